"""Stages in time: their masses and loads, and the steps that follow each other."""

from __future__ import annotations

import logging
from collections import ChainMap
from collections.abc import Callable, Iterator, Mapping
from copy import copy
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import combinations
from typing import Any, NamedTuple

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix
from typing_extensions import override

from ..arrays import max_abs
from ..contact.laws import Status
from ..dynamics.boundaries import Masses
from ..dynamics.explicit import Explicit
from ..dynamics.linear import Linear, is_linear
from ..dynamics.mass import accelerations, mass_and_damping, to_neighbours, translation
from ..dynamics.record import Record
from ..dynamics.scheme import Inertia, Motion, Scheme
from ..dynamics.settings import Dynamic
from ..dynamics.steps import Steps
from ..errors import NotConverged, Remark
from ..forms.base import Forms, Response, States, responses_of, solids_of, summaries
from ..forms.roles import Absorbing, Body, Touching, having
from ..layout import Layout
from ..nonlinear.increment import solve_increment
from ..nonlinear.newton import Newton
from ..nonlinear.step import Step
from ..nonlinear.system import System
from ..results.motion import Counts, Lazy
from ..results.stage import StageResult
from ..sparse import padded
from .energies import INERTIA, Log
from .saturated import check_base, pores_in_motion
from .setup import Setup
from .stage import Stage
from .supports import check_pairs

logger = logging.getLogger("skfem_contact")

#: Acceleration of a record over the one of gravity, and velocity at its end over the largest one,
#: that are remarked on.
_STRONGEST = 3.0
_DRIFT = 0.2

#: Share of the longest stable step that explicit steps take; looks at their energy in a stage, and
#: energy that unstable steps gain, as a share of the largest one.
_STABLE = 0.9
_SEEN = 200
_GAINED = 0.2
#: Steps before energies are compared: where a load begins at zero and rises as t or t², that of
#: velocities is ahead of the work by 25 and 44 % in the second step, 1 and 2 % in the tenth.
_BEGINNING = 10

#: Share of the load that the digits of displacements may hide in short steps.
_LOST = 1e-3


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
    transit
        Time of a wave through an element.
    wet
        Forms of water in motion.
    lag
        Time in which their water speeds up.
    carried : csr_matrix, optional
        Motion of contact nodes without mass by that of the neighbours that have it, (N, N).
    """

    settings: Dynamic
    M: csr_matrix
    C: csr_matrix
    steps: int
    step: float
    points: ndarray
    base: tuple[tuple[int, Record, ndarray], ...] = ()
    of_rock: bool = False
    transit: float = np.inf
    wet: Forms = field(default_factory=dict)
    lag: float = 0.0
    carried: csr_matrix | None = None

    def with_base(self, load: ndarray, time: float) -> ndarray:
        """Return a load at a time, with the motion of the base, (N,)."""
        for _, record, by_unit in self.base:
            if self.of_rock:
                moved = record.motion(time)[1]
            else:
                moved = record.at(time)
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


def inertia_of(setup: Setup, stage: Stage, forms: Forms, fixed: ndarray) -> InTime | None:
    """Return the inertia of a stage.

    Raises
    ------
    ValueError
        Forms that inertia is not supported for, or masses that are not known; the message names
        the stage.
    """
    settings = stage.dynamic
    if settings is None:
        return None
    # Make the matrices and the motion of the base.
    try:
        check_materials(forms)
        check_pairs(forms)
        g = setup.acceleration_of_gravity()
        _check_boundaries(forms, fixed, setup.layout)
        M, C = mass_and_damping(forms, setup.layout, settings, g)
        if M.nnz == 0:
            raise ValueError("no form has a mass: give the solids their unit_weight")
        points = _points(forms, setup.layout, settings.points)
        base = _base(setup, stage, forms, settings, M)
        wet, lag = pores_in_motion(forms, settings, g)
        check_base(lag, [record for _, record, _ in base])
    except ValueError as error:
        raise ValueError(f"stage '{stage.name}': {error}") from None
    # Check the start, and choose the steps.
    if settings.velocity is not None:
        setup.vector(settings.velocity, f"stage '{stage.name}': the velocity")
    absolute = any(form.of_rock for form in having(forms, Absorbing).values())
    if settings.explicit:
        return InTime(
            settings,
            M,
            C,
            0,
            0.0,
            points,
            base,
            absolute,
        )
    steps = settings.steps(stage.duration)
    carried = None
    if settings.moves_contact_mass:
        carried = to_neighbours(forms, setup.layout.size)
    return InTime(
        settings,
        M,
        C,
        steps=steps,
        step=stage.duration / steps,
        points=points,
        base=base,
        of_rock=absolute,
        transit=_transit(forms, g),
        wet=wet,
        lag=lag,
        carried=carried,
    )


def _base(
    setup: Setup,
    stage: Stage,
    forms: Forms,
    settings: Dynamic,
    M: csr_matrix,
) -> tuple[tuple[int, Record, ndarray], ...]:
    """Return the motions of the base: axis, record, and load by a unit of its motion.

    Supports shake by their acceleration, rock by the velocity of its outcrop.
    """
    # Records act on rigid bases as inertia, on rock as the wave that arrives.
    of_rock = {k: form for k, form in having(forms, Absorbing).items() if form.of_rock}
    axes = "xyz"[: len(setup.layout.coordinates)]
    found = []
    for name, record in _records(stage).items():
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


def _records(stage: Stage) -> Mapping[str, Any]:
    """Return the records of a base that moves, by their axes."""
    if stage.base is None or isinstance(stage.base, Mapping):
        return stage.base or {}
    return {"x": stage.base}


def remarks_on_base(setup: Setup, stage: Stage) -> Iterator[Remark]:
    """Yield remarks on records in another unit, and on bases that move twice."""
    records = _records(stage).values()
    if not records or setup.gravity_acceleration is None:
        return
    # Report records in another unit.
    for record in records:
        times = record.peak / setup.gravity_acceleration
        if times > _STRONGEST:
            yield Remark(
                "record",
                times,
                f"its record reaches {times:.3g} times the acceleration of gravity: is it in the "
                "units of the model? Otherwise take record.scaled(factor)",
            )
        # Report records that do not end at rest.
        end = abs(float(record.velocity[-1]))
        largest = max_abs(record.velocity)
        if end > _DRIFT * largest:
            yield Remark(
                "drift",
                end / largest,
                f"its record ends with {end / largest:.0%} of its largest velocity: take "
                "record.corrected(), or filter it",
            )
    if np.linalg.norm(setup.gravity) > 1.0 + 1e-6:
        yield Remark("twice", 0.0, "the model has a seismic coefficient, and its base moves, too")


def _check_boundaries(forms: Forms, fixed: ndarray, layout: Layout) -> None:
    """Refuse boundaries for waves that are held altogether: they would do nothing."""
    for name, form in having(forms, Absorbing).items():
        _, viscous = form.matrices(Masses(1.0, False, {}, layout.size))
        acting = np.flatnonzero(np.diff(viscous.indptr))
        if not len(acting):
            raise ValueError(
                f"the ground at '{name}' has no stiffness or no weight, so that no wave can leave: "
                "give its material and unit_weight, or leave the boundary out"
            )
        if np.isin(acting, fixed).all():
            raise ValueError(
                f"all {len(acting)} dofs of '{name}' are held, where no wave can leave: take these "
                "supports away by Stage(fixed=...)"
            )
    for (one, first), (other, second) in combinations(having(forms, Absorbing).items(), 2):
        common = len(np.intersect1d(first.absorbs_at, second.absorbs_at))
        if common:
            raise ValueError(
                f"waves leave twice at {common} facets, through '{one}' and '{other}': leave one "
                "out; a free field has dashpots of its own"
            )


def check_materials(forms: Forms) -> None:
    """Refuse materials that creep."""
    for name, form in solids_of(forms).items():
        for region, material in form.materials.items():
            if material.time_dependent:
                raise ValueError(
                    f"'{region}' of '{name}' creeps ({type(material).__name__}), which inertia is "
                    "not supported with: change it to a material without creep for this stage"
                )


def _points(forms: Forms, layout: Layout, given: Any) -> ndarray:
    """Return the dofs of the nodes whose motion is recorded, (n, dim)."""
    if isinstance(given, ndarray):
        given = given.tolist()
    if isinstance(given, list | tuple) and len(given) == 0:
        return np.zeros((0, 0), int)
    bases = [solid.basis for solid in solids_of(forms).values()]
    return layout.moves_of(bases[0] if bases else None, given)


def first_motion(
    in_time: InTime,
    last: StageResult,
    jump: ndarray,
    fixed: ndarray,
    layout: Layout,
) -> Motion:
    """Return the motion at the start of a stage, with the acceleration by a jump of the load.

    M a_0 = load - F - C v_0; a stage that continues a motion adds the acceleration by the jump.
    Forces on contact nodes without mass move the neighbours that have it.
    """
    n = layout.size
    M = in_time.M
    force = np.zeros(n) if last.inertial is None else last.inertial

    def started(forces: ndarray) -> ndarray:
        """Return the accelerations by forces."""
        if in_time.carried is not None:
            free = forces.copy()
            free[fixed] = 0.0
            forces = in_time.carried.T @ free
        return accelerations(M, forces, fixed)

    # A stage in time continues the last one; a jump of the load changes the acceleration.
    given = in_time.settings.velocity
    if last.velocity is not None and given is None:
        more = started(jump)
        a = last.acceleration + more
        return Motion(last.x, last.velocity, a, force + M @ more)
    # Other stages begin at rest, or with a given velocity.
    v = np.zeros(n)
    if given is not None:
        v[: len(given)] = given
        v[fixed] = 0.0
    viscous = in_time.C @ v
    a = started(force + jump - viscous)
    return Motion(last.x, v, a, M @ a + viscous)


class _Taken(NamedTuple):
    """A step: its motion, internal forces by form, states and iterations."""

    motion: Motion
    forces: Mapping[str, ndarray]
    states: States
    iterations: int = 1
    residual: float = 0.0


class _Iterated:
    """Steps by Newton's method."""

    cuts = True

    def __init__(self, system: System, forms: Forms, newton: Newton) -> None:
        self._system = system
        self._newton = newton
        self._forms = forms

    def begun(self, last: StageResult) -> dict[str, ndarray]:
        """Return the internal forces at the start."""
        responses = responses_of(self._forms, last.x, last.states)
        return {name: response.force for name, response in responses.items()}

    def take(
        self,
        last: StageResult,
        motion: Motion,
        steps: Steps,
        load: ndarray,
        prescribed: ndarray,
    ) -> _Taken:
        """Take a step."""
        h = steps.length
        states = {**last.states, INERTIA: motion}
        ahead = None
        if not steps.failed:
            # Begin where a constant acceleration leads.
            ahead = motion.x + h * motion.velocity + 0.5 * h**2 * motion.acceleration
            ahead[self._system.fixed] = prescribed
        # Digits of the displacements limit the inertia of short steps
        system = self._system.over(h)
        size = float(np.linalg.norm(load))
        inertia = system.forms[INERTIA]
        assert isinstance(inertia, Inertia)
        lost = inertia.lost(motion.x)
        tolerance = max(self._newton.tolerance, min(lost, _LOST * size) / max(size, 1e-300))
        step = Step(system, last.x, states, load, prescribed, ahead)
        new = solve_increment(step, replace(self._newton, tolerance=tolerance))
        found = dict(new.states)
        moved = found.pop(INERTIA)
        forces = dict(new.forces)
        del forces[INERTIA]
        return _Taken(moved, forces, found, new.iterations, new.residuals[-1])

    def check(self, taken: int, log: Log) -> None:
        """Check the energy now and then."""


class _LinearSteps(_Iterated):
    """Steps of a linear model, whose states are computed where somebody asks for them."""

    def __init__(self, system: System, forms: Forms, in_time: InTime) -> None:
        super().__init__(system, forms, Newton())
        self._inertia = in_time.form()
        self._model: Linear | None = None
        self._start: Mapping[str, Any] = {}
        self._responses: Mapping[str, Response] = {}

    @override
    def begun(self, last: StageResult) -> dict[str, ndarray]:
        self._start = last.states
        self._responses = responses_of(self._forms, last.x, last.states)
        return {"": np.sum([response.force for response in self._responses.values()], axis=0)}

    @override
    def take(
        self,
        last: StageResult,
        motion: Motion,
        steps: Steps,
        load: ndarray,
        prescribed: ndarray,
    ) -> _Taken:
        h = steps.length
        if self._model is None:
            inertia = self._inertia.over(h)
            self._model = Linear(self._system, inertia, self._responses, motion, h)
        elif self._model.length != h:
            self._model = self._model.with_step(motion, h)
        moved = self._model.step(motion, load, prescribed)
        states = Lazy(self._forms, partial(_states_at, self._forms, moved.x, self._start))
        return _Taken(moved, {"": self._model.force}, states)


class _ExplicitSteps(_Iterated):
    """Explicit steps, whose number follows from the longest stable one."""

    cuts = False

    def __init__(
        self,
        system: System,
        forms: Forms,
        in_time: InTime,
        last: StageResult,
    ) -> None:
        super().__init__(system, forms, Newton())
        M = in_time.M
        C = in_time.C
        self._model = Explicit(forms, system.layout, M, C, system.fixed, last)
        self._start = last.states
        self._every = 1

    def steps(self, stage: Stage, settings: Dynamic) -> tuple[float, int]:
        """Return the length and the number of the steps of a stage."""
        critical = self._model.critical
        if settings.step is not None and settings.step > critical:
            raise ValueError(
                f"the step in time, {settings.step:.4g}, is longer than the longest stable one, "
                f"{critical:.4g}: shorten it, or take implicit steps"
            )
        number = settings.steps(stage.duration, _STABLE * critical)
        self._model.length = stage.duration / number
        self._every = max(1, number // _SEEN)
        logger.info("stage '%s': %d explicit steps of %.4g", stage.name, number, self._model.length)
        return self._model.length, number

    @override
    def begun(self, last: StageResult) -> dict[str, ndarray]:
        return self._model.forces(last.x)[0]

    @override
    def take(
        self,
        last: StageResult,
        motion: Motion,
        steps: Steps,
        load: ndarray,
        prescribed: ndarray,
    ) -> _Taken:
        moved, forces = self._model.step(motion, load, prescribed)
        states: States = {**self._model.states}
        linear = self._model.linear
        if linear:
            rest = Lazy(linear, partial(_states_at, linear, moved.x, self._start))
            states = ChainMap({**self._model.states}, rest)  # type: ignore[arg-type]
        return _Taken(moved, forces, states)

    @override
    def check(self, taken: int, log: Log) -> None:
        is_seen = taken > _BEGINNING and taken % self._every == 0
        if is_seen and log.gained() > _GAINED:
            raise NotConverged(
                f"it gains energy: steps of {self._model.length:.4g} are too long for the "
                "stiffness of its contacts or materials; give a shorter Dynamic(step=...)"
            )


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
    settings = in_time.settings
    forms = {name: form for name, form in system.forms.items() if name != INERTIA}
    method, longest, number = _method_of(stage, in_time, system, forms, last, newton)
    scheme = Scheme.of(settings.rho_inf)
    steps = Steps(
        longest,
        number,
        settings.tolerance,
        scheme,
        in_time.M,
        last.x,
        in_time.transit,
    )

    # Follow the steps
    began = last.time
    log.add(began, motion, path(0.0)[0], method.begun(last))
    while not steps.finished:
        time = steps.time
        load, prescribed = path(time)
        try:
            taken = method.take(last, motion, steps, load, prescribed)
            # Steps of one length need no look at contact.
            changed = 0.0
            if settings.tolerance is not None:
                changed = _changed(forms, last.states, taken.states)
            if steps.refuses(motion, taken.motion, changed):
                logger.info("stage '%s': step to time %.6g errs, cut", stage.name, time)
                continue
            steps.accept()
            motion = taken.motion
            log.add(began + time, motion, load, taken.forces, taken.states)
            method.check(len(last.iterations) + 1, log)
        except NotConverged as error:
            logger.info("stage '%s': step to time %.6g failed: %s", stage.name, time, error)
            where = f"stage '{stage.name}' stopped at the time {last.time:.6g}"
            if not method.cuts:
                error.args = (f"{where}: {error}",)
                raise
            steps.cut(error, where)
            continue
        last = _after(last, forms, taken, load, steps.fraction, began + time)
        if steps.finished:
            last = _complete(last)
        yield last


def _method_of(
    stage: Stage,
    in_time: InTime,
    system: System,
    forms: Forms,
    last: StageResult,
    newton: Newton,
) -> tuple[_Iterated, float, int]:
    """Return the method of the steps of a stage, their length and their number."""
    if in_time.settings.explicit:
        try:
            explicit = _ExplicitSteps(system, forms, in_time, last)
            return explicit, *explicit.steps(stage, in_time.settings)
        except ValueError as error:
            raise ValueError(f"stage '{stage.name}': {error}") from None
    method = _Iterated(system, forms, newton)
    if is_linear(forms, last.x, last.states):
        method = _LinearSteps(system, forms, in_time)
    return method, in_time.step, in_time.steps


def _changed(forms: Forms, before: States, after: States) -> float:
    """Return the largest share of the points of a pair that a step has closed or opened."""
    shares = [0.0]
    for name in having(forms, Touching):
        closed = [np.mean(states[name].status != Status.OPEN) for states in (before, after)]
        shares.append(abs(float(closed[1] - closed[0])))
    return max(shares)


def _after(
    last: StageResult,
    forms: Forms,
    taken: _Taken,
    load: ndarray,
    fraction: float,
    time: float,
) -> StageResult:
    """Return the result of a step, as a copy: checks of a new one would compute the states."""
    motion = taken.motion
    counts = last.iterations
    if not isinstance(counts, Counts):
        counts = Counts(counts)
    new = copy(last)
    vars(new).update(
        x=motion.x,
        load=load,
        states=taken.states,
        iterations=counts.followed_by(taken.iterations),
        residual=taken.residual,
        fraction=fraction,
        summary=Lazy(forms, partial(summaries, forms, motion.x, taken.states)),
        time=time,
        velocity=motion.velocity,
        acceleration=motion.acceleration,
        inertial=motion.force,
    )
    return new


def _complete(last: StageResult) -> StageResult:
    """Return the result of the last step with its states and its summary computed."""
    return replace(
        last,
        states=dict(last.states),
        summary=dict(last.summary),
        iterations=tuple(last.iterations),
    )


def _states_at(forms: Forms, x: ndarray, states: States) -> dict[str, Any]:
    """Return the states of forms without memory at displacements."""
    return {name: form.assemble(x[: form.size], states[name]).state for name, form in forms.items()}


def _transit(forms: Forms, acceleration: float) -> float:
    """Return the time of a wave through an element, the median of the solid with the least one."""
    times = [np.inf]
    for form in having(forms, Body).values():
        weights = getattr(form, "unit_weights", np.zeros(0))
        heavy = np.flatnonzero(weights > 0.0)
        if not len(heavy):
            continue
        # Size of an element over the velocity of pressure waves in it.
        volume = form.basis.dx.sum(axis=1)[heavy]
        size = volume ** (1.0 / form.basis.mesh.dim())
        velocity = np.sqrt(form.elastic_moduli[heavy, 0, 0] * acceleration / weights[heavy])
        times.append(float(np.median(size / velocity)))
    return min(times)
