"""Straight triangles of some solids, their refinement, and the matching of contacts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy import ndarray
from scipy.spatial import cKDTree
from skfem import CellBasis, Mesh, MeshTri

from ..checks import format_point

#: Name of some facets: a boundary of the user's, ("held", component), or the surface.
Tag = str | tuple[str, int]
#: Name of all facets that bound the solids.
SURFACE: Tag = ("surface", 0)
#: Distance of a node in the middle of a straight facet from it, as a share of the facet.
_STRAIGHT = 1e-6
#: Distance of two nodes of a contact, as a share of a facet, that are made one.
_SAME = 1e-3
#: Largest distance of a node from the other side's facet, as a share of it, that is closed: chords
#: of curved faces.
_GAP = 0.1
#: Cosine of the angle up to which sides of a contact face each other.
_FACING = 0.9
#: Digits of lengths, of order one, that decide how triangles are divided: round-off must not.
_DIGITS = 9


@dataclass(frozen=True)
class Triangles:
    """Mesh with the parents of its triangles, and named facets."""

    # corners of every triangle are sorted, as in scikit-fem: its facets are (0, 1), (1, 2), (0, 2)
    mesh: MeshTri
    origin: ndarray  # element of the first mesh, (n_elements,)
    parent: ndarray  # triangle of the mesh that was rooted last, (n_elements,)
    tags: Mapping[Tag, ndarray]  # facets by name

    @classmethod
    def of(
        cls,
        p: ndarray,
        t: ndarray,
        origin: ndarray,
        ends: Mapping[Tag, ndarray],
        parent: ndarray | None = None,
    ) -> Triangles:
        """Make triangles from nodes, corners and the ends, (2, n), of named facets."""
        mesh = MeshTri(np.ascontiguousarray(p), np.ascontiguousarray(t), validate=False)
        parent = np.arange(t.shape[1]) if parent is None else parent

        def number(ends: ndarray) -> ndarray:
            low, high = np.sort(ends.astype(np.int64), axis=0)
            return low * mesh.nvertices + high

        known = number(mesh.facets)
        return cls(
            mesh,
            origin,
            parent,
            {name: np.flatnonzero(np.isin(known, number(e))) for name, e in ends.items()},
        )

    def refined(self, elements: ndarray) -> Triangles:
        """Cut some triangles in four, and neighbours so that no angle becomes small.

        A facet is halved only together with the longest one of its triangle (A. Plaza, G. F. Carey,
        Applied Numerical Mathematics 32 (2000) 195-218).
        """
        sides, cut = self.mesh.t2f, np.zeros(self.mesh.nfacets, dtype=bool)
        cut[sides[:, elements]] = True
        lengths = np.round(facet_lengths(self.mesh), _DIGITS)[sides]
        longest = np.take_along_axis(sides, lengths.argmax(axis=0)[None], 0)[0]
        while (missing := longest[cut[sides].any(axis=0) & ~cut[longest]]).size:
            cut[missing] = True
        return self.halved(np.flatnonzero(cut))

    def fanned(self, vertices: ndarray) -> Triangles:
        """Double the triangles around some vertices: the facets opposite to them are halved."""
        here = np.isin(self.mesh.t, vertices)
        opposite = self.mesh.t2f[[1, 2, 0]]  # to corner 0 the facet (1, 2), ...
        return self.halved(np.unique(opposite[here]))

    def halved(self, facets: ndarray, points: ndarray | None = None) -> Triangles:
        """Cut facets in two, at their middles or at given points (2, n), and their triangles in two
        to four.
        """
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
    """Return corners and parents of the parts of all triangles; `middle` is the new node on their
    facets, or -1.
    """
    count = (middle >= 0).sum(axis=0)
    # turned so that of one cut facet, or of two, the first corner begins the first
    first = np.where(
        count == 1, np.argmax(middle >= 0, axis=0), (np.argmin(middle, axis=0) + 1) % 3
    )
    turn = (first + np.arange(3)[:, None]) % 3
    (a, b, c), (ab, bc, ca) = np.take_along_axis(t, turn, 0), np.take_along_axis(middle, turn, 0)
    across = np.linalg.norm(p[:, a] - p[:, bc], axis=0) - np.linalg.norm(p[:, ab] - p[:, c], axis=0)
    short = np.round(across, _DIGITS) <= 0
    two, three = count == 2, count == 3
    parts = [
        (count == 0, (a, b, c)),
        (count == 1, (a, ab, c)),
        (count == 1, (ab, b, c)),
        (two, (ab, b, bc)),
        (two & short, (a, ab, bc)),
        (two & short, (a, bc, c)),
        (two & ~short, (a, ab, c)),
        (two & ~short, (ab, bc, c)),
        (three, (a, ab, ca)),
        (three, (ab, b, bc)),
        (three, (ca, bc, c)),
        (three, (ab, bc, ca)),
    ]
    children = np.hstack([np.stack(corners)[:, which] for which, corners in parts])
    return children, np.concatenate([np.flatnonzero(which) for which, _ in parts])


def facet_lengths(mesh: MeshTri) -> ndarray:
    """Return lengths of all facets."""
    return np.linalg.norm(np.diff(mesh.p[:, mesh.facets], axis=1)[:, 0], axis=0)


def outward_normals(mesh: MeshTri, facets: ndarray, elements: ndarray) -> ndarray:
    """Return unit normals of facets, away from one of their elements each, (2, n)."""
    a, b = mesh.p[:, mesh.facets[:, facets]].transpose(1, 0, 2)
    along = (b - a) / np.linalg.norm(b - a, axis=0)
    normal = np.stack([along[1], -along[0]])
    inward = mesh.p[:, mesh.t[:, elements]].mean(axis=1) - a
    return normal * -np.sign((normal * inward).sum(axis=0))


def gradients(mesh: MeshTri) -> tuple[ndarray, ndarray]:
    """Return gradients of the linear shape functions, (n_elements, 3 corners, 2), and areas."""
    x, y = mesh.p[:, mesh.t]
    twice = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0])
    by_x = np.stack([y[1] - y[2], y[2] - y[0], y[0] - y[1]], 1)
    by_y = np.stack([x[2] - x[1], x[0] - x[2], x[1] - x[0]], 1)
    return np.stack([by_x, by_y], 2) / twice[:, None, None], np.abs(twice) / 2


class Geometry(NamedTuple):
    """Triangles in coordinates of order one: x = centre + size * coordinates; `origin` counts
    elements of the mesh.
    """

    triangles: Triangles
    centre: ndarray
    size: float
    curved: bool


def geometry(basis: CellBasis, elements: ndarray, fixed: ndarray) -> Geometry:
    """Return triangles of some elements of a basis' mesh; dofs must be held along whole facets of
    its boundary.
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
    held = _held(basis, elements, outer, fixed)
    tags: dict[Tag, ndarray] = {SURFACE: outer, **{("held", k): outer[held[k]] for k in (0, 1)}}
    for name, named in (mesh.boundaries or {}).items():
        named = np.unique(np.asarray(named))
        tags[name] = named[count[named] > 0]
    number = np.full(mesh.p.shape[1], -1)
    number[nodes] = np.arange(len(nodes))
    ends = {tag: number[mesh.facets[:, named]] for tag, named in tags.items()}
    p = (p - centre[:, None]) / size
    if len(t) == 4:  # quadrilaterals in four triangles around their middles
        middle = p.shape[1] + np.arange(len(elements))
        p = np.hstack([p, p[:, t].mean(axis=1)])
        t = np.hstack([np.stack([t[i], t[(i + 1) % 4], middle]) for i in range(4)])
        elements = np.tile(elements, 4)
    return Geometry(Triangles.of(p, t, elements, ends), centre, size, _curved(mesh, facets))


def _held(basis: CellBasis, elements: ndarray, outer: ndarray, fixed: ndarray) -> list[ndarray]:
    """Return masks of the boundary's facets whose dofs are all held in x and in y, (n,) each."""
    held = []
    for k in (0, 1):
        dofs = basis.nodal_dofs[k, basis.mesh.facets[:, outer]]
        if len(basis.facet_dofs):
            dofs = np.vstack([dofs, basis.facet_dofs[k, outer]])
        held.append(np.asarray(np.isin(dofs, fixed).all(axis=0)))
        alone = np.setdiff1d(
            np.intersect1d(fixed, basis.dofs.element_dofs[k::2, elements]), dofs[:, held[k]]
        )
        if len(alone):
            raise ValueError(
                f"the node at {format_point(basis.doflocs[:, alone[0]])} is held in {'xy'[k]} "
                f"though no "
                "facet of the boundary there is: bounds need supports along facets"
            )
    return held


def _curved(mesh: Mesh, facets: ndarray) -> bool:
    """Return True if a facet of a mesh of second order is curved."""
    if mesh.doflocs.shape[1] == mesh.nvertices:
        return False
    ends = mesh.p[:, mesh.facets[:, facets]]
    middle = mesh.doflocs[:, mesh.dofs.facet_dofs[0, facets]]
    off = np.linalg.norm(middle - ends.mean(axis=1), axis=0)
    return bool((off > _STRAIGHT * np.linalg.norm(ends[:, 0] - ends[:, 1], axis=0)).any())


@dataclass(frozen=True)
class Contact:
    """Two boundaries in contact, by the tags of their facets; adhesion, friction and tensile
    strength.
    """

    slave: str
    master: str
    a: float = 0.0
    mu: float = 0.0
    tension: float = 0.0
    reduced: bool = False
    tied: bool = False


def matched(contacts: tuple[Contact, ...], triangles: Triangles) -> Triangles:
    """Insert the nodes of each side of a contact into the other side."""
    for contact in contacts:
        for one, other in ((contact.slave, contact.master), (contact.master, contact.slave)):
            while (cuts := _missing(triangles, one, other)) is not None:
                triangles = triangles.halved(*cuts)
        triangles = _closed(triangles, contact)
    return triangles


def _missing(triangles: Triangles, one: str, other: str) -> tuple[ndarray, ndarray] | None:
    """Return facets of one side that hold nodes of the other, and the node nearest to the middle of
    each.
    """
    mesh, facets = triangles.mesh, triangles.tags[one]
    nodes = np.unique(mesh.facets[:, triangles.tags[other]])
    along, away = _local(triangles, facets, nodes)
    inside = (along > _SAME) & (along < 1 - _SAME) & (np.abs(away) < _GAP)
    distance = np.where(inside, np.abs(along - 0.5), np.inf)
    nearest = distance.argmin(axis=1)
    cut = inside.any(axis=1)
    return (facets[cut], mesh.p[:, nodes[nearest[cut]]]) if cut.any() else None


def _local(triangles: Triangles, facets: ndarray, nodes: ndarray) -> tuple[ndarray, ndarray]:
    """Return coordinates of nodes along facets and away from them, over their lengths, (n_facets,
    n_nodes).
    """
    mesh = triangles.mesh
    a, b = mesh.p[:, mesh.facets[:, facets]].transpose(1, 0, 2)
    d = b - a
    x = mesh.p[:, None, nodes] - a[:, :, None]
    square = (d**2).sum(axis=0)[:, None]
    along = (x * d[:, :, None]).sum(axis=0) / square
    return along, (d[0][:, None] * x[1] - d[1][:, None] * x[0]) / square


def _closed(triangles: Triangles, contact: Contact) -> Triangles:
    """Move the slave's nodes onto nodes of the master that nearly coincide."""
    mesh = triangles.mesh
    slave, master = (
        np.unique(mesh.facets[:, triangles.tags[tag]]) for tag in (contact.slave, contact.master)
    )
    distance, nearest = map(np.asarray, cKDTree(mesh.p[:, master].T).query(mesh.p[:, slave].T))
    size = facet_lengths(mesh)[triangles.tags[contact.slave]].min(initial=np.inf)
    near = (distance > 0) & (distance <= 2 * _SAME * size)
    if not near.any():
        return triangles
    p = mesh.p.copy()
    p[:, slave[near]] = p[:, master[nearest[near]]]
    return replace(triangles, mesh=MeshTri(p, mesh.t, validate=False))


def pairs(contact: Contact, triangles: Triangles) -> tuple[ndarray, ndarray, ndarray]:
    """Return facets of slave and master that coincide, and True where the master's run the other
    way.
    """
    mesh, one, other = triangles.mesh, triangles.tags[contact.slave], triangles.tags[contact.master]
    if not len(one) or not len(other):
        return np.zeros(0, int), np.zeros(0, int), np.zeros(0, bool)
    middle, length = mesh.p[:, mesh.facets].mean(axis=1), facet_lengths(mesh)[one]
    distance, nearest = map(np.asarray, cKDTree(middle[:, other].T).query(middle[:, one].T))
    found = distance <= 1e-9 * length
    one, other = one[found], other[nearest[found]]
    ends = mesh.p[:, mesh.facets[0, one]] - mesh.p[:, mesh.facets[0, other]]
    return one, other, np.linalg.norm(ends, axis=0) > 0.5 * length[found]


def check_closed(contacts: tuple[Contact, ...], triangles: Triangles) -> None:
    """Refuse contacts whose sides face each other, matched, at a small distance."""
    mesh = triangles.mesh
    for contact in contacts:
        one, other = (
            np.setdiff1d(triangles.tags[contact.slave], pairs(contact, triangles)[0]),
            triangles.tags[contact.master],
        )
        if not len(one) or not len(other):
            continue
        normals = [outward_normals(mesh, facets, mesh.f2t[0, facets]) for facets in (other, one)]
        a, b = mesh.p[:, mesh.facets[:, other]].transpose(1, 0, 2)
        x = mesh.p[:, mesh.facets[:, one]].mean(axis=1)[:, None] - a[:, :, None]
        along = (x * (b - a)[:, :, None]).sum(axis=0) / ((b - a) ** 2).sum(axis=0)[:, None]
        away = np.abs((x * normals[0][:, :, None]).sum(axis=0)) / facet_lengths(mesh)[one]
        near = (along > 0) & (along < 1) & (away < _GAP) & (normals[0].T @ normals[1] < -_FACING)
        if near.any():
            raise ValueError(
                f"the sides of the contact between '{contact.slave}' and '{contact.master}' are "
                f"{away[near].max():.2g} of a facet apart: bounds need sides that coincide; move "
                f"them "
                "together, or leave the contact out"
            )
