"""Stages of an analysis, that follow each other: each starts from what the bodies carry."""
from __future__ import annotations

import logging
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy import ndarray

from ..display import progress_bar
from ..errors import NotConverged, Remarks, is_number, place
from ..forms.base import Form, as_forms
from ..nonlinear.newton import Newton
from ..nonlinear.stepping import Predictor, Stepping
from ..nonlinear.system import System
from ..nonlinear.time_steps import solve_step
from ..results.result import Result, StageResult
from ..solvers.threads import single_threaded
from .activation import Phase, among, begin, check_start, plan, state_changes
from .setup import system_of
from .supports import as_unknowns

logger = logging.getLogger("skfem_contact")


@dataclass(frozen=True)
class Stage:
    """A stage of the analysis.

    Parameters
    ----------
    name
        Its name in the result.
    load
        External forces at its end, (N,): the whole load, not the increment.
    prescribed
        Displacements at its end, (N,), of which the values at the fixed unknowns count.  By default they
        stay where they are.
    increments
        Number of increments to begin with; they are cut where Newton fails and grow where it is easy.
    activate
        Names of forms that become active; they are inactive before. Solids start stress-free in the deformed ground:
        nodes that they share with it are where it has brought them, the others follow. Water starts without excess
        pressure where none was active. Contact starts without traction, with the gaps of the mesh; but where it
        replaces a pair between the same surfaces that is deactivated in this stage, it takes over its tractions.
    deactivate
        Names of forms that are taken away. What they carried is released in proportion over the stage.
    change
        Forms that are replaced from this stage on, with other materials (``form.with_materials``) or another law
        (``pair.with_law``). They go on from what the old ones carry.
    fixed
        Supported unknowns from this stage on; by default those of the stage before. Reactions that are lost are
        released in proportion over the stage.
    duration
        Time that the stage takes, for forms to which it matters (:meth:`Form.over`); load and prescribed displacements
        go from their last values to those of the stage in proportion to it. Beside :class:`PoreWater` increments are
        cut and grow with their estimated error in time, too.

    Notes
    -----
    Nodes of bodies that are not there stay where they are, and no load may act on them.

    Examples
    --------
    A column on which a layer is placed, and from which it is taken away again:

    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> mesh = MeshQuad().refined(1).with_defaults().with_subdomains({
    ...     "ground": lambda x: x[1] < .5, "fill": lambda x: x[1] > .5})
    >>> basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    >>> soil = sc.LinearElastic(E=1e3, nu=0.)
    >>> forms = {name: sc.SolidForm(basis.with_elements(name), soil) for name in ("ground", "fill")}
    >>> ground, both = sc.weight(basis, {"ground": 20.}), sc.weight(basis, 20.)
    >>> stages = [sc.Stage("ground", ground), sc.Stage("filled", both, activate="fill"),
    ...           sc.Stage("cleared", ground, deactivate="fill")]
    >>> result = sc.Model(forms, basis.get_dofs("bottom").all()).run(stages)
    >>> surface = basis.nodal_dofs[1, mesh.p[1] == .5]
    >>> [float(f"{stage.x[surface][0]:.6f}") for stage in result]
    [-0.0025, -0.0075, -0.0025]
    """

    name: str
    load: ndarray
    prescribed: ndarray | None = None
    increments: int = 1
    activate: str | Sequence[str] = ()
    deactivate: str | Sequence[str] = ()
    change: Mapping[str, Form] = field(default_factory=dict)
    fixed: ndarray | None = None
    duration: float = 0.0


@single_threaded
def run(forms: Mapping[str, Any], stages: Sequence[Stage], fixed: ndarray,
        start: Result | StageResult | None = None,
        newton: Newton | None = None, solver: Any = None, progress: bool | None = None) -> Result:
    """Run stages one after the other.

    Parameters
    ----------
    forms
        Solids and contact pairs by name, those included that are there in some stages only.
    stages
        Stages in their order.
    fixed
        Layout that are held (or moved by ``Stage.prescribed``).
    start
        Result to go on from, whose last stage is where the first stage starts, or one stage of a result. Forms that
        it does not hold are inactive.
    newton
        Settings of Newton's method.
    solver
        A scikit-fem linear solver ``(A, b) -> x``, or ``"amg"``, algebraic multigrid by pyamg. By default a direct
        solver with an ordering of its own; for large bodies in space multigrid where it is faster and installed.
    progress
        Show a progress bar; by default where the output is a terminal.

    Returns
    -------
    Result
        The stages of ``start``, if any, and the new ones.

    Raises
    ------
    ValueError
        Bad input, before anything is computed: sizes, NaN, names that do not exist or that two stages would have, and
        in any stage a body that nothing holds.
    NotConverged
        With the partial result, whose last entry is the last increment that was accepted; so has the
        ``KeyboardInterrupt`` of a run that is stopped by hand, as its attribute ``result``.

    Warns
    -----
    AnalysisWarning
        What the forms remark on their states, each kind once; stages and supports that change nothing.

    Examples
    --------
    A square under its own weight:

    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> basis = Basis(MeshQuad().refined(2).with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    >>> forms = {"square": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.))}
    >>> fixed = basis.get_dofs("bottom").all()
    >>> result = sc.Model(forms, fixed).run([sc.Stage("gravity", sc.weight(basis, 20.))])
    >>> print(result)
    stage            increments  iterations  residual  load    state
    gravity                   1           1   ...  100%
    """
    given, stages = as_forms(forms), _checked(stages, start, newton)
    done = [start] if isinstance(start, StageResult) else list(start or ())
    _check_names(stages, [stage.name for stage in done])
    phases = plan(given, stages, as_unknowns(fixed), done[-1] if done else None)
    last = among(done[-1], phases[0].unknowns) if done else _nothing(phases[0])
    if done:
        check_start(phases[0].before, last)
    with Remarks(stacklevel=3) as remarks:
        for stage, phase in zip(stages, phases, strict=True):
            released = np.zeros(len(last.x))
            if phase.changed or (stage is stages[0] and state_changes(phase, last)):
                x, states, released = begin(phase, last)
                last = replace(last, x=x, states=states)
            if phase.changed or stage is stages[0]:
                system = system_of(phase.forms, phase.fixed, phase.unknowns, solver)
                predictor = Predictor(system.fixed)
                predictor.accept(last.x, last.load, last.time)
            remarks.add(stage.name, "the stage", phase.remarks)
            last = replace(last, name=stage.name, iterations=(), fraction=0.0, forms=system.forms)
            try:
                with progress_bar(progress, total=1.0, desc=stage.name,
                                  bar_format="{desc:16} {percentage:3.0f}% |{bar}|{postfix}") as bar:
                    for accepted in _increments(system, predictor, stage, phase, last, released, newton or Newton()):
                        last = accepted
                        bar.update(last.fraction - bar.n)
                        bar.set_postfix_str(f"{len(last.iterations)} increments, {sum(last.iterations)} iterations")
            except (NotConverged, KeyboardInterrupt) as error:
                error.result = Result((*done, last))  # type: ignore[union-attr]
                raise
            finally:  # what contact found, or did not find, may be the reason
                for name, form in system.forms.items():
                    remarks.add(stage.name, name, form.remarks(last.x[:form.size], last.states[name]))
            done.append(last)
    return Result(tuple(done))


def _increments(system: System, predictor: Predictor, stage: Stage, phase: Phase, last: StageResult,
                released: ndarray, newton: Newton) -> Iterator[StageResult]:
    """Accepted increments of a stage, one after the other."""
    path = _path(stage, phase, last.load, last.x[system.fixed], released)
    stepping, began = Stepping(stage.increments), last.time
    while last.fraction < 1.0:
        fraction = stepping.fraction
        time = began + fraction * stage.duration
        start = None if stepping.cut else predictor.start(*path(fraction), time)
        try:
            new, errors = solve_step(system, last.x, last.states, path, (last.fraction, fraction), stage.duration,
                                     newton, start, stepping.try_recovery)
        except NotConverged as error:
            stepping.reject(error)
            logger.info("stage '%s': increment to %.4f failed, cut to %.4f: %s", stage.name, fraction, stepping.size,
                        error)
            if stepping.exhausted:
                where = _place(system, error.dof)
                raise NotConverged(f"stage '{stage.name}' {stepping}: {error}{where}{_so_far(system, last)}") from error
            continue
        if stepping.too_long(errors):
            logger.info("stage '%s': step to %.3g too long, cut to %.4f", stage.name, time, stepping.size)
            continue
        logger.info("stage '%s': %.2f%% in %d iterations", stage.name, 100 * fraction, new.iterations)
        stepping.accept(fraction, new.iterations, new.equilibria)
        load, _ = path(fraction)
        summary = {name: form.summary(new.states[name]) for name, form in system.forms.items()}
        last = StageResult(stage.name, new.x, load, new.states, (*last.iterations, new.iterations),
                           new.residuals[-1], fraction, summary, system.forms, time)
        predictor.accept(last.x, last.load, time)
        yield last


def _path(stage: Stage, phase: Phase, load: ndarray, held: ndarray, released: ndarray
          ) -> Callable[[float], tuple[ndarray, ndarray]]:
    """Loads and prescribed values at a share of a stage; forces of what has gone are released in proportion."""
    target = held if phase.prescribed is None else phase.prescribed[phase.fixed]

    def at(fraction: float) -> tuple[ndarray, ndarray]:
        return load + fraction * (phase.load - load) - (1.0 - fraction) * released, held + fraction * (target - held)

    return at


def _place(system: System, unknown: int | None) -> str:
    """Where an unknown is, and what it is unless a displacement, for a message."""
    if unknown is None:
        return ""
    field = next(field for field in reversed(system.unknowns.fields) if field.first <= unknown)
    what = f"the {field.name} " if field.first else ""
    return f", {what}at {place(system.unknowns.places[:, unknown])}"


def _so_far(system: System, last: StageResult) -> str:
    """What the bodies carried when it was accepted last, for a message."""
    carried = {name: form.summary(last.states[name]) for name, form in system.forms.items()}
    carries = "; ".join(f"{name}: {text}" for name, text in carried.items() if text)
    return f". Accepted last: {carries}" if carries else ""


def _nothing(phase: Phase) -> StageResult:
    """What the first stage starts from: nothing has moved, nothing is loaded."""
    states, n = {name: form.initial_state() for name, form in phase.forms.items()}, phase.unknowns.size
    return StageResult("start", np.zeros(n), np.zeros(n), states, (), 0.0)


def _checked(stages: Sequence[Stage], start: Any, newton: Any) -> Sequence[Stage]:
    """The stages; one clear error before the analysis starts."""
    if not isinstance(stages, Sequence):
        raise ValueError(f"stages must be a list; write [Stage(...)], not {type(stages).__name__}")
    if wrong := next((stage for stage in stages if not isinstance(stage, Stage)), None):
        raise ValueError(f"stages must be a list of Stage(...), not of {type(wrong).__name__}")
    if not stages:
        raise ValueError("there is no stage to run")
    if not isinstance(start, Result | StageResult | None):
        raise ValueError(f"start must be a result or a stage of one, not {start!r}")
    if not isinstance(newton, Newton | None):
        raise ValueError(f"newton must be settings Newton(...), not {newton!r}")
    return stages


def _check_names(stages: Sequence[Stage], before: list[str]) -> None:
    """No two stages have the same name, increments and durations are numbers."""
    names = before + [stage.name for stage in stages]
    for stage in stages:
        if names.count(stage.name) > 1:
            which = "the start has a stage of the name" if stage.name in before else "two stages are named"
            raise ValueError(f"{which} '{stage.name}'")
        if not isinstance(stage.increments, (int, np.integer)) or stage.increments < 1:
            raise ValueError(f"stage '{stage.name}': increments must be at least 1 and whole, not {stage.increments!r}")
        if stage.duration != 0.0 and not is_number(stage.duration, 0.0, np.inf):
            raise ValueError(f"stage '{stage.name}': the duration must not be negative, but finite, unlike "
                             f"{stage.duration!r}")
