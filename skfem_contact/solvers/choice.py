"""Linear solver of an analysis, from a name, a function or nothing."""

from __future__ import annotations

import logging
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix

from ..errors import NotConverged
from ..forms.base import Forms
from ..sparse import FreeBlock
from .direct import ENGINES, REFINE, DirectSolver, LinearSolver, Solve, fastest_engine
from .multigrid import AmgOrDirect, iterations_that_pay
from .petsc import Petsc, distributed
from .schur import SchurSolver

logger = logging.getLogger("skfem_contact")

#: Residual of a solution by a function of the user, over the right-hand side, that shows a failure,
#: unless it is below the second number times its terms: round-off of a nearly singular matrix.
_WRONG = 0.1
_ROUND_OFF = 1e-8
#: Dofs in space up to which elastic bodies in contact are factored once: 116,000 take 34 s, as long
#: as 8 solutions by multigrid, and the time grows with the square of their number.
FACTORED_ONCE = 200_000


class FunctionSolver:
    """Function (A, b) -> x of a user behind the interface of :class:`DirectSolver`."""

    def __init__(self, function: Callable[[csr_matrix, ndarray], ndarray], free: ndarray) -> None:
        self._function = function
        self._block = FreeBlock(np.asarray(free))
        self.name = getattr(function, "__qualname__", repr(function))
        logger.info("linear solver: %s", self.name)

    def factor(self, K: csr_matrix, symmetric: bool = False) -> Solve:
        """Keep the free block of K for the function."""
        A = self._block.gather(K)
        order = self._block.order

        def solve(b: ndarray, rtol: float = REFINE) -> ndarray:
            x = np.zeros(K.shape[0])
            x[order] = self._function(A, b[order])
            if not np.all(np.isfinite(x)):
                raise NotConverged(
                    f"the linear solver {self.name} returned values that are not finite"
                )
            self._check(A, x[order], b[order])
            return x

        return solve

    def _check(self, A: csr_matrix, x: ndarray, b: ndarray) -> None:
        """Refuse a solution that leaves much of the right-hand side."""
        residual = float(np.linalg.norm(A @ x - b))
        size = float(np.linalg.norm(b))
        if residual <= _WRONG * size:
            return
        terms = float(np.linalg.norm(abs(A) @ np.abs(x)))
        if residual > _ROUND_OFF * terms:
            raise NotConverged(
                f"the linear solver {self.name} returned values that are no solution: their "
                f"residual is {residual:.2g}, the right-hand side {size:.2g}"
            )


def as_solver(
    solver: Any,
    locations: ndarray,
    free: ndarray,
    interface: ndarray | None = None,
    single: bool = False,
) -> LinearSolver:
    """Return the linear solver of the `free` dofs with coordinates `locations`, (dim, N).

    `solver` is None or the name of an engine, for a :class:`DirectSolver`; "amg", for
    :class:`AmgOrDirect`; or a linear solver of scikit-fem, a function (A, b) -> x such as
    `skfem.utils.solver_iter_krylov()` returns.
    """
    if callable(solver):
        return FunctionSolver(solver, free)
    if isinstance(solver, str) and solver == "amg":
        return AmgOrDirect(locations, free, interface)
    if solver is None or solver in tuple(ENGINES):
        return DirectSolver(locations, free, solver, single)
    names = ", ".join((*ENGINES, "amg"))
    raise ValueError(
        f"solver must be None, one of {names}, or a function (A, b) -> x, not {solver!r}"
    )


def _changing(forms: Forms) -> tuple[ndarray, bool]:
    """Return the dofs where tangents change, and whether some change anywhere."""
    interface = np.zeros(0, int)
    anywhere = False
    for form in forms.values():
        if form.changing is None:
            anywhere = True
        else:
            interface = np.union1d(interface, form.changing)
    return interface, anywhere


def linear_solver(
    forms: Forms,
    solver: Any,
    locations: ndarray,
    free: ndarray,
) -> LinearSolver:
    """Choose the linear solver of an analysis by the dofs where the tangents of its forms change.

    A function of the user, multigrid and PETSc, if given, solve all systems.  None leaves the
    choice to the installed packages, with multigrid where it pays.
    """
    interface, anywhere = _changing(forms)
    displacements = not any(form.fields for form in forms.values())
    if isinstance(solver, Petsc):
        together = distributed(solver, locations, free, displacements)
        if together is not None:
            return together
        solver = None

    # iterate where this pays, for displacements alone
    most = 0
    if solver is None and displacements:
        engine = fastest_engine()
        most = iterations_that_pay(locations, free, engine, anywhere)
    inner: LinearSolver
    if most:
        inner = AmgOrDirect(locations, free, interface, engine, most)
    else:
        inner = as_solver(solver, locations, free, interface, single=anywhere)

    # keep factors of elastic bodies; where bodies yield, factors made to be kept do not pay
    given = callable(solver) or solver == "amg"
    iterates = most > 0 and len(free) > FACTORED_ONCE
    if given or iterates or anywhere or len(interface) == 0:
        return inner
    return SchurSolver(inner, locations, free, interface, solver)
