"""MKL PARDISO as an engine of the direct solver: one analysis serves for all tangents of a mesh."""

from __future__ import annotations

import os
import weakref
from collections.abc import Callable
from contextlib import suppress
from ctypes import c_int
from importlib.metadata import PackageNotFoundError, files

import numpy as np
from numpy import ndarray
from numpy.ctypeslib import ndpointer
from scipy.sparse import csr_matrix, eye

from ..sparse import same_pattern
from .threads import allowed

UNSYMMETRIC, SYMMETRIC = 11, -2  # PARDISO's types of real matrices
ANALYSE, FACTOR, SOLVE, RELEASE = 11, 22, 33, -1  # its phases
OUT_OF_MEMORY = -2  # its error
OPTIONS = {
    1: 1,
    2: 2,
    10: 18,
    11: 1,
    13: 1,
}  # own options, METIS, pivots above 1e-18, scaling, matching
#: Entries up to which minimum degree replaces METIS: with 10,000 to 90,000 of plane bodies the
#: analysis takes 13 to 35 % less time and the factor 4 to 13 %; with 350,000 factors take 15 to 30
#: % more, with 130,000 in space 17 %.
FEW = 100_000
#: Entries from which a factor is computed by all threads that the process may use. On two free
#: cores they save a quarter of an iteration in the plane from 3,000 dofs on, but beside one more
#: process they take up to four times as long as one thread, since each waits for the other at every
#: small block.
MANY = 300_000
SPARE = 1.1  # entries of an analysed pattern to those of the matrix, at most


class Pardiso:
    """Engine of MKL, through the library that pypardiso finds; ImportError where it is not
    installed.

    An analysis costs as much as a factor and is kept for all matrices whose pattern lies within the
    analysed one, so that contacts may open and close.  Without scaling and matching PARDISO returns
    wrong solutions of indefinite systems and reports no error.
    """

    name = "MKL PARDISO"

    def __init__(self) -> None:
        self._library = _Library()
        self._analysis: _Analysis | None = None
        self._factored: csr_matrix | None = None

    def order(self, graph: csr_matrix, locations: ndarray) -> ndarray:
        """Return the given order: PARDISO computes its own."""
        return np.arange(graph.shape[0])

    def outdated(self) -> bool:
        """Return False: PARDISO orders each new pattern itself."""
        return False

    def factor(
        self, A: csr_matrix, symmetric: bool, careful: bool = False
    ) -> Callable[[ndarray], ndarray]:
        """Factor A and return its solution; `careful` scales and matches by its values, without use
        of symmetry.
        """
        symmetric = symmetric and not careful
        self._prepare(A, symmetric, careful)

        def solve(b: ndarray) -> ndarray:
            if self._factored is not A:  # another matrix was factored since
                self._prepare(A, symmetric, careful)
            assert self._analysis is not None
            return self._analysis.solve(b)

        return solve

    def _prepare(self, A: csr_matrix, symmetric: bool, afresh: bool) -> None:
        analysis, self._factored = self._analysis, None
        if analysis is None or afresh or not analysis.admits(A, symmetric):
            pattern = _ones(A) + eye(A.shape[0], format="csr")  # PARDISO wants every diagonal entry
            if analysis is not None and (both := pattern + analysis.pattern).nnz < SPARE * A.nnz:
                pattern = both
            self._analysis = analysis = None  # its memory is free for the next one
            self._analysis = analysis = _Analysis(self._library, pattern, A, symmetric)
        analysis.factor(A)
        self._factored = A


class _Analysis:
    """PARDISO's analysis of one pattern and the factor of the last values on it; its memory ends
    with it.
    """

    def __init__(
        self, library: _Library, pattern: csr_matrix, A: csr_matrix, symmetric: bool
    ) -> None:
        self.pattern, self._symmetric, self._dtype = _ones(pattern), symmetric, A.dtype
        self._last: csr_matrix | None = None
        self._positions: ndarray | slice
        n, indptr, indices = pattern.shape[0], pattern.indptr, pattern.indices
        row = np.repeat(np.arange(n), np.diff(indptr))
        self._stored = np.flatnonzero(indices >= row) if symmetric else slice(None)
        self._rows = (
            np.cumsum(np.bincount(row[self._stored] + 1, minlength=n + 1), dtype=np.int32) + 1
        )
        self._columns = indices[self._stored].astype(np.int32) + 1
        self._call = _Call(
            library, SYMMETRIC if symmetric else UNSYMMETRIC, pattern.nnz, A.dtype == np.float32
        )
        self.admits(A, symmetric)
        self._run(ANALYSE, A)
        weakref.finalize(
            self, self._call, RELEASE, np.zeros(1), self._rows, self._columns
        ).atexit = False

    def admits(self, A: csr_matrix, symmetric: bool) -> bool:
        """Return True if A is of the analysed kind and its pattern lies within the analysed one."""
        if symmetric != self._symmetric or A.dtype != self._dtype:
            return False
        if self._last is not None and same_pattern(A, self._last):
            return True
        if same_pattern(A, self.pattern):
            self._last, self._positions = A, slice(None)
            return True
        numbers = csr_matrix(
            (np.arange(1.0, self.pattern.nnz + 1), self.pattern.indices, self.pattern.indptr),
            shape=A.shape,
        )
        common = numbers.multiply(_ones(A)).tocsr()
        if common.nnz < A.nnz:
            return False
        self._last, self._positions = A, common.data.astype(np.int64) - 1
        return True

    def factor(self, A: csr_matrix) -> None:
        """Factor an admitted matrix."""
        self._run(FACTOR, A)

    def solve(self, b: ndarray) -> ndarray:
        """Solve with the matrix factored last."""
        x = np.empty_like(b)
        self._call(SOLVE, self._values, self._rows, self._columns, b, x)
        return x

    def _run(self, phase: int, A: csr_matrix) -> None:
        values = np.zeros(self.pattern.nnz, self._dtype)
        values[self._positions] = A.data
        self._values = values[self._stored]
        self._call(phase, self._values, self._rows, self._columns)


def _ones(A: csr_matrix) -> csr_matrix:
    """Return the pattern of A with entries one, so that sums keep the pattern."""
    return csr_matrix((np.ones(A.nnz), A.indices, A.indptr), shape=A.shape)


class _Call:
    """Phases of PARDISO on one handle, with one number of threads: another one than at the analysis
    is not safe.
    """

    def __init__(self, library: _Library, kind: int, entries: int, single: bool) -> None:
        self._library, self._kind = library, kind
        self._threads = allowed() if entries >= MANY else 1
        self._handle = np.zeros(64, dtype=np.intp)
        self._options = np.zeros(64, dtype=np.int32)
        for number, value in OPTIONS.items():
            self._options[number - 1] = value
        if entries <= FEW:
            self._options[1] = 0
        self._options[27] = single

    def __call__(
        self, phase: int, values: ndarray, rows: ndarray, columns: ndarray, *vectors: ndarray
    ) -> None:
        one, zero, error, kind, phases, size = (
            np.array([value], dtype=np.int32)
            for value in (1, 0, 0, self._kind, phase, len(rows) - 1)
        )
        b, x = vectors or (np.zeros(1), np.zeros(1))
        before = self._library.limit(self._threads)
        self._library.pardiso(
            self._handle,
            one,
            one,
            kind,
            phases,
            size,
            values,
            rows,
            columns,
            zero,
            one,
            self._options,
            zero,
            b,
            x,
            error,
        )
        self._library.limit(before)
        if error[0] == OUT_OF_MEMORY:
            raise MemoryError("PARDISO: not enough memory for the factor")
        if error[0] != 0:
            raise RuntimeError(f"PARDISO stopped with error {error[0]}")


class _Library:
    """Entry points of MKL."""

    def __init__(self) -> None:
        with suppress(
            PackageNotFoundError
        ):  # without the path pypardiso looks through all directories, for 1.5 s
            for path in files("mkl") or ():
                if "mkl_rt" in path.name:
                    os.environ.setdefault("PYPARDISO_MKL_RT", str(path.locate()))
        from pypardiso import ps

        self.pardiso = ps.libmkl["pardiso"]  # the subscript leaves pypardiso's own prototype alone
        integers, reals = ndpointer(np.int32, flags="C"), ndpointer(flags="C")
        handle = ndpointer(np.intp, flags="C")
        self.pardiso.argtypes = [
            handle,
            *5 * [integers],
            reals,
            *6 * [integers],
            reals,
            reals,
            integers,
        ]
        self.pardiso.restype = None
        self.limit = ps.libmkl[
            "MKL_Set_Num_Threads_Local"
        ]  # of this thread of Python; returns the last one
        self.limit.argtypes, self.limit.restype = [c_int], c_int
