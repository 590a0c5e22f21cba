"""Straight triangles of some solids, their refinement, and the matching of contacts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
import scipy
from numpy import ndarray
from skfem import CellBasis, Mesh, MeshTri

from ..checks import format_point
from ..layout import centroids, facet_corners

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
    parent: ndarray  # triangle of the mesh before, (n_elements,)
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
        if parent is None:
            parent = np.arange(t.shape[1])

        def number(ends: ndarray) -> ndarray:
            """Return one number for the two ends of every facet."""
            low, high = np.sort(ends.astype(np.int64), axis=0)
            return low * mesh.nvertices + high

        known = number(mesh.facets)
        tags = {}
        for name, pair in ends.items():
            tags[name] = np.flatnonzero(np.isin(known, number(pair)))
        return cls(mesh, origin, parent, tags)

    def rooted(self) -> Triangles:
        """Return the same triangles, which are the parents of later ones."""
        return replace(self, parent=np.arange(len(self.origin)))

    def refined(self, elements: ndarray) -> Triangles:
        """Cut some triangles in four, and neighbours so that no angle becomes small.

        A facet is halved only together with the longest one of its triangle (A. Plaza, G. F. Carey,
        Applied Numerical Mathematics 32 (2000) 195-218).
        """
        sides = self.mesh.t2f
        cut = np.zeros(self.mesh.nfacets, dtype=bool)
        cut[sides[:, elements]] = True
        lengths = np.round(facet_lengths(self.mesh), _DIGITS)[sides]
        longest = np.take_along_axis(sides, lengths.argmax(axis=0)[None], 0)[0]
        missing = longest
        while missing.size:
            missing = longest[cut[sides].any(axis=0) & ~cut[longest]]
            cut[missing] = True
        return self.halved(np.flatnonzero(cut))

    def fanned(self, vertices: ndarray) -> Triangles:
        """Double the triangles around some vertices: the facets opposite to them are halved."""
        opposite = self.mesh.t2f[[1, 2, 0]]  # to corner 0 the facet (1, 2), ...
        return self.halved(np.unique(opposite[np.isin(self.mesh.t, vertices)]))

    def halved(self, facets: ndarray, points: ndarray | None = None) -> Triangles:
        """Cut facets in two, at their middles or at points (2, n), and triangles in two to four."""
        mesh = self.mesh
        if points is None:
            points = middles(mesh, facets)

        # number the new nodes, and cut the triangles
        new = np.full(mesh.nfacets, -1)
        new[facets] = mesh.nvertices + np.arange(len(facets))
        p = np.hstack([mesh.p, points])
        children, parents = _divided(p, mesh.t, new[mesh.t2f])

        # cut the facets of all names
        ends = {}
        for name, named in self.tags.items():
            a, b = mesh.facets[:, named]
            middle = new[named]
            cut = middle >= 0
            whole = np.stack([a, b])[:, ~cut]
            first = np.stack([a, middle])[:, cut]
            second = np.stack([middle, b])[:, cut]
            ends[name] = np.hstack([whole, first, second])
        return Triangles.of(p, children, self.origin[parents], ends, self.parent[parents])

    def within(self, coarse: MeshTri, parent: ndarray) -> ndarray:
        """Return the linear functions of parents in a mesh at all corners, (n_elements, 3, 3).

        The last axis has the corners of the parent.
        """
        gradient = gradients(coarse)[0][parent]  # (n_elements, 3 corners, 2)
        corners = self.mesh.p[:, self.mesh.t]  # (2, 3 corners, n_elements)
        first = coarse.p[:, coarse.t[0, parent]]
        away = corners - first[:, None]
        shares = np.einsum("eic,cve->evi", gradient, away)
        shares[..., 0] += 1.0
        return shares


def _divided(p: ndarray, t: ndarray, middle: ndarray) -> tuple[ndarray, ndarray]:
    """Return corners and parents of the parts of all triangles.

    Facets have new nodes in their middle, (3, n_elements), or -1.
    """
    # turn the corners so that of one cut facet, or of two, the first corner begins the first
    count = (middle >= 0).sum(axis=0)
    one_cut = np.argmax(middle >= 0, axis=0)
    two_cut = (np.argmin(middle, axis=0) + 1) % 3
    first = np.where(count == 1, one_cut, two_cut)
    turn = (first + np.arange(3)[:, None]) % 3
    a, b, c = np.take_along_axis(t, turn, 0)
    ab, bc, ca = np.take_along_axis(middle, turn, 0)

    # divide the quadrilateral beyond two cut facets by its shorter diagonal
    to_bc = np.linalg.norm(p[:, a] - p[:, bc], axis=0)
    to_c = np.linalg.norm(p[:, ab] - p[:, c], axis=0)
    short = np.round(to_bc - to_c, _DIGITS) <= 0
    two = count == 2
    three = count == 3
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

    # collect corners and parents of the parts
    children = [np.stack(corners)[:, which] for which, corners in parts]
    parents = [np.flatnonzero(which) for which, _ in parts]
    return np.hstack(children), np.concatenate(parents)


def facet_lengths(mesh: MeshTri) -> ndarray:
    """Return lengths of all facets."""
    a, b = mesh.p[:, mesh.facets].transpose(1, 0, 2)
    return np.linalg.norm(b - a, axis=0)


def outward_normals(mesh: MeshTri, facets: ndarray, elements: ndarray) -> ndarray:
    """Return unit normals of facets, away from one of their elements each, (2, n)."""
    a, b = facet_corners(mesh, facets).transpose(1, 0, 2)
    along = (b - a) / np.linalg.norm(b - a, axis=0)
    normal = np.stack([along[1], -along[0]])
    inward = centroids(mesh, elements) - a
    return normal * -np.sign((normal * inward).sum(axis=0))


def gradients(mesh: MeshTri) -> tuple[ndarray, ndarray]:
    """Return gradients of the linear shape functions, (n_elements, 3 corners, 2), and areas."""
    # 2 A dN_1/dx = y_2 - y_3, 2 A dN_1/dy = x_3 - x_2, and in turn for the other corners
    x, y = mesh.p[:, mesh.t]
    following = [1, 2, 0]
    last = [2, 0, 1]
    by_x = y[following] - y[last]  # (3, n_elements)
    by_y = x[last] - x[following]
    twice = by_y[2] * by_x[1] - by_y[1] * by_x[2]
    gradient = np.stack([by_x.T, by_y.T], 2) / twice[:, None, None]  # (n_elements, 3 corners, 2)
    return gradient, np.abs(twice) / 2


class Geometry(NamedTuple):
    """Triangles in coordinates of order one: x = centre + size * coordinates.

    Their `origin` counts elements of the mesh.
    """

    triangles: Triangles
    centre: ndarray
    size: float
    curved: bool


def geometry(basis: CellBasis, elements: ndarray, fixed: ndarray) -> Geometry:
    """Return triangles of some elements of a basis' mesh.

    Dofs must be held along whole facets of its boundary.
    """
    # name the facets of the boundary, held ones, and the boundaries of the mesh
    mesh = basis.mesh
    sides = mesh.t2f[:, elements]
    facets = np.unique(sides)
    count = np.bincount(sides.ravel(), minlength=mesh.nfacets)
    outer = facets[count[facets] == 1]
    tags: dict[Tag, ndarray] = {SURFACE: outer}
    for k, mask in enumerate(_held(basis, elements, outer, fixed)):
        tags["held", k] = outer[mask]
    for name, named in (mesh.boundaries or {}).items():
        named = np.unique(np.asarray(named))
        tags[name] = named[count[named] > 0]

    # number the nodes of the elements, and scale their coordinates
    corners = mesh.t[:, elements]
    nodes, t = np.unique(corners, return_inverse=True)
    t = t.reshape(corners.shape)
    p = mesh.p[:, nodes]
    low = p.min(axis=1)
    high = p.max(axis=1)
    centre = 0.5 * (low + high)
    size = float((high - low).max())
    p = (p - centre[:, None]) / size
    number = np.full(mesh.p.shape[1], -1)
    number[nodes] = np.arange(len(nodes))
    ends = {tag: number[mesh.facets[:, named]] for tag, named in tags.items()}

    # cut quadrilaterals in four triangles around their middles
    if len(t) == 4:
        middle = p.shape[1] + np.arange(len(elements))
        p = np.hstack([p, p[:, t].mean(axis=1)])
        quarters = []
        for i, j in ((0, 1), (1, 2), (2, 3), (3, 0)):
            quarters.append(np.stack([t[i], t[j], middle]))
        t = np.hstack(quarters)
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

        # refuse dofs that are held without their facet
        known = np.intersect1d(fixed, basis.dofs.element_dofs[k::2, elements])
        alone = np.setdiff1d(known, dofs[:, held[k]])
        if len(alone):
            raise ValueError(
                f"the node at {format_point(basis.doflocs[:, alone[0]])} is held in {'xy'[k]} "
                "though no facet of the boundary there is: bounds need supports along facets"
            )
    return held


def _curved(mesh: Mesh, facets: ndarray) -> bool:
    """Return True if a facet of a mesh of second order is curved."""
    if mesh.doflocs.shape[1] == mesh.nvertices:
        return False
    ends = facet_corners(mesh, facets)
    middle_dofs = mesh.dofs.facet_dofs[0, facets]
    chord_middle = ends.mean(axis=1)
    off = np.linalg.norm(mesh.doflocs[:, middle_dofs] - chord_middle, axis=0)
    length = np.linalg.norm(ends[:, 0] - ends[:, 1], axis=0)
    return bool((off > _STRAIGHT * length).any())


@dataclass(frozen=True)
class Contact:
    """Two boundaries in contact, with adhesion, friction and tensile strength."""

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
        triangles = _with_nodes(triangles, contact.slave, contact.master)
        triangles = _with_nodes(triangles, contact.master, contact.slave)
        triangles = _closed(triangles, contact)
    return triangles


def _with_nodes(triangles: Triangles, side: str, opposite: str) -> Triangles:
    """Insert the nodes of the opposite side into a side, in each facet its middlemost first."""
    while True:
        mesh = triangles.mesh
        facets = triangles.tags[side]
        nodes = np.unique(mesh.facets[:, triangles.tags[opposite]])
        along, away = _local(triangles, facets, nodes)
        inside = (along > _SAME) & (along < 1 - _SAME) & (np.abs(away) < _GAP)
        cut = inside.any(axis=1)
        if not cut.any():
            return triangles
        nearest = np.where(inside, np.abs(along - 0.5), np.inf).argmin(axis=1)
        triangles = triangles.halved(facets[cut], mesh.p[:, nodes[nearest[cut]]])


def _local(triangles: Triangles, facets: ndarray, nodes: ndarray) -> tuple[ndarray, ndarray]:
    """Return coordinates of nodes along and off facets, over their lengths, (n_facets, n_nodes)."""
    mesh = triangles.mesh
    a, b = facet_corners(mesh, facets).transpose(1, 0, 2)
    d = (b - a)[:, :, None]  # (2, n_facets, 1)
    points = mesh.p[:, None, nodes]
    x = points - a[:, :, None]  # (2, n_facets, n_nodes)
    square = (d**2).sum(axis=0)
    along = (x * d).sum(axis=0) / square
    off = (d[0] * x[1] - d[1] * x[0]) / square
    return along, off


def _closed(triangles: Triangles, contact: Contact) -> Triangles:
    """Move the slave's nodes onto nodes of the master that nearly coincide."""
    mesh = triangles.mesh
    facets = triangles.tags[contact.slave]
    slave = np.unique(mesh.facets[:, facets])
    master = np.unique(mesh.facets[:, triangles.tags[contact.master]])
    distance, nearest = closest(mesh.p[:, master], mesh.p[:, slave])
    size = facet_lengths(mesh)[facets].min(initial=np.inf)
    near = (distance > 0) & (distance <= 2 * _SAME * size)
    if not near.any():
        return triangles
    p = mesh.p.copy()
    p[:, slave[near]] = p[:, master[nearest[near]]]
    return replace(triangles, mesh=MeshTri(p, mesh.t, validate=False))


def middles(mesh: MeshTri, facets: ndarray) -> ndarray:
    """Return the middles of facets, (2, n)."""
    return np.asarray(facet_corners(mesh, facets).mean(axis=1))


def closest(among: ndarray, points: ndarray) -> tuple[ndarray, ndarray]:
    """Return distances and indices of the nearest of some points, (2, n), to others."""
    distance, nearest = scipy.spatial.cKDTree(among.T).query(points.T)
    return np.asarray(distance), np.asarray(nearest)


def pairs(contact: Contact, triangles: Triangles) -> tuple[ndarray, ndarray, ndarray]:
    """Return facets of slave and master that coincide, and True where their directions differ."""
    mesh = triangles.mesh
    slave = triangles.tags[contact.slave]
    master = triangles.tags[contact.master]
    if not len(slave) or not len(master):
        return np.zeros(0, int), np.zeros(0, int), np.zeros(0, bool)
    length = facet_lengths(mesh)[slave]
    distance, nearest = closest(middles(mesh, master), middles(mesh, slave))
    same = distance <= 1e-9 * length
    slave = slave[same]
    master = master[nearest[same]]
    first = mesh.p[:, mesh.facets[0]]  # of the two ends of all facets
    apart = np.linalg.norm(first[:, slave] - first[:, master], axis=0)
    return slave, master, apart > 0.5 * length[same]


def check_closed(contacts: tuple[Contact, ...], triangles: Triangles) -> None:
    """Refuse contacts whose sides face each other, matched, at a small distance."""
    mesh = triangles.mesh
    for contact in contacts:
        master = triangles.tags[contact.master]
        slave = np.setdiff1d(triangles.tags[contact.slave], pairs(contact, triangles)[0])
        if not len(slave) or not len(master):
            continue
        normal = outward_normals(mesh, master, mesh.f2t[0, master])
        of_slave = outward_normals(mesh, slave, mesh.f2t[0, slave])

        # middles of the slave's facets, along and off the master's, (n_master, n_slave)
        a, b = facet_corners(mesh, master).transpose(1, 0, 2)
        d = b - a
        x = middles(mesh, slave)[:, None] - a[:, :, None]  # (2, n_master, n_slave)
        square = (d**2).sum(axis=0)
        along = (x * d[:, :, None]).sum(axis=0) / square[:, None]
        off = (x * normal[:, :, None]).sum(axis=0)
        away = np.abs(off) / facet_lengths(mesh)[slave]
        facing = normal.T @ of_slave < -_FACING
        near = (along > 0) & (along < 1) & (away < _GAP) & facing
        if near.any():
            raise ValueError(
                f"the sides of the contact between '{contact.slave}' and '{contact.master}' are "
                f"{away[near].max():.2g} of a facet apart: bounds need sides that coincide; move "
                "them together, or leave the contact out"
            )
