"""Stability of a structure: one equilibrium or one collapse costs far less than a factor of safety."""
from __future__ import annotations

from typing import Any

from ..errors import NoEquilibrium, NotConverged
from ..nonlinear.newton import Newton
from ..results.result import Result, StageResult
from ..solvers import single_threaded
from ..stages.setup import Setup
from .continuation import as_collapse, loaded_start


@single_threaded
def is_stable(setup: Setup, load: Any, start: Result | StageResult | None) -> bool:
    """Return True if a structure carries its load, see :meth:`skfem_contact.Model.is_stable`."""
    begun = loaded_start(setup, load, start)
    system, origin = begun.system, begun.origin
    try:
        system.equilibrium(origin.x, origin.states, begun.weight + begun.load, origin.x[system.fixed],
                           setup.newton or Newton(tolerance=3e-4, max_iterations=60), ("energy", "residual"),
                           at_least=1, damp=True)
    except NotConverged as error:
        if isinstance(as_collapse(error, system), NoEquilibrium):
            return False
        raise
    return True
