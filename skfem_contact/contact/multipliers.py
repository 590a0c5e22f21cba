r"""Lagrange multipliers inside Newton's method: tractions of the slave's nodes are dofs.

The traction :math:`t = \sum_j \psi_j t_j` has dual shape functions,
:math:`\int \psi_j N_k = \delta_{jk} \int N_k` over the part of each facet that faces the master,
which may be cut (B. I. Wohlmuth 2000).  On facets of second order
:math:`N_k` are hats, linear between neighbouring nodes, whose integrals are all positive.  Gap and
slip of a node are means, :math:`J_j = \int \psi_j (g, s) / W_j` with :math:`W_j = \int \psi_j`, and
the law is evaluated at the nodes:

.. math:: t_j = t(J_j + \lambda_j / \epsilon), \qquad \frac{W_j}{\epsilon} (t_j - \lambda_j) = 0 .

Where bodies slide far, points come and go at the rim of the master, and :math:`\psi_j = N_j`. The
dual function of a small part of a facet is steep: its mean is that of a linear function, which is
extrapolated to the node, and nodes at the rim would slip the wrong way. :math:`\psi_j = N_j` as
well where the master is finer than the slave: it would follow the jumps that a sum of dual
functions has at the nodes.

So closed nodes have :math:`J_j = 0`, open ones no traction, and sliding ones lie on the friction
cone, whatever the parameter :math:`\epsilon` is (P. Alart, A. Curnier 1991).  Newton's method for
these equations is a primal-dual active set strategy (S. Hueeber, B. I. Wohlmuth 2005).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix, vstack

from ..arrays import max_abs
from ..forms.base import Response
from ..sparse import float_bincount
from ..surfaces.shape import Shape
from ..surfaces.surface import Surface
from .interface import ROUND_OFF, ContactState
from .kinematics import Kinematics, geometric_tangent, slip_gradient
from .laws import LawUpdate, Status
from .quadrature import SlavePoints
from .search import Projection

#: Share of a step, from the first node that it closes on, after which it closes no more: the
#: approach a^2 / R of a sphere closes gaps up to a^2 / 2R. In the plane this is right for a
#: half-width of ten elements, too.
_LATE = 0.5
#: Power of the gap beside the edge of contact that is in proportion to the distance from it.
_POWER = 2.0 / 3.0
#: Share of the largest area below which a node faces nothing, and of a facet's largest product of
#: hats that is round-off.
_NOTHING, _SINGULAR = 1e-9, 1e-10
#: Size of the master's facets, over that of the slave's, below which they follow the jumps of the
#: duals at the slave's nodes: beside a hole, with 6 facets a quarter on 13, stresses err by 13 %.
_FINER = 0.9
#: Compliance of the multipliers in the tangent, over that of the penalty: supports may hold both
#: sides of a node, whose multiplier then has no effect, and a rigid slave leaves combinations
#: without any. With 1e-10 these err by .4 % of the pressure after two increments of a block under a
#: rigid cap; with 1e-6 by 1e-6, for one more iteration of linear analyses.
_HELD = 1e-6
#: Second moment of a surface, over the largest one, below which it has no extent there.
_FLAT = 1e-6


def hats(shape: Shape, xi: ndarray) -> ndarray:
    """Return the functions N_k of the nodes, shape (n, k), at local coordinates (n, dim - 1).

    They are linear between neighbouring nodes: the integral of a shape function of second order is
    zero at the corner of a triangle, and of a line that ends on the axis of symmetry.
    """
    if shape.dim == 1 and len(shape.nodes) == 2:
        return shape.at(np.zeros(len(xi), int), xi, 0)[0]
    spacing = np.ptp(shape.corners[:, 0]) / shape.exponents.max()
    away = (xi[:, None] - shape.nodes) / spacing  # (n, k, dim)
    if not shape.triangular:
        return np.asarray(np.maximum(1.0 - np.abs(away), 0.0).prod(axis=2))
    with_third = np.dstack((away, away.sum(axis=2)))
    farthest = np.abs(with_third).max(axis=2)
    return np.asarray(np.maximum(1.0 - farthest, 0.0))


def duals(points: SlavePoints, values: ndarray, n_facets: int) -> ndarray:
    """Return dual shape functions psi_j, shape (n, k), of functions N_k with values at points.

    Facet by facet ``psi = A M^-1 N`` with the integrals A of N_j and M of N_j N_k.
    """
    k = values.shape[1]
    if k == 1:
        return values
    weighted = points.weight[:, None] * values
    M = np.zeros((n_facets, k, k))
    np.add.at(M, points.facet, weighted[:, :, None] * values[:, None])
    A = M.sum(axis=2)
    factors = A[:, :, None] * np.linalg.pinv(M, rcond=_SINGULAR, hermitian=True)
    return np.asarray(np.einsum("njk,nk->nj", factors[points.facet], values))


@dataclass(frozen=True, eq=False)
class Nodes:
    """Hats of a slave at points, nearest node of each point, and nearest point of each node.

    A node has the internal variables of its nearest point.
    """

    values: ndarray
    owner: ndarray
    point: ndarray

    @classmethod
    def of(cls, slave: Surface, points: SlavePoints) -> Nodes:
        """Return the nodes of a slave at points."""
        n, k = points.nodes.shape
        if k == 1:
            values = np.ones((n, k))
        else:
            values = hats(slave.shape, points.xi)
        owner = points.nodes[np.arange(n), values.argmax(axis=1)]

        # Of all points of a node the last one remains, which has the largest value
        order = np.argsort(values.ravel(), kind="stable")
        point = np.full(len(slave.nodes), -1)
        point[points.nodes.ravel()[order]] = order // k
        return cls(values, owner, point)


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
    state = pair.effective(accepted)
    points = pair.points(accepted)
    slave, nodes = pair.interface.positions(x)
    round_off = ROUND_OFF * max_abs(nodes)
    eps_N, eps_T = pair.penalties(state)
    eps = np.array([eps_N] + [eps_T] * (pair.slave.dim - 1))

    # Evaluate the law at nodes: t_j = t(J_j + lambda_j / eps)
    depth = pair.depth(points)
    reach = state.clearance + depth
    held = pair.held(state)
    found, projected = pair.interface.near(slave, nodes, state, reach, depth, held)
    if held is not None:
        # Points come under a rim between equilibria alone, see DualMultipliers.after_equilibrium
        found = found._replace(found=found.found & (state.facet >= 0))
    multipliers = x[pair.multipliers]  # (dim, n_nodes)
    still = np.zeros((len(eps) - 1, multipliers.shape[1]), bool)
    if pair.symmetry is not None:
        # Nodes that only supports move have no multiplier along the surface, but the last traction
        along = pair.symmetry.along & ~pair.symmetry.across
        multipliers[1:][along] = state.multiplier[1:][along]
        still = along & ~pair.symmetry.slides(x, round_off)
    closed = _closed(
        pair,
        x,
        state,
        found,
        multipliers / eps[:, None],
        round_off,
        still,
    )
    traction = closed.everywhere(closed.update.traction)

    # Forces of the tractions that psi interpolates, and what round-off leaves of them
    kinematics = closed.kinematics
    near = closed.points
    weight = points.weight[near, None]
    acting = np.einsum("nk,nki->ni", closed.weights, traction.T[points.nodes[near]])
    work = kinematics.expanded(kinematics.work)
    force = pair.gathering.force(kinematics.dofs, np.einsum("ni,nim->nm", acting, work))
    lost = pair.gathering.force(kinematics.dofs, eps_N * round_off * weight * np.abs(work[:, 0]))

    # Equations of the multipliers: W_j / eps (t_j - lambda_j) = 0
    share = closed.area / eps[:, None]
    measure = force.copy()
    force[pair.multipliers] = share * (traction - multipliers)
    measure[pair.multipliers] = share * (np.abs(traction) + np.abs(multipliers))
    lost[pair.multipliers] = closed.area * round_off

    def candidate() -> ContactState:
        return _after(pair, state, projected(), closed)

    def stiffness(limit: float = np.inf) -> csr_matrix:
        largest = limit * weight
        return _stiffness(pair, closed, np.clip(acting, -largest, largest), share, eps)

    return Response(
        force,
        state=candidate,
        stiffness=stiffness,
        damped=lambda: stiffness(pair.largest_traction),
        round_off=lost,
        active=closed.everywhere(closed.update.status).tobytes(),
        measure=measure,
    )


def _closed(
    pair: Any,
    x: ndarray,
    state: ContactState,
    found: Projection,
    multiplied: ndarray,
    round_off: float,
    still: ndarray,
) -> _Closed:
    """Evaluate the law at the nodes that it may close, at means of gap and slip.

    Nodes that are `still` along the surface, (dim - 1, n_nodes), have no friction.
    """
    around = pair.nodes_at(state)

    def without_round_off(values: ndarray) -> ndarray:
        return np.where(np.abs(values) <= round_off, 0.0, values)

    # Mean gap J_j of the nodes that face the master
    at = np.flatnonzero(found.found)
    facing, weights, area, opened = integrals(pair, state, at, found.gap)
    faces = area > _NOTHING * area.max(initial=0.0)
    some = np.flatnonzero(faces)
    gap = without_round_off(opened[some] / area[some])
    gap = without_round_off(gap + multiplied[0, some])

    # Number the nodes that the law reaches, and find the points that act on them
    internal = state.internal[:, around.point[some]]
    reached = _law_at(pair, state, some).reaches(gap, internal, state.closed[some])
    on = some[reached]
    number = np.full(multiplied.shape[1], -1)
    number[on] = np.arange(len(on))
    numbers = number[facing.nodes]
    loaded = (numbers >= 0).any(axis=1)
    near = at[loaded]
    weights = weights[loaded]
    numbers = numbers[loaded]

    # Mean slip of these nodes
    kinematics = pair.interface.variations(x, state, found, near)
    row, column = np.nonzero(numbers >= 0)
    entries = (weights[row, column], (numbers[row, column], row))
    sums = csr_matrix(entries, shape=(len(on), len(near)))
    slip = without_round_off((sums @ kinematics.slip).T / area[on]) + multiplied[1:, on]

    jump = np.vstack((gap[None, reached], slip))
    acts = ~still[:, on]
    jump[1:] = np.where(acts, jump[1:], 0.0)
    update = _law_at(pair, state, on).update(jump, internal[:, reached], pair.penalties(state))
    tangent = update.tangent.copy()
    tangent[1:] = np.where(acts[:, None], tangent[1:], 0.0)
    update = update._replace(tangent=tangent)
    area[~faces] = pair.slave.area.mean()
    return _Closed(
        on,
        near,
        weights,
        sums,
        area,
        kinematics,
        update,
    )


def integrals(
    pair: Any, state: ContactState, at: ndarray, gap: ndarray
) -> tuple[SlavePoints, ndarray, ndarray, ndarray]:
    """Return points `at` facing the master, their weights, and integrals of psi_j and of the gap.

    The integrals of the nodes are ``W_j`` and ``W_j J_j``, shape (n_nodes,) each.
    """
    facing = pair.points(state).take(at)
    psi = pair.nodes_at(state).values[at]
    if not pair.holds_points and not _is_coarser(pair):
        psi = duals(facing, psi, len(pair.slave.facets))
    if pair.symmetry is not None:
        psi = _spread(psi, pair.symmetry.across[facing.nodes])
        psi = np.where(pair.symmetry.clamped[facing.nodes].all(axis=1)[:, None], 0.0, psi)
    weights = pair.share * facing.weight[:, None] * psi
    gaps = (gap - state.clearance)[at]
    nodes = facing.nodes.ravel()
    n = len(pair.slave.nodes)
    area = float_bincount(nodes, weights.ravel(), n)
    opened = float_bincount(nodes, (weights * gaps[:, None]).ravel(), n)
    return facing, weights, area, opened


def _is_coarser(pair: Any) -> bool:
    """Return True where a body that deforms has smaller facets on the master than on the slave."""
    return not pair.master.rigid and pair.master.spacing < _FINER * pair.slave.spacing


def _spread(psi: ndarray, held: ndarray) -> ndarray:
    """Give the functions of nodes held across the surface to the other nodes of their facet.

    See :class:`.symmetry.Symmetry`. A facet without other nodes keeps its functions.
    """
    others = (~held).sum(axis=1, keepdims=True)
    given = np.where(held & (others > 0), psi, 0.0)
    share = given.sum(axis=1, keepdims=True) / np.maximum(others, 1)
    return np.where(held, psi - given, psi + share)


def mean_gaps(pair: Any, state: ContactState, found: ndarray, gap: ndarray) -> ndarray:
    """Return the nodes' mean gaps at the points `found`, a mask; inf where they face nothing."""
    *_, area, opened = integrals(pair, state, np.flatnonzero(found), gap)
    some = area > _NOTHING * area.max(initial=0.0)
    return np.where(some, opened / np.where(some, area, 1.0), np.inf)


def nodal_forces(pair: Any, x: ndarray, state: ContactState) -> list[ndarray]:
    """Return the internal forces of pressure and of friction in a state, shape (N,) each."""
    found = pair.interface.closest(x, state.cuts, state.facet)
    at = np.flatnonzero(found.found)
    facing, weights, *_ = integrals(pair, state, at, found.gap)
    kinematics = pair.interface.variations(x, state, found, at)
    acting = np.einsum("nk,ink->ni", weights, state.multiplier[:, facing.nodes])
    work = kinematics.expanded(kinematics.work)
    forces = []
    for part in (slice(1), slice(1, None)):
        by_points = np.einsum("ni,nim->nm", acting[:, part], work[:, part])
        forces.append(pair.gathering.force(kinematics.dofs, by_points))
    return forces


def balanced(pair: Any, state: ContactState) -> ndarray:
    r"""Return tractions at points, (dim, n), with the forces and moments of the nodal forces.

    Interpolated tractions :math:`t = \sum_j N_j t_j` have the forces of the duals, but not their
    moments: at an end of the surface the node's mean over a part of a facet is shown at its end.
    The tractions become :math:`t + |t| (a + b \cdot x)`, which leaves open points without any. At
    a plane of symmetry the whole model's forces and moments count: a pressure has no moment about
    it, and a shear across it no force.
    """
    at = np.flatnonzero(state.facet >= 0)
    facing, weights, *_ = integrals(pair, state, at, state.gap)
    forces = np.einsum("nk,ink->in", weights, state.multiplier[:, facing.nodes])
    area = pair.share * facing.weight
    planes = pair.symmetry.planes if pair.symmetry else ()
    tractions = state.traction.copy()
    linear = _linear(pair, facing, area * np.abs(tractions[0, at]), planes)

    # Change each component in proportion to its size, by functions of its symmetry
    for k, (component, force) in enumerate(zip(tractions, forces, strict=True)):
        functions = linear[:, _of_symmetry(k, planes, pair.slave.dim)]
        if functions.shape[1] == 0:
            continue
        t = component[at]
        missing = functions.T @ (force - area * t)
        products = functions.T @ ((area * np.abs(t))[:, None] * functions)
        factors = np.linalg.pinv(products, rcond=_FLAT, hermitian=True) @ missing
        component[at] = t + np.abs(t) * (functions @ factors)
    return tractions


def _linear(pair: Any, points: SlavePoints, pressed: ndarray, planes: Sequence[Any]) -> ndarray:
    """Return one and the coordinates of points across the mean normal, over their size.

    They count from the middle, or from planes of symmetry.
    """
    positions = points.positions(pair.slave.nodes)
    x = positions.copy()
    if len(x):
        x -= x.mean(axis=0)
    size = max_abs(x) or 1.0
    normal = pair.slave.at(points.facet, points.xi, pair.slave.nodes).normal
    mean = pressed @ normal
    for plane in planes:
        x[:, plane.axis] = positions[:, plane.axis] - plane.coordinate
        mean[plane.axis] = 0.0
    mean /= max(float(np.linalg.norm(mean)), np.finfo(float).tiny)
    return np.column_stack((np.ones(len(x)), (x - np.outer(x @ mean, mean)) / size))


def _of_symmetry(k: int, planes: Sequence[Any], dim: int) -> ndarray:
    """Return a mask of the functions, one and the coordinates, that symmetry leaves a component."""
    fits = np.ones(1 + dim, bool)
    for plane in planes:
        is_odd = np.arange(1 + dim) == 1 + plane.axis
        fits &= is_odd == plane.odd[k]
    # between two planes no coordinate counts from both
    axes = np.bincount([plane.axis for plane in planes], minlength=dim)
    fits[1:] &= axes < 2
    return fits


def _law_at(pair: Any, state: ContactState, numbers: ndarray) -> Any:
    """Return the law at nodes."""
    points = pair.points(state).take(pair.nodes_at(state).point[numbers])
    ones = np.ones((len(numbers), 1))
    return pair.law.take(replace(points, nodes=numbers[:, None], values=ones))


def _after(pair: Any, state: ContactState, found: Projection, closed: _Closed) -> ContactState:
    """Return the candidate state; all points stick to their closest points."""
    around = pair.nodes_at(state)
    at = closed.points
    traction = closed.everywhere(closed.update.traction)
    status = closed.everywhere(closed.update.status)
    if pair.symmetry is not None and pair.symmetry.followed is not None:
        traction = traction + traction @ pair.symmetry.followed.T

    # Points have the status of the closed node with the largest hat
    nodes = pair.points(state).nodes[at]
    values = around.values[at]
    share = np.where(status[nodes] != Status.OPEN, values, 0.0)
    nearest = nodes[np.arange(len(at)), share.argmax(axis=1)]

    # Points have the internal variables of their nearest node
    number = np.full(len(status), -1)
    number[closed.on] = np.arange(len(closed.on))
    own = number[around.owner]
    known = own >= 0
    internal = state.internal.copy()
    internal[:, known] = closed.update.internal[:, own[known]]
    update = LawUpdate(
        traction=np.einsum("nk,nki->in", values, traction.T[nodes]),
        internal=internal[:, at],
        tangent=np.zeros(0),
        elastic_slip=np.zeros(0),
        status=np.where(share.any(axis=1), status[nearest], int(Status.OPEN)),
    )
    slip = state.slip + pair.interface.slid(state, found.closest)
    after = state.after(found, at, update, found.closest.take(at), slip)
    return replace(after, internal=internal, multiplier=traction, closed=status != Status.OPEN)


def _stiffness(
    pair: Any, closed: _Closed, acting: ndarray, share: ndarray, eps: ndarray
) -> csr_matrix:
    """Return the tangent of the forces and of the conditions at the nodes."""
    n = pair.size
    on = closed.on
    kinematics = closed.kinematics

    # Change of the tractions: dt = D (dJ + dlambda / eps)
    gradient = np.concatenate((kinematics.work[:, :1], slip_gradient(kinematics)), axis=1)
    means = csr_matrix(closed.sums.multiply(1.0 / closed.area[on, None]))
    jumps = _rows(means, kinematics.dofs, kinematics.expanded(gradient), n)
    multipliers = pair.multipliers[:, on].ravel()
    own = _picks(multipliers, np.repeat(1.0 / eps, len(on)), n)
    dt = _blocks(closed.update.tangent) @ (jumps + own)

    # Change of the forces, and of the conditions W / eps (t - lambda)
    work = kinematics.expanded(kinematics.work)
    forces = _rows(closed.sums, kinematics.dofs, work, n)
    conditions = _picks(multipliers, share[:, on].ravel(), n)
    everywhere = pair.multipliers.ravel()
    held = (1.0 + _HELD) * share.ravel()
    K = (forces + conditions).T @ dt - csr_matrix((held, (everywhere, everywhere)), shape=(n, n))

    # Change of the frames in which the tractions act
    if pair.tangent == "exact":
        turned = kinematics.expanded(geometric_tangent(kinematics, acting.T)).transpose(0, 2, 1)
        turned = kinematics.expanded(turned).transpose(0, 2, 1)
        K = K + pair.gathering.matrix(kinematics.dofs, turned)
    return csr_matrix(K)


def _blocks(tangent: ndarray) -> csr_matrix:
    """Return derivatives, shape (dim, dim, n), as a matrix of dim n rows."""
    dim, _, n = tangent.shape
    component, by_component, point = np.indices(tangent.shape)
    row = component * n + point
    column = by_component * n + point
    return csr_matrix((tangent.ravel(), (row.ravel(), column.ravel())), shape=(dim * n, dim * n))


def _picks(dofs: ndarray, values: ndarray, n: int) -> csr_matrix:
    """Return the matrix that picks dofs out of n, times values."""
    return csr_matrix((values, dofs, np.arange(dofs.size + 1)), shape=(dofs.size, n))


def _rows(sums: csr_matrix, dofs: ndarray, variations: ndarray, n: int) -> csr_matrix:
    """Return weighted sums over points of variations (n_points, dim, m), shape (dim n_on, n)."""
    count, m = dofs.shape
    columns = np.where(dofs < 0, n, dofs).ravel()  # column n: dofs that do not move
    ends = np.arange(count + 1) * m
    parts = []
    for i in range(variations.shape[1]):
        part = csr_matrix((variations[:, i].ravel(), columns, ends), shape=(count, n + 1))
        parts.append(sums @ part)
    return vstack(parts).tocsr()[:, :n]


def foreseen(
    pair: Any,
    start: ndarray,
    x: ndarray,
    before: ndarray | None,
    accepted: ContactState,
) -> ndarray:
    """Return a start with tension at nodes that stay open although the start closes their gaps.

    Newton's method closes all nodes whose gaps are negative at its start. These are too many,
    because the bodies yield near the contact, and it opens them again row by row, one in each
    iteration.

    An extrapolated start moves the edge of the contact evenly.  Without displacements `before` the
    start is the first step from the accepted ones.
    """
    # Find open nodes with a negative gap at the start
    state = pair.effective(accepted)
    now = mean_gaps(pair, state, np.isfinite(accepted.gap), accepted.gap)
    then = _gaps_at_start(pair, start, state)
    reached = ~accepted.closed & (now > 0.0) & (now < np.inf) & (then < 0.0)
    if not reached.any():
        return start

    # Foresee which of them stay open: by the share of the step, or by the motion of the edge
    if before is None or not accepted.closed.any():
        opens = _closes_late(now, then, reached)
    else:
        last = x - before
        ratio = float(last @ (start - x)) / float(last @ last)
        found = pair.interface.closest(before, state.cuts, state.facet)
        earlier = mean_gaps(pair, state, found.found, found.gap)
        at_edge = _at_edge(pair.slave, accepted.closed)
        opens = reached & _stays_ahead(earlier, now, ratio, at_edge)
    if not opens.any():
        return start
    start = start.copy()
    start[pair.multipliers[0, opens]] = -2.0 * pair.penalties(state)[0] * then[opens]
    return start


def _closes_late(now: ndarray, then: ndarray, reached: ndarray) -> ndarray:
    """Return a mask of nodes that a step reaches late, counted from the first that it reaches."""
    share = np.zeros(len(now))
    share[reached] = now[reached] / (now[reached] - then[reached])
    first = share[reached].min()
    return share > first + _LATE * (1.0 - first)


def _stays_ahead(earlier: ndarray, now: ndarray, ratio: float, at_edge: ndarray) -> ndarray:
    """Return a mask of nodes ahead of the contact's edge, which moves `ratio` times as before.

    At the edge of contact of smooth bodies the gap grows like the power 3/2 of the distance, so
    that its power 2/3 is in proportion to the motion of the edge.  A node closes when the edge
    comes near it, for its gap is a mean over its facets: distances count from the node.  Open nodes
    `at_edge`, next to closed ones, are as far from it in the mean.
    """
    near = now[at_edge & (now < np.inf)]
    ahead = 0.0
    if len(near):
        ahead = max(float(near.mean()), 0.0)

    def distance(gap: ndarray) -> ndarray:
        return np.asarray(np.maximum(gap + ahead, 0.0) ** _POWER - ahead**_POWER)

    with np.errstate(invalid="ignore"):  # inf - inf where nothing is near
        return (1.0 + ratio) * distance(now) > ratio * distance(earlier)


def _at_edge(slave: Surface, closed: ndarray) -> ndarray:
    """Return a mask of open nodes on facets that have a closed one."""
    has_closed = closed[slave.facets].any(axis=1)
    at_edge = np.zeros(len(closed), bool)
    at_edge[slave.facets[has_closed]] = True
    return at_edge & ~closed


def _gaps_at_start(pair: Any, x: ndarray, state: ContactState) -> ndarray:
    """Return the nodes' mean gaps at x; the next evaluation does not project again."""
    slave, nodes = pair.interface.positions(x)
    depth = pair.interface.depth(pair.points(state))
    reach = state.clearance + depth
    found, _ = pair.interface.near(slave, nodes, state, reach, depth, pair.held(state))
    return mean_gaps(pair, state, found.found, found.gap)
