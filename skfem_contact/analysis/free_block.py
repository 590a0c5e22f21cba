"""The block of the free unknowns of a matrix whose pattern seldom changes."""

from __future__ import annotations

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix

from ..assembly import with_data


class FreeBlock:
    """K[order][:, order], gathered through an index map that is kept as long as the pattern of K stays.

    Parameters
    ----------
    order
        The unknowns of the block, in its order.

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
        if not K.has_canonical_format:
            K = K.copy()
            K.sum_duplicates()
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
