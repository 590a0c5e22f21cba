"""Sides and corners of facets: closest points there, and what is outside."""
from __future__ import annotations

import numpy as np
from numpy import ndarray

from ..surfaces.surface import Surface
from ..surfaces.vectors import dot, unit

_ON_SIDE = 1e-10  # last step along a side, that of Newton's method: the error is its square
_STEPS = 25  # of Newton's method, at most


def on_ends(surface: Surface, nodes: ndarray, points: ndarray, facet: ndarray, beyond: ndarray, reach: ndarray
            ) -> tuple[ndarray, ndarray, ndarray]:
    """As :func:`on_sides` in the plane, where a side is an end: the one beyond which the foot lies."""
    side = np.argmax(beyond - reach, axis=1)
    end = surface.shape.corners[side, 0]
    at = np.arange(len(facet))
    return (end * (1.0 + reach[at, side]))[:, None], side + 1, surface.at_rim[facet, side]


def on_sides(surface: Surface, nodes: ndarray, points: ndarray, facet: ndarray, beyond: ndarray, reach: ndarray
             ) -> tuple[ndarray, ndarray, ndarray]:
    """Closest points on the sides beyond which feet lie, in space; their features; whether that is off the rim.

    Both are by side, (n, n_sides): how far the feet lie beyond, and how far the facets go on: nothing but at the rim.
    """
    shape, n = surface.shape, len(facet)
    best, xi = np.full(n, np.inf), np.zeros((n, shape.dim))
    feature, off = np.zeros(n, int), np.zeros(n, bool)
    sides = len(shape.side_corners)
    for side in range(sides):
        if len(at := np.flatnonzero(beyond[:, side] > reach[:, side])) == 0:
            continue
        start = shape.corners[shape.side_corners[side, 0]] + reach[at, side, None] * (
            shape.outward[side] / (shape.outward[side] @ shape.outward[side]))
        ends = 0.5 * reach[at][:, [side - 1, (side + 1) % sides]] * [-1, 1] + [0, 1]
        s, place = _along_side(surface, nodes, points[at], facet[at], start, shape.along[side], ends)
        distance = np.sqrt(((points[at] - place) ** 2).sum(axis=1))
        nearer = distance < best[at]
        at, s, start, ends = at[nearer], s[nearer], start[nearer], ends[nearer]
        best[at], xi[at] = distance[nearer], start + s[:, None] * shape.along[side]
        over = s[:, None] == ends  # beyond an end of the side
        feature[at] = np.where(over.any(axis=1), sides + 1, side + 1)
        off[at] = surface.at_rim[facet[at], side] | (over & (ends != [0, 1])).any(axis=1)
    return xi, feature, off


def _along_side(surface: Surface, nodes: ndarray, points: ndarray, facet: ndarray, start: ndarray, along: ndarray,
                ends: ndarray) -> tuple[ndarray, ndarray]:
    """Share of the way along a side, between two ends, (n, 2), at which it is closest, and the place there."""
    s, left = np.full(len(facet), 0.5), np.arange(len(facet))
    for _ in range(_STEPS):
        if len(left) == 0:
            break
        place = surface.at(facet[left], start[left] + s[left, None] * along, nodes, 2)
        tangent, offset = along @ place.x[1], points[left] - place.x[0]
        slope, curvature = dot(tangent, tangent), dot(along @ (along @ place.x[2]), offset)
        step = dot(offset, tangent) / np.maximum(slope - curvature, 0.5 * slope)
        new = np.clip(s[left] + np.clip(step, -1.0, 1.0), *ends[left].T)
        moves, s[left] = np.abs(new - s[left]) > _ON_SIDE, new
        left = left[moves]
    return s, surface.at(facet, start + s[:, None] * along, nodes, 0).x[0]


def side_of_joint(surface: Surface, nodes: ndarray, facet: ndarray, feature: ndarray, xi: ndarray) -> ndarray:
    """Direction that tells outside from inside at sides and corners: the sum of the normals of all facets there.

    At corners in space each normal counts with the angle of its facet (Baerentzen and Aanaes, 2005).
    """
    sides = surface.neighbours.shape[1]
    normal = np.zeros((len(facet), surface.dim))
    at_side = feature <= sides
    here, there = normals_at_joint(surface, nodes, facet[at_side], feature[at_side] - 1)
    normal[at_side] = here + there
    if not at_side.all():
        corner = np.argmin(np.abs(xi[~at_side][:, None] - surface.shape.corners).sum(axis=2), axis=1)
        normal[~at_side] = _normals_at_corners(surface, nodes, surface.facets[facet[~at_side], corner])
    return normal


def _normals_at_corners(surface: Surface, nodes: ndarray, which: ndarray) -> ndarray:
    """Sums of the normals of all facets at nodes, times their angles there."""
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


def normals_at_joint(surface: Surface, nodes: ndarray, facet: ndarray, side: ndarray) -> tuple[ndarray, ndarray]:
    """Normals of facets and of those beyond their sides, in the middle of these; the facet's own beyond the rim."""
    shape = surface.shape
    neighbour = surface.neighbours[facet, side]
    other = 1 - side if surface.dim == 2 else np.argmax(surface.neighbours[neighbour] == facet[:, None], axis=1)
    neighbour, other = np.where(neighbour < 0, facet, neighbour), np.where(neighbour < 0, side, other)
    middle = shape.side_middles[np.concatenate((side, other))]
    normal = surface.at(np.concatenate((facet, neighbour)), middle, nodes).normal
    return normal[:len(facet)], normal[len(facet):]
