"""Bonds that break: points that chatter between closed with their bond and open go on without it."""
from __future__ import annotations

import logging
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy import ndarray

from ...errors import Failure
from ..laws import InterfaceLaw, Status
from ..state import ContactState
from .family import Recovery

if TYPE_CHECKING:
    from ..pair import ContactPair

logger = logging.getLogger("skfem_contact")


@dataclass(frozen=True, eq=False)
class Debonding(Recovery):
    """Points whose bond is broken, for good: the law's internal variables say so from then on.

    The tractions of a brittle bond jump to zero as a point opens.  Then there may be no equilibrium: with its bond the
    point is drawn open, and without it pressed on.  Without the bond tractions do not jump.

    Parameters
    ----------
    points
        Whether the bond breaks, (n_points,).
    """

    points: ndarray

    @classmethod
    def begin(cls, pair: ContactPair, accepted: ContactState, failure: Failure | None) -> Debonding | None:
        """Points that open and close in turn, of a law that has a bond to break."""
        if failure is None or not failure.seen:
            return None
        closed = np.array([state.status != Status.OPEN for state in failure.seen])
        state = pair.seen(accepted)
        bonded = (pair.law.debonded(state.internal) != state.internal).any(axis=0)
        breaks = closed.any(axis=0) & ~closed.all(axis=0) & bonded
        if not breaks.any():
            return None
        logger.info("points %s of '%s' open and close in turn: their bond breaks", np.flatnonzero(breaks),
                    pair.slave.name)
        return cls(breaks | before.points if (before := pair.easing.of(cls)) else breaks)

    def seen(self, state: ContactState, law: InterfaceLaw) -> ContactState:
        """With broken bonds."""
        return replace(state, internal=np.where(self.points, law.debonded(state.internal), state.internal))
