"""Material points of a surface: the stick points of contact, and how far points are from each other on it."""
from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy import ndarray

from .surface import Surface, gauss_points
from .vectors import products, solve

_NEWTON_STEPS = 10
_EXACT = 1e-14


class MaterialPoints(NamedTuple):
    """Material points of a surface: facets, (n,), -1 for none, and local coordinates, (n, dim - 1)."""

    facet: ndarray
    xi: ndarray

    @property
    def exist(self) -> ndarray:
        """Which of them are on the surface at all, (n,)."""
        return np.asarray(self.facet >= 0)

    @property
    def known(self) -> ndarray:
        """Local coordinates, zero of those that are none."""
        return np.where(self.exist[:, None], self.xi, 0.0)

    def take(self, chosen: ndarray) -> MaterialPoints:
        """Some of the points."""
        return MaterialPoints(self.facet[chosen], self.xi[chosen])

    def places(self, surface: Surface, nodes: ndarray) -> ndarray:
        """Where they are, (n, dim); of no meaning for those that are none."""
        return surface.at(self.facet, self.known, nodes, 0).x[0]


def along_chain(surface: Surface, facet: ndarray, xi: ndarray) -> ndarray:
    """Arc positions of points of a surface in the plane, (n,), in the reference configuration.

    Its facets follow each other, with the body to the right; a closed one ends where it begins.

    Examples
    --------
    >>> import numpy as np
    >>> import skfem_contact as sc
    >>> floor = sc.rigid_polyline([(0., 0.), (1., 0.), (4., 0.)])
    >>> along_chain(floor, np.array([1]), np.array([[0.0]])).tolist()
    [2.5]
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


def way(surface: Surface, point: MaterialPoints, origin: MaterialPoints) -> ndarray:
    """Way from one material point to another along a chain, (n,), the short way round a closed one; zero for none."""
    length = np.where(point.exist & origin.exist, along_chain(surface, *point) - along_chain(surface, *origin), 0.0)
    total = float(surface.area.sum())
    return (length + 0.5 * total) % total - 0.5 * total if surface.closed else length


def apart(surface: Surface, nodes: ndarray, tangents: ndarray, point: MaterialPoints, origin: MaterialPoints
          ) -> ndarray:
    """Way from one material point to another along unit tangents, (n, dim - 1); zero where one of them is none."""
    way = point.places(surface, nodes) - origin.places(surface, nodes)
    return np.where((point.exist & origin.exist)[:, None], np.einsum("nic,nc->ni", tangents, way), 0.0)


def behind(surface: Surface, nodes: ndarray, tangents: ndarray, point: MaterialPoints, way: ndarray) -> MaterialPoints:
    """Material points of the same facets from which it is a given way, (n, dim - 1), to these along unit tangents."""
    xi, start = point.known, point.places(surface, nodes)
    for _ in range(_NEWTON_STEPS):
        place = surface.at(point.facet, xi, nodes)
        missing = np.einsum("nic,nc->ni", tangents, start - place.x[0]) - way
        step = solve(products(tangents, place.x[1]), missing)
        xi = xi + step
        if surface.shape.affine or np.abs(step).max(initial=0.0) < _EXACT:
            break
    return MaterialPoints(point.facet, np.where(point.exist[:, None], xi, np.nan))


def shifted(surface: Surface, nodes: ndarray, points: MaterialPoints, motion: ndarray) -> MaterialPoints:
    """The points moved on along the surface, (n, dim), to the first order."""
    a = surface.at(points.facet, points.known, nodes).x[1]
    return MaterialPoints(points.facet, points.xi + solve(products(a, a), np.einsum("nac,nc->na", a, motion)))
