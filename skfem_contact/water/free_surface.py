"""Lines along which a field of the nodes changes its sign."""
from __future__ import annotations

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components, depth_first_order
from skfem import Mesh

from .places import simplices


def zero_lines(mesh: Mesh, elements: ndarray, values: ndarray) -> list[ndarray]:
    """Polylines between nodes of negative and of other values, (n, 2) each, the longest first, from left to right.

    The field is linear in triangles; quadrilaterals are two of them. A closed line ends where it begins.

    Raises
    ------
    ValueError
        A mesh in space.
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
    return sorted((_cleaned(points[line]) for line in lines), key=lambda line: -_length(line))


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


def _length(line: ndarray) -> float:
    return float(np.linalg.norm(np.diff(line, axis=0), axis=1).sum())
