"""Increments of several equilibria: outer loops of forms, regularised forms after failures, steps
in time.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy import ndarray

from ..errors import Failure, IncrementTooLarge, NoEquilibrium, NotConverged
from ..forms.roles import Regularised, Timed, Touching, changed, having
from ..solvers.direct import SingularSystem
from .newton import Newton, Search
from .system import Equilibrium, System

logger = logging.getLogger("skfem_contact")

#: Lengths of the step at which points that chatter are looked for.
_LENGTHS = (1.0, 0.5, 0.25, 0.0625)
#: Equilibria of an increment, and recoveries that are tried one after the other.
_MOST, _RECOVERIES = 30, 3
#: Tolerance of the first equilibrium where forms only follow the displacements. Pressed, unloaded
#: and sheared in 20 steps, a cylinder on a block takes 52 iterations with this, 58 with 1e-4, and
#: 69 if each equilibrium is accurate.
_ROUGH = 1e-3
#: Residual of an equilibrium of regularised forms in the forms as given, over the tolerance:
#: round-off of states that were returned to their bounds.
_AGAIN = 10.0
#: Share of a step that its first part takes, and as much of the second one. Both parts are of
#: Euler's backward method over the same time and have the same matrix (R. Alexander 1977, p. 1012:
#: diagonally implicit, L-stable). No pressures or flows at the beginning are needed: loads may jump
#: there.
PART = 1.0 - np.sqrt(0.5)
#: Digits of the share of a stage that a step takes: equal steps are then equal to the last bit, and
#: share their factor.
_DIGITS = 12

#: Load and prescribed values at a share of a stage.
Path = Callable[[float], tuple[ndarray, ndarray]]


def solve_increment(
    system: System,
    x: ndarray,
    states: Mapping[str, Any],
    load: ndarray,
    prescribed: ndarray,
    newton: Newton,
    start: ndarray | None = None,
    try_recovery: bool = True,
) -> Equilibrium:
    """Solve an increment until no form changes any more.

    After each equilibrium, :meth:`~skfem_contact.Form.outer` of a form may demand another solution,
    by another form or from other multipliers; the last displacements are its start. Forms that only
    follow the displacements do so before the residual is small. Where Newton's method fails,
    :meth:`~skfem_contact.Form.begin` may return regularised forms. Their equilibrium is accepted
    only if the forms as given balance in it, too.

    Newton's method begins at `start` and, where that fails, at `x`. With `try_recovery` the search
    along the energy and regularised forms follow; these take several times as long as the rest.
    """
    minimum = not any(pair.saddle for pair in having(system.forms, Touching).values())
    first: Search = "either" if minimum and system.yields_beside_contact else "residual"
    searches: tuple[Search, ...] = (first, "energy") if try_recovery and minimum else (first,)
    given = system
    begun = {
        name: form.begin(states[name]) for name, form in having(given.forms, Regularised).items()
    }
    system = given.with_forms({**given.forms, **begun})
    if start is not None:
        try:
            return _solve(given, system, x, states, load, prescribed, newton, searches[:1], start)
        except NotConverged as error:
            logger.info("from the extrapolated start: %s", error)
            if try_recovery and error.cycle:
                system = system.out_of(error.cycle, states, load)
    if not try_recovery:
        return _solve(given, system, x, states, load, prescribed, newton, searches)
    for recovery in range(_RECOVERIES):
        try:
            return _solve(
                given, system, x, states, load, prescribed, newton, searches, leaves=recovery == 0
            )
        except NotConverged as error:
            regularised = _regularised(system, states, load, error)
            if regularised is system:
                raise
            system = regularised
    return _solve(given, system, x, states, load, prescribed, newton, searches, leaves=False)


def _solve(
    given: System,
    system: System,
    x: ndarray,
    states: Mapping[str, Any],
    load: ndarray,
    prescribed: ndarray,
    newton: Newton,
    searches: Sequence[Search],
    start: ndarray | None = None,
    leaves: bool = True,
) -> Equilibrium:
    residuals: tuple[float, ...] = ()
    settings, equilibria = newton, 1
    after = {form.outer_after for form in having(system.forms, Regularised).values()} - {None}
    if system is given and after == {"near"}:
        settings = replace(newton, tolerance=max(newton.tolerance, _ROUGH))
    for _ in range(_MOST):
        new = system.equilibrium(
            x,
            states,
            load,
            prescribed,
            settings,
            searches,
            start=start,
            leaves=leaves,
            begins=leaves and not residuals,
        )
        residuals += new.residuals if not residuals else new.residuals[1:]
        try:
            again = {
                name: form.outer(new.x, states[name], new.states[name])
                for name, form in having(system.forms, Regularised).items()
            }
        except IncrementTooLarge as error:
            raise NotConverged(f"the increment is too large: {error}", new.x, residuals) from error
        improved = {name: pair for name, pair in again.items() if pair is not None}
        if not improved and settings is newton:
            check(given, system, new, states, load, newton)
            return replace(new, residuals=residuals, equilibria=equilibria)
        states = {**states, **{name: state for name, (_, state) in improved.items()}}
        system = system.with_forms(
            {**system.forms, **{name: form for name, (form, _) in improved.items()}}
        )
        x, start, settings, equilibria = new.x, None, newton, equilibria + bool(improved)
    raise NotConverged(f"the increment was solved {_MOST} times and {list(improved)} still changes")


def check(
    given: System,
    system: System,
    found: Equilibrium,
    states: Mapping[str, Any],
    load: ndarray,
    newton: Newton,
) -> None:
    """Refuse an equilibrium of regularised forms that is none of the forms as given."""
    others = {name: form for name, form in system.forms.items() if form is not given.forms[name]}
    if not others:
        return
    again = given.evaluate(
        found.x, {k: found.states[k] if k in others else state for k, state in states.items()}, load
    )
    if again.norm > _AGAIN * newton.tolerance:
        reasons = {name: form.reason for name, form in having(others, Regularised).items()}
        why = "; ".join(f"{name}: {reason}" for name, reason in reasons.items() if reason)
        raise NotConverged(
            f"an equilibrium was found that does not last, {again.norm:.1e} of the forces are out "
            f"of "
            f"balance: {why}",
            found.x,
            (*found.residuals, again.norm),
            again.worst,
        )


def _regularised(
    system: System, states: Mapping[str, Any], load: ndarray, error: NotConverged
) -> System:
    """Return the system with regularised forms, or the same one where no form has any.

    Bodies that move freely need to be held, and points that chatter need another law. Where no
    point chatters, bodies may be about to lift off: a residual that hardly changes is that of a
    body that flies away.
    """
    loose = isinstance(error, NoEquilibrium) or isinstance(error.__cause__, SingularSystem)
    if not loose:
        if error.x is None:  # every equilibrium was found, but a form changed each time
            return system
        again = system.out_of(
            error.cycle or _candidates(system, error.x, states, load), states, load
        )
        if again is not system or isinstance(error.__cause__, IncrementTooLarge):
            return again
    return system.after(states, {name: Failure(loose=True) for name in system.forms})


def _candidates(
    system: System, x: ndarray, states: Mapping[str, Any], load: ndarray
) -> list[ndarray]:
    """Return displacements where the method stopped, and those at several lengths of its next
    step.
    """
    now = system.evaluate(x, states, load)
    try:
        step = system.factor(system.tangent(now))(now.residual)
    except SingularSystem:
        return [x]
    return [x, *(x + length * step for length in _LENGTHS)]


def solve_step(
    system: System,
    x: ndarray,
    states: Mapping[str, Any],
    path: Path,
    span: tuple[float, float],
    duration: float,
    newton: Newton,
    start: ndarray | None,
    try_recovery: bool,
) -> tuple[Equilibrium, dict[str, tuple[float, float]]]:
    """Solve a step in time; return the equilibrium at its end and
    :meth:`~skfem_contact.Form.time_error` by form.

    The step goes from one share of the stage to another (`span`). Where the stage has no duration
    the step is a plain increment, see :func:`solve_increment`.
    """
    begin, end = span
    duration *= round(end - begin, _DIGITS)
    timed = having(system.forms, Timed)
    second_order = {name for name, form in timed.items() if form.second_order}
    if not second_order or not duration > 0.0:
        step = system.over(duration)
        return solve_increment(step, x, states, *path(end), newton, start, try_recovery), {}
    first = system.over(PART * duration)
    towards = None if start is None else x + PART * (start - x)
    middle = solve_increment(
        first, x, states, *path(begin + PART * (end - begin)), newton, towards, try_recovery
    )
    rest = changed(system.forms, Timed, lambda form: form.over((1.0 - PART) * duration))
    second = first.with_forms({**rest, **{name: first.forms[name] for name in second_order}})
    timed = having(first.forms, Timed)
    begun = dict(middle.states)
    for name in second_order:
        begun[name] = timed[name].extrapolated(states[name], begun[name], 1.0 / PART - 1.0)
    ahead = x + (middle.x - x) / PART  # in proportion
    last = solve_increment(second, middle.x, begun, *path(end), newton, ahead, try_recovery)
    errors = {
        name: timed[name].time_error(middle.states[name], last.states[name])
        for name in second_order
    }
    return Equilibrium(
        last.x,
        last.states,
        middle.residuals + last.residuals[1:],
        middle.equilibria + last.equilibria,
    ), errors
