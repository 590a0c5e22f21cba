"""Limit load and load-displacement curve by indirect continuation; stability in one equilibrium."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy import ndarray

from ..display import progress_bar
from ..errors import NoEquilibrium, NotConverged, saying
from ..forms.base import States, dilate_less
from ..forms.roles import Reducible, changed
from ..limit_analysis import beside
from ..materials.base import Flow, check_reduction
from ..nonlinear.newton import Evaluation, Newton, Search
from ..nonlinear.step import Attempt, Step
from ..nonlinear.system import System
from ..results.result import Result
from ..results.stage import StageResult
from ..stages.setup import Setup
from ..stages.stage import AtRest, Force
from . import finer
from .accepted import Accepted, kept_in_errors
from .continuation import (
    GROWTH,
    Branch,
    Course,
    SearchStart,
    follow,
    last_stage,
    loaded_start,
)
from .mechanism import LOAD, as_collapse, warn_of_errors
from .result import CollapseResult, Point, SearchLog, conclude

_CUTS = 10
#: Growth of the steps where friction is that of the step before.
_SMALL_GROWTH = 1.5


class _Load(Branch):
    """A constant load and a multiple of another one."""

    lowest = -np.inf
    search: Search = "energy"

    def __init__(self, system: System, dead: ndarray, reference: ndarray) -> None:
        self.system = system
        self.dead = dead
        self.reference = reference

    def at(self, parameter: float) -> tuple[System, ndarray]:
        """Return the system, and the load at a multiplier."""
        return self.system, self.dead + parameter * self.reference

    def slope(self, now: Evaluation, states: States) -> ndarray:
        """Return the load that is multiplied, at free dofs."""
        slope = self.reference.copy()
        slope[self.system.fixed] = 0.0
        return slope


def limit_load(
    setup: Setup,
    load: Force,
    *,
    start: Result | StageResult | None = None,
    tolerance: float = 0.005,
    step: float = 1.0,
    max_value: float = np.inf,
    flow: Flow = "given",
    max_step: float = np.inf,
    min_displacement: float = 0.0,
    certify: bool | Mapping[str, Any] = False,
    undrained: bool = False,
    progress: bool | None = None,
) -> CollapseResult:
    """Multiply a load until the structure collapses.

    The work of the load is prescribed and its multiplier follows, until the curve over the work
    has levelled off.

    Parameters
    ----------
    load
        Reference load, (N,).
    start
        Where to start: a result (its last stage) or a stage, whose load stays. By default the
        bodies are unstrained, and the weight of the forms stays.
    tolerance
        The curve ends when its last slope lets the multiplier rise by no more than this share.
    step
        First multiplier; it is halved until an equilibrium is found.
    max_value
        The curve ends when the multiplier exceeds this.
    flow
        Flow rule. With psi < phi the law as given takes hundreds of iterations or stalls; one
        that is ``"lagged"`` (Krabbenhoft and others 2012) does not, but must start from
        equilibrium with its own friction, and in long steps it resists more than the given law:
        `max_step` keeps them short.
    max_step
        Work of the longest step over the work of the first one. Steps grow up to it.
    min_displacement
        The curve does not end at a peak or plateau before a displacement is as large as this.
    certify, undrained, progress
        As for :meth:`strength_reduction`; the water stays as in the start.

    Raises
    ------
    NotConverged
        No step was small enough to begin with. Like every error that ends the search, a
        ``KeyboardInterrupt`` too, its attribute ``result`` holds the accepted part.

    Warns
    -----
    AnalysisWarning
        The search has shown no limit, and it may be higher: :attr:`CollapseResult.stop` says
        why. Or the value lies outside of the proven bounds by more than `tolerance`, or needs
        displacements beyond a tenth of the model.
    """
    check_reduction(1.0, flow)
    if not tolerance > 0 or not step > 0 or not max_step > 0:
        raise ValueError(
            "tolerance, step and max_step must be positive, not "
            f"{tolerance!r}, {step!r} and {max_step!r}"
        )
    if load is None:
        raise ValueError("there is no load to be multiplied: give `load`")

    # keep the load of the start with its water as the dead load
    begun = loaded_start(setup, load, start, False, undrained, flow)
    last = last_stage(start)
    if last is None:
        dead = begun.weight
    else:
        dead = setup.vector(last.load, "the load of the start")
    system = begun.system
    if not begun.load[system.free].any():
        raise ValueError("the load to be multiplied is zero, or acts on supports alone")
    system = _flowing(system, flow)
    begun = replace(begun, system=system)

    # prove bounds that were asked for
    water = None if last is None else last.water
    accepted = Accepted(LOAD, begun)
    with accepted:
        proven = beside(
            certify,
            begun.forms,
            fixed=system.fixed,
            dead=dead,
            live=begun.load,
            flow=flow,
            progress=progress,
            at_rest=partial(setup.at_rest, begun.forms, water),
        )

    # follow the curve, and see what a coarse mesh adds
    options = _Options(tolerance, step, max_value, flow, max_step, min_displacement, progress)
    with accepted:
        result = accepted.found = _followed(setup, begun, dead, options, accepted)
        if not undrained:
            result = replace(result, added=_added(setup, begun, dead, options, result))
    return result.beside(proven, tolerance * abs(result.value))


class _Options(NamedTuple):
    """Arguments of a search, as of :func:`limit_load`."""

    tolerance: float
    step: float
    max_value: float
    flow: Flow
    max_step: float
    min_displacement: float
    progress: bool | None


def _followed(
    setup: Setup,
    begun: SearchStart,
    dead: ndarray,
    options: _Options,
    accepted: Accepted,
) -> CollapseResult:
    """Follow the curve from the first loaded equilibrium, and describe its end."""
    o = options
    system = begun.system
    branch = _Load(system, dead, begun.load)
    newton = setup.newton or Newton(tolerance=0.03 * o.tolerance, max_iterations=30)
    shown = progress_bar(o.progress, desc=LOAD, bar_format="{desc} {postfix} {elapsed}")
    with shown as bar:
        origin = begun.origin
        log = SearchLog(system, bar, origin)
        accepted.follow(branch, log, o.flow)
        first = _first(branch, origin, o.step, newton, log)
        if first.work <= 0.0:
            # Loads that stay move the structure against the load: begin from their equilibrium
            origin = replace(_first(branch, origin, 0.0, newton, log), work=0.0)
            log = SearchLog(system, bar, origin)
            accepted.follow(branch, log, o.flow)
            first = _first(branch, origin, o.step, newton, log)
        course = Course(
            o.tolerance,
            relative=True,
            max_value=o.max_value,
            growth=_SMALL_GROWTH if o.flow == "lagged" else GROWTH,
            max_step=o.max_step * first.work,
            min_displacement=o.min_displacement,
        )
        points = [origin, first]
        search = follow(branch, branch.reference, points, newton, course, log)
    end = search.points[-1]
    result = conclude(
        LOAD,
        search,
        last=end,
        system=system,
        load=branch.at(end.parameter)[1],
        steps=log.steps,
        flow=o.flow,
        multiplied=branch.reference,
    )
    return begun.ended(result)


def _added(
    setup: Setup,
    begun: SearchStart,
    dead: ndarray,
    options: _Options,
    result: CollapseResult,
) -> float:
    """Return the share that the mesh adds."""
    if dilate_less(begun.system.forms):
        return result.added

    def refined() -> CollapseResult:
        """Search with every element cut, with the same first step."""
        finer.check(setup, begun.forms, False, finer.CUT)
        model, (load, kept), states = finer.finer(
            setup,
            begun.forms,
            fixed=begun.system.fixed,
            loads=(begun.load, dead),
            states=begun.origin.states,
        )
        new = loaded_start(model, load, None, False, flow=options.flow)
        origin = replace(new.origin, states=states)
        new = replace(new, system=_flowing(new.system, options.flow), origin=origin)
        quiet = options._replace(progress=False, step=result.path[1][0])
        return _followed(model, new, kept, quiet, Accepted(LOAD, new))

    return finer.added_by(refined, result, options.tolerance)


def _first(branch: _Load, origin: Point, step: float, newton: Newton, log: SearchLog) -> Point:
    """Return the first loaded equilibrium."""
    # halve the step until an equilibrium is found
    error: NotConverged | None = None
    for cut in range(_CUTS):
        multiplier = step * 0.5**cut
        system, load = branch.at(multiplier)
        try:
            fixed = origin.x[system.fixed]
            step_to = Step(system, origin.x, origin.states, load, fixed)
            result = step_to.equilibrium(newton, Attempt(("energy",), at_least=1))
        except NotConverged as reason:
            error = reason
            log.reject(multiplier, reason, 0.0)
            continue
        work = system.work(branch.reference, result.x - origin.x)
        point = Point(result.x, result.states, multiplier, work, result.residuals)
        log.accept(point)
        return point
    assert error is not None
    where = branch.system.layout.located(error.dof)
    raise saying(
        error,
        f"no equilibrium was found under {multiplier:g} times the reference load; is the structure "
        f"stable without it? {error}{where}",
    ) from error


def is_stable(
    setup: Setup,
    load: Force = None,
    *,
    start: Result | StageResult | None = None,
    water: AtRest = None,
    undrained: bool = False,
) -> bool:
    """Return True if the structure resists its load: its factor of safety is above 1.

    An equilibrium means True; displacements that run away along a mechanism
    (:class:`NoEquilibrium`) mean False.

    Parameters
    ----------
    load, start, water, undrained
        As for :meth:`strength_reduction`.

    Raises
    ------
    NotConverged
        Neither an equilibrium nor a collapse was found; :meth:`limit_load` proceeds by
        steps. Every error has the stage that the search began with as its attribute ``result``.
    """
    # Put the load on the structure.
    begun = loaded_start(setup, load, start, water, undrained)
    system = begun.system
    origin = begun.origin
    whole = begun.weight + begun.load
    newton = setup.newton or Newton(tolerance=3e-4, max_iterations=60)
    # A collapse is a result; other failures are errors.
    with kept_in_errors(begun.begins):
        try:
            step = Step(system, origin.x, origin.states, whole, origin.x[system.fixed])
            step.equilibrium(newton, Attempt(("energy", "residual"), at_least=1, damp=True))
        except NotConverged as error:
            failure = as_collapse(error, system, origin.x, origin.states, whole, newton)
            if not isinstance(failure, NoEquilibrium) or failure.x is None:
                raise saying(error, f"{error}{system.layout.located(error.dof)}") from error
            states = system.evaluate(failure.x, origin.states, whole).states
            warn_of_errors(system, failure.x, states)
            return False
    return True


def _flowing(system: System, flow: Flow) -> System:
    """Return the system with the flow of a search in place of the flow of its materials."""
    if flow == "given":
        return system
    forms = changed(system.forms, Reducible, lambda form: form.reduced(1.0, flow, form.strengths))
    return system.with_forms(forms)
