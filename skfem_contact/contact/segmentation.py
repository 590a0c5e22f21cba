"""Where the slave's points lie, and how they follow the bodies."""
from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy import ndarray

from ..surfaces.surface import Surface
from .clipping import piecewise
from .neighbours import NeighbourList, Neighbours
from .quadrature import SlavePoints, between, gauss, nodal
from .search import Projection, project
from .state import ContactState
from .transfer import transferred

#: Pieces shorter than this share of a segment are left out.
_SLIVER = 1e-9
#: The rule "segments" is cut anew when a cut has moved by more than this share of a segment.
_MOVED = 1e-3
#: ... but not more often than this in an increment: cuts may chatter.
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
        if self.rule != "segments":
            return np.zeros(0)
        if self.slave.dim == 3:
            return piecewise(self.slave, slave, self.master, master)
        return common_cuts(self.slave, slave, self.master, master, self._facing)

    def fits(self, cuts: ndarray) -> bool:
        """Whether cuts are some of this slave."""
        if self.rule != "segments" or len(cuts) == 0:
            return self.rule != "segments" and len(cuts) == 0
        last = cuts[-1] - 1 if self.slave.dim == 2 else cuts[-1, 0] if cuts.ndim == 2 else -1
        return bool(last == len(self.slave.facets) - 1)

    def points(self, cuts: ndarray) -> SlavePoints:
        """The points between cuts."""
        if self.rule != "segments":
            return self._everywhere
        if self._last[0] is not cuts:
            self._last[:] = cuts, self._between(cuts)
        return self._last[1]

    def _between(self, cuts: ndarray) -> SlavePoints:
        if self.slave.dim == 2:
            return between(self.slave, cuts, self.slave.facets.shape[1] + 1)
        facet, xi, weight, facing = np.split(cuts, [1, 3, 4], axis=1)
        points = SlavePoints.on(self.slave, facet[:, 0].astype(int), xi, weight[:, 0])
        return replace(points, facing=facing[:, 0].astype(int))

    @cached_property
    def _facing(self) -> NeighbourList:
        """Facets of the slave that ends of the master's may face."""
        return NeighbourList(self.slave)

    @cached_property
    def _last(self) -> list[Any]:
        """Cuts that were asked for last, and their points."""
        return [None, None]

    @cached_property
    def _everywhere(self) -> SlavePoints:
        return nodal(self.slave) if self.rule == "nodal" else gauss(self.slave, self.master, int(self.rule))

    def project(self, points: SlavePoints, nodes: ndarray, positions: ndarray, depth: ndarray,
                previous: ndarray | None = None, locked: ndarray | None = None, among: Neighbours | None = None
                ) -> Projection:
        """Closest points of the points; those on pieces in space stay on the facet that their piece faces."""
        if (faces := points.facing >= 0).any():
            before = np.full(len(faces), -1) if previous is None else previous
            previous = np.where(faces, points.facing, before)
            locked = faces if locked is None else faces | locked
        return project(self.master, nodes, positions, depth, previous, locked, among)

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
        return self.transferred(state, cuts, slave, master)

    def transferred(self, state: ContactState, cuts: ndarray, slave: ndarray, master: ndarray) -> ContactState:
        """The state at the points between other cuts, where the nodes of the surfaces lie."""
        old, new = self.points(state.cuts), self.points(cuts)
        return replace(transferred(state, self.slave, slave, self.master, master, old, new), cuts=cuts)


def common_cuts(slave: Surface, slave_nodes: ndarray, master: Surface, master_nodes: ndarray, facing: NeighbourList
                ) -> ndarray:
    """Chain coordinates at which the slave is cut: by its own segments' ends and by those of the master.

    Between the cuts gap and shape functions are smooth on both sides, so that Gauss points on the pieces integrate
    the contact work exactly on flat interfaces: the patch test is passed.
    """
    m = len(master.facets)
    ends = master.at(np.arange(m), -np.ones((m, 1)), master_nodes, 0).x[0]
    if not master.closed:
        ends = np.concatenate((ends, master.at(np.array([m - 1]), np.ones((1, 1)), master_nodes, 0).x[0]))
    near = np.full(len(ends), slave.spacing)
    found = project(slave, slave_nodes, ends, near, among=facing.at(slave_nodes, ends))
    hit = found.found & ~found.vertex & (np.abs(found.xi[:, 0]) < 1.0) & (found.gap < near)
    inner = found.facet[hit] + 0.5 * (1.0 + found.xi[hit, 0])
    cuts = np.unique(np.concatenate((np.arange(len(slave.facets) + 1.0), inner)))
    tiny = np.diff(cuts) < _SLIVER
    drop = np.flatnonzero(tiny) + np.where(cuts[1:][tiny] % 1.0 == 0.0, 0, 1)  # keep the segments' own ends
    return np.delete(cuts, drop)


def moved(old: ndarray, new: ndarray) -> float:
    """Largest distance of a cut, old or new, from the nearest one among the others; in space, change of an area."""
    if old.ndim == 2:
        return _area_changed(old, new)

    def farthest(a: ndarray, b: ndarray) -> float:
        right = np.clip(np.searchsorted(b, a), 1, len(b) - 1)
        return float(np.minimum(np.abs(a - b[right - 1]), np.abs(a - b[right])).max())

    return max(farthest(old, new), farthest(new, old))


def _area_changed(old: ndarray, new: ndarray) -> float:
    """Largest change of what a facet has in common with one of the master, over the largest such area."""
    pairs, number = np.unique(np.concatenate((old, new))[:, [0, 4]], axis=0, return_inverse=True)
    before, after = (np.bincount(rows, cuts[:, 3], minlength=len(pairs)) for rows, cuts in (
        (number.ravel()[:len(old)], old), (number.ravel()[len(old):], new)))
    return float(np.abs(after - before).max() / before.max())
