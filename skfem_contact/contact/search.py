"""Closest point projection of points onto a surface (eqs 2, 3 and 17 of the paper)."""
from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy import ndarray

from .neighbours import Neighbours, neighbours
from .surface import Surface

#: Hysteresis: at a joint that turns by less than a degree, a point leaves the segment that it had in the accepted
#: state only beyond this share of its length, lest nodes that face each other chatter between two segments.
HYSTERESIS = 0.01
#: ... and one that is frozen, whatever the angle, beyond this share.
FROZEN = 0.25
_STRAIGHT = np.cos(np.deg2rad(1.0))
_SMOOTH = 1e-12  # sine of the angle at a joint without one
_ON_FACET = 1e-9  # round-off of xi at a joint
_NEWTON_STEPS = 25
_ROUND_OFF = 16 * np.finfo(float).eps  # ... of xi where the coordinates are as large as the segment


class Projection(NamedTuple):
    """Closest points of ``n`` points, found or not.

    Attributes
    ----------
    found
        Whether contact is possible, (n,): not off the ends of an open chain, and not deeper than an element or so.
    segment, xi
        Where the closest point lies.
    gap
        Signed distance, positive outside the body; inf off the ends of an open chain.
    vertex
        Whether the closest point is a vertex without an orthogonal projection on either side of it.
    """

    found: ndarray
    segment: ndarray
    xi: ndarray
    gap: ndarray
    vertex: ndarray


def project(surface: Surface, nodes: ndarray, points: ndarray, depth: ndarray,
            previous: ndarray | None = None, frozen: ndarray | None = None, among: Neighbours | None = None
            ) -> Projection:
    """Closest points on the surface, among all of its segments.

    Parameters
    ----------
    surface, nodes
        The surface and the current coordinates of its nodes.
    points
        Points to project, (n, 2).
    depth
        Largest penetration that counts as contact, (n,): what lies deeper belongs to the body's other side.
    previous
        Segments of the accepted state, (n,), -1 where there was none.
    frozen
        Whether points are to stay on these segments, or without any, (n,).
    among
        Neighbours of the points as far as they are known; points without any are not projected.
    """
    n = len(points)
    result = Projection(np.zeros(n, bool), np.zeros(n, int), np.zeros(n), np.full(n, np.inf), np.zeros(n, bool))
    row, segment, _ = among or neighbours(surface, nodes, points)[0]
    ends = _Ends.of(surface, nodes)
    foot = _foot(surface, nodes, ends, points[row], segment)
    off_end = _off_end(surface, segment, foot)
    accepted = np.full(n, -1) if previous is None else previous
    held = np.zeros(n, bool) if frozen is None else frozen
    here, there = ends.at_joint(surface, segment, foot)
    stays = _stays(here, there, foot, segment == accepted[row], held[row])
    outside = np.abs(foot) - 1.0 > np.where(off_end, 2.0 * surface.extension, np.maximum(2.0 * stays, _ON_FACET))
    reached = np.where(off_end, 1.0 + 2.0 * surface.extension, 1.0)
    xi = np.where(outside, np.minimum(np.maximum(foot, -reached), reached), foot)
    rho = surface.curve(segment, xi, nodes, 1)[1]
    offset = points[row] - rho[0]
    distance = np.hypot(offset[:, 0], offset[:, 1])
    vertex = outside & ~off_end
    # at a vertex, both segments there tell what is outside
    side = np.where(vertex, _left(here + there, offset), _left(rho[1], offset))
    gap = np.where(side >= 0, distance, -distance)
    # neither round-off nor the order of the search decides at a joint: the segment before it does
    ties = np.where(np.abs(foot - 1.0) <= _ON_FACET, _ON_FACET, 0.0)
    preferred = np.where(outside, 0.0, np.maximum(stays, ties)) * surface.length[segment]
    best = _first_minimum(row, distance - preferred)
    # what is closest decides: off the end of the chain, or too deep, there is no contact with anything farther
    best = best[~(outside & off_end)[best]]
    at = row[best]
    result.segment[at], result.xi[at], result.gap[at] = segment[best], xi[best], gap[best]
    result.vertex[at], result.found[at] = vertex[best], (gap[best] >= -depth[at]) & ~(held & (accepted == -1))[at]
    return result


def merged(near: ndarray, found: Projection, projected: Callable[[ndarray], Projection]) -> Projection:
    """What was found for the near points, and what is found now for all others, as `projected` finds it."""
    if near.all():
        return found
    return Projection(*(np.where(near, *both) for both in zip(found, projected(~near), strict=True)))


def _left(tangent: ndarray, offset: ndarray) -> ndarray:
    return tangent[:, 0] * offset[:, 1] - tangent[:, 1] * offset[:, 0]


class _Ends(NamedTuple):
    """Ends of the segments, their places and unit tangents there, (2, n_segments, 2)."""

    place: ndarray
    tangent: ndarray

    @classmethod
    def of(cls, surface: Surface, nodes: ndarray) -> _Ends:
        place, tangent = surface.ends(nodes)
        return cls(place, tangent / np.hypot(tangent[..., 0], tangent[..., 1])[..., None])

    def at_joint(self, surface: Surface, segment: ndarray, xi: ndarray) -> tuple[ndarray, ndarray]:
        """Tangents of a segment and its neighbour at the joint on the side of xi."""
        m, side = len(surface.segments), (xi > 0).astype(int)
        neighbour = segment + 2 * side - 1
        neighbour = neighbour % m if surface.closed else np.minimum(np.maximum(neighbour, 0), m - 1)
        return self.tangent[side, segment], self.tangent[1 - side, neighbour]


def _foot(surface: Surface, nodes: ndarray, ends: _Ends, points: ndarray, segment: ndarray) -> ndarray:
    """Local coordinate of the orthogonal projection on every candidate: eq. 17 on the chord, then Newton."""
    first, last = ends.place[:, segment]
    chord = last - first
    xi = np.einsum("nc,nc->n", 2 * points - first - last, chord) / np.einsum("nc,nc->n", chord, chord)
    if surface.straight:
        return xi
    xi = np.clip(xi, -1.2, 1.2)
    exact = _ROUND_OFF * float(np.abs(nodes).max() / surface.length.min())
    for _ in range(_NEWTON_STEPS):
        rho = surface.curve(segment, xi, nodes, 2)[1]
        offset = points - rho[0]
        slope = np.einsum("nc,nc->n", rho[1], rho[1])
        curvature = np.einsum("nc,nc->n", offset, rho[2])
        # beyond the centre of curvature the full Newton step runs away: fall back to the safe Gauss-Newton step
        step = np.einsum("nc,nc->n", offset, rho[1]) / np.maximum(slope - curvature, 0.5 * slope)
        xi = np.clip(xi + np.clip(step, -0.5, 0.5), -1.2, 1.2)
        if np.abs(step[np.abs(xi) < 1.2]).max(initial=0.0) < exact:
            break
    return xi


def _off_end(surface: Surface, segment: ndarray, foot: ndarray) -> ndarray:
    """Feet off the two ends of an open chain."""
    if surface.closed:
        return np.zeros(len(foot), bool)
    last = len(surface.segments) - 1
    return ((segment == 0) & (foot < -1.0)) | ((segment == last) & (foot > 1.0))


def _stays(here: ndarray, there: ndarray, foot: ndarray, accepted: ndarray, frozen: ndarray) -> ndarray:
    """Share of the segment's length by which candidates that are a point's accepted segment are preferred.

    The tangents are those of the candidate and of its neighbour at the joint between them.
    """
    share = np.where(frozen, FROZEN, HYSTERESIS)
    at_joint = accepted & (np.abs(np.abs(foot) - 1.0) <= 2.0 * share)
    bends = (np.einsum("nc,nc->n", here, there) > _STRAIGHT) & (np.abs(_left(here, there)) > _SMOOTH)
    return np.where(at_joint & (bends | frozen), share, 0.0)


def _first_minimum(row: ndarray, value: ndarray) -> ndarray:
    """Position of the first smallest value of every row."""
    order = np.lexsort((value, row))
    first = np.ones(len(order), bool)
    first[1:] = row[order[1:]] != row[order[:-1]]
    return order[first]
