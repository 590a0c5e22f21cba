r"""Gap and slip of contact points, their first variations and the exact geometric tangent, in the
plane and in space.

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
The slip is that of the point from its stick point, a material point of the master:
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
        Dofs of the slave's nodes, of those of the closest facet and, if it is another, of the stick
        point's facet; then the rotations that move these nodes; -1: none.
    work : ndarray, shape (n, dim, m)
        Work conjugates of the tractions with respect to the nodes: ``G`` = d gap / d u, then the
        tangential ones.
    slip : ndarray, shape (n, dim - 1)
        Slip from the stick point; zero where a point comes from beyond the rim: it sticks there.
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
        """Return variations by nodal displacements, shape (n, i, m), as variations by the dofs,
        shape (n, i, ...).
        """
        return (
            variations
            if self.lever is None
            else np.concatenate((variations, variations @ self.lever), axis=2)
        )


@dataclass(frozen=True, eq=False)
class _OnFacets:
    """Data of second variations; ``alpha`` (n, nodes) acts as r - rho, ``beta`` as a, ``sigma`` as
    r - x_s.

    ``delta`` acts as the direction from which tangents are counted.  The columns ``own`` are those
    of the closest facet's nodes; ``normal`` is the facet's, ``turning`` is ``n . da|_xi``,
    ``operator`` the inverse of m - g h.
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
        return self.turning + self.curvature @ self.Xi if self.curved else self.turning

    @cached_property
    def normal_motion(self) -> ndarray:
        """Variation ``dn`` of the normal at the closest point, shape (n, dim, m)."""
        return np.asarray(
            -self.mapping.x[1].transpose(0, 2, 1) @ (inverse(self.metric) @ self.turns)
        )


def variations(
    points: SlavePoints,
    slave: Surface,
    master: Surface,
    projection: Projection,
    slave_nodes: ndarray,
    nodes: ndarray,
    stick: MaterialPoints,
) -> Kinematics:
    """Return the kinematics of points with their closest and stick points at present coordinates of
    the nodes.
    """
    facet, xi, g, r = projection.facet, projection.xi, projection.gap, points.positions(slave_nodes)
    mapping = master.at(facet, xi, nodes, 1 if master.shape.affine else 3)
    N, direction = points.values, points.direction(slave, slave_nodes)
    held, weights, others = _stick_weights(master, facet, stick)
    blocks = [
        (slave, points.nodes),
        (master, master.facets[facet]),
        *((master, block) for block in others),
    ]
    dofs = np.concatenate([surface.dofs_of(block) for surface, block in blocks], axis=1)
    dofs = dofs.reshape(len(dofs), dofs.shape[1] * dofs.shape[2])
    more, lever = _levers(blocks)
    stuck = (held >= 0)[:, None]
    from_stick = _from_stick(master, nodes, facet, mapping, held, weights)
    M, own = mapping.shapes, slice(N.shape[1], N.shape[1] + mapping.shapes[0].shape[1])
    sigma = np.concatenate((np.where(stuck, N, 0.0), *(-w for w in weights)), axis=1)
    alpha, beta = np.zeros(sigma.shape), np.zeros((*M[1].shape[:2], sigma.shape[1]))
    alpha[:, : N.shape[1]], alpha[:, own], beta[:, :, own] = N, -M[0], M[1]
    delta = np.zeros_like(alpha)
    if N.shape == points.along.shape:  # a node alone does not turn the direction of its facet
        delta[:, : N.shape[1]] = points.along
    n, a = mapping.normal, mapping.x[1]
    if slave.dim == 3:
        given, direction = direction, askew(direction, n)
        delta[(direction != given).any(axis=1)] = 0.0  # an axis does not turn
    e = frame(n, direction)
    m, turning = products(a, a), lift(beta, n[:, None])
    h = np.zeros_like(m) if master.shape.affine else np.einsum("nc,nabc->nab", n, mapping.x[2])
    operator = inverse(m - g[:, None, None] * h)
    Xi = operator @ (lift(alpha[:, None], a) + g[:, None, None] * turning)
    G, T = lift(alpha[:, None], n[:, None])[:, 0], products(e, a) @ Xi
    offset = from_stick + np.where(stuck, r - mapping.x[0], 0.0)
    facets = _OnFacets(
        mapping,
        own,
        alpha,
        beta,
        sigma,
        g,
        offset,
        n,
        turning,
        m,
        h,
        operator,
        Xi,
        direction,
        delta,
    )
    edges = None
    if (v := np.flatnonzero(projection.feature)).size:
        edges = OnEdges(
            v,
            master,
            facet[v],
            xi[v],
            _free(master, projection.feature[v]),
            g[v],
            r[v],
            nodes[master.facets[facet[v]]],
            facets.from_stick[v],
            direction[v],
            N[v],
            sigma[v],
            delta[v],
        )
        n, e = n.copy(), e.copy()
        n[v], e[v], G[v], T[v] = edges.first[:4]
    return Kinematics(
        dofs if lever is None else np.hstack((dofs, more)),
        np.concatenate((G[:, None], T), axis=1),
        np.einsum("nic,nc->ni", e, from_stick),
        n,
        e,
        MaterialPoints(facet, xi),
        facets,
        edges,
        lever,
    )


def _levers(blocks: list[tuple[Surface, ndarray]]) -> tuple[ndarray, ndarray | None]:
    """Return the rotations that move nodes, shape (n, q), and their effect, shape (n, m, q), block
    by block.
    """
    if all(surface.arms is None for surface, _ in blocks):
        return np.zeros(0), None
    dofs, levers = zip(*(surface.levers(block) for surface, block in blocks), strict=True)
    lever = np.zeros(
        (len(dofs[0]), sum(a.shape[1] for a in levers), sum(a.shape[2] for a in levers))
    )
    row = column = 0
    for part in levers:
        lever[:, row : row + part.shape[1], column : column + part.shape[2]] = part
        row, column = row + part.shape[1], column + part.shape[2]
    return np.concatenate(dofs, axis=1), lever


def _free(master: Surface, feature: ndarray) -> ndarray:
    along = master.shape.along
    return np.concatenate((0 * along[:1], along, 0 * along[:1]))[feature]


def _stick_weights(
    master: Surface, facet: ndarray, stick: MaterialPoints
) -> tuple[ndarray, list[ndarray], list[ndarray]]:
    """Return facets of the stick points, and shape functions there of these and the closest
    facets.
    """
    held = stick.facet
    weights = np.where(stick.exist[:, None], master.shape.at(held, stick.known, 0)[0], 0.0)
    elsewhere = (stick.exist & (held != facet))[:, None]
    if not elsewhere.any():
        return held, [weights], []
    return (
        held,
        [np.where(elsewhere, 0.0, weights), np.where(elsewhere, weights, 0.0)],
        [np.where(elsewhere, master.facets[held], -1)],
    )


def _from_stick(
    master: Surface,
    nodes: ndarray,
    facet: ndarray,
    mapping: FacetMapping,
    held: ndarray,
    weights: list[ndarray],
) -> ndarray:
    """Return vectors from stick to closest points, shape (n, dim), exactly zero where they
    coincide.
    """
    near = np.where((held >= 0)[:, None], mapping.shapes[0], 0.0) - weights[0]
    way = np.einsum("nk,nkc->nc", near, nodes[master.facets[facet]])
    for others in weights[1:]:
        way -= np.einsum("nk,nkc->nc", others, nodes[master.facets[held]])
    return np.asarray(way)


def dragged(
    kinematics: Kinematics, master: Surface, nodes: ndarray, stick: MaterialPoints, elastic: ndarray
) -> MaterialPoints:
    """Return stick points after a step: sliding points drag them behind by their elastic slip (eq.
    10).
    """
    left = np.abs(elastic.T - kinematics.slip).max(axis=1)
    stays = stick.exist & (left <= _SAME_SLIP * np.abs(elastic).max(axis=0))
    after = offset_back(master, nodes, kinematics.tangents, kinematics.closest, elastic.T)
    return MaterialPoints(
        np.where(stays, stick.facet, after.facet), np.where(stays[:, None], stick.xi, after.xi)
    )


def slip_gradient(kinematics: Kinematics) -> ndarray:
    """Return d slip / d u, shape (n, dim - 1, m)."""
    on, n, e = kinematics.facets, kinematics.normal, kinematics.tangents
    S = lift(on.sigma[:, None], e) - dot(on.from_stick, n)[:, None, None] * (e @ on.normal_motion)
    if (spin := _spin(on, n, e)) is not None:
        s = kinematics.slip
        S += np.stack((s[:, 1], -s[:, 0]), axis=1)[:, :, None] * spin[:, None]
    if kinematics.edges is not None:
        S[kinematics.edges.at] = kinematics.edges.second[2]
    return S


def tangents(
    kinematics: Kinematics, traction: ndarray, derivative: ndarray, exact: bool
) -> ndarray:
    """Return tangents of the forces of points of unit weight, shape (n, m, m): eqs 14 to 16 or,
    unless exact, 20 to 22.

    `derivative` : ndarray, shape (dim, dim, n), holds the derivatives of the tractions by gap and
    slip.
    """
    work = kinematics.work
    jump = np.concatenate((work[:, :1], slip_gradient(kinematics)), axis=1)
    K = work.transpose(0, 2, 1) @ (derivative.transpose(2, 0, 1) @ jump)
    if exact:
        K += geometric_tangent(kinematics, traction)
    if kinematics.lever is None:
        return K
    return kinematics.expanded(kinematics.expanded(K).transpose(0, 2, 1)).transpose(0, 2, 1)


def geometric_tangent(kinematics: Kinematics, traction: ndarray) -> ndarray:
    """Return ``t_N dG/du + t_i dT_i/du``, shape (n, m, m): the part of the moving contact frame.

    These are the rotation and curvature parts of eqs 14 to 16, with the terms in :math:`m - g h`
    that the paper drops.
    """
    on, tension, dn = kinematics.facets, traction[0][:, None, None], kinematics.facets.normal_motion
    by_normal, by_point, back = (
        tension * on.gap[:, None, None] * dn,
        -tension * on.turning,
        -tension * on.turns,
    )
    left, right = (
        [by_normal, by_point, on.Xi],
        [dn, on.Xi, back],
    )  # factors: one product takes half of the time of many
    if traction[1:].any():
        t = np.einsum("in,nic->nc", traction[1:], kinematics.tangents)
        more, (further, others) = _tangential_factors(kinematics, t)
        left, right[2] = [by_normal + more[0], by_point + more[1], on.Xi, *further], back + more[2]
        right += others
    K = np.asarray(np.concatenate(left, axis=1).transpose(0, 2, 1) @ np.concatenate(right, axis=1))
    if kinematics.edges is not None:
        v, (dG, dT, _) = kinematics.edges.at, kinematics.edges.second
        K[v] = tension[v] * dG + np.einsum("in,nijk->njk", traction[1:, v], dT)
    return K


def _tangential_factors(
    kinematics: Kinematics, t: ndarray
) -> tuple[tuple[ndarray, ndarray, ndarray], tuple[list[ndarray], list[ndarray]]]:
    """Return factors of ``d((t . a) Xi)/du`` for tractions t that are constant in the frame.

    The first ones act as `dn`, from the left on `Xi` and behind it; then there are more on the left
    and on the right.
    """
    on = kinematics.facets
    a, n, g, eye = on.mapping.x[1], on.normal, on.gap[:, None, None], np.eye(t.shape[1])[None]
    p = np.einsum(
        "nab,nb->na", on.operator, np.einsum("nac,nc->na", a, t)
    )  # contravariant, for the operator m - g h
    P, beta = np.einsum("na,nac->nc", p, a), np.einsum("na,nak->nk", p, on.beta)[:, None]
    dP, by_point = lift(beta, eye), -lift(on.beta, P[:, None])
    if on.curved:
        dP += np.einsum("na,nabc->nbc", p, on.mapping.x[2]).transpose(0, 2, 1) @ on.Xi
    by_frame = -a @ dP
    if (spin := _spin(on, n, frame(n, on.direction))) is not None:
        by_frame += np.einsum("nac,nc->na", a, cross(n, t))[:, :, None] * spin[:, None]
    if on.curved:  # else P is t
        bent, by_curvature = _bending(on, p, kinematics.work[:, :1])
        by_point += g * bent
        by_frame += (
            by_curvature
            + lift(on.beta, (t - P)[:, None])
            + np.einsum("nc,nabc->nab", t - P, on.mapping.x[2]) @ on.Xi
        )
    return (g * lift(beta, eye), by_point, by_frame), (
        [lift(beta, n[:, None]), lift(on.alpha[:, None], eye)],
        [kinematics.work[:, :1], dP],
    )


def _bending(on: _OnFacets, p: ndarray, G: ndarray) -> tuple[ndarray, ndarray]:
    """Return ``n . d(p . rho_,ab)|_xi`` of second derivatives, and the part of ``d(m - g h) p`` by
    third ones.
    """
    n, g, (_, _, rho2, rho3) = on.normal, on.gap[:, None, None], on.mapping.x
    gamma = np.zeros_like(on.beta)
    gamma[:, :, on.own] = np.einsum("na,nabk->nbk", p, on.mapping.shapes[2])
    bent = lift(gamma, n[:, None])
    along, further = (
        np.einsum("na,nabc->nbc", p, x) for x in (rho2, np.einsum("nabcd,nd->nabc", rho3, n))
    )
    return bent, (
        np.einsum("na,nab->nb", p, on.curvature)[:, :, None] * G
        + g * (along @ on.normal_motion + bent + further @ on.Xi)
    )


def _spin(on: _OnFacets, n: ndarray, e: ndarray) -> ndarray | None:
    """Return the rate at which the frame turns about the normal, shape (n, m); None in the
    plane.
    """
    if e.shape[1] == 1:
        return None
    across = e[:, 1:]
    rate = (
        lift(on.delta[:, None], across)[:, 0]
        - dot(on.direction, n)[:, None] * (across @ on.normal_motion)[:, 0]
    )
    return np.asarray(rate / dot(on.direction, e[:, 0])[:, None])
