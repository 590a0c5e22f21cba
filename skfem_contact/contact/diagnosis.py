"""What a user should know of a contact state: contact that is not there, or not where it should be."""
from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np
from numpy import ndarray

from ..errors import Remark, place
from ..surfaces.surface import Surface
from .laws import InterfaceLaw, Status
from .quadrature import SlavePoints
from .settings import TOUCHING
from .sides import normals_at_joint
from .state import ContactState

if TYPE_CHECKING:
    from .pair import ContactPair

#: Penetration, as a share of the slave segment, that is remarked on.
PENETRATION = 0.01
#: Displacement that is the penalty's, as a share of the largest one, that is remarked on.
_COMPLIANCE = 0.01
#: Round-off of a traction that is the penalty times the gap, as a share of it.
_ELASTIC = 1e-6
#: Pressure that overlaps of the mesh carry by what they differ within facets, as a share of that found, likewise.
_RIPPLE = 0.05
#: Share of the pressure that acts along the slave where nodes face joints of the master, likewise; and how near to
#: one, as a share of the facet, they do so: strains move them by less.
_SIDEWAYS, _AT_JOINT = 1e-3, 0.01
#: A gap below this share of the coordinates is nothing: bodies that touch unloaded go on touching when they move.
ROUND_OFF = 8 * np.finfo(float).eps
#: Share of the pressure on points that have only just closed beside others that slide, likewise.
_CLOSED = 0.05
#: Round-off of the shear of sticking points, as a share of the largest traction, that is remarked on.
_LOST = 1e-3
#: Tractions below this share of what round-off may leave are none: a broken bond, contact that carries nothing.
_NONE = 0.1


def remarks(pair: ContactPair, x: ndarray, state: ContactState) -> Iterator[Remark]:
    """Remarks on a state: penalty, multipliers, round-off, facets, lost bonds, points that lie too deep, no contact."""
    meshed = state.gap
    if state.traction[0].any():  # else nobody asks
        meshed = pair.interface.closest(None, state.cuts).gap
    yield from _on_enforcement(pair, x, state, meshed)
    yield from _on_facets(pair, state, meshed)
    yield from _on_sliding(pair, state)
    slave, master, points = pair.slave, pair.master, pair.points(state)
    lost_bond = _without_bond(pair.law, state)
    if lost_bond.any():
        yield Remark("bond", lost_bond.sum(),
                     f"points {np.flatnonzero(lost_bond)} of '{slave.name}' opened with their bond and closed without "
                     "it: they have lost it, adhesion and tension, for good")
    deep = state.gap < -pair.interface.depth(points)
    if deep.any():
        yield Remark("too deep", -state.gap.min(),
                     f"{deep.sum()} of {len(deep)} points of '{slave.name}' lie deeper in "
                     f"'{master.name}' than an element, up to {-state.gap.min():.3g}, and do not touch it; the "
                     f"deepest is at {_place(slave, points, state)}")
    elif (state.status == Status.OPEN).all():
        gap = float((state.gap - state.offset).min())
        yield Remark("open", np.nan_to_num(gap), "no slave point found a master within reach: " + (
            f"nothing of '{master.name}' lies opposite '{slave.name}'" if np.isinf(gap) else
            f"gap is {gap:.3g} between '{slave.name}' and '{master.name}', smallest at {_place(slave, points, state)}"))


def _on_enforcement(pair: ContactPair, x: ndarray, state: ContactState, meshed: ndarray) -> Iterator[Remark]:
    """Penetration, what the penalty gives way by, what multipliers leave, and round-off."""
    slave, master, points, penalties = pair.slave, pair.master, pair.points(state), pair.penalties(state)
    share, stiffness = pair.penetration(state), pair.stiffness or penalties[0]
    if pair.enforcement is not None:
        error = pair.enforcement.error(state, points, penalties, stiffness)
        if error > pair.enforcement.tolerance:
            yield Remark("multipliers", error,
                         f"the multipliers of '{slave.name}' leave an error of {error:.2%} of the largest traction: at "
                         "some nodes they do not converge, and the penalty acts there")
    if share > PENETRATION:
        yield Remark("penetration", share,
                     f"the slave penetrates by {share:.1%} of its segment length: the penalty, {penalties[0]:.3g}, is "
                     "too soft for this load")
    elif pair.enforcement is None and share > 0.0 and penalties[0] < stiffness:
        softer = stiffness / penalties[0]
        yield Remark("soft penalty", softer,
                     f"the penalty, {penalties[0]:.3g}, is {softer:.2g} times softer than the surfaces: contact gives "
                     "way by more than the elements beside it; it is a stress per length, some times E/h")
    elif pair.enforcement is None and max(parts := _compliance(pair, x, state, meshed)) > _COMPLIANCE:
        part, penalty, which = max(zip(parts, penalties, ("", "tangential ")))
        yield Remark("compliance", part,
                     f"the {which}penalty, {penalty:.3g}, gives way by {part:.1%} of the largest displacement: finer "
                     "elements, a harder penalty or AugmentedLagrangian() take that away")
    lost = penalties[1] * ROUND_OFF * float(np.abs(master.nodes - slave.nodes.mean(axis=0)).max())
    largest = float(np.abs(state.traction).max(initial=0.0))
    if _NONE * lost < largest < lost / _LOST and (state.status == Status.STICK).any():
        yield Remark("round-off", lost / largest,
                     f"round-off of the slip makes up to {lost / largest:.1%} of the largest traction: the tangential "
                     f"penalty, {penalties[1]:.3g}, is too hard")


def _compliance(pair: ContactPair, x: ndarray, state: ContactState, meshed: ndarray) -> tuple[float, float]:
    """What the penalties give way by, averaged over the tractions, as shares of the largest displacement.

    What gave way when displacements were counted from anew, or is an overlap of the mesh, is not due to them; nor is
    what a law of one's own makes of gap and slip.
    """
    closed = np.flatnonzero(state.status != Status.OPEN)
    largest = float(np.abs(x).max(initial=0.0))
    if largest == 0.0:
        return 0.0, 0.0
    way, slip = (state.offset - state.gap)[closed], np.linalg.norm(state.slip[:, closed], axis=0)
    pressed, sheared = np.abs(state.traction[0, closed]), np.linalg.norm(state.traction[1:, closed], axis=0)
    normal, tangential = pair.penalties(state)
    weight, since = pair.points(state).weight[closed], way - (state.offset - meshed)[closed]
    return (_gives_way(weight, pressed, normal, np.abs(way), np.abs(since)) / largest,
            _gives_way(weight, sheared, tangential, slip, _moved_apart(pair, x, state)[closed]) / largest)


def _gives_way(weight: ndarray, traction: ndarray, penalty: float, way: ndarray, since: ndarray) -> float:
    """Mean over the force of the way, as far as it was gone since displacements count, where it is elastic."""
    force = weight * traction * np.isclose(traction, penalty * way, rtol=_ELASTIC, atol=0.0)
    return float(np.average(np.minimum(way, since), weights=force)) if force.any() else 0.0


def _moved_apart(pair: ContactPair, x: ndarray, state: ContactState) -> ndarray:
    """Distance by which the displacements have moved points and their closest points apart, (n,)."""
    (slave, master), (slave_0, master_0) = pair.interface.places(x), pair.interface.places(None)
    apart = pair.points(state).positions(slave - slave_0) - state.closest.places(pair.master, master - master_0)
    return np.asarray(np.linalg.norm(apart, axis=1))


def _on_facets(pair: ContactPair, state: ContactState, meshed: ndarray) -> Iterator[Remark]:
    """What straight facets do to the pressure: overlaps where they do not match, a slope at nodes where they do."""
    points = pair.points(state)
    force = points.weight * np.abs(state.traction[0])
    if not force.any():
        return
    # what counts as touching may lie deeper where bodies start with a pressure: that moves nothing apart
    overlap = np.maximum(np.minimum(state.offset, state.gap) - meshed, 0.0)
    overlap[(overlap > pair.interface.depth(points)) | (overlap < TOUCHING * points.size)] = 0.0
    penalty = pair.penalties(state)[0]
    in_series = 1.0 / (1.0 / penalty + 1.0 / (pair.stiffness or penalty))
    carried = in_series * float(_within_facets(pair.slave, points, overlap) @ pair.slave.area) / float(force.sum())
    if carried > _RIPPLE:
        yield Remark("overlap", carried,
                     f"facets of '{pair.slave.name}' and '{pair.facets.name}' that do not match overlap by up to "
                     f"{overlap.max():.3g} in the mesh, which alone carries about {carried:.1g} times the pressure "
                     'that was found: initial="adjusted" lets them touch, matching nodes or curves do not overlap')
    nodal = points.nodes.shape[1] == 1
    if nodal and (sideways := float(force @ _slope_at_joints(pair, state) / force.sum())) > _SIDEWAYS:
        smooth = ', or smoothing=0.1 and initial="adjusted",' if pair.slave.dim == 2 else ""
        yield Remark("joints", sideways,
                     f"nodes of '{pair.slave.name}' face joints of '{pair.facets.name}' and belong to the facet "
                     f"before: {sideways:.1%} of their pressure acts along the surface, as a torque if it is round; "
                     f'quadrature="segments"{smooth} avoids that')


def _on_sliding(pair: ContactPair, state: ContactState) -> Iterator[Remark]:
    """Points that have only just closed, beside others that have slid by more than a facet: they bear no shear yet."""
    force = pair.points(state).weight * np.abs(state.traction[0])
    closed = (state.status == Status.STICK) & ~state.slip.any(axis=0) & ~state.traction[1:].any(axis=0)
    slid = float(np.linalg.norm(state.slip[:, state.status == Status.SLIP], axis=0).max(initial=0.0))
    if slid > pair.slave.spacing and (share := float(force[closed].sum() / force.sum())) > _CLOSED:
        yield Remark("closed", share,
                     f"{share:.0%} of the pressure acts at points of '{pair.slave.name}' that have only just closed, "
                     f"without friction yet, while others have slid by {slid:.3g}: take more increments, or the side "
                     "that stays in contact as the slave")


def _within_facets(slave: Surface, points: SlavePoints, values: ndarray) -> ndarray:
    """Standard deviations of values at points within each facet of the slave, (n_facets,)."""
    if points.nodes.shape[1] == 1:
        nodal = np.zeros(len(slave.nodes))
        nodal[points.nodes[:, 0]] = values
        return np.asarray(nodal[slave.facets].std(axis=1))
    total, first, second = (np.bincount(points.facet, points.weight * values**power, len(slave.facets))
                            for power in (0, 1, 2))
    mean = first / total
    return np.asarray(np.sqrt(np.maximum(second / total - mean**2, 0.0)))


def _slope_at_joints(pair: ContactPair, state: ContactState) -> ndarray:
    """Sine of half the angle by which the master turns where points face its joints, else zero, (n,)."""
    master, sine = pair.master, np.zeros(len(state.gap))
    at, side = np.nonzero((state.facet >= 0)[:, None] & (master.shape.beyond(state.position.T) > -2.0 * _AT_JOINT))
    here, there = normals_at_joint(master, master.nodes, state.facet[at], side)
    np.maximum.at(sine, at, 0.5 * np.linalg.norm(here - there, axis=1))
    return sine


def _without_bond(law: InterfaceLaw, state: ContactState) -> ndarray:
    """Closed points whose bond is broken, of a law that has one."""
    gone = law.debonded(state.internal)
    has_bond = (law.debonded(np.zeros_like(gone)) != 0.0).any(axis=0)
    return has_bond & (gone == state.internal).all(axis=0) & (state.status != Status.OPEN)


def _place(slave: Surface, points: SlavePoints, state: ContactState) -> str:
    return f"{place(points.positions(slave.nodes)[np.argmin(state.gap)])} of the mesh"
