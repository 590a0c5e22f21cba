"""Material points of a surface, such as the stick points of contact, and distances between them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy import ndarray

from ..arrays import max_abs, row_norms
from .shape import gauss_points
from .surface import Surface
from .vectors import products, solve

_NEWTON_STEPS = 10
_EXACT = 1e-14


class MaterialPoints(NamedTuple):
    """Facets, shape (n,), -1 for no point, and local coordinates, (n, dim - 1), of points."""

    facet: ndarray
    xi: ndarray

    @property
    def exist(self) -> ndarray:
        """True for points on the surface, shape (n,)."""
        return np.asarray(self.facet >= 0)

    @property
    def known(self) -> ndarray:
        """Local coordinates, zero for no point."""
        return np.where(self.exist[:, None], self.xi, 0.0)

    def take(self, chosen: ndarray) -> MaterialPoints:
        """Return some of the points."""
        return MaterialPoints(self.facet[chosen], self.xi[chosen])

    def positions(self, surface: Surface, nodes: ndarray) -> ndarray:
        """Return coordinates, shape (n, dim); without meaning for no point."""
        return surface.at(self.facet, self.known, nodes, 0).x[0]


def along_chain(surface: Surface, facet: ndarray, xi: ndarray) -> ndarray:
    """Return reference arc positions of points of a surface in the plane, shape (n,).

    The facets follow each other, with the body to the right; a closed chain ends where it begins.
    """
    end = np.cumsum(surface.area)
    start = np.concatenate(([0.0], end[:-1]))[facet]
    half = 0.5 * (xi[:, 0] + 1.0)
    if surface.shape.affine:
        return np.asarray(start + half * surface.area[facet])
    # integrate the length of the tangent
    nodes = surface.nodes - surface.nodes[0]  # large coordinates would cost digits
    t, w = gauss_points(5)
    inner = -1.0 + half[:, None] * (t + 1.0)  # five Gauss points on [-1, xi]
    facets = np.repeat(facet, len(t))
    tangent = surface.at(facets, inner.reshape(-1, 1), nodes).x[1][:, 0]
    density = row_norms(tangent).reshape(-1, len(t))
    return np.asarray(start + half * (density @ w))


def arc_distance(surface: Surface, point: MaterialPoints, origin: MaterialPoints) -> ndarray:
    """Return the distance of points from others along a chain, shape (n,); zero for none.

    It is the short way round a closed chain.
    """
    between = along_chain(surface, *point) - along_chain(surface, *origin)
    length = np.where(point.exist & origin.exist, between, 0.0)
    if not surface.closed:
        return length
    total = float(surface.area.sum())
    return (length + 0.5 * total) % total - 0.5 * total


def distance(
    surface: Surface,
    nodes: ndarray,
    tangents: ndarray,
    point: MaterialPoints,
    origin: MaterialPoints,
) -> ndarray:
    """Return distances of points from others along unit tangents, (n, dim - 1); zero for none."""
    between = point.positions(surface, nodes) - origin.positions(surface, nodes)
    along = np.einsum("nic,nc->ni", tangents, between)
    both = point.exist & origin.exist
    return np.where(both[:, None], along, 0.0)


def offset_back(
    surface: Surface,
    nodes: ndarray,
    tangents: ndarray,
    point: MaterialPoints,
    slip: ndarray,
    near: MaterialPoints | None = None,
) -> MaterialPoints:
    """Return points from which these have a slip along tangents, (n, dim - 1).

    They are on the facets of points `near` them, by default of these points themselves, from which
    Newton's method begins.
    """
    if near is None:
        near = point
    facet = near.facet
    xi = near.known
    start = point.positions(surface, nodes)
    # Newton's method for tangents . (start - x) = slip.
    for _ in range(_NEWTON_STEPS):
        mapping = surface.at(facet, xi, nodes)
        missing = np.einsum("nic,nc->ni", tangents, start - mapping.x[0]) - slip
        step = solve(products(tangents, mapping.x[1]), missing)
        xi = xi + step
        if surface.shape.affine or max_abs(step) < _EXACT:
            break
    exist = point.exist & near.exist
    return MaterialPoints(np.where(exist, facet, -1), np.where(exist[:, None], xi, np.nan))
