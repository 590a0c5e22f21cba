"""Factor of safety by reduction of the strength."""

from __future__ import annotations

import logging
from collections.abc import Callable, Collection, Mapping
from dataclasses import replace
from functools import partial
from typing import Any, Literal

import numpy as np
from numpy import ndarray

from ..checks import names_of
from ..display import progress_bar
from ..errors import NoEquilibrium, NotConverged, warn
from ..forms.base import Form, reduced_parts
from ..limit_analysis import at_hand, beside
from ..materials.base import PLASTIC_STRAIN, Flow, check_reduction
from ..nonlinear.newton import Evaluation, Newton, Search
from ..nonlinear.system import System
from ..results.result import Result
from ..results.stage import StageResult
from ..solvers import single_threaded
from ..stages.setup import Setup
from .continuation import Branch, follow, loaded_start, motion
from .mechanism import FACTOR, as_collapse, is_singular
from .result import (
    CollapseResult,
    Point,
    SearchLog,
    SearchResult,
    Stop,
    conclude,
    no_collapse_below,
)

logger = logging.getLogger("skfem_contact")

#: Factors at which the first equilibrium is sought, in turn.
_FIRST = (1.0, 0.7, 0.5, 0.35, 0.25)
#: Relative step of the difference quotient by the factor.
_DIFFERENCE = 1e-6
#: Residual over the tolerance of the factor, and with psi < phi: there 0.03 costs 145 iterations
#: for 91, 181 for 120 and 367 for 208 (ACADS 1(a), 1(c), 3(a)), and the factors differ by at most
#: 0.002.
_BALANCE, _LOOSE = 0.03, 0.1
#: Share of the tolerance that the curve's end may leave open.
_OPEN = 0.25
#: Work, as a share of the elastic work of the whole load and of what the residual's tolerance
#: leaves, from which it can be prescribed: a block that sticks does .6 times its residual, 1.1e-4,
#: without any motion.
_NOTICEABLE, _BY_RESIDUAL = 1e-4, 3.0


class _Strength(Branch):
    """Structure with its strength divided by a factor.

    The structure is known to be stable at all factors up to ``safe``, and at none from ``above``
    on.
    """

    lowest = 0.0

    def __init__(
        self, system: System, load: ndarray, targets: dict[str, tuple[str, ...]], flow: Flow
    ) -> None:
        self.system, self.load, self.targets, self.flow = system, load, targets, flow
        self.safe, self.above = 0.0, np.inf
        self.beside_contact = any(form.unilateral for form in system.forms.values())
        self.search: Search = "either" if self.beside_contact else "step"

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the reduced parts."""
        return tuple(
            f"{name}.{part}" if part else name
            for name, parts in self.targets.items()
            for part in parts
        )

    @property
    def materials(self) -> list[Any]:
        """Materials of the reduced parts."""
        forms = self.system.forms
        return [
            forms[name].materials[part]
            for name, parts in self.targets.items()
            for part in parts
            if part
        ]

    def bound(self, davis: CollapseResult) -> float:
        """Return a factor that is not reached with any dilatancy, where Radenkovic's theorem
        holds.
        """
        rest = [
            form.reduced(1.0, "associated", self.targets.get(name, ()))
            for name, form in self.system.forms.items()
        ]
        if not davis.stop.shows_limit or not all(form.symmetric for form in rest):
            return np.inf
        return max(material.associated_bound(davis.bracket[1]) for material in self.materials)

    def at(self, parameter: float) -> tuple[System, ndarray]:
        """Return forms of reduced strength, and the load."""
        return self.system.with_forms({**self.system.forms, **self._reduced(parameter)}), self.load

    def _reduced(self, factor: float) -> dict[str, Form]:
        return {
            name: self.system.forms[name].reduced(factor, self.flow, parts)
            for name, parts in self.targets.items()
        }

    def slope(self, now: Evaluation, states: Mapping[str, Any]) -> ndarray:
        """Return the difference quotient of the residual: only the reduced forms depend on the
        factor.
        """
        step = _DIFFERENCE * max(now.z[-1], _DIFFERENCE)
        beside = self.system.with_forms(self._reduced(float(now.z[-1]) + step)).responses(
            now.z[:-1], states
        )
        change = (
            sum(now.responses[name].force - response.force for name, response in beside.items())
            / step
        )
        change[self.system.fixed] = 0.0
        return np.asarray(change)

    def equilibrium(
        self,
        start: Point,
        factor: float,
        newton: Newton,
        elastic: float = 0.0,
        searches: tuple[Search, ...] = ("energy", "residual"),
    ) -> Point:
        """Find equilibrium at a factor from another point; there is none where all points flow from
        the start.
        """
        system, load = self.at(factor)
        if factor <= self.safe:  # there is no collapse to be looked for
            searches = searches[:1]
        try:
            found = system.equilibrium(
                start.x,
                start.states,
                load,
                start.x[system.fixed],
                newton,
                searches,
                elastic,
                at_least=1,
                damp=True,
            )
        except NotConverged as error:
            if is_singular(error):
                raise as_collapse(error, system, start.x, start.states, load, newton) from error
            raise
        return Point(
            found.x,
            found.states,
            factor,
            start.work + system.work(load, found.x - start.x),
            found.residuals,
        )


@single_threaded
def strength_reduction(
    setup: Setup,
    load: Any,
    start: Result | StageResult | None,
    water: Any,
    reduce: str | Collection[str] | None,
    exclude: str | Collection[str],
    method: Literal["continuation", "bracket"],
    flow: Flow,
    tolerance: float,
    step: float,
    max_value: float,
    certify: bool | Literal["auto"] | Mapping[str, Any],
    undrained: bool,
    progress: bool | None,
) -> CollapseResult:
    """Reduce the strength until the structure collapses, see
    :meth:`skfem_contact.Model.strength_reduction`.
    """
    check_reduction(1.0, flow)
    if not tolerance > 0 or not step > 0 or not max_value > 1:
        raise ValueError(
            f"tolerance and step must be positive and max_value above 1, not {tolerance!r}, "
            f"{step!r} and "
            f"{max_value!r}"
        )
    begun = loaded_start(setup, load, start, water, undrained, flow)
    whole = begun.weight + begun.load
    branch = _Strength(
        begun.system, whole, reduced_parts(begun.system.forms, reduce, exclude), flow
    )
    if reduce is None:
        _check_kept(begun.system.forms, exclude)
    free = (
        flow == "given"
        and not undrained
        and any(material.dilates_less for material in branch.materials)
    )
    newton = setup.newton or Newton(
        tolerance=(_LOOSE if free else _BALANCE) * tolerance, max_iterations=30
    )
    proven = beside(
        certify,
        begun.forms,
        begun.system.fixed,
        whole,
        None,
        reduce,
        exclude,
        flow,
        progress,
        begun.at_rest,
    )
    search = partial(
        _search,
        origin=begun.origin,
        newton=newton,
        tolerance=tolerance,
        step=max(step, tolerance),
        max_value=max_value,
    )
    with progress_bar(progress, desc=FACTOR, bar_format="{desc} {postfix} {elapsed}") as bar:
        davis = _davis(branch, search, bar) if free else None
        result = begun.ended(search(branch, method=method, bar=bar, davis=davis), water)
    if certify == "auto" and not undrained:
        work = float(len(whole)) * (
            result.iterations + (result.davis.iterations if result.davis else 0)
        )
        coarse = result.stop.shows_limit and not free and result.added * result.value > tolerance
        proven = at_hand(
            begun.forms,
            begun.system.fixed,
            whole,
            reduce,
            exclude,
            flow,
            work,
            coarse,
            begun.at_rest,
        )
    return result.beside(proven, tolerance)


def _check_kept(forms: Mapping[str, Form], exclude: str | Collection[str]) -> None:
    """Report ground that yields and keeps its strength, because its law has none that can be
    reduced.
    """
    kept = [
        f"{name}.{region}, {material.label}"
        for name, form in forms.items()
        for region, material in form.materials.items()
        if set(names_of(exclude)).isdisjoint((name, region))
        and not material.reducible
        and PLASTIC_STRAIN in [variable.name for variable in material.internal]
    ]
    if kept:
        warn(
            f"{'; '.join(kept)}: this law keeps its strength, and the factor of safety is that of "
            f"the other parts, "
            "too high where a mechanism passes through it; give it a law with c and phi, or name "
            "it in `exclude`"
        )


def _search(
    branch: _Strength,
    origin: Point,
    newton: Newton,
    tolerance: float,
    step: float,
    max_value: float,
    method: str,
    bar: Any,
    davis: CollapseResult | None = None,
) -> CollapseResult:
    log = SearchLog(branch.system, bar, origin)
    if davis is not None:
        branch.safe, branch.above = davis.factor, branch.bound(davis)
    first = _first(branch, origin, newton, log)
    search = _continuation if method == "continuation" else _bracket
    found = search(branch, first, newton, tolerance, step, max_value, log)
    if np.isfinite(branch.above) and found.stop.kind != "collapse":
        found = replace(found, above=max(found.best.parameter, branch.above))
    system, load = branch.at(found.best.parameter)
    return conclude(
        FACTOR, found, found.best, system, load, log.steps, method, branch.flow, branch.names, davis
    )


def _davis(
    branch: _Strength, search: Callable[..., CollapseResult], bar: Any
) -> CollapseResult | None:
    """Search with the soils of Davis where dilatancy is less than friction: on the safe side,
    whatever the path.
    """
    try:
        return search(
            _Strength(branch.system, branch.load, branch.targets, "davis_b"),
            method="continuation",
            bar=bar,
        )
    except (
        ValueError,
        NotConverged,
    ) as error:  # materials without that flow, or nothing to begin with
        logger.info("no factor after Davis: %s", error)
        return None


def _first(branch: _Strength, origin: Point, newton: Newton, log: SearchLog) -> Point:
    """Return the first equilibrium: at factor 1, or below where there is none."""
    error: NotConverged | None = None
    for factor in (factor for factor in _FIRST if factor < branch.above):
        try:
            point = branch.equilibrium(origin, factor, newton)
        except NotConverged as reason:
            error = reason
            log.reject(factor, reason, 0.0)
            continue
        point = Point(point.x, point.states, factor, 0.0, point.residuals)
        log.accept(point)
        log.begin(point)
        return point
    most = f"{1 / _FIRST[-1]:g} times its strength"
    if isinstance(error, NoEquilibrium):
        raise NotConverged(
            f"the structure does not resist its load even with {most}: {error}"
        ) from error
    raise NotConverged(
        f"no equilibrium to start from was found, with up to {most}, and no collapse either; put "
        f"the "
        f"load on in stages and give their result as `start`: {error}"
    ) from error


def _elastic(branch: _Strength, first: Point) -> ndarray:
    """Return displacements under the whole load with the stiffness of the first point."""
    system, load = branch.at(first.parameter)
    return system.factor(system.tangent(system.evaluate(first.x, first.states, load)))(load)


def _continuation(
    branch: _Strength,
    first: Point,
    newton: Newton,
    tolerance: float,
    step: float,
    max_value: float,
    log: SearchLog,
) -> SearchResult:
    points, failed = _approach(branch, first, newton, _OPEN * tolerance, step, max_value, log)
    last = points[-1]
    if len(points) > 1:
        return follow(
            branch, branch.load, points, newton, _OPEN * tolerance, log, max_value=max_value
        )
    if failed is None:
        return SearchResult(points, no_collapse_below(max_value), motion=0 * last.x)
    flowed = any(step.yielding > 0.0 for step in log.steps)
    where = (
        "the first equilibrium is at its limit" if flowed else "the bodies are elastic up to there"
    )
    above = min(
        (step.parameter for step in log.steps if step.outcome == "collapse"), default=np.inf
    )
    shown = above - last.parameter <= tolerance
    return SearchResult(
        points, Stop("collapse" if shown else "stall", where), above, motion(last, failed)
    )


def _approach(
    branch: _Strength,
    first: Point,
    newton: Newton,
    least: float,
    step: float,
    max_value: float,
    log: SearchLog,
) -> tuple[list[Point], NotConverged | None]:
    """Take fixed factors until the load does work: as long as the bodies are elastic the factor has
    no effect.
    """
    response = _elastic(branch, first)
    noticeable = max(_NOTICEABLE, _BY_RESIDUAL * newton.tolerance) * branch.system.work(
        branch.load, response
    )
    last = first
    while last.parameter <= max_value:
        factor = last.parameter + step
        try:
            # the collapse is still far: the search that leads to it is tried last
            point = branch.equilibrium(
                last, factor, newton, float(np.linalg.norm(response)), ("step", "energy")
            )
        except NotConverged as error:
            log.reject(factor, error, last.work)
            if step < least:
                return [last], error
            step *= 0.5
            continue
        log.accept(point)
        if point.work - first.work > noticeable:
            return [last, point], None
        last, step = point, 1.5 * step
    return [last], None


def _bracket(
    branch: _Strength,
    first: Point,
    newton: Newton,
    tolerance: float,
    step: float,
    max_value: float,
    log: SearchLog,
) -> SearchResult:
    elastic = float(np.linalg.norm(_elastic(branch, first)))
    points, above, shown = [first], np.inf, np.inf
    failed: NotConverged | None = None
    while above - points[-1].parameter > tolerance and points[-1].parameter <= max_value:
        last = points[-1]
        factor = last.parameter + step if np.isinf(above) else 0.5 * (last.parameter + above)
        try:
            point = branch.equilibrium(last, factor, newton, elastic)
        except NotConverged as error:
            log.reject(factor, error, last.work)
            above, failed = factor, error
            shown = factor if isinstance(error, NoEquilibrium) else shown
            continue
        log.accept(point)
        points.append(point)
    last = points[-1]
    if failed is None:
        stop = no_collapse_below(max_value)
    elif shown > above:
        higher = f"collapse at {shown:.4f}" if np.isfinite(shown) else "no collapse above it either"
        stop = Stop(
            "stall",
            f"at {above:.4f} neither equilibrium nor collapse was found ({higher}): {failed}",
        )
    else:
        stop = Stop("collapse", f"at {shown:.4f}")
    return SearchResult(points, stop, shown, motion(last, failed))
