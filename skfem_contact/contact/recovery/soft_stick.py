"""Points that cycle between stick and slip: they stick softly at first, and harder from solution to solution.

Sticking points answer to an elastic slip e with the traction ``s epsilon_T (e + d)``, with a softness s < 1 and a
shift d of the slip that would give the traction of the last solution, t, if its elastic slip were that of the whole
penalty, ``t / epsilon_T``: ``d = t / (s epsilon_T) - t / epsilon_T``.  This is the augmented method, with t as the
multiplier: from solution to solution the points come nearer to where they stick with the whole penalty, at which the
last one is found.
"""
from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy import ndarray

from ..laws import Status
from ..state import ContactState
from ..surface import Surface

logger = logging.getLogger("skfem_contact")

#: Tangential penalty of the first solution: so many times the stiffness of the surfaces, and at most this share of
#: the penalty that is meant.
_FIRST, _SHARE = 10.0, 0.1
#: It grows from one solution to the next by this factor at least, and by more as long as that changes the tractions of
#: points that stick by no more than this share of the largest one.
_GROWTH, _CHANGE = 1.6, 0.05


def softened(state: ContactState, candidates: Sequence[ContactState], slave: str, master: Surface, hardness: float
             ) -> ContactState:
    """The state with a softer stick, or the same one where no point goes to and fro between stick and slip.

    From slip in one direction to slip in the other the traction runs through stick, in an elastic slip that is smaller
    the higher the penalty; Newton's method may jump over it for ever.  From the solution with a softer stick the next
    one is near.

    Parameters
    ----------
    state
        Accepted state.
    candidates
        States between which Newton's method goes to and fro.
    slave, master
        Name of the slave, for the log; the master.
    hardness
        Tangential penalty over the stiffness of the surfaces.
    """
    slides = np.array([np.sign(at.tangential) * (at.status == Status.SLIP) for at in candidates])
    cycles = (slides != slides[0]).any(axis=0)
    if state.softness[0] < 1.0 or not cycles.any():
        return state
    softness = min(_SHARE, _FIRST / hardness)
    logger.info("points %s of '%s' go to and fro between stick and slip: the stick begins with %.1g of its penalty",
                np.flatnonzero(cycles), slave, softness)
    return _with_softness(state, state, master, softness)


def hardened(accepted: ContactState, candidate: ContactState, master: Surface) -> ContactState:
    """The accepted state with a harder stick, for the next solution, and the tractions of the last one.

    Parameters
    ----------
    accepted, candidate
        State at the start of the increment, and the one that has been found.
    master
        The master.
    """
    elastic = _elastic(candidate, master)
    sticks = candidate.status == Status.STICK
    slip = np.nan_to_num(master.along(candidate.arc - accepted.stick_point))
    wrong = np.abs(slip - elastic)[sticks].max(initial=0.0)
    harder = _CHANGE * np.abs(elastic).max() / max(wrong, 1e-300)
    return _with_softness(accepted, candidate, master, min(1.0, max(harder, accepted.softness[0] * _GROWTH)))


def _with_softness(accepted: ContactState, last: ContactState, master: Surface, softness: float) -> ContactState:
    """The accepted state with a softness, and the shifts that stand for the tractions of the last solution."""
    elastic = _elastic(last, master)
    return replace(accepted, softness=np.array([softness]), shift=elastic / softness - elastic)


def _elastic(last: ContactState, master: Surface) -> ndarray:
    """Elastic slip along the undeformed master with which the whole penalty has the tractions of a state."""
    return np.asarray(np.nan_to_num(master.along(last.arc - last.stick_point)) * last.softness)
