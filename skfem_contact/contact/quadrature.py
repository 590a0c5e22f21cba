"""Quadrature on the slave surface: every contact discretisation is points, weights and shape functions."""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy import ndarray

from .surface import Surface

#: Meshes whose sizes differ by less than this share are as fine as each other.
_EQUAL = 1e-6


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

    def take(self, at: ndarray) -> SlavePoints:
        """Some of the points."""
        return SlavePoints(self.nodes[at], self.values[at], self.weight[at], self.arc[at], self.size[at])

    def positions(self, nodes: ndarray) -> ndarray:
        """Coordinates of the points, (n, 2), from those of the slave nodes."""
        return np.einsum("nk,nkc->nc", self.values, nodes[self.nodes])

    def at(self, nodal: ndarray) -> ndarray:
        """Values at the points, (n,), of a field given at the slave nodes."""
        return np.einsum("nk,nk->n", self.values, nodal[self.nodes])


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


def gauss(slave: Surface, master: Surface, n: int) -> SlavePoints:
    """``n`` Gauss points on every slave segment: surface-to-surface contact.

    The master's shape functions have kinks at its nodes, which Gauss points smear. Where these nodes lie closer than
    the slave's segments are long, the segments are divided, so that no piece is longer than the nodes' distance.
    """
    pieces = max(1, int(np.ceil(slave.spacing / _node_distance(master) - _EQUAL)))
    return between(slave, np.arange(len(slave.segments) * pieces + 1) / pieces, n)


def _node_distance(master: Surface) -> float:
    """Distance between the master's nodes; infinite if it is rigid, for then nothing is shared out to them."""
    if (master.dofs < 0).all():
        return np.inf
    intervals = len(master.nodes) - (0 if master.closed else 1)
    return master.spacing * len(master.segments) / intervals


def between(surface: Surface, cuts: ndarray, n: int) -> SlavePoints:
    """``n`` Gauss points on every piece of the chain between two cuts.

    Parameters
    ----------
    cuts
        Chain coordinates of the cuts, ascending: segment number plus the share ``(1 + xi) / 2``; whole numbers,
        the ends of the segments, are among them.
    """
    t, w = np.polynomial.legendre.leggauss(n)
    half = 0.5 * np.diff(cuts)
    coordinate = ((cuts[:-1] + half)[:, None] + half[:, None] * t).ravel()
    segment = np.repeat(np.floor(cuts[:-1] + half).astype(int), n)
    xi = 2.0 * (coordinate - segment) - 1.0
    M, rho = surface.curve(segment, xi, surface.nodes, 1)
    weight = np.linalg.norm(rho[1], axis=-1) * (2.0 * half[:, None] * w).ravel()
    return SlavePoints(surface.segments[segment], M[0], weight, surface.arc(segment, xi)[0], surface.length[segment])
