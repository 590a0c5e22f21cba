"""Where the slave's points lie, and how they follow the bodies."""
from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np
from numpy import ndarray

from .quadrature import SlavePoints, between, common_cuts, gauss, moved, nodal
from .state import ContactState, transferred
from .surface import Surface

#: The rule "segments" is cut anew when a cut has moved by more than this share of a segment.
_MOVED = 1e-3
#: ... but not more often than this in an increment: cuts may go to and fro.
_RECUTS = 8


@dataclass(frozen=True, eq=False)
class Sampling:
    """Points of a slave that faces a master.

    Parameters
    ----------
    slave, master
        The surfaces.
    rule
        ``"nodal"``, a number of Gauss points on each slave segment or piece of it, or ``"segments"``, whose points
        lie between the cuts that a state remembers.
    """

    slave: Surface
    master: Surface
    rule: Literal["nodal", "segments"] | int

    def cuts(self, slave: ndarray, master: ndarray) -> ndarray:
        """Cuts where the nodes of the surfaces lie now; none unless the rule is ``"segments"``."""
        return common_cuts(self.slave, slave, self.master, master) if self.rule == "segments" else np.zeros(0)

    def points(self, cuts: ndarray) -> SlavePoints:
        """The points between cuts."""
        if self.rule == "segments":
            return between(self.slave, cuts, self.slave.segments.shape[1] + 1)
        return self._everywhere

    @cached_property
    def _everywhere(self) -> SlavePoints:
        return nodal(self.slave) if self.rule == "nodal" else gauss(self.slave, self.master, int(self.rule))

    def follow(self, state: ContactState, slave: ndarray, master: ndarray) -> ContactState | None:
        """The state at points between cuts that follow the bodies, or None where they follow closely enough.

        Parameters
        ----------
        state
            Accepted state, at the start of the increment.
        slave, master
            Coordinates of the surfaces' nodes that have been found in the increment.
        """
        cuts = self.cuts(slave, master)
        if len(cuts) == 0 or moved(state.cuts, cuts) <= _MOVED or state.recuts[0] >= _RECUTS:
            return None
        return replace(transferred(state, self.points(state.cuts), self.points(cuts)), cuts=cuts,
                       recuts=state.recuts + 1)
