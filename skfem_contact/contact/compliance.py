"""Remarks on the accuracy of an enforcement: penetration, compliance, gaps between nodes."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy import ndarray

from ..arrays import max_abs, row_norms
from ..checks import format_point
from ..errors import Remark
from .interface import ROUND_OFF, ContactState
from .laws import Status

#: Penetration, as a share of the slave segment, that is remarked on.
PENETRATION = 0.01
#: Displacement that is the penalty's, as a share of the largest one, that is remarked on.
_COMPLIANCE = 0.01
#: Displacements below this share of the compression of the elements next to contact by the largest
#: traction are none.
_AT_REST = 0.01
#: Gap between nodes that multipliers leave, likewise a share of the largest one: with gaps of 1.7,
#: .5 and .3 % on coarse facets that do not match, a penalty ten times as hard changes the
#: displacements by 4.0, 1.6 and .5 %.
_BETWEEN = 0.0025
#: Difference of the pressure of the last points from that of the next facets that is remarked on,
#: as a share of it: .9 and .6 under a uniform pressure, on elements of first and second order.
_AT_ENDS = 0.4
#: Share of the largest shape function of a held node by which points are the last ones.
_LAST = 0.9
#: Round-off of a traction that is the penalty times the gap, as a share of it.
_ELASTIC = 1e-6
#: Round-off of the shear of sticking points, as a share of the largest traction, that is remarked
#: on.
_LOST = 1e-3
#: Tractions below this share of what round-off may leave are none: a broken bond, contact without
#: traction.
_NONE = 0.1


def on_penetration(pair: Any, state: ContactState) -> Iterator[Remark]:
    """Yield a remark on a penalty too soft for the load."""
    share = pair.penetration(state)
    if share > PENETRATION:
        yield Remark(
            "penetration",
            share,
            f"the slave penetrates by {share:.1%} of its segment length: the penalty, "
            f"{pair.penalties(state)[0]:.3g}, is too soft for this load",
        )


def on_compliance(pair: Any, x: ndarray, state: ContactState) -> Iterator[Remark]:
    """Yield a remark on a penalty softer than the surfaces, or one that yields visibly."""
    # A penalty softer than the surfaces yields more than they do.
    penalties = pair.penalties(state)
    stiffness = pair.stiffness or penalties[0]
    if pair.penetration(state) > 0.0 and penalties[0] < stiffness:
        softer = stiffness / penalties[0]
        yield Remark(
            "soft penalty",
            softer,
            f"the penalty, {penalties[0]:.3g}, is {softer:.2g} times softer than the surfaces: "
            "contact yields by more than the elements beside it; it is a stress per length, some "
            "times E/h",
        )
        return
    # Compare the elastic parts of gap and slip with the displacements.
    parts = _compliance(pair, x, state)
    if max(parts) > _COMPLIANCE:
        part, penalty, which = max(zip(parts, penalties, ("", "tangential ")))
        yield Remark(
            "compliance",
            part,
            f"{which}penalty compliance is {part:.1%} of the largest displacement: increase the "
            f"penalty, {penalty:.3g}, refine the mesh or use AugmentedLagrangian()",
        )


def on_held_ends(pair: Any, state: ContactState) -> Iterator[Remark]:
    """Yield a remark on ends that supports hold across the joint: nothing penetrates there."""
    if pair.symmetry is None or not pair.symmetry.across.any():
        return
    # Facets with nodes that are held, and the ones beside them
    facets = pair.slave.facets
    held = pair.symmetry.across[facets].any(axis=1)
    around = np.zeros(len(pair.slave.nodes), bool)
    around[facets[held]] = True
    beside = around[facets].any(axis=1) & ~held

    # Find the forces that are missing beside these, and the pressure of the last points
    points = pair.points(state)
    at = held[points.facet]
    next_to = beside[points.facet]
    force = points.weight * -state.traction[0]
    if not next_to.any() or not force.any():
        return
    expected = float(force[next_to].sum() / points.weight[next_to].sum())
    missing = expected * points.weight[at].sum() - force[at].sum()
    nearness = points.at(pair.symmetry.across.astype(float))
    last = at & (nearness >= _LAST * nearness.max())
    pressure = float(force[last].sum() / points.weight[last].sum())
    wrong = abs(expected - pressure)
    if wrong > _AT_ENDS * abs(expected) and abs(missing) > _COMPLIANCE * np.abs(force).sum():
        node = np.flatnonzero(pair.symmetry.across)[0]
        yield Remark(
            "held ends",
            wrong / abs(expected),
            f"at {format_point(pair.slave.nodes[node])} supports hold the joint across, so that "
            f"penalties do not act there: the last points have a pressure of {pressure:.3g}, and "
            f"{expected:.3g} is the mean of the facets beside them; take "
            "AugmentedLagrangian() or DualMultipliers()",
        )


def on_round_off(pair: Any, state: ContactState) -> Iterator[Remark]:
    """Yield a remark on a tangential penalty so hard that round-off of the slip counts."""
    penalty = pair.penalties(state)[1]
    centre = pair.slave.nodes.mean(axis=0)
    extent = max_abs(pair.master.nodes - centre)
    lost = penalty * ROUND_OFF * float(extent)
    largest = max_abs(state.traction)
    sticks = (state.status == Status.STICK).any()
    if sticks and _NONE * lost < largest < lost / _LOST:
        yield Remark(
            "round-off",
            lost / largest,
            f"round-off of the slip makes up to {lost / largest:.1%} of the largest traction: the "
            f"tangential penalty, {penalty:.3g}, is too hard",
        )


def on_gaps_between_nodes(
    pair: Any,
    x: ndarray,
    state: ContactState,
    meshed: ndarray,
) -> Iterator[Remark]:
    """Yield a remark on the mean gap that multipliers at nodes leave where pressure acts."""
    # Only closed points count.
    closed = state.traction[0] < 0.0
    largest = _largest(pair, x)
    if largest == 0.0 or not closed.any():
        return
    # Average the gap by area, without the gap of the mesh itself.
    depth = (state.clearance - state.gap)[closed]
    since = np.abs(depth - (state.clearance - meshed)[closed])
    gap = np.minimum(np.abs(depth), since)
    share = float(np.average(gap, weights=pair.points(state).weight[closed])) / largest
    if share > _BETWEEN:
        yield Remark(
            "between",
            share,
            f"between the nodes '{pair.slave.name}' gapes or penetrates by {share:.1%} of the "
            "largest displacement on average, which multipliers at the nodes do not prevent: "
            "refine the mesh",
        )


def _compliance(pair: Any, x: ndarray, state: ContactState) -> ndarray:
    """Return the mean compliance of both penalties over the largest displacement, shape (2,).

    Compliance before the last reset of displacements does not count, nor do overlaps of the mesh
    and laws of one's own.
    """
    closed = np.flatnonzero(state.status != Status.OPEN)
    depth = (state.clearance - state.gap)[closed]
    slip = np.linalg.norm(state.slip[:, closed], axis=0)

    # Bodies at rest have none
    penalties = pair.penalties(state)
    largest = _largest(pair, x)
    traction = max_abs(state.traction)
    compressed = traction / (pair.stiffness or penalties[0])
    moves = depth.any() or slip.any()
    if largest <= _AT_REST * compressed or not moves:
        return np.zeros(2)

    weight = pair.points(state).weight[closed]
    pressure = np.abs(state.traction[0, closed])
    shear = np.linalg.norm(state.traction[1:, closed], axis=0)

    def shares(depth_since: ndarray, slip_since: ndarray) -> ndarray:
        normal = _mean_compliance(weight, pressure, penalties[0], np.abs(depth), depth_since)
        tangential = _mean_compliance(weight, shear, penalties[1], slip, slip_since)
        return np.array([normal / largest, tangential / largest])

    most = shares(np.abs(depth), slip)
    if most.max() <= _COMPLIANCE:
        return most

    # Leave out overlaps of the mesh, and motion before the last reset
    meshed = pair.interface.meshed_gap(state)
    depth_since = np.abs(depth - (state.clearance - meshed)[closed])
    return shares(depth_since, _moved_apart(pair, x, state)[closed])


def _mean_compliance(
    weight: ndarray,
    traction: ndarray,
    penalty: float,
    distance: ndarray,
    since: ndarray,
) -> float:
    """Return the force-weighted mean elastic distance, as far as it has grown since a reset."""
    elastic = np.isclose(traction, penalty * distance, rtol=_ELASTIC, atol=0.0)
    force = weight * traction * elastic
    if not force.any():
        return 0.0
    return float(np.average(np.minimum(distance, since), weights=force))


def _largest(pair: Any, x: ndarray) -> float:
    """Return the largest displacement of the mesh and of both surfaces, without other fields."""
    parts = [x[: pair.mesh_dofs]]
    for surface in (pair.slave, pair.master):
        parts.append(x[surface.dofs[surface.dofs >= 0]])
    return max(max_abs(part) for part in parts)


def _moved_apart(pair: Any, x: ndarray, state: ContactState) -> ndarray:
    """Return distances between the displacements of points and closest points, shape (n,)."""
    slave, master = pair.interface.positions(x)
    slave_0, master_0 = pair.interface.positions(None)
    points = pair.points(state).positions(slave - slave_0)
    closest = state.closest.positions(pair.master, master - master_0)
    return np.asarray(row_norms(points - closest))
