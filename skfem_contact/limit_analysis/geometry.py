"""Straight triangles, named facets and supports from the bases of some solids."""
from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy import ndarray
from skfem import CellBasis, Mesh

from ..errors import place
from .triangles import Tag, Triangles

#: Distance of a node in the middle of a straight facet from it, as a share of the facet.
_STRAIGHT = 1e-6


class Geometry(NamedTuple):
    """Triangles in coordinates of order one: x = origin + size * those; `origin` counts the elements of the mesh."""

    triangles: Triangles
    centre: ndarray
    size: float
    curved: bool


def geometry(basis: CellBasis, elements: ndarray, fixed: ndarray) -> Geometry:
    """Triangles of some elements of a basis' mesh.

    Raises
    ------
    ValueError
        Unknowns are held that are not those of whole facets of the boundary.
    """
    mesh = basis.mesh
    corners = mesh.t[:, elements]
    nodes, t = np.unique(corners, return_inverse=True)
    t, p = t.reshape(corners.shape), mesh.p[:, nodes]
    low, high = p.min(axis=1), p.max(axis=1)
    centre, size = 0.5 * (low + high), float((high - low).max())
    facets = np.unique(mesh.t2f[:, elements])
    count = np.bincount(mesh.t2f[:, elements].ravel(), minlength=mesh.nfacets)
    outer = facets[count[facets] == 1]
    held = _held(basis, nodes, outer, fixed)
    tags: dict[Tag, ndarray] = {("held", k): outer[held[k]] for k in (0, 1)}
    for name, named in (mesh.boundaries or {}).items():
        named = np.unique(np.asarray(named))
        tags[name] = named[count[named] > 0]
    number = np.full(mesh.p.shape[1], -1)
    number[nodes] = np.arange(len(nodes))
    ends = {tag: number[mesh.facets[:, named]] for tag, named in tags.items()}
    p, t, origin = _triangulated((p - centre[:, None]) / size, t)
    return Geometry(Triangles.of(p, t, elements[origin], ends), centre, size, _curved(mesh, facets))


def _triangulated(p: ndarray, t: ndarray) -> tuple[ndarray, ndarray, ndarray]:
    """Triangles as they are, and quadrilaterals in four around their middles; with the element that each is part of."""
    n = t.shape[1]
    if len(t) == 3:
        return p, t, np.arange(n)
    middle = p.shape[1] + np.arange(n)
    parts = [np.stack([t[i], t[(i + 1) % 4], middle]) for i in range(4)]
    return np.hstack([p, p[:, t].mean(axis=1)]), np.hstack(parts), np.tile(np.arange(n), 4)


def _held(basis: CellBasis, nodes: ndarray, outer: ndarray, fixed: ndarray) -> ndarray:
    """Which facets of the boundary are held in x and in y, (2, n): all of their unknowns are."""
    mesh = basis.mesh
    is_fixed = np.zeros(basis.N, bool)
    is_fixed[fixed] = True
    corners = is_fixed[basis.nodal_dofs[:2]]  # (2, n_nodes)
    held = corners[:, mesh.facets[:, outer]].all(axis=1)
    supported = np.zeros_like(corners)
    if basis.facet_dofs is not None and len(basis.facet_dofs):
        middles = is_fixed[basis.facet_dofs[:2]]
        held &= middles[:, outer]
        alone = middles.copy()
        alone[:, outer[held.any(axis=0)]] &= ~held[:, held.any(axis=0)]
        touched = np.zeros(mesh.nfacets, bool)
        touched[outer] = True
        _refuse(alone & touched, mesh.p[:, mesh.facets].mean(axis=1))
    for k in (0, 1):
        supported[k, mesh.facets[:, outer[held[k]]]] = True
    there = np.zeros(corners.shape[1], bool)
    there[nodes] = True
    _refuse(corners & ~supported & there, mesh.p)
    return held


def _refuse(alone: ndarray, places: ndarray) -> None:
    """Complain of nodes that are held though no facet of theirs is."""
    if alone.any():
        component, node = np.argwhere(alone)[0]
        raise ValueError(f"the node at {place(places[:, node])} is held in {'xy'[component]} though no facet of the "
                         "boundary there is: bounds need supports along facets")


def _curved(mesh: Mesh, facets: ndarray) -> bool:
    """Whether a facet of a mesh of second order is curved."""
    if mesh.doflocs.shape[1] == mesh.nvertices:
        return False
    ends = mesh.p[:, mesh.facets[:, facets]]
    middle = mesh.doflocs[:, mesh.dofs.facet_dofs[0, facets]]
    off = np.linalg.norm(middle - ends.mean(axis=1), axis=0)
    return bool((off > _STRAIGHT * np.linalg.norm(ends[:, 0] - ends[:, 1], axis=0)).any())
