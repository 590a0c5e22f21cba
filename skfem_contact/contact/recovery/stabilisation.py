"""Start-up of bodies that nothing but contact holds: soft springs until it is closed."""
from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy import ndarray

from ..laws import InterfaceLaw, Status, Update
from ..quadrature import SlavePoints
from ..state import ContactState

#: Stiffness of the springs as a share of the penalty: at first, and when they are as good as gone.  Stiffer ones draw
#: wide gaps, as beside a cylinder on a plane, with many times the load.
_FIRST, _LAST = 1e-4, 1e-6
#: Factor by which the share falls from one solution to the next.
_FALL = 0.1
#: Springs that exert less than this share of the contact force need not be taken away little by little.
_NEGLIGIBLE = 1e-3


@dataclass(frozen=True)
class Held(InterfaceLaw):
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

    @property
    def n_internal(self) -> int:  # type: ignore[override]
        """As the law."""
        return self.law.n_internal

    @property
    def bonds(self) -> bool:
        """As the law."""
        return self.law.bonds

    def take(self, points: SlavePoints) -> Held:
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


def with_springs(state: ContactState) -> ContactState:
    """The state with springs at its open points; the same one where it has them."""
    return state if state.springs[0] == _FIRST else replace(state, springs=np.array([_FIRST]))


def release(accepted: ContactState, candidate: ContactState, weight: ndarray) -> ContactState:
    """The accepted state with softer springs, or with none where they are next to nothing or exert next to nothing.

    Parameters
    ----------
    accepted, candidate
        State at the start of the increment, and the one that has been found with springs.
    weight
        Lengths of surface that belong to the points.
    """
    force = weight * np.abs(candidate.normal)
    is_open, slides = candidate.status == Status.OPEN, (candidate.status == Status.SLIP).any()
    share = float(accepted.springs[0]) * _FALL
    gone = share < _LAST or (not slides and force[is_open].sum() <= _NEGLIGIBLE * force[~is_open].sum())
    return replace(accepted, springs=np.array([0.0 if gone else share]))
