"""Run of stages that follow each other: each starts from the state that the last one left."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from time import perf_counter
from typing import Any

import numpy as np
from numpy import ndarray

from ..display import Bars
from ..errors import NotConverged, Remarks
from ..forms.base import solids_of, summaries
from ..forms.roles import Wet
from ..nonlinear.increment import Path, solve_step
from ..nonlinear.newton import Newton
from ..nonlinear.stepping import Predictor, Stepping
from ..nonlinear.system import System
from ..results.result import Result
from ..results.stage import StageResult
from ..results.strength import undrained_friction
from ..solvers import single_threaded
from .accuracy import Parts
from .activation import Phase, begin, check_start, plan, state_changes, timeless
from .setup import Setup
from .stage import Stage, checked

logger = logging.getLogger("skfem_contact")

#: Function that is called with every accepted increment.
Observer = Callable[[StageResult], Any]


@single_threaded
def run(
    setup: Setup,
    stages: Sequence[Stage],
    start: Result | StageResult | None = None,
    on_increment: Observer | None = None,
    progress: bool | None = None,
) -> Result:
    """Run stages one after the other, see :meth:`skfem_contact.Model.run`."""
    done = [start] if isinstance(start, StageResult) else list(start or ())
    stages = checked(stages, [stage.name for stage in done])
    setup = setup.after(done[-1] if done else None)
    phases = plan(setup, stages, done[-1] if done else None)
    last = among(setup, done[-1]) if done else _nothing(phases[0])
    if done:
        check_start(phases[0].before, last)
    system, predictor, bars = None, None, Bars(progress, len(stages))
    with Remarks() as remarks:
        remarks.add(stages[-1].name, "the stage", timeless(setup, stages, phases[-1]))
        for stage, phase in zip(stages, phases, strict=True):
            lost = np.zeros(len(last.x))
            if phase.changed or (stage is stages[0] and state_changes(phase, last)):
                x, states, lost = begin(setup.layout, phase, last)
                last = replace(
                    last,
                    x=x,
                    states=states,
                    placed=_placed(phase, last, x),
                    next_step=np.inf,
                    before=None,
                )
            if system is None or predictor is None or phase.changed:
                system = setup.system(phase.forms, phase.fixed)
                predictor = Predictor(system.fixed)
                if (
                    last.before is not None and stage is stages[0]
                ):  # the run continues that of the start
                    predictor.accept(*last.before)
                predictor.accept(last.x, last.load - lost, last.time)
            last = replace(
                last,
                name=stage.name,
                iterations=(),
                fraction=0.0,
                forms=system.forms,
                increments=(),
                water=phase.water,
                water_unit_weight=setup.water_unit_weight,
                changed=phase.replaced,
                supports=phase.supports,
            )
            unreleased = lost if last.unreleased is None else lost + last.unreleased
            left = (1.0 - stage.release) * (unreleased - phase.gone)
            path = _path(phase, last, system.fixed, lost, left)
            parts = Parts(not np.array_equal(path(0.0)[1], path(1.0)[1]))
            increments = _increments(system, predictor, stage, path, last, setup.newton or Newton())
            try:
                last = _followed(increments, stage, last, on_increment, bars, parts)
            except (NotConverged, KeyboardInterrupt) as error:
                last = _remarked(remarks, phase, error.result, parts)  # type: ignore[union-attr]
                error.result = Result((*done, last))  # type: ignore[union-attr]
                raise
            last = _remarked(remarks, phase, last, parts)
            done.append(last := replace(last, unreleased=left if left.any() else None))
    return Result(tuple(done))


def _remarked(remarks: Remarks, phase: Phase, last: StageResult, parts: Parts) -> StageResult:
    """Return the end of a stage, reached or not, with all remarks on it: contact may be the reason
    of a failure.
    """
    found = {"the stage": [remark for remark in phase.remarks if remark.holds(last.x)]}
    for name, form in last.forms.items():
        found[name] = [
            *form.outputs(last.x[: form.size], last.states[name]).remarks,
            *(form.remarks_on(last.x, last.states) if isinstance(form, Wet) else ()),
            *parts.remarks(name),
        ]
    for name, remark in undrained_friction(last.forms, last.states):
        found[name].append(remark)
    for name, several in found.items():
        remarks.add(last.name, name, several)
    return replace(
        last,
        remarks=tuple(
            f"{name}: {remark.text}" for name, several in found.items() for remark in several
        ),
    )


def _followed(
    increments: Iterator[StageResult],
    stage: Stage,
    last: StageResult,
    on_increment: Observer | None,
    progress: Bars,
    parts: Parts,
) -> StageResult:
    """Return the end of a stage with the increments that it keeps; an error that stops it has the
    last one.
    """
    kept, began = list[StageResult](), perf_counter()
    with progress.stage(stage.name):
        try:
            for accepted in increments:
                parts.add(last, accepted)
                last = accepted
                if _keeps(stage, last):
                    kept.append(last)
                progress.update(
                    last.fraction, len(last.iterations), sum(last.iterations), _moved(last)
                )
                if on_increment is not None:
                    on_increment(last)
        except (NotConverged, KeyboardInterrupt) as error:
            error.result = _ended(last, kept, began)  # type: ignore[union-attr]
            raise
    return _ended(last, kept, began)


def _moved(stage: StageResult, since: ndarray | float = 0.0) -> float:
    """Return the largest displacement; rotations, pressures and multipliers do not count."""
    at = slice(None) if stage.layout is None else stage.layout.displacements
    return float(np.abs((stage.x - since)[at]).max(initial=0.0))


def _ended(last: StageResult, kept: Sequence[StageResult], began: float) -> StageResult:
    """Return the end of a stage with the increments that it keeps and the time that it has
    taken.
    """
    return replace(last, increments=tuple(kept), seconds=perf_counter() - began)


def among(setup: Setup, start: StageResult) -> StageResult:
    """Return a start, which may know displacements only, among all dofs."""
    before = start.before
    if before is not None:
        before = setup.vector(before[0], "start"), setup.vector(before[1], "start"), before[2]
    return replace(
        start,
        x=setup.vector(start.x, "start"),
        load=setup.vector(start.load, "start"),
        before=before,
    )


def _placed(phase: Phase, last: StageResult, x: ndarray) -> dict[str, ndarray]:
    """Return the displacements at which solids have become active, with the new ones of a phase, at
    x.
    """
    new = solids_of(phase.forms).keys() - phase.before.keys()
    return {
        name: x if name in new else last.placed[name]
        for name in phase.forms
        if name in {*new, *last.placed}
    }


def _keeps(stage: Stage, accepted: StageResult) -> bool:
    """Return True if a stage keeps an accepted increment."""
    if stage.keep == "last":
        return False
    return stage.keep == "all" or len(accepted.iterations) % stage.keep == 0


def _increments(
    system: System,
    predictor: Predictor,
    stage: Stage,
    path: Path,
    last: StageResult,
    newton: Newton,
) -> Iterator[StageResult]:
    """Yield the accepted increments of a stage."""
    began, duration = last.time, stage.duration
    stepping = Stepping(stage.increments, last.next_step / duration if duration else np.inf)
    start_x, farthest = last.x, _farthest(system, path)
    while last.fraction < 1.0:
        if (moved := _moved(last, start_x)) > farthest:
            raise NotConverged(
                f"stage '{stage.name}' stopped at {last.fraction:.2%} of its load: its "
                f"displacements, "
                f"{moved:.3g}, exceed the size of the bodies, {farthest:.3g}; are E and the loads "
                f"in "
                f"the same units, and is every body held?{_so_far(system, last)}",
                last.x,
            )
        fraction = stepping.fraction
        time = began + fraction * duration
        start = None if stepping.cut else predictor.start(*path(fraction), time)
        if start is not None:
            start = system.foreseen(start, last.x, predictor.before, last.states)
        try:
            new, errors = solve_step(
                system,
                last.x,
                last.states,
                path,
                (last.fraction, fraction),
                duration,
                newton,
                start,
                stepping.try_recovery,
            )
        except NotConverged as error:
            stepping.reject(error)
            logger.info(
                "stage '%s': increment to %.4f failed, cut to %.4f: %s",
                stage.name,
                fraction,
                stepping.size,
                error,
            )
            if stepping.exhausted:
                where = "" if error.dof is None else f", {system.layout.describe(error.dof)}"
                raise NotConverged(
                    f"stage '{stage.name}' {stepping}: {error}{where}{_so_far(system, last)}"
                ) from error
            continue
        if stepping.too_long(errors):
            logger.info(
                "stage '%s': step to %.3g too long, cut to %.4f", stage.name, time, stepping.size
            )
            continue
        logger.debug(
            "stage '%s': %.2f%% in %d iterations", stage.name, 100 * fraction, new.iterations
        )
        stepping.accept(fraction, new.iterations, new.equilibria)
        load, _ = path(fraction)
        summary = summaries(system.forms, new.x, new.states)
        last = StageResult(
            stage.name,
            new.x,
            load,
            new.states,
            (*last.iterations, new.iterations),
            new.residuals[-1],
            fraction,
            summary,
            system.forms,
            time,
            layout=system.layout,
            water=last.water,
            water_unit_weight=last.water_unit_weight,
            placed=last.placed,
            changed=last.changed,
            supports=last.supports,
            next_step=stepping.allowed * duration if duration else np.inf,
            before=(last.x, last.load, last.time),
        )
        predictor.accept(last.x, last.load, time)
        yield last


def _farthest(system: System, path: Path) -> float:
    """Return the size of the bodies and how far supports move: displacements beyond it are those of
    no structure.
    """
    sizes = [
        np.linalg.norm(np.ptp(form.basis.mesh.p, axis=1))
        for form in solids_of(system.forms).values()
    ]
    pushed = np.abs(path(1.0)[1] - path(0.0)[1]).max(initial=0.0)
    return float(max(sizes) + pushed) if sizes else np.inf


def _path(phase: Phase, last: StageResult, fixed: ndarray, lost: ndarray, left: ndarray) -> Path:
    """Return load and prescribed values at a share of a stage; lost forces are released but for
    those that are left.
    """
    load, held = last.load, last.x[fixed]
    target = held if phase.prescribed is None else phase.prescribed[fixed]
    end = phase.load - left
    start = 0.0 if phase.on_top is None else phase.on_top(0.0)

    def at(fraction: float) -> tuple[ndarray, ndarray]:
        values = held + fraction * (target - held)
        if phase.on_top is None:
            return load + fraction * (end - load) - (1.0 - fraction) * lost, values
        return phase.on_top(fraction) - fraction * left + (1.0 - fraction) * (
            load - lost - start
        ), values

    return at


def _so_far(system: System, last: StageResult) -> str:
    """Return the summaries of the last accepted increment, for a message."""
    lines = summaries(system.forms, last.x, last.states)
    text = "; ".join(f"{name}: {line}" for name, line in lines.items() if line)
    return f". Accepted last: {text}" if text else ""


def _nothing(phase: Phase) -> StageResult:
    """Return the start of the first stage: undeformed bodies without load."""
    states, n = {name: form.initial_state() for name, form in phase.forms.items()}, len(phase.load)
    return StageResult("start", np.zeros(n), np.zeros(n), states, (), 0.0)
