"""Sparse matrices on patterns that stay: sums, blocks and the contributions of contact points."""
from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from functools import reduce

import numpy as np
from numpy import ndarray
from scipy.sparse import coo_matrix, csr_matrix


def with_data(pattern: csr_matrix, data: ndarray) -> csr_matrix:
    """The matrix with other data; the pattern is shared and, as it is known to be sound, not looked at."""
    matrix = copy(pattern)
    matrix.data = data
    return matrix


def padded(K: csr_matrix, n: int) -> csr_matrix:
    """The matrix among n unknowns, of which it knows the first ones; its data are shared."""
    indptr = np.pad(K.indptr, (0, n - K.shape[0]), mode="edge")
    return csr_matrix((K.data, K.indices, indptr), shape=(n, n))


def scattered(K: csr_matrix, dofs: ndarray, n: int) -> csr_matrix:
    """Return a matrix of some dofs among n dofs."""
    local = K.tocoo()
    return coo_matrix((local.data, (dofs[local.row], dofs[local.col])), shape=(n, n)).tocsr()


class Gathering:
    """Forces and tangents of points among n unknowns; places in the matrix are found anew only for other nodes.

    Examples
    --------
    >>> import numpy as np
    >>> two_points = np.array([[0, 1], [1, -1]])      # -1: a rigid obstacle has no unknowns
    >>> gathering = Gathering(3)
    >>> gathering.force(two_points, np.ones((2, 2))).tolist()
    [1.0, 2.0, 0.0]
    >>> gathering.matrix(two_points, np.ones((2, 2, 2))).toarray()
    array([[1., 1., 0.],
           [1., 2., 0.],
           [0., 0., 0.]])
    """

    def __init__(self, n: int) -> None:
        self._n = n
        self._dofs: ndarray | None = None

    def force(self, dofs: ndarray, forces: ndarray) -> ndarray:
        """Sum of the points' forces, (n_points, m), on their unknowns, (n_points, m)."""
        moving = dofs >= 0
        return np.bincount(dofs[moving], forces[moving], minlength=self._n)

    def matrix(self, dofs: ndarray, matrices: ndarray) -> csr_matrix:
        """Sum of the points' matrices, (n_points, m, m)."""
        if self._dofs is None or not np.array_equal(dofs, self._dofs):
            self._find(dofs)
        data = np.bincount(self._slots, matrices[self._moving], minlength=len(self._pattern.indices))
        return with_data(self._pattern, data)

    def _find(self, dofs: ndarray) -> None:
        """Places of the entries: looked for once for all points on the same unknowns, such as those of one facet."""
        self._dofs = dofs
        alike, number = _unique_rows(dofs)
        alike = alike.astype(np.int64)  # scikit-fem counts in 32 bits, too few for the product
        moving = (alike >= 0)[:, :, None] & (alike >= 0)[:, None]
        entries, places = np.unique((alike[:, :, None] * self._n + alike[:, None])[moving], return_inverse=True)
        slots = np.zeros(moving.shape, places.dtype)
        slots[moving] = places
        self._moving = moving[number]
        self._slots = slots[number][self._moving]
        row, column = np.divmod(entries, self._n)
        ends = np.append(0, np.cumsum(np.bincount(row, minlength=self._n)))
        self._pattern = csr_matrix((np.ones(len(row)), column.astype(np.int32), ends.astype(np.int32)),
                                   shape=(self._n, self._n))


def _unique_rows(numbers: ndarray) -> tuple[ndarray, ndarray]:
    """Rows that differ, and which of them each row is."""
    order = np.lexsort(numbers.T)
    new = np.ones(len(order), bool)
    new[1:] = (numbers[order[1:]] != numbers[order[:-1]]).any(axis=1)
    number = np.empty(len(order), int)
    number[order] = np.cumsum(new) - 1
    return numbers[order[new]], number


class FreeBlock:
    """K[order][:, order], gathered through an index map that is kept as long as the pattern of K stays.

    Examples
    --------
    >>> import numpy as np
    >>> from scipy.sparse import csr_matrix
    >>> block = FreeBlock(np.array([2, 0]))
    >>> block.gather(csr_matrix(np.arange(9.0).reshape(3, 3))).toarray()
    array([[8., 6.],
           [2., 0.]])
    """

    def __init__(self, order: ndarray) -> None:
        self.order = order
        self._pattern: csr_matrix | None = None

    def gather(self, K: csr_matrix) -> csr_matrix:
        """The block of `K`, in canonical format."""
        K = _canonical(K)
        if self._pattern is None or not same_pattern(K, self._pattern):
            self._map(K)
        return with_data(self._entries, K.data.take(self._entries.data))

    def _map(self, K: csr_matrix) -> None:
        pattern = with_data(K, np.empty(K.nnz, dtype=bool))
        changes = K.indices.flags.writeable or K.indptr.flags.writeable  # scipy changes a pattern in place
        self._pattern = pattern.copy() if changes else pattern
        numbers = csr_matrix((np.arange(K.nnz), K.indices, K.indptr), shape=K.shape)
        self._entries = numbers[self.order][:, self.order].astype(np.int32)
        self._entries.sort_indices()
        self._entries.has_canonical_format = True


def same_pattern(A: csr_matrix, B: csr_matrix) -> bool:
    """Whether two matrices in canonical format have their entries at the same places."""
    return A.nnz == B.nnz and all(
        a is b or np.array_equal(a, b) for a, b in ((A.indptr, B.indptr), (A.indices, B.indices))
    )


def same_matrix(A: csr_matrix, B: csr_matrix) -> bool:
    """Whether two matrices in canonical format are the same, to the last bit."""
    return same_pattern(A, B) and np.array_equal(A.data, B.data)


#: Entries that are kept for contacts that have opened, as a share of all.
_SPARE = 0.05


class Total:
    """Sum of matrices on the union of their patterns.

    scipy drops the entries that happen to add up to zero, and contacts open and close; here they keep their places,
    so that an order of elimination and an index map serve for many iterations.

    Examples
    --------
    >>> import numpy as np
    >>> from scipy.sparse import csr_matrix
    >>> one = csr_matrix(np.eye(2))
    >>> Total().of([one, -one]).data
    array([0., 0.])
    """

    def __init__(self) -> None:
        self._pattern: csr_matrix | None = None
        self._parts: list[tuple[csr_matrix, ndarray]] = []  # masks: a sorted part fills its places in order

    def of(self, matrices: Sequence[csr_matrix]) -> csr_matrix:
        """The sum; its index arrays are those of the last one as long as they serve."""
        if len(matrices) == 1:
            return matrices[0]
        matrices = [_canonical(matrix) for matrix in matrices]
        places = self._places(matrices)
        if places is None:
            self._widen(matrices)
            places = self._places(matrices)
        pattern = self._pattern
        assert pattern is not None and places is not None
        data = np.zeros(pattern.nnz)
        data[places[0]] = matrices[0].data
        for matrix, place in zip(matrices[1:], places[1:], strict=True):
            data[place] += matrix.data
        return with_data(pattern, data)

    def _places(self, matrices: Sequence[csr_matrix]) -> list[ndarray] | None:
        """Which entries of the pattern the matrices have; None where it lacks some of theirs."""
        if self._pattern is None:
            return None
        parts: list[tuple[csr_matrix, ndarray]] = []
        for k, matrix in enumerate(matrices):
            known = k < len(self._parts) and same_pattern(matrix, self._parts[k][0])
            place = self._parts[k][1] if known else _find(matrix, self._pattern)
            if place is None:
                return None
            parts.append((matrix, place))
        self._parts = parts
        return [place for _, place in parts]

    def _widen(self, matrices: Sequence[csr_matrix]) -> None:
        """Take up new entries, and drop old ones that have become many."""
        needed = _union(matrices)
        if self._pattern is not None:
            both = _union([needed, self._pattern])
            needed = both if both.nnz <= (1.0 + _SPARE) * needed.nnz else needed
        self._pattern, self._parts = needed, []


def _canonical(matrix: csr_matrix) -> csr_matrix:
    if not matrix.has_canonical_format:
        matrix = matrix.copy()
        matrix.sum_duplicates()
    return matrix


def _union(matrices: Sequence[csr_matrix]) -> csr_matrix:
    """The entries of any of the matrices."""
    ones = [with_data(matrix, np.ones(matrix.nnz, dtype=np.int8)) for matrix in matrices]
    union = reduce(csr_matrix.maximum, sorted(ones, key=lambda one: one.nnz))  # the largest one is gone through once
    union.has_canonical_format = True  # for those of the matrices is
    union.indices.flags.writeable = union.indptr.flags.writeable = False  # whoever knows it need not look again
    return union


def _find(matrix: csr_matrix, pattern: csr_matrix) -> ndarray | None:
    """Which entries of a pattern a matrix has: their numbers or, if they are many, a mask; None if one is missing."""
    counts, have = np.diff(matrix.indptr), np.diff(pattern.indptr)
    if (counts > have).any():
        return None
    position = np.arange(matrix.nnz) + np.repeat(pattern.indptr[:-1] - matrix.indptr[:-1], counts)
    rows = np.flatnonzero((counts > 0) & (counts < have))  # the others are as in the pattern, or not within it
    if len(rows):
        n, entry, within = matrix.shape[1], _entries(matrix, rows), _entries(pattern, rows)
        keys = np.repeat(rows * n, have[rows]) + pattern.indices[within]
        wanted = np.repeat(rows * n, counts[rows]) + matrix.indices[entry]
        position[entry] = within[np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)]
    if not np.array_equal(pattern.indices.take(position), matrix.indices):
        return None
    if 8 * len(position) < pattern.nnz:  # the mask would take more memory
        return position
    mask = np.zeros(pattern.nnz, bool)
    mask[position] = True
    return mask


def _entries(matrix: csr_matrix, rows: ndarray) -> ndarray:
    """Positions of all entries of some rows."""
    start, count = matrix.indptr[rows].astype(int), np.diff(matrix.indptr)[rows]
    return np.arange(count.sum()) + np.repeat(start - np.cumsum(count) + count, count)
