"""Section forces of rings, walls and piles from the nodal forces of their elements.

The resultant of a cut follows from equilibrium, not from sampled stresses. For a virtual motion that is zero behind the
cut and a rigid motion in front of it, the internal forces of the elements between do the work of the forces that the
front exerts on the back. The share ``phi`` of the motion rises linearly over the length of one layer of elements about
the cut. On a line of nodes the resultant is the mean of the nodal forces on both sides; between two lines it
interpolates. The resultants are in equilibrium with all loads and contact forces beyond, however coarse the mesh. Where
the body is joined to more on one side, at the face of a wall or at the corner of a frame, elements beside the sections
would do work in that motion. There the share jumps, from the nodes of the cut to those in front of it or behind it: the
resultant is that of the nodal forces of the elements on the free side.
"""
from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike
from scipy.spatial import cKDTree

from ..checks import format_point
from ..errors import warn
from ..forms.solid import SolidForm, SolidState
from ..layout import nodes as nodes_of
from ..surfaces.vectors import dot

#: Round-off of a position, as a share of the element: a cut through the end of a body meets its elements.
_ROUND_OFF = 1e-9


@dataclass(frozen=True)
class SectionForces:
    """Section forces along a body, exerted by the front on the back: arrays, shape (n,), vectors in space (n, 3).

    Attributes
    ----------
    position
        Position of the sections, as in :class:`~skfem_contact.Sections`.
    x, y, z
        Coordinates of the sections; z is None in the plane.
    N
        Normal force, tension positive (a thrust is negative).
    V
        Shear force, in the plane to the left of the axis; ``V = dM/ds`` where no friction on a side of the body acts as
        a couple. In space a vector across the axis.
    M
        Moment, in the plane positive where the fibres to the left of the axis, the outer ones of a ring, are in
        tension. In space a vector across the axis.
    T
        Torque about the axis; None in the plane, like `axis`, its direction, (n, 3).
    N_hoop, M_hoop
        Normal force and moment around the axis of a shell of revolution, else None.
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

    def towards(self, left: ArrayLike) -> SectionForces:
        """Return the section forces of bending in a plane, with the height for y, from those in space.

        Parameters
        ----------
        left
            Direction across the axis, (3,): the shear force is positive to the left, the moment where the fibres there
            are in tension.

        Raises
        ------
        ValueError
            A direction along the axis, or section forces in the plane.
        """
        if self.axis is None or self.z is None:
            raise ValueError("section forces in the plane have one direction of bending only")
        side = np.asarray(left, float) - (self.axis @ np.asarray(left, float))[:, None] * self.axis
        length = np.linalg.norm(side, axis=1)
        if not (length > 1e-9 * np.linalg.norm(left)).all():
            raise ValueError(f"the side of a bent body lies across its axis, not at {left!r}")
        side = side / length[:, None]
        about = np.cross(self.axis, side)
        V, M = dot(self.V, side), -dot(self.M, about)
        return SectionForces(self.position, self.x, self.z, self.N, V, M)


@dataclass(frozen=True)
class Sections:
    """Cuts across a slender body, made by :meth:`line` or :meth:`ring`.

    Attributes
    ----------
    position : ndarray, shape (n,)
        Coordinate of every cut for tables and diagrams: central angle or arc position.
    center, axis : ndarray, shape (n, dim)
        Points on the axis of the body, to which moments refer, and unit tangents in the sense of rising position.
    half_depth, curvature : ndarray, shape (n,)
        Half the depth of the body: elements farther from the axis do not belong to it. Curvature of the axis, positive
        where it turns to the right.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> sc.Sections.line((0., 0.), (0., -15.), depth=.2, n=4).position.tolist()
    [0.0, 5.0, 10.0, 15.0]
    >>> sc.Sections.ring(center=(0., 0.), inner=.72, outer=.9, n=4).center[1].round(12).tolist()
    [0.81, 0.0]
    """

    position: ndarray
    center: ndarray
    axis: ndarray
    half_depth: ndarray
    curvature: ndarray

    @classmethod
    def ring(cls, center: ArrayLike, inner: float, outer: float, n: int = 72) -> Sections:
        """Return radial cuts through a ring at equal central angles, from the crown clockwise.

        Parameters
        ----------
        center, inner, outer
            Centre of the ring and its radii.
        n
            Number of cuts; their positions are ``360 / n`` degrees apart.
        """
        if not 0.0 < inner < outer:
            raise ValueError(f"a ring needs 0 < inner < outer, not inner={inner!r}, outer={outer!r}")
        center = _point(center, "the center")
        _check_number(n, 1)
        middle = 0.5 * (inner + outer)
        position = np.arange(n) * 360.0 / n
        sin, cos = np.sin(np.radians(position)), np.cos(np.radians(position))
        return cls(position, center + middle * np.column_stack((sin, cos)),
                   np.column_stack((cos, -sin)), np.full(n, 0.5 * (outer - inner)), np.full(n, 1.0 / middle))

    @classmethod
    def line(cls, start: ArrayLike, end: ArrayLike, depth: float, n: int = 51) -> Sections:
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
        dim = 3 if np.size(start) == 3 else 2
        start, end = _point(start, "the start", dim), _point(end, "the end", dim)
        _check_number(n, 2)
        length = float(np.linalg.norm(end - start))
        if not (length > 0.0 and depth > 0.0):
            raise ValueError(f"a line of sections needs two different ends and a positive depth, not {depth!r}")
        position = np.linspace(0.0, length, n)
        axis = (end - start) / length
        return cls(position, start + position[:, None] * axis, np.tile(axis, (n, 1)),
                   np.full(n, 0.5 * depth), np.zeros(n))

    @property
    def left(self) -> ndarray:
        """Unit normals to the left of the axis, (n, 2): outward on a ring."""
        return np.column_stack((-self.axis[:, 1], self.axis[:, 0]))

    def moved(self, distance: ndarray) -> Sections:
        """Return cuts that are moved along the curved axis, each by a distance, (n,)."""
        half = 0.5 * self.curvature * distance
        chord = (distance * np.sinc(half / np.pi))[:, None]
        center = self.center + chord * (np.cos(half)[:, None] * self.axis - np.sin(half)[:, None] * self.left)
        axis = np.cos(2.0 * half)[:, None] * self.axis - np.sin(2.0 * half)[:, None] * self.left
        return replace(self, center=center, axis=axis)

    def local(self, section: ndarray, points: ndarray) -> tuple[ndarray, ndarray]:
        """Return positions along the curved axis and distances to its left, of points (m, dim) from sections (m,)."""
        offset = points - self.center[section]
        s = np.einsum("mc,mc->m", offset, self.axis[section])
        if points.shape[1] == 3:
            return s, np.linalg.norm(offset - s[:, None] * self.axis[section], axis=1)
        y = np.einsum("mc,mc->m", offset, self.left[section])
        k = self.curvature[section]
        curved = k != 0.0
        if curved.any():
            k = k[curved]
            radius = 1.0 + k * y[curved] + 1j * k * s[curved]  # from the centre of curvature, in units of 1/k
            s[curved], y[curved] = np.angle(radius) / k, (np.abs(radius) - 1.0) / k
        return s, y


def _point(point: ArrayLike, what: str, dim: int = 2) -> ndarray:
    """Check the coordinates of a point."""
    found = np.asarray(point, float)
    if found.shape != (dim,) or not np.isfinite(found).all():
        raise ValueError(f"{what} of the sections must be a finite {('(x, y)', '(x, y, z)')[dim - 2]}, not {point!r}")
    return found


def _check_number(n: int, least: int) -> None:
    if not (isinstance(n, (int, np.integer)) and n >= least):
        raise ValueError(f"the number of sections must be an integer, at least {least}, not {n!r}")


def section_forces(form: SolidForm, state: SolidState, sections: Sections | None) -> SectionForces:
    """Return normal force, shear force and moment at sections of a body."""
    if sections is None:
        raise ValueError("a solid needs `sections`, such as Sections.line(...); only a beam has its own")
    if (dim := form.basis.mesh.dim()) != sections.center.shape[1]:
        raise ValueError(f"these sections have {sections.center.shape[1]} coordinates, the body has {dim}")
    back, front = _lines(form, sections) if sections.curvature.any() else np.zeros((2, len(sections.position)))
    if not (back < front).any():
        return _resultants(sections, *_cut(form, state, sections))
    share = np.divide(-back, front - back, out=np.zeros_like(back), where=front > back)
    ends = [_resultants(moved, *_cut(form, state, moved)) for moved in map(sections.moved, (back, front))]
    N, V, M = ((1.0 - share) * getattr(ends[0], name) + share * getattr(ends[1], name) for name in "NVM")
    x, y = sections.center.T
    return SectionForces(sections.position, x, y, N, V, M)


def _lines(form: SolidForm, sections: Sections) -> tuple[ndarray, ndarray]:
    """Return distances to the lines of nodes behind and in front of each cut, (n,); zero for a cut on a line.

    Between lines the axis is a chord: a moment about the arc would miss the thrust times the distance of both.
    """
    section, _, _, s, inside = _layers(form, sections)
    section, s = section[inside], s[inside]
    ends = np.array((s.min(axis=1), s.max(axis=1)))
    between = (np.abs(ends).min(axis=0) > _ROUND_OFF * np.ptp(ends, axis=0)) & (ends[0] < 0.0) & (ends[1] > 0.0)
    count = np.maximum(np.bincount(section[between], minlength=len(sections.position)), 1)
    back, front = (np.bincount(section[between], end[between], minlength=len(count)) / count for end in ends)
    return back, front


def _layers(form: SolidForm, sections: Sections) -> tuple[ndarray, ndarray, ndarray, ndarray, ndarray]:
    """Return sections, near elements, nodes (pairs, nodes), positions of nodes along the axis, and masks.

    Masks are True for elements of the body that the sections cut.
    """
    nodes, dim = nodes_of(form.basis), len(form.basis.doflocs)
    points = form.basis.doflocs[:, dim * nodes]
    centroid = points.mean(axis=2).T
    largest = float(np.ptp(points, axis=2).max()) * np.sqrt(dim)
    hits = cKDTree(centroid).query_ball_point(sections.center, sections.half_depth + 1.5 * largest)
    section = np.repeat(np.arange(len(hits)), [len(h) for h in hits])
    element = np.concatenate([np.asarray(h, dtype=int) for h in hits])
    if not len(element):
        raise ValueError(f"the sections cut no element of the solid: it is not at {format_point(sections.center[0])}")
    flat = np.repeat(section, nodes.shape[1])
    s = sections.local(flat, points[:, element].reshape(dim, -1).T)[0].reshape(len(element), -1)
    inside = np.abs(sections.local(section, centroid[element])[1]) <= sections.half_depth[section]
    return section, element, nodes[element], s, inside


def _cut(form: SolidForm, state: SolidState, sections: Sections) -> tuple[ndarray, ndarray, ndarray]:
    """Return sections and nodes, (pairs, nodes, dim), of cut elements, and forces on the nodes by virtual motions."""
    n, dim = len(sections.position), len(form.basis.doflocs)
    section, element, nodes, s, inside = _layers(form, sections)
    length = np.ptp(s, axis=1)
    crossing = inside & (s.min(axis=1) <= _ROUND_OFF * length) & (s.max(axis=1) >= -_ROUND_OFF * length)
    count = np.bincount(section[crossing], minlength=n)
    if not count.all():
        at = sections.center[np.flatnonzero(count == 0)[0]]
        raise ValueError(f"{(count == 0).sum()} of {n} sections cut no element of the solid; the first is at "
                         f"{format_point(at)}")
    layer = np.bincount(section[crossing], length[crossing], minlength=n) / count
    phi, joined = _shares(section, nodes, s / layer[section, None], inside)
    deformed, key = np.ptp(phi, axis=1) > 0.0, _node_keys(section, nodes)
    active, beside = deformed & inside, deformed & ~inside
    _report_what_continues(form, sections, section, element, key, active & joined[section], beside)

    section, element, phi = section[active], element[active], phi[active]
    points = form.basis.doflocs[:, dim * nodes[active]].transpose(1, 2, 0)
    lowest, highest = np.full(n, 1.0), np.zeros(n)  # 0 and 1, but for the ends of the body
    np.minimum.at(lowest, section, phi.min(axis=1))
    np.maximum.at(highest, section, phi.max(axis=1))
    used, position = np.unique(element, return_inverse=True)
    forces = form.element_forces(state.stress, used).reshape(points.shape[1], -1, len(used))[:, :, position]
    return section, points, np.einsum("pn,ncp->pnc", phi / (highest - lowest)[section, None], forces)


def _shares(section: ndarray, nodes: ndarray, s: ndarray, inside: ndarray) -> tuple[ndarray, ndarray]:
    """Return the share of the virtual motion at nodes, (pairs, nodes), and sections where other elements do work."""
    linear, *jumps = np.clip(s + 0.5, 0.0, 1.0), np.where(s > _ROUND_OFF, 1.0, 0.0), np.where(s < -_ROUND_OFF, 0.0, 1.0)
    shares, key = linear, _node_keys(section, nodes)
    left = _do_work(section, key, linear, inside)
    for jump in jumps:
        deforms = np.bincount(section, (np.ptp(jump, axis=1) > 0.0) & inside) > 0  # nothing lies beyond an end
        free = left & deforms & ~_do_work(section, key, jump, inside)
        shares = np.where(free[section, None], jump, shares)
        left = left & ~free
    return shares, left


def _report_what_continues(form: SolidForm, sections: Sections, section: ndarray, element: ndarray, key: ndarray,
                           body: ndarray, beside: ndarray) -> None:
    """Report sections where a region has elements beside those of the body, (pairs,), and nodes with them."""
    region = np.repeat(np.arange(len(form.regions)), [len(range(form.basis.nelems)[r.elements]) for r in form.regions])
    key = region[element][:, None] * (key.max() + 1) + key
    continues = section[beside][np.isin(key[beside], key[body]).any(axis=1)]
    if len(continues):
        first = continues.min()
        warn(f"at {len(np.unique(continues))} of {len(sections.position)} sections, first at the position "
             f"{sections.position[first]:.4g}, the body continues beside the cut, whose depth is "
             f"{2.0 * sections.half_depth[first]:.4g}: forces are those of the elements within. Give the depth of the "
             "whole body and an axis in its middle, unless bodies cross there")


def _node_keys(section: ndarray, nodes: ndarray) -> ndarray:
    """Return one number for each node of each section, (pairs, nodes)."""
    return np.asarray(section[:, None] * (nodes.max() + 1) + nodes)


def _do_work(section: ndarray, key: ndarray, phi: ndarray, inside: ndarray) -> ndarray:
    """Return True for sections where elements beside the body, joined to its deformed ones, are deformed."""
    deformed = np.ptp(phi, axis=1) > 0.0
    beside = deformed & ~inside
    joined = np.isin(key[beside], key[deformed & inside]).any(axis=1)
    return np.bincount(section[beside][joined], minlength=int(section.max()) + 1) > 0


def _resultants(sections: Sections, section: ndarray, points: ndarray, forces: ndarray) -> SectionForces:
    """Return sums of nodal forces (pairs, nodes, dim) by section, with moments about the centres."""
    axis, arm = sections.axis, points - sections.center[section][:, None]
    force = _by_section(section, forces.sum(axis=1), len(axis))
    N, (x, y, *z) = dot(force, axis), sections.center.T
    if not z:
        clockwise = (arm[..., 1] * forces[..., 0] - arm[..., 0] * forces[..., 1]).sum(axis=1)
        V, M = dot(force, sections.left), _by_section(section, clockwise, len(axis))
        return SectionForces(sections.position, x, y, N, V, M)
    moment = _by_section(section, np.cross(arm, forces).sum(axis=1), len(axis))
    T = dot(moment, axis)
    V, M = force - N[:, None] * axis, moment - T[:, None] * axis
    return SectionForces(sections.position, x, y, N, V, M, z[0], T, axis)


def _by_section(section: ndarray, values: ndarray, n: int) -> ndarray:
    """Return sums of values (pairs, ...) in each of n sections."""
    total = np.zeros((n, *values.shape[1:]))
    np.add.at(total, section, values)
    return total
