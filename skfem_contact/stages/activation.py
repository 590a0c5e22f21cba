"""Activation: start of a stage whose bodies, contacts or supports have changed."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix, diags_array

from ..contact.prestress import prestressed
from ..forms.base import Form, Forms, internal_force, solids_of
from ..forms.roles import Staged, Touching, Wet, having
from ..layout import Layout
from ..results.fields import undrained_excess
from ..results.stage import StageResult
from ..solvers.choice import as_solver
from ..sparse import padded
from .plan import Phase
from .setup import dofs_of

#: Springs to the ground, as a share of the stiffness, that hold what a new body does not share with
#: others.
_LOOSE = 1e-9


def begin(
    layout: Layout, phase: Phase, last: StageResult
) -> tuple[ndarray, dict[str, Any], ndarray]:
    """Return the start of a stage: displacements, states, and lost forces, (N,).

    New solids are stress-free in the deformed ground. New water and opened drains are without
    excess pressure; undrained ground keeps its excess pressure. A new contact pair has no traction,
    unless it replaces a pair between the same surfaces: then it takes over the tractions, so that
    nothing moves. Forces out of balance, because a body, a support, strength or water pressure has
    gone, are lost: the stage releases them.
    """
    new = {name: form for name, form in phase.forms.items() if name not in phase.before}
    known = dofs_of(phase.before, layout)

    # Move new bodies along, and give new water the excess pressure of undrained ground.
    x = last.x.copy()
    unmoved = np.intersect1d(layout.still, dofs_of(new, layout))
    unmoved = np.setdiff1d(unmoved, known)
    wet = [np.zeros(0, int), *(water.elements for water in having(new, Wet).values())]
    x[unmoved] = undrained_excess(last, layout, np.concatenate(wet))[unmoved]
    x = placed(layout, x, new, known, phase.fixed)

    # Begin or continue the states.
    states = {}
    for name, form in phase.forms.items():
        if name in new:
            if isinstance(form, Staged):
                begun = form.supported(phase.fixed)[0]
            else:
                begun = form
            states[name] = begun.initial_state(x[: form.size])
        else:
            states[name] = _inherited(form, phase.before[name], last, name)
    _take_over_tractions(phase, last, x, states)

    # Find the forces that nothing balances.
    lost = last.load - internal_force(phase.forms, x, states)
    if phase.in_time is not None and last.inertial is not None:
        lost -= last.inertial  # inertia stays
    lost[phase.fixed] = 0.0
    x[phase.opened] = 0.0
    x[np.intersect1d(unmoved, phase.fixed)] = 0.0
    return x, states, lost


def _take_over_tractions(
    phase: Phase,
    last: StageResult,
    x: ndarray,
    states: dict[str, Any],
) -> None:
    """Give new contact pairs the tractions of pairs that they replace."""
    # Pairs that end with this stage.
    deactivated = {}
    for k, form in phase.before.items():
        if k not in phase.forms:
            deactivated[k] = form
    for name, pair in having(phase.forms, Touching).items():
        if name in phase.before:
            continue
        replaced = {}
        for k, form in deactivated.items():
            if pair.replaces(form):
                replaced[k] = form
        # The forces of the replaced pairs become tractions of the new one.
        operator = None
        if replaced:
            operator = pair.tractions_at(x[: pair.size], states[name])
        if operator is not None:
            force = internal_force(replaced, last.x, last.states)
            states[name] = prestressed({name: operator}, force[: pair.size])[name]


def _inherited(form: Form, before: Form, last: StageResult, name: str) -> Any:
    """Return the state that a form continues from the end of the last stage."""
    old = last.forms.get(name, before)
    state = last.states[name]
    if form is old or not isinstance(form, Staged):
        return state
    return form.inherits(old, state)


def state_changes(phase: Phase, last: StageResult) -> bool:
    """Return True if any form changes the inherited state, or a drain opens."""
    if len(phase.opened) > 0:
        return True
    for name, form in phase.before.items():
        if name in phase.forms and _inherited(form, form, last, name) is not last.states[name]:
            return True
    return False


def placed(
    layout: Layout,
    x: ndarray,
    new: Forms,
    known: ndarray,
    fixed: ndarray,
) -> ndarray:
    """Return displacements with new solids moved along by the nodes that they share with old ones.

    They move as if the new solids were an elastic attachment of the old ones, whose dofs are
    `known`; bodies that share no node stay.
    """
    solids = solids_of(new)
    own = np.setdiff1d(dofs_of(solids, layout), np.union1d(known, fixed))
    if len(own) == 0 or not x.any():
        return x
    # Move the new nodes as an elastic body between the old ones.
    first, *others = (form.elastic_stiffness for form in solids.values())
    K = sum(others, start=first)
    K = csr_matrix(K + _LOOSE * diags_array(K.diagonal()))
    K = padded(K, len(x))
    start = x.copy()
    start[own] = 0.0
    moved = as_solver(None, layout.coordinates, own).factor(K)(-(K @ start))
    result = x.copy()
    result[own] = moved[own]
    return result


def check_start(forms: Forms, start: StageResult) -> None:
    """Refuse a start of another mesh, or whose contact pairs have another penalty."""
    for name, pair in having(forms, Touching).items():
        try:
            pair.check_start(start.x[: pair.size], start.states[name])
        except ValueError as error:
            raise ValueError(f"'{name}' cannot continue the start: {error}") from None
