"""Straight triangles from the bases of some solids, which remember where they come from while facets are halved."""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy import ndarray
from skfem import CellBasis, Mesh, MeshTri

from ..errors import place

#: Name of some facets: a boundary of the user's, or ("held", component).
Tag = str | tuple[str, int]
#: Distance of a node in the middle of a straight facet from it, as a share of the facet.
_STRAIGHT = 1e-6
#: Digits of lengths, of order one, that decide how triangles are divided: round-off must not.
_DIGITS = 9


@dataclass(frozen=True)
class Triangles:
    """A mesh, the elements of earlier ones that each triangle is part of, and named facets.

    Attributes
    ----------
    mesh
        Corners of every triangle are sorted, as scikit-fem does it: its facets are (0, 1), (1, 2), (0, 2).
    origin
        Element of the first mesh, (n_elements,).
    parent
        Triangle of the mesh that was :attr:`rooted` last, (n_elements,).
    tags
        Facets by name.
    """

    mesh: MeshTri
    origin: ndarray
    parent: ndarray
    tags: Mapping[Tag, ndarray]

    @classmethod
    def of(cls, p: ndarray, t: ndarray, origin: ndarray, ends: Mapping[Tag, ndarray],
           parent: ndarray | None = None) -> Triangles:
        """From nodes, corners and the ends, (2, n), of named facets."""
        mesh = MeshTri(np.ascontiguousarray(p), np.ascontiguousarray(t), validate=False)
        parent = np.arange(t.shape[1]) if parent is None else parent
        return cls(mesh, origin, parent, {name: find_facets(mesh, pairs) for name, pairs in ends.items()})

    @property
    def rooted(self) -> Triangles:
        """The same triangles, as the ones that later ones are parts of."""
        return replace(self, parent=np.arange(len(self.origin)))

    def refined(self, elements: ndarray) -> Triangles:
        """Some triangles in four, their neighbours so that no angle becomes small.

        A facet is halved only together with the longest one of its triangle (A. Plaza, G. F. Carey, Applied Numerical
        Mathematics 32 (2000) 195-218).
        """
        sides, cut = self.mesh.t2f, np.zeros(self.mesh.nfacets, dtype=bool)
        cut[sides[:, elements]] = True
        lengths = np.round(facet_lengths(self.mesh), _DIGITS)[sides]
        longest = np.take_along_axis(sides, lengths.argmax(axis=0)[None], 0)[0]
        while (missing := longest[cut[sides].any(axis=0) & ~cut[longest]]).size:
            cut[missing] = True
        return self.halved(np.flatnonzero(cut))

    def fanned(self, vertices: ndarray) -> Triangles:
        """Twice as many triangles around some vertices: the facets opposite to them are halved."""
        here = np.isin(self.mesh.t, vertices)
        opposite = self.mesh.t2f[[1, 2, 0]]  # to corner 0 the facet (1, 2), ...
        return self.halved(np.unique(opposite[here]))

    def halved(self, facets: ndarray, points: ndarray | None = None) -> Triangles:
        """Some facets in two, at their middles or at given points (2, n); their triangles in two, three or four."""
        mesh = self.mesh
        if points is None:
            points = mesh.p[:, mesh.facets[:, facets]].mean(axis=1)
        new = np.full(mesh.nfacets, -1)
        new[facets] = mesh.nvertices + np.arange(len(facets))
        p = np.hstack([mesh.p, points])
        children, parents = _divided(p, mesh.t, new[mesh.t2f])
        ends = {}
        for name, named in self.tags.items():
            (a, b), middle = mesh.facets[:, named], new[named]
            whole = middle < 0
            halves = [np.stack([a, middle])[:, ~whole], np.stack([middle, b])[:, ~whole]]
            ends[name] = np.hstack([np.stack([a, b])[:, whole], *halves])
        return Triangles.of(p, children, self.origin[parents], ends, self.parent[parents])


def _divided(p: ndarray, t: ndarray, middle: ndarray) -> tuple[ndarray, ndarray]:
    """Corners and parents of the parts of all triangles; `middle` is the new node on their facets, or -1."""
    count = (middle >= 0).sum(axis=0)
    # turned so that of one cut facet, or of two, the first corner begins the first
    first = np.where(count == 1, np.argmax(middle >= 0, axis=0), (np.argmin(middle, axis=0) + 1) % 3)
    turn = (first + np.arange(3)[:, None]) % 3
    (a, b, c), (ab, bc, ca) = np.take_along_axis(t, turn, 0), np.take_along_axis(middle, turn, 0)
    across = np.linalg.norm(p[:, a] - p[:, bc], axis=0) - np.linalg.norm(p[:, ab] - p[:, c], axis=0)
    short = np.round(across, _DIGITS) <= 0
    two, three = count == 2, count == 3
    parts = [(count == 0, (a, b, c)),
             (count == 1, (a, ab, c)), (count == 1, (ab, b, c)),
             (two, (ab, b, bc)), (two & short, (a, ab, bc)), (two & short, (a, bc, c)),
             (two & ~short, (a, ab, c)), (two & ~short, (ab, bc, c)),
             (three, (a, ab, ca)), (three, (ab, b, bc)), (three, (ca, bc, c)), (three, (ab, bc, ca))]
    children = np.hstack([np.stack(corners)[:, which] for which, corners in parts])
    return children, np.concatenate([np.flatnonzero(which) for which, _ in parts])


def facet_lengths(mesh: MeshTri) -> ndarray:
    """Lengths of all facets."""
    return np.linalg.norm(np.diff(mesh.p[:, mesh.facets], axis=1)[:, 0], axis=0)


def find_facets(mesh: MeshTri, ends: ndarray) -> ndarray:
    """Numbers of the facets with the given ends, (2, n)."""
    known, wanted = (low * mesh.nvertices + high for low, high in
                     (np.sort(pairs.astype(np.int64), axis=0) for pairs in (mesh.facets, ends)))
    return np.flatnonzero(np.isin(known, wanted))


def outward_normals(mesh: MeshTri, facets: ndarray, elements: ndarray) -> ndarray:
    """Unit normals of facets, away from one of their elements each, (2, n)."""
    a, b = mesh.p[:, mesh.facets[:, facets]].transpose(1, 0, 2)
    along = (b - a) / np.linalg.norm(b - a, axis=0)
    normal = np.stack([along[1], -along[0]])
    inward = mesh.p[:, mesh.t[:, elements]].mean(axis=1) - a
    return normal * -np.sign((normal * inward).sum(axis=0))


class Geometry(NamedTuple):
    """Triangles in coordinates of order one: x = origin + size * those; `origin` counts the elements of the mesh."""

    triangles: Triangles
    centre: ndarray
    size: float
    curved: bool


def geometry(basis: CellBasis, elements: ndarray, fixed: ndarray) -> Geometry:
    """Triangles of some elements of a basis' mesh; unknowns must be held along whole facets of its boundary."""
    mesh = basis.mesh
    corners = mesh.t[:, elements]
    nodes, t = np.unique(corners, return_inverse=True)
    t, p = t.reshape(corners.shape), mesh.p[:, nodes]
    low, high = p.min(axis=1), p.max(axis=1)
    centre, size = 0.5 * (low + high), float((high - low).max())
    facets = np.unique(mesh.t2f[:, elements])
    count = np.bincount(mesh.t2f[:, elements].ravel(), minlength=mesh.nfacets)
    outer = facets[count[facets] == 1]
    held = _held(basis, elements, outer, fixed)
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


def _held(basis: CellBasis, elements: ndarray, outer: ndarray, fixed: ndarray) -> list[ndarray]:
    """Which facets of the boundary are held in x and in y, (n,) each: all of their unknowns are."""
    held = []
    for k in (0, 1):
        dofs = basis.nodal_dofs[k, basis.mesh.facets[:, outer]]
        if len(basis.facet_dofs):
            dofs = np.vstack([dofs, basis.facet_dofs[k, outer]])
        held.append(np.asarray(np.isin(dofs, fixed).all(axis=0)))
        alone = np.setdiff1d(np.intersect1d(fixed, basis.dofs.element_dofs[k::2, elements]), dofs[:, held[k]])
        if len(alone):
            raise ValueError(f"the node at {place(basis.doflocs[:, alone[0]])} is held in {'xy'[k]} though no facet of "
                             "the boundary there is: bounds need supports along facets")
    return held


def _curved(mesh: Mesh, facets: ndarray) -> bool:
    """Whether a facet of a mesh of second order is curved."""
    if mesh.doflocs.shape[1] == mesh.nvertices:
        return False
    ends = mesh.p[:, mesh.facets[:, facets]]
    middle = mesh.doflocs[:, mesh.dofs.facet_dofs[0, facets]]
    off = np.linalg.norm(middle - ends.mean(axis=1), axis=0)
    return bool((off > _STRAIGHT * np.linalg.norm(ends[:, 0] - ends[:, 1], axis=0)).any())
