"""Levels of algebraic multigrid: aggregates by pyamg, polynomial smoothers, coarse matrices."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
from numpy import ndarray
from scipy.sparse import bsr_matrix, csr_matrix
from scipy.sparse.linalg import splu
from typing_extensions import override

from ..arrays import max_abs
from ..errors import NotConverged
from ..sparse import same_pattern, with_data
from .in_threads import InThreads

logger = logging.getLogger("skfem_contact")

# Aggregates do not follow couplings of nodes below this share of their diagonals; others cost more
# iterations.
STRENGTH = ("symmetric", {"theta": 0.08})
# A level of at most so many nodes is factored: beams of 30 and 100 times their height take 16 and
# 26 iterations (30 and 53 with pyamg's 10 nodes), plates of 1:50 take 33 (59).  With 1000 nodes a
# cube of 71,000 dofs takes 3.5 s for 2.6 s, in 13 iterations with both.
COARSEST = 300
#: Degree of the smoother's polynomial, and the smallest eigenvalue that it reduces over the largest
#: one.
_DEGREE = 3
_LOWEST = 0.05
#: Products for the largest eigenvalue from any vector and from that of the last matrix, and the
#: factor by which they may miss it.
_FIRST = 15
_NEXT = 4
_MISSED = 1.1


class Levels:
    """Prolongators of one matrix, which serve for similar matrices as well, and coarse matrices.

    Where soil yields, the smoother of the tangent itself saves three of four iterations that the
    smoother of an earlier tangent takes, for any coarse matrices.
    """

    def __init__(self, pattern: csr_matrix, A: bsr_matrix, modes: ndarray) -> None:
        self._pattern = pattern
        with _repeatable():
            # the modes are exact: their improvement takes longer than the iterations that it saves
            made = smoothed_aggregation()(
                A,
                modes,
                strength=STRENGTH,
                improve_candidates=None,
                max_coarse=COARSEST,
                coarse_solver="splu",
                presmoother=None,
                postsmoother=None,
            )
        self.sizes = [level.A.shape[0] for level in made.levels]
        self._prolongators = [level.P for level in made.levels[:-1]]
        self._largest: ndarray | None = None
        self._set([level.A for level in made.levels[1:]])

    def fit(self, pattern: csr_matrix) -> bool:
        """Return True if the prolongators were made for this pattern."""
        return same_pattern(pattern, self._pattern)

    def update(self, A: bsr_matrix) -> None:
        """Compute the coarse matrices of a matrix; the prolongators stay."""
        matrices = []
        for P in self._prolongators:
            A = P.T.tobsr(P.blocksize[::-1]) @ (A @ P)
            matrices.append(A)
        self._set(matrices)

    def cycle(
        self,
        A: csr_matrix,
        blocks: bsr_matrix,
        single: bool = False,
    ) -> Callable[[ndarray], ndarray]:
        """Return the V-cycle of a matrix, with a smoother in single precision if asked for."""
        if not self._prolongators:
            return splu(A.tocsc()).solve
        if single:
            finest: Smoother = SingleSmoother(A, blocks, self._largest)
        else:
            finest = Smoother(blocks, self._largest)
        self._largest = finest.largest
        return lambda r: self._descend(0, finest, r)

    def _set(self, matrices: list[bsr_matrix]) -> None:
        self._smoothers = [Smoother(A) for A in matrices[:-1]]
        self._transfers = [(P.tocsr(), P.T.tocsr()) for P in self._prolongators]
        self._coarsest = None
        if matrices:
            self._coarsest = _solution(matrices[-1])

    def _descend(self, level: int, smoother: Smoother, r: ndarray) -> ndarray:
        """Return the correction by a level and those below it."""
        x = smoother.from_zero(r)
        P, R = self._transfers[level]
        coarse = R @ (r - smoother.A @ x)
        if level + 1 == len(self._transfers):
            assert self._coarsest is not None
            x += P @ self._coarsest(coarse)
        else:
            x += P @ self._descend(level + 1, self._smoothers[level], coarse)
        return smoother.onwards(x, r)


class Smoother:
    """Chebyshev's polynomial of a matrix that is scaled by its blocks of nodes."""

    def __init__(self, A: bsr_matrix, largest: ndarray | None = None) -> None:
        # products with blocks take two thirds of the time of those with single entries
        self.A = InThreads(A)
        self._set(self.A, _inverse_blocks(A), largest)

    def from_zero(self, b: ndarray) -> ndarray:
        """Return an approximation of the solution for b."""
        return self._correction(b.copy())

    def onwards(self, x: ndarray, b: ndarray) -> ndarray:
        """Return an approximation closer than x."""
        return x + self._correction(b - self.A @ x)

    def _set(
        self,
        multiplied: InThreads,
        inverse: ndarray,
        largest: ndarray | None,
    ) -> None:
        """Set the matrix of the polynomial and its inverse blocks, and find the eigenvalues."""
        self._multiplied = multiplied
        self._inverse = inverse
        highest = self._highest(largest)
        self._middle = 0.5 * highest * (1.0 + _LOWEST)
        self._half = 0.5 * highest * (1.0 - _LOWEST)

    def _correction(self, residual: ndarray) -> ndarray:
        """Return the steps of the polynomial in sum; the residual changes in place."""
        ratio = self._middle / self._half
        step = self._scaled(residual) / self._middle
        x = step.copy()
        share = 1.0 / ratio
        for _ in range(_DEGREE - 1):
            residual -= self._multiplied @ step
            last = share
            share = 1.0 / (2.0 * ratio - share)
            step = share * last * step + (2.0 * share / self._half) * self._scaled(residual)
            x += step
        return x

    def _scaled(self, r: ndarray) -> ndarray:
        size = self._inverse.shape[1]
        return np.einsum("nij,nj->ni", self._inverse, r.reshape(-1, size)).ravel()

    def _highest(self, start: ndarray | None) -> float:
        """Return the largest eigenvalue by the power method."""
        products = _NEXT
        vector = start
        if vector is None:
            products = _FIRST
            n = self._inverse[:, :, 0].size
            vector = np.random.default_rng(0).standard_normal(n)
        vector = vector.astype(self._inverse.dtype)
        for _ in range(products):
            self.largest = vector / np.linalg.norm(vector)
            vector = self._scaled(self._multiplied @ self.largest)
        return _MISSED * float(np.linalg.norm(vector))


class SingleSmoother(Smoother):
    """Chebyshev's polynomial in single precision, of residuals in double precision.

    Products take two thirds of the time. The matrix is divided by the stiffness of its softest
    node, a residual by its largest entry, so that both may have any units.
    """

    def __init__(self, A: csr_matrix, blocks: bsr_matrix, largest: ndarray | None = None) -> None:
        self.A = InThreads(blocks)
        inverse = _inverse_blocks(blocks)
        self._stiffness = 1.0 / max_abs(inverse)
        entries = np.empty(A.nnz, np.float32)
        np.divide(A.data, self._stiffness, out=entries, casting="same_kind")
        inverse = (self._stiffness * inverse).astype(np.float32)
        self._set(InThreads(with_data(A, entries)), inverse, largest)

    @override
    def _correction(self, residual: ndarray) -> ndarray:
        size = max_abs(residual)
        if size == 0.0:
            return np.zeros_like(residual)
        x = super()._correction((residual / size).astype(np.float32))
        return size / self._stiffness * x.astype(float)


def _inverse_blocks(A: bsr_matrix) -> ndarray:
    """Return the inverse blocks of nodes on the diagonal, (n, size, size)."""
    from pyamg.util.utils import get_block_diag

    return np.asarray(get_block_diag(A, A.blocksize[0], inv_flag=True))


def _solution(coarsest: bsr_matrix) -> Callable[[ndarray], ndarray]:
    """Return the solution of a coarse matrix; modes of fixed aggregates have no stiffness."""
    A = coarsest.tocsc()
    A.eliminate_zeros()
    moves = np.flatnonzero(np.diff(A.indptr))
    try:
        solve = splu(A[moves][:, moves]).solve
    except RuntimeError as error:  # an exact zero among the pivots
        raise NotConverged(
            "the coarsest matrix of algebraic multigrid is singular: bodies may be loose"
        ) from error

    def solution(b: ndarray) -> ndarray:
        x = np.zeros_like(b)
        x[moves] = solve(b[moves])
        return x

    return solution


def smoothed_aggregation() -> Callable[..., Any]:
    """Import pyamg's solver, or raise an ImportError that says how to install pyamg."""
    try:
        from pyamg import smoothed_aggregation_solver
    except ImportError as error:
        raise ImportError('solver="amg" needs pyamg: pip install "skfem-contact[amg]"') from error
    return smoothed_aggregation_solver


@contextmanager
def _repeatable() -> Iterator[None]:
    """Give pyamg the same random numbers in every run, and keep the user's generator."""
    state = np.random.get_state()  # noqa: NPY002  # pyamg draws from the global generator
    np.random.seed(0)  # noqa: NPY002
    try:
        yield
    finally:
        np.random.set_state(state)  # noqa: NPY002
