"""Linear solvers of PETSc on the processes that ``mpiexec`` starts."""

from __future__ import annotations

import atexit
import logging
import os
import sys
import time
import traceback
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache, partial
from itertools import pairwise
from typing import Any, Literal, NoReturn
from weakref import finalize

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix

from ..errors import NotConverged, warn
from ..sparse import same_matrix
from .direct import REFINE, UNCHECKED, WRONG, DirectSolver, LinearSolver, Solve, nothing_free
from .multigrid import ENOUGH, KEPT, MOST, ROUGH, InTurn
from .whole_nodes import WholeNodes

logger = logging.getLogger("skfem_contact")

Method = Literal["gamg", "mumps"]

#: Seconds between two looks for work: MPI's own waiting keeps a core busy.
_PAUSE = 1e-3
#: Residual over the one asked for to which the levels of an earlier matrix must lead: the residual
#: of the recursion differs from the one of the solution.
_CLOSE = 2.0
#: Variables with the number of a process and of all, of Open MPI; of MPICH and Intel MPI.
_NUMBERS = (("OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"), ("PMI_RANK", "PMI_SIZE"))


@dataclass(frozen=True)
class Petsc:
    """Linear solver of PETSc on all processes of ``mpiexec -n 4 python script.py``.

    The script is the same for one process. Create the solver in its first lines: the other
    processes wait, take part in each solution, and end with the script. The first one assembles
    and deals out the rows of each matrix, in slabs across the longest side of the mesh. Each
    solution is checked by its residual. A solution that fails is repeated by MUMPS, then by the
    direct solver of the first process, which then stays; the log says so.

    petsc4py and mpi4py come from conda-forge or from the system (``python3-petsc4py`` and
    ``python3-mpi4py`` of Debian). Without them a warning is given, the other processes end, and
    the model chooses its solver as usual. The variable ``PETSC_OPTIONS`` has further settings,
    such as ``-pc_gamg_threshold 0.02 -ksp_monitor``.

    Parameters
    ----------
    method
        ``"gamg"``, algebraic multigrid with the rigid motions of all bodies, by conjugate
        gradients where the tangent is symmetric and by FGMRES elsewhere; ``"mumps"``, a direct
        solver. By default multigrid for displacements in space, and MUMPS elsewhere.

    References
    ----------
    S. Balay et al., PETSc/TAO users manual, ANL-21/39, Argonne National Laboratory. P. R.
    Amestoy, I. S. Duff, J.-Y. L'Excellent, J. Koster, A fully asynchronous multifrontal solver
    using distributed dynamic scheduling, SIAM J. Matrix Anal. Appl. 23 (2001) 15-41.

    Examples
    --------
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> petsc = sc.Petsc()
    >>> basis = Basis(MeshQuad().refined(2).with_defaults(), ElementVector(ElementQuad1()))
    >>> block = sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.0))
    >>> model = sc.Model({"block": block}, sc.box_supports(basis), solver=petsc)
    >>> stage = model.run([sc.Stage("weight", sc.weight(basis, 20.0))])["weight"]
    >>> round(float(stage.x.min()), 9)
    -0.001
    """

    method: Method | None = None

    def __post_init__(self) -> None:
        _process()


def distributed(
    petsc: Petsc,
    locations: ndarray,
    free: ndarray,
    displacements: bool,
) -> LinearSolver | None:
    """Return the solver of `free` dofs, all displacements or not; None without petsc4py."""
    process = _process()
    if process is None:
        return None
    method = petsc.method
    if method is None and displacements and len(locations) == 3:
        method = "gamg"
    makers = []
    if method == "gamg":
        makers.append(partial(PetscSolver, process, locations, free, "gamg"))
    if process.has_mumps():
        makers.append(partial(PetscSolver, process, locations, free, "mumps"))
    return InTurn(*makers, partial(DirectSolver, locations, free, single=True))


class PetscSolver:
    """One method of PETSc behind the interface of :class:`DirectSolver`."""

    def __init__(
        self,
        process: _Process,
        locations: ndarray,
        free: ndarray,
        method: Method,
    ) -> None:
        self._process = process
        self._method = method
        dim = len(locations) if method == "gamg" else 1
        self._nodes = WholeNodes(locations, free, parts=process.size, dim=dim)
        self._last: _Solution | None = None
        self.name = f"{method.upper()} of PETSc, processes: {process.size}"
        logger.info("linear solver: %s", self.name)

    def factor(self, K: csr_matrix, symmetric: bool = False) -> Solve:
        """Prepare the solution on all processes, see :meth:`DirectSolver.factor`."""
        if len(self._nodes.dofs) == 0:
            return nothing_free

        # return the last solution if it belongs to K
        A = self._nodes.gather(K)
        last = self._last
        if last is not None and last.symmetric == symmetric and same_matrix(A, last.A):
            return last

        # keep its preconditioner as long as it pays, else free its memory for the next one
        earlier = None
        if last is not None and self._method == "gamg":
            earlier = last.serves(symmetric)
        self._last = last = None
        self._last = _Solution(self._process, self._nodes, A, symmetric, self._method, earlier)
        return self._last


class _Solution:
    """Solution of a matrix that all processes hold together.

    Multigrid may have the levels of an earlier matrix, until their iterations beyond those of that
    matrix have cost more than new ones.
    """

    def __init__(
        self,
        process: _Process,
        nodes: WholeNodes,
        A: csr_matrix,
        symmetric: bool,
        method: Method,
        earlier: _Solution | None,
    ) -> None:
        self.A = A
        self.symmetric = symmetric
        #: Iterations a digit with the own preconditioner, and those that others needed beyond them.
        self.rate = 0.0
        self.spent = 0.0
        self._process = process
        self._nodes = nodes
        self._method = method
        self._earlier = earlier
        self.number = self._prepared()

    def serves(self, symmetric: bool) -> _Solution | None:
        """Return the solution whose preconditioner serves for the next matrix as well."""
        own = self._earlier or self
        if own.spent > KEPT or (symmetric and not own.symmetric):
            return None
        return own

    def __call__(self, b: ndarray, rtol: float = REFINE) -> ndarray:
        right = self._nodes.taken(b)
        size = float(np.linalg.norm(right))
        if not np.isfinite(size):
            raise ValueError("the right-hand side has entries that are not finite")
        if size == 0.0:
            return np.zeros_like(b)
        if rtol >= UNCHECKED:
            rtol = REFINE
        enough = ENOUGH if rtol >= ROUGH else max(WRONG, rtol)

        # solve with the levels of an earlier matrix, then with new ones if these fail
        x, count, error = self._solved(right, size, rtol)
        if self._earlier is not None and not error <= _CLOSE * rtol:
            self._earlier = None
            self.number = self._prepared()
            x, count, error = self._solved(right, size, rtol)
        if not error <= enough:
            raise NotConverged(
                f"{self._method.upper()} of PETSc does not converge, its relative residual is "
                f"{error:.1e} after {count} iterations: bodies may be loose, very thin or nearly "
                "incompressible"
            )
        return self._nodes.placed(x, len(b))

    def _prepared(self) -> int:
        """Prepare the matrix on all processes, until this object is deleted; return its number."""
        modes = None
        earlier = 0
        if self._earlier is not None:
            earlier = self._earlier.number
        elif self._method == "gamg":
            motions, _ = self._nodes.rigid_modes(self._nodes.blocks(self.A))
            modes, _ = np.linalg.qr(motions)
        process = self._process
        number = process.prepared(self.A, self._nodes.dim, self.symmetric, earlier, modes)
        finalize(self, process.unused.append, number)
        return number

    def _solved(self, b: ndarray, size: float, rtol: float) -> tuple[ndarray, int, float]:
        """Return a solution with its iterations and its relative residual."""
        own = self._earlier or self
        most = MOST
        if own is not self:
            most = int(own.rate * -np.log10(rtol) + KEPT - own.spent) + 1
        x, count = self._process.solved(self.number, b, rtol, most)
        error = float(np.linalg.norm(b - self.A @ x)) / size
        logger.debug("PETSc: %d iterations to a residual of %.1e", count, error)

        # count the iterations that other levels would have saved
        digits = max(-float(np.log10(max(error, REFINE))), 1.0)
        if own is self:
            self.rate = max(self.rate, count / digits)
        own.spent += max(0.0, count - own.rate * digits)
        return x, count, error


class _Process:
    """Process of an MPI run. The first one calls methods, which the others then run as well.

    Arguments that are None elsewhere are whole arrays on the first process.
    """

    def __init__(self, MPI: Any, PETSc: Any) -> None:
        self._PETSc = PETSc
        self._comm = MPI.COMM_WORLD.Dup()
        self._kept: dict[int, Any] = {}
        self._count = 0
        self.size = int(self._comm.size)
        self._rank = int(self._comm.rank)
        self.first = self._rank == 0
        #: Numbers of solutions that nobody needs; they are dropped with the next call.
        self.unused: list[int] = []

    def has_mumps(self) -> bool:
        """Return True if PETSc was built with MUMPS."""
        return bool(self._PETSc.Sys.hasExternalPackage("mumps"))

    # -- the first process

    def prepared(
        self,
        A: csr_matrix,
        block: int,
        symmetric: bool,
        earlier: int,
        modes: ndarray | None,
    ) -> int:
        """Return the number of a matrix that has been dealt out and prepared.

        Its preconditioner has an earlier number, or is multigrid with modes, or a factor.
        """
        self._count += 1
        small = (self._count, A.shape[0], block, symmetric, earlier, modes is not None)
        self._call("prepare", small, A, modes)
        return self._count

    def solved(self, number: int, b: ndarray, rtol: float, most: int) -> tuple[ndarray, int]:
        """Return the solution for b, and the number of iterations."""
        x, count = self._call("solve", (number, rtol, most), b)
        return x, count

    def end(self) -> None:
        """Let the other processes end."""
        for rank in range(1, self.size):
            self._comm.send(None, rank)

    def _call(self, method: str, small: tuple[Any, ...], *whole: Any) -> Any:
        """Run a method on all processes, with whole arrays on this one alone."""
        unused = tuple(self.unused)
        del self.unused[: len(unused)]
        for rank in range(1, self.size):
            self._comm.send((method, small, unused), rank)
        return self._run(method, (*small, *whole), unused)

    # -- the others

    def serve(self) -> NoReturn:
        """Run the methods that the first process calls, until it ends."""
        while True:
            while not self._comm.Iprobe(source=0):
                time.sleep(_PAUSE)
            call = self._comm.recv(source=0)
            if call is None:
                sys.exit()
            self._run(*call)

    # -- all of them together

    def _run(self, method: str, arguments: tuple[Any, ...], unused: Sequence[int]) -> Any:
        """Run a method; an error on one of several processes ends them all."""
        try:
            for number in unused:
                self._kept.pop(number).destroy()
            return getattr(self, method)(*arguments)
        except Exception:
            if self.size > 1:
                traceback.print_exc()
                self._comm.Abort(1)
            raise

    def prepare(
        self,
        number: int,
        n: int,
        block: int,
        symmetric: bool,
        earlier: int,
        levels: bool,
        A: csr_matrix | None = None,
        modes: ndarray | None = None,
    ) -> None:
        """Deal out a matrix (n, n) and prepare its preconditioner."""
        PETSc = self._PETSc
        matrix = self._dealt(A, n, block)
        if symmetric:
            matrix.setOption(PETSc.Mat.Option.SYMMETRIC, True)
        solver = PETSc.KSP().create()
        solver.setOperators(matrix)
        if earlier or levels:
            solver.setType("cg" if symmetric else "fgmres")
            solver.setNormType(PETSc.KSP.NormType.UNPRECONDITIONED)
        if levels:
            matrix.setNearNullSpace(self._near_null_space(matrix, modes))
            solver.getPC().setType("gamg")
        elif not earlier:
            solver.setType("preonly")
            solver.getPC().setType("cholesky" if symmetric else "lu")
            solver.getPC().setFactorSolverType("mumps")
        solver.setFromOptions()
        if earlier:
            solver.getPC().setType("python")
            solver.getPC().setPythonContext(_Kept(self._kept[earlier].getPC()))
        solver.setUp()
        self._kept[number] = solver

    def solve(
        self,
        number: int,
        rtol: float,
        most: int,
        b: ndarray | None = None,
    ) -> tuple[ndarray, int]:
        """Solve by a prepared matrix; the solution is whole on the first process."""
        solver = self._kept[number]
        matrix, _ = solver.getOperators()
        solver.setTolerances(rtol=rtol, max_it=most)
        x = matrix.createVecRight()
        solver.solve(self._vector(matrix, b), x)

        # gather the rows
        cuts = matrix.getOwnershipRanges()
        whole = np.empty(cuts[-1] if self.first else 0)
        self._comm.Gatherv(x.getArray(), (whole, np.diff(cuts)))
        return whole, int(solver.getIterationNumber())

    def _dealt(self, A: csr_matrix | None, n: int, block: int) -> Any:
        """Return the distributed matrix, each process has the rows of a slab."""
        number = self._PETSc.IntType
        nodes = -(-(n // block) * np.arange(self.size + 1) // self.size)
        cuts = block * nodes
        own = int(cuts[self._rank + 1] - cuts[self._rank])

        # send starts of rows, then columns and values
        starts = columns = values = None
        if A is not None:
            entries = A.indptr[cuts]
            starts = [A.indptr[a : b + 1] - A.indptr[a] for a, b in pairwise(cuts)]
            columns = np.split(A.indices, entries[1:-1])
            values = np.split(A.data, entries[1:-1])
        indptr = self._part(starts, own + 1, number)
        indices = self._part(columns, indptr[-1], number)
        data = self._part(values, indptr[-1], float)
        size = (own, n)
        return self._PETSc.Mat().createAIJ((size, size), bsize=block, csr=(indptr, indices, data))

    def _near_null_space(self, matrix: Any, modes: ndarray | None) -> Any:
        """Return the rigid motions (n, 3) or (n, 6) as orthonormal vectors."""
        block = matrix.getBlockSize()
        count = block * (block + 1) // 2
        columns: Any = [None] * count if modes is None else modes.T
        vectors = [self._vector(matrix, column) for column in columns]
        return self._PETSc.NullSpace().create(vectors=vectors)

    def _vector(self, matrix: Any, whole: ndarray | None) -> Any:
        """Return a vector that is dealt out as the rows of a matrix."""
        vector = matrix.createVecLeft()
        parts = None
        if whole is not None:
            parts = np.split(whole, matrix.getOwnershipRanges()[1:-1])
        vector.setArray(self._part(parts, vector.getLocalSize(), float))
        return vector

    def _part(self, parts: Sequence[ndarray] | None, size: int, dtype: Any) -> ndarray:
        """Return the part of this process; the first one has all of them and sends them."""
        if parts is None:
            part = np.empty(size, dtype)
            self._comm.Recv(part, source=0)
            return part
        for rank in range(1, self.size):
            self._comm.Send(np.ascontiguousarray(parts[rank], dtype), rank)
        return np.ascontiguousarray(parts[0], dtype)


class _Kept:
    """Preconditioner of an earlier matrix, by the calls of PETSc."""

    def __init__(self, preconditioner: Any) -> None:
        self._preconditioner = preconditioner

    def apply(self, _: Any, x: Any, y: Any) -> None:
        """Write the image of x to y."""
        self._preconditioner.apply(x, y)


@lru_cache(1)
def _process() -> _Process | None:
    """Return the first process; the others serve it here until they end. None without PETSc."""
    rank, size = _launched()
    try:
        from mpi4py import MPI
        from petsc4py import PETSc
    except ImportError as error:
        reason = f"petsc4py and mpi4py cannot be imported ({error})"
    else:
        process = _Process(MPI, PETSc)
        reason = ""
        if size > 1 and process.size != size:
            reason = f"mpi4py belongs to another MPI than mpiexec, it sees 1 of {size} processes"

    # leave the analysis to one process and its own solvers
    if reason:
        if rank > 0:
            sys.exit()
        warn(f"{reason}: one process runs the script, with the solver of the installed packages")
        return None
    if not process.first:
        process.serve()
    atexit.register(process.end)
    return process


def _launched() -> tuple[int, int]:
    """Return the number of this process and of all that mpiexec has started; 0, 1 without it."""
    for rank, size in _NUMBERS:
        if rank in os.environ and size in os.environ:
            return int(os.environ[rank]), int(os.environ[size])
    return 0, 1
