"""New triangles of deformed bodies: their outline as chains with names, and Gmsh's mesh in it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
import scipy
from numpy import ndarray
from skfem import Mesh, MeshTri, MeshTri2

from ..arrays import cross_in_plane, row_norms
from ..checks import format_point
from ..layout import centroids
from ..sparse import parts_of
from .kernel import gmsh_model, nodes_of
from .outline import turn

#: Size of elements at coordinates (2, n): (n,).
SizeField = Callable[[ndarray], ndarray]
#: Angle in degrees between two sides, from which on their node stays.
_CORNER = 30.0
#: Points of a chain at which sizes are taken, for each of its nodes.
_SAMPLES = 8


class Chain(NamedTuple):
    """Curve through nodes of the old mesh, between two corners or closed.

    Attributes
    ----------
    points : ndarray, shape (n, 2)
        Displaced nodes in their order; the last one of a closed chain is the first one.
    ends : tuple of int
        Numbers of the vertices at both ends.
    names : tuple of str
        Boundaries that it belongs to.
    left, right : int
        Parts on both sides; -1 outside.
    """

    points: ndarray
    ends: tuple[int, int]
    names: tuple[str, ...]
    left: int
    right: int

    @property
    def closed(self) -> bool:
        """True if both ends are one vertex."""
        return self.ends[0] == self.ends[1]


@dataclass(frozen=True)
class Outline:
    """Outlines of the parts of deformed bodies.

    Attributes
    ----------
    chains : list of Chain
        Curves between the parts and around them.
    names : list of tuple of str
        Subdomains of each part.
    """

    chains: list[Chain]
    names: list[tuple[str, ...]]


def outline(mesh: Mesh, elements: ndarray, vertices: ndarray, middles: ndarray | None) -> Outline:
    """Return the outlines of some elements of a mesh in the plane.

    Parameters
    ----------
    elements : ndarray
        Numbers of the elements.
    vertices : ndarray, shape (2, n_vertices)
        Displaced vertices.
    middles : ndarray, shape (2, n_facets), optional
        Displaced middles of the facets, of elements of second order.
    """
    # Divide the elements into connected parts of the same subdomains
    names = _names_of(mesh.nelements, mesh.subdomains)
    active = np.zeros(mesh.nelements, bool)
    active[elements] = True
    first, second = mesh.f2t
    inside = (second >= 0) & active[first] & active[second]
    of_facets = _names_of(mesh.facets.shape[1], mesh.boundaries)
    same = np.array([names[a] == names[b] for a, b in zip(first, second)])
    joined = np.flatnonzero(inside & same)
    number = parts_of(mesh.nelements, first[joined], second[joined])
    part = np.full(mesh.nelements, -1)
    _, part[active] = np.unique(number[active], return_inverse=True)
    subdomains: list[tuple[str, ...]] = [()] * (part.max() + 1)
    for element in np.flatnonzero(active):
        subdomains[part[element]] = names[element]

    # Find the facets between parts, and those with a name
    beyond = np.where(second >= 0, part[second], -1)
    sides = np.stack((part[first], beyond))
    named = np.array([len(name) > 0 for name in of_facets])
    kept = (sides[0] != sides[1]) | (named & inside)
    of_parts = (sides >= 0).any(axis=0)
    facets = np.flatnonzero(kept & of_parts)
    ways: list[tuple[int, ...]] = []
    labels = []
    for facet in facets:
        way = _directed(mesh, int(facet), sides[:, facet])
        ways.append(way)
        labels.append((of_facets[facet], way[2], way[3]))

    # Follow the runs of facets from vertex to vertex
    chains = []
    for run in _runs(ways, labels, vertices):
        start = ways[run[0]][0]
        points = [vertices[:, start]]
        for k in run:
            if middles is not None:
                points.append(middles[:, facets[k]])
            end = ways[k][1]
            points.append(vertices[:, end])
        names_of_run, left, right = labels[run[0]]
        chains.append(Chain(np.array(points), (start, end), names_of_run, left, right))
    return Outline(chains, subdomains)


def _names_of(n: int, groups: Any) -> list[tuple[str, ...]]:
    """Return the names of the groups that each of n members belongs to."""
    found: list[list[str]] = [[] for _ in range(n)]
    for name, members in sorted((groups or {}).items()):
        for member in np.asarray(members):
            found[member].append(name)
    return [tuple(names) for names in found]


def _directed(mesh: Mesh, facet: int, sides: ndarray) -> tuple[int, ...]:
    """Return start and end of a facet in the plane, and the parts on its left and right."""
    a, b = (int(vertex) for vertex in mesh.facets[:, facet])
    element = mesh.f2t[0, facet]
    centre = centroids(mesh, element)
    along = mesh.p[:, b] - mesh.p[:, a]
    aside = centre - mesh.p[:, a]
    is_left = bool(cross_in_plane(along, aside) > 0)
    left, right = (int(side) for side in (sides if is_left else sides[::-1]))
    # Facets of one outline have the same direction: the smaller part, or the outside, at the right
    if left < right:
        return b, a, right, left
    return a, b, left, right


def _runs(
    ways: list[tuple[int, ...]], labels: list[tuple[tuple[str, ...], int, int]], vertices: ndarray
) -> list[list[int]]:
    """Return facets in chains: they follow each other with the same label and without a corner."""
    after = _followers(ways, labels, vertices)
    begins = np.setdiff1d(np.arange(len(ways)), [k for k in after if k is not None])
    runs = []
    done: set[int] = set()
    # Chains with a beginning, then closed ones
    for start in [*begins.tolist(), *range(len(ways))]:
        run = []
        k: int | None = start
        while k is not None and k not in done:
            run.append(k)
            done.add(k)
            k = after[k]
        if run:
            runs.append(run)
    return runs


def _followers(
    ways: list[tuple[int, ...]], labels: list[tuple[tuple[str, ...], int, int]], vertices: ndarray
) -> list[int | None]:
    """Return the facet that continues the chain after each facet, None where it ends."""
    # Collect the facets at each node.
    leaving: dict[int, list[int]] = {}
    arriving: dict[int, list[int]] = {}
    for k, way in enumerate(ways):
        leaving.setdefault(way[0], []).append(k)
        arriving.setdefault(way[1], []).append(k)
    result: list[int | None] = []
    for k, way in enumerate(ways):
        node = way[1]
        next_ones = leaving.get(node, [])
        result.append(None)
        # A chain continues where one facet of the same label follows.
        alone = len(next_ones) == 1 and len(arriving[node]) == 1
        if not alone or labels[next_ones[0]] != labels[k]:
            continue
        # It ends at corners.
        first = vertices[:, node] - vertices[:, way[0]]
        second = vertices[:, ways[next_ones[0]][1]] - vertices[:, node]
        angle = np.degrees(turn(first, second))
        if abs(angle) < _CORNER:
            result[-1] = next_ones[0]
    return result


def triangles(shape: Outline, size: SizeField, order: int) -> Mesh:
    """Return triangles of the first or second order in outlines, with their names.

    Raises
    ------
    ValueError
        An outline that crosses itself, or that Gmsh cannot mesh.
    """
    new = [_resampled(chain, size) for chain in shape.chains]
    _check_crossings(new)
    try:
        x, cells, part = _of_gmsh(shape, new, size)
    except ValueError:
        raise
    except Exception as error:  # Gmsh raises plain exceptions
        raise ValueError(
            f"Gmsh cannot mesh the deformed bodies ({error}): take new meshes earlier, or smaller "
            "elements"
        ) from error

    # Number the vertices that elements have, and find the facets of the chains by coordinates
    used = np.unique(cells)
    number = np.full(len(x), -1)
    number[used] = np.arange(len(used))
    mesh = MeshTri(np.ascontiguousarray(x[used].T), number[cells.T])
    boundaries, middles = _facets_of_chains(mesh, shape, new, number)
    subdomains: dict[str, list[int]] = {}
    for k, names in enumerate(shape.names):
        for name in names:
            subdomains.setdefault(name, []).extend(np.flatnonzero(part == k))
    if order == 2:
        curved = MeshTri2.from_mesh(mesh)
        places = curved.doflocs.copy()
        for facet, point in middles.items():
            places[:, curved.dofs.facet_dofs[0, facet]] = point
        mesh = MeshTri2(places, curved.t)
        _check_curved(mesh)
    groups = {name: np.array(members) for name, members in subdomains.items()}
    return mesh.with_subdomains(groups).with_boundaries(boundaries)


class _Resampled(NamedTuple):
    """New vertices of a chain, (n + 1, 2), and middles between them, (n, 2)."""

    vertices: ndarray
    middles: ndarray


def _resampled(chain: Chain, size: SizeField) -> _Resampled:
    """Return new vertices on a smooth curve through the nodes of a chain, by the sizes there."""
    # Put a smooth curve through the nodes by the lengths between them
    points = chain.points
    sides = row_norms(np.diff(points, axis=0))
    s = np.concatenate(([0.0], np.cumsum(sides)))
    curve = _curve(s, points, chain.closed)

    # Divide it evenly in terms of the sizes
    fine = np.linspace(0.0, s[-1], _SAMPLES * len(points) + 1)
    density = 1.0 / np.asarray(size(curve(fine).T))
    steps = 0.5 * (density[1:] + density[:-1]) * np.diff(fine)
    count = np.concatenate(([0.0], np.cumsum(steps)))
    least = 3 if chain.closed else 1
    n = max(least, round(float(count[-1])))
    wanted = np.arange(2 * n + 1) * count[-1] / (2 * n)
    new = curve(np.interp(wanted, count, fine))
    new[0] = points[0]
    new[-1] = points[-1]
    return _Resampled(new[0::2], new[1::2])


def _curve(s: ndarray, points: ndarray, closed: bool) -> Callable[[ndarray], ndarray]:
    """Return the cubic spline through points (n, 2) at lengths s; a straight line through two."""
    if len(points) > 3:
        spline = scipy.interpolate.CubicSpline(
            s, points, bc_type="periodic" if closed else "not-a-knot"
        )
        return lambda at: np.asarray(spline(at))
    return lambda at: np.stack([np.interp(at, s, values) for values in points.T], axis=1)


def _check_crossings(chains: list[_Resampled]) -> None:
    """Refuse chains that cross themselves: a fold that has passed through itself."""
    for chain in chains:
        a = chain.vertices[:-1]
        b = chain.vertices[1:]
        along = b - a
        offset = a[None] - a[:, None]  # from segment i to segment j, (n, n, 2)
        bent = cross_in_plane(along[:, None], along[None])
        with np.errstate(divide="ignore", invalid="ignore"):
            own = cross_in_plane(offset, along[None]) / bent
            other = cross_in_plane(offset, along[:, None]) / bent
        inside = (own > 0.0) & (own < 1.0) & (other > 0.0) & (other < 1.0)
        n = len(a)
        apart = np.abs(np.subtract.outer(np.arange(n), np.arange(n)))
        inside &= (apart > 1) & (apart < n - 1)
        if inside.any():
            i = int(np.argwhere(inside)[0, 0])
            raise ValueError(
                f"the outline of the deformed bodies crosses itself near {format_point(a[i])}: it "
                "has no mesh; take contact of the boundary with itself, or stop before"
            )


def _numbered(shape: Outline, new: list[_Resampled]) -> tuple[ndarray, list[ndarray]]:
    """Return coordinates (n, 2) of all vertices on chains, and their numbers by chain."""
    ends: dict[int, int] = {}
    points: list[ndarray] = []
    rows = []
    for chain, part in zip(shape.chains, new):
        for vertex, at in zip(chain.ends, part.vertices[[0, -1]]):
            if vertex not in ends:
                ends[vertex] = len(points)
                points.append(at)
        first = len(points)
        points.extend(part.vertices[1:-1])
        inner = np.arange(first, len(points))
        rows.append(np.concatenate(([ends[chain.ends[0]]], inner, [ends[chain.ends[1]]])))
    return np.array(points), rows


def _of_gmsh(
    shape: Outline, new: list[_Resampled], size: SizeField
) -> tuple[ndarray, ndarray, ndarray]:
    """Return coordinates (n, 2), elements (m, 3) and their parts (m,) of Gmsh's triangles.

    The first coordinates are the vertices of the chains.
    """
    points, rows = _numbered(shape, new)
    with gmsh_model() as gmsh:
        geo = gmsh.model.geo
        # Add every side of the chains as a line of one element
        tags = np.array([geo.addPoint(x, y, 0.0) for x, y in points])
        lines = []
        for row in rows:
            lines.append([geo.addLine(a, b) for a, b in pairwise(tags[row])])

        # Add the faces of the parts
        faces = []
        for part in range(len(shape.names)):
            loops = []
            for loop in _loops(shape.chains, new, part):
                loops.append(geo.addCurveLoop(_signed(lines, loop)))
            faces.append(geo.addPlaneSurface(loops))
        geo.synchronize()
        _prepare(gmsh, shape.chains, lines, faces)
        gmsh.model.mesh.setSizeCallback(
            lambda dim, tag, x, y, z, lc: float(size(np.array([[x], [y]]))[0])
        )
        gmsh.model.mesh.generate(2)
        return _elements(gmsh, faces)


def _prepare(gmsh: Any, chains: list[Chain], lines: list[list[int]], faces: list[int]) -> None:
    """Keep the sides of chains undivided, and put chains inside of a part into its face."""
    for group in lines:
        for line in group:
            gmsh.model.mesh.setTransfiniteCurve(line, 2)
    for chain, group in zip(chains, lines):
        if chain.left == chain.right:
            gmsh.model.mesh.embed(1, group, 2, faces[chain.left])


def _elements(gmsh: Any, faces: list[int]) -> tuple[ndarray, ndarray, ndarray]:
    """Return coordinates, elements and their parts of the current mesh."""
    coordinates, row = nodes_of(gmsh)
    cells = []
    part_of = []
    for part, face in enumerate(faces):
        nodes = gmsh.model.mesh.getElementsByType(2, face)[1]
        cells.append(row[nodes.astype(int)].reshape(-1, 3))
        part_of.append(np.full(len(cells[-1]), part))
    return coordinates, np.vstack(cells), np.concatenate(part_of)


def _signed(lines: list[list[int]], loop: list[tuple[int, int]]) -> list[int]:
    """Return Gmsh's lines of a loop of chains (number, sign), negative against their direction."""
    result = []
    for chain, sign in loop:
        result += [sign * line for line in lines[chain][::sign]]
    return result


def _loops(chains: list[Chain], new: list[_Resampled], part: int) -> list[list[tuple[int, int]]]:
    """Return loops of chains (number, sign) around a part, the outer one first."""
    # List the chains around the part by the vertices at which they begin, with it on their left
    leaving: dict[int, list[tuple[int, int]]] = {}
    for k, chain in enumerate(chains):
        if chain.left == chain.right or part not in (chain.left, chain.right):
            continue
        sign = -1
        if chain.left == part:
            sign = 1
        leaving.setdefault(chain.ends[::sign][0], []).append((k, sign))

    # Follow them until all are in a loop
    loops = []
    areas = []
    while any(leaving.values()):
        start = next(vertex for vertex, left in leaving.items() if left)
        loop = [leaving[start].pop()]
        at = _end(chains, loop[-1])
        while at != start:
            loop.append(leaving[at].pop())
            at = _end(chains, loop[-1])
        pieces = [new[k].vertices[::sign][:-1] for k, sign in loop]
        points = np.concatenate(pieces)
        loops.append(loop)
        following = np.roll(points, -1, axis=0)
        areas.append(0.5 * cross_in_plane(points, following).sum())
    return [loops[k] for k in np.argsort(areas)[::-1]]


def _end(chains: list[Chain], way: tuple[int, int]) -> int:
    """Return the vertex at the end of a chain (number, sign)."""
    number, sign = way
    return chains[number].ends[::sign][1]


def _facets_of_chains(
    mesh: Mesh,
    shape: Outline,
    new: list[_Resampled],
    number: ndarray,
) -> tuple[dict[str, ndarray], dict[int, ndarray]]:
    """Return facets by the names of chains, and the middles of the facets on chains."""
    # Gmsh numbers points in the order in which they were added
    _, rows = _numbered(shape, new)
    n = mesh.nvertices
    key = mesh.facets.min(axis=0) * n + mesh.facets.max(axis=0)
    order = np.argsort(key)
    boundaries: dict[str, list[ndarray]] = {}
    middles: dict[int, ndarray] = {}
    for chain, part, row in zip(shape.chains, new, rows):
        nodes = number[row]
        low = np.minimum(nodes[:-1], nodes[1:])
        high = np.maximum(nodes[:-1], nodes[1:])
        position = np.searchsorted(key, low * n + high, sorter=order).clip(max=len(key) - 1)
        facets = order[position]
        if (key[facets] != low * n + high).any():
            raise ValueError(
                "Gmsh has divided the outline of the deformed bodies: its elements are too "
                "distorted; take new meshes earlier"
            )
        middles.update(zip(facets.tolist(), part.middles))
        for name in chain.names:
            boundaries.setdefault(name, []).append(facets)
    return {name: np.unique(np.concatenate(f)) for name, f in boundaries.items()}, middles


def _check_curved(mesh: MeshTri2) -> None:
    """Refuse curved triangles that fold over."""
    mapping = mesh.mapping()
    corners = np.array([[0.0, 1.0, 0.0, 0.5, 0.5, 0.0], [0.0, 0.0, 1.0, 0.0, 0.5, 0.5]])
    J = mapping.detDF(corners)
    largest = J.max(axis=1)
    bad = (J.min(axis=1) <= 0.05 * largest) & (largest > 0)
    turned = np.sign(J[:, 0])[:, None] * J <= 0
    bad |= turned.any(axis=1)
    if bad.any():
        element = np.flatnonzero(bad)[0]
        at = centroids(mesh, element)
        raise ValueError(
            f"curved triangles fold over near {format_point(at)}, where the outline bends within "
            "an element: take smaller elements there, or order=1"
        )
