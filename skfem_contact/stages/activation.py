"""What is there in each stage: bodies and contacts that come and go, supports that change."""
from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix, diags_array

from ..contact.penalty import choose_penalties
from ..contact.prestress import prestressed
from ..errors import Remark, look_up, names_of
from ..forms.base import Form, as_forms, carried, solids_of
from ..layout import Layout
from ..solvers.choice import as_solver
from ..sparse import padded
from .setup import not_there, on_all, unknowns_of
from .supports import all_unknowns, as_unknowns, check_supports

if TYPE_CHECKING:
    from ..results.result import StageResult
    from .run import Stage

#: Springs to the ground, as a share of the stiffness, that hold what a new body does not share with others.
_LOOSE = 1e-9
#: Loads on nothing below this share of the largest one are round-off of their integration.
_NO_LOAD = 1e-12


@dataclass(frozen=True)
class Phase:
    """What is there in a stage.

    Attributes
    ----------
    unknowns, load, prescribed
        All unknowns, those of forms that are not there included, and loads and displacements of all, (N,).
    before, forms
        Forms that are active before, as they are then, and in the stage.
    fixed
        Layout that are supported, or held because no active solid has them.
    changed
        Whether the stage begins with anything else than the one before ended with.
    remarks
        What in the stage changes nothing, and was probably meant to.
    """

    unknowns: Layout
    before: dict[str, Form]
    forms: dict[str, Form]
    fixed: ndarray
    load: ndarray
    prescribed: ndarray | None
    changed: bool
    remarks: tuple[Remark, ...] = ()


def plan(forms: Mapping[str, Form], stages: Sequence[Stage], fixed: ndarray, start: StageResult | None) -> list[Phase]:
    """What is there in every stage; all of it is checked before anything is computed.

    Raises
    ------
    ValueError
        Names that do not exist, a form that is activated twice, contact with a body that is not there, a load on
        one, or a body without support; the stage is named.
    """
    unknowns = all_unknowns(forms, np.size(stages[0].load))
    now = choose_penalties(forms)
    active = _at_first(forms, stages, start)
    phases: list[Phase] = []
    time = 0.0
    for stage in stages:
        before = {name: now[name] for name in now if name in active}
        changes = bool(stage.activate or stage.deactivate or stage.change or stage.fixed is not None)
        try:
            active = _after(stage, now, active)
            now.update({name: _changed(name, now[name], new) for name, new in as_forms(stage.change).items()})
            supported, fixed = fixed, fixed if stage.fixed is None else as_unknowns(stage.fixed)
            there = {name: now[name] for name in now if name in active}
            if changes or not phases:
                held = not_there(now, there, unknowns)
                check_contacts(there, held)
                check_supports(there, np.union1d(fixed, held), unknowns)
        except ValueError as error:
            raise (ValueError(f"stage '{stage.name}': {error}") if changes else error) from None
        load, prescribed = _values(stage, unknowns, held, [name for name in now if name not in active])
        waits = bool(phases) and not changes and prescribed is None and np.array_equal(load, phases[-1].load)
        time = time + stage.duration if waits else stage.duration
        remarks = (*_idle(stage, load, prescribed, phases, np.array_equal(supported, fixed)),
                   *_of_forms(stage, there, fixed, held, time))
        phases.append(Phase(unknowns, before, there, np.union1d(fixed, held), load, prescribed,
                            changes and bool(phases or start is not None), remarks))
    return phases


def _at_first(forms: Mapping[str, Form], stages: Sequence[Stage], start: StageResult | None) -> set[str]:
    """What the start holds; without one, all that is not activated later, before anything else happens to it."""
    if start is not None:
        if not set(start.states) <= set(forms):
            raise ValueError(f"start holds the forms {list(start.states)}, not {list(forms)}")
        return set(start.states)
    later: set[str] = set()
    seen: set[str] = set()
    for stage in stages:
        later |= set(names_of(stage.activate)) - seen
        seen |= set(names_of(stage.activate)) | set(names_of(stage.deactivate))
    return set(forms) - later


def _after(stage: Stage, forms: Mapping[str, Form], active: set[str]) -> set[str]:
    """Names of what is active in a stage."""
    for name in (*names_of(stage.activate), *names_of(stage.deactivate), *stage.change):
        look_up(name, forms, "form")
    for name in names_of(stage.activate):
        if name in active:
            raise ValueError(f"'{name}' is activated, but it is active already")
    for name in names_of(stage.deactivate):
        if name not in active:
            raise ValueError(f"'{name}' is deactivated, but it is not active")
    return (active | set(names_of(stage.activate))) - set(names_of(stage.deactivate))


def _changed(name: str, old: Form, new: Form) -> Form:
    """The new form in the place of the old one, whose state it goes on from."""
    try:
        return new.continues(old)
    except ValueError as error:
        raise ValueError(f"'{name}' can only be changed to another material or law of the same elements or surfaces "
                         f"({error}); deactivate it and activate another form instead") from None


def check_contacts(there: Mapping[str, Form], held: ndarray) -> None:
    """Refuse forms that act on bodies that are not there, whose unknowns are held."""
    for name, form in there.items():
        if any(unknowns is not None and np.isin(unknowns, held).any() for unknowns in (form.joins, form.acts_on)):
            raise ValueError(f"'{name}' is active, but acts on a body that is not there: {form!r}")


def _values(stage: Stage, unknowns: Layout, held: ndarray, absent: list[str]) -> tuple[ndarray, ndarray | None]:
    """Load and prescribed displacements of all unknowns: as many as these, finite, and acting on what is there."""
    load = on_all(stage.load, unknowns, f"stage '{stage.name}': the load")
    if acts_on(load, held):
        raise ValueError(f"stage '{stage.name}': a part of the load acts on bodies that are not there; {absent} are "
                         "not active")
    if stage.prescribed is None:
        return load, None
    return load, on_all(stage.prescribed, unknowns, f"stage '{stage.name}': the prescribed displacement")


def _idle(stage: Stage, load: ndarray, prescribed: ndarray | None, before: list[Phase], same_supports: bool
          ) -> Iterator[Remark]:
    """Remarks on supports that are given though they are those of before, and on a stage that changes nothing."""
    if stage.fixed is not None and same_supports:
        yield Remark("supports", 0.0, "`fixed` holds what is supported already: a boundary or a place is empty")
    others = stage.activate or stage.deactivate or stage.change or stage.duration
    if before and not others and same_supports and np.array_equal(load, before[-1].load) and prescribed is None:
        yield Remark("nothing", 0.0, "it changes nothing: its load and its supports are those of the stage before")


def _of_forms(stage: Stage, there: Mapping[str, Form], fixed: ndarray, held: ndarray, time: float) -> list[Remark]:
    """What the forms remark on the stage, which ends some time after anything has begun to change."""
    try:
        return [replace(remark, text=f"{name}: {remark.text}") for name, form in there.items()
                for remark in form.check_stage(fixed, held, time if stage.duration else 0.0)]
    except ValueError as error:
        raise ValueError(f"stage '{stage.name}': {error}") from None


def among(start: StageResult, unknowns: Layout) -> StageResult:
    """A start, which may know displacements only, among all unknowns."""
    return replace(start, x=on_all(start.x, unknowns, "start"), load=on_all(start.load, unknowns, "start"))


def acts_on(load: ndarray, unknowns: ndarray) -> bool:
    """Whether a load is more than round-off at some unknowns."""
    return len(unknowns) > 0 and bool(np.abs(load[unknowns]).max() > _NO_LOAD * np.abs(load).max())


def begin(phase: Phase, last: StageResult) -> tuple[ndarray, dict[str, Any], ndarray]:
    """Start of a stage: displacements, states, and forces that are to be released during the stage, (N,).

    New solids are stress-free in the deformed ground, new water is without excess pressure. A new contact pair carries
    no traction, unless it takes the place of one between the same surfaces: then it takes over its tractions, so that
    nothing moves. What is out of balance then, because a body, a support, strength or the pressure of water has gone,
    is to be released.
    """
    new = {name: form for name, form in phase.forms.items() if name not in phase.before}
    known = unknowns_of(phase.before)
    x = last.x.copy()
    for still in (each.numbers for form in new.values() for each in form.fields if not each.moves):
        x[np.setdiff1d(still, known)] = 0.0
    x = placed(x, new, known, phase.fixed)
    states = {name: form.initial_state(x[:form.size]) if name in new
              else _inherited(form, phase.before[name], last, name) for name, form in phase.forms.items()}
    for name, form in new.items():
        gone = {k: f for k, f in phase.before.items() if k not in phase.forms and form.replaces(f)}
        operator = form.tractions_at(x[:form.size], states[name]) if gone else None
        if operator is not None:
            states[name] = prestressed({name: operator}, carried(gone, last.x, last.states)[:form.size])[name]
    lost = last.load - carried(phase.forms, x, states)
    lost[phase.fixed] = 0.0
    return x, states, lost


def _inherited(form: Form, before: Form, last: StageResult, name: str) -> Any:
    """The state that a form goes on from, in the place of one before or of that with which the last stage ended."""
    old, state = last.forms.get(name, before), last.states[name]
    return state if form is old else form.inherits(old, state)


def state_changes(phase: Phase, last: StageResult) -> bool:
    """Whether the forms of a stage make something else of the states with which the last one ended."""
    return any(name in phase.forms and _inherited(form, form, last, name) is not last.states[name]
               for name, form in phase.before.items())


def placed(x: ndarray, new: Mapping[str, Form], known: ndarray, fixed: ndarray) -> ndarray:
    """Displacements with the nodes of new solids carried along by those that they share with old ones.

    They move as if the new solids were an elastic attachment of the old ones, whose unknowns are `known`; bodies that
    share no node stay.
    """
    solids = solids_of(new)
    own = np.setdiff1d(unknowns_of(solids), np.union1d(known, fixed))
    if len(own) == 0 or not x.any():
        return x
    first, *others = (form.elastic_stiffness for form in solids.values())
    K = sum(others, start=first)
    K = padded(csr_matrix(K + _LOOSE * diags_array(K.diagonal())), len(x))
    start = x.copy()
    start[own] = 0.0
    places = np.asarray(next(iter(solids.values())).basis.doflocs)
    places = np.pad(places, ((0, 0), (0, len(x) - places.shape[1])))  # unknowns that no solid has are not asked for
    moved = as_solver(None, places, own).factor(K)(-(K @ start))
    result = x.copy()
    result[own] = moved[own]
    return result


def check_start(forms: Mapping[str, Form], start: StageResult) -> None:
    """Refuse a start of another mesh, or whose contact pairs have got another penalty since."""
    for name, form in forms.items():
        try:
            form.check_start(start.x[:form.size], start.states[name])
        except ValueError as error:
            raise ValueError(f"'{name}' cannot go on from the start: {error}") from None
