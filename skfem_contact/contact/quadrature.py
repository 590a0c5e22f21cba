"""Quadrature on the slave surface: every contact discretisation is points, weights and shape functions."""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy import ndarray

from .surface import Surface, powers


@dataclass(frozen=True)
class SlavePoints:
    """Points of the slave surface at which contact is looked for.

    Attributes
    ----------
    nodes
        Nodes of the slave surface that move each point, (n, k).
    values
        Their shape functions, (n, k).
    weight
        Length of surface that belongs to each point, (n,), in the reference configuration.
    arc
        Position along the slave chain, (n,).
    size
        Length of the slave segment at the point, (n,).
    """

    nodes: ndarray
    values: ndarray
    weight: ndarray
    arc: ndarray
    size: ndarray

    def positions(self, nodes: ndarray) -> ndarray:
        """Coordinates of the points, (n, 2), from those of the slave nodes."""
        return np.einsum("nk,nkc->nc", self.values, nodes[self.nodes])


def nodal(surface: Surface) -> SlavePoints:
    """The paper's node-to-segment rule: the nodes themselves with their tributary lengths.

    The weight turns the traction of a node into its force, so that a penalty does not depend on the mesh.
    """
    k = surface.segments.shape[1]
    shares = np.array([.5, .5]) if k == 2 else np.array([1, 1, 4]) / 6.0
    position = np.array([0.0, 1.0]) if k == 2 else np.array([0.0, 1.0, .5])
    flat = surface.segments.ravel()
    weight = np.bincount(flat, (surface.length[:, None] * shares).ravel(), minlength=len(surface.nodes))
    size = np.zeros(len(surface.nodes))
    np.maximum.at(size, flat, np.repeat(surface.length, k))
    arc = np.zeros(len(surface.nodes))
    arc[flat[::-1]] = (surface.start[:, None] + surface.length[:, None] * position).ravel()[::-1]
    order = np.argsort(arc)
    return SlavePoints(order[:, None], np.ones((len(order), 1)), weight[order], arc[order], size[order])


def gauss(surface: Surface, n: int) -> SlavePoints:
    """``n`` Gauss points on every slave segment: surface-to-surface contact."""
    xi, w = np.polynomial.legendre.leggauss(n)
    m = len(surface.segments)
    segment, points = np.repeat(np.arange(m), n), np.tile(xi, m)
    M, rho = surface.curve(segment, points, surface.nodes)
    weight = np.linalg.norm(rho[1], axis=-1) * np.tile(w, m)
    return SlavePoints(surface.segments[segment], M[0], weight, surface.arc(segment, points)[0],
                       surface.length[segment])
