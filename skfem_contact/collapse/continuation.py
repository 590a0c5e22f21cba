"""Indirect continuation: the work of the load is prescribed, and the load or the strength follows.

Near collapse the displacements grow without bound while the parameter of the problem (strength
reduction factor, load multiplier) hardly changes, and beyond collapse there is no equilibrium. The
work of a reference load grows steadily all the time. So the work is prescribed, the parameter is
sought together with the displacements, and the curve of the parameter over the work levels off at
the limit.

S. Sysala, E. Hrubesova, Z. Michalec, F. Tschuchnigg, Int. J. Numer. Anal. Methods Geomech. 45
(2021) 2388-2414.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from numpy import ndarray

from ..checks import look_up
from ..errors import NoEquilibrium, NotConverged, warn
from ..forms.base import Form
from ..materials.base import Flow
from ..nonlinear.newton import Evaluation, Newton, Search, iterate
from ..nonlinear.system import System
from ..results.result import Result
from ..results.stage import StageResult
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
_MOST_FAILED, _LEAST_FAILED = 150, 5
_MOST_STEPS = 100
#: Iterations of a step beside contact: a pit beside a wall takes 210, 470, 211 and 176 with 30 of
#: them, and 190, 226, 147 and 172 with 15, for the same factors. Without contact steps that take
#: more are of use where psi < phi.
_BESIDE_CONTACT = 15
#: Share of the work at which the curve's last part begins.
_CHORD = 0.7
#: Lengths of the last step at which a flat piece of a curve without yielding soil is looked at
#: again, and the share of its rise that shows a straight one: a block on five bars of which two
#: flow rises by .05 % over twice the work, and by 1.2 % until the next one flows, another one by
#: 1.3 % over 340 lengths.
_BEYOND, _STRAIGHT = (512.0, 128.0, 32.0, 8.0, 2.0), 0.5
#: What a search leaves as it is at its start.
_KEPT = ("time", "water", "unreleased", "placed", "changed", "supports")


class Branch(ABC):
    """Problem that depends on one parameter."""

    #: Lower limit of the parameter, excluded.
    lowest: float
    #: Forms as they are given.
    system: System
    #: Line search: along the energy where the forms do not depend on the parameter. Where they do,
    #: the step is not exceeded; by the norm of the residual, to which single points that yield and
    #: unload add much, more searches fail. Beside contact that depends on it the work or the norm
    #: counts.
    search: Search
    #: Contact depends on the parameter.
    beside_contact: bool = False

    @abstractmethod
    def at(self, parameter: float) -> tuple[System, ndarray]:
        """Return forms and load at a value of the parameter."""

    @abstractmethod
    def slope(self, now: Evaluation, states: Mapping[str, Any]) -> ndarray:
        """Return the derivative of the residual by the parameter, at an evaluation from accepted
        states.
        """

    def resist(self) -> bool:
        """Let friction resist further slip in damped tangents from now on; return whether any
        does.
        """
        before = self.system
        self.system = before.with_forms(
            {name: form.with_resistance() for name, form in before.forms.items()}
        )
        return self.system is not before


def last_stage(start: Result | StageResult | None) -> StageResult | None:
    """Return the stage that a search starts from: the last one of a result."""
    return start[-1] if isinstance(start, Result) else start


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
        Weights and load on top, (N,); without a load of its own, that of the start.
    kept
        What the end of the search has of the start.
    at_rest
        Function that returns the pressure of the water at rest and its load, (N,), or None.
    """

    forms: dict[str, Form]
    system: System
    origin: Point
    weight: ndarray
    load: ndarray
    kept: Mapping[str, Any]
    at_rest: Callable[[], tuple[Any, ndarray] | None]

    def ended(self, result: CollapseResult, water: Any = None) -> CollapseResult:
        """Return a result from whose end stages continue as from the start: with its water,
        supports and changes.
        """
        kept = dict(self.kept) if water is None else {**self.kept, "water": water}
        return replace(result, end=replace(result.end, **kept))


def loaded_start(
    setup: Setup,
    load: Any,
    start: Result | StageResult | None,
    water: Any,
    undrained: bool = False,
    flow: Flow = "given",
) -> SearchStart:
    """Return the start of a search, with the load of the start or another load on top of weights
    and water.

    Inactive bodies do not move. Geometry that follows the displacements is held as it is at the
    start: a limit is that of one geometry, whatever the stiffness. Pore pressures stay, or those of
    ground that cannot drain follow.
    """
    last = last_stage(start)
    setup = setup.after(last)
    if last is not None and last.unreleased is not None:
        share = np.linalg.norm(last.unreleased) / np.linalg.norm(last.load)
        warn(
            f"the start holds back {share:.0%} of its load, forces of what is deactivated: the "
            f"search counts them as "
            "resistance; release the rest in a stage before"
        )
    active = (
        setup.forms
        if last is None
        else {
            name: look_up(name, setup.forms, "form, though the start holds it,")
            for name in last.states
        }
    )
    if last is not None and len(last.x) < setup.layout.size:
        unknown = [name for name, form in setup.forms.items() if form.fields and name not in active]
        raise ValueError(f"the start does not hold {unknown}: activate them in a stage")
    fixed = np.union1d(setup.fixed, setup.inactive(active))
    if undrained:
        active, fixed = without_drainage(active, fixed, flow)
    system = setup.checked_system(active, fixed)
    x = np.zeros(system.size) if last is None else last.x
    states = (
        {name: form.initial_state() for name, form in system.forms.items()}
        if last is None
        else last.states
    )
    held = {name: form.fixed_geometry(x, states[name]) for name, form in system.forms.items()}
    fixed_forms, states = ({name: pair[i] for name, pair in held.items()} for i in (0, 1))
    weight = setup.weights(active)
    water = last.water if water is None and last is not None else water
    if last is None or load is not None:
        on_top = setup.load(load) + setup.water_on(active, water)
    else:
        on_top = setup.vector(last.load, "the load of the start") - weight
        if water is not last.water:
            on_top += setup.water_on(active, water) - setup.water_on(active, last.water)
    if not (weight + on_top).any():
        what = "the load is zero" if load is not None else "there is no load"
        raise ValueError(f"{what}: give a `load`, unit weights of the forms, or a loaded `start`")
    if last is not None and not undrained:
        warn_of_fresh_pressures(system.with_forms(fixed_forms), x, states, weight + on_top)
    kept = {} if last is None else {name: getattr(last, name) for name in _KEPT}
    kept["water_unit_weight"] = setup.water_unit_weight
    return SearchStart(
        dict(active),
        system.with_forms(fixed_forms),
        Point(x, states, 0.0),
        weight,
        on_top,
        kept,
        partial(setup.at_rest, active, water),
    )


def remainder(points: list[Point] | tuple[Point, ...]) -> float:
    """Estimate how far the parameter may still rise, by the slope of the curve's last part.

    That part begins where at most :data:`_CHORD` of the present work had been done: the slope of
    shorter parts may be the solver's tolerance.
    """
    first, last = points[0], points[-1]
    done = last.work - first.work
    earlier = [point for point in points[:-1] if point.work - first.work <= _CHORD * done]
    if len(points) < 3 or not earlier or not done > 0.0:
        return np.inf
    start = earlier[-1]
    return (last.parameter - start.parameter) / (last.work - start.work) * done


def motion(last: Point, failed: NotConverged | None) -> ndarray:
    """Return displacements from the last equilibrium to those at which the next step failed."""
    return np.zeros_like(last.x) if failed is None or failed.x is None else failed.x - last.x


def follow(
    branch: Branch,
    control: ndarray,
    points: list[Point],
    newton: Newton,
    tolerance: float,
    log: SearchLog,
    **settings: Any,
) -> SearchResult:
    """Follow the curve until it has levelled off, a second time with resistance to slip where it
    stalls.

    With resistance from the start blocks that slide away end in a plateau, up to .3 % too high.
    """
    if branch.beside_contact:
        newton = replace(newton, max_iterations=min(newton.max_iterations, _BESIDE_CONTACT))
    found = _follow(branch, control, points, newton, tolerance, log, **settings)
    if found.stop.kind == "stall" and branch.resist():
        again = _follow(branch, control, points, newton, tolerance, log, **settings)
        return again if again.stop.shows_limit else found
    return found


def _follow(
    branch: Branch,
    control: ndarray,
    points: list[Point],
    newton: Newton,
    tolerance: float,
    log: SearchLog,
    relative: bool = False,
    max_value: float = np.inf,
    growth: float = GROWTH,
    max_step: float = np.inf,
    min_displacement: float = 0.0,
) -> SearchResult:
    """Follow the curve once.

    Parameters
    ----------
    branch, control, points
        The problem, the load whose work is prescribed, and two points to start from.
    tolerance, relative, max_value, min_displacement
        The curve ends when its last slope lets the parameter rise by no more than the tolerance, a
        share of the parameter if `relative`, and a displacement is as large as `min_displacement`;
        or when the parameter exceeds `max_value`.
    growth, max_step
        Ratio of a step to the one before, and work of the longest step; after a failed step they
        grow less.
    """
    points, length, failures, failed = (
        list(points),
        min(points[-1].work - points[-2].work, max_step),
        Counter[str](),
        0,
    )
    while len(points) < _MOST_STEPS:
        last = points[-1]
        margin = tolerance * (abs(last.parameter) if relative else 1.0)
        try:
            point = correct(branch, control, points, last.work + length, newton)
            if min_displacement == 0.0 and point.parameter < last.parameter - margin:
                raise PeakPassed("the curve falls", point.x, point.residuals)
        except NotConverged as error:
            rise = length * (last.parameter - points[-2].parameter) / (last.work - points[-2].work)
            if is_singular(error):
                beyond, forces = branch.at(last.parameter + max(rise, margin))
                error = as_collapse(error, beyond, last.x, last.states, forces, newton)
            log.reject(last.parameter, error, last.work + length)
            if isinstance(error, NoEquilibrium) and rise < margin:
                return SearchResult(
                    points,
                    Stop("collapse", str(error)),
                    last.parameter + margin,
                    motion(last, error),
                )
            kind = kind_of(error)
            failures[kind] += 1
            failed += max(len(error.residuals) - 1, _LEAST_FAILED)
            if kind != "collapse" and (failures[kind] > _CUTS[kind] or failed > _MOST_FAILED):
                return SearchResult(points, Stop(kind, str(error)))
            length, growth = 0.5 * length, min(growth, _CAUTIOUS)
            continue
        points.append(point)
        log.accept(point)
        left = remainder(points)
        reached = log.moved(point.x) >= min_displacement
        if (
            reached
            and left < margin
            and not (log.straight and _rises(branch, control, points, newton, margin))
        ):
            best = max(point.parameter for point in points)
            stop = Stop("plateau", f"the curve may rise by {max(left, 0.0):.2g} more")
            return SearchResult(points, stop, best + (left if left > 0.0 else margin))
        if point.parameter > max_value:
            return SearchResult(points, no_collapse_below(max_value))
        length = length if failures else min(growth * length, max_step)
        failures.clear()
    return SearchResult(points, Stop("steps", f"{_MOST_STEPS} of them without a plateau"))


def _rises(
    branch: Branch, control: ndarray, points: list[Point], newton: Newton, margin: float
) -> bool:
    """Return True if the last piece of a curve is straight and rises by more than a margin in the
    end.
    """
    before, last = points[-2:]
    length, rise = last.work - before.work, last.parameter - before.parameter
    for times in _BEYOND if _BEYOND[0] * rise > margin else ():
        try:
            far = correct(branch, control, points, last.work + times * length, newton)
        except NotConverged:
            continue
        return far.parameter - last.parameter > _STRAIGHT * times * rise
    return False


def correct(
    branch: Branch, control: ndarray, points: list[Point], work: float, newton: Newton
) -> Point:
    """Return the equilibrium at which the reference load has done some work, starting from an
    extrapolation.
    """
    before, last = points[-2:]
    share = (work - last.work) / (last.work - before.work)
    # the curve bends: the parameter's extrapolation is a cautious one
    guess = np.append(
        last.x + share * (last.x - before.x),
        last.parameter + 0.5 * (last.parameter - before.parameter),
    )
    system = branch.at(last.parameter)[0]
    target = system.work(control, points[0].x) + work

    def evaluate(z: ndarray) -> Evaluation:
        if not z[-1] > branch.lowest:
            return Evaluation(z, {}, np.zeros_like(control), np.inf)
        forms, load = branch.at(float(z[-1]))
        new = forms.evaluate(z[:-1], last.states, load)
        return replace(new, z=z)

    def direction(now: Evaluation, damped: bool) -> ndarray:
        """Solve for the Newton step of residual and work together, by two solutions with one
        factor.
        """
        solve = system.factor(system.tangent(now, damped))
        balance, drift = solve(now.residual), solve(branch.slope(now, last.states))
        lag = target - system.work(control, now.z[:-1] + balance)
        slope = system.work(control, drift)
        if slope == 0.0:
            raise NotConverged("no equilibrium: the forces do not depend on the parameter any more")
        change = lag / slope
        return np.append(balance + change * drift, change)

    try:
        now, norms = iterate(
            evaluate(guess), evaluate, direction, newton, branch.search, at_least=1, damp=True
        )
    except NotConverged as error:
        error.x = None if error.x is None else error.x[: len(control)]
        raise
    return Point(now.z[:-1], now.states, float(now.z[-1]), work, norms)
