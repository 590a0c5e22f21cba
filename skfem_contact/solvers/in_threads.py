"""Products of large sparse matrices with vectors, by rows in threads."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from itertools import pairwise

import numpy as np
from numpy import ndarray
from scipy.sparse import bsr_matrix, csr_matrix

from .threads import allowed

#: Entries of the rows of a thread whose product takes ten times as long as the call of the thread.
_MANY = 500_000


class InThreads:
    """Large sparse matrix whose products are computed by parts of the rows in threads.

    No part changes the rows of another, so that the digits do not depend on the number of threads.
    scipy lets other threads run meanwhile: of 18 million entries two threads take .56 of the time.
    """

    def __init__(self, A: bsr_matrix | csr_matrix) -> None:
        self.whole = A
        self._threads = min(allowed(), A.nnz // _MANY)
        if self._threads > 1:
            self._parts = _parts(A, self._threads)

    def __matmul__(self, x: ndarray) -> ndarray:
        """Return A x for a vector (N,) or for vectors (N, n)."""
        if self._threads < 2:
            return np.asarray(self.whole @ x)
        products = _pool(self._threads).map(lambda part: part @ x, self._parts)
        return np.concatenate(list(products))


@cache
def _pool(threads: int) -> ThreadPoolExecutor:
    """Return threads that wait for work."""
    return ThreadPoolExecutor(threads)


if hasattr(os, "register_at_fork"):  # a forked process has none of the threads
    os.register_at_fork(after_in_child=_pool.cache_clear)


def _parts(A: bsr_matrix | csr_matrix, count: int) -> list[bsr_matrix | csr_matrix]:
    """Divide a matrix into rows with about as many entries each, which share its data."""
    n = len(A.indptr) - 1
    height = A.shape[0] // n
    shares = np.arange(1, count) / count
    cuts = np.searchsorted(A.indptr, shares * A.indptr[-1])
    parts = []
    for first, last in pairwise([0, *cuts, n]):
        begin, end = A.indptr[[first, last]]
        entries = A.data[begin:end], A.indices[begin:end], A.indptr[first : last + 1] - begin
        part = type(A)(entries, shape=(height * (last - first), A.shape[1]))
        part.data, part.indices = entries[:2]  # of which scipy has made copies
        parts.append(part)
    return parts
