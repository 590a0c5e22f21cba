"""Connections of elements: hanging nodes, sides on each other, bodies that share nodes alone."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from skfem import Mesh

from ..arrays import cross_in_plane, row_norms
from ..sparse import parts_of

Indices = NDArray[np.integer]
Floats = NDArray[np.float64]

#: Distance of a node from a side, over the size of the side, up to which it lies on the side.
_ON = 1e-6
#: Number of the nearest sides among which the side below the middle of another one is sought, by
#: dimension: of smaller sides around that point at most so many are nearer than the right one.
_NEAREST = {2: 6, 3: 14}


class Outside(NamedTuple):
    """Outer sides of a mesh.

    Attributes
    ----------
    facets
        Numbers of the facets, (n,).
    nodes
        Numbers of their corners, (n, corners).
    corners
        Coordinates of the corners, which go round, (n, corners, dim).
    size
        Largest distance of a corner from the middle, (n,).
    """

    facets: Indices
    nodes: Indices
    corners: Floats
    size: Floats

    def part(self, chosen: NDArray[np.bool_]) -> Outside:
        """Return some of the sides."""
        return Outside(
            self.facets[chosen], self.nodes[chosen], self.corners[chosen], self.size[chosen]
        )

    @property
    def middles(self) -> Floats:
        """Middles of the sides, (n, dim)."""
        return np.asarray(self.corners.mean(axis=1))


def outside_of(mesh: Mesh) -> Outside:
    """Return the outer sides of a mesh."""
    facets = mesh.boundary_facets()
    # Take the corners from the elements, where the corners of quadrilaterals go round
    element = mesh.f2t[0, facets]
    local = np.argmax(mesh.t2f[:, element] == facets, axis=0)
    sides = np.array(mesh.elem.refdom.facets)
    nodes = mesh.t[sides[local].T, element].T
    corners = mesh.p.T[nodes]
    offset = corners - corners.mean(axis=1, keepdims=True)
    size = np.linalg.norm(offset, axis=2).max(axis=1)
    return Outside(facets, nodes, corners, size)


def lies_on(points: Floats, corners: Floats, size: Floats) -> NDArray[np.bool_]:
    """Return True for points, (n, dim), that lie on the sides with these corners.

    Points of a segment or a convex polygon have all of its edges on the same hand.
    """
    near = _ON * size
    if points.shape[1] == 2:
        along = corners[:, 1] - corners[:, 0]
        length = row_norms(along)
        from_first = points - corners[:, 0]
        position = (from_first * along).sum(axis=1) / length
        area = cross_in_plane(from_first, along)
        off = np.abs(area) / length
        between = (position >= -near) & (position <= length + near)
        return (off <= near) & between

    # Find the normal from the diagonals, and the distance from every edge
    k = corners.shape[1]
    to_next = corners[:, 1] - corners[:, 0]
    to_last = corners[:, k - 1] - corners[:, 0]
    normal = np.cross(to_next, to_last)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    from_middle = points - corners.mean(axis=1)
    off = (from_middle * normal).sum(axis=1)
    inside = np.abs(off) <= near
    for a in range(k):
        edge = corners[:, (a + 1) % k] - corners[:, a]
        inward = np.cross(normal, edge)
        inward /= np.linalg.norm(inward, axis=1, keepdims=True)
        distance = ((points - corners[:, a]) * inward).sum(axis=1)
        inside &= distance >= -near
    return inside


def hanging_nodes(outside: Outside, points: Floats) -> Indices:
    """Return nodes within outer sides that smaller sides with the same corners cover.

    A node inside a side hangs if smaller sides of the mesh lie on that side and have all of its
    corners.  Bodies with other nodes, and both sides of a slit, may lie on each other.
    """
    node, side = _nodes_on_sides(outside, points)
    if len(node) == 0:
        return node

    # Gather the nodes of every such side: its corners, and the nodes on it
    sides = np.unique(side)
    own = outside.nodes[sides]
    count = outside.nodes.max() + 1
    of_corners = sides[:, None] * count + own
    of_side = np.concatenate((side * count + node, of_corners.ravel()))
    of_side = np.unique(of_side)

    # Find smaller sides around each node all of whose corners are among these nodes
    link = _incidence(outside, count)
    pair, smaller = link[node].nonzero()  # link: (nodes, sides)
    other = side[pair]
    wanted = other[:, None] * count + outside.nodes[smaller]
    within = np.isin(wanted, of_side).all(axis=1)
    within &= smaller != other
    covered = np.unique(other[within, None] * count + outside.nodes[smaller[within]])
    complete = np.isin(sides[:, None] * count + own, covered).all(axis=1)
    return np.unique(node[np.isin(side, sides[complete])])


def _nodes_on_sides(outside: Outside, points: Floats) -> tuple[Indices, Indices]:
    """Return pairs of outer nodes and of the sides on which they lie without being its corners."""
    nodes = np.unique(outside.nodes)
    tree = scipy.spatial.cKDTree(points[nodes])
    near = tree.query_ball_point(outside.middles, outside.size * (1.0 - _ON))
    counts = np.array([len(found) for found in near])
    side = np.repeat(np.arange(len(near)), counts)
    if len(side) == 0:
        return side, side
    node = nodes[np.concatenate([np.asarray(found, dtype=int) for found in near])]
    strange = (outside.nodes[side] != node[:, None]).all(axis=1)
    side = side[strange]
    node = node[strange]
    on = lies_on(points[node], outside.corners[side], outside.size[side])
    return node[on], side[on]


def _incidence(outside: Outside, count: int) -> Any:
    """Return the sides at every node, (count, n)."""
    side = np.repeat(np.arange(len(outside.nodes)), outside.nodes.shape[1])
    entries = (np.ones(side.size, dtype=bool), (outside.nodes.ravel(), side))
    return coo_matrix(entries, shape=(count, len(outside.nodes))).tocsr()


def touching_sides(outside: Outside) -> tuple[Indices, Indices]:
    """Return pairs of outer sides, by their numbers in `outside`, that lie on each other.

    The middle of the first lies on the second, and they have other nodes.
    """
    dim = outside.corners.shape[2]
    middles = outside.middles
    count = min(_NEAREST[dim], len(middles))
    if count < 2:
        return np.zeros(0, int), np.zeros(0, int)
    nearest = scipy.spatial.cKDTree(middles).query(middles, k=count)[1]
    first = np.repeat(np.arange(len(middles)), count)
    second = nearest.ravel()
    # Leave out the side itself, and neighbours, whose size does not reach so far
    distance = row_norms(middles[first] - middles[second])
    possible = (first != second) & (distance <= outside.size[second] * (1.0 + _ON))
    first = first[possible]
    second = second[possible]
    on = lies_on(middles[first], outside.corners[second], outside.size[second])
    return first[on], second[on]


def doubled_elements(mesh: Mesh) -> Indices:
    """Return elements whose middle is the middle of another element.

    Middles that coincide follow each other when they are sorted along a skew direction.
    """
    middles = mesh.p[:, mesh.t].mean(axis=1)
    direction = np.array([0.8164965809, 0.5077905134, 0.2748934512])[: len(middles)]
    position = direction @ middles
    order = np.argsort(position)
    gap = np.diff(position[order])
    size = np.linalg.norm(np.ptp(mesh.p, axis=1)) / mesh.nelements
    near = np.flatnonzero(gap <= _ON * size)
    first = order[near]
    second = order[near + 1]
    apart = np.linalg.norm(middles[:, first] - middles[:, second], axis=0)
    corners = mesh.p[:, mesh.t[:, first]]
    extent = np.ptp(corners, axis=1).max(axis=0)
    same = apart <= _ON * extent
    return np.unique(np.concatenate((first[same], second[same])))


def loose_links(mesh: Mesh) -> Indices:
    """Return nodes by which alone parts of the mesh are connected, which share no side at them."""
    by_side = components(mesh.t2f, mesh.nfacets)
    # A node between parts has elements of at least two of them
    lowest = np.full(mesh.nvertices, by_side.max() + 1)
    highest = np.full(mesh.nvertices, -1)
    for nodes in mesh.t:
        np.minimum.at(lowest, nodes, by_side)
        np.maximum.at(highest, nodes, by_side)
    return np.flatnonzero(highest > lowest)


def components(parts: Indices, count: int) -> Indices:
    """Return the number of the connected component of every element, (n_elements,)."""
    n_elements = parts.shape[1]
    element = np.tile(np.arange(n_elements), (len(parts), 1))
    label = parts_of(n_elements + count, element, n_elements + parts)
    return np.unique(label[:n_elements], return_inverse=True)[1]
