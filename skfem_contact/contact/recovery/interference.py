"""Interference fits: bodies that overlap begin to push each other apart little by little."""
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
    """Overlaps of which a part counts as touching still; of the last member none.

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

    def seen(self, state: ContactState, law: InterfaceLaw) -> ContactState:
        """With what is left of the offset."""
        return replace(state, offset=self.offset)

    def proceed(self, pair: ContactPair, accepted: ContactState, found: ContactState) -> Interference:
        """Half of the overlap is left, and none of what is small."""
        left = _LEFT * (self.offset - self.wanted)
        if not left.any():
            return self
        left[np.abs(left) < PENETRATION * pair.points(accepted).size] = 0.0
        return replace(self, offset=self.wanted + left)
