"""Lines of a mesh: those that beams follow, boundaries that their sides touch, and slits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy import ndarray
from scipy.sparse import coo_matrix, csr_matrix
from scipy.sparse.csgraph import connected_components
from skfem import CellBasis, Mesh

from ..checks import check_plane, facets_of, finite, format_point, names_of
from ..layout import elements_of
from ..mesh.check import check_topology, own_tags
from ..mesh.join import moved, owners_of, renumbered
from ..surfaces.topology import ordered

#: Distance from the side of a beam, as a share of a facet, up to which a boundary lies on it.
_NEAR = 0.1
#: Distance from the line of a beam, as a share of the ground, up to which vertices lie on it.
_ON = 1e-6
#: Difference of heights, as a share of lengths, that does not make one end the upper one.
_LEVEL = 1e-6


def nodes_of(
    basis: CellBasis | None, line: Any, cells: Any, bonded: bool | None
) -> tuple[ndarray | None, ndarray, ndarray]:
    """Return dofs of shared nodes or None, coordinates of all nodes and elements of three nodes."""
    shared, points, elements = _nodes_of(basis, line, cells, bool(bonded))
    return shared if bonded or bonded is None else None, points, elements


def _nodes_of(
    basis: CellBasis | None, line: Any, cells: Any, bonded: bool
) -> tuple[ndarray | None, ndarray, ndarray]:
    if isinstance(line, str):
        if basis is not None:
            check_plane(basis, "a beam along a named line")
        if basis is None or cells is not None:
            raise ValueError(
                f"the line '{line}' needs a basis with this name, and gives its own cells"
            )
        return line_of(basis, line)
    points = finite(line, "line")
    dims = (2, 3) if basis is None else (basis.mesh.dim(),)
    if points.ndim != 2 or points.shape[1] not in dims or len(points) < 2:
        raise ValueError(
            f"the line of a beam must be a name, or at least two points (x, y), in space (x, y, "
            f"z), not "
            f"{line!r}"
        )
    if bonded:
        if basis is None or cells is not None:
            raise ValueError(
                "a beam bonded along points needs the basis of the ground, whose edges are its "
                "elements"
            )
        return _edges_along(basis, points)
    n = len(points)
    given = (
        np.column_stack((np.arange(n - 1), np.arange(1, n))) if cells is None else np.asarray(cells)
    )
    if (
        given.ndim != 2
        or given.shape[1] not in (2, 3)
        or given.dtype.kind not in "iu"
        or not len(given)
        or given.min() < 0
        or given.max() >= n
    ):
        raise ValueError(
            f"cells of a beam must be numbers of 2 or 3 of its {n} nodes, not {cells!r}"
        )
    if given.shape[1] == 2:
        points = np.vstack((points, points[given].mean(axis=1)))
        given = np.column_stack((given, n + np.arange(len(given))))
    if len(unused := np.setdiff1d(np.arange(len(points)), given)):
        raise ValueError(
            f"the node of a beam at {format_point(points[unused[0]])} belongs to no element"
        )
    return None, points, given


def line_of(basis: CellBasis, name: str) -> tuple[ndarray, ndarray, ndarray]:
    """Return dofs of the nodes, (n, 2), coordinates and elements of a named line, on the boundary
    or inside.

    It begins at its upper end, a level one at its left end, and goes clockwise where it is closed.
    """
    mesh, facets = basis.mesh, np.unique(facets_of(basis.mesh, name))
    if len(basis.facet_dofs) != 2:
        raise ValueError(f"'{name}': beams have three nodes: take a basis of second order")
    ends = _one_way(mesh.facets[:, facets], name)
    order = ordered(ends, name)
    facets, ends = facets[order], ends[:, order]
    x, closed = mesh.p[:, ends], ends[0, 0] == ends[1, -1]
    area = (x[0, 0] * x[1, 1] - x[0, 1] * x[1, 0]).sum()
    high = x[1, 1, -1] - x[1, 0, 0], x[0, 0, 0] - x[0, 1, -1]
    if area > 0.0 if closed else (high[0] or high[1]) > 0.0:
        facets, ends = facets[::-1], ends[::-1, ::-1]
    if closed:
        top = int(np.argmax((mesh.p[1] - _LEVEL * mesh.p[0])[ends[0]]))
        facets, ends = np.roll(facets, -top), np.roll(ends, -top, axis=1)
    nodal, middle = basis.nodal_dofs[0, ends], basis.facet_dofs[0, facets]
    first, cells = np.unique(np.vstack((nodal, middle)).T, return_inverse=True)
    return first[:, None] + np.arange(2), basis.doflocs[:, first].T, cells.reshape(-1, 3)


def _edges_along(basis: CellBasis, points: ndarray) -> tuple[ndarray, ndarray, ndarray]:
    """Return dofs of the nodes, (n, dim), coordinates and elements of the edges of the mesh along a
    polyline.

    Its corners are vertices of the mesh, and so are those between two of them.
    """
    mesh, dim = basis.mesh, basis.mesh.dim()
    edges, middles = (mesh.facets, basis.facet_dofs) if dim == 2 else (mesh.edges, basis.edge_dofs)
    if len(middles) != dim:
        raise ValueError("beams have three nodes: take a basis of second order")
    chain = _vertices_along(mesh, np.unique(mesh.t[:, elements_of(basis)]), points)
    number = csr_matrix(
        (np.arange(1, edges.shape[1] + 1), np.sort(edges, axis=0)), shape=(len(mesh.p.T),) * 2
    )
    ends = np.sort(np.stack((chain[:-1], chain[1:])), axis=0)
    edge = np.asarray(number[ends[0], ends[1]]).ravel() - 1
    if (edge < 0).any():
        a, b = (format_point(mesh.p[:, chain[k]]) for k in np.argmin(edge) + np.arange(2))
        raise ValueError(
            f"the mesh has no edge between {a} and {b}: a bonded beam follows its edges"
        )
    nodal, middle = basis.nodal_dofs[0, chain], middles[0, edge]
    first, cells = np.unique(np.concatenate((nodal[:-1], nodal[1:], middle)), return_inverse=True)
    return first[:, None] + np.arange(dim), basis.doflocs[:, first].T, cells.reshape(3, -1).T


def _vertices_along(mesh: Mesh, vertices: ndarray, points: ndarray) -> ndarray:
    """Return those of some vertices that lie on a polyline, in their order."""
    x = mesh.p[:, vertices].T
    near, chain = _ON * np.ptp(x, axis=0).max(), list[int]()
    for a, b in pairwise(points):
        length = np.linalg.norm(b - a)
        s = (x - a) @ (b - a) / (length or 1.0)
        off = np.linalg.norm(x - a - s[:, None] * (b - a) / (length or 1.0), axis=1)
        found = np.flatnonzero((off < near) & (s > -near) & (s < length + near))
        found = found[np.argsort(s[found])]
        for point, end in ((a, found[:1]), (b, found[-1:])):
            distance = np.linalg.norm(x - point, axis=1)
            if not len(end) or (distance < near).sum() != 1 or distance[end[0]] > near:
                raise ValueError(
                    f"{(distance < near).sum()} vertices of the mesh lie at {format_point(point)}, "
                    f"where "
                    f"a bonded beam has a node; the nearest is at "
                    f"{format_point(x[distance.argmin()])}; "
                    "where bodies touch give the basis of one, basis.with_elements(...)"
                )
        chain += list(vertices[found[1 if chain else 0 :]])
    return np.array(chain)


def _one_way(ends: ndarray, name: str) -> ndarray:
    """Return end nodes of facets, (2, n), turned so that each facet begins where another one
    ends.
    """
    ends = ends.copy()
    at: dict[int, list[int]] = {}
    for k, pair in enumerate(ends.T):
        for node in pair.tolist():
            at.setdefault(node, []).append(k)
    if branch := next((node for node, there in at.items() if len(there) > 2), None):
        raise ValueError(f"'{name}' is no single chain: it branches at node {branch}")
    single = [node for node, there in at.items() if len(there) == 1]
    node, left = (single or list(at))[0], set(range(ends.shape[1]))
    while here := [k for k in at[node] if k in left]:
        k = here[0]
        left.discard(k)
        if ends[0, k] != node:
            ends[:, k] = ends[::-1, k]
        node = int(ends[1, k])
    if left:
        raise ValueError(
            f"'{name}' is no single chain: {len(left)} of its {ends.shape[1]} facets lie apart"
        )
    return ends


def touching(
    mesh: Mesh, boundaries: str | Sequence[str] | None, points: ndarray, half: float
) -> dict[str, int]:
    """Return boundaries and the side of beams, (m, 3, 2), on which they lie, see :func:`side_of`;
    by default all.
    """
    given = list(mesh.boundaries or {}) if boundaries is None else list(names_of(boundaries))
    sides = {name: side_of(mesh, name, points, half) for name in given}
    if boundaries is not None and (away := [name for name, side in sides.items() if side is None]):
        raise ValueError(f"{away} lie on neither side of the beam, {half:g} off its axis")
    found = {name: side for name, side in sides.items() if side is not None}
    if not found:
        raise ValueError(
            f"no boundary lies on a side of the beam, {half:g} off its axis; existing: "
            f"{', '.join(given)}"
        )
    facets = np.concatenate([np.unique(facets_of(mesh, name)) for name in found])
    if len(np.unique(facets)) < len(facets):
        raise ValueError(
            f"the boundaries {list(found)} on the sides of the beam share facets: say which ones "
            f"touch it"
        )
    return found


def side_of(mesh: Mesh, name: str, points: ndarray, half: float) -> int | None:
    """Return on which side of beams a boundary lies, 1 for the left one and -1 for the right one;
    None if on neither.

    Its facets are those of the mesh's surface whose middles lie half a thickness off the beams, (m,
    3, 2), and which face them.
    """
    facets = np.unique(facets_of(mesh, name))
    if (mesh.f2t[1, facets] >= 0).any():
        return None
    ends = mesh.p[:, mesh.facets[:, facets]].transpose(2, 1, 0)
    middle, inner = ends.mean(axis=1), mesh.p[:, mesh.t[:, mesh.f2t[0, facets]]].mean(axis=1).T
    start, end = (
        points[:, [0, 2]].reshape(-1, 2),
        points[:, [2, 1]].reshape(-1, 2),
    )  # chords of the halves
    along = end - start
    length = np.linalg.norm(along, axis=1)
    t = along / length[:, None]
    n = np.column_stack((-t[:, 1], t[:, 0]))
    offset = middle[:, None] - start
    s = np.einsum("fec,ec->fe", offset, t)
    beyond = np.maximum(np.maximum(-s, s - length), 0.0)
    nearest = np.argmin(np.abs(np.einsum("fec,ec->fe", offset, n)) + 2.0 * beyond, axis=1)
    each = np.arange(len(facets))
    away, normal = np.einsum("fc,fc->f", offset[each, nearest], n[nearest]), n[nearest]
    sides = np.sign(np.einsum("fc,fc->f", inner - middle, normal))
    near = np.abs(away - half * sides) <= _NEAR * np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    within = beyond[each, nearest] <= _NEAR * length[nearest]
    return int(sides[0]) if (near & within).all() and (sides == sides[0]).all() else None


def split_along(mesh: Mesh, name: str) -> Mesh:
    """Return a plane mesh with a slit along a named line of facets inside; ends that lie inside
    stay single.

    The sides of a line ``"wall"`` become the boundaries ``"wall|left"`` and ``"wall|right"``, or
    ``"wall|below"`` and ``"wall|above"`` if it is more level than upright. Elements keep their
    numbers, and all other tags stay.

    Raises
    ------
    ValueError
        A line with facets on the surface of the mesh, one that is no open chain, or a single facet
        inside. Closed lines separate bodies: see :func:`join_bodies`.

    Examples
    --------
    >>> from skfem import MeshTri
    >>> import skfem_contact as sc
    >>> square = MeshTri().refined(2).with_boundaries({"wall": lambda x: (x[0] == .5) & (x[1] > .4)}, False)
    >>> slit = sc.split_along(square, "wall")
    >>> slit.p.shape[1] - square.p.shape[1], list(slit.boundaries)      # two nodes are double, the tip is single
    (2, ['wall|left', 'wall|right'])
    """
    check_topology(mesh)
    line, tags = np.unique(facets_of(mesh, name)), own_tags(mesh.boundaries)
    if mesh.dim() != 2 or (n := (mesh.f2t[1, line] < 0).sum()):
        raise ValueError(
            f"'{name}' must be a line inside a plane mesh"
            + ("" if mesh.dim() != 2 else f", but {n} facets lie on its surface")
        )
    others = np.setdiff1d(np.flatnonzero(mesh.f2t[1] >= 0), line)
    here, there = (
        mesh.nelements * (mesh.t[:, e] == mesh.facets[:, None, others]).argmax(axis=1) + e
        for e in mesh.f2t[:, others]
    )  # the nodes of facets in `t` of either element
    joined = coo_matrix(
        (np.ones(here.size), (here.ravel(), there.ravel())), shape=(mesh.t.size, mesh.t.size)
    )
    fan = connected_components(joined, directed=False)[1].reshape(
        mesh.t.shape
    )  # elements round a node up to the line
    first = np.full(mesh.nvertices, mesh.t.size)
    np.minimum.at(first, mesh.t, fan)
    slit = renumbered([mesh], np.zeros(mesh.nelements, int), fan - first[mesh.t])
    if slit.nvertices == mesh.nvertices:
        raise ValueError(
            f"'{name}' has no node to double: a single facet needs an end on the surface"
        )
    sides = {f"{name}|{side}": owners for side, owners in _sides(mesh, line, name).items()}
    if known := sorted(set(sides) & set(tags)):
        raise ValueError(f"the names {known} are not unique; rename these boundaries")
    boundaries = {
        tag: moved(mesh, slit, part, owners_of(mesh, part))
        for tag, part in tags.items()
        if tag != name
    }
    boundaries |= {side: moved(mesh, slit, line, owners) for side, owners in sides.items()}
    return replace(slit, _boundaries=boundaries, _subdomains=own_tags(mesh.subdomains))


def _sides(mesh: Mesh, line: ndarray, name: str) -> dict[str, ndarray]:
    """Return the elements at the facets of an open line, by the names of its two sides."""
    ends = _one_way(mesh.facets[:, line], name)
    chain = ends[:, ordered(ends, name)]
    if chain[0, 0] == chain[1, -1]:
        raise ValueError(f"'{name}' is closed, and separates bodies: use join_bodies")
    way = mesh.p[:, chain[1, -1]] - mesh.p[:, chain[0, 0]]
    level = bool(abs(way[0]) > abs(way[1]))
    x, y = (mesh.p[:, ends[1]] - mesh.p[:, ends[0]]) * np.sign(
        way[0 if level else 1]
    )  # to the right, or upwards
    inner = mesh.p[:, mesh.t[:, mesh.f2t[0, line]]].mean(axis=1) - mesh.p[:, ends[0]]
    left = np.where(x * inner[1] > y * inner[0], *mesh.f2t[:, line])
    return dict(
        zip(
            ("above", "below") if level else ("left", "right"),
            (left, mesh.f2t[:, line].sum(axis=0) - left),
            strict=True,
        )
    )
