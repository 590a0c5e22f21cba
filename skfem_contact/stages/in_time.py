"""Stages in time: their masses and loads, and the steps that follow each other."""

from __future__ import annotations

import logging
from collections import ChainMap
from collections.abc import Callable, Iterator, Mapping
from copy import copy
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix

from ..dynamics.boundaries import Masses
from ..dynamics.explicit import Explicit
from ..dynamics.linear import Linear, is_linear
from ..dynamics.mass import accelerations, mass_and_damping, translation
from ..dynamics.record import Record
from ..dynamics.scheme import Inertia, Motion, Scheme
from ..dynamics.settings import Dynamic
from ..errors import NotConverged, Remark
from ..forms.base import Form, Response, responses_of, solids_of, summaries
from ..forms.roles import Absorbing, Touching, Wet, having
from ..layout import Layout, dofs_at
from ..nonlinear.increment import solve_increment
from ..nonlinear.newton import Newton
from ..nonlinear.step import Equilibrium, Step
from ..nonlinear.system import System
from ..results.motion import Lazy
from ..results.stage import StageResult
from ..sparse import padded
from .setup import Setup
from .stage import Stage

logger = logging.getLogger("skfem_contact")

#: Name of the form of inertia in the system of a stage; results have its forces as `inertial`.
INERTIA = "inertia"
#: Parts of a step: it is cut to a quarter where no equilibrium is found, and steps grow again once
#: they end where a longer one may begin.
_PARTS = 1024
_CUT, _GROWTH = 4, 2
#: Acceleration of a record over the one of gravity, and velocity at its end over the largest one,
#: that are remarked on.
_STRONGEST, _DRIFT = 3.0, 0.2

#: Share of the longest stable step that explicit steps take; looks at their energy in a stage, and
#: energy that unstable steps gain, as a share of the largest one.
_STABLE, _SEEN, _GAINED = 0.9, 200, 0.2

#: Vector at a time since the start of the stage.
OfTime = Callable[[float], ndarray]


@dataclass(frozen=True)
class InTime:
    """Inertia of a stage.

    Attributes
    ----------
    settings
        The settings as given.
    M, C
        Mass and damping, (N, N).
    steps, step
        Number of steps, and their length; zero for explicit ones, which the run determines.
    points
        Dofs whose motion is recorded, (n, dim).
    base
        Motions of the base by axis, with the load by a unit of acceleration or, with rock, of
        velocity, (N,).
    of_rock
        True where the base moves rock below a viscous boundary.
    """

    settings: Dynamic
    M: csr_matrix
    C: csr_matrix
    steps: int
    step: float
    points: ndarray
    base: tuple[tuple[int, Record, ndarray], ...] = ()
    of_rock: bool = False

    def with_base(self, load: ndarray, time: float) -> ndarray:
        """Return a load at a time, with the motion of the base, (N,)."""
        for _, record, by_unit in self.base:
            moved = record.motion(time)[1] if self.of_rock else record.at(time)
            load = load + moved * by_unit
        return load

    def base_motion(self, time: float) -> ndarray:
        """Return displacement, velocity and acceleration of the supports, (3, dim)."""
        found = np.zeros((3, self.points.shape[1]))
        for axis, record, _ in self.base:
            found[:, axis] = record.motion(time)
        return found

    def form(self) -> Inertia:
        """Return the form of inertia and damping."""
        return Inertia(self.M, self.C, Scheme.of(self.settings.rho_inf))


def inertia_of(setup: Setup, stage: Stage, forms: Mapping[str, Form], fixed: ndarray) -> InTime:
    """Return the inertia of a stage.

    Raises
    ------
    ValueError
        Forms that inertia is not supported for, or masses that are not known; the message names
        the stage.
    """
    settings = stage.dynamic
    assert settings is not None
    try:
        check_forms(forms)
        g = setup.acceleration_of_gravity()
        _check_boundaries(forms, fixed, setup.layout)
        M, C = mass_and_damping(forms, setup.layout, settings, g)
        if M.nnz == 0:
            raise ValueError("no form has a mass: give the solids their unit_weight")
        points = _points(forms, settings.points)
        base = _base(setup, stage, forms, settings, M)
    except ValueError as error:
        raise ValueError(f"stage '{stage.name}': {error}") from None
    if settings.velocity is not None:
        setup.vector(settings.velocity, f"stage '{stage.name}': the velocity")
    absolute = any(form.of_rock for form in having(forms, Absorbing).values())
    if settings.explicit:
        return InTime(settings, M, C, 0, 0.0, points, base, absolute)
    steps = settings.steps(stage.duration)
    return InTime(settings, M, C, steps, stage.duration / steps, points, base, absolute)


def _base(
    setup: Setup, stage: Stage, forms: Mapping[str, Form], settings: Dynamic, M: csr_matrix
) -> tuple[tuple[int, Record, ndarray], ...]:
    """Return the motions of the base: axis, record, and load by a unit of its motion.

    Supports shake by their acceleration, rock by the velocity of its outcrop.
    """
    if stage.base is None:
        return ()
    given = stage.base if isinstance(stage.base, Mapping) else {"x": stage.base}
    of_rock = {k: form for k, form in having(forms, Absorbing).items() if form.of_rock}
    axes = "xyz"[: len(setup.layout.coordinates)]
    found = []
    for name, record in given.items():
        if name not in tuple(axes):
            raise ValueError(f"the base moves along one of {', '.join(axes)}, not {name!r}")
        if name == "x" and setup.coordinates == "axisymmetric":
            raise ValueError("in axial symmetry the base moves along y alone")
        if settings.step is not None and settings.step > record.step * (1.0 + 1e-9):
            raise ValueError(
                f"the step in time, {settings.step:g}, is longer than that of the record, "
                f"{record.step:g}, whose peaks it would miss: take record.resampled("
                f"{settings.step:g})"
            )
        axis = axes.index(name)
        rigid = translation(setup.layout, axis)
        load = -(M @ rigid)
        if of_rock:
            # rho v times the velocity of the outcrop, twice that of the arriving wave
            load = np.zeros(len(rigid))
            g = setup.acceleration_of_gravity()
            given_masses = Masses(g, False, {}, len(rigid))
            for form in of_rock.values():
                _, viscous = form.matrices(given_masses)
                load += padded(viscous, len(rigid)) @ rigid
        found.append((axis, record, load))
    return tuple(found)


def remarks_on_base(setup: Setup, stage: Stage) -> Iterator[Remark]:
    """Yield remarks on records in another unit, and on bases that move twice."""
    if stage.base is None or setup.gravity_acceleration is None:
        return
    given = stage.base if isinstance(stage.base, Mapping) else {"x": stage.base}
    for record in given.values():
        times = record.peak / setup.gravity_acceleration
        if times > _STRONGEST:
            yield Remark(
                "record",
                times,
                f"its record reaches {times:.3g} times the acceleration of gravity: is it in the "
                "units of the model? Otherwise take record.scaled(factor)",
            )
        end = abs(float(record.velocity[-1]))
        largest = float(np.abs(record.velocity).max())
        if end > _DRIFT * largest:
            yield Remark(
                "drift",
                end / largest,
                f"its record ends with {end / largest:.0%} of its largest velocity: take "
                "record.corrected(), or filter it",
            )
    if np.linalg.norm(setup.gravity) > 1.0 + 1e-6:
        yield Remark("twice", 0.0, "the model has a seismic coefficient, and its base moves, too")


def _check_boundaries(forms: Mapping[str, Form], fixed: ndarray, layout: Layout) -> None:
    """Refuse boundaries for waves that are held altogether: they would do nothing."""
    for name, form in having(forms, Absorbing).items():
        _, viscous = form.matrices(Masses(1.0, False, {}, layout.size))
        acting = np.flatnonzero(np.diff(viscous.indptr))
        if np.isin(acting, fixed).all():
            raise ValueError(
                f"all {len(acting)} dofs of '{name}' are held, where no wave can leave: take these "
                "supports away by Stage(fixed=...)"
            )


def check_forms(forms: Mapping[str, Form]) -> None:
    """Refuse water that flows, and materials that creep."""
    wet = list(having(forms, Wet))
    if wet:
        raise ValueError(
            f"inertia and water that flows are not supported together: deactivate {wet}; Undrained "
            "soil stands for saturated ground that shakes quickly"
        )
    for name, form in solids_of(forms).items():
        for region, material in form.materials.items():
            if material.time_dependent:
                raise ValueError(
                    f"'{region}' of '{name}' creeps ({type(material).__name__}), which inertia is "
                    "not supported with: change it to a material without creep for this stage"
                )


def _points(forms: Mapping[str, Form], given: Any) -> ndarray:
    """Return the dofs of the nodes whose motion is recorded, (n, dim)."""
    solids = list(solids_of(forms).values())
    if np.size(given) == 0:
        return np.zeros((0, 0), int)
    if not solids:
        raise ValueError("points to record are nodes of solids, and there is no solid")
    return dofs_at(solids[0].basis, given)


class Log:
    """Energies and motions of recorded nodes, step by step."""

    def __init__(self, system: System, in_time: InTime) -> None:
        self._pairs = set(having(system.forms, Touching))
        self._fixed = system.fixed
        self._M = in_time.M
        self._points = in_time.points
        self._rows: list[tuple[float, ...]] = []
        self._motions: list[ndarray] = []
        self._base: list[ndarray] = []
        self._in_time = in_time
        self._began = 0.0
        self._internal = self._contact = self._work = 0.0
        self._last: tuple[ndarray, ndarray, ndarray, ndarray, ndarray | None] | None = None

    def add(
        self, time: float, motion: Motion, load: ndarray, forces: Mapping[str, ndarray]
    ) -> None:
        """Record the end of a step, with the forces of all forms."""
        if not self._rows:
            self._began = time
        kinetic = 0.5 * float(motion.velocity @ (self._M @ motion.velocity))
        touching = [force for name, force in forces.items() if name in self._pairs]
        others = [force for name, force in forces.items() if name not in {*self._pairs, INERTIA}]
        bodies = others[0] if len(others) == 1 else np.sum(others, axis=0)
        pairs = np.sum(touching, axis=0) if touching else None
        at = self._fixed
        reaction = bodies[at] + motion.force[at] - load[at]
        if pairs is not None:
            reaction += pairs[at]
        now = load, reaction, bodies, pairs
        if self._last is not None:
            # The work of a mean force, exact for forces that change in proportion
            x, outer, held, inner, contact = self._last
            moved = motion.x - x
            self._work += 0.5 * (float(outer @ moved) + float(load @ moved))
            self._work += 0.5 * float((held + reaction) @ moved[at])
            self._internal += 0.5 * (float(inner @ moved) + float(bodies @ moved))
            if pairs is not None and contact is not None:
                self._contact += 0.5 * (float(contact @ moved) + float(pairs @ moved))
        self._last = (motion.x, *now)
        self._rows.append((time, kinetic, self._internal, self._contact, motion.damped, self._work))
        if self._points.size:
            at_points = (motion.x, motion.velocity, motion.acceleration)
            self._motions.append(np.array([values[self._points] for values in at_points]))
            if self._in_time.base and not self._in_time.of_rock:
                self._base.append(self._in_time.base_motion(time - self._began))

    def series(self) -> dict[str, ndarray]:
        """Return energies, (n, 6), motions, (n, 3, n_points, dim), and base, (n, 3, dim)."""
        found = {"energy": np.array(self._rows)}
        if self._motions:
            found["motion"] = np.array(self._motions)
            found["points"] = self._points
        if self._base:
            found["base"] = np.array(self._base)
        return found

    def gained(self) -> float:
        """Return the energy that comes from nowhere, as a share of the largest one."""
        _, kinetic, internal, contact, damped, work = self._rows[-1]
        first = self._rows[0][1]
        gained = kinetic + internal + contact + damped - first - work
        return gained / max(kinetic, abs(internal), first, abs(work), 1e-300)

    def missing(self) -> float:
        """Return the energy that the scheme has taken, as a share of the largest one."""
        _, kinetic, internal, contact, damped, work = np.array(self._rows).T
        lost = kinetic[0] + work[-1] - kinetic[-1] - internal[-1] - contact[-1] - damped[-1]
        largest = max(float(np.abs(each).max()) for each in (kinetic, internal, work))
        return float(lost / largest) if largest > 0.0 else 0.0

    def summary(self) -> str:
        """Return the kinetic energy, and the energy that the scheme has taken, in one line."""
        kinetic = np.array(self._rows)[:, 1]
        share = self.missing()
        return (
            f"kinetic energy {kinetic[-1]:.4g}, {round(share, 4) + 0.0:.2%} of the energy missing"
        )


def first_motion(
    in_time: InTime, last: StageResult, jump: ndarray, fixed: ndarray, layout: Layout
) -> Motion:
    """Return the motion at the start of a stage, with the acceleration by a jump of the load.

    M a_0 = load - F - C v_0; a stage that continues a motion adds the acceleration by the jump.
    """
    n = layout.size
    M = in_time.M
    force = np.zeros(n) if last.inertial is None else last.inertial
    given = in_time.settings.velocity
    if last.velocity is not None and given is None:
        more = accelerations(M, jump, fixed)
        a = last.acceleration + more
        return Motion(last.x, last.velocity, a, force + M @ more)
    v = np.zeros(n)
    if given is not None:
        v[: len(given)] = given
        v[fixed] = 0.0
    viscous = in_time.C @ v
    a = accelerations(M, force + jump - viscous, fixed)
    return Motion(last.x, v, a, M @ a + viscous)


def steps_of(
    stage: Stage,
    in_time: InTime,
    system: System,
    start: tuple[StageResult, Motion],
    path: Callable[[float], tuple[ndarray, ndarray]],
    newton: Newton,
    log: Log,
) -> Iterator[StageResult]:
    """Yield the accepted steps of a stage.

    Parameters
    ----------
    stage, in_time, system
        The stage, its inertia, and the system with the form of inertia.
    start
        State and motion at the start.
    path
        Load and prescribed values at a time since the start.
    newton
        Settings of Newton's method.
    log
        Records of energies and motions.
    """
    last, motion = start
    began = last.time
    load, _ = path(0.0)
    plain = {name: form for name, form in system.forms.items() if name != INERTIA}
    last = replace(last, layout=system.layout)
    responses = responses_of(plain, last.x, last.states)
    forces = {name: response.force for name, response in responses.items()}
    log.add(began, motion, load, forces)
    if in_time.settings.explicit:
        yield from _explicit_steps(stage, in_time, system, plain, (last, motion), path, log)
        return
    if is_linear(plain, last.x, last.states):
        yield from _linear_steps(in_time, system, plain, responses, (last, motion), path, log)
        return
    end = in_time.steps * _PARTS
    done, size = 0, _PARTS

    while done < end:
        # Solve a step
        h = in_time.step * size / _PARTS
        time = in_time.step * ((done + size) / _PARTS)
        load, prescribed = path(time)
        states = {**last.states, INERTIA: motion}
        ahead = motion.x + h * motion.velocity + 0.5 * h**2 * motion.acceleration
        ahead[system.fixed] = prescribed
        begin = ahead if size == _PARTS else None
        step = Step(system.over(h), last.x, states, load, prescribed, begin)
        try:
            new = solve_increment(step, newton)
        except NotConverged as error:
            logger.info("stage '%s': step to time %.6g failed: %s", stage.name, time, error)
            size //= _CUT
            if size == 0:
                raise NotConverged(
                    f"stage '{stage.name}' stopped at the time {last.time:.6g}, "
                    f"{done / end:.2%} of its duration, where steps of 1/{_PARTS} of "
                    f"{in_time.step:g} find no equilibrium: {error}"
                ) from error
            continue

        # Accept it
        done += size
        motion = new.states[INERTIA]
        last = _accepted(last, plain, step, new, done / end, began + time)
        log.add(last.time, motion, load, new.forces)
        yield last
        if size < _PARTS and done % (_GROWTH * size) == 0:
            size *= _GROWTH


def _linear_steps(
    in_time: InTime,
    system: System,
    forms: Mapping[str, Form],
    responses: Mapping[str, Response],
    start: tuple[StageResult, Motion],
    path: Callable[[float], tuple[ndarray, ndarray]],
    log: Log,
) -> Iterator[StageResult]:
    """Yield the steps of a linear model, whose states are computed where somebody asks for them."""
    last, motion = start
    began = last.time
    states = last.states
    inertia = in_time.form().over(in_time.step)
    model = Linear(system, inertia, responses, motion, in_time.step)

    for k in range(1, in_time.steps + 1):
        time = k * in_time.step
        load, prescribed = path(time)
        motion = model.step(motion, load, prescribed)
        log.add(began + time, motion, load, {"": model.force})
        found = Lazy(forms, partial(_states_at, forms, motion.x, states))
        last = _unchecked(last, forms, motion, load, found, k / in_time.steps, began + time)
        if k == in_time.steps:
            last = _complete(last)
        yield last


def _explicit_steps(
    stage: Stage,
    in_time: InTime,
    system: System,
    forms: Mapping[str, Form],
    start: tuple[StageResult, Motion],
    path: Callable[[float], tuple[ndarray, ndarray]],
    log: Log,
) -> Iterator[StageResult]:
    """Yield explicit steps, whose number follows from the longest stable one."""
    # Choose the steps
    last, motion = start
    began = last.time
    settings = in_time.settings
    try:
        model = Explicit(forms, system.layout, in_time.M, in_time.C, system.fixed, last)
    except ValueError as error:
        raise ValueError(f"stage '{stage.name}': {error}") from None
    if settings.step is not None and settings.step > model.critical:
        raise ValueError(
            f"stage '{stage.name}': the step in time, {settings.step:.4g}, is longer than the "
            f"longest stable one, {model.critical:.4g}: shorten it, or take implicit steps"
        )
    steps = settings.steps(stage.duration, _STABLE * model.critical)
    h = model.length = stage.duration / steps
    logger.info("stage '%s': %d explicit steps of %.4g", stage.name, steps, h)
    every = max(1, steps // _SEEN)

    for k in range(1, steps + 1):
        # Take a step, and look at its energy now and then
        load, prescribed = path(k * h)
        motion, forces = model.step(motion, load, prescribed)
        log.add(began + k * h, motion, load, forces)
        if k % every == 0 and log.gained() > _GAINED:
            raise NotConverged(
                f"stage '{stage.name}' gains energy at the time {began + k * h:.6g}: steps of "
                f"{h:.4g} are too long for the stiffness of its contacts or materials; give a "
                "shorter Dynamic(step=...)",
                motion.x,
            )
        linear = partial(_states_at, model.linear, motion.x, start[0].states)
        found: Mapping[str, Any] = {**model.states}
        if model.linear:
            found = ChainMap(dict(model.states), Lazy(model.linear, linear))  # type: ignore[arg-type]
        last = _unchecked(last, forms, motion, load, found, k / steps, began + k * h)
        if k == steps:
            last = _complete(last)
        yield last


def _unchecked(
    last: StageResult,
    forms: Mapping[str, Form],
    motion: Motion,
    load: ndarray,
    states: Mapping[str, Any],
    fraction: float,
    time: float,
) -> StageResult:
    """Return the result of a step, as a copy: checks of a new one would compute the states."""
    new = copy(last)
    vars(new).update(
        x=motion.x,
        load=load,
        states=states,
        iterations=(*last.iterations, 1),
        residual=0.0,
        fraction=fraction,
        summary=Lazy(forms, partial(summaries, forms, motion.x, states)),
        forms=forms,
        time=time,
        before=None,
        velocity=motion.velocity,
        acceleration=motion.acceleration,
        inertial=motion.force,
    )
    return new


def _complete(last: StageResult) -> StageResult:
    """Return the result of the last step with its states and its summary computed."""
    return replace(last, states=dict(last.states), summary=dict(last.summary))


def _states_at(forms: Mapping[str, Form], x: ndarray, states: Mapping[str, Any]) -> dict[str, Any]:
    """Return the states of forms without memory at displacements."""
    return {name: form.assemble(x[: form.size], states[name]).state for name, form in forms.items()}


def _accepted(
    last: StageResult,
    forms: Mapping[str, Form],
    step: Step,
    new: Equilibrium,
    fraction: float,
    time: float,
) -> StageResult:
    """Return the result of a step that follows the last one."""
    states = {name: state for name, state in new.states.items() if name != INERTIA}
    motion = new.states[INERTIA]
    return replace(
        last,
        x=new.x,
        load=step.load,
        states=states,
        iterations=(*last.iterations, new.iterations),
        residual=new.residuals[-1],
        fraction=fraction,
        summary=summaries(forms, new.x, states),
        forms=forms,
        time=time,
        layout=step.system.layout,
        before=None,
        velocity=motion.velocity,
        acceleration=motion.acceleration,
        inertial=motion.force,
    )
