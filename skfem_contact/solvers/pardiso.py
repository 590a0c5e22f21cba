"""MKL PARDISO as an engine of the direct solver: one analysis serves for all tangents of a mesh."""

from __future__ import annotations

import os
import weakref
from collections.abc import Callable
from contextlib import suppress
from ctypes import c_int, c_void_p
from functools import cache
from importlib.metadata import PackageNotFoundError, files
from typing import Any

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix, eye, triu

from ..arrays import max_abs
from ..sparse import same_pattern, with_data
from .threads import allowed

UNSYMMETRIC, SYMMETRIC, DEFINITE = 11, -2, 2  # PARDISO's types of real matrices
ANALYSE, FACTOR, SOLVE, RELEASE = 11, 22, 33, -1  # its phases
FORWARD, BACKWARD = 331, 333  # parts of the solution
OUT_OF_MEMORY = -2  # its error
#: Own options, METIS, pivots above 1e-18, scaling, matching.
OPTIONS = {1: 1, 2: 2, 10: 18, 11: 1, 13: 1}
#: Smallest pivots of a matrix whose factor is wrong otherwise, after scaling and matching. Rows are
#: exchanged within small blocks only, so that regular matrices may have pivots of round-off.
ENLARGE = {10: 8}
#: Of a positive definite matrix: no scaling and matching, and the parallel factor of two levels,
#: which alone solves for three columns in the time of 1.6, not of 2.4. Factor and solution take .7
#: of the time for indefinite matrices.
CHOLESKY = {11: 0, 13: 0, 24: 1}
#: Of a matrix that is condensed: its number of operations is estimated, and the Schur complement
#: is computed beside the factors. It needs neither scaling nor matching.
CONDENSE = {11: 0, 13: 0, 19: -1, 36: 2}
#: Unit of the estimated operations.
MILLION = 1e6
#: Entries up to which minimum degree replaces METIS: with 10,000 to 90,000 of plane bodies the
#: analysis takes 13 to 35 % less time and the factor 4 to 13 %; with 350,000 factors take 15 to 30
#: % more, with 130,000 in space 17 %.
FEW = 100_000
#: Entries from which a factor is computed by all threads that the process may use. On two free
#: cores they save a quarter of an iteration in the plane from 3,000 dofs on, but with one more
#: process they take up to four times as long as one thread, since each waits for the other at every
#: small block.
MANY = 300_000
#: Difference of both triangles, as a share of the largest entry, that is round-off.
SAME = 1e-12
SPARE = 1.1  # entries of an analysed pattern to those of the matrix, at most


class Pardiso:
    """Engine of MKL, through the library of pypardiso; ImportError where it is not installed.

    An analysis costs as much as a factor and is kept for all matrices whose pattern lies within the
    analysed one, so that contacts may open and close.  Without scaling and matching PARDISO returns
    wrong solutions of indefinite systems and reports no error.
    """

    name = "MKL PARDISO"
    cholesky = True

    def __init__(self) -> None:
        self._library = _library()
        self._analysis: _Analysis | None = None
        self._factored: csr_matrix | None = None

    def order(self, graph: csr_matrix, locations: ndarray) -> ndarray:
        """Return the given order: PARDISO computes its own."""
        return np.arange(graph.shape[0])

    def outdated(self) -> bool:
        """Return False: PARDISO orders each new pattern itself."""
        return False

    def factor(
        self,
        A: csr_matrix,
        symmetric: bool,
        careful: bool = False,
        definite: bool = False,
    ) -> Callable[[ndarray], ndarray]:
        """Factor A and return its solution; `careful` scales and matches by its values.

        No use is made of symmetry then.
        """
        kind = UNSYMMETRIC
        if definite:
            kind = DEFINITE
        elif symmetric and not careful:
            kind = SYMMETRIC
        self._prepare(A, kind, careful)

        def solve(b: ndarray) -> ndarray:
            if self._factored is not A:  # another matrix was factored since
                self._prepare(A, kind, careful)
            assert self._analysis is not None
            return self._analysis.solve(b)

        return solve

    def enlarged(self, A: csr_matrix) -> Callable[[ndarray], ndarray]:
        """Factor A by scaling and matching, with pivots of at least 1e-8; refinement does the rest.

        An analysis of its own leaves the one for later matrices as it is.
        """
        analysis = _Analysis(self._library, _complete(A), A, UNSYMMETRIC, ENLARGE)
        analysis.factor(A)
        return analysis.solve

    def condensed(self, A: csr_matrix, m: int, most: float) -> Condensed | None:
        """Condense A to its last m dofs, within a share of a factor's operations.

        Return None where that costs more, A is not symmetric beside the last dofs, or its diagonal
        is not positive.
        """
        return Condensed.of(A, m, most)

    def _prepare(self, A: csr_matrix, kind: int, afresh: bool) -> None:
        """Factor A with the present analysis, or with a new one where it does not serve."""
        self._factored = None
        analysis = self._analysis
        if analysis is None or afresh or not analysis.admits(A, kind):
            pattern = _complete(A)
            if analysis is not None:
                both = pattern + analysis.pattern
                if both.nnz < SPARE * A.nnz:
                    pattern = both
            self._analysis = analysis = None  # its memory is free for the next one
            options = CHOLESKY if kind == DEFINITE else {}
            analysis = _Analysis(self._library, pattern, A, kind, options)
            self._analysis = analysis
        analysis.factor(A)
        self._factored = A


class _Analysis:
    """PARDISO's analysis of one pattern, and the factor of the last values on it."""

    def __init__(
        self,
        library: _Library,
        pattern: csr_matrix,
        A: csr_matrix,
        kind: int,
        options: dict[int, int],
    ) -> None:
        self.pattern = _ones(pattern)
        self._kind = kind
        self._dtype = A.dtype
        self._last: csr_matrix | None = None
        self._positions: ndarray | slice

        # store rows and columns as PARDISO does: from 1 on, the upper triangle if symmetric
        n = pattern.shape[0]
        row = np.repeat(np.arange(n), np.diff(pattern.indptr))
        self._stored: ndarray | slice = slice(None)
        if kind != UNSYMMETRIC:
            self._stored = np.flatnonzero(pattern.indices >= row)
        entries = np.bincount(row[self._stored] + 1, minlength=n + 1)
        self._rows = np.cumsum(entries, dtype=np.int32) + 1
        self._columns = pattern.indices[self._stored].astype(np.int32) + 1

        # analyse, and release the memory with this object
        self._call = _Call(library, kind, pattern.nnz, A.dtype == np.float32)
        self._call.set(options)
        self.admits(A, kind)
        self._run(ANALYSE, A)
        release = weakref.finalize(
            self, self._call, RELEASE, np.zeros(1), self._rows, self._columns
        )
        release.atexit = False

    def admits(self, A: csr_matrix, kind: int) -> bool:
        """Return True if A is of the analysed kind and its pattern lies within the analysed one."""
        if kind != self._kind or A.dtype != self._dtype:
            return False
        if self._last is not None and same_pattern(A, self._last):
            return True
        if same_pattern(A, self.pattern):
            self._last = A
            self._positions = slice(None)
            return True
        # find the positions of A's entries by their numbers in the pattern
        numbers = with_data(self.pattern, np.arange(1.0, self.pattern.nnz + 1))
        common = numbers.multiply(_ones(A)).tocsr()
        if common.nnz < A.nnz:
            return False
        self._last = A
        self._positions = common.data.astype(np.int64) - 1
        return True

    def factor(self, A: csr_matrix) -> None:
        """Factor an admitted matrix."""
        self._run(FACTOR, A)

    def solve(self, b: ndarray) -> ndarray:
        """Solve with the matrix factored last, for one column b (n,) or several, (n, n_columns)."""
        b = np.asfortranarray(b)
        x = np.empty_like(b)
        self._call(SOLVE, self._values, self._rows, self._columns, b, x)
        return x

    def _run(self, phase: int, A: csr_matrix) -> None:
        """Run a phase with the values of A."""
        values = np.zeros(self.pattern.nnz, self._dtype)
        values[self._positions] = A.data
        self._values = values[self._stored]
        self._call(phase, self._values, self._rows, self._columns)


class Condensed:
    """Factors of a symmetric matrix whose last m dofs are not eliminated.

    Attributes
    ----------
    schur : ndarray, shape (m, m)
        Schur complement of the last dofs.
    """

    def __init__(self, A: csr_matrix, m: int) -> None:
        # store the upper triangle, with a diagonal instead of the last block
        n = A.shape[0]
        last = np.arange(n - m, n)
        upper = triu(A, format="coo")
        inner = upper.row < n - m
        self._diagonal = abs(A[last]).max(axis=1).toarray().ravel()
        values = np.append(upper.data[inner], self._diagonal)
        row = np.append(upper.row[inner], last)
        column = np.append(upper.col[inner], last)
        places = row, column
        upper = csr_matrix((values, places), shape=A.shape)
        upper.sort_indices()
        self._m = m
        self.schur = np.zeros((m, m))
        self._values = upper.data
        self._rows = upper.indptr.astype(np.int32) + 1
        self._columns = upper.indices.astype(np.int32) + 1

        # analyse, and release the memory with this object
        self._call = _Call(_library(), SYMMETRIC, A.nnz, single=False)
        self._call.keep(np.arange(n) >= n - m)
        self._run(ANALYSE)
        release = weakref.finalize(
            self, self._call, RELEASE, np.zeros(1), self._rows, self._columns
        )
        release.atexit = False

    @classmethod
    def of(cls, A: csr_matrix, m: int, most: float) -> Condensed | None:
        """Return the condensed matrix, see :meth:`Pardiso.condensed`."""
        # refuse matrices that are not symmetric beside the last block; PARDISO writes beyond its
        # memory where diagonal entries are missing
        inner = A.shape[0] - m
        difference = A[:inner] - A[:, :inner].T
        largest = max_abs(A.data)
        if abs(difference).max() > SAME * largest or not (A.diagonal()[:inner] > 0.0).all():
            return None
        new = cls(A, m)
        if m**3 > 3.0 * most * new._call.operations:
            return None

        # eliminate, and put the last block back
        try:
            new._run(FACTOR, None, new.schur)
        except RuntimeError:  # an exact zero among the pivots
            return None
        new.schur += A[inner:, inner:].toarray() - np.diag(new._diagonal)
        return new

    def solve(self, b: ndarray, inside: bool, last: Callable[[ndarray], ndarray]) -> ndarray:
        """Solve for b (n,); `last` returns the last dofs from their right-hand side.

        Without `inside` the other entries of b are zero.
        """
        y = self._part(FORWARD, b) if inside else b.copy()
        y[-self._m :] = last(y[-self._m :])
        return self._part(BACKWARD, y)

    def _part(self, phase: int, b: ndarray) -> ndarray:
        """Return the result of a part of the solution."""
        x = np.empty_like(b)
        self._run(phase, b, x)
        return x

    def _run(self, phase: int, *vectors: ndarray | None) -> None:
        """Run a phase."""
        self._call(phase, self._values, self._rows, self._columns, *vectors)


def _complete(A: csr_matrix) -> csr_matrix:
    """Return the pattern of A with every diagonal entry, which PARDISO wants."""
    return _ones(A) + eye(A.shape[0], format="csr")


def _ones(A: csr_matrix) -> csr_matrix:
    """Return the pattern of A with entries one, so that sums keep the pattern."""
    return with_data(A, np.ones(A.nnz))


@cache
def _library() -> _Library:
    """Return the entry points of MKL, which are found once."""
    return _Library()


class _Call:
    """Phases of PARDISO on one handle, with the number of threads of the analysis.

    Another number is not safe.
    """

    def __init__(self, library: _Library, kind: int, entries: int, single: bool) -> None:
        self._library = library
        self._kind = kind
        self._threads = allowed() if entries >= MANY else 1
        self._handle = np.zeros(64, dtype=np.intp)
        self._options = np.zeros(64, dtype=np.int32)
        self.set(OPTIONS)
        if entries <= FEW:
            self._options[1] = 0
        self._options[27] = single
        # arguments that are the same in every call
        self._one = _integer(1)
        self._zero = _integer(0)
        self._kept: ndarray | None = None
        self._type = _integer(kind)
        self._addresses = self._handle.ctypes.data, self._options.ctypes.data

    def set(self, options: dict[int, int]) -> None:
        """Set options by their numbers, from 1 on."""
        for number, value in options.items():
            self._options[number - 1] = value

    def keep(self, kept: ndarray) -> None:
        """Condense the matrix to the dofs of a mask."""
        self._kept = kept.astype(np.int32)
        self.set(CONDENSE)

    @property
    def operations(self) -> float:
        """Estimated number of operations of a factor that is condensed, after the analysis.

        It is rounded up to millions.
        """
        return MILLION * float(self._options[18] + 1)

    def __call__(
        self,
        phase: int,
        values: ndarray,
        rows: ndarray,
        columns: ndarray,
        *vectors: ndarray | None,
    ) -> None:
        # Give the addresses of the arguments.
        one = self._one
        zero = self._zero
        error = _integer(0)
        handle, options = self._addresses
        matrix = [each.ctypes.data for each in (values, rows, columns)]
        b, x = [None if each is None else each.ctypes.data for each in vectors] or (None, None)
        if self._kept is None:
            kept = self._zero
        else:
            kept = self._kept.ctypes.data
        n = len(rows) - 1
        size = _integer(n)
        n_columns = one
        if vectors and vectors[0] is not None:
            n_columns = _integer(vectors[0].size // n)

        # Use the threads of the analysis for this call alone.
        before = self._library.limit(self._threads)
        self._library.pardiso(
            handle,
            one,
            one,
            self._type,
            _integer(phase),
            size,
            *matrix,
            kept,
            n_columns,
            options,
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


def _integer(value: int) -> Any:
    """Return an integer that a library reads and changes by its address."""
    return (c_int * 1)(value)


class _Library:
    """Entry points of MKL."""

    def __init__(self) -> None:
        # without the path pypardiso looks through all directories, for 1.5 s
        with suppress(PackageNotFoundError):
            for path in files("mkl") or ():
                if "mkl_rt" in path.name:
                    os.environ.setdefault("PYPARDISO_MKL_RT", str(path.locate()))
        from pypardiso import ps

        self.pardiso = ps.libmkl["pardiso"]  # the subscript leaves pypardiso's own prototype alone
        self.pardiso.argtypes = 16 * [c_void_p]
        self.pardiso.restype = None
        # threads of this thread of Python; the call returns the last number
        self.limit = ps.libmkl["MKL_Set_Num_Threads_Local"]
        self.limit.argtypes = [c_int]
        self.limit.restype = c_int
