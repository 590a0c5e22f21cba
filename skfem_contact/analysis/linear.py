"""Direct solution of K x = b for the free unknowns, made for many tangents on one mesh."""

from __future__ import annotations

import logging
from collections.abc import Callable
from typing import Any, Protocol

import numpy as np
from numpy import ndarray
from scipy.sparse import csc_matrix, csr_matrix, diags
from scipy.sparse.linalg import splu

from .ordering import nested_dissection

logger = logging.getLogger("skfem_contact")

Solve = Callable[[ndarray], ndarray]

SOFT = 1e-11  # a probe that grows by more than 1/SOFT is looked at more closely
SINGULAR = 1e-15  # relative stiffness of a free motion, by round-off alone
MOVES = 1e-3  # part of the largest entry from which an unknown takes part in a free motion
REFINE = 1e-10  # relative residual from which the solution is refined
WRONG = 1e-5  # relative residual that is refused


class SingularSystem(ValueError):
    """The free unknowns can move without force: a body floats.

    Parameters
    ----------
    message
        What is wrong.
    unknowns
        Indices of the unknowns that take part in the free motion.

    Examples
    --------
    >>> import numpy as np
    >>> str(SingularSystem("body 'wall' floats", np.array([4, 5])))
    "body 'wall' floats"
    """

    def __init__(self, message: str, unknowns: ndarray) -> None:
        super().__init__(message)
        self.unknowns = unknowns


class LinearSolver(Protocol):
    """What an analysis asks of a linear solver."""

    @property
    def name(self) -> str:
        """What solves, for the log."""
        ...

    def factor(self, K: csr_matrix, symmetric: bool = False) -> Solve:
        """Prepare the solution of K[free, free] x[free] = b[free] for any b (N,)."""
        ...


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
        """The block of `K`; blocks of equal patterns share their index arrays."""
        if not K.has_canonical_format:
            K = K.copy()
            K.sum_duplicates()
        if self._pattern is None or not _same_pattern(K, self._pattern):
            self._map(K)
        block = csr_matrix((K.data[self._entries], self._indices, self._indptr), shape=2 * (len(self.order),))
        block.has_canonical_format = True
        return block

    def _map(self, K: csr_matrix) -> None:
        self._pattern = K
        numbers = csr_matrix((np.arange(K.nnz), K.indices, K.indptr), shape=K.shape)
        block = numbers[self.order][:, self.order]
        block.sort_indices()
        self._entries, self._indices, self._indptr = block.data, block.indices, block.indptr


def _same_pattern(A: csr_matrix, B: csr_matrix) -> bool:
    return A.nnz == B.nnz and np.array_equal(A.indptr, B.indptr) and np.array_equal(A.indices, B.indices)


class SuperLU:
    """Engine of scipy: `splu` of a matrix that is already in a fill-reducing order."""

    name = "SuperLU with nested dissection"

    def factor(self, A: csr_matrix, symmetric: bool, careful: bool = False) -> Solve:
        """Solution of A x = b; `careful` pivots for accuracy rather than for sparsity."""
        transposed = csc_matrix((A.data, A.indices, A.indptr), shape=A.shape)
        transposed.has_canonical_format = True
        threshold, mode = (1.0, {}) if careful else (0.01, {"SymmetricMode": True})
        lu = splu(transposed, permc_spec="NATURAL", diag_pivot_thresh=threshold, options=mode)
        return lambda b: lu.solve(b, trans="T")  # type: ignore[call-overload]  # missing in the stubs


class DirectSolver:
    """Sparse LU factors of the free block of K; all that depends on the mesh alone is done once.

    The order of elimination is kept for good, the gathering of the block as long as the pattern of K
    stays, and the factor as long as the free block of K stays.

    Parameters
    ----------
    locations
        (dim, N), the place of each unknown (`basis.doflocs`).
    free
        Indices of the unknowns to solve for; the others are zero in every solution.

    Examples
    --------
    >>> import numpy as np
    >>> from scipy.sparse import diags
    >>> K = diags([-1.0, 2.0, -1.0], [-1, 0, 1], shape=(4, 4)).tocsr()
    >>> solve = DirectSolver(np.arange(4.0)[None], np.array([1, 2, 3])).factor(K)
    >>> solve(np.ones(4)).round(12)
    array([0. , 1.5, 2. , 1.5])
    """

    def __init__(self, locations: ndarray, free: ndarray) -> None:
        self._locations = locations
        self._free = np.asarray(free)
        self._engine = SuperLU()
        self._block: FreeBlock | None = None
        self._last: _Factor | None = None
        logger.info("linear solver: %s", self.name)

    @property
    def name(self) -> str:
        """The engine that was chosen."""
        return self._engine.name

    def __repr__(self) -> str:
        return f"DirectSolver({self.name}, {len(self._free)} of {self._locations.shape[1]} unknowns)"

    def factor(self, K: csr_matrix, symmetric: bool = False) -> Solve:
        """Factor the free block of K.

        Parameters
        ----------
        K
            (N, N); nonsymmetric in slip and in non-associated flow.
        symmetric
            K is symmetric, and an engine may make use of it.

        Returns
        -------
        callable
            b (N,) -> x (N,) with K[free, free] x[free] = b[free] and zeros elsewhere.

        Raises
        ------
        SingularSystem
            A motion of the free unknowns meets no stiffness. The callable raises it as well, when its
            solution leaves a residual.
        ValueError
            K has entries that are not finite.
        """
        if self._block is None:
            self._block = self._ordered_block(K)
        A = self._block.gather(K)
        last = self._last
        if last is not None and last.symmetric == symmetric and _equal(A, last.A):
            return last
        self._last = last = None  # its memory is free for the next one
        factor = self._last = _Factor(A, self._engine, symmetric, self._block.order, K.shape[0])
        return factor

    def _ordered_block(self, K: csr_matrix) -> FreeBlock:
        graph = K[self._free][:, self._free]
        return FreeBlock(self._free[nested_dissection(graph, self._locations[:, self._free])])


def _equal(A: csr_matrix, B: csr_matrix) -> bool:
    return _same_pattern(A, B) and np.array_equal(A.data, B.data)


class _Factor:
    """Factor of one free block, with the checks that the engines leave to their caller."""

    def __init__(self, A: csr_matrix, engine: Any, symmetric: bool, order: ndarray, size: int) -> None:
        self.A, self.symmetric = A, symmetric
        self._engine, self._order, self._size = engine, order, size
        self._scale = abs(A).max(axis=1).toarray().ravel() if A.nnz else np.zeros(len(order))
        if not np.all(np.isfinite(self._scale)):
            raise ValueError("the stiffness has entries that are not finite")
        if not np.all(self._scale):
            raise self._singular(self._scale == 0.0)
        try:
            self._solve = engine.factor(A, symmetric)
        except RuntimeError as error:
            shifted = (A + diags(1e-8 * self._scale)).tocsr()
            motion = self._softest(engine.factor(shifted, symmetric))[0]
            raise self._singular(motion) from error
        self._refuse_free_motion()

    def __call__(self, b: ndarray) -> ndarray:
        rhs = b[self._order]
        size = float(np.linalg.norm(rhs))
        if not np.isfinite(size):
            raise ValueError("the right-hand side has entries that are not finite")
        x = np.zeros(self._size)
        if size > 0.0:
            x[self._order] = self._checked(rhs, size)
        return x

    def _checked(self, rhs: ndarray, size: float) -> ndarray:
        x, error = self._refined(rhs, size)
        if error > WRONG:
            self._solve = self._engine.factor(self.A, self.symmetric, careful=True)
            x, error = self._refined(rhs, size)
        if error > WRONG:
            raise self._singular(self._softest(self._solve)[0])
        return x

    def _refined(self, rhs: ndarray, size: float) -> tuple[ndarray, float]:
        """Solution and its relative residual, improved once where it is not small."""
        x = self._solve(rhs)
        residual = rhs - self.A @ x
        if np.linalg.norm(residual) > REFINE * size:
            x = x + self._solve(residual)
            residual = rhs - self.A @ x
        error = np.linalg.norm(residual) / size
        return x, float(error) if np.isfinite(error) else np.inf

    def _softest(self, solve: Solve, steps: int = 2) -> tuple[ndarray, list[float]]:
        """Inverse iteration: the softest motion and its stiffness relative to the rows' norms."""
        motion = np.random.default_rng(0).choice([-1.0, 1.0], len(self._scale))
        stiffness = []
        for _ in range(steps):
            motion = solve(self._scale * motion)
            largest = np.abs(motion).max()
            motion /= largest
            stiffness.append(1.0 / largest)
            if stiffness[-1] > SOFT:
                break
        return motion, stiffness

    def _refuse_free_motion(self) -> None:
        motion, stiffness = self._softest(self._solve)
        if not stiffness[-1] > SINGULAR:
            raise self._singular(motion)

    def _singular(self, motion: ndarray) -> SingularSystem:
        size = np.abs(motion).astype(float)
        unknowns = np.sort(self._order[size > MOVES * size.max()])
        return SingularSystem(
            f"the system is singular: {len(unknowns)} of {len(size)} free unknowns "
            f"(the first is {unknowns[0]}) can move without force",
            unknowns,
        )


class _OwnSolver:
    """A user's function (A, b) -> x behind the call of `DirectSolver`."""

    def __init__(self, function: Callable[[csr_matrix, ndarray], ndarray], free: ndarray) -> None:
        self._function = function
        self._block = FreeBlock(np.asarray(free))
        self.name = getattr(function, "__qualname__", repr(function))
        logger.info("linear solver: %s", self.name)

    def factor(self, K: csr_matrix, symmetric: bool = False) -> Solve:
        A = self._block.gather(K)

        def solve(b: ndarray) -> ndarray:
            x = np.zeros(K.shape[0])
            x[self._block.order] = self._function(A, b[self._block.order])
            if not np.all(np.isfinite(x)):
                raise ValueError(f"the linear solver {self.name} returned values that are not finite")
            return x

        return solve


def as_solver(solver: Any, locations: ndarray, free: ndarray) -> LinearSolver:
    """The linear solver of an analysis from what its user gave.

    Parameters
    ----------
    solver
        None for a :class:`DirectSolver`, or a scikit-fem linear solver, which is a function
        (A, b) -> x such as `skfem.utils.solver_iter_krylov()` returns.
    locations
        (dim, N), the place of each unknown.
    free
        Indices of the unknowns to solve for.

    Raises
    ------
    ValueError
        `solver` is neither.

    Examples
    --------
    >>> import numpy as np
    >>> from scipy.sparse import eye
    >>> from scipy.sparse.linalg import spsolve
    >>> solver = as_solver(spsolve, np.zeros((2, 3)), np.array([0, 2]))
    >>> solver.factor(2 * eye(3, format="csr"))(np.ones(3))
    array([0.5, 0. , 0.5])
    """
    if solver is None:
        return DirectSolver(locations, free)
    if callable(solver):
        return _OwnSolver(solver, free)
    raise ValueError(f"solver must be None or a function (A, b) -> x, not {solver!r}")
