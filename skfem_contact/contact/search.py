"""Closest point projection of points onto a surface (eqs 2, 3 and 17 of the paper)."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy import ndarray

from ..surfaces.material_points import MaterialPoints
from ..surfaces.surface import Surface
from ..surfaces.vectors import across, determinant, dot, products, solve, unit
from .neighbours import FROZEN, ON_FACET, Flat, Neighbours, neighbours, promising

#: Hysteresis: at a joint that turns by less than a degree, a point leaves the facet that it had in
#: the accepted state only beyond this share of its size, or nodes that face each other would
#: chatter between two facets; one that is frozen, whatever the angle, beyond the share FROZEN.
HYSTERESIS = 0.01
_STRAIGHT = np.cos(np.deg2rad(1.0))
_SMOOTH = 1e-12  # sine of the angle at a joint without one
NEWTON_STEPS = 25
_ROUND_OFF = 16 * np.finfo(float).eps  # ... of xi where the coordinates are as large as the facet
# share of its width by which a curved facet is followed beyond its sides: farther than locked
# points go
_BEYOND = 0.3
_LAST_STEP = 1e-9  # of Newton's method on a facet: the error is its square
_ON_SIDE = 1e-10  # last step along a side, that of Newton's method: the error is its square
_ALONG_STEPS = 25  # of Newton's method, at most


class Projection(NamedTuple):
    """Closest points of ``n`` points.

    Attributes
    ----------
    found : ndarray, shape (n,)
        True where contact is possible: not off the rim of a surface, and not deeper than an element
        or so.
    facet, xi : ndarray, shapes (n,) and (n, dim - 1)
        Facet and local coordinates of the closest point.
    gap, distance : ndarray, shape (n,)
        Signed distance, positive outside the body; distance from the surface, whatever facet a
        point is to stay on; inf where nothing is near.
    feature : ndarray, shape (n,)
        0 on the facet; the number of its side, from 1, or one more than there are sides for a
        corner, where there is no orthogonal projection on either facet.  The ends of facets in the
        plane are sides.
    """

    found: ndarray
    facet: ndarray
    xi: ndarray
    gap: ndarray
    feature: ndarray
    distance: ndarray

    def take(self, chosen: ndarray) -> Projection:
        """Return some of the points."""
        return Projection(*(part[chosen] for part in self))

    @property
    def closest(self) -> MaterialPoints:
        """Closest points where contact is possible."""
        return MaterialPoints(
            np.where(self.found, self.facet, -1), np.where(self.found[:, None], self.xi, np.nan)
        )

    @property
    def vertex(self) -> ndarray:
        """True where the closest point is on an edge or a vertex of the surface."""
        return np.asarray(self.feature > 0)


def project(
    surface: Surface,
    nodes: ndarray,
    points: ndarray,
    depth: ndarray,
    previous: ndarray | None = None,
    frozen: ndarray | None = None,
    among: Neighbours | None = None,
) -> Projection:
    """Return closest points of points, shape (n, dim), on a surface at present coordinates of its
    nodes.

    Parameters
    ----------
    depth : ndarray, shape (n,)
        Largest penetration that counts as contact: a deeper point belongs to the body's other side.
    previous, frozen : ndarray, shape (n,), optional
        Facets of the accepted state, -1 for none, and True for points that stay there or without
        any.
    among : Neighbours, optional
        Candidates; points without any are not projected.
    """
    n = len(points)
    result = Projection(
        np.zeros(n, bool),
        np.zeros(n, int),
        np.zeros((n, surface.dim - 1)),
        np.full(n, np.inf),
        np.zeros(n, int),
        np.full(n, np.inf),
    )
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
    mapping = surface.at(facet, xi, nodes)
    offset = r - mapping.x[0]
    distance = np.sqrt(dot(offset, offset))
    np.minimum.at(result.distance, row, distance)
    best = _first_minimum(
        row, distance - _preferred(surface, facet, beyond, feature > 0, stays) * surface.size[facet]
    )
    # what is closest decides: off the rim, or too deep, there is no contact with anything farther
    best = best[~off[best]]
    at = row[best]
    result.facet[at], result.xi[at] = facet[best], xi[best]
    above = _above(
        surface,
        nodes,
        facet[best],
        feature[best],
        xi[best],
        across(mapping.x[1][best]),
        offset[best],
    )
    result.gap[at] = np.where(above, distance[best], -distance[best])
    result.feature[at] = feature[best]
    result.found[at] = (result.gap[at] >= -depth[at]) & ~(held & (accepted == -1))[at]
    return result


def merged(
    near: ndarray, found: Projection, projected: Callable[[ndarray], Projection]
) -> Projection:
    """Return the projection of the near points, joined with a new projection of all others."""
    if near.all():
        return found
    return Projection(
        *(
            np.where(near.reshape(-1, *(1,) * (a.ndim - 1)), a, b)
            for a, b in zip(found, projected(~near), strict=True)
        )
    )


def _foot(
    surface: Surface, nodes: ndarray, points: ndarray, facet: ndarray, xi: ndarray
) -> ndarray:
    shape = surface.shape
    if shape.affine:
        return xi
    width = np.ptp(shape.corners, axis=0)
    low, high = (
        shape.corners.min(axis=0) - _BEYOND * width,
        shape.corners.max(axis=0) + _BEYOND * width,
    )
    xi = np.clip(xi, low, high)
    exact = _ROUND_OFF * float(np.abs(nodes).max() / surface.size.min())
    left = np.arange(len(facet))
    for _ in range(NEWTON_STEPS):
        step, quadratic = _newton_step(surface.at(facet[left], xi[left], nodes, 2).x, points[left])
        xi[left] = np.clip(xi[left] + np.clip(step, -width / 4, width / 4), low, high)
        last = np.where(quadratic, max(exact, _LAST_STEP), exact)[:, None]
        moves = (np.abs(step) >= last) & (xi[left] > low) & (xi[left] < high)
        left = left[moves.any(axis=1)]
        if len(left) == 0:
            break
    return xi


def _newton_step(x: list[ndarray], points: ndarray) -> tuple[ndarray, ndarray]:
    """Return steps, and True for those of Newton's method, which converge quadratically."""
    offset, metric = points - x[0], products(x[1], x[1])
    matrix = metric - np.einsum("nabc,nc->nab", x[2], offset)
    # beyond the centre of curvature the full Newton step runs away: fall back to the safe
    # Gauss-Newton step
    share = 0.5 ** metric.shape[1]
    runs_away = (determinant(matrix) < share * determinant(metric)) | (matrix[:, 0, 0] <= 0.0)
    matrix[runs_away] = metric[runs_away] * (0.5 if metric.shape[1] == 1 else 1.0)
    return solve(matrix, np.einsum("nac,nc->na", x[1], offset)), ~runs_away


def _on_facets(
    surface: Surface,
    nodes: ndarray,
    points: ndarray,
    facet: ndarray,
    foot: ndarray,
    beyond: ndarray,
    stays: ndarray,
) -> tuple[ndarray, ndarray, ndarray]:
    """Return closest points on candidates: feet, or points on the sides, see :func:`on_sides`."""
    reach = surface.reach[facet]
    limit = np.maximum(reach, np.maximum(2.0 * stays, ON_FACET))
    xi, feature, off = foot.copy(), np.zeros(len(facet), int), np.zeros(len(facet), bool)
    out = np.flatnonzero((beyond > limit).any(axis=1))
    on_them = on_ends if surface.dim == 2 else on_sides
    xi[out], feature[out], off[out] = on_them(
        surface, nodes, points[out], facet[out], beyond[out], reach[out]
    )
    return xi, feature, off


def _above(
    surface: Surface,
    nodes: ndarray,
    facet: ndarray,
    feature: ndarray,
    xi: ndarray,
    normal: ndarray,
    offset: ndarray,
) -> ndarray:
    if (bent := np.flatnonzero(feature)).size:  # all facets there decide what is outside
        normal[bent] = side_of_joint(surface, nodes, facet[bent], feature[bent], xi[bent])
    return np.asarray(dot(normal, offset) >= 0)


def _stays(
    surface: Surface,
    nodes: ndarray,
    facet: ndarray,
    beyond: ndarray,
    accepted: ndarray,
    frozen: ndarray,
) -> ndarray:
    """Return the share of the facet's size by which a point's accepted facet is preferred, by
    side.
    """
    share = np.where(frozen, FROZEN, HYSTERESIS)[:, None]
    stays = np.zeros(beyond.shape)
    near = accepted[:, None] & (np.abs(beyond) <= 2.0 * share) & ~surface.at_rim[facet]
    stays[near & frozen[:, None]] = FROZEN
    pair, side = np.nonzero(near & ~frozen[:, None])
    if len(pair):
        here, there = normals_at_joint(surface, nodes, facet[pair], side)
        turn = np.sqrt(((here - there) ** 2).sum(axis=1))
        bends = (dot(here, there) > _STRAIGHT) & (turn > _SMOOTH)
        stays[pair, side] = np.where(bends, HYSTERESIS, 0.0)
    return stays


def _preferred(
    surface: Surface, facet: ndarray, beyond: ndarray, outside: ndarray, stays: ndarray
) -> ndarray:
    """Return the share of its size by which a candidate may be farther away than another one and is
    still taken.

    So neither round-off nor the order of the search decides at a joint: the facet before it does.
    """
    tied = (np.abs(beyond) <= ON_FACET) | (outside[:, None] & (beyond > 0))
    ties = np.where(tied, ON_FACET * surface.rank[facet], 0.0)
    return np.asarray(np.where(outside[:, None], ties, np.maximum(stays, ties)).max(axis=1))


def _first_minimum(row: ndarray, value: ndarray) -> ndarray:
    order = np.lexsort((value, row))
    first = np.ones(len(order), bool)
    first[1:] = row[order[1:]] != row[order[:-1]]
    return order[first]


# -- sides and corners of facets
# --------------------------------------------------------------------------------


def on_ends(
    surface: Surface,
    nodes: ndarray,
    points: ndarray,
    facet: ndarray,
    beyond: ndarray,
    reach: ndarray,
) -> tuple[ndarray, ndarray, ndarray]:
    """Return the ends in the plane beyond which feet lie, like :func:`on_sides`."""
    side = np.argmax(beyond - reach, axis=1)
    end = surface.shape.corners[side, 0]
    at = np.arange(len(facet))
    return (end * (1.0 + reach[at, side]))[:, None], side + 1, surface.at_rim[facet, side]


def on_sides(
    surface: Surface,
    nodes: ndarray,
    points: ndarray,
    facet: ndarray,
    beyond: ndarray,
    reach: ndarray,
) -> tuple[ndarray, ndarray, ndarray]:
    """Return closest points on the sides beyond which feet lie, their features, and True if off the
    rim.
    """
    shape, n = surface.shape, len(facet)
    best, xi = np.full(n, np.inf), np.zeros((n, shape.dim))
    feature, off = np.zeros(n, int), np.zeros(n, bool)
    sides = len(shape.side_corners)
    for side in range(sides):
        if len(at := np.flatnonzero(beyond[:, side] > reach[:, side])) == 0:
            continue
        start = shape.corners[shape.side_corners[side, 0]] + reach[at, side, None] * (
            shape.outward[side] / (shape.outward[side] @ shape.outward[side])
        )
        ends = 0.5 * reach[at][:, [side - 1, (side + 1) % sides]] * [-1, 1] + [0, 1]
        s, closest = _along_side(
            surface, nodes, points[at], facet[at], start, shape.along[side], ends
        )
        distance = np.sqrt(((points[at] - closest) ** 2).sum(axis=1))
        nearer = distance < best[at]
        at, s, start, ends = at[nearer], s[nearer], start[nearer], ends[nearer]
        best[at], xi[at] = distance[nearer], start + s[:, None] * shape.along[side]
        over = s[:, None] == ends  # beyond an end of the side
        feature[at] = np.where(over.any(axis=1), sides + 1, side + 1)
        off[at] = surface.at_rim[facet[at], side] | (over & (ends != [0, 1])).any(axis=1)
    return xi, feature, off


def _along_side(
    surface: Surface,
    nodes: ndarray,
    points: ndarray,
    facet: ndarray,
    start: ndarray,
    along: ndarray,
    ends: ndarray,
) -> tuple[ndarray, ndarray]:
    s, left = np.full(len(facet), 0.5), np.arange(len(facet))
    for _ in range(_ALONG_STEPS):
        if len(left) == 0:
            break
        mapping = surface.at(facet[left], start[left] + s[left, None] * along, nodes, 2)
        tangent, offset = along @ mapping.x[1], points[left] - mapping.x[0]
        slope, curvature = dot(tangent, tangent), dot(along @ (along @ mapping.x[2]), offset)
        step = dot(offset, tangent) / np.maximum(slope - curvature, 0.5 * slope)
        new = np.clip(s[left] + np.clip(step, -1.0, 1.0), *ends[left].T)
        moves, s[left] = np.abs(new - s[left]) > _ON_SIDE, new
        left = left[moves]
    return s, surface.at(facet, start + s[:, None] * along, nodes, 0).x[0]


def side_of_joint(
    surface: Surface, nodes: ndarray, facet: ndarray, feature: ndarray, xi: ndarray
) -> ndarray:
    """Return the direction from inside to outside at sides and corners: the sum of all normals
    there.

    At corners in space each normal counts with the angle of its facet (Baerentzen and Aanaes,
    2005).
    """
    sides = surface.neighbours.shape[1]
    normal = np.zeros((len(facet), surface.dim))
    at_side = feature <= sides
    here, there = normals_at_joint(surface, nodes, facet[at_side], feature[at_side] - 1)
    normal[at_side] = here + there
    if not at_side.all():
        corner = np.argmin(
            np.abs(xi[~at_side][:, None] - surface.shape.corners).sum(axis=2), axis=1
        )
        normal[~at_side] = _normals_at_corners(
            surface, nodes, surface.facets[facet[~at_side], corner]
        )
    return normal


def _normals_at_corners(surface: Surface, nodes: ndarray, which: ndarray) -> ndarray:
    n = len(surface.shape.corners)
    facet, corner = np.nonzero(np.isin(surface.facets[:, :n], which))
    node = surface.facets[facet, corner]
    before = nodes[surface.facets[facet, corner - 1]] - nodes[node]
    after = nodes[surface.facets[facet, (corner + 1) % n]] - nodes[node]
    angle = np.arccos(np.clip(dot(unit(before), unit(after)), -1.0, 1.0))
    normal = surface.at(facet, surface.shape.corners[corner], nodes).normal
    total = np.zeros((len(surface.nodes), 3))
    np.add.at(total, node, angle[:, None] * normal)
    return total[which]


def normals_at_joint(
    surface: Surface, nodes: ndarray, facet: ndarray, side: ndarray
) -> tuple[ndarray, ndarray]:
    """Return normals of facets and of their neighbours at the side's middle; the own one at a
    rim.
    """
    shape = surface.shape
    neighbour = surface.neighbours[facet, side]
    other = (
        1 - side
        if surface.dim == 2
        else np.argmax(surface.neighbours[neighbour] == facet[:, None], axis=1)
    )
    neighbour, other = (
        np.where(neighbour < 0, facet, neighbour),
        np.where(neighbour < 0, side, other),
    )
    middle = shape.side_middles[np.concatenate((side, other))]
    normal = surface.at(np.concatenate((facet, neighbour)), middle, nodes).normal
    return normal[: len(facet)], normal[len(facet) :]
