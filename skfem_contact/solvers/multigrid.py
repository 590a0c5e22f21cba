"""Algebraic multigrid for large bodies: pyamg's smoothed aggregation, given the rigid motions of every body."""
from __future__ import annotations

import logging
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components

from ..errors import NotConverged
from ..sparse import FreeBlock, same_matrix
from ..unknowns import rigid_modes
from .direct import REFINE, WRONG, DirectSolver, LinearSolver, SingularSystem, Solve

logger = logging.getLogger("skfem_contact")

LARGE = 50_000  # free unknowns in space from which several solutions cost less than one factorisation
MOST = 300  # iterations of a solution
# Aggregates do not follow couplings of nodes below this share of their diagonals; others cost more iterations.
STRENGTH = ("symmetric", {"theta": 0.08})


class AmgSolver:
    """Conjugate gradients, or BiCGSTAB where K is not symmetric, preconditioned by algebraic multigrid.

    The coarse levels, made of aggregates of nodes, represent the rigid motions of every body exactly, three in the
    plane and six in space. Time and memory grow in proportion to the unknowns; iterations become more where
    the material is nearly incompressible and where bodies or elements are thin.

    Parameters
    ----------
    locations
        (dim, N), the place of each unknown; the components of a node follow each other.
    free
        Indices of the unknowns to solve for; the others are zero in every solution.

    Raises
    ------
    ImportError
        pyamg is not installed.

    References
    ----------
    P. Vaněk, J. Mandel, M. Brezina, Algebraic multigrid by smoothed aggregation for second and fourth order elliptic
    problems, Computing 56 (1996) 179-196.
    """

    name = "algebraic multigrid (pyamg)"

    def __init__(self, locations: ndarray, free: ndarray) -> None:
        self._aggregation = _smoothed_aggregation()
        self._locations, dim = locations, len(locations)
        nodes = np.unique(np.asarray(free) // dim)
        self._unknowns = (dim * nodes[:, None] + np.arange(dim)).ravel()  # of whole nodes
        self._held = ~np.isin(self._unknowns, free)
        self._block = FreeBlock(self._unknowns)
        self._last: _Iteration | None = None
        logger.info("linear solver: %s", self.name)

    def factor(self, K: csr_matrix, symmetric: bool = False) -> Solve:
        """Prepare the solution of K[free, free] x[free] = b[free] for any b (N,).

        Raises
        ------
        SingularSystem
            An unknown meets no stiffness.
        ValueError
            K has entries that are not finite.
        NotConverged
            By the callable that is returned: the iterations do not converge.
        """
        if len(self._unknowns) == 0:
            return np.zeros_like
        A = self._without_held(self._block.gather(K))
        iteration = self._last
        if iteration is None or not iteration.solves(A, symmetric):
            self._last = iteration = None  # its memory is free for the next one
            self._last = iteration = self._prepared(A, symmetric)

        def solve(b: ndarray) -> ndarray:
            x = np.zeros(len(b))
            x[self._unknowns] = iteration(np.where(self._held, 0.0, b[self._unknowns]))
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

    def _prepared(self, A: csr_matrix, symmetric: bool) -> _Iteration:
        """The levels for a matrix."""
        dim = len(self._locations)
        blocks = A.tobsr((dim, dim))
        graph = csr_matrix((np.ones(len(blocks.indices)), blocks.indices, blocks.indptr))
        count, body = connected_components(graph, directed=False)
        body = np.repeat(body, dim)
        modes = np.empty((len(body), dim * (dim + 1) // 2))
        for number in range(count):
            modes[body == number] = rigid_modes(self._locations, self._unknowns[body == number])
        modes[self._held] = 0.0
        with _repeatable():
            # the modes are exact as they are: to improve them takes longer than the iterations that it saves
            levels = self._aggregation(blocks, modes, strength=STRENGTH, improve_candidates=None)
        logger.info("multigrid: %d bodies, %s unknowns on the levels", count,
                    ", ".join(str(level.A.shape[0]) for level in levels.levels))
        return _Iteration(A, levels, symmetric)


class _Iteration:
    """Solution of A x = b to a small residual."""

    def __init__(self, A: csr_matrix, levels: Any, symmetric: bool) -> None:
        self._A, self._levels, self._symmetric = A, levels, symmetric

    def solves(self, A: csr_matrix, symmetric: bool) -> bool:
        """Whether this is the iteration for a matrix."""
        return symmetric == self._symmetric and same_matrix(A, self._A)

    def __call__(self, b: ndarray) -> ndarray:
        size = float(np.linalg.norm(b))
        if not np.isfinite(size):
            raise ValueError("the right-hand side has entries that are not finite")
        x = np.zeros_like(b)
        residual, error = b, 1.0 if size > 0.0 else 0.0
        for _ in range(2):  # round-off may hide what is left of the residual within one run
            if error > REFINE:
                with warnings.catch_warnings(record=True):  # pyamg's, of what the residual tells as well
                    x = x + self._levels.solve(residual, tol=REFINE / error, maxiter=MOST,
                                               accel="cg" if self._symmetric else "bicgstab")
                residual = b - self._A @ x
                error = float(np.linalg.norm(residual)) / size
        if not error <= WRONG:
            raise NotConverged(f"algebraic multigrid does not converge, its relative residual is {error:.1e}: bodies "
                               "may be loose, very thin or nearly incompressible; direct solvers need no convergence")
        return x


class AmgOrDirect:
    """Algebraic multigrid until it fails once, a direct solver from then on.

    Parameters
    ----------
    locations, free
        As for :class:`AmgSolver`.
    """

    def __init__(self, locations: ndarray, free: ndarray) -> None:
        self._locations, self._free = locations, free
        self._solver: LinearSolver = AmgSolver(locations, free)

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
                    self._solver = DirectSolver(self._locations, self._free)
                return self._solver.factor(K, symmetric)(b)

        return solve


def amg_pays(locations: ndarray, free: ndarray) -> bool:
    """Whether multigrid costs less than a factorisation of symmetric elastic bodies, and pyamg is installed.

    Parameters
    ----------
    locations, free
        As for :class:`AmgSolver`.
    """
    if len(locations) < 3 or len(free) < LARGE:
        return False
    try:
        _smoothed_aggregation()
    except ImportError:
        return False
    return True


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
