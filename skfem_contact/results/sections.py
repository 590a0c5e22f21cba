"""Section forces of rings, walls and piles from the nodal forces of their elements.

The resultant of a cut follows from equilibrium, not from sampled stresses. For a virtual motion
that is zero behind the cut and a rigid motion in front of it, the internal forces of the elements
between do the work of the forces that the front exerts on the back. The share ``phi`` of the motion
rises linearly over the length of one layer of elements about the cut. On a line of nodes the
resultant is the mean of the nodal forces on both sides; between two lines it interpolates. The
resultants are in equilibrium with all loads and contact forces beyond, however coarse the mesh.
Where the body is joined to more on one side, at the face of a wall or at the corner of a frame,
elements beside the sections would do work in that motion. There the share jumps, from the nodes of
the cut to those in front of it or behind it: the resultant is that of the nodal forces of the
elements on the free side.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy import ndarray
from scipy.spatial import cKDTree

from ..checks import format_point
from ..errors import warn
from ..forms.solid import SolidForm, SolidState
from ..layout import nodes as nodes_of
from ..surfaces.vectors import dot
from .cuts import SectionForces, Sections

#: Round-off of a position, as a share of the element: a cut through the end of a body meets its
#: elements.
_ROUND_OFF = 1e-9


def section_forces(form: SolidForm, state: SolidState, sections: Sections | None) -> SectionForces:
    """Return normal force, shear force and moment at sections of a body."""
    if sections is None:
        raise ValueError(
            "a solid needs `sections`, such as Sections.line(...); only a beam has its own"
        )
    if (dim := form.basis.mesh.dim()) != sections.center.shape[1]:
        raise ValueError(
            f"these sections have {sections.center.shape[1]} coordinates, the body has {dim}"
        )
    back, front = (
        _lines(form, sections)
        if sections.curvature.any()
        else np.zeros((2, len(sections.position)))
    )
    if not (back < front).any():
        return _at(form, state, sections)
    share = np.divide(-back, front - back, out=np.zeros_like(back), where=front > back)
    one, other = (_at(form, state, moved) for moved in map(sections.moved, (back, front)))
    x, y = sections.center.T
    return SectionForces(
        sections.position,
        x,
        y,
        **{
            name: (1.0 - share) * getattr(one, name) + share * getattr(other, name)
            for name in one.names
        },
    )


def _at(form: SolidForm, state: SolidState, sections: Sections) -> SectionForces:
    """Return the section forces at sections on lines of nodes.

    A rigid motion across the axis of revolution stretches circles: hoop stresses are left out.
    Forces by an angle are divided by the mean radius of the layer, that by equal stresses on the
    cut over that by stresses 1 / r.  An equal stress in the plane of as much as the hoop stress
    over r has the resultants of the hoop stress.
    """
    if form.coordinates != "axisymmetric":
        section, points, (forces,) = _cut(form, [state.stress], sections)
        return _resultants(sections, section, points, forces)
    hoop, equal, r = (
        state.stress[2],
        np.zeros_like(state.stress),
        np.asarray(form.basis.global_coordinates())[0],
    )
    plane, equal[:2] = state.stress - hoop * np.eye(len(equal))[2][:, None, None], 1.0
    section, points, parts = _cut(form, [plane, equal, equal / r, equal * hoop / r], sections)
    found, turned, straight, around = (
        _resultants(sections, section, points, part) for part in parts
    )
    pile = (
        np.abs(np.column_stack((sections.center[:, 0] / r.max(), sections.axis[:, 0]))).max(axis=1)
        < _ROUND_OFF
    )
    radius = straight.N / turned.N
    width, across = np.where(pile, 1.0, radius), np.where(pile, 0.0, radius)
    return replace(
        found,
        N=width * found.N,
        V=across * found.V,
        M=across * found.M,
        N_hoop=around.N,
        M_hoop=around.M,
    )


def _lines(form: SolidForm, sections: Sections) -> tuple[ndarray, ndarray]:
    """Return distances to the lines of nodes behind and in front of each cut, (n,); zero for a cut
    on a line.

    Between lines the axis is a chord: a moment about the arc would miss the thrust times the
    distance of both.
    """
    section, _, _, s, inside = _layers(form, sections)
    section, s = section[inside], s[inside]
    ends = np.array((s.min(axis=1), s.max(axis=1)))
    between = (
        (np.abs(ends).min(axis=0) > _ROUND_OFF * np.ptp(ends, axis=0))
        & (ends[0] < 0.0)
        & (ends[1] > 0.0)
    )
    count = np.maximum(np.bincount(section[between], minlength=len(sections.position)), 1)
    back, front = (
        np.bincount(section[between], end[between], minlength=len(count)) / count for end in ends
    )
    return back, front


def _layers(
    form: SolidForm, sections: Sections
) -> tuple[ndarray, ndarray, ndarray, ndarray, ndarray]:
    """Return sections, near elements, nodes (pairs, nodes), positions of nodes along the axis, and
    masks.

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
        raise ValueError(
            f"the sections cut no element of the solid: it is not at "
            f"{format_point(sections.center[0])}"
        )
    flat = np.repeat(section, nodes.shape[1])
    s = sections.local(flat, points[:, element].reshape(dim, -1).T)[0].reshape(len(element), -1)
    inside = np.abs(sections.local(section, centroid[element])[1]) <= sections.half_depth[section]
    return section, element, nodes[element], s, inside


def _cut(
    form: SolidForm, stresses: Sequence[ndarray], sections: Sections
) -> tuple[ndarray, ndarray, list[ndarray]]:
    """Return sections and nodes, (pairs, nodes, dim), of cut elements, and forces by virtual
    motions of each stress.
    """
    n, dim = len(sections.position), len(form.basis.doflocs)
    section, element, nodes, s, inside = _layers(form, sections)
    length = np.ptp(s, axis=1)
    crossing = (
        inside & (s.min(axis=1) <= _ROUND_OFF * length) & (s.max(axis=1) >= -_ROUND_OFF * length)
    )
    count = np.bincount(section[crossing], minlength=n)
    if not count.all():
        at = sections.center[np.flatnonzero(count == 0)[0]]
        raise ValueError(
            f"{(count == 0).sum()} of {n} sections cut no element of the solid; the first is at "
            f"{format_point(at)}"
        )
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
    forces = (
        form.element_forces(stress, used).reshape(points.shape[1], -1, len(used))
        for stress in stresses
    )
    share = phi / (highest - lowest)[section, None]
    return (
        section,
        points,
        [np.einsum("pn,ncp->pnc", share, force[:, :, position]) for force in forces],
    )


def _shares(
    section: ndarray, nodes: ndarray, s: ndarray, inside: ndarray
) -> tuple[ndarray, ndarray]:
    """Return the share of the virtual motion at nodes, (pairs, nodes), and sections where other
    elements do work.
    """
    linear, *jumps = (
        np.clip(s + 0.5, 0.0, 1.0),
        np.where(s > _ROUND_OFF, 1.0, 0.0),
        np.where(s < -_ROUND_OFF, 0.0, 1.0),
    )
    shares, key = linear, _node_keys(section, nodes)
    left = _do_work(section, key, linear, inside)
    for jump in jumps:
        deforms = (
            np.bincount(section, (np.ptp(jump, axis=1) > 0.0) & inside) > 0
        )  # nothing lies beyond an end
        free = left & deforms & ~_do_work(section, key, jump, inside)
        shares = np.where(free[section, None], jump, shares)
        left = left & ~free
    return shares, left


def _report_what_continues(
    form: SolidForm,
    sections: Sections,
    section: ndarray,
    element: ndarray,
    key: ndarray,
    body: ndarray,
    beside: ndarray,
) -> None:
    """Report sections where a region has elements beside those of the body, (pairs,), and nodes
    with them.
    """
    region = np.repeat(
        np.arange(len(form.regions)),
        [len(range(form.basis.nelems)[r.elements]) for r in form.regions],
    )
    key = region[element][:, None] * (key.max() + 1) + key
    continues = section[beside][np.isin(key[beside], key[body]).any(axis=1)]
    if len(continues):
        first = continues.min()
        warn(
            f"at {len(np.unique(continues))} of {len(sections.position)} sections, first at the "
            f"position "
            f"{sections.position[first]:.4g}, the body continues beside the cut, whose depth is "
            f"{2.0 * sections.half_depth[first]:.4g}: forces are those of the elements within. "
            f"Give the depth of the "
            "whole body and an axis in its middle, unless bodies cross there"
        )


def _node_keys(section: ndarray, nodes: ndarray) -> ndarray:
    """Return one number for each node of each section, (pairs, nodes)."""
    return np.asarray(section[:, None] * (nodes.max() + 1) + nodes)


def _do_work(section: ndarray, key: ndarray, phi: ndarray, inside: ndarray) -> ndarray:
    """Return True for sections where elements beside the body, joined to its deformed ones, are
    deformed.
    """
    deformed = np.ptp(phi, axis=1) > 0.0
    beside = deformed & ~inside
    joined = np.isin(key[beside], key[deformed & inside]).any(axis=1)
    return np.bincount(section[beside][joined], minlength=int(section.max()) + 1) > 0


def _resultants(
    sections: Sections, section: ndarray, points: ndarray, forces: ndarray
) -> SectionForces:
    """Return sums of nodal forces (pairs, nodes, dim) by section, with moments about the
    centres.
    """
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
