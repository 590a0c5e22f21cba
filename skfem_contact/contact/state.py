"""What the points of a contact pair remember."""
from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy import ndarray

from ..surfaces.material_points import MaterialPoints
from .laws import Status, Update
from .search import Projection


@dataclass(frozen=True)
class ContactState:
    """State of a contact pair with ``n`` points; the plane has ``dim = 2``.

    In space slips and shear tractions have two components: one along the slave's ``directions``, as its material
    carries them along, and one to the left of that, seen from the slave's side.

    Attributes
    ----------
    facet, position
        Facet of the master with the closest point, (n,), -1 where there is none, and local coordinates there,
        (dim - 1, n).
    stick_facet, stick_point
        Material point of the master to which each point sticks, likewise; -1 where it has no counterpart.
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
        Where ``quadrature="segments"`` cuts the slave: facet numbers plus shares of the facet in the plane, points of
        the pieces in space; empty for other rules.
    """

    facet: ndarray
    position: ndarray
    stick_facet: ndarray
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

    @property
    def closest(self) -> MaterialPoints:
        """Closest points on the master."""
        return MaterialPoints(self.facet, self.position.T)

    @property
    def stick(self) -> MaterialPoints:
        """Stick points on the master."""
        return MaterialPoints(self.stick_facet, self.stick_point.T)

    def after(self, found: Projection, at: ndarray, update: Update, stick: MaterialPoints, slip: ndarray
              ) -> ContactState:
        """The state that is found; open points take their closest point along as stick point.

        The law reaches the points `at`, with this answer and these stick points; slips count if they have not opened.
        """
        closest, traction, internal = found.closest, np.zeros_like(self.traction), self.internal.copy()
        facet, xi, status = closest.facet.copy(), closest.xi.copy(), np.full(len(found.gap), int(Status.OPEN))
        facet[at], xi[at] = stick
        traction[:, at], status[at], internal[:, at] = update.traction, update.status, update.internal
        return replace(self, facet=closest.facet, position=closest.xi.T, stick_facet=facet, stick_point=xi.T,
                       gap=found.gap, slip=np.where(status == Status.OPEN, 0.0, slip), traction=traction,
                       status=status, internal=internal)

    def with_stick(self, stick: MaterialPoints) -> ContactState:
        """The state with other stick points."""
        return replace(self, stick_facet=stick.facet, stick_point=stick.xi.T)
