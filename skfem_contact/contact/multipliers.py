r"""Lagrange multipliers inside Newton's method: tractions of the slave's nodes are dofs beside the
displacements.

The traction :math:`t = \sum_j \psi_j t_j` has dual shape functions,
:math:`\int \psi_j N_k = \delta_{jk} \int N_k` over the part of each facet that faces the master,
which may be cut (B. I. Wohlmuth 2000).  On facets of second order
:math:`N_k` are hats, linear between neighbouring nodes, whose integrals are all positive.  Gap and
slip of a node are means, :math:`J_j = \int \psi_j (g, s) / W_j` with :math:`W_j = \int \psi_j`, and
the law is evaluated at the nodes:

.. math:: t_j = t(J_j + \lambda_j / \epsilon), \qquad \frac{W_j}{\epsilon} (t_j - \lambda_j) = 0 .

So closed nodes have :math:`J_j = 0`, open ones no traction, and sliding ones lie on the friction
cone, whatever the parameter :math:`\epsilon` is (P. Alart, A. Curnier 1991).  Newton's method for
these equations is a primal-dual active set strategy (S. Hueeber, B. I. Wohlmuth 2005).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix, diags_array, vstack
from scipy.spatial import cKDTree

from ..forms.base import Response
from ..surfaces.shape import Shape
from ..surfaces.surface import Surface
from ..surfaces.vectors import frame
from .interface import ROUND_OFF, ContactState
from .kinematics import Kinematics, geometric_tangent, slip_gradient
from .laws import LawUpdate, Status
from .quadrature import SlavePoints
from .search import Projection

#: Share of the largest area below which a node faces nothing, and of a facet's largest product of
#: hats that is round-off.
_NOTHING, _SINGULAR = 1e-9, 1e-10
#: Compliance of the multipliers in the tangent, over that of the penalty: supports may hold both
#: sides of a node, whose multiplier then has no effect.
_HELD = 1e-10
#: Square of the cosine between a direction of slip and supports that hold it.
_ALONG = 0.99


def hats(shape: Shape, xi: ndarray) -> ndarray:
    """Return the functions of the nodes to which the duals belong, shape (n, k), at local
    coordinates (n, dim - 1).

    Lines have their shape functions.  On facets in space functions are linear between neighbouring
    nodes: the integral of a shape function of second order is zero at the corner of a triangle.
    """
    if shape.dim == 1:
        return shape.at(np.zeros(len(xi), int), xi, 0)[0]
    spacing = np.ptp(shape.corners[:, 0]) / shape.exponents.max()
    away = (xi[:, None] - shape.nodes) / spacing
    if shape.triangular:
        return np.asarray(
            np.maximum(1.0 - np.abs(np.dstack((away, away.sum(axis=2)))).max(axis=2), 0.0)
        )
    return np.asarray(np.maximum(1.0 - np.abs(away), 0.0).prod(axis=2))


def duals(points: SlavePoints, values: ndarray, n_facets: int) -> ndarray:
    """Return the dual shape functions, shape (n, k), of functions with such values at points, facet
    by facet.
    """
    if values.shape[1] == 1:
        return values
    weighted = points.weight[:, None] * values
    products = np.zeros((n_facets, values.shape[1], values.shape[1]))
    np.add.at(products, points.facet, weighted[:, :, None] * values[:, None])
    factors = products.sum(axis=2)[:, :, None] * np.linalg.pinv(
        products, rcond=_SINGULAR, hermitian=True
    )
    return np.asarray(np.einsum("njk,nk->nj", factors[points.facet], values))


@dataclass(frozen=True, eq=False)
class Nodes:
    """Hats of a slave at points, the node that each point is nearest to, and the point whose memory
    is each node's.
    """

    values: ndarray
    owner: ndarray
    point: ndarray

    @classmethod
    def of(cls, slave: Surface, points: SlavePoints) -> Nodes:
        """Return the nodes of a slave at points."""
        single = points.nodes.shape[1] == 1
        values = np.ones(points.nodes.shape) if single else hats(slave.shape, points.xi)
        order = np.argsort(values.ravel(), kind="stable")
        point = np.full(len(slave.nodes), -1)
        point[points.nodes.ravel()[order]] = (
            order // values.shape[1]
        )  # the last one, with the largest value, remains
        return cls(values, points.nodes[np.arange(len(values)), values.argmax(axis=1)], point)


@dataclass(frozen=True, eq=False)
class _Closed:
    """Nodes that may have tractions, with the points near them and the law's update.

    Attributes
    ----------
    on, points : ndarray
        Numbers of the nodes, and of the points at which they act.
    weights : ndarray, shape (n_points, k)
        Dual shape functions of the points' nodes times area.
    sums : csr_matrix, shape (n_on, n_points)
        The same as a matrix.
    area : ndarray, shape (n_nodes,)
        Integrals of the dual shape functions of all nodes.
    """

    on: ndarray
    points: ndarray
    weights: ndarray
    sums: csr_matrix
    area: ndarray
    kinematics: Kinematics
    update: LawUpdate

    def everywhere(self, values: ndarray) -> ndarray:
        """Return values of the nodes `on` at all nodes, zero elsewhere: shape (..., n_nodes)."""
        nodal = np.zeros((*values.shape[:-1], len(self.area)), values.dtype)
        nodal[..., self.on] = values
        return nodal


def respond(pair: Any, x: ndarray, accepted: ContactState) -> Response:
    """Return the response of a pair whose multipliers are dofs of the analysis."""
    slave, nodes = pair.interface.positions(x)
    points, exact, state = (
        pair.points(accepted),
        ROUND_OFF * float(np.abs(nodes).max()),
        pair.effective(accepted),
    )
    penalties = np.array(pair.penalties(state))[[0, *[1] * (pair.slave.dim - 1)]]
    depth = (
        np.full(len(points.weight), np.inf)
        if pair.law.reaches_far
        else pair.interface.depth(points)
    )
    found, projected = pair.interface.near(slave, nodes, state, state.clearance + depth, depth)
    multipliers = x[pair.multipliers]
    closed = _closed(pair, x, state, found, multipliers / penalties[:, None], exact)

    traction, kinematics, near = (
        closed.everywhere(closed.update.traction),
        closed.kinematics,
        closed.points,
    )
    acting = np.einsum("nk,nki->ni", closed.weights, traction.T[points.nodes[near]])
    work, share = kinematics.expanded(kinematics.work), closed.area / penalties[:, None]
    force = pair.gathering.force(kinematics.dofs, np.einsum("ni,nim->nm", acting, work))
    lost = pair.gathering.force(
        kinematics.dofs, penalties[0] * exact * points.weight[near, None] * np.abs(work[:, 0])
    )
    force[pair.multipliers], measure = share * (traction - multipliers), force.copy()
    measure[pair.multipliers] = share * (np.abs(traction) + np.abs(multipliers))
    lost[pair.multipliers] = closed.area * exact

    def candidate() -> ContactState:
        return _after(pair, state, projected(), closed)

    def stiffness(limit: float = np.inf) -> csr_matrix:
        largest = limit * points.weight[near, None]
        return _stiffness(pair, closed, np.clip(acting, -largest, largest), share, penalties)

    status = closed.everywhere(closed.update.status)
    return Response(
        force,
        candidate,
        stiffness,
        lambda: stiffness(pair.largest_traction),
        lost,
        status.tobytes(),
        measure,
    )


def _closed(
    pair: Any, x: ndarray, state: ContactState, found: Projection, multiplied: ndarray, exact: float
) -> _Closed:
    """Evaluate the law at the nodes that it may close, at means of gap and slip where they face the
    master.
    """
    points, around, n = pair.points(state), pair.nodes_at(state), multiplied.shape[1]
    at = np.flatnonzero(found.found)
    facing, weights, area, opened = integrals(pair, state, at, found.gap)
    some = np.flatnonzero(area > _NOTHING * area.max(initial=0.0))

    def nearly(values: ndarray) -> ndarray:
        return np.where(np.abs(values) <= exact, 0.0, values)

    gap = nearly(nearly(opened[some] / area[some]) + multiplied[0, some])
    reached = _law_at(pair, points, around, some).reaches(
        gap, state.internal[:, around.point[some]], state.closed[some]
    )
    on, gap = some[reached], gap[reached]
    number = np.full(n, -1)
    number[on] = np.arange(len(on))
    numbers = number[facing.nodes]
    act = np.flatnonzero((numbers >= 0).any(axis=1))
    weights, numbers = weights[act], numbers[act]
    kinematics = pair.interface.variations(x, state, found, at[act])
    row, column = np.nonzero(numbers >= 0)
    sums = csr_matrix(
        (weights[row, column], (numbers[row, column], row)), shape=(len(on), len(act))
    )
    slip = nearly((sums @ kinematics.slip).T / area[on]) + multiplied[1:, on]
    update = _law_at(pair, points, around, on).update(
        np.vstack((gap[None], slip)), state.internal[:, around.point[on]], pair.penalties(state)
    )
    area[area <= _NOTHING * area.max(initial=0.0)] = pair.slave.area.mean()
    return _Closed(on, at[act], weights, sums, area, kinematics, update)


def integrals(
    pair: Any, state: ContactState, at: ndarray, gap: ndarray
) -> tuple[SlavePoints, ndarray, ndarray, ndarray]:
    """Return the points `at` that face the master, their weights, and nodal integrals of the duals
    and of the gap.
    """
    around, facing = pair.nodes_at(state), pair.points(state).take(at)
    weights = (
        pair.share
        * facing.weight[:, None]
        * duals(facing, around.values[at], len(pair.slave.facets))
    )
    area, opened = (
        np.bincount(facing.nodes.ravel(), (weights * part[:, None]).ravel(), len(pair.slave.nodes))
        for part in (np.ones(len(at)), (gap - state.clearance)[at])
    )
    return facing, weights, area, opened


def mean_gaps(pair: Any, state: ContactState, found: ndarray, gap: ndarray) -> ndarray:
    """Return the nodes' means of the gap at the points `found`, a mask; inf where they face
    nothing.
    """
    *_, area, opened = integrals(pair, state, np.flatnonzero(found), gap)
    some = area > _NOTHING * area.max(initial=0.0)
    return np.where(some, opened / np.where(some, area, 1.0), np.inf)


def nodal_forces(pair: Any, x: ndarray, state: ContactState) -> list[ndarray]:
    """Return the internal forces of pressure and of friction in a state, shape (N,) each, by the
    dual functions.
    """
    found = pair.interface.closest(x, state.cuts, state.facet)
    at = np.flatnonzero(found.found)
    facing, weights, *_ = integrals(pair, state, at, found.gap)
    kinematics = pair.interface.variations(x, state, found, at)
    acting = np.einsum("nk,ink->ni", weights, state.multiplier[:, facing.nodes])
    work = kinematics.expanded(kinematics.work)
    return [
        pair.gathering.force(
            kinematics.dofs, np.einsum("ni,nim->nm", acting[:, part], work[:, part])
        )
        for part in (slice(1), slice(1, None))
    ]


def idle(pair: Any, fixed: ndarray) -> ndarray:
    """Return the tangential multipliers at nodes that supports hold along the surface, with the
    master beside them.

    Nothing slips across a plane of symmetry.  A multiplier there would act on the master's inside
    alone, and its equations would nearly be those of its neighbours.
    """
    slave, master = pair.slave, pair.facets
    directions = frame(slave.normals, np.broadcast_to(slave.directions[0], slave.nodes.shape))
    both, held = np.isin(slave.dofs, fixed), np.isin(master.dofs, fixed)
    for i in range(slave.dim):
        near = (
            cKDTree(master.nodes[held[:, i]]).query(slave.nodes)[0] if held[:, i].any() else np.inf
        )
        both[:, i] &= near < max(slave.spacing, master.spacing)
    along = (directions**2 * both[:, None]).sum(axis=2) > _ALONG
    return np.asarray(pair.multipliers[1:][along.T])


def _law_at(pair: Any, points: SlavePoints, around: Nodes, numbers: ndarray) -> Any:
    """Return the law at nodes."""
    nodes, ones = numbers[:, None], np.ones((len(numbers), 1))
    return pair.law.take(replace(points.take(around.point[numbers]), nodes=nodes, values=ones))


def _after(pair: Any, state: ContactState, found: Projection, closed: _Closed) -> ContactState:
    """Return the candidate state; all points stick to their closest points: what sticks has not
    moved.
    """
    around, at = pair.nodes_at(state), closed.points
    traction, status = (
        closed.everywhere(closed.update.traction),
        closed.everywhere(closed.update.status),
    )
    nodes, values = pair.points(state).nodes[at], around.values[at]
    share = np.where(status[nodes] != Status.OPEN, values, 0.0)
    nearest = nodes[np.arange(len(at)), share.argmax(axis=1)]
    number = np.full(len(status), -1)
    number[closed.on] = np.arange(len(closed.on))
    own, internal = number[around.owner], state.internal.copy()
    internal[:, own >= 0] = closed.update.internal[:, own[own >= 0]]
    update = LawUpdate(
        np.einsum("nk,nki->in", values, traction.T[nodes]),
        internal[:, at],
        np.zeros(0),
        np.zeros(0),
        np.where(share.any(axis=1), status[nearest], int(Status.OPEN)),
    )
    slip = state.slip + pair.interface.slid(state, found.closest)
    after = state.after(found, at, update, found.closest.take(at), slip)
    return replace(after, internal=internal, multiplier=traction, closed=status != Status.OPEN)


def _stiffness(
    pair: Any, closed: _Closed, acting: ndarray, share: ndarray, penalties: ndarray
) -> csr_matrix:
    """Return the tangent of the forces and of the conditions at the nodes."""
    n, dim, on, kinematics = pair.size, len(share), closed.on, closed.kinematics
    gradient = np.concatenate((kinematics.work[:, :1], slip_gradient(kinematics)), axis=1)
    forces, jumps = (
        _rows(closed.sums, kinematics.dofs, kinematics.expanded(part), n)
        for part in (kinematics.work, gradient)
    )
    own, everywhere = _picks(pair.multipliers[:, on], n), _picks(pair.multipliers, n)
    change = _blocks(closed.update.tangent) @ (
        diags_array(np.tile(1.0 / closed.area[on], dim)) @ jumps
        + diags_array(np.repeat(1.0 / penalties, len(on))) @ own
    )
    K = (forces + diags_array(share[:, on].ravel()) @ own).T @ change - everywhere.T @ diags_array(
        (1.0 + _HELD) * share.ravel()
    ) @ everywhere
    if pair.tangent == "exact":
        turned = kinematics.expanded(geometric_tangent(kinematics, acting.T)).transpose(0, 2, 1)
        K = K + pair.gathering.matrix(
            kinematics.dofs, kinematics.expanded(turned).transpose(0, 2, 1)
        )
    return csr_matrix(K)


def _blocks(tangent: ndarray) -> csr_matrix:
    """Return derivatives, shape (dim, dim, n), as a matrix of dim n rows."""
    dim, _, n = tangent.shape
    row, column = (
        np.broadcast_to(number * n, (dim, dim))[:, :, None] + np.arange(n)
        for number in (np.arange(dim)[:, None], np.arange(dim))
    )
    return csr_matrix((tangent.ravel(), (row.ravel(), column.ravel())), shape=(dim * n, dim * n))


def _picks(dofs: ndarray, n: int) -> csr_matrix:
    return csr_matrix(
        (np.ones(dofs.size), dofs.ravel(), np.arange(dofs.size + 1)), shape=(dofs.size, n)
    )


def _rows(sums: csr_matrix, dofs: ndarray, variations: ndarray, n: int) -> csr_matrix:
    """Return weighted sums over points of variations, shape (n_points, dim, m), by dofs: component
    by component.
    """
    count, m = dofs.shape
    columns, ends = (
        np.where(dofs < 0, n, dofs).ravel(),
        np.arange(count + 1) * m,
    )  # column n: what does not move
    return vstack(
        [
            sums @ csr_matrix((variations[:, i].ravel(), columns, ends), shape=(count, n + 1))
            for i in range(variations.shape[1])
        ]
    ).tocsr()[:, :n]
