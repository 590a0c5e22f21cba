"""Points that go to and fro between two facets, or across an end: they stay until the increment has been found."""
from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..laws import Status
from ..state import ContactState

logger = logging.getLogger("skfem_contact")


def frozen(state: ContactState, candidates: Sequence[ContactState], slave: str) -> ContactState:
    """The state with points frozen to their segment, or the same one where none goes to and fro.

    At a joint that turns, the direction of a point's traction jumps, and off the end of a chain it is gone.  A point
    that slides there may find equilibrium neither before nor after; frozen, it goes on along its facet, or has none.

    Parameters
    ----------
    state
        Accepted state.
    candidates
        States between which Newton's method goes to and fro; the points stay where the first one has them.
    slave
        Name of the slave, for the log.
    """
    segments = np.array([candidate.segment for candidate in candidates])
    closed = np.array([candidate.status != Status.OPEN for candidate in candidates])
    absent = (segments == -1) | (segments[0] == -1)
    roams = ((segments != segments[0]) & np.where(absent, closed | closed[0], closed & closed[0])).any(axis=0)
    roams &= ~state.frozen
    if not roams.any():
        return state
    logger.info("points %s of '%s' go to and fro between the facets %s of the master, -1 for none: they stay on %s",
                np.flatnonzero(roams), slave, [sorted(set(column)) for column in segments[:, roams].T.tolist()],
                segments[0, roams])
    return replace(state, frozen=state.frozen | roams, segment=np.where(roams, segments[0], state.segment))
