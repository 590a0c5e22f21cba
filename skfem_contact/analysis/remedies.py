"""What can be done where Newton's method fails: hold loose bodies, and calm points that go to and fro."""
from __future__ import annotations

import logging
from collections.abc import Mapping
from typing import Any

from numpy import ndarray

from .linear import SingularSystem
from .newton import Collapse, NotConverged
from .system import System

logger = logging.getLogger("skfem_contact")

#: Lengths of the step along which points that go to and fro show themselves.
_LENGTHS = (1.0, 0.5, 0.25, 0.0625)


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
    if isinstance(error, Collapse) or isinstance(error.__cause__, SingularSystem):
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
        step = system.solver.factor(system.tangent(now), system.symmetric)(now.residual)
    except SingularSystem:
        return [now.states]
    return [now.states, *(system.evaluate(x + length * step, states, load).states for length in _LENGTHS)]
