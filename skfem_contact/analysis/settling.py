"""Increments that take more than one equilibrium: multipliers to improve, overlaps to resolve, gaps to close."""
from __future__ import annotations

import logging
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from numpy import ndarray

from ..assembly import IncrementTooLarge
from .newton import Newton, NotConverged
from .remedies import remedy
from .system import Equilibrium, System

logger = logging.getLogger("skfem_contact")

_MOST = 30
_REMEDIES = 3


def settled(system: System, x: ndarray, states: Mapping[str, Any], load: ndarray, prescribed: ndarray,
            newton: Newton, start: ndarray | None = None) -> Equilibrium:
    """Equilibrium of an increment with which every form is content.

    After each equilibrium the forms are asked whether they want the increment solved once more from a changed
    accepted state (:meth:`ContactPair.settle`); each time the last displacements are the start.

    Where one of them fails, what :func:`remedy` knows is tried.

    Parameters
    ----------
    system, x, states, load, prescribed, newton
        As for :meth:`System.equilibrium`.
    start
        Displacements to start from; where that fails, and by default, `x`.

    Raises
    ------
    NotConverged
        One of the equilibria failed, the forms were not content after 30 of them, or could not tell what happened
        during so large an increment.
    """
    if start is not None:
        try:
            return _settled(system, x, states, load, prescribed, newton, start)
        except NotConverged as error:
            logger.info("from the extrapolated start: %s", error)
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
             newton: Newton, start: ndarray | None = None) -> Equilibrium:
    residuals: tuple[float, ...] = ()
    for count in range(1, _MOST + 1):
        new = system.equilibrium(x, states, load, prescribed, newton, start=start)
        residuals += new.residuals if not residuals else new.residuals[1:]
        try:
            again = {name: form.settle(new.x, states[name], new.states[name]) for name, form in system.forms.items()}
        except IncrementTooLarge as error:
            raise NotConverged(f"the increment is too large: {error}", new.x, residuals) from error
        if all(state is None for state in again.values()):
            return replace(new, residuals=residuals, equilibria=count)
        states = {name: states[name] if state is None else state for name, state in again.items()}
        x, start = new.x, None
    unsettled = [name for name, state in again.items() if state is not None]
    raise NotConverged(f"the increment was solved {_MOST} times and {unsettled} still changes")
