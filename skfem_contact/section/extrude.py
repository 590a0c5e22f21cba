"""Tetrahedra of a plane mesh that is extruded."""

from __future__ import annotations

import numpy as np
from numpy import ndarray
from skfem import Mesh, MeshTet1, MeshTet2
from skfem.generic_utils import OrientedBoundary

from ..mesh.join import owners_of


def extruded(mesh: Mesh, levels: ndarray, upright: bool) -> Mesh:
    """Return the tetrahedra of a mesh of triangles that is extruded, with its names.

    Each prism is cut into three tetrahedra along the diagonals that begin at the node of lower
    rank. Ranks follow from coordinates, so that both sides of an interface have the same triangles.
    """
    # Cut the prisms of all layers, whose corners a, b, c are sorted by rank
    n = mesh.nvertices
    layers = len(levels) - 1
    rank = np.empty(n, int)
    rank[np.lexsort(mesh.p[::-1, :n])] = np.arange(n)
    corners = _by_rank(mesh.t, rank)
    shift = n * np.arange(layers)
    a, b, c = corners[:, None] + shift[:, None]
    prisms = np.array(
        [
            [a, b, c, c + n],
            [a, b, b + n, c + n],
            [a, a + n, b + n, c + n],
        ]
    )  # (3, 4, layers, elements)
    t = prisms.transpose(1, 2, 3, 0).reshape(4, -1)
    plane = np.tile(mesh.p[:, :n], layers + 1)
    x = _in_space(plane, np.repeat(levels, n), upright)
    solid = MeshTet1(x, t)

    # Find the names of the plane mesh in space
    numbers = np.arange(t.shape[1]).reshape(layers, mesh.nelements, 3)
    subdomains = {}
    for name, part in (mesh.subdomains or {}).items():
        subdomains[name] = np.sort(numbers[:, part].ravel())
    boundaries = {}
    for name, facets in (mesh.boundaries or {}).items():
        boundaries[name] = _faces(mesh, solid, facets, rank)
    if upright:
        first = "base"
        last = "top"
    else:
        first = "front"
        last = "back"
    boundaries[first] = _find(solid, corners)
    boundaries[last] = _find(solid, corners + n * layers)
    if mesh.doflocs.shape[1] > n:
        solid = _curved(mesh, solid, levels, upright)
    return solid.with_subdomains(subdomains).with_boundaries(boundaries)


def _by_rank(nodes: ndarray, rank: ndarray) -> ndarray:
    """Return the nodes of each column sorted by rank."""
    return np.take_along_axis(nodes, np.argsort(rank[nodes], axis=0), axis=0)


def _in_space(x: ndarray, along: ndarray, upright: bool) -> ndarray:
    if upright:
        return np.array([x[0], x[1], along])
    return np.array([x[0], along, x[1]])


def _find(solid: Mesh, nodes: ndarray) -> ndarray:
    """Return the facets of three nodes each, (3, k)."""
    facets = _keys(solid.facets, solid.nvertices)
    order = np.argsort(facets)
    wanted = _keys(nodes, solid.nvertices)
    return np.asarray(order[np.searchsorted(facets, wanted, sorter=order)])


def _keys(nodes: ndarray, n: int) -> ndarray:
    """Return a number for each set of nodes, (2 or 3, k)."""
    key = np.zeros(nodes.shape[1], dtype=np.int64)
    for row in np.sort(nodes, axis=0).astype(np.int64):
        key = key * n + row
    return key


def _faces(mesh: Mesh, solid: Mesh, facets: ndarray, rank: ndarray) -> ndarray:
    """Return the facets above a plane boundary, seen from the same elements."""
    # Cut the rectangles above each side i-j along the diagonal from the lower rank
    n = mesh.nvertices
    layers = solid.nvertices // n - 1
    base = n * np.arange(layers)[:, None]
    ends = _by_rank(mesh.facets[:, np.asarray(facets)], rank)
    i, j = ends[:, None] + base
    nodes = np.array([[i, j, j + n], [i, i + n, j + n]])  # (2, 3, layers, sides)
    found = _find(solid, nodes.transpose(1, 0, 2, 3).reshape(3, -1))
    if not isinstance(facets, OrientedBoundary):
        return np.unique(found)

    # Three tetrahedra of each prism follow each other, layer by layer
    owners = np.tile(owners_of(mesh, facets), 2 * layers)
    first = solid.f2t[0, found] // 3 % mesh.nelements
    return OrientedBoundary(found, (first != owners).astype(int))


def _curved(mesh: Mesh, solid: Mesh, levels: ndarray, upright: bool) -> Mesh:
    """Return tetrahedra of second order whose sides follow the sides of the plane mesh."""
    # Find the plane side i-j below each edge; edges along the extrusion have i = j
    n = mesh.nvertices
    i, j = solid.edges % n
    key = _keys(mesh.facets, n)
    order = np.argsort(key)
    position = np.searchsorted(key, _keys(np.array([i, j]), n), sorter=order)
    side = order[np.minimum(position, len(key) - 1)]

    # Take its middle, at the mean of the levels
    middle = np.where(i == j, mesh.p[:, i], mesh.doflocs[:, n + side])
    along = levels[solid.edges // n].mean(axis=0)
    return MeshTet2(np.hstack((solid.p, _in_space(middle, along, upright))), solid.t)
