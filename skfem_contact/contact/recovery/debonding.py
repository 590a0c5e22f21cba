"""Bonds that break: points that open and close in turn go on without what holds them together."""
from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..laws import InterfaceLaw, Status
from ..state import ContactState

logger = logging.getLogger("skfem_contact")


def debonded(state: ContactState, candidates: Sequence[ContactState], slave: str, law: InterfaceLaw) -> ContactState:
    """The state with broken bonds at points that open and close, or the same one where there is none to break.

    The tractions of a brittle bond jump to zero as a point opens.  Then there may be no equilibrium: with its bond the
    point is drawn open, and without it pressed on.  Without the bond, for good, tractions do not jump.

    Parameters
    ----------
    state
        Accepted state.
    candidates
        States between which Newton's method goes to and fro.
    slave
        Name of the slave, for the log.
    law
        The interface law.
    """
    closed = np.array([candidate.status != Status.OPEN for candidate in candidates])
    without = law.debonded(state.internal)
    breaks = closed.any(axis=0) & ~closed.all(axis=0) & (without != state.internal).any(axis=0)
    if not breaks.any():
        return state
    logger.info("points %s of '%s' open and close in turn: their bond breaks", np.flatnonzero(breaks), slave)
    return replace(state, internal=np.where(breaks, without, state.internal))
