"""Points that chatter between stick and slip: they stick softly at first, and harder from solution to solution.

Sticking points answer to an elastic slip e with the traction ``s epsilon_T (e + d)``, with a softness s < 1 and a
shift d of the slip that would give the traction of the last solution, t, if its elastic slip were that of the whole
penalty, ``t / epsilon_T``: ``d = t / (s epsilon_T) - t / epsilon_T``.  This is the augmented method, with t as the
multiplier: from solution to solution the points come nearer to where they stick with the whole penalty, at which the
last one is found.
"""
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

#: Tangential penalty of the first solution: so many times the stiffness of the surfaces, and at most this share of
#: the penalty that is meant.
_FIRST, _SHARE = 10.0, 0.1
#: It grows from one solution to the next by this factor at least, and by more as long as that changes the tractions of
#: points that stick by no more than this share of the largest one.
_GROWTH, _CHANGE = 1.6, 0.05


@dataclass(frozen=True, eq=False)
class SoftStick(Recovery):
    """A softer stick from shifted slips.

    Parameters
    ----------
    softness
        Share of the tangential penalty.
    elastic
        Elastic slip that the whole penalty leaves under the tractions of the last solution, (dim - 1, n_points).
    """

    softness: float
    elastic: ndarray

    @classmethod
    def begin(cls, pair: ContactPair, accepted: ContactState, failure: Failure | None) -> SoftStick | None:
        """The softest stick where points change between stick and slip, or the direction of their slip.

        From slip in one direction to slip in the other the traction runs through stick, in an elastic slip that is
        smaller the higher the penalty; Newton's method may jump over it for ever.
        """
        if failure is None or not failure.seen or pair.easing.of(cls) is not None:
            return None
        slides = np.array([np.sign(state.traction[1:]) * (state.status == Status.SLIP) for state in failure.seen])
        chatters = (slides != slides[0]).any(axis=(0, 1))
        if not chatters.any():
            return None
        hardness = 1.0 if pair.stiffness is None else pair.penalties(accepted)[1] / pair.stiffness
        softness = min(_SHARE, _FIRST / hardness)
        logger.info("points %s of '%s' chatter between stick and slip: a soft stick begins with %.1g of the penalty",
                    np.flatnonzero(chatters), pair.slave.name, softness)
        return cls(softness, pair.elastic_slip(accepted))

    def seen(self, state: ContactState, law: InterfaceLaw) -> ContactState:
        """With a softer penalty."""
        return replace(state, penalty_factor=state.penalty_factor * [1.0, self.softness])

    def slip(self, at: ndarray) -> ndarray:
        """Slip from a shifted stick point."""
        return np.asarray((self.elastic / self.softness - self.elastic)[:, at])

    def proceed(self, pair: ContactPair, accepted: ContactState, found: ContactState) -> SoftStick | None:
        """A harder stick, with the tractions of the last solution."""
        elastic = pair.elastic_slip(found) * self.softness
        sticks = found.status == Status.STICK
        wrong = np.abs(pair.elastic_slip(accepted, found) - elastic)[:, sticks].max(initial=0.0)
        harder = _CHANGE * np.abs(elastic).max() / max(wrong, 1e-300)
        softness = max(harder, self.softness * _GROWTH)
        return SoftStick(softness, elastic) if softness < 1.0 else None
