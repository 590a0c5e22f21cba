"""Fill-reducing order of the unknowns: nested dissection from their places."""

from __future__ import annotations

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import breadth_first_order, maximum_bipartite_matching

COINCIDENT = 1e-9  # places closer than this part of the model's extent are one place
LEAF = 8  # places in a part that is not cut any further


def nested_dissection(graph: csr_matrix, locations: ndarray) -> ndarray:
    """Order of elimination that keeps the factors of a mesh's matrix sparse.

    The places are bisected at the median of the longest side, again and again;
    the two halves are eliminated before the places that separate them, a
    minimum vertex cover of the cut edges. Unknowns at one place stay together.

    Parameters
    ----------
    graph
        (N, N) matrix whose nonzero pattern couples the unknowns; it need not be
        symmetric.
    locations
        (dim, N), the place of each unknown.

    Returns
    -------
    ndarray
        (N,) permutation: the unknown that is eliminated first, second, ...

    References
    ----------
    A. George, Nested dissection of a regular finite element mesh, SIAM J.
    Numer. Anal. 10 (1973) 345-363. The cover follows D. Koenig's theorem.

    Examples
    --------
    A chain of five unknowns is cut in its middle, which is eliminated last.

    >>> import numpy as np
    >>> from scipy.sparse import diags
    >>> chain = diags([1.0, 1.0, 1.0], [-1, 0, 1], shape=(25, 25))
    >>> int(nested_dissection(chain, np.arange(25.0)[None])[-1])
    11
    """
    group, places = _places(locations)
    edges = _edges(graph, group)
    key = _dissect(edges, places)
    rank = np.empty(len(key), dtype=np.int64)
    rank[np.lexsort((*places, key))] = np.arange(len(key))
    return np.argsort(rank[group], kind="stable")


def _places(locations: ndarray) -> tuple[ndarray, ndarray]:
    """Number of the place of each unknown and the places' integer coordinates (dim, n)."""
    low = locations.min(axis=1, keepdims=True)
    extent = np.ptp(locations, axis=1).max() or 1.0
    steps = np.round((locations - low) / (COINCIDENT * extent)).astype(np.int64)
    places, group = np.unique(steps, axis=1, return_inverse=True)
    return group.ravel(), places


def _edges(graph: csr_matrix, group: ndarray) -> tuple[ndarray, ndarray]:
    """Each pair of coupled places once in each direction."""
    coo = graph.tocoo()
    n = group.max() + 1
    row, col = group[coo.row], group[coo.col]
    between = csr_matrix((np.ones(len(row), dtype=np.int8), (row, col)), shape=(n, n))
    between.data[:] = 1
    both = (between + between.T).tocoo()
    off = both.row != both.col
    return both.row[off], both.col[off]


def _dissect(edges: tuple[ndarray, ndarray], places: ndarray) -> ndarray:
    """Sorting key of each place: its base-3 digits are left 0, right 1, separator 2, level by level."""
    n = places.shape[1]
    levels = max(1, int(np.ceil(np.log2(max(2, n / LEAF)))))
    key = np.zeros(n, dtype=np.int64)
    part = np.zeros(n, dtype=np.int64)
    free = np.ones(n, dtype=bool)
    row, col = edges
    for _ in range(levels):
        active = np.flatnonzero(free)
        right = np.zeros(n, dtype=bool)
        right[active] = _upper_half(places[:, active], part[active])
        cut = ~right[row] & right[col]
        separator = _vertex_cover(row[cut], col[cut])
        free[separator] = False
        digit = right.astype(np.int64)
        digit[separator] = 2
        key = 3 * key + np.where(free | (part >= 0), digit, 0)
        part = np.where(free, 2 * part + right, -1)
        inside = free[row] & free[col] & (part[row] == part[col])
        row, col = row[inside], col[inside]
    return key


def _upper_half(places: ndarray, part: ndarray) -> ndarray:
    """Whether a place lies beyond the median of its part's longest side; equal coordinates stay together."""
    part = np.unique(part, return_inverse=True)[1]
    order = np.argsort(part, kind="stable")
    count = np.bincount(part)
    start = np.cumsum(count) - count
    sorted_places = places[:, order]
    highest = np.maximum.reduceat(sorted_places, start, axis=1)
    extent = highest - np.minimum.reduceat(sorted_places, start, axis=1)
    along = places[extent.argmax(axis=0)[part], np.arange(len(part))]
    ranked = along[np.lexsort((along, part))]
    median = ranked[start + count // 2]
    lowest = ranked[start]
    return np.where((median > lowest)[part], along >= median[part], along > lowest[part])


def _vertex_cover(left: ndarray, right: ndarray) -> ndarray:
    """Fewest vertices that touch every edge of the bipartite graph left -> right (Koenig)."""
    if len(left) == 0:
        return left
    lefts, i = np.unique(left, return_inverse=True)
    rights, j = np.unique(right, return_inverse=True)
    n, m = len(lefts), len(rights)
    graph = csr_matrix((np.ones(len(i), dtype=np.int8), (i, j)), shape=(n, m))
    match = maximum_bipartite_matching(graph, perm_type="column")
    matched, single = np.flatnonzero(match >= 0), np.flatnonzero(match < 0)
    unmatched = match[i] != j
    source = n + m
    rows = np.concatenate([i[unmatched], n + match[matched], np.full(len(single), source)])
    cols = np.concatenate([n + j[unmatched], matched, single])
    alternating = csr_matrix((np.ones(len(rows), dtype=np.int8), (rows, cols)), shape=2 * (source + 1,))
    reached = np.zeros(source + 1, dtype=bool)
    reached[breadth_first_order(alternating, source, return_predecessors=False)] = True
    return np.concatenate([lefts[~reached[:n]], rights[reached[n:source]]])
