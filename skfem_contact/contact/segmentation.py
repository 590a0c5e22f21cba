"""Where the slave's points lie, and how they follow the bodies."""
from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np
from numpy import ndarray

from .quadrature import SlavePoints, between, gauss, nodal
from .search import project
from .state import ContactState, transferred
from .surface import Surface

#: Pieces shorter than this share of a segment are left out.
_SLIVER = 1e-9
#: The rule "segments" is cut anew when a cut has moved by more than this share of a segment.
_MOVED = 1e-3
#: ... but not more often than this in an increment: cuts may go to and fro.
RECUTS = 8


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
            return between(self.slave, cuts, self.slave.facets.shape[1] + 1)
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
        if len(cuts) == 0 or moved(state.cuts, cuts) <= _MOVED:
            return None
        return replace(transferred(state, self.points(state.cuts), self.points(cuts)), cuts=cuts)


def common_cuts(slave: Surface, slave_nodes: ndarray, master: Surface, master_nodes: ndarray) -> ndarray:
    """Chain coordinates at which the slave is cut: by its own segments' ends and by those of the master.

    Between the cuts gap and shape functions are smooth on both sides, so that Gauss points on the pieces integrate
    the contact work exactly on flat interfaces: the patch test is passed.
    """
    m = len(master.facets)
    ends = master.at(np.arange(m), -np.ones((m, 1)), master_nodes, 0).x[0]
    if not master.closed:
        ends = np.concatenate((ends, master.at(np.array([m - 1]), np.ones((1, 1)), master_nodes, 0).x[0]))
    near = np.full(len(ends), slave.spacing)
    found = project(slave, slave_nodes, ends, near)
    hit = found.found & ~found.vertex & (np.abs(found.xi[:, 0]) < 1.0) & (found.gap < near)
    inner = found.facet[hit] + 0.5 * (1.0 + found.xi[hit, 0])
    cuts = np.unique(np.concatenate((np.arange(len(slave.facets) + 1.0), inner)))
    tiny = np.diff(cuts) < _SLIVER
    drop = np.flatnonzero(tiny) + np.where(cuts[1:][tiny] % 1.0 == 0.0, 0, 1)  # keep the segments' own ends
    return np.delete(cuts, drop)


def moved(old: ndarray, new: ndarray) -> float:
    """Largest distance of a cut, old or new, from the nearest one among the others."""
    def farthest(a: ndarray, b: ndarray) -> float:
        right = np.clip(np.searchsorted(b, a), 1, len(b) - 1)
        return float(np.minimum(np.abs(a - b[right - 1]), np.abs(a - b[right])).max())

    return max(farthest(old, new), farthest(new, old))
