"""Increments that take more than one equilibrium: multipliers to improve, overlaps to resolve, gaps to close."""
from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from numpy import ndarray

from ..assembly import IncrementTooLarge
from .newton import Newton, NotConverged, Search
from .remedies import remedy
from .system import Equilibrium, System

logger = logging.getLogger("skfem_contact")

_MOST = 30
_REMEDIES = 3


def settled(system: System, x: ndarray, states: Mapping[str, Any], load: ndarray, prescribed: ndarray,
            newton: Newton, start: ndarray | None = None, thorough: bool = True) -> Equilibrium:
    """Equilibrium of an increment with which every form is content.

    After each equilibrium the forms are asked whether they want the increment solved once more from a changed
    accepted state (:meth:`ContactPair.settle`); each time the last displacements are the start.

    Where that fails from the last displacements, what :func:`remedy` knows is tried.

    Parameters
    ----------
    system, x, states, load, prescribed, newton
        As for :meth:`System.equilibrium`.
    start
        Displacements to start from; where that fails, and by default, `x`.
    thorough
        Whether to search along the energy, and for remedies, too: this takes several times as long as the rest.

    Raises
    ------
    NotConverged
        One of the equilibria failed, the forms were not content after 30 of them, or could not tell what happened
        during so large an increment.
    """
    searches: tuple[Search, ...] = ("residual", "energy") if thorough else ("residual",)
    if start is not None:
        try:
            return _settled(system, x, states, load, prescribed, newton, searches, start)
        except NotConverged as error:
            logger.info("from the extrapolated start: %s", error)
    if not thorough:
        return _settled(system, x, states, load, prescribed, newton, searches)
    for _ in range(_REMEDIES):
        try:
            return _settled(system, x, states, load, prescribed, newton, searches)
        except NotConverged as error:
            helped = remedy(system, states, load, error)
            if helped is None:
                raise
            states = helped
    return _settled(system, x, states, load, prescribed, newton, searches)


def _settled(system: System, x: ndarray, states: Mapping[str, Any], load: ndarray, prescribed: ndarray,
             newton: Newton, searches: Sequence[Search], start: ndarray | None = None) -> Equilibrium:
    residuals: tuple[float, ...] = ()
    for count in range(1, _MOST + 1):
        new = system.equilibrium(x, states, load, prescribed, newton, searches, start=start)
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
