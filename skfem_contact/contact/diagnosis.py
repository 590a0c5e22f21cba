"""What a user should know of a contact state: contact that is not there, or not where it should be."""
from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np
from numpy import ndarray

from ..errors import place
from ..remarks import Remark
from ..surfaces.surface import Surface
from .laws import InterfaceLaw, Status
from .quadrature import SlavePoints
from .state import ContactState

if TYPE_CHECKING:
    from .pair import ContactPair

#: Penetration, as a share of the slave segment, that is remarked on.
PENETRATION = 0.01
#: A gap below this share of the coordinates is nothing: bodies that touch unloaded go on touching when they move.
ROUND_OFF = 8 * np.finfo(float).eps
#: Round-off of the shear of sticking points, as a share of the largest traction, that is remarked on.
_LOST = 1e-3


def penetration(points: SlavePoints, state: ContactState) -> float:
    """Largest penetration as a share of the slave segment there."""
    closed = state.status != Status.OPEN
    return float(np.max((state.offset - state.gap)[closed] / points.size[closed], initial=0.0))


def passed_through(depth: ndarray, accepted: ContactState, candidate: ContactState) -> int:
    """Number of points that were outside the master, or near its surface, and are deep inside now."""
    was_outside = np.isfinite(accepted.gap) & (accepted.gap >= -depth)
    return int((was_outside & (candidate.gap < -depth)).sum())


def remarks(pair: ContactPair, state: ContactState) -> Iterator[Remark]:
    """Remarks on a state: penetration, round-off, bonds that are lost, points that lie too deep, no contact."""
    slave, master, points, penalties = pair.slave, pair.master, pair.points(state), pair.penalties(state)
    share = penetration(points, state)
    if share > PENETRATION:
        yield Remark("penetration", share,
                     f"the slave penetrates by {share:.1%} of its segment length: the penalty, {penalties[0]:.3g}, is "
                     "too soft for this load")
    elif pair.enforcement is None and share > 0.0 and penalties[0] < (pair.stiffness or 0.0):
        softer = pair.stiffness / penalties[0]  # type: ignore[operator]
        yield Remark("soft penalty", softer,
                     f"the penalty, {penalties[0]:.3g}, is {softer:.2g} times softer than the surfaces: contact gives "
                     "way by more than the elements beside it; it is a stress per length, some times E/h")
    lost = penalties[1] * ROUND_OFF * float(np.abs(master.nodes - slave.nodes.mean(axis=0)).max())
    largest = float(np.abs(state.traction).max(initial=0.0))
    if 0.0 < largest < lost / _LOST and (state.status == Status.STICK).any():
        yield Remark("round-off", lost / largest,
                     f"round-off of the slip makes up to {lost / largest:.1%} of the largest traction: the tangential "
                     f"penalty, {penalties[1]:.3g}, is too hard")
    lost_bond = _without_bond(pair.law, state)
    if lost_bond.any():
        yield Remark("bond", lost_bond.sum(),
                     f"points {np.flatnonzero(lost_bond)} of '{slave.name}' opened with their bond and closed without "
                     "it: they have lost it, adhesion and tension, for good")
    deep = state.gap < -pair.depth(points)
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


def _without_bond(law: InterfaceLaw, state: ContactState) -> ndarray:
    """Closed points whose bond is broken, of a law that has one."""
    gone = law.debonded(state.internal)
    has_bond = (law.debonded(np.zeros_like(gone)) != 0.0).any(axis=0)
    return has_bond & (gone == state.internal).all(axis=0) & (state.status != Status.OPEN)


def _place(slave: Surface, points: SlavePoints, state: ContactState) -> str:
    return f"{place(points.positions(slave.nodes)[np.argmin(state.gap)])} of the mesh"
