"""What the points of a contact pair remember."""
from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy import ndarray

from .quadrature import SlavePoints


@dataclass(frozen=True)
class ContactState:
    """State of a contact pair, arrays (n_points,).

    Attributes
    ----------
    stick_point
        Arc position on the undeformed master to which each point sticks; NaN where it has no counterpart.
    arc
        Arc position of the closest point on the master.
    segment
        Segment of the master with the closest point, -1 where there is none.
    gap, slip
        Normal gap (negative: penetration, inf: nothing opposite) and slip since the point closed.
    normal, tangential
        Tractions: normal negative in compression; the tangential one opposes the slip.
    status
        :class:`~skfem_contact.Status`.
    normal_multiplier, tangential_multiplier
        Lagrange multipliers of the augmented method at the slave's nodes, (n_nodes,); zero in the penalty method.
    stiffening
        Factors by which the augmented method has changed the normal and the tangential penalty, (2,).
    offset
        Gap that counts as touching: the initial one where it was adjusted.
    cuts
        Chain coordinates at which ``quadrature="segments"`` cuts the slave; empty for other rules.
    springs
        Stiffness of the springs that hold open points until contact does, as a share of the penalty, (1,).
    frozen
        Whether the point stays on its segment in the increment that begins here.
    recuts
        Number of times that the slave has been cut anew in this increment, (1,).
    softness
        Share of the tangential penalty with which points stick while they cycle between stick and slip, (1,).
    shift
        What is added to the elastic slip of points that stick softly, along the undeformed master; zero else.
    internal
        Internal variables of the law, (n_internal, n_points).
    correction, stalls
        What the augmented method corrected the normal and the tangential multipliers by the last time, over the
        penalties, and how many times in a row that had not become less, (2, n_nodes); empty before the first time.
    """

    stick_point: ndarray
    arc: ndarray
    segment: ndarray
    gap: ndarray
    slip: ndarray
    normal: ndarray
    tangential: ndarray
    status: ndarray
    normal_multiplier: ndarray
    tangential_multiplier: ndarray
    stiffening: ndarray
    offset: ndarray
    cuts: ndarray
    springs: ndarray
    frozen: ndarray
    recuts: ndarray
    softness: ndarray
    shift: ndarray
    internal: ndarray
    correction: ndarray = field(default_factory=lambda: np.zeros((2, 0)))
    stalls: ndarray = field(default_factory=lambda: np.zeros((2, 0), int))


def transferred(state: ContactState, old: SlavePoints, new: SlavePoints) -> ContactState:
    """Carry a state from the slave's old points over to new ones: by interpolation along the slave.

    Positions on the master, and what is no smooth field, come from the nearest old point.
    """
    nearest = np.abs(new.arc[:, None] - old.arc).argmin(axis=1)
    smooth = {name: np.interp(new.arc, old.arc, getattr(state, name)) for name in (
        "slip", "normal", "tangential", "offset", "shift")}
    elastic = np.interp(new.arc, old.arc, np.nan_to_num(state.arc - state.stick_point))
    # master and slave run in opposite directions: what lies on along the slave lies back along the master
    arc = state.arc[nearest] - (new.arc - old.arc[nearest])
    return replace(state, arc=arc, stick_point=arc - elastic, segment=state.segment[nearest], gap=state.gap[nearest],
                   status=state.status[nearest], frozen=state.frozen[nearest],
                   internal=state.internal[:, nearest], **smooth)
