"""What the points of a contact pair remember."""
from __future__ import annotations

from dataclasses import dataclass

from numpy import ndarray


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
        Normal gap (negative: penetration, inf: nothing near) and slip since the point closed.
    normal, tangential
        Tractions: normal negative in compression; the tangential one opposes the slip.
    status
        :class:`~skfem_contact.Status`.
    normal_multiplier, tangential_multiplier
        Lagrange multipliers of the augmented method at the slave's nodes, (n_nodes,); zero in the penalty method.
    stiffening
        Factor by which the augmented method has changed the penalty, (1,).
    offset
        Gap that counts as touching: the initial one where it was adjusted.
    cuts
        Chain coordinates at which ``quadrature="segments"`` cuts the slave; empty for other rules.
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
