"""Section forces of slender bodies, in the plane and in space."""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike

from ..surfaces.vectors import dot


@dataclass(frozen=True)
class SectionForces:
    """Section forces along a body, arrays (n,).

    Attributes
    ----------
    position
        As in :class:`~skfem_contact.Sections`.
    x, y
        Place of the sections.
    N
        Normal force, tension positive (a thrust is negative).
    V
        Shear force: what the front exerts on the back to the left of the axis; ``V = dM/ds`` where no friction
        on a side of the body acts as a couple.
    M
        Moment, positive where the fibres to the left of the axis, the outer ones of a ring, are in tension.
    """

    position: ndarray
    x: ndarray
    y: ndarray
    N: ndarray
    V: ndarray
    M: ndarray


@dataclass(frozen=True)
class SpaceSectionForces(SectionForces):
    """Section forces along a straight body in space, what the front exerts on the back: arrays (n,) and (n, 3).

    Attributes
    ----------
    position
        Distance from the start of the axis, (n,).
    x, y, z
        Place of the sections, (n,).
    N
        Normal force, (n,), tension positive.
    V
        Shear force, a vector across the axis, (n, 3).
    M
        Bending moment, a vector across the axis, (n, 3).
    T
        Torque about the axis, (n,).
    axis
        Direction of the axis, (n, 3).
    """

    z: ndarray
    T: ndarray
    axis: ndarray

    def towards(self, left: ArrayLike) -> SectionForces:
        """Those of bending in a plane: shear force to the left, moment positive where the fibres there are in tension.

        Parameters
        ----------
        left
            Direction across the axis, (3,).

        Raises
        ------
        ValueError
            A direction along the axis.

        Returns
        -------
        SectionForces
            As in the plane, with the height for y: diagrams can be drawn of it.
        """
        side = np.asarray(left, float) - (self.axis @ np.asarray(left, float))[:, None] * self.axis
        length = np.linalg.norm(side, axis=1)
        if not (length > 1e-9 * np.linalg.norm(left)).all():
            raise ValueError(f"the side of a bent body lies across its axis, not at {left!r}")
        side = side / length[:, None]
        about = np.cross(self.axis, side)
        V, M = dot(self.V, side), -dot(self.M, about)
        return SectionForces(self.position, self.x, self.z, self.N, V, M)
