"""Increments that take more than one equilibrium: outer loops of the forms, and easier forms where Newton fails."""
from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from numpy import ndarray

from ..errors import Failure, IncrementTooLarge, NoEquilibrium, NotConverged
from ..solvers.direct import SingularSystem
from .line_search import Search
from .newton import Newton
from .system import Equilibrium, System

logger = logging.getLogger("skfem_contact")

#: Lengths of the step along which points that chatter show themselves.
_LENGTHS = (1.0, 0.5, 0.25, 0.0625)
#: Equilibria of an increment, and recoveries that are tried one after the other.
_MOST, _RECOVERIES = 30, 3
#: Residual of what was found, assembled again, over the tolerance: round-off of what was returned to its bounds.
_AGAIN = 10.0


def solve_increment(system: System, x: ndarray, states: Mapping[str, Any], load: ndarray, prescribed: ndarray,
                    newton: Newton, start: ndarray | None = None, try_recovery: bool = True) -> Equilibrium:
    """Equilibrium of an increment with which every form is content.

    After each equilibrium the forms are asked whether they want the increment solved once more, by another form or
    from other multipliers (:meth:`~skfem_contact.Form.outer`); each time the last displacements are the start.
    Where Newton's method fails from the last accepted displacements, forms are asked for easier ones that lead to
    themselves (:meth:`~skfem_contact.Form.begin`).  What is found is assembled again by the forms as given, from
    the states that it leaves: only if that balances is it an answer.

    Where it fails from the start, `x` is tried; to search along the energy and by easier forms, too (`try_recovery`),
    takes several times as long as the rest.

    Raises
    ------
    NotConverged
        One of the equilibria failed, the forms were not content after 30 of them, could not tell what happened during
        so large an increment, or what was found is no equilibrium of the forms as given.
    """
    searches: tuple[Search, ...] = ("residual", "energy") if try_recovery else ("residual",)
    given = system
    system = given.with_forms({name: form.begin(states[name]) for name, form in given.forms.items()})
    if start is not None:
        try:
            return _solve(given, system, x, states, load, prescribed, newton, searches, start)
        except NotConverged as error:
            logger.info("from the extrapolated start: %s", error)
    if not try_recovery:
        return _solve(given, system, x, states, load, prescribed, newton, searches)
    for _ in range(_RECOVERIES):
        try:
            return _solve(given, system, x, states, load, prescribed, newton, searches)
        except NotConverged as error:
            easier = _easier(system, states, load, error)
            if easier is system:
                raise
            system = easier
    return _solve(given, system, x, states, load, prescribed, newton, searches)


def _solve(given: System, system: System, x: ndarray, states: Mapping[str, Any], load: ndarray, prescribed: ndarray,
           newton: Newton, searches: Sequence[Search], start: ndarray | None = None) -> Equilibrium:
    residuals: tuple[float, ...] = ()
    for count in range(1, _MOST + 1):
        new = system.equilibrium(x, states, load, prescribed, newton, searches, start=start)
        residuals += new.residuals if not residuals else new.residuals[1:]
        try:
            again = {name: form.outer(new.x, states[name], new.states[name]) for name, form in system.forms.items()}
        except IncrementTooLarge as error:
            raise NotConverged(f"the increment is too large: {error}", new.x, residuals) from error
        changed = {name: answer for name, answer in again.items() if answer is not None}
        if not changed:
            check(given, system, new, states, load, newton)
            return replace(new, residuals=residuals, equilibria=count)
        states = {**states, **{name: state for name, (_, state) in changed.items()}}
        system = system.with_forms({**system.forms, **{name: form for name, (form, _) in changed.items()}})
        x, start = new.x, None
    raise NotConverged(f"the increment was solved {_MOST} times and {list(changed)} still changes")


def check(given: System, system: System, found: Equilibrium, states: Mapping[str, Any], load: ndarray,
          newton: Newton) -> None:
    """Refuse what balances by easier forms alone: they are assembled anew from what they left, as they were given."""
    eased = {name: form for name, form in system.forms.items() if form is not given.forms[name]}
    if not eased:
        return
    again = given.evaluate(found.x, {k: found.states[k] if k in eased else state for k, state in states.items()}, load)
    if again.norm > _AGAIN * newton.tolerance:
        why = "; ".join(f"{name}: {form.reason}" for name, form in eased.items() if form.reason)
        raise NotConverged(f"an equilibrium was found that does not last, {again.norm:.1e} of the forces are out of "
                           f"balance: {why}", found.x, (*found.residuals, again.norm), again.worst)


def _easier(system: System, states: Mapping[str, Any], load: ndarray, error: NotConverged) -> System:
    """The system with easier forms, or the same one where no form knows any.

    Bodies that move freely need to be held, and points that chatter an easier law.  Where none chatters the bodies may
    be about to lift off: a residual that hardly changes is that of a body that flies away.
    """
    loose = isinstance(error, NoEquilibrium) or isinstance(error.__cause__, SingularSystem)
    if not loose:
        if error.x is None:  # every equilibrium was found, but a form was never content
            return system
        seen = _candidates(system, error.x, states, load)
        easier = _begin(system, states, {name: Failure(False, tuple(candidates[name] for candidates in seen))
                                         for name in system.forms})
        if easier is not system or isinstance(error.__cause__, IncrementTooLarge):
            return easier
    return _begin(system, states, {name: Failure(loose=True) for name in system.forms})


def _begin(system: System, states: Mapping[str, Any], failures: Mapping[str, Failure]) -> System:
    """The system with what its forms begin with after failures."""
    return system.with_forms({name: form.begin(states[name], failures[name]) for name, form in system.forms.items()})


def _candidates(system: System, x: ndarray, states: Mapping[str, Any], load: ndarray) -> list[dict[str, Any]]:
    """Candidate states where the method stopped, and at several places along its next step."""
    now = system.evaluate(x, states, load)
    try:
        step = system.factor(system.tangent(now))(now.residual)
    except SingularSystem:
        return [now.states]
    return [now.states, *(system.evaluate(x + length * step, states, load).states for length in _LENGTHS)]
