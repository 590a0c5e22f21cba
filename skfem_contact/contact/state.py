"""What the points of a contact pair remember."""
from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy import ndarray

from .laws import Status, Update
from .quadrature import SlavePoints
from .search import Projection
from .surface import Surface


@dataclass(frozen=True)
class ContactState:
    """State of a contact pair with ``n`` points; the plane has ``dim = 2``.

    Attributes
    ----------
    facet
        Facet of the master with the closest point, (n,), -1 where there is none.
    position
        Arc position of the closest point on the undeformed master, (n,), NaN where there is none.
    stick_point
        Arc position to which each point sticks, (n,); NaN where it has no counterpart.
    gap
        Normal gap, (n,); negative: penetration, inf: nothing opposite.
    slip
        Slip since the point closed, (dim - 1, n).
    traction
        Normal traction, negative in compression, then shear, which opposes the slip, (dim, n).
    status
        :class:`~skfem_contact.Status`, (n,).
    internal
        Internal variables of the law, (n_internal, n).
    multiplier
        Lagrange multipliers of the augmented method at the slave's nodes, (dim, n_nodes); zero in the penalty method.
    penalty_factor
        Factors by which the augmented method has changed the normal and the tangential penalty, (2,).
    offset
        Gap that counts as touching: the initial one where it was adjusted, (n,).
    cuts
        Chain coordinates at which ``quadrature="segments"`` cuts the slave; empty for other rules.
    """

    facet: ndarray
    position: ndarray
    stick_point: ndarray
    gap: ndarray
    slip: ndarray
    traction: ndarray
    status: ndarray
    internal: ndarray
    multiplier: ndarray
    penalty_factor: ndarray
    offset: ndarray
    cuts: ndarray


def closest(master: Surface, found: Projection) -> tuple[ndarray, ndarray]:
    """Facets and arc positions of closest points, as a state holds them."""
    position, at = np.full(len(found.gap), np.nan), np.isfinite(found.gap)
    position[at] = master.arc(found.segment[at], found.xi[at])[0]
    return np.where(found.found, found.segment, -1), position


def follow(state: ContactState, master: Surface, found: Projection, at: ndarray, update: Update, elastic: ndarray
           ) -> ContactState:
    """The candidate state: open points take their closest point along as stick point, sliding ones drag it (eq. 10).

    Parameters
    ----------
    state
        Accepted state.
    master
        The master.
    found
        Closest points of all points.
    at, update
        Points that the law reaches, and its answer for them.
    elastic
        Distance along the undeformed master from their new stick points.
    """
    facet, position = closest(master, found)
    stick_point, internal, traction = position.copy(), state.internal.copy(), np.zeros_like(state.traction)
    status = np.full(len(position), int(Status.OPEN))
    stick_point[at] -= elastic
    traction[:, at], status[at], internal[:, at] = update.traction, update.status, update.internal
    moved = master.along(position - state.position)
    slip = np.where(status == Status.OPEN, 0.0, state.slip + np.where(np.isnan(moved), 0.0, moved))
    return replace(state, facet=facet, position=position, stick_point=stick_point, gap=found.gap, slip=slip,
                   traction=traction, status=status, internal=internal)


def transferred(state: ContactState, old: SlavePoints, new: SlavePoints) -> ContactState:
    """Carry a state from the slave's old points over to new ones: by interpolation along the slave.

    Positions on the master, and what is no smooth field, come from the nearest old point.
    """
    def smooth(values: ndarray) -> ndarray:
        return np.array([np.interp(new.arc, old.arc, row) for row in np.atleast_2d(values)])

    at = nearest(old, new)
    elastic = smooth(np.nan_to_num(state.position - state.stick_point))[0]
    # master and slave run in opposite directions: what lies on along the slave lies back along the master
    position = state.position[at] - (new.arc - old.arc[at])
    return replace(state, position=position, stick_point=position - elastic, facet=state.facet[at], gap=state.gap[at],
                   status=state.status[at], internal=state.internal[:, at], slip=smooth(state.slip),
                   traction=smooth(state.traction), offset=smooth(state.offset)[0])


def nearest(old: SlavePoints, new: SlavePoints) -> ndarray:
    """Number of the old point nearest to each new one, along the slave."""
    return np.asarray(np.abs(new.arc[:, None] - old.arc).argmin(axis=1))
