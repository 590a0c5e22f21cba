"""Indirect continuation: the work of the load is prescribed, and the load or the strength follows.

Near collapse the displacements grow without bound while the parameter of the problem (strength reduction factor,
load multiplier) hardly changes, and beyond it there is no equilibrium at all.  The work that a reference load does
on the displacements grows steadily through all of this.  So it is prescribed, the parameter is an unknown beside
the displacements, and its curve over the work levels off at the limit.

S. Sysala, E. Hrubesova, Z. Michalec, F. Tschuchnigg, Int. J. Numer. Anal. Methods Geomech. 45 (2021) 2388-2414.
"""
from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal, Protocol

import numpy as np
from numpy import ndarray

from ..errors import NoEquilibrium, NotConverged
from ..forms import Form
from ..nonlinear.evaluation import Evaluation
from ..nonlinear.line_search import Search
from ..nonlinear.newton import Newton, iterate
from ..nonlinear.system import System
from ..solvers.direct import SingularSystem
from ..stages.result import Result, StageResult
from ..stages.setup import build_system, check_load, left_by
from .result import Stop, no_collapse_below

#: Relative step of the difference quotient by the parameter.
_DIFFERENCE = 1e-6
#: Growth of the steps.
GROWTH = 2.0
#: ... once a step has failed; ACADS 1(c) with psi = 0 takes 154 iterations with 2, 152 with 1.5 and 123 with 1.3.
_CAUTIOUS = 1.3
#: Step lengths in a row that may fail before the curve ends: no equilibrium is found, or one below the last.
_CUTS = {"stall": 6, "peak": 1}
#: Iterations of failed steps after which it ends, too.
_VAIN = 150
_MOST_STEPS = 100
#: Share of the work at which the curve's last part begins.
_CHORD = 0.7


class Fall(NotConverged):
    """An equilibrium was found, but below the last one: the step was too long, or the curve has a peak."""


class Branch(Protocol):
    """A problem that depends on one parameter."""

    #: The parameter must be larger than this.
    lowest: float
    #: Line search: along the energy where the forms do not depend on the parameter.  Where they do, the step is not
    #: exceeded; by the norm of the residual, to which single points that yield and unload add much, many more fail.
    search: Search

    def at(self, parameter: float) -> tuple[System, ndarray]:
        """Forms and load at a value of the parameter."""


@dataclass(frozen=True)
class Point:
    """An equilibrium on the curve of parameter over work.

    Attributes
    ----------
    x
        Displacements, (N,).
    states
        Accepted states of the forms.
    parameter
        Factor of safety or load multiplier.
    work
        Work of the reference load since the curve's first point.
    residuals
        History of the residual.
    """

    x: ndarray
    states: Mapping[str, Any]
    parameter: float
    work: float = 0.0
    residuals: tuple[float, ...] = (0.0,)

    @property
    def iterations(self) -> int:
        """Number of tangents factored on the way from the last point to this one."""
        return len(self.residuals) - 1


class Report(Protocol):
    """Hears of every step."""

    def accept(self, point: Point) -> None:
        """An equilibrium."""

    def reject(self, parameter: float, error: NotConverged, work: float) -> None:
        """A step that failed, after the last parameter."""


@dataclass(frozen=True)
class Curve:
    """Points of the curve, why it ends, and a value of the parameter that it does not reach.

    Attributes
    ----------
    points
        Equilibria in the order they were found.
    stop
        Why it ends there.
    above
        The smallest parameter that is known not to be reached; infinite where nothing is known.
    """

    points: tuple[Point, ...]
    stop: Stop
    above: float = np.inf

    @property
    def highest(self) -> Point:
        """The point of the largest parameter."""
        return max(self.points, key=lambda point: point.parameter)


def last_stage(start: Result | StageResult | None) -> StageResult | None:
    """The stage that a search starts from: the last one of a result."""
    return start[-1] if isinstance(start, Result) else start


def starting_point(system: System, last: StageResult | None) -> tuple[System, Point]:
    """Where a search starts, at the end of a stage or with unstrained bodies, and the system with its geometry there.

    What follows displaced bodies is held where it is: limits are those of one geometry, whatever the stiffness.
    """
    x = np.zeros(system.size) if last is None else last.x
    states = {name: form.initial_state() for name, form in system.forms.items()} if last is None else last.states
    held = {name: form.first_geometry(x, states[name]) for name, form in system.forms.items()}
    forms, states = ({name: pair[i] for name, pair in held.items()} for i in (0, 1))
    return system.with_forms(forms), Point(x, states, 0.0)


def loaded_start(forms: Mapping[str, Form], fixed: ndarray, load: ndarray | None, start: Result | StageResult | None,
                 solver: Any) -> tuple[System, Point, ndarray]:
    """System, starting point and load, by default that of the stage from which a search starts."""
    last = last_stage(start)
    if load is None and last is None:
        raise ValueError("there is no load: give `load`, or a `start` that carries one")
    whole, origin = starting_point(build_system(*left_by(last, forms, fixed), solver=solver), last)
    return whole, origin, check_load(load if last is None or load is not None else last.load, whole.unknowns)


def remainder(points: list[Point] | tuple[Point, ...]) -> float:
    """How far the parameter may still rise, by the slope of the curve's last part.

    That part begins where at most :data:`_CHORD` of the present work had been done: what shorter steps show may be
    the solver's tolerance.
    """
    first, last = points[0], points[-1]
    done = last.work - first.work
    earlier = [point for point in points[:-1] if point.work - first.work <= _CHORD * done]
    if len(points) < 3 or not earlier or not done > 0.0:
        return np.inf
    start = earlier[-1]
    return (last.parameter - start.parameter) / (last.work - start.work) * done


def follow(branch: Branch, control: ndarray, points: list[Point], newton: Newton, tolerance: float,
           report: Report, relative: bool = False, highest: float = np.inf, growth: float = GROWTH,
           longest: float = np.inf, until: float = 0.0) -> Curve:
    """Follow the curve until it has levelled off.

    Parameters
    ----------
    branch
        The problem.
    control
        Reference load whose work is prescribed, (N,).
    points
        Two points to start from, or more.
    newton
        Settings of Newton's method.
    tolerance
        The curve ends when its last slope lets the parameter rise by no more than this.
    relative
        Whether the tolerance is a share of the parameter.
    highest
        The curve ends when the parameter exceeds this.
    report
        Told of every new point and of every step that failed.
    growth
        Ratio of a step to the one before; the step after one that failed does not grow, those after it grow less.
    longest
        Work of the longest step.
    until
        Largest displacement that a curve that has levelled off must have reached.
    """
    points, length, failures, vain = list(points), min(points[-1].work - points[-2].work, longest), Counter[str](), 0
    while len(points) < _MOST_STEPS:
        last = points[-1]
        margin = tolerance * (abs(last.parameter) if relative else 1.0)
        try:
            point = correct(branch, control, points, last.work + length, newton)
            if until == 0.0 and point.parameter < last.parameter - margin:
                raise Fall("the curve falls", point.x, point.residuals)
        except NotConverged as error:
            report.reject(last.parameter, error, last.work + length)
            rise = length * (last.parameter - points[-2].parameter) / (last.work - points[-2].work)
            if isinstance(error, NoEquilibrium) and rise < margin:
                return Curve(tuple(points), Stop("collapse", str(error)), last.parameter + rise)
            kind = kind_of(error)
            failures[kind] += 1
            vain += max(len(error.residuals) - 1, 0)
            if kind != "collapse" and (failures[kind] > _CUTS[kind] or vain > _VAIN):
                return Curve(tuple(points), Stop(kind, str(error)))
            length, growth = 0.5 * length, min(growth, _CAUTIOUS)
            continue
        points.append(point)
        report.accept(point)
        left = remainder(points)
        reached = np.abs(point.x - points[0].x).max() >= until
        if reached and left < margin:
            best = max(point.parameter for point in points)
            stop = Stop("plateau", f"the curve may rise by {max(left, 0.0):.2g} more")
            return Curve(tuple(points), stop, best + (left if left > 0.0 else margin))
        if point.parameter > highest:
            return Curve(tuple(points), no_collapse_below(highest))
        length = length if failures else min(growth * length, longest)
        failures.clear()
    return Curve(tuple(points), Stop("steps", f"{_MOST_STEPS} of them without a plateau"))


def correct(branch: Branch, control: ndarray, points: list[Point], work: float, newton: Newton) -> Point:
    """The equilibrium at which the reference load has done some work, starting from an extrapolation.

    Raises
    ------
    NotConverged
        Newton's method found none.
    """
    before, last = points[-2:]
    share = (work - last.work) / (last.work - before.work)
    # the curve bends: the parameter's extrapolation is a cautious one
    guess = np.append(last.x + share * (last.x - before.x), last.parameter + 0.5 * (last.parameter - before.parameter))
    system = branch.at(last.parameter)[0]
    target = system.work(control, points[0].x) + work

    def evaluate(z: ndarray) -> Evaluation:
        if not z[-1] > branch.lowest:
            return Evaluation(z, {}, np.zeros_like(control), np.inf)
        forms, load = branch.at(float(z[-1]))
        new = forms.evaluate(z[:-1], last.states, load)
        return replace(new, z=z)

    def direction(now: Evaluation, damped: bool) -> ndarray:
        """Newton step of residual and work together, by two solutions with one factor."""
        delta = _DIFFERENCE * max(abs(now.z[-1]), _DIFFERENCE)
        beside = now.z.copy()
        beside[-1] += delta
        by_parameter = (evaluate(beside).residual - now.residual) / delta
        solve = system.factor(system.tangent(now, damped))
        balance, drift = solve(now.residual), solve(by_parameter)
        lag = target - system.work(control, now.z[:-1] + balance)
        slope = system.work(control, drift)
        if slope == 0.0:
            raise NotConverged("no equilibrium: the forces do not depend on the parameter any more")
        change = lag / slope
        return np.append(balance + change * drift, change)

    try:
        now, norms = iterate(evaluate(guess), evaluate, direction, newton, branch.search, at_least=1, damp=True)
    except NotConverged as error:
        error.x = None if error.x is None else error.x[:-1]
        raise as_collapse(error, system) from error
    return Point(now.z[:-1], now.states, float(now.z[-1]), work, norms)


def as_collapse(error: NotConverged, system: System) -> NotConverged:
    """The error, or :class:`NoEquilibrium` where all points flow from the start and nothing resists any more."""
    singular = error.__cause__
    if len(error.residuals) > 1 or not isinstance(singular, SingularSystem) \
            or len(singular.unknowns) < len(system.free):
        return error
    return NoEquilibrium("all points flow at once, and nothing resists any more", error.x, error.residuals,
                         error.unknown)


def kind_of(error: NotConverged) -> Literal["collapse", "peak", "stall"]:
    """How a step failed."""
    return "collapse" if isinstance(error, NoEquilibrium) else "peak" if isinstance(error, Fall) else "stall"
