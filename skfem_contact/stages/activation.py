"""Activation: bodies and contacts that become active and inactive, supports that change."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix, diags_array

from ..checks import look_up, names_of
from ..contact.prestress import prestressed
from ..errors import Remark
from ..forms.base import Form, internal_force, solids_of
from ..forms.roles import Couples, Staged, Touching, Wet, having, joined_by
from ..layout import Layout, nodes
from ..results.fields import undrained_elements, undrained_excess
from ..results.stage import StageResult
from ..solvers.choice import as_solver
from ..sparse import padded
from .setup import Setup, dofs_of
from .stage import Stage
from .supports import check_supports

#: Springs to the ground, as a share of the stiffness, that hold what a new body does not share with
#: others.
_LOOSE = 1e-9
#: Share of the nodes of a solid from which a load is its weight: a traction acts on half of them at
#: most.
_WEIGHTY = 0.6
#: Loads on inactive dofs below this share of the largest one are round-off of their integration.
_NO_LOAD = 1e-12


@dataclass(frozen=True)
class Phase:
    """Active forms, supports and loads of a stage.

    Attributes
    ----------
    before, forms
        Forms that are active before, as they are then, and in the stage.
    fixed
        Dofs that are supported, or held because no active form has them.
    load, prescribed
        Load at the end and prescribed displacements of all dofs, (N,).
    changed
        True if the stage begins with anything else than the one before ended with.
    gone
        Weight and water load that vanish with deactivated bodies at the dofs that stay, where they
        are released in part, (N,).
    on_top
        Load as a function of the share of the stage, where it is given as one.
    remarks
        Remarks on what changes nothing in the stage, and was probably meant to.
    water
        Water at rest, as the stage or one before gave it.
    replaced, supports
        Forms that the stage or ones before have changed, and the supported dofs.
    opened
        Pressures that are held from the stage on, and not prescribed.
    """

    before: dict[str, Form]
    forms: dict[str, Form]
    fixed: ndarray
    load: ndarray
    prescribed: ndarray | None
    changed: bool
    gone: ndarray
    on_top: Callable[[float], ndarray] | None = None
    remarks: tuple[Remark, ...] = ()
    water: Any = None
    replaced: Mapping[str, Form] = field(default_factory=dict)
    supports: ndarray | None = None
    opened: ndarray = field(default_factory=lambda: np.zeros(0, int))


def plan(setup: Setup, stages: Sequence[Stage], start: StageResult | None) -> list[Phase]:
    """Return active forms, supports and loads of every stage; all of it is checked before anything
    is computed.
    """
    now, fixed = dict(setup.forms), setup.fixed
    active, phases = _at_first(now, stages, start), list[Phase]()
    there = {name: now[name] for name in now if name in active}
    time, water, nothing = 0.0, None if start is None else start.water, np.zeros(setup.layout.size)
    left = start is not None and start.unreleased is not None
    top = nothing if start is None else setup.vector(start.load, "start") - setup.weights(there)
    for stage in stages:
        before, changes = (
            there,
            bool(stage.activate or stage.deactivate or stage.change or stage.fixed is not None),
        )
        try:
            old, fixed = fixed, fixed if stage.fixed is None else setup.layout.dofs(stage.fixed)
            if changes or not phases:
                active = _after(stage, now, active)
                now.update(_changed(setup, stage.change, now))
                there = {name: now[name] for name in now if name in active}
                check_contacts(there, held := setup.inactive(there))
                check_supports(there, still := np.union1d(fixed, held))
        except ValueError as error:
            raise (ValueError(f"stage '{stage.name}': {error}") if changes else error) from None
        water = water if stage.water is None else stage.water
        if changes or not phases or stage.water is not None:
            rest = _at_rest(setup, there, water, held)
        load, on_top = _loads(
            setup, stage, rest, held, [name for name in now if name not in active]
        )
        prescribed = (
            None
            if stage.prescribed is None
            else setup.vector(
                stage.prescribed, f"stage '{stage.name}': the prescribed displacement"
            )
        )
        same = bool(phases) and np.array_equal(load, phases[-1].load)
        waits = same and not (changes or left) and prescribed is None and on_top is None
        time = time + stage.duration if waits else stage.duration
        remarks = (
            *_idle(
                stage,
                same and prescribed is None,
                stage.fixed is None or np.array_equal(old, fixed),
                left,
            ),
            *_of_forms(stage, there, fixed, held, time),
            *_of_pressures(setup, stage, there, load, prescribed, fixed, water),
            *_of_weights(
                setup, stage, {k: there[k] for k in before if k in there}, top, load - rest
            ),
        )
        top, left = load - rest, (changes or left) and stage.release < 1.0
        gone = (
            _freed(_at_rest(setup, before, water, held) - rest, still)
            if left and stage.deactivate
            else nothing
        )
        changed = changes and bool(phases or start is not None)
        phases.append(
            Phase(
                before,
                there,
                still,
                load,
                prescribed,
                changed,
                gone,
                on_top,
                remarks,
                water,
                {name: form for name, form in now.items() if form is not setup.own[name]},
                fixed,
                _opened(setup, stage, fixed, old if phases or start is None else start.supports),
            )
        )
    return phases


def timeless(setup: Setup, stages: Sequence[Stage], last: Phase) -> Iterator[Remark]:
    """Yield a remark on solids that creep in stages none of which takes time; initial states are
    without weights.
    """
    creeps = [
        name
        for name, form in solids_of(last.forms).items()
        if any(material.time_dependent for material in form.materials.values())
    ]
    if creeps and setup.gravity.any() and not any(stage.duration for stage in stages):
        yield Remark(
            "timeless",
            len(creeps),
            f"{creeps} would creep, but no stage takes any time, in which it is "
            "elastic: give Stage(duration=...)",
        )


def _opened(setup: Setup, stage: Stage, fixed: ndarray, before: ndarray | None) -> ndarray:
    """Return pressures that a stage holds beside those before, unless it prescribes them; files
    know none before.
    """
    if stage.prescribed is not None:
        return np.zeros(0, int)
    return np.intersect1d(
        setup.layout.pressures, np.setdiff1d(fixed, setup.fixed if before is None else before)
    )


def _loads(
    setup: Setup, stage: Stage, rest: ndarray, held: ndarray, absent: list[str]
) -> tuple[ndarray, Callable[[float], ndarray] | None]:
    """Return the whole load at the end of a stage, and as a function of its share where it is given
    as one.
    """
    what = f"stage '{stage.name}': the load"

    def on_top(share: float) -> ndarray:
        load = setup.load(stage.load(share) if callable(stage.load) else stage.load, what)
        if acts_on(load, held):
            raise ValueError(
                f"stage '{stage.name}': a part of the load acts on inactive bodies; {absent} are "
                f"not "
                "active"
            )
        return load + rest

    return on_top(1.0), on_top if callable(stage.load) else None


def _freed(load: ndarray, held: ndarray) -> ndarray:
    """Return a load without what acts on held dofs, (N,)."""
    load[held] = 0.0
    return load


def _at_rest(setup: Setup, active: Mapping[str, Form], water: Any, held: ndarray) -> ndarray:
    """Return the weights of active forms and the load of water on them, (N,)."""
    wet = setup.water_on(active, water)
    wet[held] = 0.0
    return setup.weights(active) + wet


def _at_first(
    forms: Mapping[str, Form], stages: Sequence[Stage], start: StageResult | None
) -> set[str]:
    """Return the names that the start holds; without one, those that are not activated later."""
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
    """Return the names of the active forms of a stage."""
    for name in (*names_of(stage.activate), *names_of(stage.deactivate), *stage.change):
        look_up(name, forms, "form")
    for name in names_of(stage.activate):
        if name in active:
            raise ValueError(f"'{name}' is activated, but it is active already")
    for name in names_of(stage.deactivate):
        if name not in active:
            raise ValueError(f"'{name}' is deactivated, but it is not active")
    return (active | set(names_of(stage.activate))) - set(names_of(stage.deactivate))


def _changed(setup: Setup, change: Mapping[str, Any], now: Mapping[str, Form]) -> dict[str, Form]:
    """Return the new forms, which continue the states of the present ones."""
    found = {}
    for name, new in change.items():
        try:
            found.update(setup.adopted({name: new}, now))
        except ValueError as error:
            raise ValueError(
                f"'{name}' can only be changed to another material or law of the same elements or "
                f"surfaces ({error}); deactivate it and activate another form instead"
            ) from None
    return found


def check_contacts(there: Mapping[str, Form], held: ndarray) -> None:
    """Refuse forms that act on inactive bodies, whose dofs are held."""
    for name, form in there.items():
        acts_on = form.acts_on if isinstance(form, Couples) else None
        if any(
            dofs is not None and np.isin(dofs, held).any() for dofs in (joined_by(form), acts_on)
        ):
            raise ValueError(f"'{name}' is active, but acts on an inactive body: {form!r}")


def _idle(stage: Stage, same_load: bool, same_supports: bool, left: bool) -> Iterator[Remark]:
    """Yield remarks on supports that are those of before, and on a stage that changes nothing."""
    if stage.fixed is not None and same_supports:
        yield Remark(
            "supports",
            0.0,
            "`fixed` holds what is supported already: leave it out, or a boundary is empty",
        )
    others = stage.activate or stage.deactivate or stage.change or stage.duration or left
    if same_load and same_supports and not others:
        yield Remark(
            "nothing",
            0.0,
            "it changes nothing: its load and its supports are those of the stage before",
        )


def _of_forms(
    stage: Stage, there: Mapping[str, Form], fixed: ndarray, held: ndarray, time: float
) -> list[Remark]:
    """Return the remarks of the forms on the stage, which ends some time after the last change."""
    try:
        return [
            replace(remark, text=f"{name}: {remark.text}")
            for name, form in having(there, Staged).items()
            for remark in form.check_stage(fixed, held, time if stage.duration else 0.0)
        ]
    except ValueError as error:
        raise ValueError(f"stage '{stage.name}': {error}") from None


def _of_pressures(
    setup: Setup,
    stage: Stage,
    there: Mapping[str, Form],
    load: ndarray,
    prescribed: ndarray | None,
    fixed: ndarray,
    water: Any,
) -> Iterator[Remark]:
    """Refuse loads on pressures, water per increment, and water that counts twice; report loose
    prescribed pressures.

    Report ground that drains at once because its water was not activated, and levels where there is
    suction.
    """
    layout, waters, active = setup.layout, having(setup.forms, Wet), having(there, Wet)
    if not waters:
        return
    solid = np.concatenate([form.elements for form in solids_of(there).values()])
    dry = [name for name, form in waters.items() if np.isin(form.elements, solid).any()]
    if stage.duration and dry and not active:
        yield Remark(
            "dry",
            len(dry),
            f"{dry} is not active in a stage with a duration: the ground drains at once; "
            "name it in `activate`",
        )
    if twice := sum(
        int(np.isin(undrained_elements(there), form.elements).sum()) for form in active.values()
    ):
        raise ValueError(
            f"stage '{stage.name}': {twice} elements are Undrained and have PoreWater too: their "
            f"water "
            "would count twice; give the soil alone, or deactivate the water"
        )
    for name in active if isinstance(water, float | int) and water is not False else ():
        if (suction := active[name].suction) > 0.0:
            yield Remark(
                "suction",
                suction,
                f"a level has none of the suction, up to {suction:.3g}, with which "
                f"'{name}' begins: give water=model.forms['{name}'].initial",
            )
    loose = np.setdiff1d(np.flatnonzero(0.0 * load if prescribed is None else prescribed), fixed)
    for one, part in zip(layout.fields, layout.parts, strict=True):
        if one.kind == "pressure" and (n := int(np.count_nonzero(load[part]))):
            raise ValueError(
                f"stage '{stage.name}': the load acts on the {one.name} at {n} dofs, where it "
                f"would be "
                "water per increment: prescribe pressures that are held"
            )
        n = int(np.count_nonzero((loose >= part.start) & (loose < part.stop)))
        if (
            one.kind == "pressure" and n and loose[0] >= layout.n_displacements
        ):  # else all dofs are given
            yield Remark(
                "loose",
                n,
                f"the {one.name} is prescribed at {n} dofs that are not held, which does "
                "nothing: name them in `fixed`",
            )


def _of_weights(
    setup: Setup, stage: Stage, forms: Mapping[str, Form], before: ndarray, load: ndarray
) -> Iterator[Remark]:
    """Yield remarks on weights of solids that stay, which the load on top had before, and lacks."""
    if stage.load is not None and not load.any():
        return  # nothing at all is asked for
    n, dim = setup.layout.n_displacements, len(setup.gravity)
    was, now = (values[:n].reshape(-1, dim) @ setup.gravity for values in (before, load))
    for name, form in solids_of(forms).items():
        there, least = np.unique(nodes(form.basis)), _NO_LOAD * np.abs(was).max(initial=0.0)
        lost = there[(np.abs(was[there]) > least) & (np.abs(now[there]) <= least)]
        total = float(was[lost].sum())
        if (
            form.own_weight(setup.gravity) is None
            and len(lost) > _WEIGHTY * len(there)
            and total > 0.0
        ):
            yield Remark(
                "weight",
                total,
                f"it lacks the weight of '{name}', about {total:.2g}, which the load before "
                "had: loads of stages are whole loads, not increments; add it, or give the solid "
                "its "
                "unit_weight",
            )


def acts_on(load: ndarray, dofs: ndarray) -> bool:
    """Return True if a load is more than round-off at some dofs."""
    return len(dofs) > 0 and bool(np.abs(load[dofs]).max() > _NO_LOAD * np.abs(load).max())


def begin(
    layout: Layout, phase: Phase, last: StageResult
) -> tuple[ndarray, dict[str, Any], ndarray]:
    """Return the start of a stage: displacements, states, and lost forces, (N,), to be released
    during the stage.

    New solids are stress-free in the deformed ground. New water and opened drains are without
    excess pressure, but for that of ground that could not drain. A new contact pair has no
    traction, unless it replaces one between the same surfaces: then it takes over its tractions, so
    that nothing moves. Forces out of balance, because a body, a support, strength or water pressure
    has gone, are lost.
    """
    new = {name: form for name, form in phase.forms.items() if name not in phase.before}
    known = dofs_of(phase.before, layout)
    x = last.x.copy()
    still = np.setdiff1d(np.intersect1d(layout.still, dofs_of(new, layout)), known)
    wet = [form.elements for form in having(new, Wet).values()]
    x[still] = undrained_excess(last, layout, np.concatenate([still[:0], *wet]))[still]
    x = placed(layout, x, new, known, phase.fixed)
    states = {
        name: form.initial_state(x[: form.size])
        if name in new
        else _inherited(form, phase.before[name], last, name)
        for name, form in phase.forms.items()
    }
    for name, form in having(new, Touching).items():
        gone = {k: f for k, f in phase.before.items() if k not in phase.forms and form.replaces(f)}
        operator = form.tractions_at(x[: form.size], states[name]) if gone else None
        if operator is not None:
            force = internal_force(gone, last.x, last.states)
            states[name] = prestressed({name: operator}, force[: form.size])[name]
    lost = last.load - internal_force(phase.forms, x, states)
    lost[phase.fixed] = 0.0
    x[phase.opened], x[np.intersect1d(still, phase.fixed)] = 0.0, 0.0
    return x, states, lost


def _inherited(form: Form, before: Form, last: StageResult, name: str) -> Any:
    """Return the state that a form continues from the end of the last stage."""
    old, state = last.forms.get(name, before), last.states[name]
    if form is old or not isinstance(form, Staged):
        return state
    return form.inherits(old, state)


def state_changes(phase: Phase, last: StageResult) -> bool:
    """Return True if any form changes the inherited state, or a drain opens."""
    return len(phase.opened) > 0 or any(
        name in phase.forms and _inherited(form, form, last, name) is not last.states[name]
        for name, form in phase.before.items()
    )


def placed(
    layout: Layout, x: ndarray, new: Mapping[str, Form], known: ndarray, fixed: ndarray
) -> ndarray:
    """Return displacements with the nodes of new solids moved along by those that they share with
    old ones.

    They move as if the new solids were an elastic attachment of the old ones, whose dofs are
    `known`; bodies that share no node stay.
    """
    solids = solids_of(new)
    own = np.setdiff1d(dofs_of(solids, layout), np.union1d(known, fixed))
    if len(own) == 0 or not x.any():
        return x
    first, *others = (form.elastic_stiffness for form in solids.values())
    K = sum(others, start=first)
    K = padded(csr_matrix(K + _LOOSE * diags_array(K.diagonal())), len(x))
    start = x.copy()
    start[own] = 0.0
    moved = as_solver(None, layout.coordinates, own).factor(K)(-(K @ start))
    result = x.copy()
    result[own] = moved[own]
    return result


def check_start(forms: Mapping[str, Form], start: StageResult) -> None:
    """Refuse a start of another mesh, or whose contact pairs have another penalty."""
    for name, form in having(forms, Touching).items():
        try:
            form.check_start(start.x[: form.size], start.states[name])
        except ValueError as error:
            raise ValueError(f"'{name}' cannot continue the start: {error}") from None
