"""Lines of a mesh that beams follow, boundaries that their sides touch, and slits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix
from skfem import CellBasis, Mesh

from ..arrays import left_of, row_norms
from ..checks import check_plane, facets_of, finite, format_point, names_of
from ..layout import centroids, elements_of, facet_corners
from ..mesh.check import check_topology, own_tags
from ..mesh.join import moved, owners_of, renumbered
from ..sparse import parts_of
from ..surfaces.topology import ordered

#: Largest distance of a boundary from the side of a beam on which it lies, in facets.
_NEAR = 0.1
#: Largest distance of vertices from the line of a beam on which they lie, as a share of the ground.
_ON = 1e-6
#: Difference of heights, as a share of lengths, that does not make one end the upper one.
_LEVEL = 1e-6


def nodes_of(
    basis: CellBasis | None,
    line: Any,
    cells: Any,
    bonded: bool | None,
) -> tuple[ndarray | None, ndarray, ndarray]:
    """Return dofs of shared nodes or None, coordinates of all nodes and elements of three nodes."""
    if isinstance(line, str):
        return _along_named(basis, line, cells, bonded)
    # A polyline has nodes of its own, or follows edges of the mesh.
    points = finite(line, "line")
    dims = (2, 3) if basis is None else (basis.mesh.dim(),)
    if points.ndim != 2 or points.shape[1] not in dims or len(points) < 2:
        raise ValueError(
            "the line of a beam must be a name, or at least two points (x, y), in space (x, y, "
            f"z), not {line!r}"
        )
    if not bonded:
        return None, *_elements_between(points, cells)
    if basis is None or cells is not None:
        raise ValueError(
            "a beam bonded along points needs the basis of the ground, whose edges are its elements"
        )
    return _edges_along(basis, points)


def _elements_between(points: ndarray, cells: Any) -> tuple[ndarray, ndarray]:
    """Return coordinates and elements of three nodes, by default of a chain of points."""
    # Elements follow the points unless they are given.
    n = len(points)
    if cells is None:
        elements = np.column_stack((np.arange(n - 1), np.arange(1, n)))
    else:
        elements = np.asarray(cells)
    # Check the numbers of nodes.
    whole = elements.dtype.kind in "iu" and elements.ndim == 2 and len(elements) > 0
    if not whole or elements.shape[1] not in (2, 3) or elements.min() < 0 or elements.max() >= n:
        raise ValueError(
            f"cells of a beam must be numbers of 2 or 3 of its {n} nodes, not {cells!r}"
        )
    # Put a node into the middle of elements of two.
    if elements.shape[1] == 2:
        points = np.vstack((points, points[elements].mean(axis=1)))
        elements = np.column_stack((elements, n + np.arange(len(elements))))
    # Every node belongs to an element.
    unused = np.setdiff1d(np.arange(len(points)), elements)
    if len(unused):
        raise ValueError(
            f"the node of a beam at {format_point(points[unused[0]])} belongs to no element"
        )
    return points, elements


def _along_named(
    basis: CellBasis | None,
    line: str,
    cells: Any,
    bonded: bool | None,
) -> tuple[ndarray | None, ndarray, ndarray]:
    """Return shared dofs, coordinates and elements along a named line of the mesh."""
    if basis is not None:
        check_plane(basis, "a beam along a named line")
    if basis is None or cells is not None:
        raise ValueError(f"the line '{line}' needs a basis with this name, and gives its own cells")
    shared, points, elements = line_of(basis, line)
    if bonded is False:
        return None, points, elements
    return shared, points, elements


def line_of(basis: CellBasis, name: str) -> tuple[ndarray, ndarray, ndarray]:
    """Return dofs of the nodes, (n, 2), coordinates and elements of a named line.

    It begins at its upper end, a level one at its left end, and goes clockwise where it is closed.
    """
    mesh = basis.mesh
    facets = np.unique(facets_of(mesh, name))
    if len(basis.facet_dofs) != 2:
        raise ValueError(f"'{name}': beams have three nodes: take a basis of second order")
    # Order the facets as one chain.
    ends = _one_way(mesh.facets[:, facets], name)
    order = ordered(ends, name)
    facets = facets[order]
    ends = ends[:, order]

    # Turn a closed line clockwise and begin at its top, an open one at its upper or left end
    x, y = mesh.p[:, ends]  # (2, n): start and end of each facet
    closed = ends[0, 0] == ends[1, -1]
    if closed:
        areas = x[0] * y[1] - x[1] * y[0]
        backward = areas.sum() > 0.0
    else:
        rise = y[1, -1] - y[0, 0]
        backward = rise > 0.0 if rise else x[0, 0] > x[1, -1]
    if backward:
        facets = facets[::-1]
        ends = ends[::-1, ::-1]
    if closed:
        height = mesh.p[1] - _LEVEL * mesh.p[0]
        top = int(np.argmax(height[ends[0]]))
        facets = np.roll(facets, -top)
        ends = np.roll(ends, -top, axis=1)
    nodal = basis.nodal_dofs[0, ends]
    return _numbered(basis, np.vstack((nodal, basis.facet_dofs[0, facets])).T)


def _edges_along(basis: CellBasis, points: ndarray) -> tuple[ndarray, ndarray, ndarray]:
    """Return dofs of the nodes, (n, dim), coordinates and elements of mesh edges on a polyline.

    Its corners are vertices of the mesh, as are all points between two elements.
    """
    mesh = basis.mesh
    dim = mesh.dim()
    # Edges of the mesh, and the dofs at their middles.
    edges = mesh.facets
    middles = basis.facet_dofs
    if dim == 3:
        edges = mesh.edges
        middles = basis.edge_dofs
    if len(middles) != dim:
        raise ValueError("beams have three nodes: take a basis of second order")
    chain = _vertices_along(mesh, np.unique(mesh.t[:, elements_of(basis)]), points)

    # Find the edges between neighbours on the chain
    n = mesh.p.shape[1]
    numbers = np.arange(1, edges.shape[1] + 1)
    number = csr_matrix((numbers, np.sort(edges, axis=0)), shape=(n, n))
    first, second = np.sort(np.stack((chain[:-1], chain[1:])), axis=0)
    edge = np.asarray(number[first, second]).ravel() - 1
    if (edge < 0).any():
        k = np.argmin(edge)
        a, b = (format_point(mesh.p[:, vertex]) for vertex in chain[k : k + 2])
        raise ValueError(
            f"the mesh has no edge between {a} and {b}: a bonded beam follows its edges"
        )
    # Elements are start, end and middle.
    nodal = basis.nodal_dofs[0, chain]
    dofs = np.stack((nodal[:-1], nodal[1:], middles[0, edge]), axis=1)
    return _numbered(basis, dofs)


def _numbered(basis: CellBasis, dofs: ndarray) -> tuple[ndarray, ndarray, ndarray]:
    """Return dofs, coordinates and elements from the first dofs of the elements' nodes, (m, 3)."""
    first, cells = np.unique(dofs, return_inverse=True)
    shared = first[:, None] + np.arange(basis.mesh.dim())
    return shared, basis.doflocs[:, first].T, cells.reshape(-1, 3)


def _vertices_along(mesh: Mesh, vertices: ndarray, points: ndarray) -> ndarray:
    """Return the vertices that lie on a polyline, in their order."""
    x = mesh.p[:, vertices].T
    near = _ON * np.ptp(x, axis=0).max()
    chain: list[int] = []
    for a, b in pairwise(points):
        # Find the vertices between both ends
        length = np.linalg.norm(b - a)
        t = (b - a) / (length or 1.0)
        s = (x - a) @ t
        off = row_norms(x - a - s[:, None] * t)
        found = np.flatnonzero((off < near) & (s > -near) & (s < length + near))
        found = found[np.argsort(s[found])]

        # Refuse ends that are no vertex, or several
        for point, end in ((a, found[:1]), (b, found[-1:])):
            distance = row_norms(x - point)
            count = (distance < near).sum()
            if not len(end) or count != 1 or distance[end[0]] > near:
                raise ValueError(
                    f"{count} vertices of the mesh lie at {format_point(point)}, where a bonded "
                    f"beam has a node; the nearest is at {format_point(x[distance.argmin()])}, "
                    f"{distance.min():.3g} away; where bodies touch give the basis of one, "
                    "basis.with_elements(...)"
                )
        chain += list(vertices[found[1 if chain else 0 :]])
    return np.array(chain)


def _one_way(ends: ndarray, name: str) -> ndarray:
    """Return end nodes of facets, (2, n), each turned to begin where another facet ends."""
    ends = ends.copy()
    # Facets that meet at each node: two at most.
    facets: dict[int, list[int]] = {}
    for k, pair in enumerate(ends.T):
        for node in pair.tolist():
            facets.setdefault(node, []).append(k)
    for node, members in facets.items():
        if len(members) > 2:
            raise ValueError(
                f"'{name}' is no single chain: it branches at node {node}; name its branches apart"
            )

    # Follow the chain from a single end, or from any node
    single = [node for node, members in facets.items() if len(members) == 1]
    node = (single or list(facets))[0]
    remaining = set(range(ends.shape[1]))
    while following := remaining.intersection(facets[node]):
        k = min(following)
        remaining.discard(k)
        if ends[0, k] != node:
            ends[:, k] = ends[::-1, k]
        node = int(ends[1, k])
    if remaining:
        raise ValueError(
            f"'{name}' is no single chain: {len(remaining)} of its {ends.shape[1]} facets lie "
            "apart; name its pieces apart, also where a slit crosses it"
        )
    return ends


def touching(
    mesh: Mesh,
    boundaries: str | Sequence[str] | None,
    points: ndarray,
    half: float,
) -> dict[str, int]:
    """Return boundaries, by default all, on a side of beams, (m, 3, 2), and which: 1 or -1."""
    # Sort boundaries by the side on which they lie.
    given = list(mesh.boundaries or {})
    if boundaries is not None:
        given = list(names_of(boundaries))
    sides: dict[str, int] = {}
    away = []
    for name in given:
        side = side_of(mesh, name, points, half)
        if side is None:
            away.append(name)
        else:
            sides[name] = side
    # Boundaries by name must lie on a side, and some boundary must.
    if boundaries is not None and away:
        raise ValueError(f"{away} lie on neither side of the beam, {half:g} off its axis")
    if not sides:
        raise ValueError(
            f"no boundary lies on a side of the beam, {half:g} off its axis; existing: "
            f"{', '.join(given)}"
        )
    # A facet lies on one side alone.
    facets = np.concatenate([np.unique(facets_of(mesh, name)) for name in sides])
    if len(np.unique(facets)) < len(facets):
        raise ValueError(
            f"the boundaries {list(sides)} on the sides of the beam share facets: say which ones "
            f"touch it"
        )
    return sides


def side_of(mesh: Mesh, name: str, points: ndarray, half: float) -> int | None:
    """Return the side of beams on which a boundary lies: 1 left, -1 right, None on neither.

    Its facets lie on the surface of the mesh and face the beams, (m, 3, 2); their middles lie half
    a thickness off the axis.
    """
    facets = np.unique(facets_of(mesh, name))
    if (mesh.f2t[1, facets] >= 0).any():
        return None
    ends = facet_corners(mesh, facets).transpose(2, 1, 0)  # (facets, 2, dim)
    middle = ends.mean(axis=1)
    owner = mesh.f2t[0, facets]
    inner = centroids(mesh, owner).T

    # Tangents t and normals n of the chords of both halves of the elements
    start = points[:, [0, 2]].reshape(-1, 2)
    end = points[:, [2, 1]].reshape(-1, 2)
    length = row_norms(end - start)
    t = (end - start) / length[:, None]
    n = left_of(t)

    # Find the nearest chord of each facet, by distances across and beyond its ends
    offset = middle[:, None] - start  # (facets, chords, 2)
    s = np.einsum("fec,ec->fe", offset, t)
    across = np.einsum("fec,ec->fe", offset, n)
    beyond = np.maximum(np.maximum(-s, s - length), 0.0)
    distance = np.abs(across) + 2.0 * beyond
    nearest = np.argmin(distance, axis=1)
    each = np.arange(len(facets))

    # Compare the distances with half a thickness, on the side on which the ground lies
    normal = n[nearest]
    away = np.einsum("fc,fc->f", offset[each, nearest], normal)
    sides = np.sign(np.einsum("fc,fc->f", inner - middle, normal))
    size = row_norms(ends[:, 1] - ends[:, 0])
    near = np.abs(away - half * sides) <= _NEAR * size
    within = beyond[each, nearest] <= _NEAR * length[nearest]
    one_side = sides == sides[0]
    if (near & within & one_side).all():
        return int(sides[0])
    return None


def split_along(mesh: Mesh, name: str) -> Mesh:
    """Return a plane mesh with a slit along a named line inside; inner ends stay single.

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
    >>> wall = {"wall": lambda x: (x[0] == .5) & (x[1] > .4)}
    >>> square = MeshTri().refined(2).with_boundaries(wall, False)
    >>> slit = sc.split_along(square, "wall")

    Two nodes are double, the tip is single:

    >>> slit.p.shape[1] - square.p.shape[1], list(slit.boundaries)
    (2, ['wall|left', 'wall|right'])
    """
    check_topology(mesh)
    line = np.unique(facets_of(mesh, name))
    if mesh.dim() != 2:
        raise ValueError(f"'{name}' must be a line inside a plane mesh")
    on_surface = (mesh.f2t[1, line] < 0).sum()
    if on_surface:
        raise ValueError(
            f"'{name}' must be a line inside a plane mesh, but {on_surface} facets lie on its "
            "surface"
        )

    # Join the corners of elements across all other facets: fans round a node up to the line
    others = np.setdiff1d(np.flatnonzero(mesh.f2t[1] >= 0), line)
    first, second = (
        mesh.nelements * (mesh.t[:, element] == mesh.facets[:, None, others]).argmax(axis=1)
        + element
        for element in mesh.f2t[:, others]
    )
    size = mesh.t.size
    fan = parts_of(size, first, second).reshape(mesh.t.shape)

    # Give every further fan of a node a copy of it
    lowest = np.full(mesh.nvertices, size)
    np.minimum.at(lowest, mesh.t, fan)
    slit = renumbered([mesh], np.zeros(mesh.nelements, int), fan - lowest[mesh.t])
    if slit.nvertices == mesh.nvertices:
        raise ValueError(
            f"'{name}' has no node to double: a single facet needs an end on the surface"
        )

    # Name both sides
    sides = {f"{name}|{side}": owners for side, owners in _sides(mesh, line, name).items()}
    tags = own_tags(mesh.boundaries)
    known = sorted(sides.keys() & tags.keys())
    if known:
        raise ValueError(f"the names {known} are not unique; rename these boundaries")
    tags.pop(name, None)
    boundaries = {}
    for tag, part in tags.items():
        boundaries[tag] = moved(mesh, slit, part, owners_of(mesh, part))
    boundaries |= {side: moved(mesh, slit, line, owners) for side, owners in sides.items()}
    return replace(slit, _boundaries=boundaries, _subdomains=own_tags(mesh.subdomains))


def _sides(mesh: Mesh, line: ndarray, name: str) -> dict[str, ndarray]:
    """Return the elements at the facets of an open line, by the names of its two sides."""
    ends = _one_way(mesh.facets[:, line], name)
    chain = ends[:, ordered(ends, name)]
    if chain[0, 0] == chain[1, -1]:
        raise ValueError(f"'{name}' is closed, and separates bodies: use join_bodies")

    # Turn the facets to the right, or upwards
    first_node = mesh.p[:, chain[0, 0]]
    last_node = mesh.p[:, chain[1, -1]]
    dx, dy = last_node - first_node
    start, end = mesh.p[:, ends].swapaxes(0, 1)
    along = end - start
    level = bool(abs(dx) > abs(dy))
    if level:
        along *= np.sign(dx)
    else:
        along *= np.sign(dy)

    # Find the elements on their left
    first, second = mesh.f2t[:, line]
    inner = centroids(mesh, first) - start
    first_is_left = along[0] * inner[1] > along[1] * inner[0]
    left = np.where(first_is_left, first, second)
    right = np.where(first_is_left, second, first)
    if level:
        return {"above": left, "below": right}
    return {"left": left, "right": right}
