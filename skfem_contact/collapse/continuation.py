"""Indirect continuation: the work of the load is prescribed, and the load or the strength follows.

Near collapse the displacements grow without bound while the parameter of the problem (strength
reduction factor, load multiplier) hardly changes. Beyond collapse no equilibrium exists. The work
of a reference load grows steadily all the time. So the work is prescribed, the parameter is sought
together with the displacements, and the curve of the parameter over the work levels off at the
limit.

S. Sysala, E. Hrubesova, Z. Michalec, F. Tschuchnigg, Int. J. Numer. Anal. Methods Geomech. 45
(2021) 2388-2414.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from numpy import ndarray

from ..checks import look_up, trusted_calls
from ..errors import NotConverged, warn
from ..forms.base import Form, Forms, States
from ..forms.roles import Reducible, changed
from ..materials.base import Flow
from ..nonlinear.newton import FAR, Evaluation, Newton, Problem, Search, iterate
from ..nonlinear.system import System
from ..results.result import Result
from ..results.stage import StageResult, undeformed
from ..stages.setup import Setup
from .mechanism import as_collapse, is_singular
from .pressures import warn_of_fresh_pressures, without_drainage
from .result import (
    CollapseResult,
    PeakPassed,
    Point,
    SearchLog,
    SearchResult,
    Stop,
    kind_of,
    no_collapse_below,
)

#: Growth of the steps.
GROWTH = 2.0
#: Growth once a step has failed; ACADS 1(c) with psi = 0 takes 154 iterations with 2, 152 with 1.5
#: and 123 with 1.3.
_CAUTIOUS = 1.3
#: Step lengths in a row that may fail before the curve ends: no equilibrium is found, or one below
#: the last.
_CUTS = {"stall": 6, "peak": 1}
#: Iterations of failed steps after which the curve ends, too, and least count of one: 30 halved
#: steps are round-off.
_MOST_FAILED = 150
_LEAST_FAILED = 5
_MOST_STEPS = 100
#: Iterations of a step with contact: a pit beside a wall takes 210, 470, 211 and 176 with 30 of
#: them, and 190, 226, 147 and 172 with 15, for the same factors. Without contact steps that take
#: more are of use where psi < phi.
_WITH_CONTACT = 15
#: Share of the work at which the curve's last part begins.
_CHORD = 0.7
#: Lengths of the last step at which a flat piece of a curve without yielding soil is looked at
#: again, and the share of its rise that shows a straight one: a block on five bars of which two
#: flow rises by .05 % over twice the work, and by 1.2 % until the next one flows, another one by
#: 1.3 % over 340 lengths.
_BEYOND = (512.0, 128.0, 32.0, 8.0, 2.0)
_STRAIGHT = 0.5
#: Attributes of a stage that a search does not change.
_KEPT = (
    "time",
    "water",
    "unreleased",
    "placed",
    "changed",
    "supports",
    "supports_given",
)


class Branch(ABC):
    """Problem that depends on one parameter."""

    #: Lower limit of the parameter, excluded.
    lowest: float
    #: Forms as they are given.
    system: System
    #: Line search: along the energy where the forms do not depend on the parameter. Where they do,
    #: the step is not exceeded; by the norm of the residual, to which single points that yield and
    #: unload add much, more searches fail. Where contact depends on it the work or the norm counts.
    search: Search
    #: Contact depends on the parameter.
    with_contact: bool = False

    @abstractmethod
    def at(self, parameter: float) -> tuple[System, ndarray]:
        """Return forms and load at a value of the parameter."""

    @abstractmethod
    def slope(self, now: Evaluation, states: States) -> ndarray:
        """Return the derivative of the residual by the parameter, from accepted states."""

    def resist(self) -> bool:
        """Let friction resist further slip in damped tangents; return True if any form does."""
        before = self.system
        resisting = changed(before.forms, Reducible, lambda form: form.with_resistance())
        self.system = before.with_forms(resisting)
        return self.system is not before


def last_stage(start: Result | StageResult | None) -> StageResult | None:
    """Return the stage that a search starts from: the last one of a result.

    Raises
    ------
    ValueError
        The stage moves: inertia balances a part of its load.
    """
    last = start[-1] if isinstance(start, Result) else start
    if last is not None and last.inertial is not None:
        raise ValueError(
            f"the stage '{last.name}' moves, and a search starts from rest: add a Stage without "
            "`dynamic`, in which the ground comes to rest"
        )
    return last


@dataclass(frozen=True)
class SearchStart:
    """Start of a search.

    Attributes
    ----------
    forms
        Active forms.
    system, origin
        Their system, in the geometry of the start, and the start itself.
    weight, load
        Weights and load on top, (N,); by default the load of the start.
    kept
        Attributes of the stage at the start that the end of the search keeps.
    at_rest
        Function that returns the pressure of the water at rest and its load, (N,), or None.
    begins
        The stage of the start, or unstrained bodies without load.
    """

    forms: dict[str, Form]
    system: System
    origin: Point
    weight: ndarray
    load: ndarray
    kept: Mapping[str, Any]
    at_rest: Callable[[], tuple[Any, ndarray] | None]
    begins: StageResult

    def ended(self, result: CollapseResult, water: Any = None) -> CollapseResult:
        """Return a result whose end keeps water, supports and changes of the start."""
        kept = dict(self.kept)
        if water is not None:
            kept["water"] = water
        return replace(result, end=replace(result.end, **kept))


def loaded_start(
    setup: Setup,
    load: Any,
    start: Result | StageResult | None,
    water: Any,
    undrained: bool = False,
    flow: Flow = "given",
) -> SearchStart:
    """Return the start of a search with its load on top of weights and water.

    By default the load is the load of the start. Inactive bodies do not move. Geometry that follows
    the displacements is held as it is at the start: a limit belongs to one geometry, whatever the
    stiffness. Pore pressures stay; in ground that cannot drain they follow.
    """
    setup.refuse_finite(
        "a search for collapse is of small kinematics: a changing shape never yields"
    )
    last = last_stage(start)
    setup = setup.after(last)
    _warn_of_unreleased(last)

    # number the active forms and hold the dofs of the others
    active = _active_forms(setup, last)
    fixed = np.union1d(setup.fixed, setup.inactive(active))
    if undrained:
        active, fixed = without_drainage(active, fixed, flow)
    system = setup.checked_system(active, fixed)
    if last is None:  # otherwise the stages have reported their forms
        for remark in setup.remarks_on(active, setup.fixed, setup.inactive(active)):
            warn(remark.text)
    system, origin = _fixed_geometry(system, last)

    # put the load on top of the weights
    if water is None and last is not None:
        water = last.water
    weight = setup.weights(active)
    on_top = _load_on_top(setup, load, last, water, active)
    if not (weight + on_top).any():
        raise ValueError(
            "there is no load, or it is zero: give a `load`, unit weights of the forms, or a "
            "loaded `start`"
        )
    if last is not None and not undrained:
        warn_of_fresh_pressures(system, origin.x, origin.states, weight + on_top)

    # keep the settings of the start for the end of the search
    kept: dict[str, Any] = {"water_unit_weight": setup.water_unit_weight}
    if last is not None:
        kept.update((name, getattr(last, name)) for name in _KEPT)
    return SearchStart(
        forms=dict(active),
        system=system,
        origin=origin,
        weight=weight,
        load=on_top,
        kept=kept,
        at_rest=partial(setup.at_rest, active, water),
        begins=last or undeformed("start", active, system.size),
    )


def _warn_of_unreleased(last: StageResult | None) -> None:
    """Raise a warning where a stage holds back forces of deactivated bodies."""
    if last is None or last.unreleased is None:
        return
    share = np.linalg.norm(last.unreleased) / np.linalg.norm(last.load)
    warn(
        f"the start holds back {share:.0%} of its load, forces of what is deactivated: the search "
        "counts them as resistance; release the rest in a stage before"
    )


def _active_forms(setup: Setup, last: StageResult | None) -> Forms:
    """Return the forms that are active in a stage, or all without one."""
    if last is None:
        return setup.forms
    active = {}
    for name in last.states:
        active[name] = look_up(name, setup.forms, "form, though the start holds it,")
    if len(last.x) < setup.layout.size:
        unknown = []
        for name, form in setup.forms.items():
            if form.fields and name not in active:
                unknown.append(name)
        raise ValueError(f"the start does not hold {unknown}: activate them in a stage")
    return active


def _fixed_geometry(system: System, last: StageResult | None) -> tuple[System, Point]:
    """Return forms in the geometry at the end of a stage, with its displacements and states."""
    x = np.zeros(system.size) if last is None else last.x
    forms = dict(system.forms)
    states = {}
    for name, form in system.forms.items():
        states[name] = form.initial_state() if last is None else last.states[name]
        if isinstance(form, Reducible):
            forms[name], states[name] = form.fixed_geometry(x, states[name])
    return system.with_forms(forms), Point(x, states, 0.0)


def _load_on_top(
    setup: Setup,
    load: Any,
    last: StageResult | None,
    water: Any,
    active: Forms,
) -> ndarray:
    """Return the load of a search without the weights of the active forms, (N,)."""
    if last is None or load is not None:
        return setup.load(load) + setup.water_on(active, water)
    on_top = setup.vector(last.load, "the load of the start") - setup.weights(active)
    if water is not last.water:
        on_top += setup.water_on(active, water) - setup.water_on(active, last.water)
    return on_top


def remainder(points: Sequence[Point]) -> float:
    """Estimate how far the parameter may still rise, by the slope of the curve's last part.

    The part begins where at most :data:`_CHORD` of the present work had been done: the slope of
    shorter parts may be the solver's tolerance.
    """
    start = first = points[0]
    last = points[-1]
    done = last.work - first.work
    if len(points) < 3 or not done > 0.0:
        return np.inf
    for point in points[:-1]:
        if point.work - first.work <= _CHORD * done:
            start = point
    return (last.parameter - start.parameter) / (last.work - start.work) * done


def motion(last: Point, failed: NotConverged | None) -> ndarray:
    """Return displacements from the last equilibrium to the point where the next step failed."""
    if failed is None or failed.x is None:
        return np.zeros_like(last.x)
    return failed.x - last.x


@dataclass(frozen=True)
class Course:
    """Steps and end of a curve.

    Attributes
    ----------
    tolerance, relative
        The curve ends when its last slope lets the parameter rise by no more than the tolerance, a
        share of the parameter if `relative`.
    min_displacement
        Largest displacement without which the curve does not end.
    max_value
        The curve ends when the parameter exceeds this value.
    growth, max_step
        Ratio of a step to the one before, and work of the longest step; after a failed step the
        steps grow less.
    """

    tolerance: float
    relative: bool = False
    max_value: float = np.inf
    growth: float = GROWTH
    max_step: float = np.inf
    min_displacement: float = 0.0

    def margin(self, parameter: float) -> float:
        """Return the tolerance at a value of the parameter."""
        if self.relative:
            return self.tolerance * abs(parameter)
        return self.tolerance


def follow(
    branch: Branch,
    control: ndarray,
    points: list[Point],
    newton: Newton,
    course: Course,
    log: SearchLog,
) -> SearchResult:
    """Follow the curve until it has levelled off; where it stalls, again with resistance to slip.

    With resistance from the start blocks that slide away end in a plateau, up to .3 % too high.
    """
    if branch.with_contact:
        newton = replace(newton, max_iterations=min(newton.max_iterations, _WITH_CONTACT))
    result = _follow(branch, control, points, newton, course, log)
    if result.stop.kind == "stall" and branch.resist():
        again = _follow(branch, control, points, newton, course, log)
        if again.stop.shows_limit:
            return again
    return result


def _follow(
    branch: Branch,
    control: ndarray,
    points: list[Point],
    newton: Newton,
    course: Course,
    log: SearchLog,
) -> SearchResult:
    """Follow the curve once, by the work of the load `control`, from two points on it."""
    points = list(points)
    length = min(points[-1].work - points[-2].work, course.max_step)
    growth = course.growth
    failures = Counter[str]()  # failed steps in a row, by kind
    spent = 0  # iterations of failed steps
    while len(points) < _MOST_STEPS:
        before, last = points[-2:]
        margin = course.margin(last.parameter)
        rise = length * (last.parameter - before.parameter) / (last.work - before.work)
        try:
            point = _next(branch, control, points, length, newton, course)
        except NotConverged as error:
            # look for a collapse where the step could show it, or too many have failed
            failure = error
            stalls = failures[kind_of(error)] >= _CUTS.get(kind_of(error), _MOST_FAILED)
            spent += max(len(error.residuals) - 1, _LEAST_FAILED)
            if rise < margin or stalls or spent > _MOST_FAILED:
                reached = last.parameter + max(rise, margin)
                failure = _as_collapse(branch, last, reached, error, newton)

            # end at a collapse, or after too many failures; otherwise halve the step
            log.reject(last.parameter, failure, last.work + length)
            kind = kind_of(failure)
            if kind == "collapse" and rise < margin:
                stop = Stop("collapse", str(failure))
                return SearchResult(points, stop, last.parameter + margin, motion(last, failure))
            failures[kind] += 1
            if kind != "collapse" and (failures[kind] > _CUTS[kind] or spent > _MOST_FAILED):
                return SearchResult(points, Stop(kind, str(failure)))
            length *= 0.5
            growth = min(growth, _CAUTIOUS)
            continue

        # end on a plateau or beyond the largest value; otherwise lengthen the step
        points.append(point)
        log.accept(point)
        if _is_level(branch, control, points, newton, course, log):
            return _plateau(points, margin)
        if point.parameter > course.max_value:
            return SearchResult(points, no_collapse_below(course.max_value))
        if not failures:
            length = min(growth * length, course.max_step)
        failures.clear()
    return SearchResult(points, Stop("steps", f"{_MOST_STEPS} of them without a plateau"))


def _next(
    branch: Branch,
    control: ndarray,
    points: list[Point],
    length: float,
    newton: Newton,
    course: Course,
) -> Point:
    """Return the next point of the curve, which must not fall where the end may be its peak."""
    last = points[-1]
    point = correct(branch, control, points, last.work + length, newton)
    lowest = last.parameter - course.margin(last.parameter)
    if course.min_displacement == 0.0 and point.parameter < lowest:
        raise PeakPassed("the curve falls", point.x, point.residuals)
    return point


def _plateau(points: list[Point], margin: float) -> SearchResult:
    """Return the end of a curve that may rise by less than a margin."""
    rise = max(remainder(points), 0.0)
    stop = Stop("plateau", f"the curve may rise by {rise:.2g} more")
    best = max(point.parameter for point in points)
    return SearchResult(points, stop, best + (rise or margin))


def _as_collapse(
    branch: Branch,
    last: Point,
    parameter: float,
    error: NotConverged,
    newton: Newton,
) -> NotConverged:
    """Return a collapse for a singular tangent if nothing resists at a parameter, or the error."""
    if not is_singular(error):
        return error
    system, load = branch.at(parameter)
    return as_collapse(error, system, last.x, last.states, load, newton)


def _is_level(
    branch: Branch,
    control: ndarray,
    points: list[Point],
    newton: Newton,
    course: Course,
    log: SearchLog,
) -> bool:
    """Return True if a curve may rise by less than its margin, also beyond a straight end."""
    before, last = points[-2:]
    margin = course.margin(before.parameter)
    if log.moved(last.x) < course.min_displacement or not remainder(points) < margin:
        return False
    length = last.work - before.work
    rise = last.parameter - before.parameter
    if not log.straight or not _BEYOND[0] * rise > margin:
        return True

    # continue the straight piece as far as an equilibrium exists
    for times in _BEYOND:
        try:
            far = correct(branch, control, points, last.work + times * length, newton)
        except NotConverged:
            continue
        return not far.parameter - last.parameter > _STRAIGHT * times * rise
    return True


def correct(
    branch: Branch,
    control: ndarray,
    points: list[Point],
    work: float,
    newton: Newton,
) -> Point:
    """Return the equilibrium at which the reference load has done some work.

    The vector z holds the displacements and the parameter. The work of the load is linear in the
    displacements, so that each Newton step satisfies it.
    """
    # extrapolate from the last two points; the curve bends, so the parameter goes half as far
    before, last = points[-2:]
    share = (work - last.work) / (last.work - before.work)
    x = last.x + share * (last.x - before.x)
    guess = np.append(x, last.parameter + 0.5 * (last.parameter - before.parameter))
    curve = _Curve(branch, control, last, points[0], work)
    try:
        with trusted_calls():
            now, norms = iterate(
                curve.evaluate(guess), curve, newton, branch.search, at_least=1, damp=True
            )
    except NotConverged as error:
        if error.x is not None:
            error.x = error.x[: len(control)]
        raise
    return Point(now.z[:-1], now.states, float(now.z[-1]), work, norms)


class _Curve(Problem):
    """Equilibria of displacements and parameter at which the reference load has done some work."""

    def __init__(
        self,
        branch: Branch,
        control: ndarray,
        last: Point,
        first: Point,
        work: float,
    ) -> None:
        self._branch = branch
        self._control = control
        self._last = last
        self._system = branch.at(last.parameter)[0]
        self._target = self._system.work(control, first.x) + work

    def evaluate(self, z: ndarray) -> Evaluation:
        if not z[-1] > self._branch.lowest:
            return Evaluation(z, {}, np.zeros_like(self._control), np.inf)
        system, load = self._branch.at(float(z[-1]))
        return replace(system.evaluate(z[:-1], self._last.states, load), z=z)

    def direction(self, now: Evaluation, damped: bool) -> ndarray:
        """Solve for the Newton step of residual and work, by two solutions with one factor.

        It does no work where the work is the prescribed one. A step far beyond the displacements
        since the last point follows a mechanism, on which line searches creep: tests reach
        equilibrium with steps of up to 8 times these displacements, and none with 800 times.
        """
        system = self._system
        solve = system.factor(system.tangent(now, damped))
        balance = solve(now.residual)
        drift = solve(self._branch.slope(now, self._last.states))
        lag = self._target - system.work(self._control, now.z[:-1] + balance)
        slope = system.work(self._control, drift)
        if slope == 0.0:
            raise NotConverged("no equilibrium: the forces do not depend on the parameter any more")
        change = lag / slope
        step = balance + change * drift
        moves = system.layout.displacements
        moved = (now.z[:-1] - self._last.x)[moves]
        times = np.linalg.norm(step[moves]) / np.linalg.norm(moved)
        if times > FAR:
            raise NotConverged(
                f"no equilibrium: the tangent leads {times:.0f} times as far as the step"
            )
        return np.append(step, change)
