"""Points that chatter: between facets, between stick and slip, or between closed with their bond and open."""
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

#: Tangential penalty of the first solution with a soft stick: so many times the stiffness of the surfaces, and at most
#: this share of the penalty that is meant.
_FIRST, _SHARE = 10.0, 0.1
#: It grows from one solution to the next by this factor at least, and by more as long as that changes the tractions of
#: points that stick by no more than this share of the largest one.
_GROWTH, _CHANGE = 1.6, 0.05


@dataclass(frozen=True, eq=False)
class FacetLock(Recovery):
    """Points that are locked to a facet, also a little beyond its ends, until an equilibrium is found.

    At a joint that turns, the direction of a point's traction jumps, and off the end of a chain it is gone.  Locked, a
    point goes on along its facet, and Newton's method finds on which side of the joint it comes to rest.  Whether that
    is equilibrium of points that are free shows when the forms as given are assembled from what was found.

    Parameters
    ----------
    points
        Whether the point is locked, (n_points,).
    facet
        Facets to which they are, -1 for none, (n_points,).
    slave
        Name of the slave, for messages.
    """

    points: ndarray
    facet: ndarray
    slave: str

    @classmethod
    def begin(cls, pair: ContactPair, accepted: ContactState, failure: Failure | None) -> FacetLock | None:
        """Points that are not locked yet and change their facet; they stay where the first state has them."""
        if failure is None or not failure.seen:
            return None
        facets = np.array([state.facet for state in failure.seen])
        closed = np.array([state.status != Status.OPEN for state in failure.seen])
        absent = (facets == -1) | (facets[0] == -1)
        chatters = ((facets != facets[0]) & np.where(absent, closed | closed[0], closed & closed[0])).any(axis=0)
        before = pair.easing.of(cls) or cls(np.zeros_like(chatters), facets[0], pair.slave.name)
        chatters &= ~before.points
        if not chatters.any():
            return None
        between = [sorted(set(column)) for column in facets[:, chatters].T.tolist()]
        logger.info("points %s of '%s' chatter between the facets %s of '%s', -1 for none: locked to %s",
                    np.flatnonzero(chatters), pair.slave.name, between, pair.master.name, facets[0, chatters])
        return cls(chatters | before.points, np.where(chatters, facets[0], before.facet), pair.slave.name)

    def seen(self, state: ContactState) -> ContactState:
        """On their facets."""
        return replace(state, facet=np.where(self.points, self.facet, state.facet))

    @property
    def reason(self) -> str:
        """Where the points rest, and what helps."""
        return (f"points {np.flatnonzero(self.points)} of '{self.slave}' rest on neither side of a joint between "
                "facets that turns, or of an end: smoothing the master takes the joints away")


@dataclass(frozen=True, eq=False)
class SoftStick(Recovery):
    """Points that stick softly at first, and harder from solution to solution.

    Sticking points answer to an elastic slip e with the traction ``s epsilon_T (e + d)``, with a softness s < 1 and a
    shift d of the slip that would give the traction of the last solution, t, if its elastic slip were that of the whole
    penalty, ``t / epsilon_T``: ``d = t / (s epsilon_T) - t / epsilon_T``.  This is the augmented method, with t as the
    multiplier: from solution to solution the points come nearer to where they stick with the whole penalty, at which
    the last one is found.

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
        return cls(softness, pair.interface.elastic_slip(accepted))

    def seen(self, state: ContactState) -> ContactState:
        """With a softer penalty."""
        return replace(state, penalty_factor=state.penalty_factor * [1.0, self.softness])

    def slip(self, at: ndarray) -> ndarray:
        """Slip from a shifted stick point."""
        return np.asarray((self.elastic / self.softness - self.elastic)[:, at])

    def proceed(self, pair: ContactPair, accepted: ContactState, found: ContactState) -> SoftStick | None:
        """A harder stick, with the tractions of the last solution."""
        elastic = pair.interface.elastic_slip(found) * self.softness
        sticks = found.status == Status.STICK
        wrong = np.abs(pair.interface.elastic_slip(accepted, found) - elastic)[:, sticks].max(initial=0.0)
        harder = _CHANGE * np.abs(elastic).max() / max(wrong, 1e-300)
        softness = max(harder, self.softness * _GROWTH)
        return SoftStick(softness, elastic) if softness < 1.0 else None


@dataclass(frozen=True, eq=False)
class Debonding(Recovery):
    """Points whose bond is broken, for good: the law's internal variables say so from then on.

    The tractions of a brittle bond jump to zero as a point opens.  Then there may be no equilibrium: with its bond the
    point is drawn open, and without it pressed on.  Without the bond tractions do not jump.

    Parameters
    ----------
    points
        Whether the bond breaks, (n_points,).
    bond
        The law that has it.
    """

    points: ndarray
    bond: InterfaceLaw

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
        return cls(breaks | before.points if (before := pair.easing.of(cls)) else breaks, pair.law)

    def seen(self, state: ContactState) -> ContactState:
        """With broken bonds."""
        return replace(state, internal=np.where(self.points, self.bond.debonded(state.internal), state.internal))
