"""What the points of a contact pair remember."""
from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy import ndarray

from .quadrature import SlavePoints


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
