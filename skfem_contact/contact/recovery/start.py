"""Bodies that do not hold each other as they are given: loose ones, and ones that overlap."""
from __future__ import annotations

import logging
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy import ndarray

from ...errors import Failure
from ..diagnosis import PENETRATION
from ..laws import InterfaceLaw, Status, Update
from ..quadrature import SlavePoints
from ..state import ContactState
from .family import Recovery

if TYPE_CHECKING:
    from ..pair import ContactPair

logger = logging.getLogger("skfem_contact")

#: Stiffness of the springs as a share of the penalty: at first, and when they are as good as gone.  Stiffer ones draw
#: wide gaps, as beside a cylinder on a plane, with many times the load.
_FIRST, _LAST = 1e-4, 1e-6
#: Factor by which the share falls from one solution to the next.
_FALL = 0.1
#: Springs that exert less than this share of the contact force need not be taken away little by little.
_NEGLIGIBLE = 1e-3
#: Share of the overlap that is left from one member to the next.
_LEFT = 0.5


@dataclass(frozen=True)
class Stabilisation(Recovery):
    """Soft springs until contact is closed, for bodies that nothing else holds; softer from solution to solution.

    Their stiffness is a share of the penalty.
    """

    share: float = _FIRST

    @classmethod
    def begin(cls, pair: ContactPair, accepted: ContactState, failure: Failure | None) -> Stabilisation | None:
        """The stiffest springs where bodies are loose, unless a bond holds them."""
        if failure is None or not failure.loose or pair.law.bonds or pair.easing.of(cls) is not None:
            return None
        logger.info("bodies are loose while contact is open: stabilisation by soft springs closes '%s', which are then "
                    "taken away", pair.slave.name)
        return cls()

    def law(self, law: InterfaceLaw) -> Stabilised:
        """The law with springs."""
        return Stabilised(law, self.share)

    def proceed(self, pair: ContactPair, accepted: ContactState, found: ContactState) -> Stabilisation | None:
        """Softer springs, or none where they are next to nothing or exert next to nothing."""
        force = pair.points(accepted).weight * np.abs(found.traction[0])
        is_open, slides = found.status == Status.OPEN, (found.status == Status.SLIP).any()
        share = self.share * _FALL
        gone = share < _LAST or (not slides and force[is_open].sum() <= _NEGLIGIBLE * force[~is_open].sum())
        return None if gone else Stabilisation(share)


@dataclass(frozen=True)
class Stabilised(InterfaceLaw):
    """An interface law with soft springs: normal ones draw open points to the surface that they face.

    Sideways springs act only where the law resists slip under pressure, for without friction nothing will hold the
    bodies there.  They act at closed points too: not all of these may slide at once.
    """

    law: InterfaceLaw
    share: float

    reaches_far = True

    @property
    def n_internal(self) -> int:  # type: ignore[override]
        """As the law."""
        return self.law.n_internal

    def take(self, points: SlavePoints) -> Stabilised:
        """The springs are the same everywhere."""
        return replace(self, law=self.law.take(points))

    def reaches(self, gap: ndarray, internal: ndarray, closed: ndarray) -> ndarray:
        """All points."""
        return np.ones(len(gap), bool)

    def update(self, jump: ndarray, internal: ndarray, penalty: tuple[float, float]) -> Update:
        """The law's tractions where the gap is closed, and those of the springs."""
        is_open, pressed = jump[0] > 0.0, np.zeros_like(jump)
        law = self.law.update(np.concatenate((np.minimum(jump[:1], 0.0), jump[1:])), internal, penalty)
        pressed[0] = -1.0
        resists = self.law.update(pressed, internal, penalty).tangent
        springs = self.share * np.einsum("iin->in", resists)
        springs[0] = np.where(is_open, self.share * penalty[0], 0.0)
        tangent = np.where(is_open, 0.0, law.tangent)
        tangent[np.arange(len(jump)), np.arange(len(jump))] += springs
        return Update(np.where(is_open, 0.0, law.traction) + springs * jump, law.internal, tangent,
                      np.where(is_open, 0.0, law.elastic_slip), np.where(is_open, int(Status.OPEN), law.status))


@dataclass(frozen=True, eq=False)
class Interference(Recovery):
    """Overlaps that are resolved in steps: a part of them counts as touching still, and of the last member none.

    Parameters
    ----------
    offset
        Gap that counts as touching, (n_points,).
    wanted
        What it is to become, (n_points,): zero for overlaps as meshed, or the interference that is asked for, from
        where the meshes fit.
    """

    offset: ndarray
    wanted: ndarray

    @classmethod
    def begin(cls, pair: ContactPair, accepted: ContactState, failure: Failure | None) -> Interference | None:
        """All of the overlap touches.

        There is nothing to do where it is not to be resolved in steps, or has been: closed points carry tractions then.
        """
        untouched = (accepted.status != Status.OPEN).any() and not accepted.traction.any()
        named = isinstance(pair.initial, str)
        wanted = np.zeros_like(accepted.offset) if named else accepted.offset + pair.initial
        ramped = (not named or pair.initial == "ramped") and (accepted.offset != wanted).any()
        return cls(accepted.offset, wanted) if failure is None and untouched and ramped else None

    def seen(self, state: ContactState) -> ContactState:
        """With what is left of the offset."""
        return replace(state, offset=self.offset)

    def proceed(self, pair: ContactPair, accepted: ContactState, found: ContactState) -> Interference:
        """Half of the overlap is left, and none of what is small."""
        left = _LEFT * (self.offset - self.wanted)
        if not left.any():
            return self
        left[np.abs(left) < PENETRATION * pair.points(accepted).size] = 0.0
        return replace(self, offset=self.wanted + left)
