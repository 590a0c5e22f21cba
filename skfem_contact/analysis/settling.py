"""Increments that take more than one equilibrium: multipliers to improve, overlaps to resolve."""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from numpy import ndarray

from .newton import Equilibrium, Newton, NotConverged, System

_MOST = 30


def settled(system: System, x: ndarray, states: Mapping[str, Any], load: ndarray, prescribed: ndarray,
            newton: Newton) -> Equilibrium:
    """Equilibrium of an increment with which every form is content.

    After each equilibrium the forms are asked whether they want the increment solved once more from a changed
    accepted state (:meth:`ContactPair.settle`); each time the last displacements are the start.

    Parameters
    ----------
    system, x, states, load, prescribed, newton
        As for :meth:`System.equilibrium`.

    Raises
    ------
    NotConverged
        One of the equilibria failed, or the forms were not content after 30 of them.
    """
    residuals: tuple[float, ...] = ()
    for _ in range(_MOST):
        new = system.equilibrium(x, states, load, prescribed, newton)
        residuals += new.residuals if not residuals else new.residuals[1:]
        again = {name: form.settle(new.x, states[name], new.states[name]) for name, form in system.forms.items()}
        if all(state is None for state in again.values()):
            return replace(new, residuals=residuals)
        states = {name: states[name] if state is None else state for name, state in again.items()}
        x = new.x
    unsettled = [name for name, state in again.items() if state is not None]
    raise NotConverged(f"the increment was solved {_MOST} times and {unsettled} still changes")
