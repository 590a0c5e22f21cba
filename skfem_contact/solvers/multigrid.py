"""Algebraic multigrid for large bodies: smoothed aggregation with their rigid motions."""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from importlib.util import find_spec

import numpy as np
from numpy import ndarray
from scipy.sparse import bsr_matrix, csr_matrix
from scipy.sparse.linalg import splu

from ..errors import NotConverged
from .direct import (
    REFINE,
    UNCHECKED,
    WRONG,
    DirectSolver,
    LinearSolver,
    SingularSystem,
    Solve,
    nothing_free,
)
from .in_threads import InThreads
from .krylov import Fgmres, Preconditioner, conjugate_gradients
from .levels import Levels, smoothed_aggregation
from .whole_nodes import WholeNodes

logger = logging.getLogger("skfem_contact")

Balance = Callable[[ndarray, ndarray], ndarray]
Method = Callable[[InThreads, ndarray, Preconditioner, float, int], tuple[ndarray, int]]

MOST = 300  # iterations of a solution
# Coarse matrices are kept for the next tangents until the additional iterations have cost more
# than new ones, which take as long as 9 to 11 iterations (9,000 to 36,000 dofs of yielding soil).
KEPT = 15
# Dofs in space for each iteration that takes as long as a factorisation: a paraboloid in contact,
# 50,240 dofs, is factored in 1.4 s by PARDISO and in 7.2 s by SuperLU, times that grow with the
# square of the dofs; an iteration takes 0.062 s.  Blocks without stretched elements take 20
# iterations or more.
PER_ITERATION = {"pardiso": 2000, "superlu": 500}
# Where bodies yield, rough solutions are enough, in 4 to 15 iterations: of a footing with 36,501
# dofs PARDISO factors a tangent in 25 iterations' time, SuperLU in three times as long.  Up to 50
# are tried before a factor replaces them.
PER_ITERATION_YIELDING = {"pardiso": 700, "superlu": 500}
FEWEST = 20
#: Relative residual from which on a solution is rough: it may leave a tenth after the largest
#: number of iterations. With rough residuals of .1 a footing of 10,000 dofs takes 29 iterations of
#: Newton's method for 28.
ROUGH = 1e-3
ENOUGH = 0.1
#: Residual from which on a solution is far from equilibrium, and iterations after which it ends
#: with any residual. Mechanisms are about to form then, along which directions that are more
#: accurate lead away.  After one that leaves more than a tenth the next may take twice as many.  A
#: footing of 98,301 dofs takes 57 iterations of Newton's method and 524 of the linear solver; with
#: 100 for each solution it takes 59 and 587. Newton's method asks for .03 far from equilibrium, and
#: for .01 or less near it.
_FAR = 0.02
_EARLY = 25


class AmgSolver:
    """Conjugate gradients or FGMRES, preconditioned by algebraic multigrid.

    FGMRES solves where K is not symmetric or not definite. Coarse levels consist of aggregates of
    nodes and represent the rigid motions of every body exactly. The levels are built from the whole
    tangent and contain the coupling by contact. A factor of the block of the interface removes the
    residual that the levels leave on it, where penalties are large. Contact therefore costs few
    iterations, whatever the penalty. Time and memory grow in proportion to the dofs. Nearly
    incompressible material and stretched elements increase the number of iterations.

    Parameters
    ----------
    locations, free
        See :class:`DirectSolver`.
    interface
        Dofs of surfaces in contact.
    most
        Largest number of iterations of a solution.

    References
    ----------
    P. Vaněk, J. Mandel, M. Brezina, Algebraic multigrid by smoothed aggregation for second and
    fourth order elliptic problems, Computing 56 (1996) 179-196.  Y. Saad, A flexible inner-outer
    preconditioned GMRES algorithm, SIAM J. Sci. Comput. 14 (1993) 461-469.
    """

    name = "algebraic multigrid (pyamg)"

    def __init__(
        self,
        locations: ndarray,
        free: ndarray,
        interface: ndarray | None = None,
        most: int | None = None,
    ) -> None:
        smoothed_aggregation()
        self._nodes = WholeNodes(locations, free)
        on_interface = np.isin(self._nodes.dofs, [] if interface is None else interface)
        self._interface = np.flatnonzero(on_interface)
        self._most = MOST if most is None else most
        # levels, the iterations that they took a digit, and the iterations spent beyond these
        self._levels: Levels | None = None
        self._rate = 0.0
        self._spent = 0.0
        self.iterations = 0
        self._early = _EARLY
        self._fgmres = Fgmres()
        logger.info("linear solver: %s", self.name)

    def factor(self, K: csr_matrix, symmetric: bool = False) -> Solve:
        """Prepare the solution, see :meth:`DirectSolver.factor`.

        The callable raises NotConverged if it fails.
        """
        if len(self._nodes.dofs) == 0:
            return nothing_free

        A = self._nodes.gather(K)
        balanced = self._balance(A)
        blocks = self._nodes.blocks(A)

        # keep the levels of an earlier matrix as long as their iterations pay
        levels = self._levels
        fresh = self._spent > KEPT
        if levels is None or fresh:
            levels = self._renewed(A, blocks)
            fresh = True
        single = not symmetric  # FGMRES alone admits cycles that round-off makes unsymmetric
        cycle = levels.cycle(A, blocks, single)
        first = conjugate_gradients if symmetric else self._fgmres
        methods = (first, self._fgmres)
        multiplied = InThreads(blocks)

        def solve(b: ndarray, rtol: float = REFINE) -> ndarray:
            nonlocal cycle, fresh
            if rtol >= UNCHECKED:
                rtol = REFINE
            right = self._nodes.taken(b)
            far = rtol >= _FAR
            self._fgmres.forgets = far
            most = self._most
            if far:
                most = min(self._most, self._early)

            # iterate with the present coarse matrices as long as they pay, then with new ones
            patience = most
            if not fresh:
                patience = min(most, self._patience(rtol))
            result = _iterated(
                multiplied,
                cycle,
                balanced,
                right,
                methods,
                patience,
                rtol,
            )
            self.iterations = result.count
            remaining = most
            if far:
                remaining = most - result.count
            if remaining > 0 and not (result.close or fresh):
                cycle = self._renewed(A, blocks).cycle(A, blocks, single)
                fresh = True
                result = _iterated(
                    multiplied,
                    cycle,
                    balanced,
                    right,
                    methods,
                    remaining,
                    rtol,
                    result.x,
                )
                self.iterations += result.count
            self._judge(result, rtol, most, fresh)

            return self._nodes.placed(result.x, len(b))

        return solve

    def _judge(self, result: _Result, rtol: float, most: int, fresh: bool) -> None:
        """Refuse a solution that is too rough, and learn from its iterations."""
        logger.debug(
            "multigrid: %d iterations to a residual of %.1e", self.iterations, result.error
        )
        failed = rtol < ROUGH or (most == self._most and result.error > ENOUGH)
        if failed and not result.close:
            raise NotConverged(
                f"algebraic multigrid does not converge, its relative residual is "
                f"{result.error:.1e} after {self.iterations} iterations: bodies may be loose, "
                "very thin or nearly incompressible"
            )
        if result.close:
            self._count(result, fresh)
        if rtol >= _FAR:
            self._end_early(result, fresh)

    def _patience(self, rtol: float) -> int:
        """Return the iterations up to which coarse matrices of an earlier tangent pay."""
        return int(self._rate * -np.log10(rtol) + KEPT - self._spent) + 1

    def _end_early(self, result: _Result, fresh: bool) -> None:
        """Decide when the next solution far from equilibrium ends, and on its coarse matrices."""
        if result.close and self.iterations <= _EARLY:
            self._early = _EARLY
        elif result.error > ENOUGH:
            self._early *= 2
        if not (result.close or fresh):
            self._spent = KEPT + 1.0

    def _count(self, result: _Result, fresh: bool) -> None:
        """Count the iterations that other coarse matrices would have saved."""
        if fresh:
            self._rate = max(self._rate, result.count / max(result.digits, 1.0))
        self._spent += max(0.0, result.count - self._rate * result.digits)

    def _renewed(self, A: csr_matrix, blocks: bsr_matrix) -> Levels:
        """Return levels of A, with the known aggregates if A has their pattern."""
        self._rate = 0.0
        self._spent = 0.0
        levels = self._levels
        if levels is not None and levels.fit(A):
            levels.update(blocks)
            return levels
        self._levels = levels = None  # its memory is free for the next ones
        self._levels = levels = self._built(A, blocks)
        return levels

    def _built(self, A: csr_matrix, blocks: bsr_matrix) -> Levels:
        """Build the levels of a matrix."""
        modes, count = self._nodes.rigid_modes(blocks)
        levels = Levels(A, blocks, modes)
        logger.info(
            "multigrid: %d bodies, %s dofs on the levels", count, ", ".join(map(str, levels.sizes))
        )
        return levels

    def _balance(self, A: csr_matrix) -> Balance:
        """Return the function (x, b) -> x that removes the residual b - A x of the interface.

        A preconditioner that ends with this balance is symmetric for all residuals that vanish on
        the interface, as all residuals of its iterations do.
        """
        indices = self._interface
        if len(indices) == 0:
            return lambda x, b: x
        rows = A[indices]
        try:
            solve = splu(rows[:, indices].tocsc()).solve
        except RuntimeError as error:  # an exact zero among the pivots
            raise SingularSystem(
                "the interface can move without force", self._nodes.dofs[indices]
            ) from error

        def balanced(x: ndarray, b: ndarray) -> ndarray:
            x[indices] += solve(b[indices] - rows @ x)
            return x

        return balanced


@dataclass(frozen=True)
class _Result:
    """Solution with its relative residual, which is `close` if it is small or round-off."""

    x: ndarray
    count: int
    first: float  # residual of the start
    error: float
    close: bool

    @property
    def digits(self) -> float:
        """Decimal digits by which the iterations have reduced the residual."""
        if self.error > 0.0:
            return float(np.log10(self.first / self.error))
        return 0.0


def _iterated(
    A: InThreads,
    cycle: Preconditioner,
    balanced: Balance,
    b: ndarray,
    methods: Sequence[Method],
    most: int,
    rtol: float,
    start: ndarray | None = None,
) -> _Result:
    """Solve A x = b to a relative residual, or to the residual that round-off leaves."""
    # start from a balanced guess
    size = float(np.linalg.norm(b))
    if not np.isfinite(size):
        raise ValueError("the right-hand side has entries that are not finite")
    if start is None:
        start = np.zeros_like(b)
    x = balanced(start, b)
    error = 0.0
    if size > 0.0:
        error = float(np.linalg.norm(b - A @ x)) / size
    first = error
    count = 0
    wanted = rtol

    def preconditioned(r: ndarray) -> ndarray:
        return balanced(cycle(r), r)

    # improve the solution by one method after the other
    for method in methods:
        if error <= wanted or count >= most:
            continue
        step, taken = method(A, b - A @ x, preconditioned, wanted / error, most - count)
        count += taken
        candidate = balanced(x + step, b)
        improved = float(np.linalg.norm(b - A @ candidate)) / size
        if improved < error:
            x = candidate
            error = improved
        if error > rtol:
            wanted = max(rtol, _round_off(A.whole, x) / size)
    enough = wanted
    if count < most:
        enough = max(WRONG, rtol)
    return _Result(x, count, first, error, close=error <= enough)


def _round_off(A: bsr_matrix | csr_matrix, x: ndarray) -> float:
    """Estimate the residual of round-off: 7e-9 of the load of a beam 30 times as long as high."""
    magnitudes = abs(A) @ np.abs(x)
    return float(np.finfo(float).eps * np.linalg.norm(magnitudes))


class InTurn:
    """Linear solvers in turn: after the first failure of one the next takes over for good."""

    def __init__(self, *makers: Callable[[], LinearSolver]) -> None:
        self._makers = list(makers)
        self._solver = self._makers.pop(0)()

    @property
    def name(self) -> str:
        """Name of the solver in use."""
        return self._solver.name

    def factor(self, K: csr_matrix, symmetric: bool = False) -> Solve:
        """Prepare the solution of K[free, free] x[free] = b[free]."""
        solver = self._solver
        try:
            first = solver.factor(K, symmetric)
        except NotConverged as error:
            self._replace(solver, error)
            return self.factor(K, symmetric)

        def solve(b: ndarray, rtol: float = REFINE) -> ndarray:
            try:
                return first(b, rtol)
            except NotConverged as error:
                self._replace(solver, error)
                return self.factor(K, symmetric)(b)

        return solve

    def _replace(self, failed: LinearSolver, error: NotConverged) -> None:
        """Let the next solver take over, unless it has; raise the error of the last one."""
        if failed is not self._solver:
            return
        if not self._makers:
            raise error
        logger.info("%s; a direct solver takes over", error)
        self._solver = self._makers.pop(0)()


class AmgOrDirect(InTurn):
    """Algebraic multigrid up to a number of iterations; a direct solver after its first failure."""

    def __init__(
        self,
        locations: ndarray,
        free: ndarray,
        interface: ndarray | None = None,
        engine: str | None = None,
        most: int | None = None,
    ) -> None:
        super().__init__(
            partial(AmgSolver, locations, free, interface, most),
            partial(DirectSolver, locations, free, engine, single=True),
        )


def iterations_that_pay(locations: ndarray, free: ndarray, engine: str, yielding: bool) -> int:
    """Return the iterations that cost less than factors; 0 where multigrid does not pay."""
    per_iteration = PER_ITERATION
    if yielding:
        per_iteration = PER_ITERATION_YIELDING
    most = len(free) // per_iteration[engine]
    if len(locations) < 3 or most < FEWEST or find_spec("pyamg") is None:
        return 0
    return most
