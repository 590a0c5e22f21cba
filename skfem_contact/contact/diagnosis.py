"""Remarks on a contact state: missing contact, facets, slip, lost bonds."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import scipy
from numpy import ndarray

from ..arrays import cross_in_plane, row_norms
from ..checks import format_point
from ..errors import Remark
from ..surfaces.surface import Surface
from ..surfaces.vectors import dot, frame, unit
from .base import ContactBase
from .interface import TOUCHING, ContactState
from .laws import Status
from .quadrature import SlavePoints
from .ripple import on_peaks, on_ripple
from .search import normals_at_joint

#: Pressure of overlaps of the mesh from their differences within facets, as a share of that found,
#: likewise.
_RIPPLE = 0.05
#: Kinds of remarks on overlaps of the mesh.
_DEEP_OVERLAP = "deep overlap"
_OVERLAP = "overlap"
OVERLAPS = (_DEEP_OVERLAP, _OVERLAP)
#: Distance of the centres of two facets along the surface, and difference of their sizes, as a
#: share, below which they match: sides that cross at a slope of .3 differ by 4 %.
_MATCHING = 0.05
#: Square of the mean of a surface's normals from which it is flat.
_FLAT_SURFACE = 0.9
#: Mean overlap of the mesh where pressure acts, as a share of the facets, likewise: fits have a
#: hundredth, indenters that start inside of their base up to .2. Blocks that were placed too low
#: overlap by as much everywhere, to a tenth.
_DEEP = 0.25
_EVENLY = 0.9
_TOO_LOW = 0.05
#: Share of the pressure that acts along the slave where nodes face joints of the master, likewise;
#: and how near to one, as a share of the facet, they do so: strains move them by less.
_SIDEWAYS = 1e-3
_AT_JOINT = 0.01
#: Share of the pressure on points that have only just closed beside others that slide, likewise.
_CLOSED = 0.05
#: Friction of points that slid in the increment in which they closed, as a share of all friction:
#: .85, .69, .47 and .17 where a parabola is pressed down in 1, 2, 5 and 20 increments; the radius
#: that sticks is 64, 19, 7 and 0 % off that with 60. Slips of more times the elastic displacement
#: of the bodies than the second do not count: no part sticks.
_CLOSING = 0.6
_GROSS = 3.0
#: Error of the pressure of a round fit on flat facets, about that many times one minus the mean
#: cosine of the angle between the normals of facets and their means at nodes, that is remarked on:
#: 3.5, 2.8 and 2.2 times for 64, 32 and 16 facets around, 3.5 for a ball; angles of edges, whose
#: cosine is less than the last number, do not count.
_FLAT = 0.02
_TIMES = 3.0
_EDGE = 0.87
#: Friction of a fit to and fro within facets that are inclined to its way, as a share of mu p: half
#: of the whole one at most where the surface ends. With the penalty curved facets have .3 to .8
#: with three around a quarter, .1 with six, .014 with twelve; flat ones .56 with 24 or 64.
#: Multipliers have .03 with three, nothing where facets match.
_INCLINED = 0.1
#: Torque of the pressure on a round fit, as a share of that of friction, likewise.
_TURNED = 0.02
#: Share of the force on facets that a round obstacle touches in parts alone, likewise: circles that
#: meet 3 to 18 facets of a half have peaks of 1.6 to 3.7 times Hertz' where it is above .2, and of
#: at most 1.2 times where it is zero.
_PARTS = 0.1
#: Square of the mean normal of an obstacle, less than one by round-off alone: it is level.
_LEVEL = 1e-9


def remarks(pair: ContactBase, x: ndarray, state: ContactState) -> Iterator[Remark]:
    """Yield remarks on a state: enforcement, facets, slip, lost bonds, deep points, no contact."""
    meshed = state.gap
    if state.traction[0].any():
        meshed = pair.interface.meshed_gap(state)
    yield from pair.enforcement.remarks(pair, x, state, meshed)
    yield from _on_facets(pair, state, meshed)
    ripples = list(on_ripple(pair, state, meshed))
    yield from ripples or on_peaks(pair, state)
    yield from _on_joints(pair, state)
    yield from _on_sliding(pair, state)
    yield from _on_closing(pair, state)
    yield from _on_turning(pair, x, state)
    yield from _on_flat_facets(pair, state)
    yield from _on_inclined_facets(pair, state)
    yield from _on_parts(pair, state)
    yield from _on_bonds(pair, state)
    yield from _on_distance(pair, state)


def _on_parts(pair: ContactBase, state: ContactState) -> Iterator[Remark]:
    """Yield a remark on facets within the contact that a round obstacle touches in parts alone."""
    master = pair.facets
    points = pair.points(state)
    is_second_order = points.nodes.shape[1] > 2 ** (pair.slave.dim - 1)
    if not master.rigid or is_second_order or pair.quadrature in ("nodal", 2):
        return
    mean = master.area @ master.centres.normal / master.area.sum()
    if float(mean @ mean) > 1.0 - _LEVEL:
        return
    # Find facets with open points beside closed ones, whose neighbours are closed somewhere, too.
    facets = pair.slave.facets
    n = len(facets)
    is_open = state.status == Status.OPEN
    n_open = np.bincount(points.facet[is_open], minlength=n)
    touch = np.bincount(points.facet[~is_open], minlength=n) > 0
    within = ~np.isin(facets, facets[~touch]).any(axis=1)
    in_parts = within & (n_open > 0)
    # Compare their force with the whole.
    force = np.bincount(points.facet, points.weight * np.abs(state.traction[0]), n)
    share = float(force[in_parts].sum() / max(force.sum(), np.finfo(float).tiny))
    if share > _PARTS:
        yield Remark(
            "parts",
            share,
            f"{share:.0%} of the force acts on facets of '{pair.slave.name}' that touch "
            f"'{master.name}' in parts alone, for they are straight: resultants are right, but "
            "pressures at points are up to several times too high; take quadrature=2, smaller "
            "facets or elements of second order",
        )


def _on_bonds(pair: ContactBase, state: ContactState) -> Iterator[Remark]:
    """Yield a remark on closed points without their bond."""
    broken = pair.law.debonded(state.internal)
    has_bond = (pair.law.debonded(np.zeros_like(broken)) != 0.0).any(axis=0)
    without = (broken == state.internal).all(axis=0)
    lost = has_bond & without & (state.status != Status.OPEN)
    if lost.any():
        where = pair.points(state).positions(pair.slave.nodes)[np.argmax(lost)]
        yield Remark(
            "bond",
            lost.sum(),
            f"{lost.sum()} points of '{pair.slave.name}', the first at {format_point(where)}, "
            "opened with their bond and closed without it: they have lost it, adhesion and "
            "tension, for good",
        )


def _on_distance(pair: ContactBase, state: ContactState) -> Iterator[Remark]:
    """Yield a remark on points too deep in the master, or on bodies that do not touch."""
    # Name the deepest point.
    points = pair.points(state)
    slave = pair.slave.name
    master = pair.master.name
    deepest = points.positions(pair.slave.nodes)[np.argmin(state.gap)]
    place = f"{format_point(deepest)} of the mesh"
    # Points deeper than an element lie behind the surface.
    deep = state.gap < -pair.interface.depth(points)
    overlap = _overlap_of_supports(pair, state)
    if deep.any():
        yield Remark(
            "too deep",
            -state.gap.min(),
            f"{deep.sum()} of {len(deep)} points of '{slave}' lie deeper in '{master}' than an "
            f"element, up to {-state.gap.min():.3g}, and do not touch it; the deepest is at "
            f"{place}",
        )
    elif overlap > 0.0:
        yield Remark(
            "held overlap",
            overlap,
            f"supports hold '{slave}' and '{master}' where they overlap by {overlap:.3g}: no "
            "contact traction acts there, for none moves anything; free one side, or take them "
            "apart",
        )
    elif (state.status == Status.OPEN).all() and pair.interface.fold is None:
        gap = float((state.gap - state.clearance).min())
        found = f"gap is {gap:.3g} between '{slave}' and '{master}', smallest at {place}"
        if np.isinf(gap):
            found = f"nothing of '{master}' lies opposite '{slave}'"
        yield Remark(
            "open", np.nan_to_num(gap), f"no slave point found a master within reach: {found}"
        )


def _overlap_of_supports(pair: ContactBase, state: ContactState) -> float:
    """Return the largest overlap on facets that need no multipliers, for supports hold them."""
    if not pair.saddle or pair.symmetry is None:
        return 0.0
    points = pair.points(state)
    is_held = pair.symmetry.clamped[pair.slave.facets].all(axis=1)[points.facet]
    overlap = np.where(is_held, state.clearance - state.gap, 0.0)
    return float(overlap[overlap > TOUCHING * points.size].max(initial=0.0))


def _on_facets(pair: ContactBase, state: ContactState, meshed: ndarray) -> Iterator[Remark]:
    """Yield remarks on deep overlaps of the mesh, and on overlaps of facets that do not match."""
    points = pair.points(state)
    force = points.weight * np.abs(state.traction[0])
    if not force.any():
        return

    # Points may touch elsewhere where bodies are placed or start with a pressure: no overlap;
    # facets of smooth curves have none either
    touching = np.minimum(state.clearance, state.gap)
    deepest = np.maximum(state.rounded - meshed, 0.0)
    overlap = np.clip(touching - meshed, 0.0, deepest)
    no_overlap = (overlap > pair.interface.depth(points)) | (overlap < TOUCHING * points.size)
    overlap[no_overlap] = 0.0

    even = overlap[force > 0.0].min() > _EVENLY * overlap.max()
    limit = _DEEP
    if even and not pair.slave.closed:
        limit = _TOO_LOW
    deep = float(force @ (overlap / points.size) / force.sum())
    if deep > limit:
        yield Remark(
            _DEEP_OVERLAP,
            deep,
            f"'{pair.slave.name}' lies inside '{pair.facets.name}' by {deep:.0%} of its facets in "
            f"the mesh, up to {overlap.max():.3g}: pressure and displacements contain this "
            'overlap; move the body, or initial="adjusted" if they only touch',
        )

    # An interference that is given as a number knows no differences within facets; others are
    # resisted by penalty and surfaces in series
    if not isinstance(pair.initial, str):
        return
    penalty = pair.penalties(state)[0]
    in_series = 1.0 / (1.0 / penalty + 1.0 / (pair.stiffness or penalty))
    rest = _without_wedge(pair.slave, points, overlap)
    ripple = float(_within_facets(pair.slave, points, rest) @ pair.slave.area)
    carried = in_series * ripple / float(force.sum())
    if carried > _RIPPLE:
        which = ""
        advice = 'initial="adjusted" lets them touch'
        if not _matching(pair):
            which = " that do not match"
            advice += ", matching nodes or curves do not overlap"
        if pair.initial == "adjusted":
            advice = "they slid from where they were adjusted: take curved or smaller elements"
        yield Remark(
            _OVERLAP,
            carried,
            f"facets of '{pair.slave.name}' and '{pair.facets.name}'{which} overlap by up to "
            f"{overlap.max():.3g} in the mesh, which alone causes about {carried:.1g} times the "
            f"pressure that was found: {advice}",
        )


def _on_joints(pair: ContactBase, state: ContactState) -> Iterator[Remark]:
    """Yield a remark on nodes that face joints of the master and press along the surface."""
    # Only nodes can face a joint.
    points = pair.points(state)
    force = points.weight * np.abs(state.traction[0])
    is_nodal = points.nodes.shape[1] == 1
    if not is_nodal or not force.any():
        return
    # Average the slope at joints by the force.
    sideways = float(force @ _slope_at_joints(pair, state) / force.sum())
    if sideways > _SIDEWAYS:
        smooth = ""
        if pair.slave.dim == 2:
            smooth = ', or smoothing=0.1 and initial="adjusted",'
        yield Remark(
            "joints",
            sideways,
            f"nodes of '{pair.slave.name}' face joints of '{pair.facets.name}' and belong to the "
            f"facet before: {sideways:.1%} of their pressure acts along the surface, as a torque "
            f'if it is round; quadrature="segments"{smooth} avoids that',
        )


def _on_sliding(pair: ContactBase, state: ContactState) -> Iterator[Remark]:
    """Yield a remark on points that have just closed, without shear, while others have slid."""
    # Find points that have just closed, and how far others have slid.
    no_slip = ~state.slip.any(axis=0)
    no_shear = ~state.traction[1:].any(axis=0)
    closed = (state.status == Status.STICK) & no_slip & no_shear
    slides = state.status == Status.SLIP
    slips = np.linalg.norm(state.slip[:, slides], axis=0)
    slid = float(slips.max(initial=0.0))
    if slid <= pair.slave.spacing:
        return
    # Weigh them by their share of the force.
    force = pair.points(state).weight * np.abs(state.traction[0])
    share = float(force[closed].sum() / force.sum())
    if share > _CLOSED:
        yield Remark(
            "closed",
            share,
            f"{share:.0%} of the pressure acts at points of '{pair.slave.name}' that have only "
            f"just closed, without friction yet, while others have slid by {slid:.3g}: take more "
            "increments, or the side that stays in contact as the slave",
        )


def _on_closing(pair: ContactBase, state: ContactState) -> Iterator[Remark]:
    """Yield a remark on slip of increments in which points closed: part of it came before."""
    points = pair.points(state)
    stiffness = pair.stiffness or pair.penalties(state)[0]
    shear = np.linalg.norm(state.traction[1:], axis=0)
    slip = np.linalg.norm(state.slip, axis=0)
    rubs = shear > 0.0
    if not rubs.any():
        return

    # Leave out slips that are large beside the elastic displacement of the bodies
    positions = points.positions(pair.slave.nodes)[rubs]
    width = np.linalg.norm(np.ptp(positions, axis=0))
    elastic = shear * width / (stiffness * pair.slave.spacing)
    slid = (state.status == Status.SLIP) & (slip > 0.0) & (slip < _GROSS * elastic)

    force = points.weight * shear
    while_closing = np.minimum(state.closing_slip[slid] / slip[slid], 1.0)
    share = float(force[slid] @ while_closing / force.sum())
    if share > _CLOSING:
        yield Remark(
            "closing",
            share,
            f"{share:.0%} of the friction comes from slip of '{pair.slave.name}' in the increments "
            "in which its points closed, which counts motion before they touched: too little "
            "sticks; take more increments, with which this share falls",
        )


def _on_turning(pair: ContactBase, x: ndarray, state: ContactState) -> Iterator[Remark]:
    """Yield a remark on round fits whose pressure transfers torque, by corners or as they turn."""
    on = np.flatnonzero(state.traction[0])
    slave, master = pair.interface.positions(x)
    normal = pair.master.at(*state.closest.take(on), master).normal
    # Forces of small rotations have the arms of the undeformed body.
    if not pair.finite:
        slave = pair.slave.nodes
    yield from on_torque(pair, state, on, normal, slave)


def on_torque(
    pair: ContactBase,
    state: ContactState,
    on: ndarray,
    normal: ndarray,
    nodes: ndarray,
) -> Iterator[Remark]:
    """Yield a remark on a round fit whose pressure at the points `on` transfers torque.

    The master has normals, (n, dim), at them, and the slave's nodes are at the ends of arms.
    """
    # Only round fits with friction transfer torque.
    mu = float(np.max(getattr(pair.law, "mu", 0.0)))
    is_fit = not isinstance(pair.initial, str) and pair.slave.closed
    if not is_fit or mu == 0.0 or len(on) == 0:
        return
    # Compare the torque of pressures with that of full friction.
    points = pair.points(state)
    force = points.weight[on] * np.abs(state.traction[0, on])
    arm = (points.positions(nodes) - nodes.mean(axis=0))[on]
    friction = mu * float(force @ row_norms(arm))
    lever = cross_in_plane(arm, normal)
    torque = float(force @ lever)
    carried = abs(torque) / friction
    if carried > _TURNED:
        yield Remark(
            "torque",
            carried,
            f"the pressure on '{pair.slave.name}' transfers {carried:.1%} of the torque of full "
            "friction: corners of facets hook, or small rotations are too large; a round fit "
            "slips before: take curved elements, of MeshQuad2, or smaller ones",
        )


def _on_flat_facets(pair: ContactBase, state: ContactState) -> Iterator[Remark]:
    """Yield a remark on fits of flat facets that turn at joints, whose pressure errs."""
    # Only fits are this sensitive.
    if isinstance(pair.initial, str) or not state.traction[0].any():
        return
    # Compare the normals of facets and of nodes, away from edges.
    own, mean = _normals_at_nodes(pair.slave, np.arange(len(pair.slave.facets)))
    cosine = dot(own, mean)
    error = _TIMES * (1.0 - float(cosine[cosine > _EDGE].mean()))
    if error > _FLAT:
        yield Remark(
            "flat facets",
            error,
            f"facets of '{pair.slave.name}' are flat where the bodies are round: the pressure of "
            f"the fit is about {error:.0%} too high; take curved elements, of MeshQuad2 or "
            "MeshHex2, or smaller ones",
        )


def _on_inclined_facets(pair: ContactBase, state: ContactState) -> Iterator[Remark]:
    """Yield a remark on fits whose facets are inclined to the way that closes them: they rub."""
    mu = float(np.max(getattr(pair.law, "mu", 0.0)))
    on = np.flatnonzero(state.traction[0])
    smoothed = pair.master.facets is not pair.facets.facets
    if isinstance(pair.initial, str) or mu == 0.0 or len(on) == 0 or smoothed:
        return
    # Find the slip of a motion along the normals of smooth surfaces.
    master = pair.master
    closest = state.closest.take(on)
    normal = master.at(closest.facet, closest.xi, master.nodes).normal
    values = master.shape.at(closest.facet, closest.xi, 0)[0]
    mean = _normals_at_nodes(master, closest.facet)[1].reshape(*values.shape, -1)
    way = pair.initial * unit(np.einsum("nk,nkc->nc", values, mean))
    points = pair.points(state)
    tangents = frame(normal, points.direction(pair.slave, pair.slave.nodes)[on])
    slip = np.einsum("nac,nc->na", tangents, way)
    length = np.maximum(row_norms(slip), np.finfo(float).tiny)
    # Take the friction along it, which is at most that of the penalty.
    weight = points.weight[on]
    friction = mu * float(weight @ np.abs(state.traction[0, on]))
    along = float(weight @ (dot(state.traction[1:, on].T, slip) / length))
    most = pair.penalties(state)[1] * float(weight @ length)
    share = min(abs(along), most) / friction
    if share > _INCLINED:
        yield Remark(
            "inclined facets",
            share,
            f"at least {share:.0%} of the limit of friction acts to and fro within facets of "
            f"'{master.name}', which are inclined to the way of the fit: resultants are right, "
            "shear at points is not; DualMultipliers() have little of it, curved elements with "
            "eight or more around a quarter as well",
        )


def _normals_at_nodes(surface: Surface, facet: ndarray) -> tuple[ndarray, ndarray]:
    """Return normals of facets at their nodes, and those of nodes away from edges, (n k, dim)."""
    k = surface.facets.shape[1]
    xi = np.tile(surface.shape.nodes, (len(facet), 1))
    own = surface.at(np.repeat(facet, k), xi, surface.nodes).normal
    mean = surface.normals[surface.facets[facet].ravel()]
    is_edge = dot(own, mean) <= _EDGE
    return own, np.where(is_edge[:, None], own, mean)


def _matching(pair: ContactBase) -> bool:
    """Return True if facets of the slave have facets of equal centre and size opposite them."""
    if pair.folds:
        return False
    slave = pair.slave
    master = pair.facets
    centre = slave.centres.x[0]
    opposite = scipy.spatial.cKDTree(master.centres.x[0]).query(centre)[1]

    # Compare centres along the surface, and sizes
    normal = slave.centres.normal
    way = master.centres.x[0][opposite] - centre
    aside = row_norms(way - dot(way, normal)[:, None] * normal)
    longer = np.abs(master.size[opposite] - slave.size)
    return bool((np.maximum(aside, longer) < _MATCHING * slave.size).all())


def _without_wedge(slave: Surface, points: SlavePoints, overlap: ndarray) -> ndarray:
    """Return overlaps of points, (n,), without the part that is linear along a flat surface.

    Straight surfaces at an angle overlap like a wedge, which matching facets do as well.
    """
    # Normals of a flat surface hardly differ from their mean
    mean = slave.area @ slave.centres.normal / slave.area.sum()
    if float(mean @ mean) < _FLAT_SURFACE:
        return overlap

    # Fit a plane over the coordinates along the surface
    inside = overlap > 0.0
    x = points.positions(slave.nodes)[inside]
    along = x - np.outer(x @ mean, mean) / float(mean @ mean)
    linear = np.column_stack((np.ones(len(x)), along))
    rest = np.zeros(len(overlap))
    wedge, *_ = np.linalg.lstsq(linear, overlap[inside], rcond=None)
    rest[inside] = overlap[inside] - linear @ wedge
    return rest


def _within_facets(slave: Surface, points: SlavePoints, values: ndarray) -> ndarray:
    """Return standard deviations of values at points within facets, shape (n_facets,)."""
    if points.nodes.shape[1] == 1:
        nodal = np.zeros(len(slave.nodes))
        nodal[points.nodes[:, 0]] = values
        return np.asarray(nodal[slave.facets].std(axis=1))
    n = len(slave.facets)
    total = np.bincount(points.facet, points.weight, n)
    mean = np.bincount(points.facet, points.weight * values, n) / total
    mean_square = np.bincount(points.facet, points.weight * values**2, n) / total
    return np.asarray(np.sqrt(np.maximum(mean_square - mean**2, 0.0)))


def _slope_at_joints(pair: ContactBase, state: ContactState) -> ndarray:
    """Return sines of half the master's turn at joints that points face, else zero, shape (n,)."""
    master = pair.master
    beyond = master.shape.beyond(state.position.T)
    at_joint = (state.facet >= 0)[:, None] & (beyond > -2.0 * _AT_JOINT)
    at, side = np.nonzero(at_joint)
    own, neighbour = normals_at_joint(master, master.nodes, state.facet[at], side)
    sine = np.zeros(len(state.gap))
    np.maximum.at(sine, at, 0.5 * row_norms(own - neighbour))
    return sine
