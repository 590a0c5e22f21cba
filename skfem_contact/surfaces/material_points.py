"""Material points of a surface, such as the stick points of contact, and distances between them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy import ndarray

from .shape import gauss_points
from .surface import Surface
from .vectors import products, solve

_NEWTON_STEPS = 10
_EXACT = 1e-14


class MaterialPoints(NamedTuple):
    """Material points of a surface: facets, shape (n,), -1 for none, and local coordinates, shape
    (n, dim - 1).
    """

    facet: ndarray
    xi: ndarray

    @property
    def exist(self) -> ndarray:
        """True for points on the surface, shape (n,)."""
        return np.asarray(self.facet >= 0)

    @property
    def known(self) -> ndarray:
        """Local coordinates, zero where there is no point."""
        return np.where(self.exist[:, None], self.xi, 0.0)

    def take(self, chosen: ndarray) -> MaterialPoints:
        """Return some of the points."""
        return MaterialPoints(self.facet[chosen], self.xi[chosen])

    def positions(self, surface: Surface, nodes: ndarray) -> ndarray:
        """Return coordinates, shape (n, dim); without meaning where there is no point."""
        return surface.at(self.facet, self.known, nodes, 0).x[0]


def along_chain(surface: Surface, facet: ndarray, xi: ndarray) -> ndarray:
    """Return arc positions of points of a surface in the plane, shape (n,), in the reference
    configuration.

    The facets follow each other, with the body to the right; a closed chain ends where it begins.
    """
    first = np.concatenate(([0.0], np.cumsum(surface.area)[:-1]))[facet]
    half = 0.5 * (xi[:, 0] + 1.0)
    if surface.shape.affine:
        return np.asarray(first + half * surface.area[facet])
    nodes = surface.nodes - surface.nodes[0]  # large coordinates would cost digits
    t, w = gauss_points(5)
    inner = -1.0 + half[:, None] * (t + 1.0)  # five Gauss points on [-1, xi]
    tangent = surface.at(np.repeat(facet, len(t)), inner.reshape(-1, 1), nodes, 1).x[1][:, 0]
    return np.asarray(first + half * (np.linalg.norm(tangent, axis=1).reshape(-1, len(t)) @ w))


def arc_distance(surface: Surface, point: MaterialPoints, origin: MaterialPoints) -> ndarray:
    """Return the distance of points from others along a chain, the short way round a closed one;
    zero for none.
    """
    length = np.where(
        point.exist & origin.exist,
        along_chain(surface, *point) - along_chain(surface, *origin),
        0.0,
    )
    total = float(surface.area.sum())
    return (length + 0.5 * total) % total - 0.5 * total if surface.closed else length


def distance(
    surface: Surface,
    nodes: ndarray,
    tangents: ndarray,
    point: MaterialPoints,
    origin: MaterialPoints,
) -> ndarray:
    """Return the distance of points from others along unit tangents, shape (n, dim - 1); zero for
    none.
    """
    between = point.positions(surface, nodes) - origin.positions(surface, nodes)
    return np.where(
        (point.exist & origin.exist)[:, None], np.einsum("nic,nc->ni", tangents, between), 0.0
    )


def offset_back(
    surface: Surface, nodes: ndarray, tangents: ndarray, point: MaterialPoints, slip: ndarray
) -> MaterialPoints:
    """Return material points of the same facets from which these have a slip, shape (n, dim - 1),
    along tangents.
    """
    xi, start = point.known, point.positions(surface, nodes)
    for _ in range(_NEWTON_STEPS):
        mapping = surface.at(point.facet, xi, nodes)
        missing = np.einsum("nic,nc->ni", tangents, start - mapping.x[0]) - slip
        step = solve(products(tangents, mapping.x[1]), missing)
        xi = xi + step
        if surface.shape.affine or np.abs(step).max(initial=0.0) < _EXACT:
            break
    return MaterialPoints(point.facet, np.where(point.exist[:, None], xi, np.nan))


def moved_along(
    surface: Surface, nodes: ndarray, points: MaterialPoints, motion: ndarray
) -> MaterialPoints:
    """Return the points moved by a motion, shape (n, dim), along the surface, to the first
    order.
    """
    a = surface.at(points.facet, points.known, nodes).x[1]
    return MaterialPoints(
        points.facet, points.xi + solve(products(a, a), np.einsum("nac,nc->na", a, motion))
    )
