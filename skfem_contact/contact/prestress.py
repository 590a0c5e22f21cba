"""Contact in a fixed geometry: tractions in equilibrium with forces, and linearised contact."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from copy import copy
from dataclasses import replace

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix, diags_array, hstack
from scipy.sparse.linalg import lsqr, norm
from typing_extensions import override

from ..errors import Remark
from ..forms.base import Form, Outputs, Response
from ..forms.roles import Couples, Reducible, Regularised
from ..surfaces.material_points import MaterialPoints, offset_back
from .base import ContactBase
from .diagnosis import on_torque
from .interface import ContactState
from .laws import LawUpdate, Status, resisting
from .reactions import nodal_forces, reactions

#: Components of a stress by their indices in the tensor.
_TENSOR = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2]])
#: Distance of the pressure's resultant from the last point, over that of the next one, in a joint
#: that turns about it; and the distance of the next one, as a share of the facet, that is remarked
#: on: further cuts leave less than .04.
_PIVOT = 0.3
_APART = 0.1
_ACCURACY = 1e-14
_MOST = 10_000
#: Damping of the least change of tractions, over the size of the operator. Tractions that hardly
#: exert a force would balance round-off, or facets that do not match, by a thousand times the
#: pressure: round a pipe of 32 facets in 32 or 40, a K0 state is .42 and .24 of the load out of
#: balance without damping, and 2e-10 and 1e-4 with 1e-3 or 1e-2.
_DAMPED = 1e-3


def prestressed(
    operators: Mapping[str, TractionOperator],
    force: ndarray,
    where: ndarray | None = None,
    guess: Mapping[str, ndarray] | None = None,
) -> dict[str, ContactState]:
    """Return states in which pairs exert given nodal forces together.

    Of all tractions with these nodal forces the least ones are taken, or the nearest ones to a
    guess; forces that only large tractions balance remain. Gap and slip then begin where the
    penalty and the multipliers give these tractions: nothing moves. Tractions that the law does
    not admit, such as tension, are left out.

    Parameters
    ----------
    operators
        Operator of each pair by name, see :meth:`ContactPair.tractions_at`.
    force : ndarray, shape (N,)
        Internal forces of the pairs together.
    where : ndarray, optional
        Dofs at which the forces count; by default all.
    guess : dict of ndarray, shape (4 or 6, n_points)
        Stresses (xx, yy, zz, xy, in space yz, zx too) at the points, from which the tractions
        should differ little.
    """
    if where is None:
        where = np.arange(len(force))

    # Begin with the guess, and find the least change of tractions that exerts the missing forces
    given = np.zeros(len(force))
    near = []
    blocks = []
    for name, operator in operators.items():
        if guess is None:
            tractions = np.zeros(operator.forces.shape[1])
        else:
            tractions = operator.of_stress(guess[name])
        forces = operator.forces_on(len(force))
        given = given + forces @ tractions
        near.append(tractions)
        blocks.append(forces @ diags_array(operator.scale))
    matrix = csr_matrix(hstack(blocks))[where]
    # Given stresses may not match the facets; forces of a replaced pair have tractions
    damping = 0.0 if guess is None else _DAMPED
    change = _least_change(matrix, (force - given)[where], damping)

    # Split the change by pairs
    states = {}
    start = 0
    for (name, operator), tractions in zip(operators.items(), near, strict=True):
        end = start + len(operator.scale)
        states[name] = operator.state_with(tractions + operator.scale * change[start:end])
        start = end
    return states


def _least_change(matrix: csr_matrix, force: ndarray, damping: float) -> ndarray:
    r"""Return the damped least squares of A x = b.

    .. math:: |b - A x|^2 + \lambda^2 |x|^2 \to \min

    leaves parts of b whose singular values are far below :math:`\lambda`, the damping times the
    size of A.
    """
    if matrix.nnz == 0:
        return np.zeros(matrix.shape[1])
    size = np.sqrt(norm(matrix, 1) * norm(matrix, np.inf))
    x, *_ = lsqr(
        matrix,
        force,
        damp=damping * size,
        atol=_ACCURACY,
        btol=_ACCURACY,
        conlim=0.0,
        iter_lim=_MOST,
    )
    return np.asarray(x)


class TractionOperator:
    """Linear map `forces` from tractions at all points of a pair, normal ones first, to forces.

    Attributes
    ----------
    forces : csr_matrix, shape (size, dim n_points)
        Nodal forces of tractions.
    scale : ndarray, shape (dim n_points,)
        Tractions whose square has the integral one.
    coordinates : ndarray, shape (n_points, dim)
        Coordinates of the points in the mesh.
    """

    def __init__(self, pair: ContactBase, x: ndarray, state: ContactState) -> None:
        # Closed points with their frames
        points = pair.points(state)
        found = pair.interface.closest(x, state.cuts, state.facet)
        at = np.flatnonzero(found.found & (state.status != Status.OPEN))
        frame = pair.interface.variations(x, state, found, at)
        self._pair = pair
        self._x = x
        self._state = state
        self._points = points
        self._at = at
        self._frame = frame
        self.coordinates = points.positions(pair.slave.nodes)

        # Forces of a traction at each point
        dim = pair.slave.dim
        self.forces = nodal_forces(pair, points, at, frame)
        self.scale = np.tile(1.0 / np.sqrt(points.weight), dim)

    def forces_on(self, n: int) -> csr_matrix:
        """Return the map to forces on n dofs, of which the pair knows the first ones."""
        forces = self.forces.copy()
        forces.resize((n, forces.shape[1]))  # type: ignore[call-arg, arg-type, unused-ignore]
        return forces

    def reactions(self) -> csr_matrix | None:
        """Return all nodal forces that contact can exert, see :func:`reactions`."""
        return reactions(self._pair, self._x, self._state)

    def of_stress(self, stress: ndarray) -> ndarray:
        """Return the tractions of stresses at the points, shape (dim n_points,)."""
        dim = self._pair.slave.dim
        normal = self._frame.normal
        tensor = stress[:, self._at][_TENSOR[:dim, :dim]]  # (dim, dim, n_closed)
        vector = np.einsum("ijn,nj->ni", tensor, normal)
        tractions = np.zeros((dim, len(self._points.weight)))
        tractions[0, self._at] = np.einsum("nc,nc->n", vector, normal)
        tractions[1:, self._at] = np.einsum("nic,nc->in", self._frame.tangents, vector)
        return tractions.ravel()

    def state_with(self, tractions: ndarray) -> ContactState:
        """Return the state with these tractions, shape (dim n_points,)."""
        pair = self._pair
        state, tractions = pair.enforcement.start_with(
            pair, self._state, tractions.reshape(pair.slave.dim, -1)
        )

        # Let gap and slip begin where the penalties give these tractions
        by_gap, by_slip = pair.penalties(state)
        closed = state.status != Status.OPEN
        clearance = np.where(closed, state.gap - tractions[0] / by_gap, state.clearance)
        _, nodes = pair.interface.positions(self._x)
        at = self._at
        slip = tractions[1:, at].T / by_slip
        stick = MaterialPoints(state.stick_facet.copy(), state.stick_point.T.copy())
        stick.facet[at], stick.xi[at] = offset_back(
            pair.master, nodes, self._frame.tangents, self._frame.closest, slip
        )
        start = replace(state, clearance=clearance).with_stick(stick)
        return pair.assemble(self._x, start).state


class LinearisedContact(Form, Couples, Reducible, Regularised):
    """Contact pair whose geometry is held as it is at displacements x : ndarray, shape (N,).

    Solids of small strains have one geometry, contact of finite sliding follows the displaced
    bodies.  A search for a collapse goes to any displacement: if contact followed, the factor would
    depend on how far the bodies have moved, that is on their stiffness.  So closest points, normals
    and tributary lengths are kept, and gap and slip

        g = g_0 + G . (u - u_0),    s = s_0 + T . (u - u_0)

    grow with the variations G and T at x, see :mod:`~skfem_contact.contact.kinematics`.  In the
    states of this form `position` is the tangential motion of the points since x, and `stick_point`
    the motion without elastic slip.
    """

    unilateral = True
    _resists = False

    def __init__(self, pair: ContactBase, x: ndarray, state: ContactState) -> None:
        self.pair = pair
        self.size = pair.size
        self.strengths = pair.strengths
        self.joins = pair.joins
        self.changing = pair.changing

        # Variations of the points that face the master
        points = pair.points(state)
        found = pair.interface.closest(x, state.cuts, state.facet)
        at = np.flatnonzero(found.found)
        frame = pair.interface.variations(x, state, found, at)
        self._points = points
        self._at = at
        self._near = points.take(at)
        self._dofs = frame.dofs
        self._work = frame.expanded(frame.work)
        self._normal = frame.normal
        self._first = x.take(frame.dofs.clip(0))

        # Gap and elastic slip, to which multipliers contribute
        eps_N, eps_T = pair.penalties(state)
        closing = state.clearance - points.at(state.multiplier[0]) / eps_N
        self._closing = closing[at]
        self._gap = (found.gap - closing)[at]
        self._elastic = frame.slip.T + self._near.at(state.multiplier[1:].T).T / eps_T

    def __repr__(self) -> str:
        return f"<{self.pair!r}, linearised>"

    @property
    @override
    def symmetric(self) -> bool:  # type: ignore[override]
        return self.pair.symmetric

    @override
    def initial_state(self, x: ndarray | None = None) -> ContactState:
        return self.held(self.pair.initial_state(x))

    def held(self, state: ContactState) -> ContactState:
        """Return a state of the pair at x as a state of this form."""
        origin = np.zeros(state.slip.shape)
        origin[:, self._at] = -self._elastic
        return replace(state, position=np.zeros(state.slip.shape), stick_point=origin)

    @override
    def released(self, x: ndarray, state: ContactState) -> tuple[Form, ContactState]:
        """Return the pair that follows the bodies, and its state with the same tractions."""
        pair = self.pair
        found = pair.interface.closest(x, state.cuts)
        closest = found.closest
        on = np.flatnonzero((state.status != Status.OPEN) & found.found)
        frame = pair.interface.variations(x, state.with_stick(closest), found, on)

        # Keep the penetration
        clearance = state.clearance.copy()
        clearance[on] += found.gap[on] - state.gap[on]

        # Keep the elastic slip
        _, nodes = pair.interface.positions(x)
        multiplied = self._points.at(state.multiplier[1:].T).T / pair.penalties(state)[1]
        slip = (state.position - state.stick_point - multiplied)[:, on]
        stick = MaterialPoints(closest.facet.copy(), closest.xi.copy())
        stick.facet[on], stick.xi[on] = offset_back(
            pair.master, nodes, frame.tangents, frame.closest, slip.T
        )
        state = replace(
            state, facet=closest.facet, position=closest.xi.T, gap=found.gap, clearance=clearance
        )
        return pair, state.with_stick(stick)

    @override
    def reduced(self, factor: float, flow: str, names: Collection[str]) -> LinearisedContact:
        new = copy(self)
        new.pair = self.pair.reduced(factor, flow, names)
        return new

    @override
    def with_resistance(self) -> LinearisedContact:
        new = copy(self)
        new._resists = True
        return new

    @override
    def assemble(self, x: ndarray, state: ContactState) -> Response:
        pair = self.pair
        near = self._near

        # g = g_0 + G . (u - u_0), s = T . (u - u_0)
        moved_dofs = x.take(self._dofs.clip(0)) - self._first
        change = np.where(self._dofs < 0, 0.0, moved_dofs)
        motion = np.einsum("nim,nm->in", self._work, change)
        gap = self._gap + motion[0]
        moved = motion[1:]

        # Update the law at the points that it reaches
        internal = pair.effective(state).internal
        closed = state.status[self._at] != int(Status.OPEN)
        law = pair.law.take(near)
        on = np.flatnonzero(law.reaches(gap, internal[:, self._at], closed))
        at = self._at[on]
        dofs = self._dofs[on]
        work = self._work[on]
        weight = pair.share * self._points.weight[at]
        slip = moved[:, on] - state.stick_point[:, at]
        jump = np.concatenate((gap[None, on], slip))
        law = pair.law.take(near.take(on))
        update = law.update(jump, internal[:, at], pair.penalties(state))

        def candidate() -> ContactState:
            # Move the points, and begin the elastic slip of those that are updated.
            position = state.position.copy()
            position[:, self._at] = moved
            origin = state.stick_point.copy()
            origin[:, self._at] = moved
            origin[:, at] -= update.elastic_slip
            gaps = state.gap.copy()
            gaps[self._at] = gap + self._closing
            # Write tractions, status and memory of these points.
            traction = np.zeros_like(state.traction)
            traction[:, at] = update.traction
            status = np.full(len(gaps), int(Status.OPEN))
            status[at] = update.status
            new_internal = internal.copy()
            new_internal[:, at] = update.internal
            slip = np.where(status == Status.OPEN, 0.0, state.slip + position - state.position)
            return replace(
                state,
                gap=gaps,
                slip=slip,
                traction=traction,
                status=status,
                internal=new_internal,
                position=position,
                stick_point=origin,
            )

        def stiffness(update: LawUpdate) -> csr_matrix:
            tangent = update.tangent.transpose(2, 0, 1)
            K = work.transpose(0, 2, 1) @ (tangent @ work)
            return pair.gathering.matrix(dofs, K * weight[:, None, None])

        def damped() -> csr_matrix:
            return stiffness(resisting(update, jump[1:]) if self._resists else update)

        force = weight[:, None] * np.einsum("in,nim->nm", update.traction, work)
        force = pair.gathering.force(dofs, force)
        return Response(force, candidate, lambda: stiffness(update), damped)

    @override
    def outputs(self, x: ndarray, state: ContactState) -> Outputs:
        return Outputs(remarks=lambda: self._remarks(state))

    def _remarks(self, state: ContactState) -> Iterator[Remark]:
        """Yield remarks on a round fit that hooks, and on a joint that turns about a point."""
        pressed = np.flatnonzero(state.traction[0, self._at])
        on = self._at[pressed]
        normal = self._normal[pressed]
        yield from on_torque(self.pair, state, on, normal, self.pair.slave.nodes)
        yield from self._on_pivot(state)

    def _on_pivot(self, state: ContactState) -> Iterator[Remark]:
        """Yield a remark where a joint's last point, inside of its end, has all of the pressure."""
        # Only points inside of the ends leave a lever.
        points = self._points
        has_points_at_ends = points.nodes.shape[1] == 1
        if self.pair.slave.dim > 2 or has_points_at_ends:
            return
        # Compare the resultant with the outer points, over the distance to the next ones.
        force = points.weight * np.abs(state.traction[0])
        along = points.facet + 0.5 * (1.0 + points.xi[:, 0])
        positions = np.unique(along[self._at])
        if not force.any() or len(positions) < 2:
            return
        apart = np.diff(positions)[[0, -1]]
        from_ends = np.abs(force @ along / force.sum() - positions[[0, -1]]) / apart
        if (from_ends[apart > _APART] < _PIVOT).any():
            yield Remark(
                "pivot",
                1.0 - from_ends.min(),
                f"'{self.pair.slave.name}' turns about its last point of "
                'quadrature, inside of its end, and the limit is too low: quadrature="nodal" has '
                'points at the ends, "segments" close to them',
            )
