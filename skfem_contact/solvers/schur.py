"""Schur complement of an interface: elastic bodies in contact are factored once.

The dofs inside the bodies are eliminated, which leaves the Schur complement S of the contact
surfaces, the condensed stiffness of the interface. A tangent ``K + P dK P^T`` whose change dK lies
on the interface costs two solutions with the old factors and a small dense system

    z = K^-1 b,    (S + dK) x_S = S z_S,    x = K^-1 (b - P dK x_S).

Once elastic bodies are in equilibrium inside, the residual acts on the interface alone: then S z_S
= b_S, and one solution is enough.
"""

from __future__ import annotations

import logging
import warnings
from collections.abc import Callable

import numpy as np
from numpy import ndarray
from scipy.linalg import LinAlgWarning, lu_factor, lu_solve
from scipy.sparse import csr_matrix

from ..arrays import max_abs
from ..sparse import FreeBlock, same_pattern, widened, within
from .direct import REFINE, SOFT, Condensed, Engine, LinearSolver, Solve, any_motion, as_engine

logger = logging.getLogger("skfem_contact")

#: The dense system may cost this share of a factorisation.
_SHARE = 0.3
#: Entries of the dense system over those of the matrix, at most: bodies that touch everywhere, such
#: as thin strips, are not worth it.
_DENSE = 10
_NOTHING = 1e-8  # relative size of the forces inside the bodies that round-off leaves of none
_WRONG = 1e-6  # relative residual from which the solution is left to the other solver


class SchurSolver:
    """Linear solver that keeps its factors while the tangent changes on an interface only.

    Other tangents are solved by `solver`. The engine computes the kept factors; by default the
    fastest one that is installed.
    """

    def __init__(
        self,
        solver: LinearSolver,
        locations: ndarray,
        free: ndarray,
        interface: ndarray,
        engine: str | None = None,
    ) -> None:
        self._solver = solver
        self._engine = as_engine(engine)
        self._locations = locations
        self._on_interface = np.zeros(locations.shape[1], bool)
        self._on_interface[np.intersect1d(interface, free)] = True
        self._free = free
        self._last: csr_matrix | None = None
        self._base: _Base | None = None
        self._worth = True

    @property
    def name(self) -> str:
        """Name for the log."""
        return self._solver.name

    def factor(self, K: csr_matrix, symmetric: bool = False) -> Solve:
        """Prepare the solution of K[free, free] x[free] = b[free]."""
        last = self._last
        self._last = K

        def other() -> Solve:
            return self._solver.factor(K, symmetric)

        # solve with the factors that are kept
        if self._base is not None:
            if not same_pattern(K, self._base.K):  # contact has got new entries
                self._base.K = widened(self._base.K, K)
            change = self._change(K, self._base.K)
            if change is not None:
                return self._base.updated(K, change, other)
        self._base = None

        # condense the first tangent, or one whose change lies on the interface
        if self._worth and (last is None or self._change(K, last) is not None):
            self._base = _Base.of(K, self._locations, self._free, self._on_interface, self._engine)
            if self._base is not None:
                return self._base.first(other)
            self._worth = False
        return other()

    def _change(self, K: csr_matrix, old: csr_matrix) -> csr_matrix | None:
        """Return the change of the free block if it lies on the interface, else None."""
        # collect the entries that differ
        if same_pattern(K, old):
            entries = np.flatnonzero(K.data != old.data)
            row: ndarray = np.searchsorted(K.indptr, entries, side="right") - 1
            col = K.indices[entries]
            data = K.data[entries] - old.data[entries]
        else:
            change = (K - old).tocoo()
            row = change.row
            col = change.col
            data = change.data

        # keep entries among free dofs, which must lie on the interface
        free = np.zeros(K.shape[0], bool)
        free[self._free] = True
        kept = (data != 0.0) & free[row] & free[col]
        row = row[kept]
        col = col[kept]
        if not (self._on_interface[row].all() and self._on_interface[col].all()):
            return None
        return csr_matrix((data[kept], (row, col)), shape=K.shape)


class _Base:
    """Factors of one tangent that is condensed to the m dofs of the interface.

    Multipliers, which no element gives stiffness to, are left to the dense system: `apart`.
    """

    def __init__(
        self,
        K: csr_matrix,
        order: ndarray,
        apart: ndarray,
        m: int,
        condensed: Condensed,
    ) -> None:
        self.K = K
        self._order = order
        self._apart = apart
        self._m = m
        self._condensed = condensed
        self._all = np.concatenate((order, apart))
        self._ends = np.concatenate((order[-m:], apart))  # dofs of the dense system
        self._added = within(K, self._ends).toarray()
        self._added[:m, :m] = 0.0

    @classmethod
    def of(
        cls,
        K: csr_matrix,
        locations: ndarray,
        free: ndarray,
        on_interface: ndarray,
        engine: Engine,
    ) -> _Base | None:
        """Condense K; None where the interface is too large or pivots are too small."""
        # order the dofs: inner ones, then the interface; multipliers couple with no inner dof
        inner = free[~on_interface[free]]
        last = free[on_interface[free]]
        coupled = np.diff(K[last][:, inner].indptr) > 0
        apart = last[~coupled]
        last = last[coupled]
        m = len(last)
        if m == 0 or len(inner) == 0 or m**2 > _DENSE * K.nnz:
            return None
        inner = inner[engine.order(within(K, inner), locations[:, inner])]
        order = np.concatenate((inner, last))

        # eliminate the inner dofs
        condensed = engine.condensed(FreeBlock(order).gather(K), m, _SHARE)
        if condensed is None:
            return None
        logger.info("elastic bodies in contact: factored once, %d dofs on the interface", m)
        return cls(K, order, apart, m, condensed)

    def first(self, other: Callable[[], Solve]) -> Solve:
        """Prepare solutions with the condensed tangent; `other` where a motion has no stiffness."""
        solve = self.updated(self.K, csr_matrix(self.K.shape), other)
        scale = np.abs(self.K.diagonal())
        if max_abs(solve(scale * any_motion(len(scale)))) < 1.0 / SOFT:
            return solve
        return other()

    def updated(self, K: csr_matrix, change: csr_matrix, other: Callable[[], Solve]) -> Solve:
        """Prepare solutions with the factored tangent plus `change`.

        `other` solves where they are inaccurate.
        """
        order = self._order
        ends = self._ends
        m = self._m
        delta = self._added + within(change, ends).toarray()

        # leave multipliers of open nodes out of the dense system
        in_columns = np.count_nonzero(delta, axis=0)
        in_rows = np.count_nonzero(delta, axis=1)
        single = (in_columns == 1) & (in_rows == 1)
        single &= np.diagonal(delta) != 0.0
        single[:m] = False
        live = np.flatnonzero(~single)
        alone = np.flatnonzero(single)
        total = delta[np.ix_(live, live)]
        total[:m, :m] += self._condensed.schur
        scale = np.abs(total).max(axis=1)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", LinAlgWarning)
            dense = lu_factor(total, overwrite_a=True, check_finite=False)
        if not np.diagonal(dense[0]).all():  # an exact zero among the pivots
            return other()
        # leave tangents with a motion that hardly anything resists to the other solver
        motion = lu_solve(dense, scale * any_motion(len(scale)))
        if not max_abs(motion) < 1.0 / SOFT:
            return other()

        # eliminate the interior, solve on the interface, and insert
        def once(b: ndarray, inside: bool = True) -> ndarray:
            x = np.zeros_like(b)

            def on_interface(load: ndarray) -> ndarray:
                right = np.concatenate((load, b[self._apart]))
                right[live] = lu_solve(dense, right[live])
                right[alone] /= delta[alone, alone]
                x[self._apart] = right[m:]
                return right[:m]

            x[order] = self._condensed.solve(b[order], inside, on_interface)
            return x

        def unbalanced(x: ndarray, b: ndarray) -> tuple[ndarray, float]:
            residual = np.zeros_like(b)
            residual[self._all] = (b - K @ x)[self._all]
            size = max(float(np.linalg.norm(b[self._all])), 1e-300)
            return residual, float(np.linalg.norm(residual)) / size

        def solve(b: ndarray, rtol: float = REFINE) -> ndarray:
            in_bodies = np.linalg.norm(b[order[:-m]])
            inside = bool(in_bodies > _NOTHING * np.linalg.norm(b[ends]))
            x = once(b, inside)
            residual, error = unbalanced(x, b)
            accepted = REFINE if inside else 10.0 * _NOTHING
            if error > accepted:
                x = x + once(residual)
                error = unbalanced(x, b)[1]
            if error <= _WRONG:
                return x
            return other()(b, rtol)

        return solve
