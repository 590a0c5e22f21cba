"""Fill-reducing order of the unknowns: nested dissection from their places."""

from __future__ import annotations

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_array, csr_matrix
from scipy.sparse.csgraph import breadth_first_order, maximum_flow

COINCIDENT = 1e-9  # places closer than this part of the model's extent are one place
LEAF = 8  # places in a part that is not cut any further
SLACK = 0.1  # part of the places on either side of the median that may change sides
HOPS = 3  # edges from the median's cut within which a separator is looked for,
SMALL = 200  # in parts of more places than this; smaller ones are separated at the median's cut
WALL = 2**28  # capacity that no separator reaches


def nested_dissection(graph: csr_matrix, locations: ndarray) -> ndarray:
    """Order of elimination that keeps the factors of a mesh's matrix sparse.

    The places are bisected at the median of the longest side, again and again;
    the two halves are eliminated before the places that separate them. These
    are the fewest unknowns that do so in the neighbourhood of the median, found
    as the minimum cut of a network whose places have the number of their
    unknowns as capacity (on the cut edges alone it would be their minimum
    vertex cover). On graded meshes they are far fewer than a straight line
    passes by. Layout at one place stay together.

    `graph`, (N, N), couples the unknowns by its nonzero pattern, which need not be
    symmetric; `locations`, (dim, N), are their places; the answer, (N,), is the unknown
    that is eliminated first, second, ...

    References
    ----------
    A. George, Nested dissection of a regular finite element mesh, SIAM J.
    Numer. Anal. 10 (1973) 345-363. C. Ashcraft, J. W. H. Liu, Applications of
    the Dulmage-Mendelsohn decomposition and network flow to graph bisection
    improvement, SIAM J. Matrix Anal. Appl. 19 (1998) 325-354.

    Examples
    --------
    A chain is cut in its middle, which is eliminated last.

    >>> import numpy as np
    >>> from scipy.sparse import diags
    >>> chain = diags([1.0, 1.0, 1.0], [-1, 0, 1], shape=(25, 25))
    >>> int(nested_dissection(chain, np.arange(25.0)[None])[-1]) in range(10, 15)
    True
    """
    group, places = _places(locations)
    key = _dissect(_edges(graph, group), places, np.bincount(group))
    rank = np.empty(len(key), dtype=np.int64)
    rank[np.lexsort((*places, key))] = np.arange(len(key))
    return np.argsort(rank[group], kind="stable")


def _places(locations: ndarray) -> tuple[ndarray, ndarray]:
    """Number of the place of each unknown, and the places' integer coordinates (dim, n)."""
    low = locations.min(axis=1, keepdims=True)
    extent = np.ptp(locations, axis=1).max() or 1.0
    steps = np.round((locations - low) / (COINCIDENT * extent)).astype(np.int64)
    order = np.lexsort(steps)
    steps = steps[:, order]
    new = np.ones(len(order), dtype=bool)
    new[1:] = np.any(steps[:, 1:] != steps[:, :-1], axis=0)
    group = np.empty(len(order), dtype=np.int64)
    group[order] = np.cumsum(new) - 1
    return group, steps[:, new]


def _edges(graph: csr_matrix, group: ndarray) -> tuple[ndarray, ndarray]:
    """Each pair of coupled places once in each direction."""
    coo = graph.tocoo()
    n = group.max() + 1
    row, col = group[coo.row], group[coo.col]
    between = csr_matrix((np.ones(len(row), dtype=bool), (row, col)), shape=(n, n))
    both = (between + between.T).tocoo()
    off = both.row != both.col
    return both.row[off], both.col[off]


def _dissect(edges: tuple[ndarray, ndarray], places: ndarray, weight: ndarray) -> ndarray:
    """Sorting key of each place: its base-3 digits are left 0, right 1, separator 2, level by level."""
    n = places.shape[1]
    along = np.array([np.unique(axis, return_inverse=True)[1] for axis in places])
    key = np.zeros(n, dtype=np.int64)
    part = np.zeros(n, dtype=np.int64)
    inner = np.ones(n, dtype=bool)  # not yet in a separator
    row, col = edges
    size = n
    while size > LEAF:
        active = np.flatnonzero(inner)
        right, near = np.zeros(n, dtype=bool), np.zeros(n, dtype=bool)
        right[active], near[active] = _bisect(along[:, active], places[:, active], part[active])
        separator = _separator(row, col, right, near, weight, HOPS if size > SMALL else 0)
        key[active] = 3 * key[active] + right[active]
        key[~inner] *= 3
        key[separator] += 2 - right[separator]
        inner[separator] = False
        part = 2 * part + right
        kept = inner[row] & inner[col] & (part[row] == part[col])
        row, col = row[kept], col[kept]
        size //= 2
    return key


def _bisect(along: ndarray, places: ndarray, part: ndarray) -> tuple[ndarray, ndarray]:
    """Whether a place lies beyond the median of its part's longest side, and whether it lies near it.

    Places of one coordinate stay together: the separators of a structured mesh are straight.
    """
    part = np.unique(part, return_inverse=True)[1]
    count = np.bincount(part)
    start = np.cumsum(count) - count
    in_parts = places[:, np.argsort(part, kind="stable")]
    extent = np.maximum.reduceat(in_parts, start, axis=1) - np.minimum.reduceat(in_parts, start, axis=1)
    along = along[extent.argmax(axis=0)[part], np.arange(len(part))]
    order = np.argsort(part * (along.max() + 1) + along)
    median, lowest = along[order][start + count // 2], along[order][start]
    right = np.where((median > lowest)[part], along >= median[part], along > lowest[part])
    rank = np.empty(len(part))
    rank[order] = np.arange(len(part)) + 0.5
    return right, np.abs((rank - start[part]) / count[part] - 0.5) < SLACK


def _separator(
    row: ndarray, col: ndarray, right: ndarray, near: ndarray, weight: ndarray, hops: int
) -> ndarray:
    """Places of least weight that separate left from right; `right` is updated for those that change sides.

    A place v of the band about the cut is an arc (v, v + m) of its weight in a network whose
    other arcs cannot be cut. Places with neighbours outside the band, and those not near the median,
    are tied to the source or the sink: they stay on their side or join the separator.
    """
    band = np.zeros(len(right), dtype=bool)
    band[row[right[row] != right[col]]] = True
    inside = near[row] & near[col]
    near_row, near_col = row[inside], col[inside]
    for _ in range(hops):
        band[near_col[band[near_row]]] = True
    places = np.flatnonzero(band)
    m = len(places)
    number = np.zeros(len(right), dtype=np.int64)
    number[places] = np.arange(m)
    from_band = band[row]
    row, col = row[from_band], col[from_band]
    tied = ~near
    tied[row[~band[col]]] = True
    sources, sinks = (number[places[tied[places] & (right[places] == side)]] for side in (False, True))
    within = band[col]
    tails = np.concatenate([np.arange(m), m + number[row[within]], np.full(len(sources), 2 * m), m + sinks])
    heads = np.concatenate([m + np.arange(m), number[col[within]], sources, np.full(len(sinks), 2 * m + 1)])
    capacity = np.full(len(tails), WALL, dtype=np.int32)
    capacity[:m] = weight[places]
    network = csr_array((capacity, (tails, heads)), shape=(2 * m + 2, 2 * m + 2))
    entered, left = _source_side(network)[: 2 * m].reshape(2, m)
    right[places] = ~left
    return places[entered & ~left]


def _source_side(network: csr_array) -> ndarray:
    """Nodes on the source's side of the minimum cut; the source and the sink are the last two nodes."""
    n = network.shape[0]
    residual = network - maximum_flow(network, n - 2, n - 1).flow
    residual.data = np.maximum(residual.data, 0)
    residual.eliminate_zeros()
    side = np.zeros(n, dtype=bool)
    side[breadth_first_order(residual, n - 2, return_predecessors=False)] = True
    return side
