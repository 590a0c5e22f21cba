"""Run of stages that follow each other: each starts from the state that the last one left."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator, Sequence
from contextlib import nullcontext
from dataclasses import dataclass, replace
from time import perf_counter
from typing import Any

import numpy as np
from numpy import ndarray

from ..arrays import max_abs
from ..checks import trusted_calls
from ..contact.diagnosis import OVERLAPS
from ..display import Bars
from ..errors import NotConverged, Remark, Remarks, saying, warn
from ..forms.base import Forms, solids_of, summaries
from ..forms.roles import Absorbing, Wet, having
from ..nonlinear.increment import Interval, Path, solve_step
from ..nonlinear.loose import share_held
from ..nonlinear.newton import Newton
from ..nonlinear.step import Equilibrium, Step
from ..nonlinear.stepping import Predictor, Stepping
from ..nonlinear.system import System
from ..results.result import Result
from ..results.stage import StageResult, undeformed
from ..results.strength import undrained_friction
from ..solvers import single_threaded
from .accuracy import Parts
from .activation import begin, check_start, state_changes
from .along_path import along_path
from .buckling import remark_on
from .creep import creep_errors
from .energies import INERTIA, Log
from .in_time import InTime, first_motion, steps_of
from .plan import Phase, plan, timeless
from .saturated import remark_on_motion
from .setup import Setup
from .stage import Stage, checked

logger = logging.getLogger("skfem_contact")

#: Shares of a stage at which prescribed displacements are compared with the first ones.
_SHARES = (0.1, 0.3, 0.6, 1.0)
#: Round-off of prescribed displacements at the start of a stage, as a share of them.
_JUMP = 1e-9
#: Time of a jump at the start of a stage over the duration of the stage: nothing flows or creeps in
#: it, and bodies with inertia stay.
_SUDDEN = 1e-9

#: Share of the largest kinetic energy with which a motion has not faded.
_MOVING = 1e-2
#: Share of the energy that a scheme may take, and that contact may give, before it is remarked on.
_MISSING, _GIVEN = 0.1, 0.02

#: Displacements along a path over the size of all that moves: long bars may hold short ones.
_SNAPS = 10.0

#: Seconds between two updates of the bars.
_SHOWN = 0.05

#: Function that is called with every accepted increment.
Observer = Callable[[StageResult], Any]


class _Accepted:
    """Stages and increments that are accepted so far: whatever ends a run takes them with it."""

    def __init__(self, done: Sequence[StageResult]) -> None:
        self.done = [*done]
        self.reached: StageResult | None = None  # the last increment of a stage that is not done
        self.kept: list[StageResult] = []
        self.seconds = 0.0  # since the begin of that stage
        self.begun = False

    def result(self) -> Result:
        """Return the stages that are done and the one that is not."""
        stages = [*self.done]
        reached = self.reached
        if reached is not None and reached.name not in [stage.name for stage in stages[-1:]]:
            kept = tuple(self.kept)
            stages.append(replace(reached, increments=kept, seconds=self.seconds))
        return Result(tuple(stages))


def run(
    setup: Setup,
    stages: Sequence[Stage],
    *,
    start: Result | StageResult | None = None,
    on_increment: Observer | None = None,
    progress: bool | None = None,
    remarks: Remarks | None = None,
) -> Result:
    """Run stages one after the other on one mesh, see :meth:`Model.run`.

    Without `remarks`, to which they are added, remarks become warnings when the run ends.
    """
    accepted = _Accepted([start] if isinstance(start, StageResult) else list(start or ()))
    try:
        with single_threaded, Remarks() if remarks is None else nullcontext(remarks) as found:
            return _run(setup, stages, accepted, on_increment, progress, found)
    except BaseException as error:
        if accepted.begun:
            error.result = accepted.result()  # type: ignore[attr-defined]
        raise


def _run(
    setup: Setup,
    stages: Sequence[Stage],
    accepted: _Accepted,
    on_increment: Observer | None,
    progress: bool | None,
    remarks: Remarks,
) -> Result:
    """Run stages, and record every increment that is accepted."""
    # Check everything, and plan all stages.
    done = accepted.done
    stages = checked(stages, [stage.name for stage in done])
    setup = setup.after(done[-1] if done else None)
    phases = plan(setup, stages, done[-1] if done else None)
    if done:
        last = among(setup, done[-1])
        check_start(phases[0].before, last)
    else:
        first = phases[0]
        begun = setup.supported(first.forms, first.fixed)
        last = undeformed("start", begun, setup.layout.size)

    if done and done[-1].fraction < 1.0:
        warn(
            f"the start ends at {done[-1].fraction:.0%} of its stage '{done[-1].name}', from which "
            "the run continues: start=result.completed() leaves this stage out"
        )

    # Follow the stages.
    follower = _Follower(setup, accepted, on_increment, Bars(progress, len(stages)))
    anew = any(stage.new_mesh is not None for stage in done)
    remarks.add(stages[-1].name, "the stage", timeless(setup, stages, phases[-1]))
    accepted.begun = True
    for stage, phase in zip(stages, phases, strict=True):
        try:
            last = follower.stage(stage, phase, last)
        except BaseException:
            if accepted.reached is not None:
                accepted.reached = _remarked(remarks, phase, accepted.reached, follower.parts, anew)
            raise
        last = _remarked(remarks, phase, last, follower.parts, anew, follower.buckling(last))
        done.append(last)
        accepted.reached = None
    return accepted.result()


class _Follower:
    """Stages that follow each other, with the system and the predictor that they share."""

    def __init__(
        self,
        setup: Setup,
        accepted: _Accepted,
        on_increment: Observer | None,
        progress: Bars,
    ) -> None:
        self._setup = setup
        self._accepted = accepted
        self.parts = Parts(driven=False)  # of the stage that is followed
        self._on_increment = on_increment
        self._progress = progress
        self._system: System | None = None
        self._first = True
        self._predictor = Predictor(np.zeros(0, int))

    def stage(self, stage: Stage, phase: Phase, last: StageResult) -> StageResult:
        """Return the end of a stage."""
        first = self._first
        self._first = False
        last, lost = self._changed(stage, phase, last, first)
        if phase.in_time is not None:
            return self._in_time(stage, phase, phase.in_time, last, lost)
        system = self._system
        if system is None or phase.changed:
            system = self._assembled(phase, last, lost, first)

        # Release lost forces, but for the share that remains.
        onward = None
        if last.fraction < 1.0 and last.before is not None:
            onward = last.x - last.before[0]
        last = self._begun(stage, phase, last, system.forms)
        unreleased = lost if last.unreleased is None else lost + last.unreleased
        remaining = (1.0 - stage.released) * (unreleased - phase.gone)
        held = last.x[system.fixed]
        values = _values(phase, held, system.fixed)
        _check_begin(stage, values(0.0), held)
        path = _path(phase, last, values, lost, remaining)
        last = replace(last, load=last.load - lost)  # in balance with the states before release

        # Follow the increments.
        pushed = _pushed(values)
        self.parts = Parts(driven=pushed > 0.0)
        newton = self._setup.newton or Newton()
        ways = [
            _Way(
                stage.name,
                path,
                increments=stage.increments,
                duration=stage.duration,
                pushed=pushed,
                arc_length=stage.arc_length,
                onward=onward,
            )
        ]
        if phase.jump is not None:
            jump = _jump_path(phase.jump, path)
            sudden = _SUDDEN * stage.duration
            ways.insert(0, _Way(stage.name, jump, stage.increments, sudden, at_start=True))
        increments = _increments(system, self._predictor, ways, last, newton)
        last = self._followed(increments, stage, last)
        return replace(last, unreleased=remaining if remaining.any() else None)

    def _changed(
        self, stage: Stage, phase: Phase, last: StageResult, first: bool
    ) -> tuple[StageResult, ndarray]:
        """Begin with other forms, bodies and supports; return the forces that are lost, too."""
        if phase.changed or (first and state_changes(phase, last)):
            x, states, lost = begin(self._setup.layout, phase, last)
            last = replace(
                last,
                x=x,
                states=states,
                placed=_placed(phase, last, x),
                next_step=np.inf,
                before=None,
            )
            return last, lost

        # A static stage after one in time loses the forces of inertia
        lost = np.zeros(len(last.x))
        if phase.in_time is None and last.inertial is not None:
            self._remark_on_motion(stage, last)
            lost = last.inertial.copy()
            lost[phase.fixed] = 0.0
        return last, lost

    def _assembled(self, phase: Phase, last: StageResult, lost: ndarray, first: bool) -> System:
        """Return the system of a stage, and begin its extrapolation of displacements."""
        system = self._setup.system(phase.forms, phase.fixed)
        self._system = system
        self._predictor = Predictor(system.fixed)
        if first and last.before is not None:  # the run continues the one of the start
            self._predictor.accept(*last.before)
        self._predictor.accept(last.x, last.load - lost, last.time)
        return system

    def _begun(self, stage: Stage, phase: Phase, last: StageResult, forms: Forms) -> StageResult:
        """Return the start of a stage, at rest."""
        return replace(
            last,
            name=stage.name,
            iterations=(),
            fraction=0.0,
            forms=forms,
            increments=(),
            water=phase.water,
            water_unit_weight=self._setup.water_unit_weight,
            gravity=tuple(float(part) for part in self._setup.gravity),
            changed=phase.replaced,
            supports=phase.supports,
            supports_given=phase.supports_given,
            velocity=None,
            acceleration=None,
            inertial=None,
            series={},
            new_mesh=None,
        )

    def _remark_on_motion(self, stage: Stage, last: StageResult) -> None:
        """Warn of a stage without inertia that ends a motion."""
        energy = last.series.get("energy")
        if energy is None:
            return
        share = float(energy[-1, 1] / max(energy[:, 1].max(), 1e-300))
        if share > _MOVING:
            warn(
                f"stage '{stage.name}' has no inertia and starts from rest: the kinetic energy of "
                f"'{last.name}', {share:.1%} of its largest one, is dropped; let the motion fade "
                "first"
            )

    def _in_time(
        self, stage: Stage, phase: Phase, in_time: InTime, last: StageResult, lost: ndarray
    ) -> StageResult:
        """Return the end of a stage with inertia."""
        # Absorbing sides begin to move; inertia joins the forms.
        states = dict(last.states)
        forms = dict(phase.forms)
        for name, form in having(phase.forms, Absorbing).items():
            forms[name] = form.in_motion()
            states[name] = form.begun(last.states, states[name])
        last = replace(last, states=states)
        forms.update(in_time.wet)
        forms[INERTIA] = in_time.form()
        system = self._setup.system(forms, phase.fixed)
        self._system = None
        unreleased = lost if last.unreleased is None else lost + last.unreleased
        remaining = (1.0 - stage.released) * (unreleased - phase.gone)
        path = _path_in_time(stage, phase, last.x[system.fixed], system.fixed, remaining)

        # Begin with the acceleration by the jump of the load
        load, _ = path(0.0)
        jump = load - (last.load - lost)
        motion = first_motion(in_time, last, jump, system.fixed, system.layout)
        plain = {name: form for name, form in system.forms.items() if name != INERTIA}
        last = replace(
            self._begun(stage, phase, last, plain),
            load=load,
            layout=system.layout,
            before=None,
            velocity=motion.velocity,
            acceleration=motion.acceleration,
            inertial=motion.force,
        )
        log = Log(system, in_time, states)
        newton = self._setup.newton or Newton()
        self.parts = Parts(driven=False)
        increments = steps_of(stage, in_time, system, (last, motion), path, newton, log)
        try:
            last = self._followed(increments, stage, last)
        except BaseException:
            if self._accepted.reached is not None:
                self._accepted.reached = replace(self._accepted.reached, series=log.series())
            raise
        # Energy that is missing shows steps that are too long.
        _warn_of_energy(stage.name, log)
        for name, text in log.slides.remarks():
            warn(f"stage '{stage.name}', {name}: {text}")
        text = remark_on_motion(log.frequency, in_time.lag)
        if text:
            warn(f"stage '{stage.name}': {text}")
        rest = remaining if remaining.any() else None
        summary = {**last.summary, "motion": log.summary()}
        return replace(last, unreleased=rest, series=log.series(), summary=summary)

    def buckling(self, last: StageResult) -> tuple[str, Remark] | None:
        """Return a remark on thrusts near buckling at the end of the last stage, with its form."""
        if self._system is None:
            return None
        return remark_on(self._system, last)

    def _followed(
        self, increments: Iterator[StageResult], stage: Stage, last: StageResult
    ) -> StageResult:
        """Return the end of a stage with the increments that it keeps."""
        accepted = self._accepted
        # Keep the increments that the stage asks for, and show the progress.
        accepted.kept = []
        accepted.reached = last
        accepted.seconds = 0.0
        iterations = 0
        shown = -np.inf
        began = perf_counter()
        with self._progress.stage(stage.name):
            for new in increments:
                seconds = perf_counter() - began
                if stage.dynamic is None:
                    self.parts.add(last, new)
                last = new
                accepted.reached = new
                accepted.seconds = seconds
                if _keeps(stage, last):
                    accepted.kept.append(last)
                iterations += last.iterations[-1]
                increments_done = len(last.iterations)
                if seconds - shown > _SHOWN or last.fraction == 1.0:
                    shown = seconds
                    self._progress.update(last.fraction, increments_done, iterations, _moved(last))
                if self._on_increment is not None:
                    self._on_increment(last)
        return replace(last, increments=tuple(accepted.kept), seconds=perf_counter() - began)


def _warn_of_energy(name: str, log: Log) -> None:
    """Warn of steps that are too long: the scheme takes energy, or contact gives it."""
    share = log.missing()
    if abs(share) > _MISSING:
        what = "gained"
        if share > 0.0:
            what = "missing, taken by the scheme"
        warn(
            f"stage '{name}': {abs(share):.0%} of the energy is {what}: shorten the steps, or take "
            "rho_inf nearer to 1"
        )
    given = log.gained_by_contact()
    if given > _GIVEN:
        warn(
            f"stage '{name}': contact that closes and opens gives {given:.0%} of the energy: "
            "shorten the steps, or give a softer penalty"
        )


def _remarked(
    remarks: Remarks,
    phase: Phase,
    last: StageResult,
    parts: Parts,
    anew: bool,
    slender: tuple[str, Remark] | None = None,
) -> StageResult:
    """Return the end of a stage, reached or not, with all remarks on it.

    Contact may be the reason of a failure.  On new meshes (``anew``) overlaps are errors of their
    curves, which the first increment removes.
    """
    # Collect the remarks of the plan, of the forms and of the way.
    found = {"the stage": [remark for remark in phase.remarks if remark.holds(last.x)]}
    for name, form in last.forms.items():
        found[name] = [*last.outputs(name).remarks]
        if isinstance(form, Wet):
            found[name] += form.remarks_on(last.x, last.states)
        found[name] += parts.remarks(name)
    more = [*undrained_friction(last.forms, last.states)]
    if slender is not None:
        more.append(slender)
    for name, remark in more:
        found[name].append(remark)
    # Write them down, each once.
    texts = []
    for name, several in found.items():
        if anew:
            several = [remark for remark in several if remark.kind not in OVERLAPS]
        remarks.add(last.name, name, several)
        texts += [f"{name}: {remark.text}" for remark in several]
    return replace(last, remarks=tuple(texts))


def _moved(stage: StageResult, since: ndarray | float = 0.0) -> float:
    """Return the largest displacement; rotations, pressures and multipliers do not count."""
    moves = slice(None) if stage.layout is None else stage.layout.displacements
    return max_abs((stage.x - since)[moves])


def among(setup: Setup, start: StageResult) -> StageResult:
    """Return a start, which may know displacements only, among all dofs."""
    before = start.before
    if before is not None:
        x, load, time = before
        before = setup.vector(x, "start"), setup.vector(load, "start"), time
    return replace(
        start,
        x=setup.vector(start.x, "start"),
        load=setup.vector(start.load, "start"),
        before=before,
    )


def _placed(phase: Phase, last: StageResult, x: ndarray) -> dict[str, ndarray]:
    """Return the displacements at which solids have become active; for new ones these are x."""
    new = solids_of(phase.forms).keys() - phase.before.keys()
    result = {}
    for name in phase.forms:
        if name in new:
            result[name] = x
        elif name in last.placed:
            result[name] = last.placed[name]
    return result


def _keeps(stage: Stage, accepted: StageResult) -> bool:
    """Return True if a stage keeps an accepted increment; jumps at its start have none to keep."""
    if stage.keep == "last" or accepted.fraction == 0.0:
        return False
    return stage.keep == "all" or len(accepted.iterations) % stage.keep == 0


@dataclass(frozen=True)
class _Way:
    """Loads and prescribed values that a stage follows: all of it, or the jump at its start.

    Attributes
    ----------
    name
        Name of the stage.
    path
        Load and prescribed values at a share of the way.
    increments, duration
        Number of increments to begin with, and time that they take.
    pushed
        How far supports move.
    at_start
        True for a jump at the start of the stage.
    arc_length
        True for increments of given length along the path.
    onward
        Way of the last increment, (N,), of a path that ended before its load.
    """

    name: str
    path: Path
    increments: int
    duration: float
    pushed: float = 0.0
    at_start: bool = False
    arc_length: bool = False
    onward: ndarray | None = None

    def __str__(self) -> str:
        jump = ""
        if self.at_start:
            jump = ", in the jump of the load at its start,"
        return f"stage '{self.name}'{jump}"


def _increments(
    system: System,
    predictor: Predictor,
    ways: Sequence[_Way],
    last: StageResult,
    newton: Newton,
) -> Iterator[StageResult]:
    """Yield the accepted increments of a stage; in a jump its share and time stay."""
    began = last.time
    for way in ways:
        if way.arc_length:
            yield from _along_path(way, system, predictor, last, newton)
            return
        for accepted in _along(way, system, predictor, last, newton):
            last = accepted
            if way.at_start:
                last = replace(accepted, fraction=0.0, time=began, next_step=np.inf)
            yield last


def _along(
    way: _Way, system: System, predictor: Predictor, last: StageResult, newton: Newton
) -> Iterator[StageResult]:
    """Yield the accepted increments along a way."""
    # Choose the first increment by the last one of the stage before.
    began = last.time
    duration = way.duration
    path = way.path
    stepping = Stepping(way.increments, last.next_step / duration if duration else np.inf)
    start_x = last.x
    farthest = _farthest(system, way.pushed)
    driven = way.pushed > 0.0
    while last.fraction < 1.0:
        _check_size(way, system, last, _moved(last, start_x), farthest)

        # Extrapolate the last increments, and solve the next one.
        fraction = stepping.fraction
        time = began + fraction * duration
        load, prescribed = path(fraction)
        start = None if stepping.cut else predictor.start(load, prescribed, time)
        if start is not None:
            start = system.foreseen(start, last.x, predictor.before, last.states)
        before = None if start is None else predictor.before
        step = Step(system, last.x, last.states, load, prescribed, start, before)
        interval = Interval(path, last.fraction, fraction, duration)
        try:
            with trusted_calls(system.evaluated):
                new, errors = solve_step(step, interval, newton, stepping.try_recovery)
            states = last.states, new.states
            times = last.time, time
            share = fraction - last.fraction
            creep = creep_errors(system.forms, states, times, share, driven)
        except NotConverged as error:
            held = 1.0
            if not duration and not driven:
                held = share_held(step, last.load, error.x)
            stepping.reject(error, held)
            text = "%s: increment to %.4f failed, cut to %.4f: %s"
            logger.info(text, way, fraction, stepping.size, error)
            if stepping.exhausted:
                where = system.layout.located(error.dof)
                raise saying(
                    error, f"{way} {stepping}: {error}{where}{_so_far(system, last)}"
                ) from error
            continue
        if stepping.too_long(errors, creep):
            text = "%s: step to %.3g too long, cut to %.4f"
            logger.info(text, way, time, stepping.size)
            continue

        # Accept it.
        percent = 100 * fraction
        logger.debug("%s: %.2f%% in %d iterations", way, percent, new.iterations)
        stepping.accept(fraction, new.iterations, new.equilibria)
        next_step = np.inf
        if duration:
            next_step = stepping.allowed * duration
        with trusted_calls():
            last = _accepted(last, step, new, fraction, time, next_step)
        predictor.accept(last.x, last.load, time)
        system.evaluated = True
        yield last


def _along_path(
    way: _Way, system: System, predictor: Predictor, last: StageResult, newton: Newton
) -> Iterator[StageResult]:
    """Yield the accepted increments along a way beyond limit points of its load."""
    size = max(
        _extent(field.coordinates) for field in system.layout.fields if field.kind == "displacement"
    )
    farthest = _SNAPS * (2.0 * size + way.pushed)
    start_x = last.x

    def accept(before: StageResult, step: Step, new: Equilibrium, share: float) -> StageResult:
        after = _accepted(before, step, new, share, before.time, np.inf)
        _check_size(way, system, after, _moved(after, start_x), farthest)
        predictor.accept(after.x, after.load, after.time)
        return after

    yield from along_path(
        way,
        system,
        path=way.path,
        increments=way.increments,
        last=last,
        newton=newton,
        accept=accept,
        onward=way.onward,
    )


def _accepted(
    last: StageResult,
    step: Step,
    new: Equilibrium,
    fraction: float,
    time: float,
    next_step: float,
) -> StageResult:
    """Return the result of an increment that follows the last one."""
    forms = step.system.forms
    return replace(
        last,
        x=new.x,
        load=step.load,
        states=new.states,
        iterations=(*last.iterations, new.iterations),
        residual=new.residuals[-1],
        fraction=fraction,
        summary=summaries(forms, new.x, new.states),
        forms=forms,
        time=time,
        layout=step.system.layout,
        before=(last.x, last.load, last.time),
        next_step=next_step,
    )


def _check_size(
    way: _Way, system: System, last: StageResult, moved: float, farthest: float
) -> None:
    """Refuse displacements larger than the bodies."""
    if moved > farthest:
        raise NotConverged(
            f"{way} stopped at {last.fraction:.2%} of its load: its displacements, "
            f"{moved:.3g}, exceed the size of the bodies, {farthest:.3g}; are E and the loads in "
            f"the same units, and is every body held?{_so_far(system, last)}",
            last.x,
        )


def _farthest(system: System, pushed: float) -> float:
    """Return the size of the bodies and how far supports move: no structure moves farther."""
    sizes = [_extent(form.basis.mesh.p) for form in solids_of(system.forms).values()]
    if not sizes:
        return np.inf
    # Half a turn moves the far end of a body by twice its size.
    turns = 2.0 if system.finite else 1.0
    return float(turns * max(sizes) + pushed)


def _extent(coordinates: ndarray) -> float:
    """Return the largest distance between points (dim, n) along a diagonal of their box."""
    if coordinates.shape[1] == 0:
        return 0.0
    return float(np.linalg.norm(np.ptp(coordinates, axis=1)))


def _check_begin(stage: Stage, given: ndarray, held: ndarray) -> None:
    """Refuse prescribed displacements that jump at the start of a stage."""
    jump = max_abs(given - held)
    if jump > _JUMP * max_abs(held):
        raise ValueError(
            f"stage '{stage.name}': prescribed(0) differs by {jump:.3g} from the displacements at "
            "the end of the stage before: begin with those"
        )


def _values(phase: Phase, held: ndarray, fixed: ndarray) -> Callable[[float], ndarray]:
    """Return the values of the fixed dofs at a share of a stage, which held some before."""
    given = phase.prescribed
    if callable(given):
        return lambda share: given(share)[fixed]
    target = held if given is None else given[fixed]
    return lambda share: held + share * (target - held)


def _pushed(values: Callable[[float], ndarray]) -> float:
    """Return how far supports move in a stage, which may end where it begins."""
    start = values(0.0)
    moved = [max_abs(values(share) - start) for share in _SHARES]
    return float(max(moved))


def _path(
    phase: Phase,
    last: StageResult,
    values: Callable[[float], ndarray],
    lost: ndarray,
    remaining: ndarray,
) -> Path:
    """Return load and prescribed values at a share of a stage.

    Lost forces are released but for the remaining ones.
    """
    # Begin where the last stage ended.
    load = last.load
    # End with what the stage gives, less the part that is not released.
    end = phase.load - remaining
    on_top = phase.on_top
    start = 0.0 if on_top is None else on_top(0.0)
    if phase.jump is not None:
        start = start - phase.jump

    def at(fraction: float) -> tuple[ndarray, ndarray]:
        if on_top is None:
            return load + fraction * (end - load) - (1.0 - fraction) * lost, values(fraction)
        faded = (1.0 - fraction) * (load - lost - start)  # weights and water that change, too
        return on_top(fraction) - fraction * remaining + faded, values(fraction)

    return at


def _path_in_time(
    stage: Stage, phase: Phase, held: ndarray, fixed: ndarray, remaining: ndarray
) -> Path:
    """Return load and prescribed values at a time since the start of a stage with inertia."""
    on_top = phase.on_top
    in_time = phase.in_time
    target = phase.prescribed
    assert on_top is not None
    assert in_time is not None
    stays = bool(remaining.any())

    def at(time: float) -> tuple[ndarray, ndarray]:
        if target is None:
            values = held
        elif callable(target):
            values = target(time)[fixed]
        else:
            # Values by time, or in proportion to it.
            values = held + time / stage.duration * (target[fixed] - held)
        load = on_top(time)
        if stays:
            load = load - remaining
        return in_time.with_base(load, time), values

    return at


def _jump_path(jump: ndarray, path: Path) -> Path:
    """Return load and prescribed values on the way to the first load of a path with a jump."""
    end, prescribed = path(0.0)

    def at(fraction: float) -> tuple[ndarray, ndarray]:
        return end - (1.0 - fraction) * jump, prescribed

    return at


def _so_far(system: System, last: StageResult) -> str:
    """Return the summaries of the last accepted increment, for a message."""
    lines = summaries(system.forms, last.x, last.states)
    text = "; ".join(f"{name}: {line}" for name, line in lines.items() if line)
    if text:
        return f". Accepted last: {text}"
    return ""
