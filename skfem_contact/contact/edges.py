r"""Variations of points whose closest point lies on an edge or a vertex of the master.

The normal follows the offset, :math:`n = (r - \rho) / g`, and the closest point may move along the
edge.  The tangential traction works on

.. math:: e_i \cdot (\delta r - \delta\rho|_\xi - g\, \Omega n), \qquad
          \Omega = \mathrm{skew}\,(\delta a_\alpha \otimes a^\alpha + \delta n_f \otimes n_f),

the motion relative to a frame that turns with the facet, whose normal is :math:`n_f`: rigid motion
does no work, so that force and moment balance.  These points are few: their second variations are
complex steps, exact to round-off (J. N. Lyness, 1967).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy import ndarray

from ..surfaces.surface import Surface
from ..surfaces.vectors import across, dot, frame, inverse, lift, outer, products, unit

_STEP = 1e-30


class First(NamedTuple):
    """Unit vectors, first variations of gap and slip work, and slip, (n, dim - 1)."""

    normal: ndarray
    tangents: ndarray
    gap_gradient: ndarray
    tangential: ndarray
    slip: ndarray


@dataclass(frozen=True, eq=False)
class OnEdges:
    """Contact at edges and vertices: the points of the numbers `at` among all that are in contact.

    The edge lies `along` a direction in local coordinates, shape (n, dim - 1), zero at vertices.
    `point` and `nodes` are coordinates of the points and of their facets' nodes; `values` are the
    slave's shape functions.
    """

    at: ndarray
    master: Surface
    facet: ndarray
    xi: ndarray
    along: ndarray
    gap: ndarray
    point: ndarray
    nodes: ndarray
    from_stick: ndarray
    direction: ndarray
    values: ndarray
    sigma: ndarray
    delta: ndarray

    @cached_property
    def first(self) -> First:
        """First variations."""
        return self._first(
            np.arange(len(self.at)), self.point, self.nodes, self.from_stick, self.direction
        )

    @cached_property
    def second(self) -> tuple[ndarray, ndarray, ndarray]:
        """Derivatives of gap gradients, work of tractions, and slips, (n, dim - 1, m)."""
        n, dim = self.point.shape
        slave, k, nodes = self.values.shape[1], self.nodes.shape[1], self.sigma.shape[1]
        eye = np.eye(dim)
        row = np.repeat(np.arange(n), dim * nodes)
        values = np.concatenate((self.values, np.zeros((n, nodes - slave))), axis=1)
        point = self.point[row] + 1j * _STEP * lift_columns(values, eye)
        corners = np.zeros((nodes, dim, k, dim))
        corners[np.arange(slave, slave + k), :, np.arange(k)] = eye
        x = self.nodes[row] + 1j * _STEP * np.tile(corners.reshape(-1, k, dim), (n, 1, 1))
        from_stick = self.from_stick[row] + 1j * _STEP * lift_columns(self.sigma, eye)
        direction = self.direction[row] + 1j * _STEP * lift_columns(self.delta, eye)
        step = self._first(row, point, x, from_stick, direction)
        G, T, s = (
            np.moveaxis((part.imag / _STEP).reshape(n, dim * nodes, *part.shape[1:]), 1, -1)
            for part in (step.gap_gradient, step.tangential, step.slip)
        )
        return G, T, s

    def _first(
        self, row: ndarray, r: ndarray, nodes: ndarray, from_stick: ndarray, direction: ndarray
    ) -> First:
        facet, along = self.facet[row], self.along[row]
        xi = self._closest(facet, self.xi[row] + 0j, along, r, nodes)
        M = self.master.shape.at(facet, xi, 1)
        rho, a = np.einsum("nk,nkc->nc", M[0], nodes), M[1] @ nodes
        offset = r - rho
        g = np.sqrt(dot(offset, offset)) * np.sign(self.gap[row])
        n, facet_n, dual = offset / g[:, None], unit(across(a)), inverse(products(a, a)) @ a
        e = frame(n, direction)
        blocks = (
            np.zeros((len(row), self.sigma.shape[1])),
            np.zeros((*M[1].shape[:2], self.sigma.shape[1])),
        )
        alpha, beta = (block.astype(complex) for block in blocks)
        slave, k = self.values.shape[1], nodes.shape[1]
        alpha[:, :slave], alpha[:, slave : slave + k], beta[:, :, slave : slave + k] = (
            self.values[row],
            -M[0],
            M[1],
        )
        T = lift(alpha[:, None], e) - g[:, None, None] * np.stack(
            [
                lift(beta, _turning(e[:, i], n, facet_n, dual)).sum(axis=1)
                for i in range(e.shape[1])
            ],
            axis=1,
        )
        result = (
            n,
            e,
            lift(alpha[:, None], n[:, None])[:, 0],
            T,
            np.einsum("nic,nc->ni", e, from_stick),
        )
        return First(*(result if np.iscomplexobj(r) else (part.real for part in result)))

    def _closest(
        self, facet: ndarray, xi: ndarray, along: ndarray, r: ndarray, nodes: ndarray
    ) -> ndarray:
        """Return local coordinates after one Newton step along the edge: exact for the complex
        part.
        """
        moves = along.any(axis=1)
        M = self.master.shape.at(facet, xi, 2)
        offset = r - np.einsum("nk,nkc->nc", M[0], nodes)
        tangent = np.einsum("na,nak,nkc->nc", along, M[1], nodes, optimize=True)
        bend = np.einsum("na,nb,nabk,nkc->nc", along, along, M[2], nodes, optimize=True)
        slope = np.where(moves, dot(tangent, tangent) - dot(offset, bend), 1.0)
        return np.asarray(xi + along * (dot(offset, tangent) / slope)[:, None])


def lift_columns(factors: ndarray, eye: ndarray) -> ndarray:
    """Return the motion of points with every dof of their nodes, shape (n nodes dim, dim)."""
    return np.asarray((factors[:, :, None, None] * eye).reshape(-1, len(eye)))


def _turning(e: ndarray, n: ndarray, facet_n: ndarray, dual: ndarray) -> ndarray:
    """Return vectors c with ``e . Omega n = c_a . da_a``, shape (n, dim - 1, dim)."""
    by_n, by_e = np.einsum("nac,nc->na", dual, n), np.einsum("nac,nc->na", dual, e)
    along_normal = by_e * dot(facet_n, n)[:, None] - by_n * dot(facet_n, e)[:, None]
    return np.asarray(0.5 * (outer(by_n, e) - outer(by_e, n) - outer(along_normal, facet_n)))
