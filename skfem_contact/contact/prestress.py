"""Contact in a held geometry: tractions in equilibrium with given forces, and contact linearised
about a state.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from copy import copy
from dataclasses import replace

import numpy as np
from numpy import ndarray
from scipy.sparse import coo_matrix, csr_matrix, diags_array, hstack
from scipy.sparse.linalg import lsqr
from typing_extensions import override

from ..errors import Remark
from ..forms.base import Form, Outputs, Response
from ..forms.roles import Couples, Reducible, Regularised
from ..surfaces.material_points import MaterialPoints, offset_back
from .base import ContactBase
from .interface import ContactState
from .laws import LawUpdate, Status, resisting

#: Components of a stress by their indices in the tensor.
_TENSOR = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2]])
#: Distance of the pressure's resultant from the last point, over that of the next one, in a joint
#: that turns about it; and the distance of the next one, as a share of the facet, that is remarked
#: on: further cuts leave less than .04.
_PIVOT, _APART = 0.3, 0.1
_ACCURACY = 1e-14
_MOST = 10_000


def prestressed(
    operators: Mapping[str, TractionOperator],
    force: ndarray,
    where: ndarray | None = None,
    guess: Mapping[str, ndarray] | None = None,
) -> dict[str, ContactState]:
    """Return states in which pairs exert given nodal forces together.

    Of all tractions with these nodal forces those of least norm are taken, or those nearest to a
    guess. Gap and slip then begin where the penalty and the multipliers give these tractions:
    nothing moves. Tractions that the law does not admit, such as tension, are left out.

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
    where = np.arange(len(force)) if where is None else where
    near = {
        name: np.zeros(a.forces.shape[1]) if guess is None else a.of_stress(guess[name])
        for name, a in operators.items()
    }
    forces = {name: a.forces_on(len(force)) for name, a in operators.items()}
    left = force - sum(part @ near[name] for name, part in forces.items())
    operator = csr_matrix(
        hstack([forces[name] @ diags_array(a.scale) for name, a in operators.items()])
    )[where]
    found = lsqr(operator, left[where], atol=_ACCURACY, btol=_ACCURACY, conlim=0.0, iter_lim=_MOST)[
        0
    ]
    ends = np.cumsum([0] + [len(a.scale) for a in operators.values()])
    return {
        name: a.state_with(near[name] + a.scale * found[ends[k] : ends[k + 1]])
        for k, (name, a) in enumerate(operators.items())
    }


class TractionOperator:
    """Linear map `forces` from the tractions at all points of a pair, the normal ones first, to
    nodal forces.

    Tractions of `scale` have a square with the integral one; `coordinates` are those of the points
    in the mesh.
    """

    def __init__(self, pair: ContactBase, x: ndarray, state: ContactState) -> None:
        self._pair, self._x, self._state = pair, x, state
        self._points = points = pair.points(state)
        found = pair.interface.closest(x, state.cuts, state.facet)
        self._at = at = np.flatnonzero(found.found & (state.status != Status.OPEN))
        self._frame = frame = pair.interface.variations(x, state, found, at)
        self.coordinates = points.positions(pair.slave.nodes)
        n, dim, weight = len(points.weight), pair.slave.dim, pair.share * points.weight[at]
        values = weight[:, None, None] * frame.expanded(frame.work)
        rows = np.broadcast_to(frame.dofs[:, None], values.shape)
        columns = np.broadcast_to((at[:, None] + n * np.arange(dim))[:, :, None], values.shape)
        moving = rows >= 0
        self.forces = coo_matrix(
            (values[moving], (rows[moving], columns[moving])), shape=(pair.size, dim * n)
        ).tocsr()
        self.scale = np.tile(1.0 / np.sqrt(points.weight), dim)

    def forces_on(self, n: int) -> csr_matrix:
        """Return the map to forces on n dofs, of which the pair knows the first ones."""
        forces = self.forces.copy()
        forces.resize((n, forces.shape[1]))  # type: ignore[call-arg, arg-type, unused-ignore]
        return forces

    def of_stress(self, stress: ndarray) -> ndarray:
        """Return the tractions of stresses at the points, shape (dim n_points,)."""
        frame, dim = self._frame, self._pair.slave.dim
        vector = np.einsum("ijn,nj->ni", stress[:, self._at][_TENSOR[:dim, :dim]], frame.normal)
        tractions = np.zeros((dim, len(self._points.weight)))
        tractions[0, self._at] = np.einsum("nc,nc->n", vector, frame.normal)
        tractions[1:, self._at] = np.einsum("nic,nc->in", frame.tangents, vector)
        return tractions.ravel()

    def state_with(self, tractions: ndarray) -> ContactState:
        """Return the state with these tractions, shape (dim n_points,)."""
        pair, state, points = self._pair, self._state, self._points
        if pair.dual:
            raise ValueError(
                f"contact of '{pair.slave.name}' has DualMultipliers, and cannot start with given "
                "tractions: take the penalty method or AugmentedLagrangian()"
            )
        tractions = tractions.reshape(pair.slave.dim, -1)
        if pair.enforcement is not None:
            at_points = np.repeat(np.arange(len(points.weight)), points.nodes.shape[1])
            shapes = csr_matrix((points.values.ravel(), (at_points, points.nodes.ravel())))
            nodal = np.stack(
                [lsqr(shapes, part, atol=_ACCURACY, btol=_ACCURACY)[0] for part in tractions]
            )
            state = replace(state, multiplier=nodal)
            tractions = tractions - nodal @ shapes.T
        by_gap, by_slip = pair.penalties(state)
        clearance = np.where(
            state.status != Status.OPEN, state.gap - tractions[0] / by_gap, state.clearance
        )
        at, stick = self._at, MaterialPoints(state.stick_facet.copy(), state.stick_point.T.copy())
        nodes = pair.interface.positions(self._x)[1]
        stick.facet[at], stick.xi[at] = offset_back(
            pair.master,
            nodes,
            self._frame.tangents,
            self._frame.closest,
            tractions[1:, at].T / by_slip,
        )
        return pair.assemble(self._x, replace(state, clearance=clearance).with_stick(stick)).state


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
        self.pair, self.size, self.strengths = pair, pair.size, pair.strengths
        self.joins, self.changing = pair.joins, pair.changing
        self._points = points = pair.points(state)
        found = pair.interface.closest(x, state.cuts, state.facet)
        self._at = at = np.flatnonzero(found.found)
        near, frame = points.take(at), pair.interface.variations(x, state, found, at)
        self._dofs, self._work = frame.dofs, frame.expanded(frame.work)
        penalties = pair.penalties(state)
        closing = state.clearance - points.at(state.multiplier[0]) / penalties[0]
        self._gap, self._closing = (found.gap - closing)[at], closing[at]
        self._elastic = frame.slip.T + near.at(state.multiplier[1:].T).T / penalties[1]
        self._first = x.take(frame.dofs.clip(0))

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
        pair, found = self.pair, self.pair.interface.closest(x, state.cuts)
        on = np.flatnonzero((state.status != Status.OPEN) & found.found)
        closest, clearance = found.closest, state.clearance.copy()
        frame = pair.interface.variations(x, state.with_stick(closest), found, on)
        clearance[on] += found.gap[on] - state.gap[on]
        multiplied = self._points.at(state.multiplier[1:].T).T / pair.penalties(state)[1]
        stick = MaterialPoints(closest.facet.copy(), closest.xi.copy())
        slip = (state.position - state.stick_point - multiplied)[:, on]
        stick.facet[on], stick.xi[on] = offset_back(
            pair.master, pair.interface.positions(x)[1], frame.tangents, frame.closest, slip.T
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
        pair, near = self.pair, self._points.take(self._at)
        change = np.where(self._dofs < 0, 0.0, x.take(self._dofs.clip(0)) - self._first)
        gap, *motions = np.einsum("nim,nm->in", self._work, change)
        gap, moved = self._gap + gap, np.array(motions)
        internal, closed = pair.effective(state).internal, state.status != int(Status.OPEN)
        on = np.flatnonzero(
            pair.law.take(near).reaches(gap, internal[:, self._at], closed[self._at])
        )
        at, dofs, work = self._at[on], self._dofs[on], self._work[on]
        jump = np.stack((gap[on], *(moved[:, on] - state.stick_point[:, at])))
        update = pair.law.take(near.take(on)).update(jump, internal[:, at], pair.penalties(state))
        weight = pair.share * self._points.weight[at]

        def candidate() -> ContactState:
            motion, origin, gaps, new = (
                a.copy() for a in (state.position, state.stick_point, state.gap, internal)
            )
            motion[:, self._at], gaps[self._at] = moved, gap + self._closing
            origin[:, self._at] = moved
            origin[:, at] -= update.elastic_slip
            traction, status = np.zeros_like(state.traction), np.full(len(gaps), int(Status.OPEN))
            traction[:, at], status[at], new[:, at] = (
                update.traction,
                update.status,
                update.internal,
            )
            slip = np.where(status == Status.OPEN, 0.0, state.slip + motion - state.position)
            return replace(
                state,
                gap=gaps,
                slip=slip,
                traction=traction,
                status=status,
                internal=new,
                position=motion,
                stick_point=origin,
            )

        def stiffness(update: LawUpdate) -> csr_matrix:
            K = work.transpose(0, 2, 1) @ (update.tangent.transpose(2, 0, 1) @ work)
            return pair.gathering.matrix(dofs, K * weight[:, None, None])

        force = weight[:, None] * np.einsum("in,nim->nm", update.traction, work)
        return Response(
            pair.gathering.force(dofs, force),
            candidate,
            lambda: stiffness(update),
            lambda: stiffness(resisting(update, jump[1:]) if self._resists else update),
        )

    @override
    def outputs(self, x: ndarray, state: ContactState) -> Outputs:
        return Outputs(remarks=lambda: self._remarks(state))

    def _remarks(self, state: ContactState) -> Iterator[Remark]:
        """Yield a remark where the last point of a joint's quadrature, inside of its end, has all
        of the pressure.
        """
        force = self._points.weight * np.abs(state.traction[0])
        along = self._points.facet + 0.5 * (1.0 + self._points.xi[:, 0])
        positions = np.unique(along[self._at])
        if (
            self.pair.slave.dim > 2
            or self._points.nodes.shape[1] == 1
            or not force.any()
            or len(positions) < 2
        ):
            return
        apart = np.diff(positions)[[0, -1]]
        from_ends = np.abs(force @ along / force.sum() - positions[[0, -1]]) / apart
        if (from_ends[apart > _APART] < _PIVOT).any():
            yield Remark(
                "pivot",
                1.0 - from_ends.min(),
                f"'{self.pair.slave.name}' turns about its last point of "
                'quadrature, inside of its end, and the limit is too low: quadrature="nodal" has '
                "points at "
                'the ends, "segments" close to them',
            )
