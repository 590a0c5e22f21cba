"""Sparse matrices on patterns that stay: sums, blocks and the contributions of contact points."""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from functools import reduce
from weakref import ref

import numpy as np
from numpy import ndarray
from scipy.sparse import coo_matrix, csr_matrix
from scipy.sparse.csgraph import connected_components


def with_data(pattern: csr_matrix, data: ndarray) -> csr_matrix:
    """Return the matrix with other data; the pattern is shared and not checked again."""
    matrix = copy(pattern)
    matrix.data = data
    return matrix


def constant(K: csr_matrix) -> csr_matrix:
    """Return a matrix after its data have become read-only, so that they can be known again."""
    K.data.flags.writeable = False
    return K


def padded(K: csr_matrix, n: int) -> csr_matrix:
    """Pad a matrix of the first dofs to n dofs; its data are shared."""
    empty = np.repeat(K.indptr[-1:], n - K.shape[0])
    indptr = np.concatenate((K.indptr, empty))
    matrix = csr_matrix((K.data, K.indices, indptr), shape=(n, n))
    return with_data(matrix, K.data)  # scipy has taken a view of the data


def within(K: csr_matrix, dofs: ndarray) -> csr_matrix:
    """Return the rows and columns of some dofs."""
    return K[dofs][:, dofs]


def scattered(K: csr_matrix, dofs: ndarray, n: int) -> csr_matrix:
    """Return a matrix of some dofs among n dofs."""
    local = K.tocoo()
    entries = local.data, (dofs[local.row], dofs[local.col])
    return coo_matrix(entries, shape=(n, n)).tocsr()


def parts_of(n: int, first: ndarray, second: ndarray) -> ndarray:
    """Return the numbers of the connected parts of n things, (n,), of which pairs are linked."""
    links = coo_matrix((np.ones(first.size), (first.ravel(), second.ravel())), shape=(n, n))
    return np.asarray(connected_components(links, directed=False)[1])


class Scattering:
    """Slots of a form's matrices among n dofs, found again only for another pattern."""

    def __init__(self) -> None:
        self._last: tuple[csr_matrix, csr_matrix] | None = None  # of the form, and among all dofs
        self._dofs: ndarray | None = None
        self._slots: ndarray | None = None

    def of(self, K: csr_matrix, dofs: ndarray | None, n: int) -> csr_matrix:
        """Return a matrix of some dofs, by default of the first ones, among n dofs."""
        if self._last is None or not self._serves(K, dofs, n):
            self._last = K, self._found(K, dofs, n)
        local, wide = self._last
        constant = K.data is local.data and not K.data.flags.writeable
        if constant and not wide.data.flags.writeable:
            return wide
        data = K.data
        if self._slots is not None:
            data = float_bincount(self._slots, K.data, wide.nnz)
            data.flags.writeable = K.data.flags.writeable
        wide = with_data(wide, data)
        self._last = K, wide
        return wide

    def _serves(self, K: csr_matrix, dofs: ndarray | None, n: int) -> bool:
        """Return True if the entries of K have the slots of the last ones."""
        assert self._last is not None
        local, wide = self._last
        if wide.shape[0] != n or local.shape != K.shape:
            return False
        known = self._dofs
        if dofs is not known and (dofs is None or known is None or not np.array_equal(dofs, known)):
            return False
        return local is K or (K.has_canonical_format and same_pattern(K, local))

    def _found(self, K: csr_matrix, dofs: ndarray | None, n: int) -> csr_matrix:
        """Find the slots of the entries, and return a matrix that has their pattern."""
        self._dofs = dofs
        self._slots = None
        if dofs is None:
            return padded(K, n)
        local = K.tocoo()
        numbers = dofs.astype(np.int64)
        keys = numbers[local.row] * n + numbers[local.col]
        entries, self._slots = np.unique(keys, return_inverse=True)
        return _with_entries(entries, n)


def _with_entries(entries: ndarray, n: int) -> csr_matrix:
    """Return a matrix of n rows with ones at sorted entries, row times n plus column."""
    row, column = np.divmod(entries, n)
    ends = np.append(0, np.cumsum(np.bincount(row, minlength=n)))
    pattern = np.ones(len(row)), column.astype(np.int32), ends.astype(np.int32)
    matrix = csr_matrix(pattern, shape=(n, n))
    matrix.has_canonical_format = True
    # a pattern that cannot change need not be compared again
    matrix.indices.flags.writeable = False
    matrix.indptr.flags.writeable = False
    return matrix


def float_bincount(numbers: ndarray, values: ndarray, n: int) -> ndarray:
    """Sum values by their numbers, shape (n,).

    :func:`numpy.bincount` returns integers for no values at all, which round whatever
    is assigned to them.
    """
    return np.bincount(numbers, values, minlength=n).astype(float)


class Gathering:
    """Forces and tangents of points among n dofs.

    Slots in the matrix are found again only for points on other nodes.
    """

    def __init__(self, n: int) -> None:
        self._n = n
        self._dofs: ndarray | None = None

    def force(self, dofs: ndarray, forces: ndarray) -> ndarray:
        """Sum the points' forces, (n_points, m), on their dofs, (n_points, m)."""
        moving = dofs >= 0
        return float_bincount(dofs[moving], forces[moving], self._n)

    def matrix(self, dofs: ndarray, matrices: ndarray) -> csr_matrix:
        """Sum the points' matrices, (n_points, m, m)."""
        if self._dofs is None or not np.array_equal(dofs, self._dofs):
            self._find(dofs)
        if len(self._first) < len(dofs):
            matrices = np.add.reduceat(matrices, self._first, axis=0)
        count = len(self._pattern.indices)
        data = np.bincount(self._slots, matrices.ravel(), minlength=count + 1)
        return with_data(self._pattern, data[:count])

    def _find(self, dofs: ndarray) -> None:
        """Find the slots of the entries, once for all points on the same dofs.

        Points on the same dofs that follow each other, such as on a facet, are added first.
        """
        n = self._n
        self._dofs = dofs
        changes = np.ones(len(dofs), bool)
        changes[1:] = (dofs[1:] != dofs[:-1]).any(axis=1)
        self._first = np.flatnonzero(changes)

        # number the entries of moving dofs
        alike, number = _unique_rows(dofs[self._first])
        alike = alike.astype(np.int64)  # scikit-fem counts in 32 bits, too few for the product
        free = alike >= 0
        moving = free[:, :, None] & free[:, None]  # (n_blocks, m, m)
        keys = alike[:, :, None] * n + alike[:, None]
        entries, numbers = np.unique(keys[moving], return_inverse=True)
        slots = np.full(moving.shape, len(entries))  # the last slot is of held dofs
        slots[moving] = numbers
        self._slots = slots[number].ravel()

        self._pattern = _with_entries(entries, n)


def _unique_rows(numbers: ndarray) -> tuple[ndarray, ndarray]:
    """Return the different rows, and the number of each row among them."""
    order = np.lexsort(numbers.T)
    ordered = numbers[order]
    new = np.ones(len(order), bool)
    new[1:] = (ordered[1:] != ordered[:-1]).any(axis=1)
    number = np.empty(len(order), int)
    number[order] = np.cumsum(new) - 1
    return ordered[new], number


class FreeBlock:
    """K[order][:, order], gathered through an index map for as long as the pattern of K stays."""

    def __init__(self, order: ndarray) -> None:
        self.order = order
        self._pattern: csr_matrix | None = None

    def gather(self, K: csr_matrix) -> csr_matrix:
        """Return the block of `K`, in canonical format."""
        K = _canonical(K)
        if self._pattern is None or not same_pattern(K, self._pattern):
            self._map(K)
        return with_data(self._entries, K.data.take(self._entries.data))

    def _map(self, K: csr_matrix) -> None:
        """Find the entries of the block in the data of `K`."""
        pattern = with_data(K, np.empty(K.nnz, dtype=bool))
        # scipy changes a pattern in place
        changes = K.indices.flags.writeable or K.indptr.flags.writeable
        self._pattern = pattern.copy() if changes else pattern
        # numpy copies indices of 32 bits in every call: these have 64
        numbers = csr_matrix((np.arange(K.nnz), K.indices, K.indptr), shape=K.shape)
        self._entries = numbers[self.order][:, self.order]
        self._entries.sort_indices()
        self._entries.has_canonical_format = True


def same_pattern(A: csr_matrix, B: csr_matrix) -> bool:
    """Return True if two matrices in canonical format have the same pattern."""
    if A.nnz != B.nnz:
        return False
    pairs = ((A.indptr, B.indptr), (A.indices, B.indices))
    return all(a is b or np.array_equal(a, b) for a, b in pairs)


def same_matrix(A: csr_matrix, B: csr_matrix) -> bool:
    """Return True if two matrices in canonical format are the same, to the last bit."""
    return same_pattern(A, B) and np.array_equal(A.data, B.data)


def widened(A: csr_matrix, pattern: csr_matrix) -> csr_matrix:
    """Return A on a wider pattern, or A where that one lacks entries; both are canonical."""
    slots = _find(A, pattern)
    if slots is None:
        return A
    data = np.zeros(pattern.nnz)
    data[slots] = A.data
    return with_data(pattern, data)


#: Entries that are kept for contacts that have opened, as a share of all.
_SPARE = 0.05


class Total:
    """Sum of matrices on the union of their patterns.

    scipy drops entries that add up to zero, and contacts open and close. Here all entries keep
    their slots, so that an order of elimination and an index map serve for many iterations.
    """

    def __init__(self) -> None:
        self._pattern: csr_matrix | None = None
        # slots are masks where they can be: a sorted part fills its slots in order
        self._parts: list[tuple[csr_matrix, ndarray]] = []
        self._sum: tuple[list[ref[ndarray]], csr_matrix] | None = None
        self._scaled: tuple[csr_matrix, csr_matrix] | None = None
        self._factors: tuple[ndarray, ndarray] | None = None  # of the entries on one pattern

    def of(self, matrices: Sequence[csr_matrix]) -> csr_matrix:
        """Return the sum; its index arrays stay as long as they serve."""
        if len(matrices) == 1:
            return matrices[0]
        values = [matrix.data for matrix in matrices]
        if self._sum is not None:
            known, total = self._sum
            if _same_constants(known, values):
                return total
            del known, total
            self._sum = self._scaled = None  # their memory is free for the next sum

        # find the slots of the parts, in a wider pattern if need be
        matrices = [_canonical(matrix) for matrix in matrices]
        slots = self._slots(matrices)
        if slots is None:
            self._widen(matrices)
            slots = self._slots(matrices)
        pattern = self._pattern
        assert pattern is not None and slots is not None

        data = np.zeros(pattern.nnz)
        data[slots[0]] = matrices[0].data
        for matrix, own in zip(matrices[1:], slots[1:], strict=True):
            data[own] += matrix.data
        total = with_data(pattern, data)
        self._sum = [ref(each) for each in values], total
        return total

    def scaled(self, K: csr_matrix, scale: ndarray) -> csr_matrix:
        """Return a matrix with its rows and columns multiplied by a scale, (n,)."""
        if self._scaled is not None and self._scaled[0] is K:
            return self._scaled[1]
        known = self._factors is not None and K.indices is self._factors[0]
        if not known:
            factors = np.repeat(scale, np.diff(K.indptr)) * scale[K.indices]
            self._factors = K.indices, factors
        assert self._factors is not None
        self._scaled = K, constant(with_data(K, K.data * self._factors[1]))
        return self._scaled[1]

    def _slots(self, matrices: Sequence[csr_matrix]) -> list[ndarray] | None:
        """Return the slots of the matrices in the pattern; None where the pattern lacks some."""
        if self._pattern is None:
            return None
        parts: list[tuple[csr_matrix, ndarray]] = []
        for k, matrix in enumerate(matrices):
            known = k < len(self._parts) and same_pattern(matrix, self._parts[k][0])
            slots = self._parts[k][1] if known else _find(matrix, self._pattern)
            if slots is None:
                return None
            parts.append((matrix, slots))
        self._parts = parts
        return [slots for _, slots in parts]

    def _widen(self, matrices: Sequence[csr_matrix]) -> None:
        """Add new entries, and drop old ones that have become many."""
        pattern = _union(matrices)
        if self._pattern is not None:
            both = _union([pattern, self._pattern])
            if both.nnz <= (1.0 + _SPARE) * pattern.nnz:
                pattern = both
        self._pattern = pattern
        self._parts = []


def _same_constants(known: list[ref[ndarray]], values: list[ndarray]) -> bool:
    """Return True if read-only data are the known ones."""
    if len(known) != len(values):
        return False
    pairs = zip(known, values, strict=True)
    return all(old() is new and not new.flags.writeable for old, new in pairs)


def _canonical(matrix: csr_matrix) -> csr_matrix:
    """Return the matrix with sorted columns, each once."""
    if not matrix.has_canonical_format:
        matrix = matrix.copy()
        matrix.sum_duplicates()
    return matrix


def _union(matrices: Sequence[csr_matrix]) -> csr_matrix:
    """Return the entries of any of the matrices."""
    ones = [with_data(matrix, np.ones(matrix.nnz, dtype=np.int8)) for matrix in matrices]
    ones.sort(key=lambda matrix: matrix.nnz)  # the largest one is gone through once
    union = reduce(csr_matrix.maximum, ones)
    union.has_canonical_format = True  # like the matrices
    # a known pattern need not be compared again
    union.indices.flags.writeable = False
    union.indptr.flags.writeable = False
    return union


def _find(matrix: csr_matrix, pattern: csr_matrix) -> ndarray | None:
    """Return the slots of a matrix in a pattern, or None if one is missing.

    They are numbers or, if many, a mask.
    """
    counts = np.diff(matrix.indptr)
    available = np.diff(pattern.indptr)
    if (counts > available).any():
        return None
    # rows of as many entries are as in the pattern, or not within it; search the others
    shift = pattern.indptr[:-1] - matrix.indptr[:-1]
    position = np.arange(matrix.nnz) + np.repeat(shift, counts)
    rows = np.flatnonzero((counts > 0) & (counts < available))
    if len(rows):
        n = matrix.shape[1]
        entry = _entries(matrix, rows)
        within = _entries(pattern, rows)
        keys = np.repeat(rows * n, available[rows]) + pattern.indices[within]
        wanted = np.repeat(rows * n, counts[rows]) + matrix.indices[entry]
        slot = np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)
        position[entry] = within[slot]
    if not np.array_equal(pattern.indices.take(position), matrix.indices):
        return None
    if 8 * len(position) < pattern.nnz:  # the mask would take more memory
        return position
    mask = np.zeros(pattern.nnz, bool)
    mask[position] = True
    return mask


def _entries(matrix: csr_matrix, rows: ndarray) -> ndarray:
    """Return the positions of all entries of some rows."""
    start = matrix.indptr[rows].astype(int)
    count = np.diff(matrix.indptr)[rows]
    before = np.cumsum(count) - count
    return np.arange(count.sum()) + np.repeat(start - before, count)
