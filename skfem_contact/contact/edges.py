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
        slave = self.values.shape[1]
        k = self.nodes.shape[1]
        n_nodes = self.sigma.shape[1]
        m = dim * n_nodes
        eye = np.eye(dim)

        # Move every node by a complex step in every direction: a row for each point and dof
        row = np.repeat(np.arange(n), m)
        of_master = np.zeros((n, n_nodes - slave))
        values = np.concatenate((self.values, of_master), axis=1)
        corners = np.zeros((n_nodes, dim, k, dim))
        corners[np.arange(slave, slave + k), :, np.arange(k)] = eye
        corners = np.tile(corners.reshape(-1, k, dim), (n, 1, 1))
        step = 1j * _STEP
        point = self.point[row] + step * _by_dofs(values, eye)
        nodes = self.nodes[row] + step * corners
        from_stick = self.from_stick[row] + step * _by_dofs(self.sigma, eye)
        direction = self.direction[row] + step * _by_dofs(self.delta, eye)
        moved = self._first(row, point, nodes, from_stick, direction)

        def derivative(part: ndarray) -> ndarray:
            by_row = (part.imag / _STEP).reshape(n, m, *part.shape[1:])
            return np.moveaxis(by_row, 1, -1)

        return (
            derivative(moved.gap_gradient),
            derivative(moved.tangential),
            derivative(moved.slip),
        )

    def _first(
        self,
        row: ndarray,
        r: ndarray,
        nodes: ndarray,
        from_stick: ndarray,
        direction: ndarray,
    ) -> First:
        """Return the variations of points `row` at real or complex coordinates."""
        # Normal n = (r - rho) / g at the closest point, and the frame
        facet = self.facet[row]
        xi = self._closest(facet, self.xi[row] + 0j, self.along[row], r, nodes)
        M = self.master.shape.at(facet, xi, 1)
        rho = np.einsum("nk,nkc->nc", M[0], nodes)
        offset = r - rho
        g = np.sqrt(dot(offset, offset)) * np.sign(self.gap[row])
        n = offset / g[:, None]
        e = frame(n, direction)

        # Normal and dual tangents of the facet, with which the frame turns
        a = M[1] @ nodes
        facet_n = unit(across(a))
        dual = inverse(products(a, a)) @ a

        # Factors of the nodes in r - rho and in the tangents a
        slave = self.values.shape[1]
        own = slice(slave, slave + nodes.shape[1])
        n_nodes = self.sigma.shape[1]
        alpha = np.zeros((len(row), n_nodes), complex)
        alpha[:, :slave] = self.values[row]
        alpha[:, own] = -M[0]
        beta = np.zeros((*a.shape[:2], n_nodes), complex)  # (n, dim - 1, nodes)
        beta[:, :, own] = M[1]

        # Motion relative to the turning frame: e . (dr - drho - g Omega n)
        turned = []
        for i in range(e.shape[1]):
            c = _turning(e[:, i], n, facet_n, dual)
            turned.append(lift(beta, c).sum(axis=1))
        turning = g[:, None, None] * np.stack(turned, axis=1)
        result = First(
            normal=n,
            tangents=e,
            gap_gradient=lift(alpha[:, None], n[:, None])[:, 0],
            tangential=lift(alpha[:, None], e) - turning,
            slip=np.einsum("nic,nc->ni", e, from_stick),
        )
        if np.iscomplexobj(r):
            return result
        return First(*(part.real for part in result))

    def _closest(
        self,
        facet: ndarray,
        xi: ndarray,
        along: ndarray,
        r: ndarray,
        nodes: ndarray,
    ) -> ndarray:
        """Return xi after one Newton step along the edge, exact for the complex part."""
        M = self.master.shape.at(facet, xi, 2)
        offset = r - np.einsum("nk,nkc->nc", M[0], nodes)
        tangent = np.einsum("na,nak,nkc->nc", along, M[1], nodes, optimize=True)
        bend = np.einsum("na,nb,nabk,nkc->nc", along, along, M[2], nodes, optimize=True)
        slope = dot(tangent, tangent) - dot(offset, bend)
        slope = np.where(along.any(axis=1), slope, 1.0)  # vertices stay
        step = dot(offset, tangent) / slope
        return np.asarray(xi + along * step[:, None])


def _by_dofs(factors: ndarray, eye: ndarray) -> ndarray:
    """Return the motion of points with every dof of their nodes, shape (n nodes dim, dim)."""
    return np.asarray((factors[:, :, None, None] * eye).reshape(-1, len(eye)))


def _turning(e: ndarray, n: ndarray, facet_n: ndarray, dual: ndarray) -> ndarray:
    """Return vectors c with ``e . Omega n = c_a . da_a``, shape (n, dim - 1, dim)."""
    by_n = np.einsum("nac,nc->na", dual, n)
    by_e = np.einsum("nac,nc->na", dual, e)
    by_e_along = by_e * dot(facet_n, n)[:, None]
    by_n_along = by_n * dot(facet_n, e)[:, None]
    along_normal = by_e_along - by_n_along
    turning = outer(by_n, e) - outer(by_e, n) - outer(along_normal, facet_n)
    return np.asarray(0.5 * turning)
