"""Algebraic multigrid for large bodies: pyamg's smoothed aggregation, given the rigid motions of every body."""
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

MOST = 300  # iterations of a solution
# Levels are kept for the next tangents until these take so many iterations more than the first did: to make them
# costs as much as 9 to 12 iterations (9,000 to 52,000 unknowns under a paraboloid in contact).
KEPT = 10
RESTART = 100  # iterations of FGMRES whose directions are kept, two vectors each
# Layout in space for each iteration that takes as long as a factorisation: a paraboloid in contact, 50,240 unknowns,
# is factored in 1.4 s by PARDISO and in 7.2 s by SuperLU, times that grow with the square of the unknowns; an
# iteration takes 0.062 s.  Blocks without stretched elements take 20 iterations or more.
PER_ITERATION = {"pardiso": 2000, "superlu": 500}
FEWEST = 20
# Aggregates do not follow couplings of nodes below this share of their diagonals; others cost more iterations.
STRENGTH = ("symmetric", {"theta": 0.08})


class AmgSolver:
    """Conjugate gradients, or FGMRES where K is not symmetric or not definite, preconditioned by algebraic multigrid.

    The coarse levels, made of aggregates of nodes, represent the rigid motions of every body exactly, three in the
    plane and six in space.  They are made from the whole tangent and see what contact couples; what they leave of the
    residual on the interface, where penalties are large, is removed by a factor of that block: contact then costs few
    iterations, whatever the penalty.  Time and memory grow in proportion to the unknowns; iterations become more where
    the material is nearly incompressible and where bodies or elements are thin.

    Parameters
    ----------
    locations, free
        As for :class:`DirectSolver`.
    interface
        Layout of surfaces in contact.
    most
        Iterations of a solution, at most.

    Raises
    ------
    ImportError
        pyamg is not installed.

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
        self._unknowns = (dim * nodes[:, None] + np.arange(dim)).ravel()  # of whole nodes
        self._held = ~np.isin(self._unknowns, free)
        self._block = FreeBlock(self._unknowns)
        self._interface = np.flatnonzero(np.isin(self._unknowns, [] if interface is None else interface))
        self._levels: _Levels | None = None
        self._most = MOST if most is None else most
        logger.info("linear solver: %s", self.name)

    @property
    def iterations(self) -> int:
        """Number of iterations of the last solution."""
        return 0 if self._levels is None else self._levels.last

    def factor(self, K: csr_matrix, symmetric: bool = False) -> Solve:
        """As :meth:`DirectSolver.factor`; the callable raises NotConverged where the iterations do not converge."""
        if len(self._unknowns) == 0:
            return np.zeros_like
        block = self._without_held(self._block.gather(K))
        try:
            interface = _Interface(block, self._interface)
        except RuntimeError as error:  # an exact zero among the pivots
            raise SingularSystem("the interface can move without force", self._unknowns[self._interface]) from error
        A = block.tobsr(2 * (len(self._locations),))
        levels = self._levels
        if levels is None or levels.worn:
            self._levels = levels = None  # its memory is free for the next ones
            self._levels = levels = self._built(A)

        def solve(b: ndarray) -> ndarray:
            assert self._levels is not None
            right, x = np.where(self._held, 0.0, b[self._unknowns]), np.zeros(len(b))
            try:
                x[self._unknowns] = self._levels.solve(A, interface, right, symmetric, self._most)
            except NotConverged as error:
                if self._levels.finest is A:
                    raise
                logger.info("%s; with new levels:", error)
                self._levels = self._built(A)
                x[self._unknowns] = self._levels.solve(A, interface, right, symmetric, self._most)
            return x

        return solve

    def _without_held(self, A: csr_matrix) -> csr_matrix:
        """The matrix with nothing but the diagonal in the rows and columns of unknowns that are held."""
        if not np.isfinite(A.data).all():
            raise ValueError("the stiffness has entries that are not finite")
        row = np.repeat(np.arange(A.shape[0]), np.diff(A.indptr))
        A.data[(self._held[row] | self._held[A.indices]) & (row != A.indices)] = 0.0
        loose = np.flatnonzero(A.diagonal() == 0.0)
        if len(loose):
            raise SingularSystem(f"{len(loose)} unknowns meet no stiffness, the first is {self._unknowns[loose[0]]}",
                                 self._unknowns[loose])
        return A

    def _built(self, A: bsr_matrix) -> _Levels:
        """The levels for a matrix."""
        dim = len(self._locations)
        graph = csr_matrix((np.ones(len(A.indices)), A.indices, A.indptr))
        count, body = connected_components(graph, directed=False)
        body = np.repeat(body, dim)
        modes = np.empty((len(body), dim * (dim + 1) // 2))
        for number in range(count):
            modes[body == number] = rigid_modes(self._locations, self._unknowns[body == number])
        modes[self._held] = 0.0
        with _repeatable():
            # the modes are exact as they are: to improve them takes longer than the iterations that it saves
            levels = self._aggregation(A, modes, strength=STRENGTH, improve_candidates=None)
        logger.info("multigrid: %d bodies, %s unknowns on the levels", count,
                    ", ".join(str(level.A.shape[0]) for level in levels.levels))
        return _Levels(A, levels.aspreconditioner())


class _Interface:
    """Factor of the block of some unknowns: RuntimeError where it is singular.

    A preconditioner that ends with the balance on the interface is symmetric for all residuals that vanish there, and
    all those of its iterations do.
    """

    def __init__(self, A: csr_matrix, at: ndarray) -> None:
        self._at, self._rows = at, A[at]
        self._solve = splu(self._rows[:, at].tocsc()).solve if len(at) else None

    def balanced(self, x: ndarray, b: ndarray) -> ndarray:
        """The vector with values on the interface that leave no residual b - A x there."""
        if self._solve is not None:
            x[self._at] += self._solve(b[self._at] - self._rows @ x)
        return x


class _Levels:
    """Levels made for one matrix, and solutions of small residual with it and with others that are like it."""

    def __init__(self, finest: bsr_matrix, cycle: LinearOperator) -> None:
        self.finest, self._cycle = finest, cycle
        self._first, self.last = 0, 0

    @property
    def worn(self) -> bool:
        """Whether new levels would pay: the last solution took many more iterations than the first."""
        return self.last > self._first + KEPT

    def solve(self, A: bsr_matrix, interface: _Interface, b: ndarray, symmetric: bool, most: int) -> ndarray:
        """Solution of A x = b."""
        size = float(np.linalg.norm(b))
        if not np.isfinite(size):
            raise ValueError("the right-hand side has entries that are not finite")
        x, count = interface.balanced(np.zeros_like(b), b), 0
        residual = b - A @ x
        error = float(np.linalg.norm(residual)) / size if size > 0.0 else 0.0
        cycle = LinearOperator(A.shape, lambda r: interface.balanced(self._cycle @ r, r), dtype=float)
        for method in ("cg" if symmetric else "fgmres", "fgmres"):  # twice: round-off may hide what is left
            if error > REFINE and count < most:
                step, taken = _krylov(method, A, residual, cycle, REFINE / error, most - count)
                x, count = interface.balanced(x + step, b), count + taken
                residual = b - A @ x
                error = float(np.linalg.norm(residual)) / size
        self.last, self._first = count, self._first or count
        if not error <= (WRONG if count < most else REFINE):
            raise NotConverged(f"algebraic multigrid does not converge, its relative residual is {error:.1e} after "
                               f"{count} iterations: bodies may be loose, very thin or nearly incompressible; direct "
                               "solvers need no convergence")
        return x


def _krylov(method: str, A: bsr_matrix, b: ndarray, cycle: LinearOperator, tolerance: float, most: int
            ) -> tuple[ndarray, int]:
    """Solution by one of pyamg's methods, as far as it comes, and its iterations."""
    from pyamg import krylov

    residuals: list[float] = []
    limits = {"maxiter": most}
    if method == "fgmres" and most > RESTART:
        limits = {"restart": RESTART, "maxiter": -(-most // RESTART)}
    with warnings.catch_warnings(record=True):  # pyamg's, of what the residual tells as well
        x, _ = getattr(krylov, method)(A, b, tol=tolerance, M=cycle, residuals=residuals, **limits)
    return x, len(residuals) - 1


class AmgOrDirect:
    """Algebraic multigrid while it takes less time than a factorisation; once it does not, a direct solver for good."""

    def __init__(self, locations: ndarray, free: ndarray, interface: ndarray, engine: str) -> None:
        self._locations, self._free, self._engine = locations, free, engine
        self._solver: LinearSolver = AmgSolver(locations, free, interface, _iterations_that_pay(free, engine))

    @property
    def name(self) -> str:
        """What solves, for the log."""
        return self._solver.name

    def factor(self, K: csr_matrix, symmetric: bool = False) -> Solve:
        """Prepare the solution of K[free, free] x[free] = b[free]; see :meth:`DirectSolver.factor`."""
        first = self._solver.factor(K, symmetric)

        def solve(b: ndarray) -> ndarray:
            try:
                return first(b)
            except NotConverged as error:
                logger.info("%s", error)
                if isinstance(self._solver, AmgSolver):
                    self._solver = DirectSolver(self._locations, self._free, self._engine)
                return self._solver.factor(K, symmetric)(b)

        return solve


def amg_pays(locations: ndarray, free: ndarray, engine: str) -> bool:
    """Whether multigrid may cost less than a factorisation by an engine in space, and pyamg is installed."""
    return len(locations) == 3 and _iterations_that_pay(free, engine) >= FEWEST and find_spec("pyamg") is not None


def _iterations_that_pay(free: ndarray, engine: str) -> int:
    return len(free) // PER_ITERATION[engine]


def _smoothed_aggregation() -> Callable[..., Any]:
    """Pyamg's solver, or an error that says how to get it."""
    try:
        from pyamg import smoothed_aggregation_solver
    except ImportError as error:
        raise ImportError('solver="amg" needs pyamg: pip install "skfem-contact[amg]"') from error
    return smoothed_aggregation_solver


@contextmanager
def _repeatable() -> Iterator[None]:
    """Give pyamg the same random numbers in every run, and keep those of the user."""
    state = np.random.get_state()  # noqa: NPY002  # pyamg's are the global ones
    np.random.seed(0)  # noqa: NPY002
    try:
        yield
    finally:
        np.random.set_state(state)  # noqa: NPY002
