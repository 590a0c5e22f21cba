"""What is there in each stage: bodies and contacts that come and go, supports that change."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix, diags_array

from ..contact.laws import Status
from ..contact.pair import ContactPair
from ..contact.penalty import choose_penalties
from ..contact.prestress import prestressed
from ..errors import look_up
from ..forms import Form
from ..solid import SolidForm
from ..solvers.choice import as_solver
from .setup import check_vector, unknowns_of
from .supports import as_unknowns, check_supports

if TYPE_CHECKING:
    from .result import StageResult
    from .stage import Stage

#: Springs to the ground, as a share of the stiffness, that hold what a new body does not share with others.
_LOOSE = 1e-9
#: Loads on nothing below this share of the largest one are round-off of their integration.
_NO_LOAD = 1e-12
#: Tractions that differ by this share come from another penalty.
_SAME = 1e-6


@dataclass(frozen=True)
class Phase:
    """What is there in a stage.

    Attributes
    ----------
    before
        Forms that are active before, by name: as they are then.
    forms
        Forms that are active in the stage, by name.
    fixed
        Unknowns that are supported, or held because no active solid has them.
    changed
        Whether the stage begins with anything else than the one before ended with.
    """

    before: dict[str, Form]
    forms: dict[str, Form]
    fixed: ndarray
    changed: bool


def plan(forms: Mapping[str, Form], stages: Sequence[Stage], fixed: ndarray, start: StageResult | None) -> list[Phase]:
    """What is there in every stage; all of it is checked before anything is computed.

    Parameters
    ----------
    forms
        All forms; contact pairs without a penalty get one.
    stages
        Stages in their order.
    fixed
        Unknowns that are supported at first.
    start
        What the first stage starts from, if anything.

    Raises
    ------
    ValueError
        Names that do not exist, a form that is activated twice, contact with a body that is not there, a load on
        one, or a body without support; the stage is named.
    """
    now, active = dict(forms), _at_first(forms, stages, start)
    phases: list[Phase] = []
    for stage in stages:
        before = {name: now[name] for name in now if name in active}
        changes = bool(stage.activate or stage.deactivate or stage.change or stage.fixed is not None)
        try:
            active = _after(stage, now, active)
            now.update({name: _changed(name, now[name], new) for name, new in stage.change.items()})
            fixed = fixed if stage.fixed is None else as_unknowns(stage.fixed)
            there = {name: now[name] for name in now if name in active}
            held = np.setdiff1d(unknowns_of(now), unknowns_of(there))
            if changes or not phases:
                check_contacts(there, held)
                check_supports(there, np.union1d(fixed, held))
        except ValueError as error:
            raise (ValueError(f"stage '{stage.name}': {error}") if changes else error) from None
        _check_values(stage, _size(there), held, [name for name in now if name not in active])
        phases.append(Phase(before, there, np.union1d(fixed, held), changes and bool(phases or start is not None)))
    return _with_penalties(phases, forms)


def _with_penalties(phases: list[Phase], forms: Mapping[str, Form]) -> list[Phase]:
    """Contact pairs keep their penalty through all stages, whatever their law and whatever is around them."""
    chosen = choose_penalties(forms)

    def finished(name: str, form: Form) -> Form:
        if form is forms[name]:
            return chosen[name]
        if isinstance(form, ContactPair) and form.penalty is None:
            normal, tangential = chosen[name].penalty
            return form.with_penalty(normal, tangential, chosen[name].stiffness)
        return form

    return [replace(phase, before={k: finished(k, f) for k, f in phase.before.items()},
                    forms={k: finished(k, f) for k, f in phase.forms.items()}) for phase in phases]


def _at_first(forms: Mapping[str, Form], stages: Sequence[Stage], start: StageResult | None) -> set[str]:
    """What the start holds; without one, all that is not activated later, before anything else happens to it."""
    if start is not None:
        if not set(start.states) <= set(forms):
            raise ValueError(f"start holds the forms {list(start.states)}, not {list(forms)}")
        return set(start.states)
    later: set[str] = set()
    seen: set[str] = set()
    for stage in stages:
        later |= set(_names(stage.activate)) - seen
        seen |= set(_names(stage.activate)) | set(_names(stage.deactivate))
    return set(forms) - later


def _names(given: str | Sequence[str]) -> tuple[str, ...]:
    return (given,) if isinstance(given, str) else tuple(given)


def _after(stage: Stage, forms: Mapping[str, Form], active: set[str]) -> set[str]:
    """Names of what is active in a stage."""
    for name in (*_names(stage.activate), *_names(stage.deactivate), *stage.change):
        look_up(name, forms, "form")
    for name in _names(stage.activate):
        if name in active:
            raise ValueError(f"'{name}' is activated, but it is active already")
    for name in _names(stage.deactivate):
        if name not in active:
            raise ValueError(f"'{name}' is deactivated, but it is not active")
    return (active | set(_names(stage.activate))) - set(_names(stage.deactivate))


def _changed(name: str, old: Form, new: Form) -> Form:
    """The new form in the place of the old one, whose state it goes on from."""
    same = type(old) is type(new)
    if isinstance(old, SolidForm) and isinstance(new, SolidForm):
        same = np.array_equal(old.basis.element_dofs, new.basis.element_dofs) and old.weight.shape == new.weight.shape
    if isinstance(old, ContactPair) and isinstance(new, ContactPair):
        same = (old.slave.name, old.facets.name, old.quadrature) == (new.slave.name, new.facets.name, new.quadrature)
    if not same:
        raise ValueError(f"'{name}' can only be changed to another material or law of the same elements or surfaces; "
                         "deactivate it and activate another form instead")
    return new


def _size(forms: Mapping[str, Form]) -> int:
    return next(int(form.basis.N) for form in forms.values() if isinstance(form, SolidForm))


def check_contacts(there: Mapping[str, Form], held: ndarray) -> None:
    """Refuse contact with bodies that are not there, whose unknowns are held."""
    for name, form in there.items():
        if isinstance(form, ContactPair) and np.isin(form.unknowns, held).any():
            raise ValueError(f"contact '{name}' is active, but a part of '{form.slave.name}' or '{form.facets.name}' "
                             "belongs to a body that is not")


def _check_values(stage: Stage, n: int, held: ndarray, absent: list[str]) -> None:
    """Load and prescribed displacements are as many as the unknowns, finite, and act on what is there."""
    given = [("load", stage.load)]
    if stage.prescribed is not None:
        given.append(("prescribed displacement", stage.prescribed))
    for what, values in given:
        check_vector(values, n, f"stage '{stage.name}': the {what}")
    if acts_on(stage.load, held):
        raise ValueError(f"stage '{stage.name}': a part of the load acts on bodies that are not there; {absent} are "
                         "not active")


def acts_on(load: ndarray, unknowns: ndarray) -> bool:
    """Whether a load is more than round-off at some unknowns."""
    return len(unknowns) > 0 and bool(np.abs(load[unknowns]).max() > _NO_LOAD * np.abs(load).max())


def begin(phase: Phase, last: StageResult) -> tuple[ndarray, dict[str, Any], ndarray]:
    """Start of a stage: displacements, states, and forces that are to be released during the stage, (N,).

    New solids are stress-free in the deformed ground. A new contact pair carries no traction, unless it takes the
    place of one between the same surfaces: then it takes over its tractions, so that nothing moves. What is
    out of balance then, because a body, a support or strength has gone, is to be released.
    """
    new = {name: form for name, form in phase.forms.items() if name not in phase.before}
    x = placed(last.x, new, unknowns_of(phase.before), phase.fixed)
    states = {name: form.initial_state(x) if name in new else last.states[name] for name, form in phase.forms.items()}
    for name, form in new.items():
        if isinstance(form, ContactPair):
            gone = {k: f for k, f in phase.before.items() if k not in phase.forms and _same_surfaces(f, form)}
            carried = sum((f.assemble(last.x, last.states[k]).force for k, f in gone.items()), start=np.zeros(len(x)))
            if gone:
                states[name] = prestressed({name: form}, x, {name: states[name]}, carried)[name]
    lost = last.load - sum(form.assemble(x, states[name]).force for name, form in phase.forms.items())
    lost[phase.fixed] = 0.0
    return x, states, lost


def _same_surfaces(old: Form, new: ContactPair) -> bool:
    return isinstance(old, ContactPair) and {old.slave.name, old.facets.name} == {new.slave.name, new.facets.name}


def placed(x: ndarray, new: Mapping[str, Form], known: ndarray, fixed: ndarray) -> ndarray:
    """Displacements with the nodes of new solids carried along by those that they share with old ones.

    They move as if the new solids were an elastic attachment of the old ones; bodies that share no node stay.

    Parameters
    ----------
    x
        Displacements, (N,).
    new
        The new forms; solids among them are placed.
    known, fixed
        Unknowns of the old solids, and those that are held or not there.
    """
    solids = {name: form for name, form in new.items() if isinstance(form, SolidForm)}
    own = np.setdiff1d(unknowns_of(solids), np.union1d(known, fixed))
    if len(own) == 0 or not x.any():
        return x
    first, *others = (form.elastic_stiffness for form in solids.values())
    K = sum(others, start=first)
    K = csr_matrix(K + _LOOSE * diags_array(K.diagonal()))
    start = x.copy()
    start[own] = 0.0
    locations = next(iter(solids.values())).basis.doflocs
    moved = as_solver(None, locations, own).factor(K)(-(K @ start))
    result = x.copy()
    result[own] = moved[own]
    return result


def check_start(forms: Mapping[str, Form], start: StageResult) -> None:
    """Refuse a start of another mesh, or whose contact pairs have got another penalty since.

    Parameters
    ----------
    forms
        Forms that are active in it.
    start
        What the first stage starts from.
    """
    n = _size(forms)
    if len(start.x) != n:
        raise ValueError(f"start has {len(start.x)} unknowns, not {n}")
    for name, form in forms.items():
        if not isinstance(form, ContactPair):
            continue
        old = start.states[name]
        new = form.assemble(start.x, old).state
        both = (new.status != Status.OPEN) & (old.status != Status.OPEN)
        pressure = old.traction[0]
        if np.abs(new.traction[0] - pressure)[both].max(initial=0.0) > _SAME * np.abs(pressure).max(initial=0.0):
            raise ValueError(f"contact '{name}' has another penalty than in the start: give `penalty=`, or use "
                             "choose_penalties(forms) of the same forms in both analyses")
