"""Interface of a contact pair: the slave's points, their state, and their closest points."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy import ndarray

from ..arrays import max_abs
from ..surfaces.faceting import Faceting, alike
from ..surfaces.material_points import (
    MaterialPoints,
    arc_distance,
    distance,
    offset_back,
)
from ..surfaces.surface import Surface
from ..surfaces.vectors import dot, frame
from .fold import Beside, Fold
from .kinematics import Kinematics, variations
from .laws import LawUpdate, Status
from .neighbours import ON_FACET, NeighbourList, Neighbours, Pairs
from .quadrature import SlavePoints, between, changed, common_cuts, gauss, nodal, piecewise
from .search import Projection, merged, project
from .symmetry import Plane
from .transfer import Transfer

#: The rule "segments" is cut anew when a cut has moved by more than this share of a segment.
_MOVED = 1e-3
#: ... but not more often than this in an increment: cuts may chatter.
RECUTS = 8
#: Gaps of the mesh below this share of the slave segment are round-off: such bodies touch.
TOUCHING = 1e-8
#: A gap below this share of the coordinates is nothing: bodies that touch unloaded still touch when
#: they move.
ROUND_OFF = 8 * np.finfo(float).eps


@dataclass(frozen=True)
class ContactState:
    """State of a contact pair with ``n`` points; the plane has ``dim = 2``.

    In space slips and shear tractions have two components: one along the slave's ``directions``,
    which move with its material, and one to the left of that, seen from the slave's side.

    Attributes
    ----------
    facet, position : ndarray, shapes (n,) and (dim - 1, n)
        Facet of the master with the closest point or -1, and local coordinates
        there.
    stick_facet, stick_point : ndarray, shapes (n,) and (dim - 1, n)
        Material point of the master to which each point sticks; -1 where it has no counterpart.
    gap : ndarray, shape (n,)
        Normal gap; negative: penetration, inf: nothing opposite.
    slip : ndarray, shape (dim - 1, n)
        Slip since the point closed, with all motion in the increment in which it closed.
    closing_slip : ndarray, shape (n,)
        Length of the slip in the increment in which the point closed.
    traction : ndarray, shape (dim, n)
        Normal traction, negative in compression, then shear, which opposes the slip.
    status : ndarray, shape (n,)
        0 open, 1 stick, 2 slip.
    internal : ndarray, shape (n_internal, n)
        Internal variables of the law.
    multiplier : ndarray, shape (dim, n_nodes)
        Lagrange multipliers at the slave's nodes; zero in the penalty method.
    penalty_factor : ndarray, shape (2,)
        Factors by which the augmented method has changed the normal and the tangential penalty.
    clearance : ndarray, shape (n,)
        Gap of bodies that touch: the initial one where it was adjusted.
    rounded : ndarray, shape (n,)
        Part of the clearance by which facets differ from smooth curves; 0.0 in states of older
        files.
    closed : ndarray, shape (n_nodes,)
        Nodes that are closed in the method of :class:`DualMultipliers`.
    cuts : ndarray
        Cuts of the slave for ``quadrature="segments"``: facet numbers plus shares of the facet in
        the plane, points of the pieces in space; empty for other rules.
    """

    facet: ndarray
    position: ndarray
    stick_facet: ndarray
    stick_point: ndarray
    gap: ndarray
    slip: ndarray
    closing_slip: ndarray
    traction: ndarray
    status: ndarray
    internal: ndarray
    multiplier: ndarray
    penalty_factor: ndarray
    clearance: ndarray
    closed: ndarray
    cuts: ndarray
    rounded: ndarray | float = 0.0

    @property
    def closest(self) -> MaterialPoints:
        """Closest points on the master."""
        return MaterialPoints(self.facet, self.position.T)

    @property
    def stick(self) -> MaterialPoints:
        """Stick points on the master."""
        return MaterialPoints(self.stick_facet, self.stick_point.T)

    def after(
        self,
        found: Projection,
        at: ndarray,
        update: LawUpdate,
        stick: MaterialPoints,
        slip: ndarray,
    ) -> ContactState:
        """Return the candidate state after an update of the points `at`.

        Open points stick to their closest points.
        """
        # Set the points that are updated; the others are open.
        closest = found.closest
        stick_facet = closest.facet.copy()
        stick_xi = closest.xi.copy()
        stick_facet[at], stick_xi[at] = stick
        traction = np.zeros_like(self.traction)
        traction[:, at] = update.traction
        status = np.full(len(found.gap), int(Status.OPEN))
        status[at] = update.status
        internal = self.internal.copy()
        internal[:, at] = update.internal
        # An open point has no slip, and keeps the slip at which it closed.
        slip = np.where(status == Status.OPEN, 0.0, slip)
        closing_slip = np.where(
            self.status == Status.OPEN, np.linalg.norm(slip, axis=0), self.closing_slip
        )
        return replace(
            self,
            facet=closest.facet,
            position=closest.xi.T,
            stick_facet=stick_facet,
            stick_point=stick_xi.T,
            gap=found.gap,
            slip=slip,
            closing_slip=closing_slip,
            traction=traction,
            status=status,
            internal=internal,
        )

    def with_stick(self, stick: MaterialPoints) -> ContactState:
        """Return a copy with other stick points."""
        return replace(self, stick_facet=stick.facet, stick_point=stick.xi.T)


class _Found(NamedTuple):
    """Last projection: given points and coordinates, a mask of projected points, and the result."""

    points: SlavePoints
    given: tuple[ndarray, ...]
    near: ndarray
    result: Projection


@dataclass(frozen=True, eq=False)
class Interface:
    """Slave and master with a quadrature rule, and the share of a facet that gaps may have.

    With `rounds` gaps count between smooth curves where facets in the plane approximate these.
    With a `fold` both are one surface, which touches itself. The slave may end at `planes` of
    symmetry.
    """

    slave: Surface
    master: Surface
    rule: Literal["nodal", "segments"] | int
    adjusted: float = 0.0
    rounds: bool = False
    fold: Fold | None = None
    planes: tuple[Plane, ...] = ()

    def _around(
        self, candidates: NeighbourList, points: SlavePoints, nodes: ndarray, positions: ndarray
    ) -> Neighbours:
        """Return candidates for closest points: on a folded surface no neighbours."""
        beside = None if self.fold is None else Beside(self.fold, points.facet)
        return candidates.at(nodes, positions, points.facing, beside)

    @cached_property
    def _facetings(self) -> tuple[Faceting, Faceting] | None:
        """Distances of both surfaces' facets from smooth curves; None where these do not count."""
        if not (self.rounds and alike(self.slave, self.master)):
            return None
        return Faceting.of(self.slave), Faceting.of(self.master)

    @property
    def smooth(self) -> bool:
        """True if gaps count between smooth curves."""
        return self._facetings is not None

    def faceting(self, points: SlavePoints, closest: MaterialPoints) -> ndarray:
        """Return gaps between the facets of smooth curves that touch, shape (n,)."""
        if self._facetings is None:
            return np.zeros(len(points.weight))
        own, opposite = self._facetings
        gap = own.at(MaterialPoints(points.facet, points.xi)) + opposite.at(closest)
        return np.where(closest.exist, gap, 0.0)

    def meshed_gap(self, state: ContactState) -> ndarray:
        """Return gaps of the mesh, (n,), from which present ones differ by displacements alone."""
        points = self.points(state.cuts)
        found = self.in_mesh(state.cuts)
        return np.asarray(found.gap - self.faceting(points, found.closest) + state.rounded)

    def in_mesh(self, cuts: ndarray) -> Projection:
        """Project all points between cuts in the undeformed mesh."""
        if self.rule == "segments":
            return self.closest(None, cuts)
        return self._everywhere_in_mesh

    @cached_property
    def _everywhere_in_mesh(self) -> Projection:
        """Closest points in the undeformed mesh, for a rule that knows no cuts."""
        return self.closest(None, np.zeros(0))

    @cached_property
    def neighbours(self) -> NeighbourList:
        """Facets of the master that may be closest to points of the slave."""
        return NeighbourList(self.master)

    @cached_property
    def _meshed(self) -> NeighbourList:
        """Candidates in the undeformed mesh."""
        return NeighbourList(self.master)

    @cached_property
    def _facing(self) -> NeighbourList:
        """Facets of the slave that may be closest to ends of the master's facets."""
        return NeighbourList(self.slave)

    def positions(self, x: ndarray | None) -> tuple[ndarray, ndarray]:
        """Return the nodes of both surfaces displaced by x (N,), or undeformed for None.

        They count from the middle of the slave: large coordinates would cost digits.
        """
        origin = self.slave.middle
        return self.slave.positions(x, origin), self.master.positions(x, origin)

    def cuts(self, x: ndarray | None) -> ndarray:
        """Return the cuts at displacements x; none unless the rule is ``"segments"``."""
        if self.rule != "segments":
            return np.zeros(0)
        slave, master = self.positions(x)
        if self.slave.dim == 3:
            planes = [plane.now(slave) for plane in self.planes]
            return piecewise(self.slave, slave, self.master, master, self.adjusted, planes)
        return common_cuts(
            self.slave, slave, self.master, master, facing=self._facing, mirrored=self._mirrored
        )

    @cached_property
    def _mirrored(self) -> tuple[bool, bool]:
        """True if the slave's chain in the plane begins and ends at planes of symmetry."""
        if self.slave.closed:
            return False, False
        on_plane = np.unique(np.concatenate([np.zeros(0, int), *(p.nodes for p in self.planes)]))
        begin, end = self.slave.shape.corners.argmin(), self.slave.shape.corners.argmax()
        return self.slave.facets[0, begin] in on_plane, self.slave.facets[-1, end] in on_plane

    def fits(self, cuts: ndarray) -> bool:
        """Return True if cuts belong to this slave."""
        if len(cuts) == 0 or cuts.ndim != self.slave.dim - 1:
            return False
        if cuts.ndim == 1:
            last_facet = cuts[-1] - 1
        else:
            last_facet = cuts[-1, 0]
        return bool(last_facet == len(self.slave.facets) - 1)

    def points(self, cuts: ndarray) -> SlavePoints:
        """Return the points between cuts."""
        if self.rule != "segments":
            return self._everywhere
        if self._last[0] is not cuts:
            self._last[:] = cuts, self._between(cuts)
        return self._last[1]

    def _between(self, cuts: ndarray) -> SlavePoints:
        """Return the points on pieces: in the plane between cuts, in space given by their rows."""
        if self.slave.dim == 2:
            return between(self.slave, cuts, self.slave.facets.shape[1] + 1)
        facet, xi, weight, facing = np.split(cuts, [1, 3, 4], axis=1)
        points = SlavePoints.on(self.slave, facet[:, 0].astype(int), xi, weight[:, 0])
        return replace(points, facing=facing[:, 0].astype(int))

    @cached_property
    def _last(self) -> list[Any]:
        """Last cuts and the points between them."""
        return [None, None]

    @cached_property
    def _everywhere(self) -> SlavePoints:
        """Points of a rule that knows no cuts."""
        if self.rule == "nodal":
            return nodal(self.slave)
        return gauss(self.slave, self.master, int(self.rule))

    def depth(self, points: SlavePoints) -> ndarray:
        """Return the largest penetration: a deeper point belongs to the other side of the body."""
        depth = np.maximum(points.size, self.master.spacing)
        if self.fold is not None:
            return np.minimum(depth, self._half_thickness)
        return depth

    @cached_property
    def _half_thickness(self) -> ndarray:
        """Half the distance of points from the opposite side of their own wall, shape (n,)."""
        points = self._everywhere
        slave, nodes = self.positions(None)
        positions = points.positions(slave)
        around = self._around(self._meshed, points, nodes, positions)
        unlimited = np.full(len(positions), np.inf)
        found = self.project(points, nodes, positions, unlimited, None, around.pairs)
        behind = found.found & (found.gap < -ROUND_OFF * max_abs(nodes))
        return np.where(behind, -0.5 * found.gap, np.inf)

    def project(
        self,
        points: SlavePoints,
        nodes: ndarray,
        positions: ndarray,
        depth: ndarray,
        previous: ndarray | None,
        among: Pairs,
        held: ndarray | None = None,
    ) -> Projection:
        """Return closest points; points on pieces in space stay on the facets that these face."""
        # Points on pieces keep the facet that they face.
        frozen = None
        faces = points.facing >= 0
        if faces.any():
            frozen = faces
            previous = np.where(faces, points.facing, -1 if previous is None else previous)
        return project(
            self.master,
            nodes,
            points=positions,
            depth=depth,
            previous=previous,
            frozen=frozen,
            among=among,
            held=held,
            fold=self.fold,
            own_facets=points.facet,
        )

    def within_facets(self, state: ContactState) -> ndarray:
        """Return a mask of the points with a closest point on no side of their facet."""
        beyond = self.master.shape.beyond(np.nan_to_num(state.position.T))
        return np.asarray((state.facet >= 0) & (np.abs(beyond) > ON_FACET).all(axis=1))

    def off_facets(self, state: ContactState) -> ndarray:
        """Return a mask of the points that an increment has left beyond a side of their facet."""
        beyond = self.master.shape.beyond(np.nan_to_num(state.position.T))
        limit = self.master.reach[state.facet.clip(0)] + ON_FACET
        return np.asarray((state.facet >= 0) & (beyond > limit).any(axis=1))

    def near(
        self,
        slave: ndarray,
        nodes: ndarray,
        state: ContactState,
        reach: ndarray,
        depth: ndarray,
        held: ndarray | None = None,
    ) -> tuple[Projection, Callable[[], Projection]]:
        """Project closed points, and open ones that may be as near as a reach.

        Parameters
        ----------
        slave, nodes : ndarray, shape (n_nodes, dim)
            Present coordinates of the nodes of both surfaces.
        reach, depth : ndarray, shape (n,)
            Gap that matters; largest penetration.
        held : ndarray, shape (n,), optional
            True for points that stay on their facets, see :func:`.search.project`.

        Returns
        -------
        Projection
            Closest points of these points.
        callable
            Function that projects all others as well, and returns the closest points of all.
        """
        points = self.points(state.cuts)
        positions = points.positions(slave)
        around = self._around(self.neighbours, points, nodes, positions)
        near = (state.status != Status.OPEN) | around.within(reach, depth)

        def projected(chosen: ndarray) -> Projection:
            among = around.of(chosen)
            return self.project(
                points,
                nodes,
                positions,
                depth,
                state.facet,
                among,
                held,
            )

        # Reuse the last projection where nothing but multipliers has changed
        mask = np.zeros(0, bool) if held is None else held
        given = (state.facet, slave, nodes, depth, mask)
        last = self._found[0]
        reused = last is not None and last.points is points
        if reused and all(map(np.array_equal, last.given, given)):
            found = last.result
            if (near & ~last.near).any():
                found = merged(last.near, found, lambda others: projected(others & near))
            near |= last.near
        else:
            found = projected(near)
            self.neighbours.learn(near, found.distance, found.gap)
        self._found[0] = _Found(points, given, near, found)

        def everywhere() -> Projection:
            result = merged(near, found, projected)
            self._found[0] = _Found(points, given, np.ones_like(near), result)
            return result

        return found, everywhere

    @cached_property
    def _found(self) -> list[Any]:
        """Last projection, a :class:`_Found`."""
        return [None]

    def closest(
        self, x: ndarray | None, cuts: ndarray, previous: ndarray | None = None
    ) -> Projection:
        """Project all points between cuts at displacements x."""
        slave, nodes = self.positions(x)
        points = self.points(cuts)
        positions = points.positions(slave)
        candidates = self._meshed if x is None else self.neighbours
        around = self._around(candidates, points, nodes, positions)
        return self.project(points, nodes, positions, self.depth(points), previous, around.pairs)

    def variations(
        self, x: ndarray, state: ContactState, found: Projection, at: ndarray
    ) -> Kinematics:
        """Return the kinematics of the points `at` of a state at their closest points."""
        slave, nodes = self.positions(x)
        return variations(
            self.points(state.cuts).take(at),
            self.slave,
            self.master,
            found.take(at),
            slave,
            nodes,
            state.stick.take(at),
        )

    def passed_through(self, x: ndarray, accepted: ContactState, found: ContactState) -> int:
        """Count points from outside, or near the surface, that are deep inside now, or beyond."""
        points = self.points(accepted.cuts)
        slave, nodes = self.positions(x)
        depth = self.depth(points)
        was_outside = np.isfinite(accepted.gap) & (accepted.gap >= -depth)
        passed = was_outside & (found.gap < -depth)

        # Compare points that were near and are open now with their former closest points
        was_near = was_outside & accepted.closest.exist & (accepted.gap <= depth)
        released = np.flatnonzero(was_near & (found.status == Status.OPEN))
        touched = self.master.at(*accepted.closest.take(released), nodes)
        offset = points.positions(slave)[released] - touched.x[0]
        passed[released] |= dot(offset, touched.normal) < -depth[released]
        return int(passed.sum())

    def _tangents(self, points: SlavePoints, closest: MaterialPoints) -> ndarray:
        """Return unit tangents of the undeformed master along slips, shape (n, dim - 1, dim)."""
        normal = self.master.at(closest.facet, closest.known, self.master.nodes).normal
        return frame(normal, points.direction(self.slave, self.slave.nodes))

    def _distance(self, cuts: ndarray, closest: MaterialPoints, before: MaterialPoints) -> ndarray:
        """Return distances along the undeformed master, shape (dim - 1, n)."""
        tangents = self._tangents(self.points(cuts), closest)
        return distance(self.master, self.master.nodes, tangents, closest, before).T

    def slid(self, accepted: ContactState, closest: MaterialPoints) -> ndarray:
        """Return distances of closest points from a state's: along the chain, straight in space."""
        if self.slave.dim == 2:
            return arc_distance(self.master, closest, accepted.closest)[None]
        return self._distance(accepted.cuts, closest, accepted.closest)

    def elastic_slip(self, state: ContactState, found: ContactState | None = None) -> ndarray:
        """Return the slip of the closest points, or of a found state's, from the stick points."""
        closest = state.closest if found is None else found.closest
        return self._distance(state.cuts, closest, state.stick)

    def with_elastic_slip(self, state: ContactState, slip: ndarray) -> ContactState:
        """Return the state with stick points from which the closest points have this slip."""
        tangents = self._tangents(self.points(state.cuts), state.closest)
        stick = offset_back(self.master, self.master.nodes, tangents, state.closest, slip.T)
        return state.with_stick(stick)

    def follow(
        self, state: ContactState, found: ContactState, x: ndarray
    ) -> tuple[ContactState, Transfer] | None:
        """Return an accepted state at cuts that follow the bodies to x, and the transfer to them.

        The `found` state is at x between the old cuts. None if the cuts hardly move.
        """
        cuts = self.cuts(x)
        if len(cuts) == 0 or changed(state.cuts, cuts) <= _MOVED:
            return None
        transfer = self.transfer(state.cuts, cuts)
        origin = self._origin(transfer, state, found, self.closest(x, cuts).closest)
        elastic = transfer.of(self.elastic_slip(state))
        state = self.transferred(transfer, state, cuts).with_stick(origin)
        # The clearance of round facets follows from the new coordinates.
        rounded = self.faceting(transfer.new, origin)
        state = replace(
            state,
            facet=origin.facet,
            position=origin.xi.T,
            clearance=state.clearance + rounded,
            rounded=rounded,
        )
        return self.with_elastic_slip(state, elastic), transfer

    def _origin(
        self,
        transfer: Transfer,
        state: ContactState,
        found: ContactState,
        closest: MaterialPoints,
    ) -> MaterialPoints:
        """Return where new closest points were when a state was accepted.

        They have slid since as far as the points of the found state.
        """
        slid = transfer.of(self._distance(state.cuts, found.closest, state.closest))
        # A point comes from its own facet where the one beside it has stayed on its facet.
        stayed = (found.facet == state.facet)[transfer.at]
        before = state.closest.take(transfer.at)
        near = MaterialPoints(
            np.where(stayed, closest.facet, before.facet),
            np.where(stayed[:, None], closest.xi, before.xi),
        )
        # Tangents of these facets: those beyond a corner may be at right angles to them.
        tangents = self._tangents(transfer.new, near)
        return offset_back(self.master, self.master.nodes, tangents, closest, slid.T, near)

    def transfer(self, cuts: ndarray, others: ndarray) -> Transfer:
        """Return the transfer from points between cuts to points between others."""
        return Transfer(self.slave, self.points(cuts), self.points(others))

    def transferred(self, transfer: Transfer, state: ContactState, cuts: ndarray) -> ContactState:
        """Return the fields of a state at points between other cuts, without points of the master.

        Fields that are not smooth come from the nearest old point. The clearance lacks the part of
        round facets.
        """
        at = transfer.at
        clearance = transfer.of(state.clearance - state.rounded)
        return replace(
            state,
            gap=state.gap[at],
            status=state.status[at],
            internal=state.internal[:, at],
            slip=transfer.of(state.slip),
            closing_slip=transfer.of(state.closing_slip),
            traction=transfer.of(state.traction),
            clearance=clearance + self.clearance_between(state.cuts, cuts, at),
            cuts=cuts,
        )

    def clearance_between(self, cuts: ndarray, others: ndarray, at: ndarray) -> ndarray:
        """Return by how much clearances at points of other cuts differ from those numbered `at`.

        The clearance of an adjusted point is its gap in the mesh, of others round-off. In the plane
        it is interpolated.
        """
        points = self.points(others)
        if self.slave.dim == 2 or self.adjusted <= TOUCHING:
            return np.zeros(len(points.size))
        before = self.in_mesh(cuts).gap[at]
        after = self.in_mesh(others).gap
        near = self.adjusted * points.size
        adjusted = (np.abs(before) <= near) & (np.abs(after) <= near)
        return np.where(adjusted, after, 0.0) - np.where(adjusted, before, 0.0)
