"""Growth of contact with dual multipliers: nodes that an increment closes, foreseen at its start.

Newton's method closes all nodes whose gaps are negative at its start.  These are too
many, because the bodies yield near the contact, and it opens them again row by row, one in each
iteration.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy import ndarray

from ..surfaces.surface import Surface
from .interface import ContactState
from .multipliers import mean_gaps

#: Share of a step, from the first node that it closes on, after which it closes no more: the
#: approach a^2 / R of a sphere closes gaps up to a^2 / 2R. In the plane this is right for a
#: half-width of ten elements, too.
_LATE = 0.5
#: Power of the gap beside the edge of contact that is in proportion to the distance from it.
_POWER = 2.0 / 3.0


def foreseen(
    pair: Any,
    start: ndarray,
    x: ndarray,
    before: ndarray | None,
    accepted: ContactState,
) -> ndarray:
    """Return a start with tension at nodes that stay open although the start closes their gaps.

    An extrapolated start moves the edge of the contact evenly.  Without displacements `before` the
    start is the first step from the accepted ones.
    """
    # Find open nodes with a negative gap at the start
    state = pair.effective(accepted)
    now = mean_gaps(pair, state, np.isfinite(accepted.gap), accepted.gap)
    then = _gaps_at_start(pair, start, state)
    reached = ~accepted.closed & (now > 0.0) & (now < np.inf) & (then < 0.0)
    if not reached.any():
        return start

    # Foresee which of them stay open: by the share of the step, or by the motion of the edge
    if before is None or not accepted.closed.any():
        opens = _closes_late(now, then, reached)
    else:
        last = x - before
        ratio = float(last @ (start - x)) / float(last @ last)
        found = pair.interface.closest(before, state.cuts, state.facet)
        earlier = mean_gaps(pair, state, found.found, found.gap)
        at_edge = _at_edge(pair.slave, accepted.closed)
        opens = reached & _stays_ahead(earlier, now, ratio, at_edge)
    if not opens.any():
        return start
    start = start.copy()
    start[pair.multipliers[0, opens]] = -2.0 * pair.penalties(state)[0] * then[opens]
    return start


def _closes_late(now: ndarray, then: ndarray, reached: ndarray) -> ndarray:
    """Return a mask of nodes that a step reaches late, counted from the first that it reaches."""
    share = np.zeros(len(now))
    share[reached] = now[reached] / (now[reached] - then[reached])
    first = share[reached].min()
    return share > first + _LATE * (1.0 - first)


def _stays_ahead(earlier: ndarray, now: ndarray, ratio: float, at_edge: ndarray) -> ndarray:
    """Return a mask of nodes ahead of the contact's edge, which moves `ratio` times as before.

    At the edge of contact of smooth bodies the gap grows like the power 3/2 of the distance, so
    that its power 2/3 is in proportion to the motion of the edge.  A node closes when the edge
    comes near it, for its gap is a mean over its facets: distances count from the node.  Open nodes
    `at_edge`, next to closed ones, are as far from it in the mean.
    """
    near = now[at_edge & (now < np.inf)]
    ahead = 0.0
    if len(near):
        ahead = max(float(near.mean()), 0.0)

    def distance(gap: ndarray) -> ndarray:
        return np.asarray(np.maximum(gap + ahead, 0.0) ** _POWER - ahead**_POWER)

    with np.errstate(invalid="ignore"):  # inf - inf where nothing is near
        return (1.0 + ratio) * distance(now) > ratio * distance(earlier)


def _at_edge(slave: Surface, closed: ndarray) -> ndarray:
    """Return a mask of open nodes on facets that have a closed one."""
    has_closed = closed[slave.facets].any(axis=1)
    at_edge = np.zeros(len(closed), bool)
    at_edge[slave.facets[has_closed]] = True
    return at_edge & ~closed


def _gaps_at_start(pair: Any, x: ndarray, state: ContactState) -> ndarray:
    """Return the nodes' mean gaps at x; the next evaluation does not project again."""
    slave, nodes = pair.interface.positions(x)
    depth = pair.interface.depth(pair.points(state))
    reach = state.clearance + depth
    found, _ = pair.interface.near(slave, nodes, state, reach, depth, pair.held(state))
    return mean_gaps(pair, state, found.found, found.gap)
