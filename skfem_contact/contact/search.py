"""Closest point projection of points onto a surface (eqs 2, 3 and 17 of the paper)."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy import ndarray

from ..arrays import max_abs
from ..surfaces.material_points import MaterialPoints
from ..surfaces.surface import Surface
from ..surfaces.vectors import across, determinant, dot, products, solve, unit
from .fold import Fold
from .neighbours import FROZEN, ON_FACET, Flat, Pairs, neighbours, promising

#: Hysteresis: at a joint that turns by less than a degree, a point leaves the facet that it had in
#: the accepted state only beyond this share of its size, or nodes that face each other would
#: chatter between two facets; one that is frozen, whatever the angle, beyond the share FROZEN.
HYSTERESIS = 0.01
_STRAIGHT = np.cos(np.deg2rad(1.0))
#: Share of a facet's size by which a held point may leave it in an increment.
HELD = 0.25
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
    among: Pairs | None = None,
    held: ndarray | None = None,
    fold: Fold | None = None,
    own_facets: ndarray | None = None,
) -> Projection:
    """Return closest points of points (n, dim) on a surface at present coordinates of its nodes.

    Parameters
    ----------
    depth : ndarray, shape (n,)
        Largest penetration that counts as contact: a deeper point belongs to the body's other side.
    previous, frozen : ndarray, shape (n,), optional
        Facets of the accepted state, -1 for none, and True for points that stay there or without
        any.
    among : Pairs, optional
        Candidates; points without any are not projected.
    held : ndarray, shape (n,), optional
        True for points that leave their facets between increments.
    fold, own_facets : Fold and ndarray, shape (n,), optional
        Neighbours on a surface that touches itself, and the facets on which the points lie.
    """
    n = len(points)
    accepted = np.full(n, -1) if previous is None else previous
    if frozen is None:
        frozen = np.zeros(n, bool)
    if among is None:
        among = neighbours(surface, nodes, points)[0].pairs

    # Project the point of each pair (point, facet) orthogonally, on facets that are close enough
    row = among.point
    facet = among.facet
    r = points[row]
    flat = Flat.of(surface, nodes)
    foot = flat.foot(surface.shape, facet, r)
    if surface.dim == 3:
        kept = promising(
            surface,
            nodes,
            flat,
            r,
            row,
            facet,
            foot,
        ) | (facet == accepted[row])
        row = row[kept]
        facet = facet[kept]
        foot = foot[kept]
        r = r[kept]
    foot = _foot(surface, nodes, r, facet, foot)

    # Move feet beyond a side to the closest point on that side
    beyond = surface.shape.beyond(foot)
    own = facet == accepted[row]
    stays = _stays(surface, nodes, facet, beyond, own, frozen[row])
    if held is not None:
        keeps = (own & held[row])[:, None] & (beyond <= 2.0 * HELD)
        stays[keeps] = HELD
    xi, feature, off = _on_facets(
        surface,
        nodes,
        r,
        facet,
        foot,
        beyond,
        stays,
    )
    if fold is not None and own_facets is not None:
        off |= fold.beside(surface, own_facets[row], facet, feature)
    mapping = surface.at(facet, xi, nodes)
    offset = r - mapping.x[0]
    distance = np.sqrt(dot(offset, offset))

    # Choose the closest candidate of each point; off the rim, or too deep, it has no contact with
    # anything farther
    preferred = _preferred(surface, facet, beyond, feature > 0, stays)
    best = _first_minimum(row, distance - preferred * surface.size[facet])
    best = best[~off[best]]
    above = _above(
        surface,
        nodes,
        facet=facet[best],
        feature=feature[best],
        xi=xi[best],
        normal=across(mapping.x[1][best]),
        offset=offset[best],
    )

    result = Projection(
        found=np.zeros(n, bool),
        facet=np.zeros(n, int),
        xi=np.zeros((n, surface.dim - 1)),
        gap=np.full(n, np.inf),
        feature=np.zeros(n, int),
        distance=np.full(n, np.inf),
    )
    indices = row[best]
    gap = np.where(above, distance[best], -distance[best])
    lost = frozen & (accepted == -1)
    result.facet[indices] = facet[best]
    result.xi[indices] = xi[best]
    result.gap[indices] = gap
    result.feature[indices] = feature[best]
    result.found[indices] = (gap >= -depth[indices]) & ~lost[indices]
    if fold is not None:
        # A deeper point of a thin wall has found the back of its own wall
        result.gap[~result.found] = np.inf
    np.minimum.at(result.distance, row, distance)
    return result


def merged(
    near: ndarray, found: Projection, projected: Callable[[ndarray], Projection]
) -> Projection:
    """Return the projection of the near points, joined with a new projection of all others."""
    if near.all():
        return found
    parts = []
    for known, new in zip(found, projected(~near), strict=True):
        mask = near[:, None] if known.ndim == 2 else near
        parts.append(np.where(mask, known, new))
    return Projection(*parts)


def _foot(
    surface: Surface,
    nodes: ndarray,
    points: ndarray,
    facet: ndarray,
    xi: ndarray,
) -> ndarray:
    """Return orthogonal projections on facets by Newton's method from xi (n, dim - 1), eq. 2.

    Facets of straight sides need none: eq. 17.
    """
    shape = surface.shape
    if shape.affine:
        return xi
    # Steps remain near the facet, where its map can be inverted.
    corners = shape.corners
    width = np.ptp(corners, axis=0)
    low = corners.min(axis=0) - _BEYOND * width
    high = corners.max(axis=0) + _BEYOND * width
    xi = np.clip(xi, low, high)
    exact = _ROUND_OFF * float(max_abs(nodes) / surface.size.min())
    # Iterate at the points that still move.
    remaining = np.arange(len(facet))
    for _ in range(NEWTON_STEPS):
        x = surface.at(facet[remaining], xi[remaining], nodes, 2).x
        step, quadratic = _newton_step(x, points[remaining])
        limited = np.clip(step, -width / 4, width / 4)
        new = np.clip(xi[remaining] + limited, low, high)
        xi[remaining] = new
        last = np.where(quadratic, max(exact, _LAST_STEP), exact)[:, None]
        moves = (np.abs(step) >= last) & (new > low) & (new < high)
        remaining = remaining[moves.any(axis=1)]
        if len(remaining) == 0:
            break
    return xi


def _newton_step(x: list[ndarray], points: ndarray) -> tuple[ndarray, ndarray]:
    """Return steps, and True for Newton's steps, which converge quadratically."""
    rho, a, bend = x
    offset = points - rho
    metric = products(a, a)
    matrix = metric - np.einsum("nabc,nc->nab", bend, offset)

    # Beyond the centre of curvature the full Newton step runs away: take the Gauss-Newton step
    is_line = metric.shape[1] == 1
    share = 0.25
    if is_line:
        share = 0.5
    runs_away = (determinant(matrix) < share * determinant(metric)) | (matrix[:, 0, 0] <= 0.0)
    matrix[runs_away] = metric[runs_away] * (0.5 if is_line else 1.0)
    step = solve(matrix, np.einsum("nac,nc->na", a, offset))
    return step, ~runs_away


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
    out = np.flatnonzero((beyond > limit).any(axis=1))
    if surface.dim == 2:
        moved = on_ends(surface, facet[out], beyond[out], reach[out])
    else:
        moved = on_sides(surface, nodes, points[out], facet[out], beyond[out], reach[out])
    xi = foot.copy()
    feature = np.zeros(len(facet), int)
    off = np.zeros(len(facet), bool)
    xi[out], feature[out], off[out] = moved
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
    """Return a mask of points outside the body; at sides and corners all facets decide."""
    bent = np.flatnonzero(feature)
    if bent.size:
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
    """Return the share of the size by which an accepted facet is preferred, by side, (n, sides)."""
    frozen = frozen[:, None]
    share = np.where(frozen, FROZEN, HYSTERESIS)
    near = accepted[:, None] & (np.abs(beyond) <= 2.0 * share) & ~surface.at_rim[facet]
    stays = np.zeros(beyond.shape)
    stays[near & frozen] = FROZEN
    pair, side = np.nonzero(near & ~frozen)
    if len(pair):
        own, neighbour = normals_at_joint(surface, nodes, facet[pair], side)
        turn = np.sqrt(((own - neighbour) ** 2).sum(axis=1))
        bends = (dot(own, neighbour) > _STRAIGHT) & (turn > _SMOOTH)
        stays[pair, side] = np.where(bends, HYSTERESIS, 0.0)
    return stays


def _preferred(
    surface: Surface,
    facet: ndarray,
    beyond: ndarray,
    outside: ndarray,
    stays: ndarray,
) -> ndarray:
    """Return the share of its size by which a taken candidate may be farther away than another.

    So neither round-off nor the order of the search decides at a joint: the facet before it does.
    """
    outside = outside[:, None]
    tied = (np.abs(beyond) <= ON_FACET) | (outside & (beyond > 0))
    ties = np.where(tied, ON_FACET * surface.rank[facet], 0.0)
    largest = np.where(outside, ties, np.maximum(stays, ties))
    return np.asarray(largest.max(axis=1))


def _first_minimum(row: ndarray, value: ndarray) -> ndarray:
    """Return the index of the smallest value of each row, in the order of rows."""
    order = np.lexsort((value, row))
    sorted_rows = row[order]
    first = np.ones(len(order), bool)
    first[1:] = sorted_rows[1:] != sorted_rows[:-1]
    return order[first]


# Sides and corners of facets


def on_ends(
    surface: Surface,
    facet: ndarray,
    beyond: ndarray,
    reach: ndarray,
) -> tuple[ndarray, ndarray, ndarray]:
    """Return the ends in the plane beyond which feet lie, like :func:`on_sides`."""
    side = np.argmax(beyond - reach, axis=1)
    end = surface.shape.corners[side, 0]
    xi = end * (1.0 + reach[np.arange(len(facet)), side])
    return xi[:, None], side + 1, surface.at_rim[facet, side]


def on_sides(
    surface: Surface,
    nodes: ndarray,
    points: ndarray,
    facet: ndarray,
    beyond: ndarray,
    reach: ndarray,
) -> tuple[ndarray, ndarray, ndarray]:
    """Return closest points on the sides beyond which feet lie, features, and True off the rim."""
    shape = surface.shape
    n = len(facet)
    n_sides = len(shape.side_corners)
    best = np.full(n, np.inf)
    xi = np.zeros((n, shape.dim))
    feature = np.zeros(n, int)
    off = np.zeros(n, bool)
    for side in range(n_sides):
        indices = np.flatnonzero(beyond[:, side] > reach[:, side])
        if len(indices) == 0:
            continue

        # Extend the side, and its ends, by the reach of the surface beyond its rim
        along = shape.along[side]
        outward = shape.outward[side] / (shape.outward[side] @ shape.outward[side])
        start = shape.corners[shape.side_corners[side, 0]] + reach[indices, side, None] * outward
        adjacent = [side - 1, (side + 1) % n_sides]
        ends = 0.5 * reach[indices][:, adjacent] * [-1, 1] + [0, 1]

        # Keep the closest point of this side where it is nearer than on the sides before
        r = points[indices]
        s, closest = _along_side(
            surface,
            nodes,
            r,
            facet[indices],
            start,
            along,
            ends,
        )
        distance = np.sqrt(((r - closest) ** 2).sum(axis=1))
        nearer = distance < best[indices]
        indices = indices[nearer]
        s = s[nearer]
        ends = ends[nearer]
        best[indices] = distance[nearer]
        xi[indices] = start[nearer] + s[:, None] * along
        at_end = s[:, None] == ends
        feature[indices] = np.where(at_end.any(axis=1), n_sides + 1, side + 1)
        beyond_rim = (at_end & (ends != [0, 1])).any(axis=1)
        off[indices] = surface.at_rim[facet[indices], side] | beyond_rim
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
    """Return shares s of a side at the closest points, by Newton's method, and the points."""
    # Minimise |x - rho(s)|^2 along the side, from its middle.
    s = np.full(len(facet), 0.5)
    remaining = np.arange(len(facet))
    for _ in range(_ALONG_STEPS):
        if len(remaining) == 0:
            break
        before = s[remaining]
        xi = start[remaining] + before[:, None] * along
        rho, a, bend = surface.at(facet[remaining], xi, nodes, 2).x
        tangent = along @ a
        offset = points[remaining] - rho
        slope = dot(tangent, tangent)
        curvature = dot(along @ (along @ bend), offset)
        step = dot(offset, tangent) / np.maximum(slope - curvature, 0.5 * slope)
        new = np.clip(before + np.clip(step, -1.0, 1.0), *ends[remaining].T)
        s[remaining] = new
        remaining = remaining[np.abs(new - before) > _ON_SIDE]
    return s, surface.at(facet, start + s[:, None] * along, nodes, 0).x[0]


def side_of_joint(
    surface: Surface,
    nodes: ndarray,
    facet: ndarray,
    feature: ndarray,
    xi: ndarray,
) -> ndarray:
    """Return the outward direction at sides and corners: the sum of all normals.

    At corners in space each normal counts with the angle of its facet (Baerentzen and Aanaes,
    2005).
    """
    n_sides = surface.neighbours.shape[1]
    normal = np.zeros((len(facet), surface.dim))
    at_side = feature <= n_sides
    own, neighbour = normals_at_joint(surface, nodes, facet[at_side], feature[at_side] - 1)
    normal[at_side] = own + neighbour
    if at_side.all():
        return normal
    at_corner = ~at_side
    apart = np.abs(xi[at_corner][:, None] - surface.shape.corners).sum(axis=2)
    node = surface.facets[facet[at_corner], np.argmin(apart, axis=1)]
    normal[at_corner] = _normals_at_corners(surface, nodes, node)
    return normal


def _normals_at_corners(surface: Surface, nodes: ndarray, which: ndarray) -> ndarray:
    """Return sums of the facets' normals times their angles at some corner nodes, shape (n, 3)."""
    n = len(surface.shape.corners)
    facet, corner = np.nonzero(np.isin(surface.facets[:, :n], which))
    node = surface.facets[facet, corner]
    before = nodes[surface.facets[facet, corner - 1]] - nodes[node]
    after = nodes[surface.facets[facet, (corner + 1) % n]] - nodes[node]
    cosine = dot(unit(before), unit(after))
    angle = np.arccos(np.clip(cosine, -1.0, 1.0))
    normal = surface.at(facet, surface.shape.corners[corner], nodes).normal
    total = np.zeros((len(surface.nodes), 3))
    np.add.at(total, node, angle[:, None] * normal)
    return total[which]


def normals_at_joint(
    surface: Surface,
    nodes: ndarray,
    facet: ndarray,
    side: ndarray,
) -> tuple[ndarray, ndarray]:
    """Return normals of facets and their neighbours at a side's middle; the own one at a rim."""
    neighbour = surface.neighbours[facet, side]
    if surface.dim == 2:
        other_side = 1 - side
    else:
        other_side = np.argmax(surface.neighbours[neighbour] == facet[:, None], axis=1)
    alone = neighbour < 0
    neighbour = np.where(alone, facet, neighbour)
    other_side = np.where(alone, side, other_side)
    middle = surface.shape.side_middles[np.concatenate((side, other_side))]
    normal = surface.at(np.concatenate((facet, neighbour)), middle, nodes).normal
    return normal[: len(facet)], normal[len(facet) :]
