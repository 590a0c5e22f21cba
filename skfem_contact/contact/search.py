"""Closest point projection of points onto a surface (eqs 2, 3 and 17 of the paper)."""
from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy import ndarray

from ..surfaces.material_points import MaterialPoints
from ..surfaces.surface import Surface
from ..surfaces.vectors import across, determinant, dot, products, solve
from .neighbours import FROZEN, ON_FACET, Flat, Neighbours, neighbours, promising
from .sides import normals_at_joint, on_ends, on_sides, side_of_joint

#: Hysteresis: at a joint that turns by less than a degree, a point leaves the facet that it had in the accepted
#: state only beyond this share of its size, lest nodes that face each other chatter between two facets; one that is
#: frozen, whatever the angle, beyond the share FROZEN.
HYSTERESIS = 0.01
_STRAIGHT = np.cos(np.deg2rad(1.0))
_SMOOTH = 1e-12  # sine of the angle at a joint without one
_NEWTON_STEPS = 25
_ROUND_OFF = 16 * np.finfo(float).eps  # ... of xi where the coordinates are as large as the facet
_BEYOND = 0.3  # share of its width by which a curved facet is followed beyond its sides: farther than locked points go


class Projection(NamedTuple):
    """Closest points of ``n`` points, found or not.

    Attributes
    ----------
    found
        Whether contact is possible, (n,): not off the rim of a surface, and not deeper than an element or so.
    facet, xi
        Where the closest point lies, (n,) and (n, dim - 1).
    gap
        Signed distance, positive outside the body; inf where nothing is near.
    feature
        What the closest point lies on: 0 the facet; the number of its side, from 1, or one more than there are sides
        for a corner, where there is no orthogonal projection on either facet.  The ends of facets in the plane are
        sides.
    distance
        From the surface, no matter on which facet a point is to stay, (n,); inf where nothing is near.
    """

    found: ndarray
    facet: ndarray
    xi: ndarray
    gap: ndarray
    feature: ndarray
    distance: ndarray

    def take(self, chosen: ndarray) -> Projection:
        """Some of the points."""
        return Projection(*(part[chosen] for part in self))

    @property
    def closest(self) -> MaterialPoints:
        """Closest points where contact is possible."""
        return MaterialPoints(np.where(self.found, self.facet, -1), np.where(self.found[:, None], self.xi, np.nan))

    @property
    def vertex(self) -> ndarray:
        """Whether the closest point is an edge or a vertex of the surface."""
        return np.asarray(self.feature > 0)


def project(surface: Surface, nodes: ndarray, points: ndarray, depth: ndarray,
            previous: ndarray | None = None, frozen: ndarray | None = None, among: Neighbours | None = None
            ) -> Projection:
    """Closest points of points, (n, dim), on a surface whose nodes lie there, among its facets near them.

    Parameters
    ----------
    depth
        Largest penetration that counts as contact, (n,): what lies deeper belongs to the body's other side.
    previous, frozen
        Facets of the accepted state, (n,), -1 for none, and whether points are to stay there or without any, (n,).
    among
        Neighbours as far as they are known; points without any are not projected.
    """
    n = len(points)
    result = Projection(np.zeros(n, bool), np.zeros(n, int), np.zeros((n, surface.dim - 1)), np.full(n, np.inf),
                        np.zeros(n, int), np.full(n, np.inf))
    row, facet, *_ = among or neighbours(surface, nodes, points)[0]
    accepted = np.full(n, -1) if previous is None else previous
    held = np.zeros(n, bool) if frozen is None else frozen
    flat, r = Flat.of(surface, nodes), points[row]
    foot = flat.foot(surface.shape, facet, r)
    if surface.dim == 3:
        kept = promising(surface, nodes, flat, r, row, facet, foot) | (facet == accepted[row])
        row, facet, foot, r = row[kept], facet[kept], foot[kept], r[kept]
    foot = _foot(surface, nodes, r, facet, foot)
    beyond = surface.shape.beyond(foot)
    stays = _stays(surface, nodes, facet, beyond, facet == accepted[row], held[row])
    xi, feature, off = _on_facets(surface, nodes, r, facet, foot, beyond, stays)
    place = surface.at(facet, xi, nodes)
    offset = r - place.x[0]
    distance = np.sqrt(dot(offset, offset))
    np.minimum.at(result.distance, row, distance)
    best = _first_minimum(row, distance - _preferred(surface, facet, beyond, feature > 0, stays) * surface.size[facet])
    # what is closest decides: off the rim, or too deep, there is no contact with anything farther
    best = best[~off[best]]
    at = row[best]
    result.facet[at], result.xi[at] = facet[best], xi[best]
    above = _above(surface, nodes, facet[best], feature[best], xi[best], across(place.x[1][best]), offset[best])
    result.gap[at] = np.where(above, distance[best], -distance[best])
    result.feature[at] = feature[best]
    result.found[at] = (result.gap[at] >= -depth[at]) & ~(held & (accepted == -1))[at]
    return result


def merged(near: ndarray, found: Projection, projected: Callable[[ndarray], Projection]) -> Projection:
    """What was found for the near points, and what is found now for all others, as `projected` finds it."""
    if near.all():
        return found
    return Projection(*(np.where(near.reshape(-1, *(1,) * (a.ndim - 1)), a, b)
                        for a, b in zip(found, projected(~near), strict=True)))


def _foot(surface: Surface, nodes: ndarray, points: ndarray, facet: ndarray, xi: ndarray) -> ndarray:
    """Local coordinates of the orthogonal projection on every candidate: Newton from those on flat ones."""
    shape = surface.shape
    if shape.affine:
        return xi
    width = np.ptp(shape.corners, axis=0)
    low, high = shape.corners.min(axis=0) - _BEYOND * width, shape.corners.max(axis=0) + _BEYOND * width
    xi = np.clip(xi, low, high)
    exact = _ROUND_OFF * float(np.abs(nodes).max() / surface.size.min())
    left = np.arange(len(facet))
    for _ in range(_NEWTON_STEPS):
        step = _newton_step(surface.at(facet[left], xi[left], nodes, 2).x, points[left])
        xi[left] = np.clip(xi[left] + np.clip(step, -width / 4, width / 4), low, high)
        moves = (np.abs(step) >= exact) & (xi[left] > low) & (xi[left] < high)
        left = left[moves.any(axis=1)]
        if len(left) == 0:
            break
    return xi


def _newton_step(x: list[ndarray], points: ndarray) -> ndarray:
    """Newton's step towards the orthogonal projection; x as in :class:`Place`."""
    offset, metric = points - x[0], products(x[1], x[1])
    matrix = metric - np.einsum("nabc,nc->nab", x[2], offset)
    # beyond the centre of curvature the full Newton step runs away: fall back to the safe Gauss-Newton step
    share = 0.5 ** metric.shape[1]
    runs_away = (determinant(matrix) < share * determinant(metric)) | (matrix[:, 0, 0] <= 0.0)
    matrix[runs_away] = metric[runs_away] * (0.5 if metric.shape[1] == 1 else 1.0)
    return solve(matrix, np.einsum("nac,nc->na", x[1], offset))


def _on_facets(surface: Surface, nodes: ndarray, points: ndarray, facet: ndarray, foot: ndarray, beyond: ndarray,
               stays: ndarray) -> tuple[ndarray, ndarray, ndarray]:
    """Closest points on candidates: feet, or places on the sides beyond which they lie; as :func:`on_sides`."""
    reach = surface.reach[facet]
    limit = np.maximum(reach, np.maximum(2.0 * stays, ON_FACET))
    xi, feature, off = foot.copy(), np.zeros(len(facet), int), np.zeros(len(facet), bool)
    out = np.flatnonzero((beyond > limit).any(axis=1))
    on_them = on_ends if surface.dim == 2 else on_sides
    xi[out], feature[out], off[out] = on_them(surface, nodes, points[out], facet[out], beyond[out], reach[out])
    return xi, feature, off


def _above(surface: Surface, nodes: ndarray, facet: ndarray, feature: ndarray, xi: ndarray, normal: ndarray,
           offset: ndarray) -> ndarray:
    """Whether points lie outside the body, seen from their closest points with the facet's normal there."""
    if (bent := np.flatnonzero(feature)).size:  # all facets there tell what is outside
        normal[bent] = side_of_joint(surface, nodes, facet[bent], feature[bent], xi[bent])
    return np.asarray(dot(normal, offset) >= 0)


def _stays(surface: Surface, nodes: ndarray, facet: ndarray, beyond: ndarray, accepted: ndarray, frozen: ndarray
           ) -> ndarray:
    """Share of the facet's size by which candidates that are a point's accepted facet are preferred, by side."""
    share = np.where(frozen, FROZEN, HYSTERESIS)[:, None]
    stays = np.zeros(beyond.shape)
    pair, side = np.nonzero(accepted[:, None] & (np.abs(beyond) <= 2.0 * share) & ~surface.at_rim[facet])
    if len(pair):
        here, there = normals_at_joint(surface, nodes, facet[pair], side)
        turn = np.sqrt(((here - there) ** 2).sum(axis=1))
        bends = (dot(here, there) > _STRAIGHT) & (turn > _SMOOTH)
        stays[pair, side] = np.where(bends | frozen[pair], share[pair, 0], 0.0)
    return stays


def _preferred(surface: Surface, facet: ndarray, beyond: ndarray, outside: ndarray, stays: ndarray) -> ndarray:
    """Share of its size by which a candidate may be farther away than another one and is taken yet, (n,).

    Neither round-off nor the order of the search decides at a joint: the facet before it does.
    """
    tied = (np.abs(beyond) <= ON_FACET) | (outside[:, None] & (beyond > 0))
    ties = np.where(tied, ON_FACET * surface.rank[facet], 0.0)
    return np.asarray(np.where(outside[:, None], ties, np.maximum(stays, ties)).max(axis=1))


def _first_minimum(row: ndarray, value: ndarray) -> ndarray:
    """Position of the first smallest value of every row."""
    order = np.lexsort((value, row))
    first = np.ones(len(order), bool)
    first[1:] = row[order[1:]] != row[order[:-1]]
    return order[first]
