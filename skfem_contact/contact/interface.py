"""The two surfaces of a contact pair: the points of the slave, what they face, and how they follow the bodies."""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy import ndarray
from scipy.spatial import cKDTree

from ..surfaces.material_points import MaterialPoints, along_chain, apart, behind, shifted, way
from ..surfaces.surface import Surface
from ..surfaces.vectors import frame
from .kinematics import Kinematics, variations
from .laws import Status
from .neighbours import NeighbourList, Neighbours
from .pieces import common_cuts, moved, piecewise
from .quadrature import SlavePoints, between, gauss, nodal
from .search import Projection, merged, project
from .state import ContactState

#: The rule "segments" is cut anew when a cut has moved by more than this share of a segment.
_MOVED = 1e-3
#: ... but not more often than this in an increment: cuts may chatter.
RECUTS = 8


@dataclass(frozen=True, eq=False)
class Interface:
    """A slave that faces a master.

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

    @cached_property
    def neighbours(self) -> NeighbourList:
        """Facets of the master that points of the slave may face."""
        return NeighbourList(self.master)

    @cached_property
    def _meshed(self) -> NeighbourList:
        """Those that they face in the mesh, where nothing moves."""
        return NeighbourList(self.master)

    @cached_property
    def _facing(self) -> NeighbourList:
        """Facets of the slave that ends of the master's may face."""
        return NeighbourList(self.slave)

    def places(self, x: ndarray | None) -> tuple[ndarray, ndarray]:
        """Nodes of both surfaces, seen from the middle of the slave: large coordinates would cost digits.

        They are displaced by x, (N,), or undeformed for None.
        """
        origin = self.slave.middle
        return self.slave.positions(x, origin), self.master.positions(x, origin)

    # -- points of the slave --------------------------------------------------------------------------------

    def cuts(self, x: ndarray | None) -> ndarray:
        """Cuts at some displacements; none unless the rule is ``"segments"``."""
        if self.rule != "segments":
            return np.zeros(0)
        slave, master = self.places(x)
        if self.slave.dim == 3:
            return piecewise(self.slave, slave, self.master, master)
        return common_cuts(self.slave, slave, self.master, master, self._facing)

    def fits(self, cuts: ndarray) -> bool:
        """Whether cuts are some of this slave."""
        if len(cuts) == 0 or cuts.ndim != self.slave.dim - 1:
            return False
        return bool((cuts[-1] - 1 if cuts.ndim == 1 else cuts[-1, 0]) == len(self.slave.facets) - 1)

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
    def _last(self) -> list[Any]:
        """Cuts that were asked for last, and their points."""
        return [None, None]

    @cached_property
    def _everywhere(self) -> SlavePoints:
        return nodal(self.slave) if self.rule == "nodal" else gauss(self.slave, self.master, int(self.rule))

    # -- what they face -------------------------------------------------------------------------------------

    def depth(self, points: SlavePoints) -> ndarray:
        """Largest penetration: what is deeper than an element or so belongs to the other side of the body."""
        return np.maximum(points.size, self.master.spacing)

    def project(self, points: SlavePoints, nodes: ndarray, positions: ndarray, depth: ndarray,
                previous: ndarray | None, locked: ndarray | None, among: Neighbours) -> Projection:
        """Closest points of the points; those on pieces in space stay on the facet that their piece faces."""
        if (faces := points.facing >= 0).any():
            before = np.full(len(faces), -1) if previous is None else previous
            previous = np.where(faces, points.facing, before)
            locked = faces if locked is None else faces | locked
        return project(self.master, nodes, positions, depth, previous, locked, among)

    def near(self, slave: ndarray, nodes: ndarray, state: ContactState, reach: ndarray, depth: ndarray,
             locked: ndarray | None) -> tuple[Projection, Callable[[], Projection]]:
        """Closest points of closed points and of those that may be as near as a reach, (n,); what finds all others too.

        The nodes of the surfaces lie there, no point is deeper than a depth, (n,), locked ones stay on their facets.
        """
        points = self.points(state.cuts)
        positions = points.positions(slave)
        around = self.neighbours.at(nodes, positions)
        near = (state.status != Status.OPEN) | around.within(reach, depth)  # the others need not be projected

        def projected(chosen: ndarray) -> Projection:
            return self.project(points, nodes, positions, depth, state.facet, locked, around.of(chosen))

        found = projected(near)
        self.neighbours.learn(near, found.distance, found.gap)
        return found, lambda: merged(near, found, projected)

    def closest(self, x: ndarray | None, cuts: ndarray, previous: ndarray | None = None) -> Projection:
        """Closest points of all points between cuts, at some displacements."""
        slave, nodes = self.places(x)
        points = self.points(cuts)
        positions = points.positions(slave)
        around = self._meshed if x is None else self.neighbours
        return self.project(points, nodes, positions, self.depth(points), previous, None, around.at(nodes, positions))

    def variations(self, x: ndarray, state: ContactState, found: Projection, at: ndarray) -> Kinematics:
        """Variations of points of a state, given by their numbers, at their closest points."""
        slave, nodes = self.places(x)
        return variations(self.points(state.cuts).take(at), self.slave, self.master, found.take(at), slave, nodes,
                          state.stick.take(at))

    def passed_through(self, x: ndarray, accepted: ContactState, found: ContactState) -> int:
        """Number of points that were outside the master, or near its surface, and are deep inside now, or beyond it."""
        points, (slave, nodes) = self.points(accepted.cuts), self.places(x)
        depth = self.depth(points)
        was_outside = np.isfinite(accepted.gap) & (accepted.gap >= -depth)
        passed = was_outside & (found.gap < -depth)
        left = np.flatnonzero(was_outside & accepted.closest.exist & (accepted.gap <= depth)
                              & (found.status == Status.OPEN))
        touched = self.master.at(*accepted.closest.take(left), nodes)
        offset = points.positions(slave)[left] - touched.x[0]
        passed[left] |= np.einsum("nc,nc->n", offset, touched.normal) < -depth[left]
        return int(passed.sum())

    # -- ways along the undeformed master, (dim - 1, n) -----------------------------------------------------

    def _tangents(self, points: SlavePoints, closest: MaterialPoints) -> ndarray:
        """Unit tangents of the undeformed master, (n, dim - 1, dim), counted as those of slips are."""
        normal = self.master.at(closest.facet, closest.known, self.master.nodes).normal
        return frame(normal, points.direction(self.slave, self.slave.nodes))

    def _apart(self, cuts: ndarray, closest: MaterialPoints, before: MaterialPoints) -> ndarray:
        tangents = self._tangents(self.points(cuts), closest)
        return apart(self.master, self.master.nodes, tangents, closest, before).T

    def slid(self, accepted: ContactState, closest: MaterialPoints) -> ndarray:
        """Way of the closest points since a state: along the chain, or straight in space."""
        if self.slave.dim == 2:
            return way(self.master, closest, accepted.closest)[None]
        return self._apart(accepted.cuts, closest, accepted.closest)

    def elastic_slip(self, state: ContactState, found: ContactState | None = None) -> ndarray:
        """Slip of a state's closest points, or of those of another one, from its stick points."""
        return self._apart(state.cuts, (found or state).closest, state.stick)

    def with_elastic_slip(self, state: ContactState, slip: ndarray) -> ContactState:
        """The state with stick points from which the closest points have slipped."""
        tangents = self._tangents(self.points(state.cuts), state.closest)
        return state.with_stick(behind(self.master, self.master.nodes, tangents, state.closest, slip.T))

    # -- other points ---------------------------------------------------------------------------------------

    def follow(self, state: ContactState, x: ndarray) -> ContactState | None:
        """An accepted state at points between cuts that follow the bodies to x; None where they do closely enough."""
        cuts = self.cuts(x)
        return None if len(cuts) == 0 or moved(state.cuts, cuts) <= _MOVED else self.transferred(state, cuts, x)

    def transferred(self, state: ContactState, cuts: ndarray, x: ndarray | None) -> ContactState:
        """The state at the points between other cuts, at some displacements.

        Positions on the master, and what is no smooth field, come from the nearest old point.
        """
        old, new, (slave, master) = self.points(state.cuts), self.points(cuts), self.places(x)
        at, elastic = self.nearest(old, new), self.elastic_slip(state)
        slip, traction, offset, elastic = (self.interpolated(old, new, values) for values in (
            state.slip, state.traction, state.offset, elastic))
        motion = new.positions(slave) - old.positions(slave)[at]
        closest = shifted(self.master, master, state.closest.take(at), motion)
        state = replace(state, facet=closest.facet, position=closest.xi.T, gap=state.gap[at], status=state.status[at],
                        internal=state.internal[:, at], slip=slip, traction=traction, offset=offset,
                        stick_facet=closest.facet, stick_point=closest.xi.T, cuts=cuts)
        return self.with_elastic_slip(state, elastic)

    def nearest(self, old: SlavePoints, new: SlavePoints) -> ndarray:
        """Number of the old point nearest to each new one in the undeformed slave."""
        if self.slave.dim == 2:
            before, after = (along_chain(self.slave, points.facet, points.xi) for points in (old, new))
            return np.asarray(np.abs(after[:, None] - before).argmin(axis=1))
        before, after = (self._places_and_normals(points) for points in (old, new))
        return np.asarray(cKDTree(before).query(after)[1])

    def _places_and_normals(self, points: SlavePoints) -> ndarray:
        """Where points of a slave in space lie, and which way they look: not round a corner, (n, 6)."""
        normal = self.slave.at(points.facet, points.xi, self.slave.nodes).normal
        return np.hstack((points.positions(self.slave.nodes), self.slave.spacing * normal))

    def interpolated(self, old: SlavePoints, new: SlavePoints, values: ndarray) -> ndarray:
        """Fields, (..., n), at new points: along the slave in the plane, of the nearest old point in space."""
        if self.slave.dim == 3:
            return np.asarray(values[..., self.nearest(old, new)])
        before, after = (along_chain(self.slave, points.facet, points.xi) for points in (old, new))
        rows = [np.interp(after, before, row) for row in values.reshape(-1, values.shape[-1])]
        return np.array(rows).reshape(*values.shape[:-1], len(after))
