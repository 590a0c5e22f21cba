"""Remarks on a contact state: missing contact, penetration, penalties, lost bonds."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy import ndarray

from ..checks import format_point
from ..errors import Remark
from ..surfaces.surface import Surface
from .base import TOUCHING, ContactBase
from .interface import ROUND_OFF, ContactState
from .laws import InterfaceLaw, Status
from .penalty import AugmentedLagrangian
from .quadrature import SlavePoints
from .search import normals_at_joint

#: Penetration, as a share of the slave segment, that is remarked on.
PENETRATION = 0.01
#: Displacement that is the penalty's, as a share of the largest one, that is remarked on.
_COMPLIANCE = 0.01
#: Displacements below this share of the compression of the elements beside contact by the largest
#: traction are none.
_AT_REST = 0.01
#: Gap between nodes that multipliers leave, likewise a share of the largest one: with gaps of 1.7,
#: .5 and .3 % on coarse facets that do not match, a penalty ten times as hard changes the
#: displacements by 4.0, 1.6 and .5 %.
_BETWEEN = 0.0025
#: Round-off of a traction that is the penalty times the gap, as a share of it.
_ELASTIC = 1e-6
#: Pressure of overlaps of the mesh from their differences within facets, as a share of that found,
#: likewise.
_RIPPLE = 0.05
#: Mean overlap of the mesh where pressure acts, as a share of the facets, likewise: fits have a
#: hundredth, indenters that start inside of their base up to .2. Blocks that were placed too low
#: overlap by as much everywhere, to a tenth.
_DEEP, _EVENLY, _TOO_LOW = 0.25, 0.9, 0.05
#: Share of the pressure that acts along the slave where nodes face joints of the master, likewise;
#: and how near to one, as a share of the facet, they do so: strains move them by less.
_SIDEWAYS, _AT_JOINT = 1e-3, 0.01
#: Share of the pressure on points that have only just closed beside others that slide, likewise.
_CLOSED = 0.05
#: Friction of points that slid in the increment in which they closed, as a share of all friction:
#: .85, .69, .47 and .17 where a parabola is pressed down in 1, 2, 5 and 20 increments; the radius
#: that sticks is 64, 19, 7 and 0 % off that with 60. Slips of more times the elastic displacement
#: of the bodies than the second do not count: no part sticks.
_CLOSING, _GROSS = 0.6, 3.0
#: Error of the pressure of a round fit on flat facets, about that many times one minus the mean
#: cosine of the angle between the normals of facets and their means at nodes, that is remarked on:
#: 3.5, 2.8 and 2.2 times for 64, 32 and 16 facets around, 3.5 for a ball; angles of edges, whose
#: cosine is less than the last number, do not count.
_FLAT, _TIMES, _EDGE = 0.02, 3.0, 0.87
#: Torque of the pressure on a round fit, as a share of that of friction, likewise.
_TURNED = 0.02
#: Round-off of the shear of sticking points, as a share of the largest traction, that is remarked
#: on.
_LOST = 1e-3
#: Tractions below this share of what round-off may leave are none: a broken bond, contact without
#: traction.
_NONE = 0.1


def remarks(pair: ContactBase, x: ndarray, state: ContactState) -> Iterator[Remark]:
    """Yield remarks on a state: penalty, multipliers, round-off, facets, lost bonds, deep points,
    no contact.
    """
    meshed = state.gap
    if state.traction[0].any():  # else nobody asks
        meshed = pair.interface.closest(None, state.cuts).gap
    yield from _on_enforcement(pair, x, state, meshed)
    yield from _on_facets(pair, state, meshed)
    yield from _on_sliding(pair, state)
    yield from _on_closing(pair, state)
    yield from _on_turning(pair, x, state)
    yield from _on_flat_facets(pair, state)
    slave, master, points = pair.slave, pair.master, pair.points(state)
    lost_bond = _without_bond(pair.law, state)
    if lost_bond.any():
        yield Remark(
            "bond",
            lost_bond.sum(),
            f"points {np.flatnonzero(lost_bond)} of '{slave.name}' opened with their bond and "
            f"closed without "
            "it: they have lost it, adhesion and tension, for good",
        )
    deep = state.gap < -pair.interface.depth(points)
    if deep.any():
        yield Remark(
            "too deep",
            -state.gap.min(),
            f"{deep.sum()} of {len(deep)} points of '{slave.name}' lie deeper in "
            f"'{master.name}' than an element, up to {-state.gap.min():.3g}, and do not touch it; "
            f"the "
            f"deepest is at {_deepest(slave, points, state)}",
        )
    elif (state.status == Status.OPEN).all():
        gap = float((state.gap - state.clearance).min())
        yield Remark(
            "open",
            np.nan_to_num(gap),
            "no slave point found a master within reach: "
            + (
                f"nothing of '{master.name}' lies opposite '{slave.name}'"
                if np.isinf(gap)
                else f"gap is {gap:.3g} between '{slave.name}' and '{master.name}', smallest at "
                f"{_deepest(slave, points, state)}"
            ),
        )


def _on_enforcement(
    pair: ContactBase, x: ndarray, state: ContactState, meshed: ndarray
) -> Iterator[Remark]:
    """Yield remarks on penetration, compliance of the penalty, errors of multipliers, and
    round-off.
    """
    slave, master, points, penalties = (
        pair.slave,
        pair.master,
        pair.points(state),
        pair.penalties(state),
    )
    share, stiffness = pair.penetration(state), pair.stiffness or penalties[0]
    if isinstance(pair.enforcement, AugmentedLagrangian):
        error = pair.enforcement.error(state, points, penalties, stiffness)
        if error > pair.enforcement.tolerance:
            yield Remark(
                "multipliers",
                error,
                f"the multipliers of '{slave.name}' leave an error of {error:.2%} of the largest "
                f"traction: at "
                "some nodes they do not converge, and the penalty acts there",
            )
    if pair.enforcement is not None and (left := _left_between(pair, x, state, meshed)) > _BETWEEN:
        yield Remark(
            "between",
            left,
            f"between the nodes '{slave.name}' gapes or penetrates by {left:.1%} of the largest "
            f"displacement "
            "on average, which multipliers at the nodes do not prevent: refine the mesh",
        )
    if pair.dual:
        return
    if share > PENETRATION:
        yield Remark(
            "penetration",
            share,
            f"the slave penetrates by {share:.1%} of its segment length: the penalty, "
            f"{penalties[0]:.3g}, is "
            "too soft for this load",
        )
    elif pair.enforcement is None and share > 0.0 and penalties[0] < stiffness:
        softer = stiffness / penalties[0]
        yield Remark(
            "soft penalty",
            softer,
            f"the penalty, {penalties[0]:.3g}, is {softer:.2g} times softer than the surfaces: "
            f"contact yields "
            "by more than the elements beside it; it is a stress per length, some times E/h",
        )
    elif pair.enforcement is None and max(parts := _compliance(pair, x, state)) > _COMPLIANCE:
        part, penalty, which = max(zip(parts, penalties, ("", "tangential ")))
        yield Remark(
            "compliance",
            part,
            f"{which}penalty compliance is {part:.1%} of the largest displacement: increase the "
            f"penalty, "
            f"{penalty:.3g}, refine the mesh or use AugmentedLagrangian()",
        )
    lost = penalties[1] * ROUND_OFF * float(np.abs(master.nodes - slave.nodes.mean(axis=0)).max())
    largest = float(np.abs(state.traction).max(initial=0.0))
    if _NONE * lost < largest < lost / _LOST and (state.status == Status.STICK).any():
        yield Remark(
            "round-off",
            lost / largest,
            f"round-off of the slip makes up to {lost / largest:.1%} of the largest traction: the "
            f"tangential "
            f"penalty, {penalties[1]:.3g}, is too hard",
        )


def _compliance(pair: ContactBase, x: ndarray, state: ContactState) -> ndarray:
    """Return the force-weighted mean compliance of both penalties as shares of the largest
    displacement, (2,).

    Compliance before the last reset of displacements does not count, nor do overlaps of the mesh
    and laws of one's own.
    """
    closed = np.flatnonzero(state.status != Status.OPEN)
    largest, penalties, weight = _largest(pair, x), pair.penalties(state), pair.points(state).weight
    depth, slip = (
        (state.clearance - state.gap)[closed],
        np.linalg.norm(state.slip[:, closed], axis=0),
    )
    compressed = float(np.abs(state.traction).max(initial=0.0)) / (pair.stiffness or penalties[0])
    if largest <= _AT_REST * compressed or not (depth.any() or slip.any()):
        return np.zeros(2)
    tractions = (
        np.abs(state.traction[0, closed]),
        np.linalg.norm(state.traction[1:, closed], axis=0),
    )

    def shares(*since: ndarray) -> ndarray:
        return np.array(
            [
                _mean_compliance(weight[closed], *part) / largest
                for part in zip(tractions, penalties, (np.abs(depth), slip), since, strict=True)
            ]
        )

    if (most := shares(np.abs(depth), slip)).max() <= _COMPLIANCE:  # without what the mesh brings
        return most
    meshed = pair.interface.closest(None, state.cuts).gap
    return shares(
        np.abs(depth - (state.clearance - meshed)[closed]), _moved_apart(pair, x, state)[closed]
    )


def _left_between(pair: ContactBase, x: ndarray, state: ContactState, meshed: ndarray) -> float:
    """Return the mean gap that multipliers leave where pressure acts, as a share of the largest
    displacement.
    """
    closed, largest = state.traction[0] < 0.0, _largest(pair, x)
    if largest == 0.0 or not closed.any():
        return 0.0
    depth = (state.clearance - state.gap)[closed]
    since = np.abs(depth - (state.clearance - meshed)[closed])
    left = np.minimum(np.abs(depth), since)
    return float(np.average(left, weights=pair.points(state).weight[closed])) / largest


def _largest(pair: ContactBase, x: ndarray) -> float:
    """Return the largest displacement of the mesh and of both surfaces; pressures, rotations,
    multipliers are none.
    """
    own = [x[surface.dofs[surface.dofs >= 0]] for surface in (pair.slave, pair.master)]
    return max(float(np.abs(part).max(initial=0.0)) for part in (x[: pair.mesh_dofs], *own))


def _mean_compliance(
    weight: ndarray, traction: ndarray, penalty: float, distance: ndarray, since: ndarray
) -> float:
    """Return the force-weighted mean elastic distance, as far as it has grown since the last
    reset.
    """
    force = weight * traction * np.isclose(traction, penalty * distance, rtol=_ELASTIC, atol=0.0)
    return float(np.average(np.minimum(distance, since), weights=force)) if force.any() else 0.0


def _moved_apart(pair: ContactBase, x: ndarray, state: ContactState) -> ndarray:
    """Return the distance between the displacements of points and of their closest points, shape
    (n,).
    """
    (slave, master), (slave_0, master_0) = (
        pair.interface.positions(x),
        pair.interface.positions(None),
    )
    between = pair.points(state).positions(slave - slave_0) - state.closest.positions(
        pair.master, master - master_0
    )
    return np.asarray(np.linalg.norm(between, axis=1))


def _on_facets(pair: ContactBase, state: ContactState, meshed: ndarray) -> Iterator[Remark]:
    """Yield remarks on overlaps of facets that do not match, and on nodes that face joints."""
    points = pair.points(state)
    force = points.weight * np.abs(state.traction[0])
    if not force.any():
        return
    # what counts as touching may lie elsewhere where bodies are placed or start with a pressure:
    # that is no overlap
    overlap = np.clip(
        np.minimum(state.clearance, state.gap) - meshed, 0.0, np.maximum(-meshed, 0.0)
    )
    overlap[(overlap > pair.interface.depth(points)) | (overlap < TOUCHING * points.size)] = 0.0
    flat = not pair.slave.closed and overlap[force > 0.0].min() > _EVENLY * overlap.max()
    if (deep := float(force @ (overlap / points.size) / force.sum())) > (
        _TOO_LOW if flat else _DEEP
    ):
        yield Remark(
            "deep overlap",
            deep,
            f"'{pair.slave.name}' lies inside '{pair.facets.name}' by {deep:.0%} of its facets in "
            f"the mesh, "
            f"up to {overlap.max():.3g}: pressure and displacements contain this overlap; move the "
            f"body, "
            'or initial="adjusted" if they only touch',
        )
    penalty = pair.penalties(state)[0]
    in_series = 1.0 / (1.0 / penalty + 1.0 / (pair.stiffness or penalty))
    carried = (
        in_series
        * float(_within_facets(pair.slave, points, overlap) @ pair.slave.area)
        / float(force.sum())
    )
    if carried > _RIPPLE:
        yield Remark(
            "overlap",
            carried,
            f"facets of '{pair.slave.name}' and '{pair.facets.name}' that do not match overlap by "
            f"up to "
            f"{overlap.max():.3g} in the mesh, which alone causes about {carried:.1g} times the "
            f"pressure "
            'that was found: initial="adjusted" lets them touch, matching nodes or curves do not '
            "overlap",
        )
    nodal = points.nodes.shape[1] == 1
    if (
        nodal
        and (sideways := float(force @ _slope_at_joints(pair, state) / force.sum())) > _SIDEWAYS
    ):
        smooth = ', or smoothing=0.1 and initial="adjusted",' if pair.slave.dim == 2 else ""
        yield Remark(
            "joints",
            sideways,
            f"nodes of '{pair.slave.name}' face joints of '{pair.facets.name}' and belong to the "
            f"facet "
            f"before: {sideways:.1%} of their pressure acts along the surface, as a torque if it "
            f"is round; "
            f'quadrature="segments"{smooth} avoids that',
        )


def _on_sliding(pair: ContactBase, state: ContactState) -> Iterator[Remark]:
    """Yield a remark on points without shear that have just closed, beside others that have slid by
    a facet.
    """
    force = pair.points(state).weight * np.abs(state.traction[0])
    closed = (
        (state.status == Status.STICK) & ~state.slip.any(axis=0) & ~state.traction[1:].any(axis=0)
    )
    slid = float(
        np.linalg.norm(state.slip[:, state.status == Status.SLIP], axis=0).max(initial=0.0)
    )
    if slid > pair.slave.spacing and (share := float(force[closed].sum() / force.sum())) > _CLOSED:
        yield Remark(
            "closed",
            share,
            f"{share:.0%} of the pressure acts at points of '{pair.slave.name}' that have only "
            f"just closed, "
            f"without friction yet, while others have slid by {slid:.3g}: take more increments, or "
            f"the side "
            "that stays in contact as the slave",
        )


def _on_closing(pair: ContactBase, state: ContactState) -> Iterator[Remark]:
    """Yield a remark on points that slid in the increment in which they closed: part of this slip
    came before.
    """
    points, stiffness = pair.points(state), pair.stiffness or pair.penalties(state)[0]
    shear, slip = (np.linalg.norm(values, axis=0) for values in (state.traction[1:], state.slip))
    if not (shear > 0.0).any():
        return
    width = np.linalg.norm(np.ptp(points.positions(pair.slave.nodes)[shear > 0.0], axis=0))
    elastic = shear * width / (stiffness * pair.slave.spacing)
    slid = (state.status == Status.SLIP) & (slip > 0.0) & (slip < _GROSS * elastic)
    force = points.weight * shear
    share = float(
        force[slid] @ np.minimum(state.closing_slip[slid] / slip[slid], 1.0) / force.sum()
    )
    if share > _CLOSING:
        yield Remark(
            "closing",
            share,
            f"{share:.0%} of the friction comes from slip of '{pair.slave.name}' in the increments "
            f"in which "
            "its points closed, which counts motion before they touched: too little sticks; take "
            "more "
            "increments, with which this share falls",
        )


def _on_turning(pair: ContactBase, x: ndarray, state: ContactState) -> Iterator[Remark]:
    """Yield a remark on round fits whose pressure transfers torque: by the corners of facets, or as
    they turn.
    """
    on, mu = np.flatnonzero(state.traction[0]), float(np.max(getattr(pair.law, "mu", 0.0)))
    if isinstance(pair.initial, str) or not pair.slave.closed or mu == 0.0 or len(on) == 0:
        return
    points, normal = (
        pair.points(state),
        pair.master.at(*state.closest.take(on), pair.interface.positions(x)[1]).normal,
    )
    force = points.weight[on] * np.abs(state.traction[0, on])
    arm = (points.positions(pair.slave.nodes) - pair.slave.nodes.mean(axis=0))[on]
    friction = mu * float(force @ np.linalg.norm(arm, axis=1))
    if (
        carried := abs(float(force @ (arm[:, 0] * normal[:, 1] - arm[:, 1] * normal[:, 0])))
        / friction
    ) > _TURNED:
        yield Remark(
            "torque",
            carried,
            f"the pressure on '{pair.slave.name}' transfers {carried:.1%} of the torque of "
            "full friction: corners of facets hook, or small rotations are too large; a round fit "
            "slips "
            "before: take curved or smaller elements, or limit_load",
        )


def _on_flat_facets(pair: ContactBase, state: ContactState) -> Iterator[Remark]:
    """Yield a remark on fits whose facets turn at their joints: their pressure is that of other
    radii.
    """
    if isinstance(pair.initial, str) or not state.traction[0].any():
        return
    slave, (m, k) = pair.slave, pair.slave.facets.shape
    own = slave.at(
        np.repeat(np.arange(m), k), np.tile(slave.shape.nodes, (m, 1)), slave.nodes
    ).normal
    cosine = np.einsum("nc,nc->n", own, slave.normals[slave.facets.ravel()])
    error = _TIMES * (1.0 - float(cosine[cosine > _EDGE].mean()))
    if error > _FLAT:
        yield Remark(
            "flat facets",
            error,
            f"facets of '{slave.name}' are flat where the bodies are round: the pressure of the "
            f"fit is "
            f"about {error:.0%} too high; take curved elements, of MeshQuad2 or MeshHex2, or "
            f"smaller ones",
        )


def _within_facets(slave: Surface, points: SlavePoints, values: ndarray) -> ndarray:
    if points.nodes.shape[1] == 1:
        nodal = np.zeros(len(slave.nodes))
        nodal[points.nodes[:, 0]] = values
        return np.asarray(nodal[slave.facets].std(axis=1))
    total, first, second = (
        np.bincount(points.facet, points.weight * values**power, len(slave.facets))
        for power in (0, 1, 2)
    )
    mean = first / total
    return np.asarray(np.sqrt(np.maximum(second / total - mean**2, 0.0)))


def _slope_at_joints(pair: ContactBase, state: ContactState) -> ndarray:
    """Return the sine of half the angle by which the master turns where points face its joints,
    else zero.
    """
    master, sine = pair.master, np.zeros(len(state.gap))
    at, side = np.nonzero(
        (state.facet >= 0)[:, None] & (master.shape.beyond(state.position.T) > -2.0 * _AT_JOINT)
    )
    here, there = normals_at_joint(master, master.nodes, state.facet[at], side)
    np.maximum.at(sine, at, 0.5 * np.linalg.norm(here - there, axis=1))
    return sine


def _without_bond(law: InterfaceLaw, state: ContactState) -> ndarray:
    gone = law.debonded(state.internal)
    has_bond = (law.debonded(np.zeros_like(gone)) != 0.0).any(axis=0)
    return has_bond & (gone == state.internal).all(axis=0) & (state.status != Status.OPEN)


def _deepest(slave: Surface, points: SlavePoints, state: ContactState) -> str:
    return f"{format_point(points.positions(slave.nodes)[np.argmin(state.gap)])} of the mesh"
