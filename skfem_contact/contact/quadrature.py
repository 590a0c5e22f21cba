"""Quadrature on the slave surface: every contact discretisation is points, weights and shape functions."""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy import ndarray

from ..surfaces.shape import Shape
from ..surfaces.surface import Place, Surface, gauss_points, rule
from ..surfaces.vectors import across, products, solve

#: Meshes whose sizes differ by less than this share are as fine as each other.
_EQUAL = 1e-6


@dataclass(frozen=True)
class SlavePoints:
    """Points of the slave surface at which contact is looked for.

    Attributes
    ----------
    facet, xi
        Facet and local coordinates of each point, (n,) and (n, dim - 1); in the plane in the order of the chain.
    nodes
        Nodes of the slave surface that move each point, (n, k).
    values
        Their shape functions, (n, k).
    weight
        Area of surface that belongs to each point, (n,), in the reference configuration: length in the plane, in axial
        symmetry length times radius.
    size
        Size of the slave's facet at the point, (n,).
    along
        Factors of the facet's nodes in the direction from which tangents are counted in space, (n, k); see
        :meth:`direction`.
    facing
        Facets of the master that pieces of facets in space face, (n,); -1 for none, and for other points.
    """

    facet: ndarray
    xi: ndarray
    nodes: ndarray
    values: ndarray
    weight: ndarray
    size: ndarray
    along: ndarray
    facing: ndarray

    @classmethod
    def on(cls, surface: Surface, facet: ndarray, xi: ndarray, weight: ndarray) -> SlavePoints:
        """Points given by facet and local coordinates, with weights in the measure of the local coordinates."""
        place = surface.at(facet, xi, surface.nodes)
        area = np.linalg.norm(across(place.x[1]), axis=1) * (place.x[0][:, 0] if surface.axisymmetric else 1.0)
        return cls(facet, xi, surface.facets[facet], place.shapes[0], area * weight, surface.size[facet],
                   _along(surface, facet, place), np.full(len(facet), -1))

    def take(self, chosen: ndarray) -> SlavePoints:
        """Some of the points, given by their numbers."""
        return SlavePoints(**{name: part[chosen] for name, part in vars(self).items()})

    def positions(self, nodes: ndarray) -> ndarray:
        """Coordinates of the points, (n, dim), from those of the slave nodes."""
        return np.asarray(np.einsum("nk,nkc->nc", self.values, nodes[self.nodes]))

    def direction(self, slave: Surface, nodes: ndarray) -> ndarray:
        """The slave's direction as its material carries it along, (n, dim); nothing in the plane."""
        if slave.dim == 2:
            return np.zeros((len(self.facet), 2))
        return np.asarray(np.einsum("nk,nkc->nc", self.along, nodes[slave.facets[self.facet]]))

    def at(self, nodal: ndarray) -> ndarray:
        """Values at the points, (n, ...), of a field given at the slave nodes, (n_nodes, ...)."""
        return np.asarray(np.einsum("nk,nk...->n...", self.values, nodal[self.nodes]))


def _along(surface: Surface, facet: ndarray, place: Place) -> ndarray:
    """Factors of the facets' nodes in the surface's directions at places of the undeformed surface, (n, k)."""
    if surface.dim == 2:
        return np.zeros(place.shapes[0].shape)
    a = place.x[1]
    contravariant = solve(products(a, a), np.einsum("nac,nc->na", a, surface.directions[facet]))
    return np.asarray(np.einsum("na,nak->nk", contravariant, place.shapes[1]))


def nodal(surface: Surface) -> SlavePoints:
    """The paper's node-to-segment rule: the nodes themselves with their tributary lengths or areas.

    The weight turns the traction of a node into its force, so that a penalty does not depend on the mesh. On triangles
    of second order the nodes on the sides carry it all.

    Raises
    ------
    ValueError
        Facets of eight nodes, whose corners have negative areas.
    """
    m, k = surface.facets.shape
    xi, w = rule(surface.shape, 3)
    facet = np.repeat(np.arange(m), len(w))
    everywhere = SlavePoints.on(surface, facet, np.tile(xi, (m, 1)), np.tile(w, m))
    weight = np.bincount(everywhere.nodes.ravel(), (everywhere.weight[:, None] * everywhere.values).ravel())
    weight[np.abs(weight) < _EQUAL * weight.max()] = 0.0
    if (weight < 0.0).any():
        raise ValueError(f"'{surface.name}': the corners of facets of eight nodes have negative areas: use Gauss "
                         'points or quadrature="segments" in place of "nodal"')
    size = np.zeros(len(weight))
    np.maximum.at(size, surface.facets.ravel(), np.repeat(surface.size, k))
    _, first = np.unique(surface.facets.ravel(), return_index=True)
    facet, local = np.divmod(first, k)
    place = surface.shape.nodes[local]
    order = np.argsort(facet + 0.5 * place[:, 0]) if surface.dim == 2 else np.arange(len(weight))
    order = order[weight[order] > 0.0]
    along = _along(surface, facet, surface.at(facet, place, surface.nodes))
    return SlavePoints(facet[order], place[order], order[:, None], np.ones((len(order), 1)), weight[order], size[order],
                       along[order], np.full(len(order), -1))


def gauss(slave: Surface, master: Surface, n: int) -> SlavePoints:
    """Gauss points on every slave facet: surface-to-surface contact.

    There are n in each direction, on triangles as many as integrate the degree 2n - 2.  The master's shape
    functions have kinks at its nodes, which Gauss points smear. Where these nodes lie closer than the slave's facets
    are long, the facets are divided, so that no piece is longer than the nodes' distance.
    """
    pieces = max(1, int(np.ceil(slave.spacing / _node_distance(master) - _EQUAL)))
    xi, w = _divided(slave.shape, n, pieces)
    m = len(slave.facets)
    return SlavePoints.on(slave, np.repeat(np.arange(m), len(w)), np.tile(xi, (m, 1)), np.tile(w, m))


def _node_distance(master: Surface) -> float:
    """Distance between the master's nodes; infinite if it is rigid, for then nothing is shared out to them."""
    if master.rigid:
        return np.inf
    intervals = len(master.nodes) - (0 if master.closed else 1)
    if master.dim == 3:
        intervals = len(master.facets) * int(master.shape.exponents.max()) ** 2
    return float(master.spacing * (len(master.facets) / intervals) ** (1 / (master.dim - 1)))


def _divided(shape: Shape, n: int, pieces: int) -> tuple[ndarray, ndarray]:
    """Gauss points and weights on equal pieces of a facet, so many in each direction."""
    xi, w = rule(shape, n)
    low, share = shape.corners.min(axis=0), 1.0 / pieces
    shift = np.ptp(shape.corners, axis=0) * share
    steps = np.stack(np.meshgrid(*[np.arange(pieces)] * shape.dim, indexing="ij"), axis=-1).reshape(-1, shape.dim)
    upright = low + steps[:, None] * shift + (xi - low) * share
    if not shape.triangular:
        return upright.reshape(-1, shape.dim), np.tile(w * share**shape.dim, len(steps))
    turned = low + (steps[:, None] + 1) * shift - (xi - low) * share
    inside = np.concatenate((upright[steps.sum(axis=1) < pieces], turned[steps.sum(axis=1) < pieces - 1]))
    return inside.reshape(-1, shape.dim), np.tile(w * share**2, len(inside))


def between(surface: Surface, cuts: ndarray, n: int) -> SlavePoints:
    """``n`` Gauss points on every piece of a surface in the plane between two cuts.

    The cuts ascend: facet number plus the share ``(1 + xi) / 2``; facets' ends, whole numbers, are among them.
    """
    t, w = gauss_points(n)
    half = 0.5 * np.diff(cuts)
    coordinate = ((cuts[:-1] + half)[:, None] + half[:, None] * t).ravel()
    facet = np.repeat(np.floor(cuts[:-1] + half).astype(int), n)
    return SlavePoints.on(surface, facet, 2.0 * (coordinate - facet)[:, None] - 1.0, (2.0 * half[:, None] * w).ravel())
