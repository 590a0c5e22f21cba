"""Algebraic multigrid for large bodies: pyamg's smoothed aggregation with the rigid motions of every body."""

from __future__ import annotations

import logging
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from typing import Any

import numpy as np
from numpy import ndarray
from scipy.sparse import bsr_matrix, csr_matrix
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import LinearOperator, splu

from ..errors import NotConverged
from ..layout import rigid_modes
from ..sparse import FreeBlock
from .direct import REFINE, WRONG, DirectSolver, LinearSolver, SingularSystem, Solve

logger = logging.getLogger("skfem_contact")

Balance = Callable[[ndarray, ndarray], ndarray]

MOST = 300  # iterations of a solution
# Levels are kept for the next tangents until these take so many iterations more than the first did: new levels
# cost as much as 9 to 12 iterations (9,000 to 52,000 dofs under a paraboloid in contact).
KEPT = 10
RESTART = 100  # iterations of FGMRES whose directions are kept, two vectors each
# Dofs in space for each iteration that takes as long as a factorisation: a paraboloid in contact, 50,240 dofs,
# is factored in 1.4 s by PARDISO and in 7.2 s by SuperLU, times that grow with the square of the dofs; an
# iteration takes 0.062 s.  Blocks without stretched elements take 20 iterations or more.
PER_ITERATION = {"pardiso": 2000, "superlu": 500}
FEWEST = 20
# Aggregates do not follow couplings of nodes below this share of their diagonals; others cost more iterations.
STRENGTH = ("symmetric", {"theta": 0.08})
# A level of at most so many nodes is factored: beams of 30 and 100 times their height take 16 and 26 iterations
# (30 and 53 with pyamg's 10 nodes), plates of 1:50 take 33 (59).  With 1000 nodes a cube of 71,000 dofs takes 3.5 s
# for 2.6 s, in 13 iterations with both.
COARSEST = 300


class AmgSolver:
    """Conjugate gradients, or FGMRES where K is not symmetric or not definite, preconditioned by algebraic multigrid.

    Coarse levels consist of aggregates of nodes and represent the rigid motions of every body exactly.  The levels are
    built from the whole tangent and contain the coupling by contact.  A factor of the block of the interface removes
    the residual that the levels leave there, where penalties are large.  Contact therefore costs few iterations,
    whatever the penalty.  Time and memory grow in proportion to the dofs.  Nearly incompressible material and stretched
    elements increase the number of iterations.

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
    P. Vaněk, J. Mandel, M. Brezina, Algebraic multigrid by smoothed aggregation for second and fourth order elliptic
    problems, Computing 56 (1996) 179-196.  Y. Saad, A flexible inner-outer preconditioned GMRES algorithm, SIAM J. Sci.
    Comput. 14 (1993) 461-469.
    """

    name = "algebraic multigrid (pyamg)"

    def __init__(self, locations: ndarray, free: ndarray, interface: ndarray | None = None,
                 most: int | None = None) -> None:
        self._aggregation = _smoothed_aggregation()
        self._locations, dim = locations, len(locations)
        nodes = np.unique(np.asarray(free) // dim)
        self._dofs = (dim * nodes[:, None] + np.arange(dim)).ravel()  # of whole nodes
        self._held = ~np.isin(self._dofs, free)
        self._block = FreeBlock(self._dofs)
        self._interface = np.flatnonzero(np.isin(self._dofs, [] if interface is None else interface))
        self._levels: _Levels | None = None
        self._most = MOST if most is None else most
        logger.info("linear solver: %s", self.name)

    @property
    def iterations(self) -> int:
        """Number of iterations of the last solution."""
        return 0 if self._levels is None else self._levels.last

    def factor(self, K: csr_matrix, symmetric: bool = False) -> Solve:
        """Prepare the solution, see :meth:`DirectSolver.factor`; the callable raises NotConverged if it fails."""
        if len(self._dofs) == 0:
            return np.zeros_like
        block = self._without_held(self._block.gather(K))
        try:
            balanced = _balance(block, self._interface)
        except RuntimeError as error:  # an exact zero among the pivots
            raise SingularSystem("the interface can move without force", self._dofs[self._interface]) from error
        A = block.tobsr(2 * (len(self._locations),))
        levels = self._levels
        if levels is None or levels.worn:
            self._levels = levels = None  # its memory is free for the next ones
            self._levels = levels = self._built(A)

        def solve(b: ndarray) -> ndarray:
            assert self._levels is not None
            right, x = np.where(self._held, 0.0, b[self._dofs]), np.zeros(len(b))
            try:
                x[self._dofs] = self._levels.solve(A, balanced, right, symmetric, self._most)
            except NotConverged as error:
                if self._levels.finest is A:
                    raise
                logger.info("%s; with new levels:", error)
                self._levels = self._built(A)
                x[self._dofs] = self._levels.solve(A, balanced, right, symmetric, self._most)
            return x

        return solve

    def _without_held(self, A: csr_matrix) -> csr_matrix:
        """Remove all but the diagonal from the rows and columns of prescribed dofs."""
        if not np.isfinite(A.data).all():
            raise ValueError("the stiffness has entries that are not finite")
        row = np.repeat(np.arange(A.shape[0]), np.diff(A.indptr))
        A.data[(self._held[row] | self._held[A.indices]) & (row != A.indices)] = 0.0
        loose = np.flatnonzero(A.diagonal() == 0.0)
        if len(loose):
            raise SingularSystem(f"{len(loose)} dofs meet no stiffness, the first is {self._dofs[loose[0]]}",
                                 self._dofs[loose])
        return A

    def _built(self, A: bsr_matrix) -> _Levels:
        """Build the levels of a matrix."""
        dim = len(self._locations)
        graph = csr_matrix((np.ones(len(A.indices)), A.indices, A.indptr))
        count, body = connected_components(graph, directed=False)
        body = np.repeat(body, dim)
        modes = np.empty((len(body), dim * (dim + 1) // 2))
        for number in range(count):
            modes[body == number] = rigid_modes(self._locations, self._dofs[body == number])
        modes[self._held] = 0.0
        with _repeatable():
            # the modes are exact: their improvement takes longer than the iterations that it saves
            levels = self._aggregation(A, modes, strength=STRENGTH, improve_candidates=None, max_coarse=COARSEST,
                                       coarse_solver="splu")
        logger.info("multigrid: %d bodies, %s dofs on the levels", count,
                    ", ".join(str(level.A.shape[0]) for level in levels.levels))
        return _Levels(A, levels.aspreconditioner())


def _balance(A: csr_matrix, at: ndarray) -> Balance:
    """Return the function (x, b) -> x that removes the residual b - A x of some dofs; RuntimeError if singular.

    A preconditioner that ends with this balance is symmetric for all residuals that vanish there, as all residuals of
    its iterations do.
    """
    rows = A[at]
    solve = splu(rows[:, at].tocsc()).solve if len(at) else None

    def balanced(x: ndarray, b: ndarray) -> ndarray:
        if solve is not None:
            x[at] += solve(b[at] - rows @ x)
        return x

    return balanced


class _Levels:
    """Multigrid levels of one matrix, and solutions with this matrix and similar ones."""

    def __init__(self, finest: bsr_matrix, cycle: LinearOperator) -> None:
        self.finest, self._cycle = finest, cycle
        self._first, self.last = 0, 0

    @property
    def worn(self) -> bool:
        """True if the last solution took many more iterations than the first, so that new levels pay."""
        return self.last > self._first + KEPT

    def solve(self, A: bsr_matrix, balanced: Balance, b: ndarray, symmetric: bool, most: int) -> ndarray:
        """Solve A x = b to a relative residual of `REFINE`, or to the residual that round-off leaves."""
        size = float(np.linalg.norm(b))
        if not np.isfinite(size):
            raise ValueError("the right-hand side has entries that are not finite")
        x, count, wanted = balanced(np.zeros_like(b), b), 0, REFINE
        error = float(np.linalg.norm(b - A @ x)) / size if size > 0.0 else 0.0
        cycle = LinearOperator(A.shape, lambda r: balanced(self._cycle @ r, r), dtype=float)
        for method in (_conjugate_gradients if symmetric else _fgmres, _fgmres):
            if error > wanted and count < most:
                step, taken = method(A, b - A @ x, cycle, wanted / error, most - count)
                candidate, count = balanced(x + step, b), count + taken
                improved = float(np.linalg.norm(b - A @ candidate)) / size
                if improved < error:
                    x, error = candidate, improved
                if error > REFINE:
                    wanted = max(REFINE, _round_off(A, x) / size)
        self.last, self._first = count, self._first or count
        if not error <= (WRONG if count < most else wanted):
            raise NotConverged(f"algebraic multigrid does not converge, its relative residual is {error:.1e} after "
                               f"{count} iterations: bodies may be loose, very thin or nearly incompressible")
        return x


def _round_off(A: bsr_matrix, x: ndarray) -> float:
    """Estimate the residual that round-off leaves: 7e-9 of the load of a beam 30 times as long as high."""
    magnitude = bsr_matrix((np.abs(A.data), A.indices, A.indptr), shape=A.shape)
    return float(np.finfo(float).eps * np.linalg.norm(magnitude @ np.abs(x)))


def _conjugate_gradients(A: bsr_matrix, b: ndarray, cycle: LinearOperator, tolerance: float, most: int
                         ) -> tuple[ndarray, int]:
    """Return the solution and the number of iterations; an A that is not definite ends them.

    The residual follows the recursion.  Recomputed from x every few iterations, as by pyamg, the residual stagnates
    at 1e-7 on slender beams and then grows.
    """
    x, residual, target = np.zeros_like(b), b.copy(), tolerance * np.linalg.norm(b)
    direction, product = np.zeros_like(b), np.inf
    for count in range(most):
        preconditioned = cycle @ residual
        product, last = float(residual @ preconditioned), product
        direction = preconditioned + product / last * direction
        image = A @ direction
        curvature = float(direction @ image)
        if not curvature > 0.0:
            return x, count
        x += product / curvature * direction
        residual -= product / curvature * image
        if np.linalg.norm(residual) <= target:
            return x, count + 1
    return x, most


def _fgmres(A: bsr_matrix, b: ndarray, cycle: LinearOperator, tolerance: float, most: int) -> tuple[ndarray, int]:
    """Return the solution and the number of iterations."""
    from pyamg import krylov

    residuals: list[float] = []
    limits = {"restart": RESTART, "maxiter": -(-most // RESTART)} if most > RESTART else {"maxiter": most}
    with warnings.catch_warnings(record=True):  # the residual reports the same
        x, _ = krylov.fgmres(A, b, tol=tolerance, M=cycle, residuals=residuals, **limits)
    return x, len(residuals) - 1


class AmgOrDirect:
    """Algebraic multigrid up to a number of iterations; from its first failure on a direct solver."""

    def __init__(self, locations: ndarray, free: ndarray, interface: ndarray | None = None, engine: str | None = None,
                 most: int | None = None) -> None:
        self._locations, self._free, self._engine = locations, free, engine
        self._solver: LinearSolver = AmgSolver(locations, free, interface, most)

    @property
    def name(self) -> str:
        """Name of the solver in use."""
        return self._solver.name

    def factor(self, K: csr_matrix, symmetric: bool = False) -> Solve:
        """Prepare the solution of K[free, free] x[free] = b[free]; see :meth:`DirectSolver.factor`."""
        first = self._solver.factor(K, symmetric)

        def solve(b: ndarray) -> ndarray:
            try:
                return first(b)
            except NotConverged as error:
                logger.info("%s; a direct solver takes over", error)
                if isinstance(self._solver, AmgSolver):
                    self._solver = DirectSolver(self._locations, self._free, self._engine)
                return self._solver.factor(K, symmetric)(b)

        return solve


def iterations_that_pay(locations: ndarray, free: ndarray, engine: str) -> int:
    """Return the iterations that cost less than a factorisation by an engine; 0 where multigrid does not pay."""
    most = len(free) // PER_ITERATION[engine]
    return most if len(locations) == 3 and most >= FEWEST and find_spec("pyamg") is not None else 0


def _smoothed_aggregation() -> Callable[..., Any]:
    """Import pyamg's solver, or raise an ImportError that says how to install pyamg."""
    try:
        from pyamg import smoothed_aggregation_solver
    except ImportError as error:
        raise ImportError('solver="amg" needs pyamg: pip install "skfem-contact[amg]"') from error
    return smoothed_aggregation_solver


@contextmanager
def _repeatable() -> Iterator[None]:
    """Give pyamg the same random numbers in every run, and keep those of the user."""
    state = np.random.get_state()  # noqa: NPY002  # pyamg draws from the global generator
    np.random.seed(0)  # noqa: NPY002
    try:
        yield
    finally:
        np.random.set_state(state)  # noqa: NPY002
