"""Direct solution of K x = b for the free dofs, for many tangents on one mesh."""

from __future__ import annotations

import logging
from collections.abc import Callable
from functools import lru_cache
from typing import Literal, Protocol
from weakref import ref

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix, diags

from ..arrays import max_abs
from ..sparse import FreeBlock, same_matrix, with_data
from .krylov import Fgmres
from .pardiso import Pardiso
from .superlu import SuperLU

logger = logging.getLogger("skfem_contact")

SOFT = 1e-11  # a probe that grows by more than 1/SOFT is looked at more closely
SINGULAR = 1e-15  # relative stiffness of a free motion, by round-off alone
MOVES = 1e-2  # part of the largest entry from which a dof takes part in a motion
UNCHECKED = 1.0  # relative residual with which solutions of a factor are not checked
REFINE = 1e-10  # relative residual from which the solution is refined
WRONG = 1e-5  # relative residual that is refused
HOLD = 1e-13  # relative stiffness that is added to find the dofs that move
#: Free dofs in space from which factors have single precision: from 4,000 to 32,000 dofs they take
#: 65 to 50 % of the time and half of the memory, and three refinements, 2 to 5 % of a factor each,
#: lead to residuals of 1e-14.  In the plane refinements take what factors save.
SINGLE = 4000
#: Stiffness from which they do, and the residual to which so many refinements must lead.
FIRM = 1e-5
ROUND_OFF = 1e-13
REFINEMENTS = 4
#: Share of the residual asked for to which rough solutions are refined: one that is just as rough
#: as asked for costs Newton's method iterations.
FINER = 1e-3
#: Rough solutions of large bodies in space that yield, of a relative residual between these, begin
#: with the factor of an earlier tangent as preconditioner.  Far rougher ones are of matrices that
#: serve for several.
FINEST = 1e-4
ROUGHEST = 0.05
#: Iterations that such a solution may take, and from which on the next matrix is factored: of a
#: footing of 10,125 dofs one takes 4.5 ms, a factor 85 ms, and solutions take 3 to 12.
MOST = 15
MANY = 11


class SingularSystem(ValueError):
    """Error of a body that floats: the free `dofs` of its motion move without force."""

    def __init__(self, message: str, dofs: ndarray) -> None:
        super().__init__(message)
        self.dofs = dofs


class Solve(Protocol):
    """Solution of a prepared system."""

    def __call__(self, b: ndarray, rtol: float = REFINE) -> ndarray:
        """Return the solution for b (N,); iterative solvers may leave a residual of rtol |b|.

        With ``UNCHECKED`` direct solvers do not look at the residual of a factor that has been
        checked before, and iterative ones solve to ``REFINE``.
        """


class LinearSolver(Protocol):
    """Interface of a linear solver."""

    @property
    def name(self) -> str:
        """Name for the log."""

    def factor(self, K: csr_matrix, symmetric: bool = False) -> Solve:
        """Prepare the solution of K[free, free] x[free] = b[free] for any b (N,)."""


class Condensed(Protocol):
    """Interface of factors of a matrix that is condensed to its last m dofs.

    Attributes
    ----------
    schur : ndarray, shape (m, m)
        Schur complement of the last dofs.
    """

    schur: ndarray

    def solve(self, b: ndarray, inside: bool, last: Callable[[ndarray], ndarray]) -> ndarray:
        """Solve for b (n,); `last` returns the last dofs from their right-hand side.

        Without `inside` the other entries of b are zero.
        """


class Engine(Protocol):
    """Interface of SuperLU and PARDISO: sparse factors without checks."""

    name: str
    cholesky: bool  # whether a factor is another one where the matrix is said to be definite

    def order(self, graph: csr_matrix, locations: ndarray) -> ndarray:
        """Return the order of the dofs in the matrices to come."""

    def outdated(self) -> bool:
        """Return True if a new order pays."""

    def factor(
        self,
        A: csr_matrix,
        symmetric: bool,
        careful: bool = False,
        definite: bool = False,
    ) -> Callable[[ndarray], ndarray]:
        """Factor A and return its solution, for one column (n,) or several, (n, n_columns).

        An exact zero among the pivots raises a RuntimeError; of a matrix that is said to be
        positive definite a negative one may do so as well.
        """

    def enlarged(self, A: csr_matrix) -> Callable[[ndarray], ndarray] | None:
        """Factor A with small pivots enlarged and return its solution, which wants refinement.

        Return None for an engine whose pivots are chosen among all rows.
        """

    def condensed(self, A: csr_matrix, m: int, most: float) -> Condensed | None:
        """Condense A to its last m dofs; return None where this is not possible.

        A dense factor of the last dofs may cost the share `most` of a sparse one.
        """


#: Ways to compute a factor: in single precision, in double precision, and with pivots chosen for
#: accuracy.
Way = Literal["single", "double", "careful"]
WAYS: tuple[Way, ...] = ("single", "double", "careful")
#: The fastest first.
ENGINES: dict[str, Callable[[], Engine]] = {"pardiso": Pardiso, "superlu": SuperLU}


class DirectSolver:
    """Sparse factors of the free block of K, for many tangents on one mesh.

    The order of elimination is kept as long as the factors stay sparse.  The map that gathers the
    block is kept as long as the pattern of K stays, and the factor as long as the free block of K
    stays.

    Parameters
    ----------
    locations
        Coordinates of each dof (`basis.doflocs`), (dim, N), in any unit of length.
    free
        Dofs to solve for; the others are zero in every solution.
    engine
        "superlu" (scipy) or "pardiso" (Intel MKL, needs the extra ``fast``); by default PARDISO
        where it is installed.
    single
        Factor large matrices in space in single precision, and refine their solutions to the
        residual of double precision.  It pays where a factor serves for few solutions.

    Examples
    --------
    >>> import numpy as np
    >>> from scipy.sparse import diags
    >>> K = diags([-1.0, 2.0, -1.0], [-1, 0, 1], shape=(4, 4)).tocsr()
    >>> solver = DirectSolver(np.arange(4.0)[None], free=np.array([1, 2, 3]), engine="superlu")
    >>> solver
    DirectSolver(SuperLU with nested dissection, 3 of 4 dofs)
    >>> solver.factor(K)(np.ones(4)).round(12)
    array([0. , 1.5, 2. , 1.5])
    """

    def __init__(
        self,
        locations: ndarray,
        free: ndarray,
        engine: str | None = None,
        single: bool = False,
    ) -> None:
        self._locations = locations
        self._free = np.asarray(free)
        self._engine = as_engine(engine)
        self._block: FreeBlock | None = None
        self._last: _Factor | None = None
        self._iterates = single and len(locations) == 3 and len(self._free) >= SINGLE
        self._single = self._iterates
        self._given: ref[csr_matrix] | None = None
        self._taken = 0  # iterations of the last solution by an earlier factor
        logger.info("linear solver: %s", self.name)

    @property
    def name(self) -> str:
        """Name of the engine."""
        return self._engine.name

    def __repr__(self) -> str:
        return f"DirectSolver({self.name}, {len(self._free)} of {self._locations.shape[1]} dofs)"

    def factor(self, K: csr_matrix, symmetric: bool = False) -> Solve:
        """Factor the free block of K, (N, N), for solutions b (N,) -> x (N,).

        The solutions are zero at the prescribed dofs. PARDISO makes use of the symmetry of K; K is
        nonsymmetric in slip and in non-associated flow. A motion of the free dofs without stiffness
        raises :class:`SingularSystem`, here or in the callable.
        """
        n = self._locations.shape[1]
        if K.shape != (n, n):
            raise ValueError(
                f"the stiffness has the shape {K.shape}, but {n} dofs have coordinates"
            )
        if len(self._free) == 0:
            return nothing_free

        # return the last factor if it belongs to K
        kept = self._kept(symmetric)
        if kept is not None and self._known(K):
            return kept
        if self._block is None:
            self._block = self._ordered(K)
        A = self._block.gather(K)
        if kept is not None and same_matrix(A, kept.A):
            self._given = ref(K)
            return kept

        if kept is not None and self._iterates and self._taken < MANY:
            return self._iterated(K, A, kept)
        return self._factored(K, A, symmetric)

    def _factored(self, K: csr_matrix, A: csr_matrix, symmetric: bool) -> _Factor:
        """Return the factor of K with the free block A, in the first way that may hold."""
        if self._block is None or self._engine.outdated():
            self._block = self._ordered(K)
            A = self._block.gather(K)
        ways = self._ways()
        self._taken = 0
        self._last = None  # its memory is free for the next one
        factor = _Factor(
            A,
            self._engine,
            symmetric,
            order=self._block.order,
            size=self._locations.shape[1],
            ways=ways,
        )
        self._last = factor
        self._given = ref(K)
        return factor

    def _iterated(self, K: csr_matrix, A: csr_matrix, earlier: _Factor) -> Solve:
        """Return the solution of K by iterations with an earlier factor, or by its own one."""
        kept: _Factor | None = earlier
        own: _Factor | None = None
        symmetric = earlier.symmetric

        def solve(b: ndarray, rtol: float = REFINE) -> ndarray:
            nonlocal kept, own
            if kept is not None and FINEST <= rtol <= ROUGHEST and self._last is kept:
                x, self._taken = kept.iterated(A, b, rtol)
                if x is not None:
                    return x
            kept = None  # its memory is free for the own one
            if own is None:
                own = self._factored(K, A, symmetric)
            return own(b, rtol)

        return solve

    def _ways(self) -> tuple[Way, ...]:
        """Return the ways to factor: without single precision after a matrix that is not firm.

        Once its solutions have not been accurate, single precision is not tried again.
        """
        last = self._last
        if last is not None and not last.accurate:
            self._single = False
        if self._single and (last is None or last.firm):
            return WAYS
        return WAYS[1:]

    def _kept(self, symmetric: bool) -> _Factor | None:
        """Return the last factor if it serves for matrices of this symmetry."""
        last = self._last
        if last is None or not last.usable or last.symmetric != symmetric:
            return None
        return last

    def _known(self, K: csr_matrix) -> bool:
        """Return True if K is the last matrix, whose entries cannot have changed."""
        return self._given is not None and self._given() is K and not K.data.flags.writeable

    def _ordered(self, K: csr_matrix) -> FreeBlock:
        block = FreeBlock(self._free)
        order = self._free[self._engine.order(block.gather(K), self._locations[:, self._free])]
        if np.array_equal(order, self._free):
            return block
        return FreeBlock(order)


def nothing_free(b: ndarray, rtol: float = REFINE) -> ndarray:
    """Return the solution where all dofs are prescribed."""
    return np.zeros_like(b)


def fastest_engine() -> str:
    """Return the name of the fastest installed engine."""
    try:
        Pardiso()
    except ImportError:
        return "superlu"
    return "pardiso"


def as_engine(name: str | None = None) -> Engine:
    """Return the engine of a name, or the fastest installed one."""
    name = name or fastest_engine()
    if name not in ENGINES:
        raise ValueError(f"there is no engine {name!r}; there are {', '.join(ENGINES)}")
    return ENGINES[name]()


class _Factor:
    """Factor of one free block, in the first of the `ways` that holds, with checks of solutions."""

    def __init__(
        self,
        A: csr_matrix,
        engine: Engine,
        symmetric: bool,
        order: ndarray,
        size: int,
        ways: tuple[Way, ...],
    ) -> None:
        self.A = A
        self.symmetric = symmetric
        self._engine = engine
        self._order = order
        self._size = size
        self._scale = self._row_norms()
        #: True unless single precision has left too large a residual.
        self.accurate = True
        #: True if the first way was stiff enough for single precision.
        self.firm = False
        for way in ways:
            try:
                self._factor(way)
            except RuntimeError:  # an exact zero among the pivots
                continue
            least = SINGULAR
            if way == "single":
                least = FIRM
            stiffness = self._stiffness()
            if stiffness > least:
                self.firm = stiffness > FIRM and way == ways[0]
                return
        raise self._singular()

    def __call__(self, b: ndarray, rtol: float = REFINE) -> ndarray:
        rhs = b[self._order]
        size = float(np.linalg.norm(rhs))
        if not np.isfinite(size):
            raise ValueError("the right-hand side has entries that are not finite")
        x = np.zeros(self._size)
        if size > 0.0:
            unchecked = rtol >= UNCHECKED
            if unchecked and self._way != "single":
                x[self._order] = self._solve(rhs)
            else:
                x[self._order] = self._checked(rhs, size, 0.0 if unchecked else FINER * rtol)
        return x

    def iterated(self, A: csr_matrix, b: ndarray, rtol: float) -> tuple[ndarray | None, int]:
        """Solve for a similar matrix, with this factor as preconditioner.

        Returns
        -------
        x, count
            Solution, or None where too few iterations were allowed; number of iterations.
        """
        rhs = b[self._order]
        x = np.zeros(self._size)
        size = float(np.linalg.norm(rhs))
        if size == 0.0:
            return x, 0
        method = Fgmres()
        method.forgets = True
        found, count = method(A, rhs, self._solve, rtol, MOST)
        error = float(np.linalg.norm(rhs - A @ found)) / size
        logger.debug("kept factor: %d iterations to a residual of %.1e", count, error)
        if not error <= rtol:
            return None, count
        x[self._order] = found
        return x, count

    @property
    def usable(self) -> bool:
        """True unless the factors have turned out to be singular."""
        return "_solve" in vars(self)

    def _factor(self, way: Way) -> None:
        self._forget()
        self._way = way
        if way == "single":
            self._solve = _in_single(self._engine, self.A, self.symmetric)
        else:
            self._solve = self._engine.factor(self.A, self.symmetric, way == "careful")

    def _forget(self) -> None:
        """Drop the factors, whose memory the next ones need."""
        vars(self).pop("_solve", None)

    def _checked(self, rhs: ndarray, size: float, enough: float = 0.0) -> ndarray:
        """Solve to a small residual, or to one that is enough in single precision."""
        x, error = self._refined(rhs, size, enough)
        if self._way == "single" and error > max(REFINE, enough):
            self.accurate = False
            self._factor("double")
            x, error = self._refined(rhs, size)
        if error > WRONG:
            self._factor("careful")
            x, error = self._refined(rhs, size)
        if error > WRONG and (solve := self._engine.enlarged(self.A)) is not None:
            self._solve = solve
            x, error = self._refined(rhs, size)
        if error > WRONG:
            raise self._singular()
        return x

    def _refined(self, rhs: ndarray, size: float, enough: float = 0.0) -> tuple[ndarray, float]:
        """Return the refined solution, and its relative residual."""
        x = self._solve(rhs)
        residual = rhs - self.A @ x
        small = REFINE
        most = 1
        if self._way == "single":
            small = max(ROUND_OFF, enough)
            most = REFINEMENTS
        while np.linalg.norm(residual) > small * size and most > 0:
            x = x + self._solve(residual)
            most -= 1
            residual = rhs - self.A @ x
        error = float(np.linalg.norm(residual)) / size
        return x, error if np.isfinite(error) else np.inf

    def _row_norms(self) -> ndarray:
        """Return the largest entry of each row: penalties may be millions of times E."""
        A = self.A
        filled = np.flatnonzero(np.diff(A.indptr))
        norms = np.zeros(A.shape[0])
        norms[filled] = np.maximum.reduceat(np.abs(A.data), A.indptr[filled])
        if not np.all(np.isfinite(norms)):
            raise ValueError("the stiffness has entries that are not finite")
        if not np.all(norms):
            raise _floating(self._order[norms == 0.0], len(norms))
        return norms

    def _stiffness(self) -> float:
        """Estimate the relative stiffness of the softest motion by one or two inverse iterations.

        SuperLU needs a copy of its factors for the ratio of the pivots.
        """
        motion = any_motion(len(self._scale))
        for _ in range(2):
            motion = self._solve(self._scale * motion)
            stiffness = 1.0 / max_abs(motion)
            if stiffness > SOFT:
                break
            motion *= stiffness
        return stiffness

    def _singular(self) -> SingularSystem:
        """Return the error with the dofs of the softest motion, found with a little stiffness."""
        self._forget()
        stiffened = (self.A + diags(HOLD * self._scale)).tocsr()
        # scaled as an earlier matrix the first factors may give no numbers
        for careful in (False, True):
            solve = self._engine.factor(stiffened, self.symmetric, careful)
            motion = any_motion(len(self._scale))
            for _ in range(2):
                motion = solve(self._scale * motion)
                motion /= max_abs(motion)
            if np.isfinite(motion).all():
                break
        moving = ~(np.abs(motion) <= MOVES)  # all of them without numbers
        return _floating(self._order[moving], len(motion))


def _in_single(engine: Engine, A: csr_matrix, symmetric: bool) -> Callable[[ndarray], ndarray]:
    """Factor A in single precision and return its solution, in any units."""
    largest = max_abs(A.data)
    scaled = (A.data / largest).astype(np.float32)
    solve = engine.factor(with_data(A, scaled), symmetric)

    def solution(b: ndarray) -> ndarray:
        size = max_abs(b) or 1.0
        x = solve((b / size).astype(np.float32))
        return x.astype(float) * (size / largest)

    return solution


@lru_cache(4)
def any_motion(n: int) -> ndarray:
    """Return the start of the inverse iteration: random numbers, the same in every run."""
    motion = np.random.default_rng(0).standard_normal(n)
    motion.flags.writeable = False
    return motion


def _floating(dofs: ndarray, n: int) -> SingularSystem:
    dofs = np.sort(dofs)
    return SingularSystem(
        f"the system is singular: {len(dofs)} of {n} free dofs can move without force, the first "
        f"is {dofs[0]}",
        dofs,
    )
