"""SuperLU as engine of the direct solver: scipy's factors in the order of a nested dissection."""

from __future__ import annotations

from collections.abc import Callable
from hashlib import blake2b

import numpy as np
from numpy import ndarray
from scipy.sparse import csc_matrix, csr_array, csr_matrix
from scipy.sparse.csgraph import breadth_first_order, maximum_flow, structural_rank
from scipy.sparse.linalg import SuperLU as Factors
from scipy.sparse.linalg import splu

TINY = 1e-13  # ratio of a pivot to its row's stiffness that is round-off
DRIFT = 1.15  # growth of the factors from which the dofs are ordered anew
COINCIDENT = 1e-9  # points closer than this part of the model's extent are one point
LEAF = 8  # points in a part that is not cut any further
SLACK = 0.1  # part of the points on either side of the median that may change sides
HOPS = 3  # edges from the median's cut within which a separator is searched,
SMALL = 200  # in parts of more points than this; smaller ones are separated at the median's cut
WALL = 2**28  # capacity that no separator reaches
# orders that are kept for the next models of the same mesh: a fifth of the time of 1,500 dofs,
KEPT = 8
FEWER = 100_000  # of fewer dofs than these: of more the order is a small part

#: The last orders, by their pattern and coordinates.
_orders: dict[bytes, ndarray] = {}


class SuperLU:
    """Engine of scipy: :func:`~scipy.sparse.linalg.splu` of the transposed matrix, without copy."""

    name = "SuperLU with nested dissection"
    cholesky = False

    def __init__(self) -> None:
        self._first_fill: int | None = None  # with the present order
        self._fill = 0

    def order(self, graph: csr_matrix, locations: ndarray) -> ndarray:
        """Return the order of elimination of the dofs of `graph`."""
        self._first_fill = None
        if graph.shape[0] >= FEWER:
            return nested_dissection(graph, locations)
        parts = (graph.indptr, graph.indices, np.ascontiguousarray(locations))
        key = blake2b(b"".join(part.tobytes() for part in parts)).digest()
        order = _orders.pop(key, None)
        if order is None:
            order = nested_dissection(graph, locations)
        _orders[key] = order  # the last one is the one used last
        while len(_orders) > KEPT:
            _orders.pop(next(iter(_orders)))
        return order

    def outdated(self) -> bool:
        """Return True if contacts have moved so far that the factors have grown."""
        return self._first_fill is not None and self._fill > DRIFT * self._first_fill

    def factor(
        self,
        A: csr_matrix,
        symmetric: bool,
        careful: bool = False,
        definite: bool = False,
    ) -> Callable[[ndarray], ndarray]:
        """Factor A and return its solution; `careful` pivots for accuracy.

        SuperLU makes no use of symmetry and definiteness. Where the entries that are not zero leave
        a row without a pivot, whatever their values, it reads beyond its arrays: it prints errors
        of BLAS, or ends the process.
        """
        # refuse matrices without a pivot in a row
        if not A.diagonal().all():
            entries = A.copy()
            entries.eliminate_zeros()
            if structural_rank(entries) < A.shape[0]:
                raise RuntimeError("the matrix is singular by its pattern")

        # factor the transpose, whose columns are the rows of A
        transposed = csc_matrix((A.data, A.indices, A.indptr), shape=A.shape)
        transposed.has_canonical_format = True
        lu = splu(
            transposed,
            permc_spec="NATURAL",
            diag_pivot_thresh=1.0 if careful else 0.01,
            options={} if careful else {"SymmetricMode": True},
        )
        if not careful:
            self._fill = lu.nnz
            self._first_fill = self._first_fill or lu.nnz
        # stubs of scipy before 1.18 lack the argument
        return lambda b: lu.solve(b, trans="T")  # type: ignore[call-overload,unused-ignore]

    def enlarged(self, A: csr_matrix) -> None:
        """Return None: pivots are chosen among all rows."""

    def condensed(self, A: csr_matrix, m: int, most: float) -> Condensed | None:
        """Condense A to its last m dofs, within a share of a factor's operations.

        Return None where that costs more, or pivots are too small.
        """
        return Condensed.of(A, m, most)


class Condensed:
    """Factors of a matrix whose last m dofs are eliminated last.

    The trailing blocks of the factors are the factors of the Schur complement.

    Attributes
    ----------
    schur : ndarray, shape (m, m)
        Schur complement of the last dofs.
    """

    def __init__(self, lu: Factors, m: int) -> None:
        self._lu = lu
        self._m = m
        lower = lu.L.tocsc()[-m:, -m:]
        upper = lu.U.tocsc()[-m:, -m:]
        self.schur = (lower @ upper).toarray()

    @classmethod
    def of(cls, A: csr_matrix, m: int, most: float) -> Condensed | None:
        """Return the condensed matrix, see :meth:`SuperLU.condensed`."""
        try:
            lu = splu(
                A.tocsc(),
                permc_spec="NATURAL",
                diag_pivot_thresh=0.0,
                options={"SymmetricMode": True},
            )
        except RuntimeError:  # an exact zero among the pivots
            return None
        columns = np.diff(lu.L.indptr).astype(float)
        too_large = m**3 > 3.0 * most * (columns**2).sum()
        if too_large or not _unpivoted(lu, A):
            return None
        return cls(lu, m)

    def solve(self, b: ndarray, inside: bool, last: Callable[[ndarray], ndarray]) -> ndarray:
        """Solve for b (n,); `last` returns the last dofs from their right-hand side.

        Without `inside` the other entries of b are zero.
        """
        m = self._m
        if inside:
            load = self.schur @ self._lu.solve(b)[-m:]
        else:
            load = b[-m:]
        right = b.copy()
        right[-m:] += self.schur @ last(load) - load
        return self._lu.solve(right)


def _unpivoted(lu: Factors, A: csr_matrix) -> bool:
    """Return True if the factors have the order of A and no pivots of round-off."""
    identity = np.arange(A.shape[0])
    kept = np.array_equal(lu.perm_r, identity) and np.array_equal(lu.perm_c, identity)
    pivots = np.abs(lu.U.diagonal())
    return kept and bool((pivots > TINY * np.abs(A.diagonal())).all())


def nested_dissection(graph: csr_matrix, locations: ndarray) -> ndarray:
    """Return the order of elimination, (N,), that keeps the factors of a mesh's matrix sparse.

    The points of the dofs are bisected at the median of the longest side, again and again; the two
    halves are eliminated before the points that separate them.  The separator is the lightest one
    near the median, the minimum cut of a network whose points have the number of their dofs as
    capacity.  On graded meshes such a separator is much smaller than a straight one.  Dofs of one
    point stay together.

    The nonzero pattern of `graph`, (N, N), couples the dofs and need not be symmetric; `locations`,
    (dim, N), are the coordinates.

    References
    ----------
    A. George, Nested dissection of a regular finite element mesh, SIAM J. Numer. Anal. 10 (1973)
    345-363. C. Ashcraft, J. W. H. Liu, Applications of the Dulmage-Mendelsohn decomposition and
    network flow to graph bisection improvement, SIAM J. Matrix Anal. Appl. 19 (1998) 325-354.
    """
    group, points = _points(locations)
    key = _dissect(_edges(graph, group), points, np.bincount(group))
    rank = np.empty(len(key), dtype=np.int64)
    rank[np.lexsort((*points, key))] = np.arange(len(key))
    return np.argsort(rank[group], kind="stable")


def _points(locations: ndarray) -> tuple[ndarray, ndarray]:
    """Return the number of each dof's point, and integer coordinates of the points, (dim, n)."""
    low = locations.min(axis=1, keepdims=True)
    extent = np.ptp(locations, axis=1).max() or 1.0
    grid = COINCIDENT * extent
    steps = np.round((locations - low) / grid).astype(np.int64)
    order = np.lexsort(steps)
    steps = steps[:, order]

    # number the points that differ from the one before.
    new = np.ones(len(order), dtype=bool)
    new[1:] = np.any(steps[:, 1:] != steps[:, :-1], axis=0)
    group = np.empty(len(order), dtype=np.int64)
    group[order] = np.cumsum(new) - 1
    return group, steps[:, new]


def _edges(graph: csr_matrix, group: ndarray) -> tuple[ndarray, ndarray]:
    """Return each pair of coupled points once in each direction."""
    coo = graph.tocoo()
    n = group.max() + 1
    pairs = group[coo.row], group[coo.col]
    between = csr_matrix((np.ones(coo.nnz, dtype=bool), pairs), shape=(n, n))
    both = (between + between.T).tocoo()
    off = both.row != both.col
    return both.row[off], both.col[off]


def _dissect(edges: tuple[ndarray, ndarray], points: ndarray, weight: ndarray) -> ndarray:
    """Return sorting keys of points: base-3 digits left 0, right 1, separator 2, by level."""
    n = points.shape[1]
    along = np.array([np.unique(axis, return_inverse=True)[1] for axis in points])
    key = np.zeros(n, dtype=np.int64)
    part = np.zeros(n, dtype=np.int64)
    inner = np.ones(n, dtype=bool)  # not yet in a separator
    row, col = edges
    size = n
    while size > LEAF:
        # cut each part in two, and find the points between its halves
        active = np.flatnonzero(inner)
        right = np.zeros(n, dtype=bool)
        near = np.zeros(n, dtype=bool)
        right[active], near[active] = _bisect(along[:, active], points[:, active], part[active])
        separator = _separator(row, col, right, near, weight, HOPS if size > SMALL else 0)

        # write one digit of the keys
        key[active] = 3 * key[active] + right[active]
        key[~inner] *= 3
        key[separator] += 2 - right[separator]
        inner[separator] = False
        part = 2 * part + right

        # drop edges that leave a part
        kept = inner[row] & inner[col] & (part[row] == part[col])
        row = row[kept]
        col = col[kept]
        size //= 2
    return key


def _bisect(along: ndarray, points: ndarray, part: ndarray) -> tuple[ndarray, ndarray]:
    """Return masks of points beyond and near the median of the longest side of their part.

    Points of one coordinate stay together: the separators of a structured mesh are straight.
    """
    # find the longest side of each part
    part = np.unique(part, return_inverse=True)[1]
    count = np.bincount(part)
    start = np.cumsum(count) - count
    by_part = np.argsort(part, kind="stable")
    in_parts = points[:, by_part]
    highest = np.maximum.reduceat(in_parts, start, axis=1)
    extent = highest - np.minimum.reduceat(in_parts, start, axis=1)
    side = extent.argmax(axis=0)
    along = along[side[part], np.arange(len(part))]

    # cut it at its median
    order = np.argsort(part * (along.max() + 1) + along)
    ordered = along[order]
    median = ordered[start + count // 2]
    lowest = ordered[start]
    right = np.where((median > lowest)[part], along >= median[part], along > lowest[part])
    rank = np.empty(len(part))
    rank[order] = np.arange(len(part)) + 0.5
    share = (rank - start[part]) / count[part]
    return right, np.abs(share - 0.5) < SLACK


def _separator(
    row: ndarray,
    col: ndarray,
    right: ndarray,
    near: ndarray,
    weight: ndarray,
    hops: int,
) -> ndarray:
    """Return the points of least weight that separate left from right; update `right`.

    A point v of the band about the cut is an arc (v, v + m) of its weight in a network whose other
    arcs cannot be cut. Points with neighbours outside the band and points far from the median are
    tied to the source or the sink: they stay on their side or join the separator.
    """
    # widen the band from the cut
    band = np.zeros(len(right), dtype=bool)
    band[row[right[row] != right[col]]] = True
    inside = near[row] & near[col]
    near_row = row[inside]
    near_col = col[inside]
    for _ in range(hops):
        band[near_col[band[near_row]]] = True
    points = np.flatnonzero(band)
    m = len(points)
    number = np.zeros(len(right), dtype=np.int64)
    number[points] = np.arange(m)

    # tie points with neighbours outside to their side
    from_band = band[row]
    row = row[from_band]
    col = col[from_band]
    tied = ~near
    tied[row[~band[col]]] = True
    sources = number[points[tied[points] & ~right[points]]]
    sinks = number[points[tied[points] & right[points]]]

    # cut the network
    within = band[col]
    arcs = np.arange(m)
    source = np.full(len(sources), 2 * m)
    sink = np.full(len(sinks), 2 * m + 1)
    tails = np.concatenate([arcs, m + number[row[within]], source, m + sinks])
    heads = np.concatenate([m + arcs, number[col[within]], sources, sink])
    capacity = np.full(len(tails), WALL, dtype=np.int32)
    capacity[:m] = weight[points]
    network = csr_array((capacity, (tails, heads)), shape=(2 * m + 2, 2 * m + 2))
    entered, passed = _source_side(network)[: 2 * m].reshape(2, m)
    right[points] = ~passed
    return points[entered & ~passed]


def _source_side(network: csr_array) -> ndarray:
    """Return a mask of the nodes on the source's side of the minimum cut.

    Source and sink are the last two nodes.
    """
    n = network.shape[0]
    residual = network - maximum_flow(network, n - 2, n - 1).flow
    residual.data = np.maximum(residual.data, 0)
    residual.eliminate_zeros()
    side = np.zeros(n, dtype=bool)
    side[breadth_first_order(residual, n - 2, return_predecessors=False)] = True
    return side
