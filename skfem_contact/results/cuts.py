"""Cuts across slender bodies, and the forces in them."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike

from ..arrays import left_of, max_abs, row_norms
from ..surfaces.vectors import dot
from ..units import kind_of

#: Coordinates on the axis of revolution, as a share of its length.
_ROUND_OFF = 1e-9


@dataclass(frozen=True)
class SectionForces:
    """Section forces along a body, exerted by the front on the back.

    They are arrays, shape (n,), vectors in space (n, 3). In a body of revolution they are per
    length of the circumference at the axis of the section. On the axis of revolution, in a pile,
    the normal force is per radian, and shear force and moment are zero.

    Attributes
    ----------
    position
        Position of the sections, as in :class:`~skfem_contact.Cuts`.
    x, y, z
        Coordinates of the sections; z is None in the plane.
    N
        Normal force, tension positive (a thrust is negative).
    V
        Shear force, in the plane to the left of the axis; ``V = dM/ds`` where no friction on a side
        of the body acts as a couple. In space a vector across the axis.
    M
        Moment, in the plane positive where the fibres to the left of the axis, the outer ones of a
        ring, are in tension. In space a vector across the axis.
    T
        Torque about the axis; None in the plane, like `axis`, its direction, (n, 3).
    N_hoop, M_hoop
        Normal force and moment around the axis of a body of revolution, per length along the
        section's axis, else None.
    """

    position: ndarray
    x: ndarray
    y: ndarray
    N: ndarray
    V: ndarray
    M: ndarray
    z: ndarray | None = None
    T: ndarray | None = None
    axis: ndarray | None = None
    N_hoop: ndarray | None = None
    M_hoop: ndarray | None = None

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the forces and moments in a plane."""
        if self.N_hoop is None:
            return ("N", "V", "M")
        return ("N", "V", "M", "N_hoop", "M_hoop")

    @property
    def _on_axis(self) -> bool:
        """True on the axis of revolution, where the normal force is per radian."""
        if self.N_hoop is None:
            return False
        return max_abs(self.x) <= _ROUND_OFF * max_abs(self.y)

    def kind(self, name: str) -> str:
        """Return the kind of the unit of a force or moment."""
        if name == "N" and self._on_axis:
            return "force per radian"
        return kind_of(name, self.T is not None)

    def towards(self, left: ArrayLike) -> SectionForces:
        """Return the section forces in a plane of bending in space, with the height for y.

        Parameters
        ----------
        left
            Direction across the axis, (3,): the shear force is positive to the left, the moment
            where the fibres on this side are in tension.

        Raises
        ------
        ValueError
            A direction along the axis, or section forces in the plane.
        """
        if self.axis is None or self.z is None:
            raise ValueError("section forces in the plane have one direction of bending only")
        # Take the part of the direction across the axis.
        direction = np.asarray(left, float)
        side = direction - (self.axis @ direction)[:, None] * self.axis
        length = row_norms(side)
        if not (length > 1e-9 * np.linalg.norm(direction)).all():
            raise ValueError(f"the side of a bent body lies across its axis, not at {left!r}")
        side = side / length[:, None]

        # The moment about the axis across both.
        bending_axis = np.cross(self.axis, side)
        return SectionForces(
            self.position,
            self.x,
            self.z,
            N=self.N,
            V=dot(self.V, side),
            M=-dot(self.M, bending_axis),
            T=self.T,
        )


@dataclass(frozen=True)
class Cuts:
    """Cuts across a slender body, made by :meth:`line` or :meth:`ring`.

    Attributes
    ----------
    position : ndarray, shape (n,)
        Coordinate of every cut for tables and diagrams: central angle or arc position.
    center, axis : ndarray, shape (n, dim)
        Points on the axis of the body, to which moments refer, and unit tangents in the sense of
        rising position.
    half_depth, curvature : ndarray, shape (n,)
        Half the depth of the body: elements farther from the axis are outside. Curvature of
        the axis, positive where it turns to the right.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> sc.Cuts.line((0., 0.), (0., -15.), depth=.2, n=4).position.tolist()
    [0.0, 5.0, 10.0, 15.0]
    >>> sc.Cuts.ring(center=(0., 0.), inner=.72, outer=.9, n=4).center[1].round(12).tolist()
    [0.81, 0.0]
    """

    position: ndarray
    center: ndarray
    axis: ndarray
    half_depth: ndarray
    curvature: ndarray

    @classmethod
    def ring(cls, center: ArrayLike, inner: float, outer: float, n: int = 72) -> Cuts:
        """Return radial cuts through a ring at equal central angles, from the crown clockwise.

        Parameters
        ----------
        center, inner, outer
            Centre of the ring and its radii.
        n
            Number of cuts; their positions are ``360 / n`` degrees apart.
        """
        # Check the ring.
        if not 0.0 < inner < outer:
            raise ValueError(
                f"a ring needs 0 < inner < outer, not inner={inner!r}, outer={outer!r}"
            )
        center = _point(center, "the center")
        _check_number(n, 1)
        # Place the cuts clockwise from the crown.
        middle = 0.5 * (inner + outer)
        position = np.arange(n) * 360.0 / n
        angle = np.radians(position)
        sin = np.sin(angle)
        cos = np.cos(angle)
        return cls(
            position,
            center + middle * np.column_stack((sin, cos)),
            np.column_stack((cos, -sin)),
            np.full(n, 0.5 * (outer - inner)),
            np.full(n, 1.0 / middle),
        )

    @classmethod
    def line(cls, start: ArrayLike, end: ArrayLike, depth: float, n: int = 51) -> Cuts:
        """Return cuts across a straight wall, pile or beam, from one end of its axis to the other.

        Parameters
        ----------
        start, end
            Ends of the axis, in the plane or in space; the position is the distance from the start.
        depth
            Depth of the body across its axis; in space the diameter of a cylinder that holds it.
        n
            Number of cuts, both ends included.
        """
        # Check the ends.
        dim = 2
        if np.size(start) == 3:
            dim = 3
        start = _point(start, "the start", dim)
        end = _point(end, "the end", dim)
        _check_number(n, 2)
        length = float(np.linalg.norm(end - start))
        if not (length > 0.0 and depth > 0.0):
            raise ValueError(
                f"a line of sections needs two different ends and a positive depth, not {depth!r}"
            )
        # Place the cuts at equal distances.
        position = np.linspace(0.0, length, n)
        axis = (end - start) / length
        return cls(
            position,
            start + position[:, None] * axis,
            np.tile(axis, (n, 1)),
            np.full(n, 0.5 * depth),
            np.zeros(n),
        )

    @property
    def left(self) -> ndarray:
        """Unit normals to the left of the axis, (n, 2): outward on a ring."""
        return left_of(self.axis)

    def moved(self, distance: ndarray) -> Cuts:
        """Return cuts that are moved along the curved axis, each by a distance, (n,)."""
        # The chord of the angle 2 h of an arc has the length ds sin(h) / h and the direction h.
        half = 0.5 * self.curvature * distance
        length = distance * np.sinc(half / np.pi)
        center = self.center + length[:, None] * self._turned(half)
        return replace(self, center=center, axis=self._turned(2.0 * half))

    def _turned(self, angle: ndarray) -> ndarray:
        """Return the axes, turned to the right by angles (n,)."""
        cos = np.cos(angle)[:, None]
        sin = np.sin(angle)[:, None]
        return cos * self.axis - sin * self.left

    def local(self, section: ndarray, points: ndarray) -> tuple[ndarray, ndarray]:
        """Return positions along the curved axis and distances to its left of points (m, dim).

        Positions count from the sections (m,). In space distances are to any side.
        """
        offset = points - self.center[section]
        axis = self.axis[section]
        s = np.einsum("mc,mc->m", offset, axis)
        if points.shape[1] == 3:
            return s, row_norms(offset - s[:, None] * axis)
        y = np.einsum("mc,mc->m", offset, self.left[section])

        # Take angle and radius, in units of 1 / k, about the centre of curvature.
        curvature = self.curvature[section]
        curved = curvature != 0.0
        if curved.any():
            k = curvature[curved]
            radius = 1.0 + k * y[curved] + 1j * k * s[curved]
            s[curved] = np.angle(radius) / k
            y[curved] = (np.abs(radius) - 1.0) / k
        return s, y


def _point(point: ArrayLike, name: str, dim: int = 2) -> ndarray:
    """Check the coordinates of a point."""
    coordinates = np.asarray(point, float)
    if coordinates.shape != (dim,) or not np.isfinite(coordinates).all():
        axes = "(x, y, z)"
        if dim == 2:
            axes = "(x, y)"
        raise ValueError(f"{name} of the sections must be a finite {axes}, not {point!r}")
    return coordinates


def _check_number(n: int, least: int) -> None:
    if not (isinstance(n, (int, np.integer)) and n >= least):
        raise ValueError(f"the number of sections must be an integer, at least {least}, not {n!r}")
