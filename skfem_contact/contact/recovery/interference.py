"""Interference fits: bodies that overlap as meshed begin to push each other apart little by little."""
from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy import ndarray

from ...errors import Failure
from ..diagnosis import PENETRATION
from ..laws import InterfaceLaw, Status
from ..state import ContactState
from .family import Recovery

if TYPE_CHECKING:
    from ..pair import ContactPair

#: Share of the overlap that is left from one member to the next.
_LEFT = 0.5


@dataclass(frozen=True, eq=False)
class Interference(Recovery):
    """Overlaps as meshed of which a part counts as touching still; of the last member none.

    Parameters
    ----------
    offset
        Gap that counts as touching, (n_points,).
    """

    offset: ndarray

    @classmethod
    def begin(cls, pair: ContactPair, accepted: ContactState, failure: Failure | None) -> Interference | None:
        """All of the overlap touches.

        There is nothing to do where it is not to be resolved in steps, or has been: closed points carry tractions then.
        """
        untouched = (accepted.status != Status.OPEN).any() and not accepted.traction.any()
        wanted = failure is None and pair.initial == "ramped" and untouched and accepted.offset.any()
        return cls(accepted.offset) if wanted else None

    def seen(self, state: ContactState, law: InterfaceLaw) -> ContactState:
        """With what is left of the offset."""
        return replace(state, offset=self.offset)

    def proceed(self, pair: ContactPair, accepted: ContactState, found: ContactState) -> Interference:
        """Half of the overlap is left, and none of what is small."""
        if not self.offset.any():
            return self
        left = _LEFT * self.offset
        return Interference(np.where(np.abs(left) < PENETRATION * pair.points(accepted).size, 0.0, left))
