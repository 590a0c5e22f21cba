r"""Gap and slip of contact points, their first variations and the exact geometric tangent.

A point :math:`r = \sum_a N_a x_a` faces the curve :math:`\rho(\xi) = \sum_b M_b(\xi) x_b` at its closest point:
:math:`(r - \rho) \cdot \rho_1 = 0`, :math:`g = (r - \rho) \cdot n` (eqs 2 and 3).  With the operators

.. math:: A\,\delta u = \delta r - \delta\rho|_\xi, \quad B\,\delta u = \delta\rho_1|_\xi,
          \quad C\,\delta u = \delta\rho_2|_\xi

and :math:`l = |\rho_1|`, :math:`a = l^2`, :math:`h = n \cdot \rho_2` the variations are exact for any penetration:

.. math:: \delta g = G \cdot \delta u, \quad G = A^T n, \qquad
          \delta\xi = \Xi \cdot \delta u, \quad \Xi = (A^T \rho_1 + g B^T n) / (a - g h).

The internal force of a point of unit weight is :math:`t_N G + t_T l\,\Xi` (eq. 13 with the sign of eq. 7 mended),
where :math:`t_T` grows with the slip :math:`s = (l / l_{ref}) (S(\xi) - S_c)`: S is the arc position along the
undeformed master, S_c the stick point (eq. 7 across segments).
"""
from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy import ndarray

from .laws import Update
from .quadrature import SlavePoints
from .search import Projection
from .surface import Surface


class Kinematics(NamedTuple):
    """Variations at ``n`` contact points with ``m`` unknowns each.

    Attributes
    ----------
    dofs
        Unknowns, slave nodes first, (n, m).
    gap_gradient
        ``G`` = d gap / d u, the work conjugate of the normal traction, (n, m).
    tangential
        ``l Xi``, the work conjugate of the tangential traction, (n, m).
    slip_gradient
        d slip / d u, (n, m).
    normal, tangent
        Unit vectors of the master at the closest point, (n, 2).
    elastic_arc
        Distance along the undeformed master from the stick point, ``S - S_c``, (n,).
    stretch
        ``l / l_ref``, the slip of a unit of that distance, (n,).
    second
        Everything the geometric tangent needs, see :func:`geometric_tangent`.
    """

    dofs: ndarray
    gap_gradient: ndarray
    tangential: ndarray
    slip_gradient: ndarray
    normal: ndarray
    tangent: ndarray
    elastic_arc: ndarray
    stretch: ndarray
    second: tuple[ndarray, ...]


def _lift(factors: ndarray, vectors: ndarray) -> ndarray:
    """``A^T v`` for an operator that acts node by node: (n, nodes) and (n, 2) give (n, 2 nodes)."""
    return (factors[:, :, None] * vectors[:, None, :]).reshape(len(factors), 2 * factors.shape[1])


def _turned(vectors: ndarray) -> ndarray:
    """Vectors, (n, 2), turned by +90 degrees."""
    return vectors[:, ::-1] * (-1.0, 1.0)


def _dot(u: ndarray, v: ndarray) -> ndarray:
    return np.einsum("nc,nc->n", u, v)


def variations(points: SlavePoints, slave: Surface, master: Surface, at: ndarray, projection: Projection,
               positions: ndarray, stick_point: ndarray, nodes: ndarray) -> Kinematics:
    """Variations of the points ``at``.

    Parameters
    ----------
    points, slave, master
        The slave's points and the two surfaces.
    at
        Numbers of the points that are in contact, (n,).
    projection
        Closest points of all points.
    positions
        Current coordinates of all points, (n_points, 2).
    stick_point
        Arc positions ``S_c`` of all points; nan where a point comes from beyond the ends: it sticks where it arrives.
    nodes
        Current coordinates of the master's nodes.
    """
    segment, xi, g = projection.segment[at], projection.xi[at], projection.gap[at]
    M, rho = master.curve(segment, xi, nodes)
    N = points.values[at]
    dofs = np.concatenate((slave.dofs[points.nodes[at]], master.dofs[master.segments[segment]]), axis=1)
    zero = np.zeros_like(N)
    alpha, beta, gamma = (np.concatenate((s, m), axis=1) for s, m in ((N, -M[0]), (zero, M[1]), (zero, M[2])))

    l = np.hypot(rho[1, :, 0], rho[1, :, 1])
    v = np.flatnonzero(projection.vertex[at])
    tau = facet_tau = rho[1] / l[:, None]
    n = facet_n = _turned(tau)
    if len(v):
        n, tau = n.copy(), tau.copy()
        n[v] = (positions[at[v]] - rho[0, v]) / g[v, None]
        tau[v] = -_turned(n[v])
    h = _dot(n, rho[2])
    D = l**2 - g * h
    G, Bn, Bt = _lift(alpha, n), _lift(beta, n), _lift(beta, tau)
    Xi = (_lift(alpha, rho[1]) + g[:, None] * Bn) / D[:, None]
    tangential = l[:, None] * Xi
    if len(v):  # there xi stays; the facet's own rotation is taken out, so that friction exerts no couple
        Xi[v] = 0.0
        tangential[v] = _lift(alpha[v], tau[v]) + (g[v] / l[v])[:, None] * _lift(beta[v], facet_n[v])

    arc, metric, dmetric = master.arc(segment, xi)
    arrives = np.isnan(stick_point[at])
    elastic_arc = np.where(arrives, 0.0, master.along(arc - stick_point[at]))
    dl = Bt + _dot(tau, rho[2])[:, None] * Xi
    slip_gradient = l[:, None] * Xi + elastic_arc[:, None] * (
        dl / metric[:, None] - (l * dmetric / metric**2)[:, None] * Xi)
    if len(v):  # there the arc position stays, but not the metric
        slip_gradient[v] = (elastic_arc / metric)[v, None] * _lift(beta[v], facet_tau[v])
    slip_gradient[arrives] = 0.0
    second = (alpha, beta, gamma, rho, l, g, h, D, Xi, dl, Bn, Bt, v, facet_tau, facet_n)
    return Kinematics(dofs.reshape(G.shape), G, tangential, slip_gradient, n, tau, elastic_arc, l / metric, second)


def tangents(kinematics: Kinematics, update: Update, exact: bool) -> ndarray:
    """Tangents of the forces of points of unit weight, (n, m, m): eqs 14 to 16 or, unless exact, eqs 20 to 22."""
    G, T, S = kinematics.gap_gradient, kinematics.tangential, kinematics.slip_gradient
    dN, dT = (by_gap[:, None] * G + by_slip[:, None] * S for by_gap, by_slip in update.tangent)
    primary = _outer(G, dN) + _outer(T, dT)
    if not exact:
        return primary
    return primary + geometric_tangent(kinematics, *update.traction)


def geometric_tangent(kinematics: Kinematics, normal_traction: ndarray, tangential_traction: ndarray) -> ndarray:
    r"""``t_N dG/du + t_T d(l Xi)/du``: what turning and moving the contact frame adds, (n, m, m).

    These are the rotation and curvature parts of eqs 14 to 16, complete: with the terms in
    :math:`a - g h` that the paper drops.
    """
    alpha, beta, gamma, rho, l, g, h, D, Xi, dl, Bn, Bt, v, facet_tau, facet_n = kinematics.second
    n, tau, G = kinematics.normal, kinematics.tangent, kinematics.gap_gradient
    col = (slice(None), None)
    turn = Bn + h[col] * Xi  # l times the rate at which the normal turns towards -tau
    dG = -_outer(Bn, Xi) - _outer(_lift(alpha, tau) / l[col], turn)

    Br, Cn = _lift(beta, rho[1]), _lift(gamma, n)
    by_xi = _lift(alpha, rho[2]) - Br + g[col] * Cn
    dq = _node_by_node(alpha, beta) + _outer(by_xi, Xi) + _outer(Bn, G) - _outer((g / l)[col] * Bt, turn)
    dh = Cn - (_dot(tau, rho[2]) / l)[col] * turn + _dot(n, rho[3])[col] * Xi
    dD = 2 * Br + 2 * _dot(rho[1], rho[2])[col] * Xi - h[col] * G - g[col] * dh
    dXi = (dq - _outer(Xi, dD)) / D[:, None, None]
    K = (normal_traction[:, None, None] * dG
         + tangential_traction[:, None, None] * (_outer(Xi, dl) + l[:, None, None] * dXi))
    if len(v):  # around a vertex the normal follows the offset itself
        over_g, over_l = (1.0 / g[v])[col], (1.0 / l[v])[col]
        At, turned = _lift(alpha[v], tau[v]), _lift(beta[v], facet_n[v])
        along = _lift(beta[v], facet_tau[v])
        lever = _outer(turned, over_l * G[v] - g[v][col] * over_l**2 * along) \
            - g[v][:, None, None] * over_l[..., None]**2 * _outer(along, turned)
        K[v] = (normal_traction[v][:, None, None] * over_g[..., None] * _outer(At, At)
                + tangential_traction[v][:, None, None] * (lever - over_g[..., None] * _outer(G[v], At)))
    return K


def _outer(u: ndarray, v: ndarray) -> ndarray:
    return u[:, :, None] * v[:, None, :]


def _node_by_node(alpha: ndarray, beta: ndarray) -> ndarray:
    """``A^T B`` of two operators that act node by node, (n, 2 nodes, 2 nodes)."""
    n, k = alpha.shape
    result = np.zeros((n, 2 * k, 2 * k))
    result[:, 0::2, 0::2] = result[:, 1::2, 1::2] = _outer(alpha, beta)
    return result
