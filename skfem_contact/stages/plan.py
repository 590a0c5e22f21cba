"""Plan of an analysis: active forms, supports and loads of every stage, checked before the run."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy import ndarray

from ..arrays import max_abs
from ..checks import look_up, names_of, trusted_calls
from ..contact.base import ContactBase
from ..errors import Remark
from ..forms.base import Form, Forms, solids_of
from ..forms.roles import Couples, Wet, having, joined_by
from ..layout import elements_in, nodes
from ..results.fields import undrained_elements
from ..results.stage import StageResult
from .in_time import InTime, inertia_of, remarks_on_base
from .setup import Setup, let_go
from .stage import Stage
from .supports import check_supports, remarks_on_turns

#: Share of the nodes of a solid from which a load is its weight: a traction acts on half of them at
#: most.
_WEIGHTY = 0.6
#: Share of the load above which a load that is given as a function begins with a jump.
_JUMP = 1e-9
#: Loads on inactive dofs below this share of the largest one are round-off of their integration.
_NO_LOAD = 1e-12


@dataclass(frozen=True)
class Phase:
    """Active forms, supports and loads of a stage.

    Attributes
    ----------
    before, forms
        Forms that are active before the stage, as they are then, and in the stage.
    fixed
        Dofs that are supported, and inactive ones.
    load, prescribed
        Load at the end and prescribed displacements of all dofs, (N,).
    changed
        True if the stage begins with other forms or supports than the stage before ended with.
    gone
        Weight and water load of deactivated bodies at the dofs that stay, where the stage releases
        a part of them, (N,).
    on_top
        Load as a function of the share of the stage, where it is given as one.
    jump
        Difference between this load at share 0 and the load before, (N,), or None.
    remarks
        Remarks on input that changes nothing in the stage, and was probably meant to.
    water
        Water at rest of the stage or of an earlier one.
    replaced, supports
        Forms that stages have changed so far, and the supported dofs.
    supports_given
        True if a stage has given the supports in place of the model.
    opened
        Pressures that are held from the stage on, and not prescribed.
    in_time
        Inertia of the stage; `on_top` and `prescribed` then are functions of the time.
    """

    before: dict[str, Form]
    forms: dict[str, Form]
    fixed: ndarray
    load: ndarray
    prescribed: ndarray | Callable[[float], ndarray] | None
    changed: bool
    gone: ndarray
    on_top: Callable[[float], ndarray] | None = None
    jump: ndarray | None = None
    remarks: tuple[Remark, ...] = ()
    water: Any = None
    replaced: Forms = field(default_factory=dict)
    supports: ndarray | None = None
    supports_given: bool = False
    opened: ndarray = field(default_factory=lambda: np.zeros(0, int))
    in_time: InTime | None = None


def plan(setup: Setup, stages: Sequence[Stage], start: StageResult | None) -> list[Phase]:
    """Return the phases of all stages; everything is checked before anything is computed."""
    planner = Planner(setup, stages, start)
    return [planner.phase(stage) for stage in stages]


class Planner:
    """Forms, supports, water and loads, followed from stage to stage."""

    def __init__(self, setup: Setup, stages: Sequence[Stage], start: StageResult | None) -> None:
        self._setup = setup
        self._start = start
        self._known = dict(setup.forms)  # all forms, as stages have changed them so far
        self._names = _active_at_first(self._known, stages, start)
        self._active = self._select()
        self._supports = setup.fixed
        self._supports_given = False
        if start is not None:
            self._supports_given = start.supports_given and setup.fixed is start.supports
        self._inactive = np.zeros(0, int)
        self._water = None if start is None else start.water
        self._rest = np.zeros(setup.layout.size)  # weights and water load
        self._on_top = np.zeros(setup.layout.size)
        self._last_load: ndarray | None = None  # of the last stage that was planned
        self._unreleased = False
        self._moves = False  # without supports, as inertia allows
        self._pushes = False  # a stage has moved supports
        self._time = 0.0  # since the last change of the load
        if start is not None:
            self._unreleased = start.unreleased is not None

    @property
    def _first(self) -> bool:
        return self._last_load is None

    def phase(self, stage: Stage) -> Phase:
        """Return the phase of the next stage.

        Raises
        ------
        ValueError
            Names, supports, loads or water of the stage do not fit; the message names the stage.
        """
        # Change forms and supports.
        before = self._active
        on_top_before = self._on_top_before(stage)
        self._on_top = on_top_before
        known_supports = self._known_supports()
        moved = self._moves
        changes = _changes_forms(stage) or stage.fixed is not None
        same_supports = self._change(stage, changes)
        fixed = np.union1d(self._supports, self._inactive)
        remains = (changes or self._unreleased) and stage.released < 1.0
        gone = np.zeros(self._setup.layout.size)
        if remains and stage.deactivate:
            gone = self._gone(stage, before, fixed)

        # Add up weights, water and the load on top of them
        self._set_water(stage, changes)
        in_time = inertia_of(self._setup, stage, self._active, fixed)
        load, on_top = self._loads(stage)
        jump = self._jump(stage, on_top, on_top_before)
        prescribed = self._prescribed(stage)

        # Compare with the stage before
        same_load = prescribed is None and self._same_as_before(load)
        waits = same_load and on_top is None and not (changes or self._unreleased)
        if waits:
            self._time = self._time + stage.duration
        else:
            self._time = stage.duration
        remarks = (
            *_of_idle_input(stage, same_load, same_supports, self._unreleased or moved),
            *self._of_forms(stage),
            *self._of_water(stage),
            *self._of_regions(stage),
            *self._of_pressures(stage, load, prescribed),
            *self._of_free_dofs(prescribed),
            *self._of_turns(stage, prescribed),
            *_of_jump(stage, load, jump),
            *_of_removal(stage, on_top_before, load),
            *remarks_on_base(self._setup, stage),
            *self._of_weights(stage, before, load - self._rest),
        )

        self._unreleased = remains
        phase = Phase(
            before=before,
            forms=self._active,
            fixed=fixed,
            load=load,
            prescribed=prescribed,
            changed=changes and (self._start is not None or not self._first),
            gone=gone,
            on_top=on_top,
            jump=jump,
            remarks=remarks,
            water=self._water,
            replaced=self._all_replaced(),
            supports=self._supports,
            supports_given=self._supports_given,
            opened=self._opened(stage, known_supports),
            in_time=in_time,
        )
        self._on_top = load - self._rest
        self._last_load = load
        return phase

    def _set_water(self, stage: Stage, changes: bool) -> None:
        """Take over the water of a stage, and the load at rest where anything changes it."""
        if stage.water is not None:
            self._water = own_arrays(stage.water)
        if changes or self._first or stage.water is not None:
            self._rest = self._at_rest(self._active, self._water)

    def _gone(self, stage: Stage, before: Forms, fixed: ndarray) -> ndarray:
        """Return the weights of bodies that go, and their load of the water before the stage."""
        water = self._water_before(stage)
        gone = self._at_rest(before, water) - self._at_rest(self._active, water)
        gone[fixed] = 0.0
        return gone

    def _water_before(self, stage: Stage) -> Any:
        """Return the water before a stage; where a file only names it, the stage gives it again."""
        if isinstance(self._water, str):
            return stage.water
        return self._water

    def _same_as_before(self, load: ndarray) -> bool:
        """Return True if a load is the load of the stage before."""
        return self._last_load is not None and np.array_equal(load, self._last_load)

    def _all_replaced(self) -> dict[str, Form]:
        """Return the forms that stages have changed so far."""
        own = self._setup.own
        return {name: form for name, form in self._known.items() if form is not own[name]}

    def _select(self) -> dict[str, Form]:
        """Return the active forms in the order of the model."""
        return {name: form for name, form in self._known.items() if name in self._names}

    def _change(self, stage: Stage, changes: bool) -> bool:
        """Change forms and supports, and return True if the supports stay.

        Bodies must be active and held.
        """
        # Change the supports, then the forms, and check what is left.
        old = self._supports
        try:
            if stage.fixed is not None:
                # Supports first: forms are checked against them.
                self._supports = self._setup.layout.dofs(stage.fixed)
                self._supports_given = True
            if changes or self._first or self._moves:
                self._names = _active_after(stage, self._known, self._names)
                self._known.update(self._replaced(stage))
                self._active = self._select()
                self._inactive = self._setup.inactive(self._active)
                gone = self._setup.gone(self._active)
                self._active = let_go(self._active, self._inactive, gone)
                self._known.update(self._active)
                check_contacts(self._active, self._inactive, gone)
                if stage.dynamic is None:
                    check_supports(self._active, np.union1d(self._supports, self._inactive))
            self._moves = stage.dynamic is not None
        except ValueError as error:
            raise (ValueError(f"stage '{stage.name}': {error}") if changes else error) from None
        return stage.fixed is None or np.array_equal(old, self._supports)

    def _replaced(self, stage: Stage) -> dict[str, Form]:
        """Return the new forms of a stage, which continue the states of the present ones."""
        found = {}
        for name, new in stage.change.items():
            try:
                found.update(self._setup.adopted({name: new}, self._known))
            except ValueError as error:
                raise ValueError(
                    f"'{name}' can only be changed to another material or law of the same elements "
                    f"or surfaces ({error}); deactivate it and activate another form instead"
                ) from None
        return found

    def _known_supports(self) -> ndarray:
        """Return the supported dofs before a stage; older files have none."""
        known: ndarray | None = self._supports
        if self._first and self._start is not None:
            known = self._start.supports
        if known is None:
            return self._setup.fixed
        return known

    def _opened(self, stage: Stage, before: ndarray) -> ndarray:
        """Return pressures that a stage holds in addition, unless it prescribes them."""
        if stage.prescribed is not None:
            return np.zeros(0, int)
        new = np.setdiff1d(self._supports, before)
        return np.intersect1d(self._setup.layout.pressures, new)

    def _at_rest(self, forms: Forms, water: Any) -> ndarray:
        """Return the weights of some forms and the load of water on them, (N,)."""
        wet = self._setup.water_on(forms, water)
        wet[self._inactive] = 0.0
        return self._setup.weights(forms) + wet

    def _loads(self, stage: Stage) -> tuple[ndarray, Callable[[float], ndarray] | None]:
        """Return the load at the end of a stage, and as a function where it is given as one."""
        # A load is checked against the bodies that are active.
        what = f"stage '{stage.name}': the load"
        setup = self._setup
        rest = self._rest
        inactive = self._inactive
        absent = [name for name in self._known if name not in self._names]

        def whole(given: Any) -> ndarray:
            load = setup.load(given, what)
            if acts_on(load, inactive):
                raise ValueError(
                    f"stage '{stage.name}': a part of the load acts on inactive bodies; {absent} "
                    "are not active"
                )
            return load + rest

        # A load that is constant needs no function, but in time.
        function = stage.load
        if not callable(function):
            constant = whole(function)
            return constant, None if stage.dynamic is None else lambda time: constant

        # A function is checked at every call.
        def at(share: float) -> ndarray:
            given = function(share)
            if given is None:
                raise ValueError(
                    f"stage '{stage.name}': the load function returns None at {share:.3g}: return "
                    "the load vector, (N,)"
                )
            with trusted_calls():
                return whole(given)

        return at(_end_of(stage)), at

    def _on_top_before(self, stage: Stage) -> ndarray:
        """Return the load on top of weights and water before a stage."""
        start = self._start
        if start is None or not self._first:
            return self._on_top
        setup = self._setup
        load = setup.vector(start.load, "start")
        if start.unreleased is not None:
            load = load + setup.vector(start.unreleased, "start")
        return load - self._at_rest(self._active, self._water_before(stage))

    def _jump(
        self,
        stage: Stage,
        on_top: Callable[[float], ndarray] | None,
        on_top_before: ndarray,
    ) -> ndarray | None:
        """Return the difference between the first load of a function and the load before."""
        if on_top is None or stage.dynamic is not None:
            return None
        first = on_top(0.0)
        jump = first - self._rest - on_top_before
        jump[self._inactive] = 0.0
        largest = max_abs([first, on_top_before])
        if max_abs(jump) > _JUMP * largest:
            return jump
        return None

    def _prescribed(self, stage: Stage) -> ndarray | Callable[[float], ndarray] | None:
        """Return the prescribed displacements of all dofs, (N,), as a function or None."""
        given = stage.prescribed
        what = f"stage '{stage.name}': the prescribed displacement"
        if given is None:
            return None
        if not callable(given):
            return self._setup.vector(given, what)
        self._setup.vector(given(0.0), what)
        return lambda time: self._setup.vector(given(time), what)

    def _of_forms(self, stage: Stage) -> list[Remark]:
        """Return remarks of the forms on the stage."""
        duration = 0.0
        if stage.duration:
            duration = self._time
        moving = stage.dynamic is not None
        try:
            return [
                *self._setup.remarks_on(
                    self._active,
                    self._supports,
                    inactive=self._inactive,
                    duration=duration,
                    moving=moving,
                )
            ]
        except ValueError as error:
            raise ValueError(f"stage '{stage.name}': {error}") from None

    def _of_water(self, stage: Stage) -> Iterator[Remark]:
        """Refuse water that counts twice; report ground that drains at once, and lost suction."""
        waters = having(self._setup.forms, Wet)
        active = having(self._active, Wet)
        if not waters:
            return
        if stage.duration and not active:
            yield from self._of_drained(waters)

        # Refuse elements whose water would count twice
        undrained = undrained_elements(self._active)
        twice = sum(int(np.isin(undrained, water.elements).sum()) for water in active.values())
        if twice:
            raise ValueError(
                f"stage '{stage.name}': {twice} elements are Undrained and have PoreWater too: "
                "their water would count twice; give the soil alone, or deactivate the water"
            )

        # Report suction that a level takes away
        if isinstance(self._water, bool) or not isinstance(self._water, float | int):
            return
        for name, water in active.items():
            if water.suction > 0.0:
                yield Remark(
                    "suction",
                    water.suction,
                    f"a level has none of the suction, up to {water.suction:.3g}, with which "
                    f"'{name}' begins: give water=model.forms['{name}'].initial",
                )

    def _of_regions(self, stage: Stage) -> Iterator[Remark]:
        """Report levels of regions that are not active, and count nowhere."""
        if not isinstance(stage.water, Mapping):
            return
        solids = solids_of(self._active)
        ground = elements_in(solids.values())
        subdomains = next(iter(solids.values())).basis.mesh.subdomains
        absent = [name for name in stage.water if not np.isin(subdomains[name], ground).any()]
        if absent:
            yield Remark(
                "levels",
                len(absent),
                f"the water of {absent} counts nowhere, for none of their elements is active: a "
                "pit has the water of the region at its bottom",
            )

    def _of_drained(self, waters: Mapping[str, Wet]) -> Iterator[Remark]:
        """Report ground whose pore water is not active."""
        ground = elements_in(solids_of(self._active).values())
        dry = []
        for name, water in waters.items():
            if np.isin(water.elements, ground).any():
                dry.append(name)
        if dry:
            yield Remark(
                "dry",
                len(dry),
                f"{dry} is not active in a stage with a duration: the ground drains at once; "
                "name it in `activate`",
            )

    def _of_pressures(
        self,
        stage: Stage,
        load: ndarray,
        prescribed: ndarray | Callable[[float], ndarray] | None,
    ) -> Iterator[Remark]:
        """Refuse loads on pressures; report prescribed pressures that are not held."""
        layout = self._setup.layout
        if callable(prescribed):
            prescribed = prescribed(_end_of(stage))
        if prescribed is None:
            given = np.zeros(0, int)
        else:
            given = np.flatnonzero(prescribed)
        # Prescribed values act at supports alone.
        loose = np.setdiff1d(given, self._supports)
        if len(loose) and loose[0] < layout.n_displacements:
            loose = loose[:0]  # values are given for all dofs
        for one, part in zip(layout.fields, layout.parts, strict=True):
            if one.kind != "pressure":
                continue
            loaded = int(np.count_nonzero(load[part]))
            if loaded:
                raise ValueError(
                    f"stage '{stage.name}': the load acts on the {one.name} at {loaded} dofs, "
                    "where it would be water per increment: prescribe pressures that are held"
                )
            n = int(np.count_nonzero((loose >= part.start) & (loose < part.stop)))
            if n:
                yield Remark(
                    "loose",
                    n,
                    f"the {one.name} is prescribed at {n} dofs that are not held, which does "
                    "nothing: name them in `fixed`",
                )

    def _of_free_dofs(
        self, prescribed: ndarray | Callable[[float], ndarray] | None
    ) -> Iterator[Remark]:
        """Yield a remark on displacements that are prescribed at free dofs alone."""
        if prescribed is None or callable(prescribed):
            return
        # Values of all dofs may be given: zeros and those of the start are no change.
        before = np.zeros(len(prescribed))
        if self._start is not None:
            n = min(len(before), len(self._start.x))  # another model may have had fewer dofs
            before[:n] = self._start.x[:n]
        changed = prescribed != before
        self._pushes |= bool(changed[self._supports].any())
        given = np.flatnonzero(changed & (prescribed != 0.0))
        given = np.setdiff1d(given, self._setup.layout.pressures)
        if len(given) and not self._pushes:
            yield Remark(
                "free",
                len(given),
                f"displacements are prescribed at {len(given)} dofs, none of which is held, which "
                "does nothing: name them in `fixed`",
            )

    def _of_turns(
        self, stage: Stage, prescribed: ndarray | Callable[[float], ndarray] | None
    ) -> Iterator[Remark]:
        """Yield a remark on boundaries that are turned beside solids of small rotations."""
        bodies = list(solids_of(self._active).values())
        if prescribed is None or self._setup.finite or not bodies:
            return
        if callable(prescribed):
            prescribed = prescribed(_end_of(stage))
        yield from remarks_on_turns(bodies[0].basis, self._supports, prescribed)

    def _of_weights(
        self,
        stage: Stage,
        before: Forms,
        on_top: ndarray,
    ) -> Iterator[Remark]:
        """Yield remarks on weights of solids in the load before that this load lacks."""
        if stage.load is not None and not on_top.any():
            return  # nothing at all is asked for
        gravity = self._setup.gravity
        n = self._setup.layout.n_displacements
        then = self._on_top[:n].reshape(-1, len(gravity)) @ gravity  # weight at the nodes
        now = on_top[:n].reshape(-1, len(gravity)) @ gravity
        least = _NO_LOAD * max_abs(then)
        remaining = {name: form for name, form in self._active.items() if name in before}
        for name, form in solids_of(remaining).items():
            own = np.unique(nodes(form.basis))
            loaded_before = np.abs(then[own]) > least
            unloaded_now = np.abs(now[own]) <= least
            lost = own[loaded_before & unloaded_now]
            total = float(then[lost].sum())
            weightless = form.own_weight(gravity) is None
            if weightless and len(lost) > _WEIGHTY * len(own) and total > 0.0:
                yield Remark(
                    "weight",
                    total,
                    f"it lacks the weight of '{name}', about {total:.2g}, which the load before "
                    "had: loads of stages are whole loads, not increments; add it, or give the "
                    "solid its unit_weight",
                )


def timeless(setup: Setup, stages: Sequence[Stage], last: Phase) -> Iterator[Remark]:
    """Yield a remark on solids that creep where no stage takes time.

    Initial states are without weights, and have no remark.
    """
    creeps = []
    for name, form in solids_of(last.forms).items():
        if any(material.time_dependent for material in form.materials.values()):
            creeps.append(name)
    if creeps and setup.gravity.any() and not any(stage.duration for stage in stages):
        yield Remark(
            "timeless",
            len(creeps),
            f"{creeps} would creep, but no stage takes any time, in which it is "
            "elastic: give Stage(duration=...)",
        )


def _active_at_first(forms: Forms, stages: Sequence[Stage], start: StageResult | None) -> set[str]:
    """Return the names that the start holds; without one, the names not activated later."""
    if start is not None:
        if not set(start.states) <= set(forms):
            raise ValueError(f"start holds the forms {list(start.states)}, not {list(forms)}")
        return set(start.states)
    later: set[str] = set()
    seen: set[str] = set()
    for stage in stages:
        activated = set(names_of(stage.activate))
        later |= activated - seen
        seen |= activated | set(names_of(stage.deactivate))
    return set(forms) - later


def _active_after(stage: Stage, forms: Forms, active: set[str]) -> set[str]:
    """Return the names of the active forms of a stage."""
    activated = names_of(stage.activate)
    deactivated = names_of(stage.deactivate)
    for name in (*activated, *deactivated, *stage.change):
        _check_form(name, forms)
    for name in activated:
        if name in active:
            raise ValueError(f"'{name}' is activated, but it is active already")
    for name in deactivated:
        if name not in active:
            raise ValueError(f"'{name}' is deactivated, but it is not active")
    return (active | set(activated)) - set(deactivated)


def _check_form(name: str, forms: Forms) -> None:
    """Refuse a name that is no form; a subdomain of the mesh may become one."""
    try:
        look_up(name, forms, "form")
    except ValueError as error:
        for solid in solids_of(forms).values():
            if name in (solid.basis.mesh.subdomains or {}):
                raise ValueError(
                    f"{error}; '{name}' is a subdomain of the mesh: give it a solid of its own, "
                    f"SolidForm(basis.with_elements('{name}'), ...)"
                ) from None
        raise


def _end_of(stage: Stage) -> float:
    """Return the argument of functions at the end of a stage: its share, or the time."""
    if stage.dynamic is None:
        return 1.0
    return stage.duration


def own_arrays(water: Any) -> Any:
    """Return water at rest with copies of its arrays, which the user may change later."""
    if isinstance(water, Mapping):
        return {name: own_arrays(level) for name, level in water.items()}
    if isinstance(water, (ndarray, list)):
        return deepcopy(water)
    return water


def check_contacts(forms: Forms, inactive: ndarray, gone: ndarray) -> None:
    """Refuse active forms that act on inactive dofs, or on facets of elements that are gone."""
    for name, form in forms.items():
        acted_on = None
        away = False
        if isinstance(form, Couples):
            acted_on = form.acts_on
        if isinstance(form, ContactBase):
            away = bool(np.isin(form.behind, gone).any())
        for dofs in (joined_by(form), acted_on):
            if dofs is not None:
                away |= bool(np.isin(dofs, inactive).any())
        if away:
            raise ValueError(f"'{name}' is active, but acts on an inactive body: {form!r}")


def _of_jump(stage: Stage, load: ndarray, jump: ndarray | None) -> Iterator[Remark]:
    """Yield a remark on a load that is a function and does not begin with the load before."""
    if jump is None:
        return
    size = max_abs(jump)
    largest = max(max_abs(load), size)
    yield Remark(
        "jump",
        size / largest,
        f"its load begins with a jump: function(0) differs from the load before by "
        f"{size / largest:.2g} of the largest force; the jump is applied at the start, in "
        f"{stage.increments} increments of its own",
    )


def _of_removal(stage: Stage, before: ndarray, load: ndarray) -> Iterator[Remark]:
    """Yield a remark on a stage with inertia that lacks the load before, on top of weights."""
    largest = max_abs(before)
    removes = largest > _NO_LOAD * max_abs(load)
    if stage.dynamic is not None and stage.load is None and removes:
        yield Remark(
            "removal",
            largest,
            f"it has no load, and the load before, of up to {largest:.2g}, is removed at its "
            "start: loads of stages are whole loads; give it again if it stays",
        )


def _changes_forms(stage: Stage) -> bool:
    """Return True if a stage activates, deactivates or changes forms."""
    return bool(stage.activate or stage.deactivate or stage.change)


def _of_idle_input(
    stage: Stage,
    same_load: bool,
    same_supports: bool,
    out_of_balance: bool,
) -> Iterator[Remark]:
    """Yield remarks on supports that change nothing, and on a stage that changes nothing."""
    if stage.fixed is not None and same_supports:
        yield Remark(
            "supports",
            0.0,
            "`fixed` holds what is supported already: leave it out, or a boundary is empty",
        )
    changes = _changes_forms(stage) or stage.duration or out_of_balance
    if same_load and same_supports and not changes:
        yield Remark(
            "nothing",
            0.0,
            "it changes nothing: its load and its supports are those of the stage before",
        )


def acts_on(load: ndarray, dofs: ndarray) -> bool:
    """Return True if a load is more than round-off at some dofs."""
    return max_abs(load[dofs]) > _NO_LOAD * max_abs(load)
