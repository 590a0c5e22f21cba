"""Increments that take more than one equilibrium: multipliers to improve, overlaps to resolve, gaps to close."""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from numpy import ndarray

from ..assembly import IncrementTooLarge
from .newton import Newton, NotConverged
from .remedies import remedy
from .system import Equilibrium, System

_MOST = 30
_REMEDIES = 3


def settled(system: System, x: ndarray, states: Mapping[str, Any], load: ndarray, prescribed: ndarray,
            newton: Newton) -> Equilibrium:
    """Equilibrium of an increment with which every form is content.

    After each equilibrium the forms are asked whether they want the increment solved once more from a changed
    accepted state (:meth:`ContactPair.settle`); each time the last displacements are the start.

    Where one of them fails, what :func:`remedy` knows is tried.

    Parameters
    ----------
    system, x, states, load, prescribed, newton
        As for :meth:`System.equilibrium`.

    Raises
    ------
    NotConverged
        One of the equilibria failed, the forms were not content after 30 of them, or could not tell what happened
        during so large an increment.
    """
    for _ in range(_REMEDIES):
        try:
            return _settled(system, x, states, load, prescribed, newton)
        except NotConverged as error:
            helped = remedy(system, states, load, error)
            if helped is None:
                raise
            states = helped
    return _settled(system, x, states, load, prescribed, newton)


def _settled(system: System, x: ndarray, states: Mapping[str, Any], load: ndarray, prescribed: ndarray,
             newton: Newton) -> Equilibrium:
    residuals: tuple[float, ...] = ()
    for count in range(1, _MOST + 1):
        new = system.equilibrium(x, states, load, prescribed, newton)
        residuals += new.residuals if not residuals else new.residuals[1:]
        try:
            again = {name: form.settle(new.x, states[name], new.states[name]) for name, form in system.forms.items()}
        except IncrementTooLarge as error:
            raise NotConverged(f"the increment is too large: {error}", new.x, residuals) from error
        if all(state is None for state in again.values()):
            return replace(new, residuals=residuals, equilibria=count)
        states = {name: states[name] if state is None else state for name, state in again.items()}
        x = new.x
    unsettled = [name for name, state in again.items() if state is not None]
    raise NotConverged(f"the increment was solved {_MOST} times and {unsettled} still changes")
