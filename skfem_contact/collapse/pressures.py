"""Pore pressures in a search for a collapse: kept, or of ground that has no time to drain."""

from __future__ import annotations

from itertools import chain

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix, diags

from ..errors import warn
from ..forms.base import Form, Forms, States, responses_of
from ..forms.roles import Body, Timed, Wet, borrowed_by, changed, having
from ..nonlinear.system import System
from ..solvers.direct import DirectSolver, SingularSystem
from ..sparse import Total

#: Thrust of the pressures that have yet to drain, as a share of the load, that is remarked on. A
#: cut of 6 m has .055 at once and a factor of 2.74 for 2.50 without drainage; .010 and 2.40 for
#: 2.41 after a year.
_FRESH = 0.05
#: Time for drainage, over the time of the tightest element and of a line of all nodes.
_LONG = 1e2


def carriers(forms: Forms) -> dict[str, Form]:
    """Return the forms that bring or move pore pressures."""
    wet = {}
    for name, form in forms.items():
        kinds = [field.kind for field in (*form.fields, *borrowed_by(form))]
        if "pressure" in kinds:
            wet[name] = form
    return wet


def _pressures(wet: Forms) -> ndarray:
    """Return the dofs of the pressures of some forms."""
    waters = having(wet, Wet).values()
    own = [water.carries for water in waters if water.carries is not None]
    return np.concatenate([np.zeros(0, int), *own])


def without_drainage(forms: Forms, fixed: ndarray, flow: str) -> tuple[dict[str, Form], ndarray]:
    """Return forms whose water does not flow, and fixed dofs without their pressures."""
    # check that water can be trapped, under a flow rule with an end
    wet = carriers(forms)
    if not any(form.fields for form in wet.values()):
        raise ValueError(
            "undrained=True is for ground with PoreWater, and none is active: give the ground "
            "Undrained materials"
        )
    if flow != "given":
        raise ValueError(
            f"undrained=True takes the flow rule as given, not flow='{flow}': ground that dilates "
            "and cannot drain gets stronger without end"
        )
    soils = chain.from_iterable(body.materials.values() for body in having(forms, Body).values())
    if any(soil.dilates for soil in soils):
        warn(
            "a soil that dilates, psi > 0, gets stronger without end where its water cannot leave; "
            "undrained soils take psi=0"
        )

    # stop the flow, and free the pressures
    undrained = changed(forms, Timed, lambda form: form.undrained())
    return undrained, np.setdiff1d(fixed, _pressures(wet))


def _assembled(forms: Forms, x: ndarray, states: States) -> tuple[ndarray, csr_matrix]:
    """Return force and tangent of some forms, (N,) and (N, N)."""
    responses = responses_of(forms, x, states).values()
    force = sum((response.force for response in responses), start=np.zeros(len(x)))
    return force, Total().of([response.stiffness for response in responses])


def warn_of_fresh_pressures(
    system: System,
    x: ndarray,
    states: States,
    load: ndarray,
) -> None:
    """Raise a warning where a search keeps pressures that have yet to drain.

    The pressures drain in one implicit step of so long a time that nothing remains of them. The
    thrust on the displacements of the change of pressure is compared with the load.
    """
    wet = carriers(system.forms)
    p = np.intersect1d(_pressures(wet), system.free)
    if len(p) == 0:
        return

    # time for drainage: from the diagonals of capacity and, in a unit of time, of flow
    capacity = _assembled(wet, x, states)[1].diagonal()
    in_unit_time = changed(wet, Timed, lambda form: form.over(1.0))
    rates = abs(_assembled(in_unit_time, x, states)[1].diagonal())
    if not (capacity[p].all() and rates[p].all()):
        return
    long = _LONG * float((capacity[p] / rates[p]).max()) * len(p) ** 2

    # change of pressure in that time, and its thrust
    force, K = _assembled(changed(wet, Timed, lambda form: form.over(long)), x, states)
    flow = (K - diags(capacity)).tocsr()
    try:
        change = DirectSolver(system.layout.coordinates, p).factor(flow)(-force)
    except SingularSystem:
        return
    moved = np.intersect1d(system.free, system.layout.displacements)
    thrust = float(np.linalg.norm((K @ change)[moved]))
    share = thrust / max(float(np.linalg.norm(load)), 1e-300)
    if share > _FRESH:
        warn(
            "the search keeps excess pore pressures that have yet to drain; their thrust is "
            f"{share:.2g} of the load. The value is that of a collapse as slow as the drainage; "
            "just after a quick change it may be lower: undrained=True"
        )
