"""Section forces of rings, walls and piles from the nodal forces of their elements.

The resultant of a cut follows from equilibrium, not from sampled stresses. For a virtual motion
that is zero behind the cut and a rigid motion in front of it, the internal forces of the elements
between do the work of the forces that the front exerts on the back. The share ``phi`` of the motion
rises linearly over the length of one layer of elements about the cut. On a line of nodes the
resultant is the mean of the nodal forces on both sides; between two lines it interpolates. The
resultants are in equilibrium with all loads and contact forces beyond, however coarse the mesh.
Where the body is joined to more on one side, at the face of a wall or at the corner of a frame,
elements outside the body would do work in this motion. At these sections the share jumps, from the
nodes of the cut to the nodes in front of it or behind it: the resultant is the sum of the nodal
forces of the elements on the free side.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import scipy
from numpy import ndarray

from ..arrays import quotient
from ..checks import format_point
from ..errors import warn
from ..forms.solid import SolidForm, SolidState
from ..layout import nodes as nodes_of
from ..surfaces.vectors import dot
from .cuts import Cuts, SectionForces
from .patch_recovery import element_regions

#: Round-off of a position, as a share of the element: a cut through the end of a body meets its
#: elements.
_ROUND_OFF = 1e-9


def section_forces(form: SolidForm, state: SolidState, sections: Cuts | None) -> SectionForces:
    """Return normal force, shear force and moment at sections of a body."""
    if form.kinematics == "finite":
        raise ValueError("section forces are of small kinematics: this solid has finite ones")
    # Check the sections.
    if sections is None:
        raise ValueError(
            "a solid needs `sections`, such as Cuts.line(...); only a beam has its own"
        )
    dim = form.basis.mesh.dim()
    if dim != sections.center.shape[1]:
        raise ValueError(
            f"these sections have {sections.center.shape[1]} coordinates, the body has {dim}"
        )
    if not sections.curvature.any():
        return _at(form, state, sections)
    back, front = _lines(form, sections)
    if not (back < front).any():
        return _at(form, state, sections)

    # Interpolate linearly between the lines of nodes behind and in front of each section.
    behind = _at(form, state, sections.moved(back))
    ahead = _at(form, state, sections.moved(front))
    share = quotient(-back, front - back)
    forces = {}
    for name in behind.names:
        forces[name] = (1.0 - share) * getattr(behind, name) + share * getattr(ahead, name)
    x, y = sections.center.T
    return SectionForces(sections.position, x, y, **forces)


def _at(form: SolidForm, state: SolidState, sections: Cuts) -> SectionForces:
    """Return the section forces at sections on lines of nodes.

    In axial symmetry a rigid motion across the axis of revolution stretches circles: hoop stresses
    are left out. Forces per radian are divided by the mean radius of the layer,

        r_mean = N(sigma = 1) / N(sigma = 1 / r) .

    Equal stresses ``sigma_hoop / r`` in the plane have the resultants of the hoop stress.
    """
    if form.coordinates != "axisymmetric":
        cut, parts = _cut(form, [state.stress], sections)
        return _resultants(sections, cut, parts[0])

    # Cut the stresses in the plane, equal ones, equal ones over r, and the hoop stresses.
    r = np.asarray(form.basis.global_coordinates())[0]
    hoop = state.stress[2]
    zz = np.eye(len(state.stress))[2]
    plane = state.stress - hoop * zz[:, None, None]
    equal = np.zeros_like(state.stress)
    equal[:2] = 1.0
    cut, parts = _cut(form, [plane, equal, equal / r, equal * hoop / r], sections)
    forces, turned, straight, around = (_resultants(sections, cut, part) for part in parts)

    # A pile on the axis of revolution has its normal force per radian, and no bending.
    off_axis = sections.center[:, 0] / r.max()
    across_axis = np.column_stack((off_axis, sections.axis[:, 0]))
    on_axis = np.abs(across_axis).max(axis=1) < _ROUND_OFF
    radius = straight.N / turned.N
    across = np.where(on_axis, 0.0, radius)
    return replace(
        forces,
        N=np.where(on_axis, 1.0, radius) * forces.N,
        V=across * forces.V,
        M=across * forces.M,
        N_hoop=around.N,
        M_hoop=around.M,
    )


def _lines(form: SolidForm, sections: Cuts) -> tuple[ndarray, ndarray]:
    """Return distances to the lines of nodes behind and in front of each cut, (n,), or zero.

    Between lines the axis is a chord: a moment about the arc would miss the thrust times the
    distance of both. The distances of a cut on a line are zero.
    """
    layers = _layers(form, sections)
    # Select elements between whose lines of nodes a cut lies.
    section = layers.section[layers.inside]
    s = layers.s[layers.inside]
    lowest = s.min(axis=1)
    highest = s.max(axis=1)
    off_lines = np.minimum(np.abs(lowest), np.abs(highest)) > _ROUND_OFF * (highest - lowest)
    between = off_lines & (lowest < 0.0) & (highest > 0.0)

    # Take means over the elements of each cut.
    n = len(sections.position)
    section = section[between]
    count = np.maximum(np.bincount(section, minlength=n), 1)
    back = np.bincount(section, lowest[between], minlength=n) / count
    front = np.bincount(section, highest[between], minlength=n) / count
    return back, front


class _Layers(NamedTuple):
    """Pairs of sections and elements near them; `inside` where the element is of the body."""

    section: ndarray
    element: ndarray
    nodes: ndarray  # (pairs, nodes)
    s: ndarray  # positions of the nodes along the axis, (pairs, nodes)
    inside: ndarray

    @property
    def keys(self) -> ndarray:
        """One number for each node of each section, (pairs, nodes)."""
        n_nodes = self.nodes.max() + 1
        return np.asarray(self.section[:, None] * n_nodes + self.nodes)


class _Cut(NamedTuple):
    """Pairs of sections and cut elements with the coordinates of the nodes, (pairs, nodes, dim)."""

    section: ndarray
    points: ndarray


def _layers(form: SolidForm, sections: Cuts) -> _Layers:
    """Return the elements near sections."""
    nodes = nodes_of(form.basis)
    dim = len(form.basis.doflocs)
    points = form.basis.doflocs[:, dim * nodes]  # (dim, n_elements, nodes)
    centroid = points.mean(axis=2).T
    largest = float(np.ptp(points, axis=2).max()) * np.sqrt(dim)
    near = sections.half_depth + 1.5 * largest

    # Pair each section with the elements around its centre.
    hits = scipy.spatial.cKDTree(centroid).query_ball_point(sections.center, near)
    section = np.repeat(np.arange(len(hits)), [len(hit) for hit in hits])
    element = np.concatenate([np.asarray(hit, dtype=int) for hit in hits])
    if not len(element):
        raise ValueError(
            f"the sections cut no element of the solid: it is not at "
            f"{format_point(sections.center[0])}"
        )

    # Find the positions of their nodes along the axis, and the elements within the depth.
    section_of_nodes = np.repeat(section, nodes.shape[1])
    s, _ = sections.local(section_of_nodes, points[:, element].reshape(dim, -1).T)
    s = s.reshape(len(element), -1)
    _, offset = sections.local(section, centroid[element])
    inside = np.abs(offset) <= sections.half_depth[section]

    # Leave out elements on the other side of a ring, where positions jump by its circumference.
    here = np.abs(sections.curvature[section]) * np.ptp(s, axis=1) < np.pi
    return _Layers(section[here], element[here], nodes[element[here]], s[here], inside[here])


def _cut(
    form: SolidForm, stresses: Sequence[ndarray], sections: Cuts
) -> tuple[_Cut, list[ndarray]]:
    """Return cut elements, and their nodal forces, (pairs, nodes, dim), of each stress.

    The forces are multiplied by the share ``phi`` of the virtual motion at the nodes.
    """
    # Scale positions by the mean length of the elements that each section crosses.
    layers = _layers(form, sections)
    section = layers.section
    crossing, length = _crossing(layers)
    n = len(sections.position)
    count = np.bincount(section[crossing], minlength=n)
    if not count.all():
        missed = sections.center[np.flatnonzero(count == 0)[0]]
        raise ValueError(
            f"{(count == 0).sum()} of {n} sections cut no element of the solid; the first is at "
            f"{format_point(missed)}"
        )
    layer = np.bincount(section[crossing], length[crossing], minlength=n) / count

    # Find the deformed elements of the body, and warn where the body continues outside.
    phi, joined = _shares(layers, layers.s / layer[section, None])
    deformed = np.ptp(phi, axis=1) > 0.0
    active = deformed & layers.inside
    _report_continued(form, sections, layers, active & joined[section], deformed & ~layers.inside)

    # Scale phi to 0 and 1 at the ends of the body, too.
    section = section[active]
    element = layers.element[active]
    phi = phi[active]
    lowest = np.full(n, 1.0)
    highest = np.zeros(n)
    np.minimum.at(lowest, section, phi.min(axis=1))
    np.maximum.at(highest, section, phi.max(axis=1))
    share = phi / (highest - lowest)[section, None]

    # Multiply the nodal forces of the elements by the shares of their nodes.
    dim = len(form.basis.doflocs)
    points = form.basis.doflocs[:, dim * layers.nodes[active]].transpose(1, 2, 0)
    used, position = np.unique(element, return_inverse=True)
    parts = []
    for stress in stresses:
        force = form.element_forces(stress, used).reshape(points.shape[1], dim, len(used))
        parts.append(np.einsum("pn,ncp->pnc", share, force[:, :, position]))
    return _Cut(section, points), parts


def _crossing(layers: _Layers) -> tuple[ndarray, ndarray]:
    """Return True for elements of the body that the section meets, and lengths along the axis."""
    lowest = layers.s.min(axis=1)
    highest = layers.s.max(axis=1)
    length = highest - lowest
    meets = (lowest <= _ROUND_OFF * length) & (highest >= -_ROUND_OFF * length)
    return layers.inside & meets, length


def _shares(layers: _Layers, s: ndarray) -> tuple[ndarray, ndarray]:
    """Return the share of the motion at nodes, (pairs, nodes), and sections with outside work.

    Outside work is done by elements that are joined to the body but not of it.
    """
    shares = np.clip(s + 0.5, 0.0, 1.0)
    remaining = _works_outside(layers, shares)
    ahead = np.where(s > _ROUND_OFF, 1.0, 0.0)
    behind = np.where(s < -_ROUND_OFF, 0.0, 1.0)
    for jump in (ahead, behind):
        # Beyond an end of the body a jump deforms no element.
        inside = layers.section[(np.ptp(jump, axis=1) > 0.0) & layers.inside]
        deforms = np.bincount(inside, minlength=len(remaining)) > 0
        free = remaining & deforms & ~_works_outside(layers, jump)
        shares = np.where(free[layers.section, None], jump, shares)
        remaining = remaining & ~free
    return shares, remaining


def _works_outside(layers: _Layers, phi: ndarray) -> ndarray:
    """Return True for sections where elements joined to the body, but not of it, are deformed."""
    keys = layers.keys
    deformed = np.ptp(phi, axis=1) > 0.0
    outside = deformed & ~layers.inside
    joined = np.isin(keys[outside], keys[deformed & layers.inside]).any(axis=1)
    section = layers.section[outside][joined]
    return np.bincount(section, minlength=int(layers.section.max()) + 1) > 0


def _report_continued(
    form: SolidForm,
    sections: Cuts,
    layers: _Layers,
    body: ndarray,
    outside: ndarray,
) -> None:
    """Report sections where a region of the body, (pairs,), has elements outside, (pairs,)."""
    region = element_regions(form)[layers.element]
    keys = layers.keys
    keys = region[:, None] * (keys.max() + 1) + keys
    joined = np.isin(keys[outside], keys[body]).any(axis=1)
    continues = layers.section[outside][joined]
    if len(continues):
        first = continues.min()
        warn(
            f"at {len(np.unique(continues))} of {len(sections.position)} sections, first at the "
            f"position {sections.position[first]:.4g}, the body continues beside the cut, whose "
            f"depth is {2.0 * sections.half_depth[first]:.4g}: forces are those of the elements "
            "within. Give the depth of the whole body and an axis in its middle, unless bodies "
            "cross there"
        )


def _resultants(sections: Cuts, cut: _Cut, forces: ndarray) -> SectionForces:
    """Return sums of nodal forces (pairs, nodes, dim) by section, with moments about the centres.

    N is the force along the axis t, V the force across it, T the moment about it, M the rest.
    """
    axis = sections.axis
    n = len(axis)
    arm = cut.points - sections.center[cut.section][:, None]
    force = _by_section(cut.section, forces.sum(axis=1), n)
    N = dot(force, axis)
    x, y, *z = sections.center.T

    # In the plane a section has a shear force and a moment.
    if not z:
        clockwise = arm[..., 1] * forces[..., 0] - arm[..., 0] * forces[..., 1]
        M = _by_section(cut.section, clockwise.sum(axis=1), n)
        return SectionForces(sections.position, x, y, N, V=dot(force, sections.left), M=M)

    # In space they are vectors across the axis.
    moment = _by_section(cut.section, np.cross(arm, forces).sum(axis=1), n)
    T = dot(moment, axis)
    return SectionForces(
        sections.position,
        x,
        y,
        N=N,
        V=force - N[:, None] * axis,
        M=moment - T[:, None] * axis,
        z=z[0],
        T=T,
        axis=axis,
    )


def _by_section(section: ndarray, values: ndarray, n: int) -> ndarray:
    """Return sums of values (pairs, ...) in each of n sections."""
    total = np.zeros((n, *values.shape[1:]))
    np.add.at(total, section, values)
    return total
