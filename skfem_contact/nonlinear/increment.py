"""Increments of several equilibria: outer loops of forms, regularised forms, steps in time."""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy import ndarray

from ..errors import Failure, IncrementTooLarge, NoEquilibrium, NotConverged
from ..forms.roles import Regularised, Timed, Touching, having
from ..solvers.direct import SingularSystem
from .newton import Newton, Search
from .step import Attempt, Equilibrium, Step
from .system import System

logger = logging.getLogger("skfem_contact")

#: Lengths of the iteration at which points that chatter are looked for.
_LENGTHS = (1.0, 0.5, 0.25, 0.0625)
#: Equilibria of an increment, and recoveries that are tried one after the other.
_MOST = 30
_RECOVERIES = 3
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


@dataclass(frozen=True)
class Interval:
    """Part of a stage that a step takes.

    Attributes
    ----------
    path
        Load and prescribed values at a share of the stage.
    begin, end
        Shares of the stage.
    duration
        Duration of the whole stage.
    """

    path: Path
    begin: float
    end: float
    duration: float

    @property
    def time(self) -> float:
        """Duration of the step."""
        return self.duration * round(self.end - self.begin, _DIGITS)

    @property
    def at_end(self) -> tuple[ndarray, ndarray]:
        """Load and prescribed values at the end."""
        return self.path(self.end)

    @property
    def in_between(self) -> tuple[ndarray, ndarray]:
        """Load and prescribed values after the first part of a step of second order."""
        return self.path(self.begin + PART * (self.end - self.begin))


def searches_of(system: System, try_recovery: bool) -> tuple[Search, ...]:
    """Choose line searches: multipliers make equilibrium no minimum of the energy along a step."""
    minimum = not any(pair.saddle for pair in having(system.forms, Touching).values())
    flows = minimum and system.yields_beside_contact
    searches: list[Search] = ["residual"]
    if flows:
        searches = ["either"]
    if minimum and try_recovery:
        searches.append("energy")
    # Full steps bend slender bodies. Ground that flows around a tool runs away by them: pipes,
    # cones and wedges pushed into clay take .5 to .8 of the iterations without.
    if system.finite and not flows:
        searches.insert(0, "full")
    return tuple(searches)


def solve_increment(step: Step, newton: Newton, try_recovery: bool = True) -> Equilibrium:
    """Solve an increment, once or several times, until no form needs another solution.

    After each equilibrium, :meth:`~skfem_contact.roles.Regularised.outer` of a form may demand
    another solution, with another form or accepted state. Where Newton's method fails,
    :meth:`~skfem_contact.roles.Regularised.begin` may return regularised forms. Their equilibrium
    is accepted only if the forms as given balance in it, too.

    Newton's method begins at `step.start` and, where that fails, at `step.x`. With `try_recovery`
    the search along the energy and regularised forms follow; these take several times as long as
    the rest.
    """
    given = step.system
    step = replace(step, system=given.after(step.states, {}))

    searches = searches_of(given, try_recovery)

    # Try the extrapolated start.
    from_x = replace(step, start=None)
    if step.start is not None:
        try:
            return _solve(given, step, newton, Attempt(searches[:1]))
        except NotConverged as error:
            logger.info("from the extrapolated start: %s", error)
            if try_recovery and error.cycle:
                system = step.system.out_of(error.cycle, step.states, step.load)
                from_x = replace(from_x, system=system)
    if not try_recovery:
        return _solve(given, from_x, newton, Attempt(searches))

    # Try the accepted displacements, with forms that are regularised after each failure.
    for recovery in range(_RECOVERIES):
        try:
            return _solve(given, from_x, newton, Attempt(searches, leaves=recovery == 0))
        except NotConverged as error:
            system = _regularised(from_x, error)
            if system is from_x.system:
                raise
            from_x = replace(from_x, system=system)
    return _solve(given, from_x, newton, Attempt(searches, leaves=False))


def _solve(given: System, step: Step, newton: Newton, attempt: Attempt) -> Equilibrium:
    """Solve a step until no form needs another solution; `given` has the forms as given."""
    residuals: tuple[float, ...] = ()
    settings = newton
    equilibria = 1

    # Solve roughly at first where forms only follow the displacements.
    after = {form.outer_after for form in having(step.system.forms, Regularised).values()}
    if step.system is given and after - {None} == {"near"}:
        settings = replace(newton, tolerance=max(newton.tolerance, _ROUGH))
    for _ in range(_MOST):
        begins = attempt.leaves and not residuals
        new = step.equilibrium(settings, replace(attempt, begins=begins))
        residuals += new.residuals if not residuals else new.residuals[1:]
        improved = improved_forms(step, new, residuals)
        if not improved and settings is newton:
            check(given, step, new, newton)
            return replace(new, residuals=residuals, equilibria=equilibria, responses={})

        # Begin the next solution at this equilibrium, with the improved forms and states.
        forms = {name: form for name, (form, _) in improved.items()}
        states = {name: state for name, (_, state) in improved.items()}
        system = step.system.with_forms({**step.system.forms, **forms})
        step = replace(step, system=system, x=new.x, states={**step.states, **states}, start=None)
        settings = newton
        equilibria += bool(improved)
    raise NotConverged(f"the increment was solved {_MOST} times and {list(improved)} still changes")


def improved_forms(
    step: Step, new: Equilibrium, residuals: tuple[float, ...]
) -> dict[str, tuple[Any, Any]]:
    """Return forms and accepted states with which the increment must be solved once more."""
    improved = {}
    try:
        for name, form in having(step.system.forms, Regularised).items():
            pair = form.outer(new.x, step.states[name], new.states[name])
            if pair is not None:
                improved[name] = pair
    except IncrementTooLarge as error:
        raise NotConverged(f"the increment is too large: {error}", new.x, residuals) from error
    return improved


def check(given: System, step: Step, found: Equilibrium, newton: Newton) -> None:
    """Refuse an equilibrium of regularised forms that is none of the forms as given."""
    # Evaluate the forms as given at this equilibrium.
    others = {}
    for k, form in step.system.forms.items():
        if form is not given.forms[k]:
            others[k] = form
    if not others:
        return
    states = {}
    for k, state in step.states.items():
        states[k] = found.states[k] if k in others else state
    same = {k: response for k, response in found.responses.items() if k not in others}
    again = given.evaluate(found.x, states, step.load, same)
    if again.norm > _AGAIN * newton.tolerance:
        reasons = {name: form.reason for name, form in having(others, Regularised).items()}
        why = "; ".join(f"{name}: {reason}" for name, reason in reasons.items() if reason)
        raise NotConverged(
            f"an equilibrium was found that does not last, {again.norm:.1e} of the forces are out "
            f"of balance: {why}",
            found.x,
            (*found.residuals, again.norm),
            again.worst,
        )


def _regularised(step: Step, error: NotConverged) -> System:
    """Return the system with regularised forms, or the same one where no form has any.

    Bodies that move freely need to be held, and points that chatter need another law. Where no
    point chatters, bodies may be about to lift off: a residual that hardly changes is the residual
    of a body that flies away.
    """
    system = step.system
    cause = error.__cause__
    loose = isinstance(error, NoEquilibrium) or isinstance(cause, SingularSystem)
    if not loose:
        if error.x is None:  # every equilibrium was found, but a form changed each time
            return system
        visited = error.cycle or _candidates(step, error.x)
        again = system.out_of(visited, step.states, step.load)
        if again is not system or isinstance(cause, IncrementTooLarge):
            return again
    failures = {name: Failure(loose=True) for name in system.forms}
    return system.after(step.states, failures)


def _candidates(step: Step, x: ndarray) -> list[ndarray]:
    """Return displacements where the method stopped, and on the way of its next iteration."""
    system = step.system
    now = system.evaluate(x, step.states, step.load)
    try:
        direction = system.factor(system.tangent(now))(now.residual)
    except SingularSystem:
        return [x]
    return [x, *(x + length * direction for length in _LENGTHS)]


def solve_step(
    step: Step,
    interval: Interval,
    newton: Newton,
    try_recovery: bool,
) -> tuple[Equilibrium, dict[str, tuple[float, float]]]:
    """Solve a step in time, and return the equilibrium at its end and the errors by form.

    Where the stage has no duration the step is a plain increment, see :func:`solve_increment`. The
    errors are those of :meth:`~skfem_contact.roles.Timed.time_error`.

    Parameters
    ----------
    step
        System as given, accepted displacements and states, load and prescribed values at the end.
    interval
        Part of the stage.
    newton, try_recovery
        As for :func:`solve_increment`.
    """
    system = step.system
    duration = interval.time
    timed = having(system.forms, Timed)
    second_order = {name for name, form in timed.items() if form.second_order}
    if not second_order or not duration > 0.0:
        whole = replace(step, system=system.over(duration))
        return solve_increment(whole, newton, try_recovery), {}

    # Take the first part.
    first = system.over(PART * duration)
    if step.start is None:
        start = None
    else:
        start = step.x + PART * (step.start - step.x)
    load, prescribed = interval.in_between
    part = replace(step, system=first, load=load, prescribed=prescribed, start=start)
    middle = solve_increment(part, newton, try_recovery)

    # Take the second part, from states in proportion.
    timed = having(first.forms, Timed)
    rest = (1.0 - PART) * duration
    for name, form in having(system.forms, Timed).items():
        if name not in second_order:
            timed[name] = form.over(rest)
    second = first.with_forms({**first.forms, **timed})
    states = dict(middle.states)
    for name in second_order:
        states[name] = timed[name].extrapolated(step.states[name], states[name], 1.0 / PART - 1.0)
    ahead = step.x + (middle.x - step.x) / PART
    part = replace(step, system=second, x=middle.x, states=states, start=ahead)
    last = solve_increment(part, newton, try_recovery)

    errors = {}
    for name in second_order:
        errors[name] = timed[name].time_error(middle.states[name], last.states[name])
    residuals = middle.residuals + last.residuals[1:]
    equilibria = middle.equilibria + last.equilibria
    return Equilibrium(last.x, last.states, residuals, equilibria), errors
