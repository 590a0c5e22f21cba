"""Points that cycle between stick and slip: they stick softly at first, and harder from solution to solution."""
from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..materials.coulomb import Status
from .state import ContactState

logger = logging.getLogger("skfem_contact")

#: Tangential penalty of the first solution, as a share of the one that is meant.
_FIRST = 0.1
#: Factor by which it grows from one solution to the next: with 10 points begin to cycle anew.
_GROWTH = 3.0


def softened(state: ContactState, candidates: Sequence[ContactState], slave: str) -> ContactState:
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
    slave
        Name of the slave, for the log.
    """
    slides = np.array([np.sign(at.tangential) * (at.status == Status.SLIP) for at in candidates])
    cycles = (slides != slides[0]).any(axis=0)
    if state.softness[0] < 1.0 or not cycles.any():
        return state
    logger.info("points %s of '%s' go to and fro between stick and slip: the stick begins with %g of its penalty",
                np.flatnonzero(cycles), slave, _FIRST)
    return _with_softness(state, _FIRST)


def hardened(accepted: ContactState) -> ContactState:
    """The accepted state with a harder stick, for the next solution."""
    return _with_softness(accepted, min(1.0, accepted.softness[0] * _GROWTH))


def _with_softness(state: ContactState, softness: float) -> ContactState:
    """The tractions remain, the elastic slip changes."""
    elastic = (state.arc - state.stick_point) * state.softness / softness
    return replace(state, softness=np.array([softness]), stick_point=state.arc - elastic)
