"""Increments that take more than one equilibrium: multipliers to improve, overlaps to resolve, gaps to close."""
from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from numpy import ndarray

from ..errors import IncrementTooLarge, NoEquilibrium, NotConverged
from ..solvers.direct import SingularSystem
from .line_search import Search
from .newton import Newton
from .system import Equilibrium, System

logger = logging.getLogger("skfem_contact")
#: Lengths of the step along which points that go to and fro show themselves.
_LENGTHS = (1.0, 0.5, 0.25, 0.0625)
logger = logging.getLogger("skfem_contact")

_MOST = 30
_REMEDIES = 3


def solve_increment(system: System, x: ndarray, states: Mapping[str, Any], load: ndarray, prescribed: ndarray,
            newton: Newton, start: ndarray | None = None, try_recovery: bool = True) -> Equilibrium:
    """Equilibrium of an increment with which every form is content.

    After each equilibrium the forms are asked whether they want the increment solved once more from a changed
    accepted state (:meth:`ContactPair.outer`); each time the last displacements are the start.

    Where that fails from the last displacements, what :func:`remedy` knows is tried.

    Parameters
    ----------
    system, x, states, load, prescribed, newton
        As for :meth:`System.equilibrium`.
    start
        Displacements to start from; where that fails, and by default, `x`.
    try_recovery
        Whether to search along the energy, and for remedies, too: this takes several times as long as the rest.

    Raises
    ------
    NotConverged
        One of the equilibria failed, the forms were not content after 30 of them, or could not tell what happened
        during so large an increment.
    """
    searches: tuple[Search, ...] = ("residual", "energy") if try_recovery else ("residual",)
    if start is not None:
        try:
            return _solve(system, x, states, load, prescribed, newton, searches, start)
        except NotConverged as error:
            logger.info("from the extrapolated start: %s", error)
    if not try_recovery:
        return _solve(system, x, states, load, prescribed, newton, searches)
    for _ in range(_REMEDIES):
        try:
            return _solve(system, x, states, load, prescribed, newton, searches)
        except NotConverged as error:
            helped = remedy(system, states, load, error)
            if helped is None:
                raise
            states = helped
    return _solve(system, x, states, load, prescribed, newton, searches)


def _solve(system: System, x: ndarray, states: Mapping[str, Any], load: ndarray, prescribed: ndarray,
             newton: Newton, searches: Sequence[Search], start: ndarray | None = None) -> Equilibrium:
    residuals: tuple[float, ...] = ()
    for count in range(1, _MOST + 1):
        new = system.equilibrium(x, states, load, prescribed, newton, searches, start=start)
        residuals += new.residuals if not residuals else new.residuals[1:]
        try:
            again = {name: form.outer(new.x, states[name], new.states[name]) for name, form in system.forms.items()}
        except IncrementTooLarge as error:
            raise NotConverged(f"the increment is too large: {error}", new.x, residuals) from error
        if all(state is None for state in again.values()):
            return replace(new, residuals=residuals, equilibria=count)
        states = {name: states[name] if state is None else state for name, state in again.items()}
        x, start = new.x, None
    changing = [name for name, state in again.items() if state is not None]
    raise NotConverged(f"the increment was solved {_MOST} times and {changing} still changes")


def remedy(system: System, states: Mapping[str, Any], load: ndarray, error: NotConverged) -> dict[str, Any] | None:
    """Accepted states from which the increment may succeed, or None; the log says what was done.

    Bodies that are loose because contact is open are held by soft springs (:meth:`ContactPair.hold`).  Points that
    go to and fro between facets, or between stick and slip, are calmed (:meth:`ContactPair.calm`).

    Parameters
    ----------
    system, states, load
        As for :meth:`System.equilibrium`.
    error
        How it failed.
    """
    if isinstance(error, NoEquilibrium) or isinstance(error.__cause__, SingularSystem):
        new = {name: getattr(form, "hold", _keep)(states[name]) for name, form in system.forms.items()}
        done = "bodies are loose while contact is open: soft springs in %s close it and are then taken away"
    elif error.x is None:  # every equilibrium was found, but a form was never content
        return None
    else:
        seen = _candidates(system, error.x, states, load)
        new = {name: getattr(form, "calm", _keep)(states[name], *(candidates[name] for candidates in seen))
               for name, form in system.forms.items()}
        done = "points of %s go to and fro: they are calmed in this increment"
    changed = [name for name in new if new[name] is not states[name]]
    if not changed:
        return None
    logger.info(done, changed)
    return new


def _keep(state: Any, *candidates: Any) -> Any:
    """A form that knows no remedy."""
    return state


def _candidates(system: System, x: ndarray, states: Mapping[str, Any], load: ndarray) -> list[dict[str, Any]]:
    """Candidate states where the method stopped, and at several places along its next step."""
    now = system.evaluate(x, states, load)
    try:
        step = system.factor(system.tangent(now))(now.residual)
    except SingularSystem:
        return [now.states]
    return [now.states, *(system.evaluate(x + length * step, states, load).states for length in _LENGTHS)]
