"""Increments that take more than one equilibrium: multipliers to improve, overlaps to resolve, gaps to close."""
from __future__ import annotations

import logging
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from numpy import ndarray

from ..assembly import IncrementTooLarge
from .linear import SingularSystem
from .newton import Newton, NotConverged
from .system import Equilibrium, System

logger = logging.getLogger("skfem_contact")

_MOST = 30


def settled(system: System, x: ndarray, states: Mapping[str, Any], load: ndarray, prescribed: ndarray,
            newton: Newton) -> Equilibrium:
    """Equilibrium of an increment with which every form is content.

    After each equilibrium the forms are asked whether they want the increment solved once more from a changed
    accepted state (:meth:`ContactPair.settle`); each time the last displacements are the start.

    Where nothing holds the bodies, because contact that will hold them is open, soft springs close the gaps
    (:meth:`ContactPair.hold`) and are then taken away; the log says so.

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
    try:
        return _settled(system, x, states, load, prescribed, newton)
    except NotConverged as error:
        held = {name: getattr(form, "hold", lambda state: state)(states[name]) for name, form in system.forms.items()}
        names = [name for name in held if held[name] is not states[name]]
        if not isinstance(error.__cause__, SingularSystem) or not names:
            raise
    logger.warning("bodies are loose while contact is open: soft springs in %s close it and are then taken away", names)
    try:
        return _settled(system, x, held, load, prescribed, newton)
    except NotConverged as error:
        raise NotConverged(f"contact does not hold the bodies, not even once soft springs in {names} have closed it: "
                           f"{error}", error.x, error.residuals) from error


def _settled(system: System, x: ndarray, states: Mapping[str, Any], load: ndarray, prescribed: ndarray,
             newton: Newton) -> Equilibrium:
    residuals: tuple[float, ...] = ()
    for _ in range(_MOST):
        new = system.equilibrium(x, states, load, prescribed, newton)
        residuals += new.residuals if not residuals else new.residuals[1:]
        try:
            again = {name: form.settle(new.x, states[name], new.states[name]) for name, form in system.forms.items()}
        except IncrementTooLarge as error:
            raise NotConverged(f"the increment is too large: {error}", new.x, residuals) from error
        if all(state is None for state in again.values()):
            return replace(new, residuals=residuals)
        states = {name: states[name] if state is None else state for name, state in again.items()}
        x = new.x
    unsettled = [name for name, state in again.items() if state is not None]
    raise NotConverged(f"the increment was solved {_MOST} times and {unsettled} still changes")
