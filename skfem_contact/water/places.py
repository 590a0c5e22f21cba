"""A field of the nodes between them: its values at any place, and the lines along which it changes its sign."""
from __future__ import annotations

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components, depth_first_order
from scipy.spatial import cKDTree
from skfem import Mesh

from ..checks import place

#: Corners of the triangles of a quadrilateral and of the tetrahedra of a hexahedron, as in scikit-fem.
_PARTS = {(2, 3): ((0, 1, 2),), (2, 4): ((0, 1, 3), (1, 2, 3)), (3, 4): ((0, 1, 2, 3),),
          (3, 8): ((0, 1, 3, 4), (0, 3, 2, 4), (2, 3, 4, 6), (3, 4, 6, 7), (3, 4, 5, 7), (1, 3, 4, 5))}
#: So far outside of an element, in its own size, a place is inside by round-off; and so far beside its straight sides
#: where the sides of the mesh are curved.
_ROUND_OFF, _CURVED = 1e-9, 0.1
#: Elements that are tried, those with the nearest centres first: graded meshes have many near ones.
_TRIED = (8, 64, 512)


def simplices(mesh: Mesh, elements: ndarray) -> ndarray:
    """Triangles or tetrahedra that elements consist of, (dim + 1, n)."""
    t = mesh.t[:, elements]
    return np.hstack([t[list(part)] for part in _PARTS[mesh.dim(), len(t)]])


class Interpolation:
    """A field of the nodes, linear on the triangles or tetrahedra that the elements consist of."""

    def __init__(self, mesh: Mesh, elements: ndarray, values: ndarray) -> None:
        self._values, self._corners = values, simplices(mesh, elements)
        p = mesh.p[:, self._corners]
        self._origin = p[:, 0]
        self._inverse = np.linalg.inv((p[:, 1:] - p[:, :1]).transpose(2, 0, 1))
        self._tree = cKDTree(p.mean(axis=1).T)

    def __call__(self, x: ndarray) -> ndarray:
        """Values at places (dim, ...); ValueError for one that lies outside."""
        points = x.reshape(len(x), -1)
        result, lost = np.empty(points.shape[1]), np.arange(points.shape[1])
        for tried in (*(n for n in _TRIED if n < len(self._inverse)), len(self._inverse)):
            outside, values = self._among(points[:, lost], tried)
            found = outside <= (_ROUND_OFF if tried < _TRIED[-1] and tried < len(self._inverse) else _CURVED)
            result[lost[found]] = values[found]
            lost = lost[~found]
            if len(lost) == 0:
                return result.reshape(x.shape[1:])
        raise ValueError(f"{len(lost)} places lie outside of the porous ground, "
                         f"the first is {place(points[:, lost[0]])}")

    def _among(self, x: ndarray, tried: int) -> tuple[ndarray, ndarray]:
        """How far places lie outside of the best of the elements with the nearest centres, and the values there."""
        near = self._tree.query(x.T, tried)[1].reshape(x.shape[1], -1)
        outside, values = np.full(x.shape[1], np.inf), np.empty(x.shape[1])
        for candidate in near.T:
            local = np.einsum("nij,jn->in", self._inverse[candidate], x - self._origin[:, candidate])
            weights = np.vstack((1.0 - local.sum(axis=0), local))
            better = -weights.min(axis=0) < outside
            outside[better] = -weights.min(axis=0)[better]
            values[better] = (weights * self._values[self._corners[:, candidate]]).sum(axis=0)[better]
        return outside, values


def zero_lines(mesh: Mesh, elements: ndarray, values: ndarray) -> list[ndarray]:
    """Polylines between nodes of negative and of other values, (n, 2) each, the longest first, from left to right.

    The field is linear in triangles; quadrilaterals are two of them. A closed line ends where it begins.
    """
    if mesh.dim() != 2:
        raise ValueError("a free surface is a line in plane flow only")
    corners = simplices(mesh, elements)
    negative = values < 0.0
    a, b, c = corners[:, negative[corners].any(axis=0) & ~negative[corners].all(axis=0)]
    sides = np.sort(np.stack((np.stack((a, b)), np.stack((b, c)), np.stack((c, a)))), axis=1)  # (3, 2, n)
    crossed = negative[sides[:, 0]] != negative[sides[:, 1]]  # two of the three
    pairs = sides.transpose(2, 0, 1)[crossed.T]
    ends, number = np.unique(pairs, axis=0, return_inverse=True)
    share = values[ends[:, 0]] / (values[ends[:, 0]] - values[ends[:, 1]])
    p = mesh.p[:, ends]
    points = (p[:, :, 0] + share * (p[:, :, 1] - p[:, :, 0])).T
    lines = _chains(number.reshape(-1, 2), len(points))
    return sorted((_cleaned(points[line]) for line in lines),
                  key=lambda line: -np.linalg.norm(np.diff(line, axis=0), axis=1).sum())


def _chains(links: ndarray, n: int) -> list[ndarray]:
    """Points in their order along chains; a ring repeats its first point."""
    both = np.vstack((links, links[:, ::-1]))
    graph = csr_matrix((np.ones(len(both)), both.T), shape=(n, n))
    degree = np.bincount(both[:, 0], minlength=n)
    count, part = connected_components(graph, directed=False)
    chains = []
    for k in range(count):
        members = np.flatnonzero(part == k)
        start, ring = members[degree[members].argmin()], degree[members].min() > 1
        chain = depth_first_order(graph, start, return_predecessors=False)
        chains.append(np.append(chain, start) if ring else chain)
    return chains


def _cleaned(line: ndarray) -> ndarray:
    """A line from left to right, or from below, without points that coincide with the one before."""
    if tuple(line[-1]) < tuple(line[0]):
        line = line[::-1]
    kept = np.ones(len(line), dtype=bool)
    kept[1:] = np.linalg.norm(np.diff(line, axis=0), axis=1) > 1e-12 * np.ptp(line, axis=0).max()
    return line[kept] if kept.sum() > 1 else line
