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
    n, layers = mesh.nvertices, len(levels) - 1
    rank = np.empty(n, int)
    rank[np.lexsort(mesh.p[::-1, :n])] = np.arange(n)
    corners = np.take_along_axis(mesh.t, np.argsort(rank[mesh.t], axis=0), axis=0)
    a, b, c = corners[:, None] + n * np.arange(layers)[:, None]
    tets = np.array(
        [[a, b, c, c + n], [a, b, b + n, c + n], [a, a + n, b + n, c + n]]
    )  # (3, 4, layers, elements)
    t = tets.transpose(1, 2, 3, 0).reshape(4, -1)
    solid = MeshTet1(
        _in_space(np.tile(mesh.p[:, :n], layers + 1), np.repeat(levels, n), upright), t
    )
    prism = np.arange(t.shape[1]).reshape(layers, mesh.nelements, 3)
    subdomains = {
        name: np.sort(prism[:, part].ravel()) for name, part in (mesh.subdomains or {}).items()
    }
    boundaries = {
        name: _faces(mesh, solid, facets, rank) for name, facets in (mesh.boundaries or {}).items()
    }
    for name, level in zip(("base", "top") if upright else ("front", "back"), (0, layers)):
        boundaries[name] = _find(solid, corners + n * level)
    if mesh.doflocs.shape[1] > n:
        solid = _curved(mesh, solid, levels, upright)
    return solid.with_subdomains(subdomains).with_boundaries(boundaries)


def _in_space(x: ndarray, along: ndarray, upright: bool) -> ndarray:
    return np.array([x[0], x[1], along] if upright else [x[0], along, x[1]])


def _find(solid: Mesh, nodes: ndarray) -> ndarray:
    """Return the facets of three nodes each, (3, k)."""
    facets, wanted = (_keys(part, solid.nvertices) for part in (solid.facets, nodes))
    order = np.argsort(facets)
    return np.asarray(order[np.searchsorted(facets, wanted, sorter=order)])


def _keys(nodes: ndarray, n: int) -> ndarray:
    """Return a number for each set of nodes, (2 or 3, k)."""
    key = np.zeros(nodes.shape[1], dtype=np.int64)
    for row in np.sort(nodes, axis=0).astype(np.int64):
        key = key * n + row
    return key


def _faces(mesh: Mesh, solid: Mesh, facets: ndarray, rank: ndarray) -> ndarray:
    """Return the facets above those of a plane boundary, seen from the same elements."""
    n, ends = mesh.nvertices, mesh.facets[:, np.asarray(facets)]
    i, j = np.take_along_axis(ends, np.argsort(rank[ends], axis=0), axis=0)
    layers = solid.nvertices // n - 1
    base = n * np.arange(layers)[:, None]
    i, j = i + base, j + base
    nodes = np.concatenate(
        (np.array([i, j, j + n]).reshape(3, -1), np.array([i, i + n, j + n]).reshape(3, -1)), axis=1
    )
    found = _find(solid, nodes)
    if not isinstance(facets, OrientedBoundary):
        return np.unique(found)
    owners = np.tile(owners_of(mesh, facets), 2 * layers)
    return OrientedBoundary(
        found, (solid.f2t[0, found] // 3 % mesh.nelements != owners).astype(int)
    )


def _curved(mesh: Mesh, solid: Mesh, levels: ndarray, upright: bool) -> Mesh:
    """Return tetrahedra of second order whose sides follow those of the plane mesh."""
    n = mesh.nvertices
    i, j = solid.edges % n
    along = levels[solid.edges // n].mean(axis=0)
    key = _keys(mesh.facets, n)
    order = np.argsort(key)
    side = order[
        np.minimum(np.searchsorted(key, _keys(np.array([i, j]), n), sorter=order), len(key) - 1)
    ]
    middle = np.where(i == j, mesh.p[:, i], mesh.doflocs[:, n + side])
    return MeshTet2(np.hstack((solid.p, _in_space(middle, along, upright))), solid.t)
