"""Regularised contact pairs where Newton's method fails, or bodies overlap at the start.

A family of regularised pairs begins with one that Newton's method solves, and proceeds to the pair
as given.
"""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import NamedTuple, TypeVar

import numpy as np
from numpy import ndarray
from typing_extensions import override

from ..arrays import max_abs
from ..errors import Failure, warn
from .base import ContactBase
from .compliance import PENETRATION
from .interface import ContactState
from .laws import InterfaceLaw, LawUpdate, Status
from .quadrature import SlavePoints

logger = logging.getLogger("skfem_contact")

Pair = TypeVar("Pair", bound=ContactBase)

#: Share of the overlap that is left from one pair to the next.
_LEFT = 0.5
#: Gap that loose bodies close, as a share of the slave's facets, that is warned of.
_APART = 0.1
#: Stiffness of the springs as a share of the penalty: at first, and when they are as good as gone.
#: Stiffer ones draw wide gaps, as beside a cylinder on a plane, with many times the load.
_FIRST = 1e-4
_LAST = 1e-6
#: Factor by which the share falls from one solution to the next.
_FALL = 0.1
#: Springs that exert less than this share of the contact force need not be taken away little by
#: little.
_NEGLIGIBLE = 1e-3
#: Tangential penalty of the first solution with a soft stick: so many times the stiffness of the
#: surfaces, and at most this share of the penalty as given.
_SOFT = 10.0
_SHARE = 0.1
#: It grows from one solution to the next by this factor at least, and by more as long as that
#: changes the tractions of points that stick by no more than this share of the largest one.
_GROWTH = 1.6
_CHANGE = 0.05


class Family(NamedTuple):
    """Family of regularised pairs.

    `start`, of a pair, its accepted state and a failure, None before the first attempt, returns the
    first pair of the family, or None where it does not help.  `proceed`, of a pair, its accepted
    state and the state of an equilibrium, returns the next pair and True if this one is regularised
    too; None where nothing is left to do.
    """

    start: Callable[[ContactBase, ContactState, Failure | None], ContactBase | None]
    proceed: Callable[[ContactBase, ContactState, ContactState], tuple[ContactBase, bool] | None]


def begin(pair: Pair, accepted: ContactState, failure: Failure | None) -> Pair:
    """Return the first pair of the first family that helps; the pair itself where none does."""
    for family in FAMILIES:
        easier = family.start(pair, accepted, failure)
        if easier is not None:
            return easier.with_(families=(*_without(pair, family), family))  # type: ignore[return-value]
    return pair


def proceed(pair: Pair, accepted: ContactState, found: ContactState) -> Pair:
    """Return the next pair of the first family that continues; the pair itself in the end."""
    for family in pair.families:
        step = family.proceed(pair, accepted, found)
        if step is not None:
            after, regularised = step
            last = (family,) if regularised else ()
            return after.with_(families=(*_without(pair, family), *last))
    return pair


def _without(pair: ContactBase, family: Family) -> tuple[Family, ...]:
    """Return the families of a pair without one of them."""
    return tuple(other for other in pair.families if other is not family)


# Bodies that overlap: a part of the overlap counts as touching, and less from solution to solution


def _start_interference(
    pair: ContactBase, accepted: ContactState, failure: Failure | None
) -> ContactBase | None:
    """Return a pair without interference, unless tractions have resolved it before."""
    untouched = (accepted.status != Status.OPEN).any() and not accepted.traction.any()
    if failure is not None or not untouched:
        return None
    if isinstance(pair.initial, str):
        if pair.initial != "ramped":
            return None
        wanted = np.zeros_like(accepted.clearance) + accepted.rounded
    else:
        wanted = accepted.clearance + pair.initial
    if (accepted.clearance == wanted).all():
        return None
    return pair.with_(clearance=np.stack((accepted.clearance, wanted)))


def _resolve_interference(
    pair: ContactBase, accepted: ContactState, found: ContactState
) -> tuple[ContactBase, bool] | None:
    """Return the pair with a part of the remaining interference resolved."""
    assert pair.clearance is not None
    now, wanted = pair.clearance
    remaining = _LEFT * (now - wanted)
    if not remaining.any():
        return None
    remaining[np.abs(remaining) < PENETRATION * pair.points(accepted).size] = 0.0
    return pair.with_(clearance=np.stack((wanted + remaining, wanted))), True


# Loose bodies: soft springs until contact is closed, softer from solution to solution


def _start_springs(
    pair: ContactBase, accepted: ContactState, failure: Failure | None
) -> ContactBase | None:
    """Return a pair with the stiffest springs where bodies are loose, unless a bond holds them."""
    # Springs are for loose bodies and contact without bonds.
    if failure is None or not failure.loose or pair.law.bonds or isinstance(pair.law, Stabilised):
        return None
    logger.info(
        "bodies are loose while contact is open: stabilisation by soft springs closes '%s', which "
        "are then taken away",
        pair.slave.name,
    )
    # Report contact that is far away.
    nearest = (accepted.gap - accepted.clearance).min()
    if np.isfinite(nearest) and nearest > _APART * pair.slave.spacing:
        warn(
            f"nothing holds a body before contact closes, and '{pair.slave.name}' starts "
            f"{nearest:.3g} away from '{pair.master.name}', "
            f"{nearest / pair.slave.spacing:.0%} of a facet: its displacements contain this "
            'distance; move it in the mesh, or initial="adjusted" if they touch'
        )
    return pair.with_(law=Stabilised(pair.law, _FIRST))


def _soften_springs(
    pair: ContactBase, accepted: ContactState, found: ContactState
) -> tuple[ContactBase, bool]:
    """Return the pair with softer springs, or without any once they hardly act."""
    assert isinstance(pair.law, Stabilised)
    force = pair.points(accepted).weight * np.abs(found.traction[0])
    is_open = found.status == Status.OPEN
    slides = (found.status == Status.SLIP).any()
    hardly_act = force[is_open].sum() <= _NEGLIGIBLE * force[~is_open].sum()
    share = pair.law.share * _FALL
    if share < _LAST or (hardly_act and not slides):
        return pair.with_(law=pair.law.law), False
    return pair.with_(law=replace(pair.law, share=share)), True


@dataclass(frozen=True)
class Stabilised(InterfaceLaw):
    """Interface law with soft springs, whose stiffness is a share of the penalty.

    Normal springs draw open points to the closest points.  Sideways springs act where the law
    resists slip under pressure, for without friction nothing will hold the bodies; they act
    at closed points too: not all of these may slide at once.
    """

    law: InterfaceLaw
    share: float

    reaches_far = True

    @property
    @override
    def n_internal(self) -> int:  # type: ignore[override]
        return self.law.n_internal

    @property
    @override
    def symmetric(self) -> bool:  # type: ignore[override]
        return self.law.symmetric

    @override
    def take(self, points: SlavePoints) -> Stabilised:
        return replace(self, law=self.law.take(points))

    @override
    def reaches(self, gap: ndarray, internal: ndarray, closed: ndarray) -> ndarray:
        return np.ones(len(gap), bool)

    @override
    def update(self, jump: ndarray, internal: ndarray, penalty: tuple[float, float]) -> LawUpdate:
        is_open = jump[0] > 0.0
        closed_jump = np.concatenate((np.minimum(jump[:1], 0.0), jump[1:]))
        law = self.law.update(closed_jump, internal, penalty)

        # Springs have a share of the penalty, sideways where the law resists slip under pressure
        pressed = np.zeros_like(jump)
        pressed[0] = -1.0
        resists = self.law.update(pressed, internal, penalty).tangent
        springs = self.share * np.einsum("iin->in", resists)
        springs[0] = np.where(is_open, self.share * penalty[0], 0.0)

        diagonal = np.arange(len(jump))
        tangent = np.where(is_open, 0.0, law.tangent)
        tangent[diagonal, diagonal] += springs
        return LawUpdate(
            traction=np.where(is_open, 0.0, law.traction) + springs * jump,
            internal=law.internal,
            tangent=tangent,
            elastic_slip=np.where(is_open, 0.0, law.elastic_slip),
            status=np.where(is_open, int(Status.OPEN), law.status),
        )

    @override
    def debonded(self, internal: ndarray) -> ndarray:
        return self.law.debonded(internal)


# Points that chatter between stick and slip: a soft stick, harder from solution to solution
#
# Sticking points react to an elastic slip e with the traction s epsilon_T (e + d).  The softness s
# is below 1, and the shift d makes this the traction t of the last solution where e is that of the
# whole penalty, t / epsilon_T: d = t / (s epsilon_T) - t / epsilon_T.  This is the augmented method
# with t as the multiplier.


def _start_soft_stick(
    pair: ContactBase, accepted: ContactState, failure: Failure | None
) -> ContactBase | None:
    """Return the softest stick where points change between stick and slip, or turn their slip.

    From slip in one direction to slip in the other the traction runs through stick, in an elastic
    slip that is smaller the higher the penalty; Newton's method may jump over it for ever.
    """
    if failure is None or not failure.seen or pair.softness < 1.0 or pair.saddle:
        return None
    directions = []
    for state in failure.seen:
        slides = state.status == Status.SLIP
        directions.append(np.sign(state.traction[1:]) * slides)
    seen = np.array(directions)  # (states, dim - 1, n)
    chatters = (seen != seen[0]).any(axis=(0, 1))
    if not chatters.any():
        return None
    if pair.stiffness is None:
        hardness = 1.0
    else:
        hardness = pair.penalties(accepted)[1] / pair.stiffness
    softness = min(_SHARE, _SOFT / hardness)
    logger.info(
        "points %s of '%s' chatter between stick and slip: a soft stick begins with %.1g of "
        "the penalty",
        np.flatnonzero(chatters),
        pair.slave.name,
        softness,
    )
    return _soft(pair, softness, pair.interface.elastic_slip(accepted))


def _harden_stick(
    pair: ContactBase, accepted: ContactState, found: ContactState
) -> tuple[ContactBase, bool]:
    """Return the pair with a harder stick, or the whole penalty in the end."""
    elastic = pair.interface.elastic_slip(found) * pair.softness
    change = np.abs(pair.interface.elastic_slip(accepted, found) - elastic)
    wrong = change[:, found.status == Status.STICK].max(initial=0.0)
    harder = _CHANGE * max_abs(elastic) / max(wrong, 1e-300)
    softness = max(harder, pair.softness * _GROWTH)
    if softness < 1.0:
        return _soft(pair, softness, elastic), True
    return pair.with_(softness=1.0, slip_shift=None), False


def _soft(pair: ContactBase, softness: float, elastic: ndarray) -> ContactBase:
    """Return a pair with the tractions of the whole penalty at an elastic slip (dim - 1, n)."""
    return pair.with_(softness=softness, slip_shift=elastic / softness - elastic)


# Points that open and close in turn: their bond breaks for good
#
# The tractions of a brittle bond jump to zero as a point opens.  Then there may be no equilibrium:
# with its bond the point is drawn open, and without it pressed on.


def _start_debonding(
    pair: ContactBase, accepted: ContactState, failure: Failure | None
) -> ContactBase | None:
    """Return a pair with broken bonds where points open and close in turn."""
    if failure is None or not failure.seen:
        return None
    closed = np.array([state.status != Status.OPEN for state in failure.seen])
    internal = pair.effective(accepted).internal
    bonded = (pair.law.debonded(internal) != internal).any(axis=0)
    breaks = closed.any(axis=0) & ~closed.all(axis=0) & bonded
    if not breaks.any():
        return None
    logger.info(
        "points %s of '%s' open and close in turn: their bond breaks",
        np.flatnonzero(breaks),
        pair.slave.name,
    )
    return pair.with_(debonded=breaks if pair.debonded is None else breaks | pair.debonded)


#: In the order in which they are tried.
FAMILIES = (
    Family(_start_interference, _resolve_interference),
    Family(_start_springs, _soften_springs),
    Family(_start_debonding, lambda pair, accepted, found: None),
    Family(_start_soft_stick, _harden_stick),
)
