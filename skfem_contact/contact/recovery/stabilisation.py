"""Start-up of bodies that nothing but contact holds: soft springs until it is closed."""
from __future__ import annotations

import logging
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy import ndarray

from ...errors import Failure
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


@dataclass(frozen=True)
class Stabilisation(Recovery):
    """Springs that become softer from solution to solution.

    Parameters
    ----------
    share
        Stiffness of the springs as a share of the penalty.
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

    Parameters
    ----------
    law
        The law.
    share
        Stiffness of the springs as a share of the penalty.
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
        return Update(
            traction=np.where(is_open, 0.0, law.traction) + springs * jump,
            internal=law.internal,
            tangent=tangent,
            elastic_slip=np.where(is_open, 0.0, law.elastic_slip),
            status=np.where(is_open, int(Status.OPEN), law.status),
        )
