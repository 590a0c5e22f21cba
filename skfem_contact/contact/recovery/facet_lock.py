"""Points that chatter between two facets, or across an end: they stay on one until an equilibrium is found."""
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
class FacetLock(Recovery):
    """Points that are locked to a facet, also a little beyond its ends.

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

    def seen(self, state: ContactState, law: InterfaceLaw) -> ContactState:
        """On their facets."""
        return replace(state, facet=np.where(self.points, self.facet, state.facet))

    @property
    def reason(self) -> str:  # type: ignore[override]
        """Where the points rest, and what helps."""
        return (f"points {np.flatnonzero(self.points)} of '{self.slave}' rest on neither side of a joint between "
                "facets that turns, or of an end: smoothing the master takes the joints away")
