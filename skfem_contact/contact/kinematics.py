r"""Gap and slip of contact points, their first variations and the exact geometric tangent.

A point :math:`r = \sum_a N_a x_a` faces the facet :math:`\rho(\xi) = \sum_b M_b(\xi) x_b` at its
closest point:
:math:`(r - \rho) \cdot a_\alpha = 0` with :math:`a_\alpha = \rho_{,\alpha}`,
:math:`g = (r - \rho) \cdot n` (eqs 2 and 3).  With the metric
:math:`m_{\alpha\beta} = a_\alpha \cdot a_\beta`, the curvature
:math:`h_{\alpha\beta} = n \cdot \rho_{,\alpha\beta}` and variations :math:`\delta\rho|_\xi`,
:math:`\delta a_\alpha|_\xi` at a fixed
:math:`\xi`, exact for any penetration,

.. math:: \delta g = G \cdot \delta u = n \cdot (\delta r - \delta\rho|_\xi), \qquad
          (m - g h)_{\alpha\beta}\, \delta\xi^\beta = a_\alpha \cdot (\delta r - \delta\rho|_\xi)
          + g\, n \cdot \delta a_\alpha|_\xi .

The internal force of a point of unit weight is :math:`t_N G + (t \cdot a_\alpha)\,\Xi^\alpha` with
:math:`\delta\xi = \Xi \cdot \delta u` (eq. 13 with the sign of eq. 7 mended): it exerts no couple.
The slip of a point counts from its stick point, a material point of the master:
:math:`s_i = e_i \cdot (r - x_s)` with unit tangents :math:`e_i`.

On an edge or a vertex :math:`n = (r - \rho)/g` follows the offset, and the tangential force is
taken to the point's motion relative to a frame that turns with the facet.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy import ndarray

from ..surfaces.material_points import MaterialPoints, offset_back
from ..surfaces.surface import FacetMapping, Surface
from ..surfaces.vectors import askew, cross, dot, frame, inverse, lift, products
from .edges import OnEdges
from .quadrature import SlavePoints
from .search import Projection

#: Round-off of an elastic slip, as a share of it.
_SAME_SLIP = 1e-9


class Kinematics(NamedTuple):
    """Variations at ``n`` contact points with ``m`` nodal displacements each.

    Attributes
    ----------
    dofs : ndarray, shape (n, m) or more
        Dofs of the slave's nodes, of the closest facet's and, if it is another, of the stick
        point's facet; then the rotations that move these nodes; -1: none.
    work : ndarray, shape (n, dim, m)
        Work conjugates of the tractions with respect to the nodes: ``G`` = d gap / d u, then the
        tangential ones.
    slip : ndarray, shape (n, dim - 1)
        Slip from the stick point; zero where a point comes from beyond the rim, where it sticks.
    normal, tangents : ndarray, shapes (n, dim) and (n, dim - 1, dim)
        Unit vectors of the master at the closest point.
    lever : ndarray, shape (n, m, q), optional
        Displacements of the nodes by their rotations.
    """

    dofs: ndarray
    work: ndarray
    slip: ndarray
    normal: ndarray
    tangents: ndarray
    closest: MaterialPoints
    facets: _OnFacets
    edges: OnEdges | None
    lever: ndarray | None = None

    def expanded(self, variations: ndarray) -> ndarray:
        """Return variations (n, i, m) by displacements of nodes as variations by the dofs."""
        if self.lever is None:
            return variations
        by_rotations = variations @ self.lever
        return np.concatenate((variations, by_rotations), axis=2)


@dataclass(frozen=True, eq=False)
class _OnFacets:
    """Data of second variations at points that face the inside of a facet.

    Attributes
    ----------
    mapping
        Positions and derivatives of the master at the closest points.
    own
        Columns of the closest facet's nodes.
    alpha, sigma : ndarray, shape (n, nodes)
        Factors of the nodes in r - rho, and in r - x_s.
    beta : ndarray, shape (n, dim - 1, nodes)
        Factors of the nodes in the tangents a.
    gap : ndarray, shape (n,)
    from_stick : ndarray, shape (n, dim)
        Vector r - x_s.
    normal : ndarray, shape (n, dim)
        Normal of the facet.
    turning, Xi : ndarray, shape (n, dim - 1, m)
        Variations ``n . da|_xi``, and of the local coordinates xi.
    metric, curvature, operator : ndarray, shape (n, dim - 1, dim - 1)
        m, h, and the inverse of m - g h.
    direction : ndarray, shape (n, dim)
        Direction from which tangents are counted.
    delta : ndarray, shape (n, nodes)
        Factors of the nodes in the direction.
    """

    mapping: FacetMapping
    own: slice
    alpha: ndarray
    beta: ndarray
    sigma: ndarray
    gap: ndarray
    from_stick: ndarray
    normal: ndarray
    turning: ndarray
    metric: ndarray
    curvature: ndarray
    operator: ndarray
    Xi: ndarray
    direction: ndarray
    delta: ndarray

    @property
    def curved(self) -> bool:
        """True if the facets have second derivatives."""
        return len(self.mapping.x) > 2

    @cached_property
    def turns(self) -> ndarray:
        """Rates ``n . da`` at which the normal turns towards the tangents, (n, dim - 1, m)."""
        if self.curved:
            return self.turning + self.curvature @ self.Xi
        return self.turning

    @cached_property
    def normal_motion(self) -> ndarray:
        """Variation ``dn = -a m^-1 (n . da)`` of the closest point's normal, (n, dim, m)."""
        a = self.mapping.x[1].transpose(0, 2, 1)
        return np.asarray(-a @ (inverse(self.metric) @ self.turns))


def variations(
    points: SlavePoints,
    slave: Surface,
    master: Surface,
    projection: Projection,
    slave_nodes: ndarray,
    nodes: ndarray,
    stick: MaterialPoints,
) -> Kinematics:
    """Return the kinematics of points at present coordinates of the nodes of both surfaces.

    The points have the closest points of a projection, and the stick points `stick`.
    """
    facet = projection.facet
    xi = projection.xi
    g = projection.gap
    r = points.positions(slave_nodes)
    mapping = master.at(facet, xi, nodes, 1 if master.shape.affine else 3)
    n = mapping.normal
    a = mapping.x[1]

    # Number the nodes: the slave's, those of the closest facet, those of another stick facet
    weights, others = _stick_weights(master, facet, stick)
    blocks = [(slave, points.nodes), (master, master.facets[facet])]
    blocks += [(master, block) for block in others]
    dofs = np.concatenate([surface.dofs_of(block) for surface, block in blocks], axis=1)
    dofs = dofs.reshape(len(dofs), dofs.shape[1] * dofs.shape[2])
    rotations, lever = _levers(blocks)

    # Collect the factors of the nodes in r - rho, in the tangents a, and in r - x_s
    N = points.values
    M = mapping.shapes
    k = N.shape[1]
    own = slice(k, k + M[0].shape[1])
    stuck = stick.exist[:, None]
    sigma = np.concatenate((np.where(stuck, N, 0.0), *(-w for w in weights)), axis=1)
    alpha = np.zeros(sigma.shape)
    alpha[:, :k] = N
    alpha[:, own] = -M[0]
    beta = np.zeros((*M[1].shape[:2], sigma.shape[1]))  # (n, dim - 1, nodes)
    beta[:, :, own] = M[1]
    direction, delta = _directions(points, slave, slave_nodes, n, alpha.shape)

    # First variations: (m - g h) dxi = a . (dr - drho) + g n . da, dg = n . (dr - drho)
    e = frame(n, direction)
    m = products(a, a)
    if master.shape.affine:
        h = np.zeros_like(m)
    else:
        h = np.einsum("nc,nabc->nab", n, mapping.x[2])
    turning = lift(beta, n[:, None])
    operator = inverse(m - g[:, None, None] * h)
    Xi = operator @ (lift(alpha[:, None], a) + g[:, None, None] * turning)
    G = lift(alpha[:, None], n[:, None])[:, 0]
    T = products(e, a) @ Xi

    to_closest = _from_stick(master, nodes, facet, mapping, stick, weights)
    facets = _OnFacets(
        mapping=mapping,
        own=own,
        alpha=alpha,
        beta=beta,
        sigma=sigma,
        gap=g,
        from_stick=to_closest + np.where(stuck, r - mapping.x[0], 0.0),
        normal=n,
        turning=turning,
        metric=m,
        curvature=h,
        operator=operator,
        Xi=Xi,
        direction=direction,
        delta=delta,
    )

    # Replace the variations of points that face an edge or a vertex
    edges = None
    v = np.flatnonzero(projection.feature)
    if v.size:
        edges = OnEdges(
            at=v,
            master=master,
            facet=facet[v],
            xi=xi[v],
            along=_along_features(master)[projection.feature[v]],
            gap=g[v],
            point=r[v],
            nodes=nodes[master.facets[facet[v]]],
            from_stick=facets.from_stick[v],
            direction=direction[v],
            values=N[v],
            sigma=sigma[v],
            delta=delta[v],
        )
        n = n.copy()
        e = e.copy()
        n[v], e[v], G[v], T[v] = edges.first[:4]
    return Kinematics(
        dofs=dofs if lever is None else np.hstack((dofs, rotations)),
        work=np.concatenate((G[:, None], T), axis=1),
        slip=np.einsum("nic,nc->ni", e, to_closest),
        normal=n,
        tangents=e,
        closest=MaterialPoints(facet, xi),
        facets=facets,
        edges=edges,
        lever=lever,
    )


def _directions(
    points: SlavePoints,
    slave: Surface,
    nodes: ndarray,
    normal: ndarray,
    shape: tuple[int, ...],
) -> tuple[ndarray, ndarray]:
    """Return directions from which tangents are counted, and the nodes' factors in them."""
    delta = np.zeros(shape)
    if points.values.shape == points.along.shape:  # a node alone does not turn its facet
        delta[:, : points.along.shape[1]] = points.along
    given = points.direction(slave, nodes)
    if slave.dim == 2:
        return given, delta
    direction = askew(given, normal)
    delta[(direction != given).any(axis=1)] = 0.0  # an axis does not turn
    return direction, delta


def _levers(blocks: list[tuple[Surface, ndarray]]) -> tuple[ndarray, ndarray | None]:
    """Return the rotations that move nodes, (n, q), and the nodes' displacements, (n, m, q)."""
    if all(surface.arms is None for surface, _ in blocks):
        return np.zeros(0), None
    dofs = []
    levers = []
    for surface, block in blocks:
        numbers, part = surface.levers(block)
        dofs.append(numbers)
        levers.append(part)
    n_rows = sum(part.shape[1] for part in levers)
    n_columns = sum(part.shape[2] for part in levers)
    lever = np.zeros((len(dofs[0]), n_rows, n_columns))  # block diagonal
    row = column = 0
    for part in levers:
        _, m, q = part.shape
        lever[:, row : row + m, column : column + q] = part
        row += m
        column += q
    return np.concatenate(dofs, axis=1), lever


def _along_features(master: Surface) -> ndarray:
    """Return the directions in which closest points move, by feature: only along sides."""
    along = master.shape.along
    none = 0 * along[:1]
    return np.concatenate((none, along, none))


def _stick_weights(
    master: Surface, facet: ndarray, stick: MaterialPoints
) -> tuple[list[ndarray], list[ndarray]]:
    """Return shape functions at stick points, by facets, and nodes of facets not the closest."""
    shapes = master.shape.at(stick.facet, stick.known, 0)[0]
    weights = np.where(stick.exist[:, None], shapes, 0.0)
    elsewhere = (stick.exist & (stick.facet != facet))[:, None]
    if not elsewhere.any():
        return [weights], []
    here = np.where(elsewhere, 0.0, weights)
    away = np.where(elsewhere, weights, 0.0)
    return [here, away], [np.where(elsewhere, master.facets[stick.facet], -1)]


def _from_stick(
    master: Surface,
    nodes: ndarray,
    facet: ndarray,
    mapping: FacetMapping,
    stick: MaterialPoints,
    weights: list[ndarray],
) -> ndarray:
    """Return vectors from stick to closest points, (n, dim), exactly zero where they coincide."""
    near = np.where(stick.exist[:, None], mapping.shapes[0], 0.0) - weights[0]
    way = np.einsum("nk,nkc->nc", near, nodes[master.facets[facet]])
    for others in weights[1:]:
        way -= np.einsum("nk,nkc->nc", others, nodes[master.facets[stick.facet]])
    return np.asarray(way)


def dragged(
    kinematics: Kinematics,
    master: Surface,
    nodes: ndarray,
    stick: MaterialPoints,
    elastic: ndarray,
) -> MaterialPoints:
    """Return stick points after a step: sliding drags them at their elastic slip (eq. 10)."""
    slid = np.abs(elastic.T - kinematics.slip).max(axis=1)
    stays = stick.exist & (slid <= _SAME_SLIP * np.abs(elastic).max(axis=0))
    after = offset_back(master, nodes, kinematics.tangents, kinematics.closest, elastic.T)
    facet = np.where(stays, stick.facet, after.facet)
    xi = np.where(stays[:, None], stick.xi, after.xi)
    return MaterialPoints(facet, xi)


def slip_gradient(kinematics: Kinematics) -> ndarray:
    """Return d slip / d u, shape (n, dim - 1, m): of s_i = e_i . (r - x_s)."""
    on = kinematics.facets
    n = kinematics.normal
    e = kinematics.tangents
    height = dot(on.from_stick, n)[:, None, None]
    S = lift(on.sigma[:, None], e) - height * (e @ on.normal_motion)
    spin = _spin(on, n, e)
    if spin is not None:
        s = kinematics.slip
        turned = np.stack((s[:, 1], -s[:, 0]), axis=1)
        S += turned[:, :, None] * spin[:, None]
    if kinematics.edges is not None:
        S[kinematics.edges.at] = kinematics.edges.second[2]
    return S


def tangents(
    kinematics: Kinematics,
    traction: ndarray,
    derivative: ndarray,
    exact: bool,
) -> ndarray:
    """Return tangents of points of unit weight, (n, m, m): eqs 14 to 16, or 20 to 22.

    Parameters
    ----------
    traction : ndarray, shape (dim, n)
        Tractions, which the geometric part contains.
    derivative : ndarray, shape (dim, dim, n)
        Derivatives of the tractions by gap and slip.
    exact : bool
        True for the rotation and curvature parts of eqs 14 to 16; without them eqs 20 to 22.
    """
    work = kinematics.work
    jump = np.concatenate((work[:, :1], slip_gradient(kinematics)), axis=1)
    K = work.transpose(0, 2, 1) @ (derivative.transpose(2, 0, 1) @ jump)
    if exact:
        K += geometric_tangent(kinematics, traction)
    if kinematics.lever is None:
        return K
    K = kinematics.expanded(K).transpose(0, 2, 1)
    return kinematics.expanded(K).transpose(0, 2, 1)


def geometric_tangent(kinematics: Kinematics, traction: ndarray) -> ndarray:
    """Return ``t_N dG/du + t_i dT_i/du``, shape (n, m, m): the part of the moving contact frame.

    These are the rotation and curvature parts of eqs 14 to 16, with the terms in :math:`m - g h`
    that the paper drops.
    """
    on = kinematics.facets
    dn = on.normal_motion
    t_N = traction[0][:, None, None]

    # d(t_N G)/du = by_normal^T dn + by_point^T Xi + Xi^T by_frame
    by_normal = t_N * on.gap[:, None, None] * dn
    by_point = -t_N * on.turning
    by_frame = -t_N * on.turns
    left = [by_normal, by_point, on.Xi]
    right = [dn, on.Xi, by_frame]

    if traction[1:].any():
        t = np.einsum("in,nic->nc", traction[1:], kinematics.tangents)
        factors = _tangential_factors(kinematics, t)
        left = [by_normal + factors.by_normal, by_point + factors.by_point, on.Xi, *factors.left]
        right = [dn, on.Xi, by_frame + factors.by_frame, *factors.right]

    # Multiply all factors at once, which takes half of the time of one product each
    rows = np.concatenate(left, axis=1).transpose(0, 2, 1)
    K = np.asarray(rows @ np.concatenate(right, axis=1))

    if kinematics.edges is not None:
        v = kinematics.edges.at
        dG, dT, _ = kinematics.edges.second
        K[v] = t_N[v] * dG + np.einsum("in,nijk->njk", traction[1:, v], dT)
    return K


class _Factors(NamedTuple):
    """Factors of ``d((t . a) Xi)/du``, shape (n, i, m) each.

    The first three act from the left on `dn` and on `Xi`, and from the right on `Xi`; `left` and
    `right` are further pairs.
    """

    by_normal: ndarray
    by_point: ndarray
    by_frame: ndarray
    left: list[ndarray]
    right: list[ndarray]


def _tangential_factors(kinematics: Kinematics, t: ndarray) -> _Factors:
    """Return the factors for tractions t, shape (n, dim), that are constant in the frame."""
    on = kinematics.facets
    a = on.mapping.x[1]
    n = on.normal
    g = on.gap[:, None, None]
    G = kinematics.work[:, :1]
    identity = np.eye(t.shape[1])[None]

    # Contravariant components p = (m - g h)^-1 (a . t), and the vector P = p a
    p = np.einsum("nab,nb->na", on.operator, np.einsum("nac,nc->na", a, t))
    P = np.einsum("na,nac->nc", p, a)
    beta = np.einsum("na,nak->nk", p, on.beta)[:, None]

    # Differentiate P and the frame
    moved = lift(beta, identity)
    dP = moved
    if on.curved:
        bend = np.einsum("na,nabc->nbc", p, on.mapping.x[2])
        dP = moved + bend.transpose(0, 2, 1) @ on.Xi
    by_point = -lift(on.beta, P[:, None])
    by_frame = -a @ dP
    spin = _spin(on, n, frame(n, on.direction))
    if spin is not None:
        across_n = np.einsum("nac,nc->na", a, cross(n, t))
        by_frame += across_n[:, :, None] * spin[:, None]

    # Add the curvature; on flat facets P is t
    if on.curved:
        bent, by_curvature = _bending(on, p, G)
        by_point += g * bent
        rest = t - P
        by_tangents = lift(on.beta, rest[:, None])
        by_position = np.einsum("nc,nabc->nab", rest, on.mapping.x[2]) @ on.Xi
        by_frame += by_curvature + by_tangents + by_position
    return _Factors(
        by_normal=g * moved,
        by_point=by_point,
        by_frame=by_frame,
        left=[lift(beta, n[:, None]), lift(on.alpha[:, None], identity)],
        right=[G, dP],
    )


def _bending(on: _OnFacets, p: ndarray, G: ndarray) -> tuple[ndarray, ndarray]:
    """Return ``n . d(p . rho_,ab)|_xi``, and the part of ``d(m - g h) p`` by third derivatives."""
    n = on.normal
    g = on.gap[:, None, None]
    _, _, rho2, rho3 = on.mapping.x
    gamma = np.zeros_like(on.beta)
    gamma[:, :, on.own] = np.einsum("na,nabk->nbk", p, on.mapping.shapes[2])
    bent = lift(gamma, n[:, None])
    second = np.einsum("na,nabc->nbc", p, rho2)
    third = np.einsum("na,nabc->nbc", p, np.einsum("nabcd,nd->nabc", rho3, n))
    by_gap = np.einsum("na,nab->nb", p, on.curvature)[:, :, None] * G
    by_curvature = g * (second @ on.normal_motion + bent + third @ on.Xi)
    return bent, by_gap + by_curvature


def _spin(on: _OnFacets, n: ndarray, e: ndarray) -> ndarray | None:
    """Return the rate at which the frame turns about the normal, (n, m); None in the plane."""
    if e.shape[1] == 1:
        return None
    across = e[:, 1:]
    by_direction = lift(on.delta[:, None], across)[:, 0]
    by_normal = dot(on.direction, n)[:, None] * (across @ on.normal_motion)[:, 0]
    length = dot(on.direction, e[:, 0])
    return np.asarray((by_direction - by_normal) / length[:, None])
