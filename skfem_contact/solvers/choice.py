"""The linear solver that a user gives: a name, a function, or nothing."""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix

from ..forms.base import Form
from ..sparse import FreeBlock
from .direct import ENGINES, DirectSolver, LinearSolver, SingularSystem, Solve, fastest_engine
from .multigrid import AmgOrDirect, AmgSolver, amg_pays
from .schur import SchurSolver

logger = logging.getLogger("skfem_contact")

#: Layout in space up to which elastic bodies in contact are factored once: 116,000 take 34 s, as long as 8 solutions
#: by multigrid, and the square of their number counts.
FACTORED_ONCE = 200_000


class FunctionSolver:
    """A function (A, b) -> x behind the call of :class:`DirectSolver`."""

    def __init__(self, function: Callable[[csr_matrix, ndarray], ndarray], free: ndarray) -> None:
        self._function = function
        self._block = FreeBlock(np.asarray(free))
        self.name = getattr(function, "__qualname__", repr(function))
        logger.info("linear solver: %s", self.name)

    def factor(self, K: csr_matrix, symmetric: bool = False) -> Solve:
        """Keep the free block of K for the function."""
        A = self._block.gather(K)

        def solve(b: ndarray) -> ndarray:
            x = np.zeros(K.shape[0])
            x[self._block.order] = self._function(A, b[self._block.order])
            if not np.all(np.isfinite(x)):
                raise SingularSystem(f"the linear solver {self.name} returned values that are not finite",
                                     np.flatnonzero(~np.isfinite(x)))
            return x

        return solve


def as_solver(solver: Any, locations: ndarray, free: ndarray) -> LinearSolver:
    """The linear solver of the `free` unknowns, at their places (dim, N), from what a user gave.

    That is None or the name of an engine, for a :class:`DirectSolver`; "amg", for an :class:`AmgSolver`; or a
    scikit-fem linear solver, a function (A, b) -> x such as `skfem.utils.solver_iter_krylov()` returns; others are
    refused by a ``ValueError``.

    Examples
    --------
    >>> import numpy as np
    >>> from scipy.sparse import eye
    >>> from scipy.sparse.linalg import spsolve
    >>> solver = as_solver(spsolve, np.zeros((2, 3)), np.array([0, 2]))
    >>> solver.factor(2 * eye(3, format="csr"))(np.ones(3))
    array([0.5, 0. , 0.5])
    """
    if callable(solver):
        return FunctionSolver(solver, free)
    if solver == "amg":
        return AmgSolver(locations, free)
    if solver is None or solver in tuple(ENGINES):
        return DirectSolver(locations, free, solver)
    names = ", ".join((*ENGINES, "amg"))
    raise ValueError(f"solver must be None, one of {names}, or a function (A, b) -> x, not {solver!r}")


def linear_solver(forms: Mapping[str, Form], solver: Any, locations: ndarray, free: ndarray) -> LinearSolver:
    """The linear solver of an analysis, see :func:`as_solver`: where the tangents of its forms change decides.

    A user's own function and multigrid are used for everything; None leaves the choice to what is installed, and
    multigrid where it pays.
    """
    changing = [form.changing for form in forms.values() if form.changing is not None]
    anywhere = len(changing) < len(forms)
    interface = np.unique(np.concatenate(changing or [np.zeros(0, int)]))
    if solver == "amg":
        return AmgSolver(locations, free, interface)
    engine = fastest_engine() if solver is None else ""
    large = solver is None and amg_pays(locations, free, engine) and not any(form.fields for form in forms.values())
    inner = AmgOrDirect(locations, free, interface, engine) if large else as_solver(solver, locations, free)
    if callable(solver) or anywhere or len(interface) == 0 or (large and len(free) > FACTORED_ONCE):
        return inner  # where bodies yield, factors that are made to be kept do not pay
    return SchurSolver(inner, locations, free, interface)
