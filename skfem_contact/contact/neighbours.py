"""Candidate facets for the closest points, searched when needed and kept while little moves."""

from __future__ import annotations

from collections.abc import Callable
from itertools import chain, product
from typing import NamedTuple

import numpy as np
import scipy
from numpy import ndarray

from ..surfaces.shape import Shape
from ..surfaces.surface import Surface
from ..surfaces.vectors import across, dot, inverse, products, unit

#: Motion, as a share of the spacing of the samples, for which a list of neighbours lasts.
_SLACK = 0.25
#: ... and for points on pieces, whose lists are made anew with the pieces.
_SLACK_OF_PIECES = 0.125
#: Samples a side of a typical facet, in the plane and in space: half as many would make 3 times as
#: many candidates.
_SAMPLES = {2: 1, 3: 2}
_AT_ONCE = 10_000  # points whose samples are in memory, some hundred each
#: Share of a facet's size by which a point that is frozen on it may be beyond it.
FROZEN = 0.25
ON_FACET = 1e-9  # round-off of xi at a joint
#: Samples among which one is looked for that a point may touch, at first.
_FIRST_SAMPLES = 32

#: Mask of pairs (point, facet) that do not touch: neighbours on one surface.
Excludes = Callable[[ndarray, ndarray], ndarray]


class Pairs(NamedTuple):
    """Pairs (point, facet), point by point."""

    point: ndarray
    facet: ndarray


_NO_PAIRS = Pairs(np.zeros(0, int), np.zeros(0, int))


class Samples(NamedTuple):
    """Samples of facets, and how far the nearest one of each point is."""

    surface: Surface
    nodes: ndarray
    points: ndarray
    facet: ndarray
    tree: scipy.spatial.cKDTree
    nearest: ndarray
    margin: ndarray
    motion: float
    excludes: Excludes | None

    def around(self, some: ndarray) -> Pairs:
        """Return the pairs of some points with the facets that may be closest after a motion."""
        # Take the facets of all samples near the nearest one
        row, sample = _around(
            self.tree, self.points[some], self.nearest[some], self.margin + 2.0 * self.motion
        )
        row = some[row]
        facet = self.facet[sample]
        if self.excludes is not None:
            kept = ~self.excludes(row, facet)
            row = row[kept]
            facet = facet[kept]
        m = len(self.surface.facets)
        pair = row * m + facet
        pair = pair[np.diff(pair, prepend=-1) != 0]  # samples of a facet follow each other
        row, facet = np.divmod(np.unique(pair), m)
        if self.surface.dim == 2:
            return Pairs(row, facet)

        # Leave out those in space whose flat images are farther than another facet
        flat = Flat.of(self.surface, self.nodes)
        r = self.points[row]
        foot = flat.foot(self.surface.shape, facet, r)
        slack = 2.0 * self.motion + FROZEN * self.surface.size[facet]
        kept = promising(self.surface, self.nodes, flat, r, row, facet, foot, slack)
        return Pairs(row[kept], facet[kept])


class Candidates:
    """Pairs that contain each point's closest facet, searched when a point is first asked for."""

    def __init__(self, samples: Samples, known: Pairs) -> None:
        self._samples = samples
        self._pairs = known
        self._known = np.zeros(len(samples.points), bool)
        self._known[known.point] = True

    def of(self, chosen: ndarray) -> Pairs:
        """Return the pairs of the points that a mask chooses."""
        new = np.flatnonzero(chosen & ~self._known)
        if len(new):
            found = self._samples.around(new)
            point = np.concatenate((self._pairs.point, found.point))
            facet = np.concatenate((self._pairs.facet, found.facet))
            order = np.argsort(point, kind="stable")
            self._pairs = Pairs(point[order], facet[order])
            self._known[new] = True
        kept = chosen[self._pairs.point]
        return Pairs(self._pairs.point[kept], self._pairs.facet[kept])


class Neighbours(NamedTuple):
    """Candidates for the closest facets of points, and bounds of their distances.

    No part of the surface, beyond its rim included, is nearer to a point than its `clearance`;
    points known to lie outside the body are True in `outside`.
    """

    candidates: Candidates
    clearance: ndarray
    outside: ndarray

    @property
    def pairs(self) -> Pairs:
        """Pairs (point, facet) of all points."""
        return self.candidates.of(np.ones(len(self.clearance), bool))

    def of(self, chosen: ndarray) -> Pairs:
        """Return the pairs of the points that a mask chooses."""
        return self.candidates.of(chosen)

    def within(self, gap: ndarray, depth: ndarray) -> ndarray:
        """Return a mask of points that may be as near as a gap or, inside, as deep as a depth."""
        surely_outside = self.outside & (depth < np.inf)
        reach = np.where(surely_outside, gap, np.maximum(depth, gap))
        return np.asarray(self.clearance <= reach)


class _Searched(NamedTuple):
    """Neighbours found at coordinates of points and nodes, and the motion for which they last."""

    found: Neighbours
    lasts: float
    own: ndarray | None
    nodes: ndarray
    points: ndarray


class NeighbourList:
    """Neighbours of points, searched anew after motion that could matter (L. Verlet, 1967)."""

    def __init__(self, surface: Surface) -> None:
        self._surface = surface
        self._moved = 0.0
        self._list: _Searched | None = None

    def at(
        self,
        nodes: ndarray,
        points: ndarray,
        own: ndarray | None = None,
        excludes: Excludes | None = None,
    ) -> Neighbours:
        """Return neighbours at present coordinates of the surface's nodes and of the points.

        `own` : ndarray, shape (n,), are the facets on which pieces in space lie, -1 for none.
        """
        last = self._list
        if last is not None and own is last.own and len(points) == len(last.points):
            self._moved = _relative_motion(nodes - last.nodes, points - last.points)
            if self._moved <= last.lasts:
                return last.found._replace(clearance=last.found.clearance - self._moved)
        if own is None or (own < 0).all():
            found, lasts = neighbours(self._surface, nodes, points, _SLACK, excludes)
        else:
            found, lasts = _neighbours_of_pieces(self._surface, nodes, points, own)
        self._list = _Searched(found, lasts, own, nodes, points)
        self._moved = 0.0
        return found

    def learn(self, chosen: ndarray, distance: ndarray, gap: ndarray) -> None:
        """Remember distances and gaps of chosen points (a mask) at their present coordinates.

        Points that have moved less than their distance have not passed the surface: if outside,
        they remain so.
        """
        assert self._list is not None
        known = self._list.found
        indices = np.flatnonzero(chosen)
        surely = distance[indices] - self._moved
        gap = gap[indices]
        known.clearance[indices] = np.maximum(known.clearance[indices], surely)
        known.outside[indices] |= (gap > 0.0) & (gap < np.inf) & (surely > 0.0)


def _relative_motion(nodes: ndarray, points: ndarray) -> float:
    """Return the largest possible change of distances; a common translation changes none."""
    common = nodes.sum(axis=0) / len(nodes)

    def largest(motion: ndarray) -> float:
        relative = motion - common
        return float(np.sqrt(dot(relative, relative).max()))

    return largest(nodes) + largest(points)


def neighbours(
    surface: Surface,
    nodes: ndarray,
    points: ndarray,
    slack: float = 0.0,
    excludes: Excludes | None = None,
    alone: Pairs = _NO_PAIRS,
) -> tuple[Neighbours, float]:
    """Return neighbours of points (n, dim), and the motion for which they last.

    The facets are sampled at a uniform spacing.  The sample next to the closest point is at most
    half a spacing (half a diagonal in space) farther away than that point.  So all samples within
    this distance of the nearest one, and a margin for curved facets, are candidates.  The motion is
    `slack` times the spacing. Samples of excluded facets do not count. Points that stay `alone` on
    their facets need none.
    """
    # Sample the facets
    m = len(surface.facets)
    least = surface.size.sum() / (4 * m)
    spacing = max(surface.spacing, least) / _SAMPLES[surface.dim]
    length = _longest_side(surface)
    divisions = np.ceil(length / spacing).astype(int)
    facet, samples, gap = _samples(surface, nodes, divisions)

    # Find the nearest sample of each point
    tree = scipy.spatial.cKDTree(samples)
    if excludes is None:
        nearest = np.full(len(points), np.inf)
        others = np.delete(np.arange(len(points)), alone.point)
        nearest[others] = tree.query(points[others])[0]
    else:
        nearest = _nearest_allowed(tree, points, facet, excludes)

    # Bound the distances from the surface and its extension beyond the rim
    stretch = np.maximum(1.0, gap / spacing)
    margin = 0.75 * np.sqrt(surface.dim - 1) * spacing * stretch
    last = length[surface.at_rim.any(axis=1)].max(initial=0.0)
    beyond = surface.extension * stretch.max() * (last + spacing)
    clearance = nearest - margin.max() - beyond
    outside = np.zeros(len(points), bool)
    motion = slack * spacing
    found = Samples(surface, nodes, points, facet, tree, nearest, margin[facet], motion, excludes)
    return Neighbours(Candidates(found, alone), clearance, outside), motion


def _neighbours_of_pieces(
    surface: Surface,
    nodes: ndarray,
    points: ndarray,
    own: ndarray,
) -> tuple[Neighbours, float]:
    """Return neighbours of points of pieces, many of which stay on their own facets alone."""
    flat = Flat.of(surface, nodes)
    motion = _SLACK_OF_PIECES * surface.spacing / _SAMPLES[3]

    # Find points so near to their own facets, and so far from their sides, that they stay there
    indices = np.flatnonzero(own >= 0)
    facet = own[indices]
    r = points[indices]
    foot = flat.foot(surface.shape, facet, r)
    limit = np.where(surface.at_rim, surface.reach, 2.0 * FROZEN)
    aside, height, bulge = flat.apart(surface, nodes, facet, r, foot, limit)
    height = np.abs(height)
    inside = aside <= -2.0 * bulge - motion
    near = height <= FROZEN * surface.size[facet] - 2.0 * bulge
    stays = inside & near
    alone = Pairs(indices[stays], facet[stays])

    # Search the neighbours of the others
    found, _ = neighbours(surface, nodes, points, _SLACK_OF_PIECES, alone=alone)
    found.clearance[alone.point] = (height - 2.0 * bulge)[stays]
    return found, motion


class Flat(NamedTuple):
    """Facets linearised at their centres: coordinates, tangents and their inverse metric."""

    centre: ndarray
    tangents: ndarray
    inverse: ndarray

    @classmethod
    def of(cls, surface: Surface, nodes: ndarray) -> Flat:
        """Return the facets at present coordinates of the nodes."""
        coordinates = nodes[surface.facets]  # (n_facets, k, dim)
        values, slopes = surface.shape.at_centre
        centre = np.einsum("nk,nkc->nc", values, coordinates)
        tangents = slopes @ coordinates
        return cls(centre, tangents, inverse(products(tangents, tangents)))

    def foot(self, shape: Shape, facet: ndarray, points: ndarray) -> ndarray:
        """Return xi of orthogonal projections, (n, dim - 1), eq. 17: exact on affine facets."""
        offset = points - self.centre[facet]
        along = self.tangents[facet] @ offset[:, :, None]
        return np.asarray(shape.centre + (self.inverse[facet] @ along)[:, :, 0])

    def apart(
        self,
        surface: Surface,
        nodes: ndarray,
        facet: ndarray,
        points: ndarray,
        foot: ndarray,
        reach: ndarray,
    ) -> tuple[ndarray, ndarray, ndarray]:
        """Return distances beyond a reach at sides, heights, and the facets' largest bulges."""
        shape = surface.shape
        flat = self.centre[:, None] + (shape.nodes - shape.centre) @ self.tangents
        squares = ((flat - nodes[surface.facets]) ** 2).sum(axis=2)
        bulge = np.sqrt(squares.max(axis=1))
        outward = shape.outward.T
        slope = np.sqrt(((self.inverse @ outward) * outward).sum(axis=1))
        aside = (shape.beyond(foot) - reach[facet]) / slope[facet]
        normal = unit(across(self.tangents))
        height = dot(points - self.centre[facet], normal[facet])
        return aside.max(axis=1), height, bulge[facet]


def promising(
    surface: Surface,
    nodes: ndarray,
    flat: Flat,
    points: ndarray,
    row: ndarray,
    facet: ndarray,
    foot: ndarray,
    slack: ndarray | float = 0.0,
) -> ndarray:
    """Return a mask of pairs (point, facet) in space that may be the closest, by flat facets.

    A facet is excluded if the distance of its flat image, less the largest distance between the two
    and a slack, exceeds the distance of some point on another facet.
    """
    # Points with one candidate keep it
    rivals = np.bincount(row)[row] > 1
    if not rivals.all():
        kept = np.ones(len(row), bool)
        kept[rivals] = promising(
            surface,
            nodes,
            flat,
            points=points[rivals],
            row=row[rivals],
            facet=facet[rivals],
            foot=foot[rivals],
            slack=slack[rivals] if isinstance(slack, ndarray) else slack,
        )
        return kept

    # Bound the distance of each facet from below, by its flat image
    aside, height, bulge = flat.apart(surface, nodes, facet, points, foot, surface.reach)
    least = np.sqrt(height**2 + np.maximum(aside, 0.0) ** 2) - 2.0 * bulge - slack

    # Bound the distance of each point from above, by a point on a facet
    shape = surface.shape
    inside = np.clip(foot, shape.corners.min(axis=0), shape.corners.max(axis=0))
    if shape.triangular:
        inside /= np.maximum(inside.sum(axis=1), 1.0)[:, None]
    offset = points - surface.at(facet, inside, nodes, 0).x[0]
    most = np.full(row.max(initial=-1) + 1, np.inf)
    np.minimum.at(most, row, np.sqrt(dot(offset, offset)))
    return np.asarray(least <= most[row] * (1.0 + ON_FACET) + ON_FACET * surface.size[facet])


def _longest_side(surface: Surface) -> ndarray:
    """Return the length of each facet's longest side in the mesh."""
    if surface.dim == 2:
        return surface.area
    corners = surface.nodes[surface.facets[:, : len(surface.shape.corners)]]
    sides = corners - np.roll(corners, -1, axis=1)
    return np.asarray(np.linalg.norm(sides, axis=2).max(axis=1))


def _samples(
    surface: Surface, nodes: ndarray, divisions: ndarray
) -> tuple[ndarray, ndarray, ndarray]:
    """Return facets and coordinates of samples, and each facet's largest distance of samples."""
    facets = []
    coordinates = []
    gap = np.zeros(len(divisions))
    for n in np.unique(divisions):
        on = np.flatnonzero(divisions == n)
        lattice, (first, second) = _lattice(surface.shape, int(n))
        n_points = len(lattice)
        facet = np.repeat(on, n_points)
        xi = np.tile(lattice, (len(on), 1))
        M = surface.shape.at(facet, xi, 0)[0]
        M = M.reshape(len(on), n_points, -1)
        x = np.einsum("fqk,fkc->fqc", M, nodes[surface.facets[on]])  # (facets, points, dim)
        squares = ((x[:, first] - x[:, second]) ** 2).sum(axis=2)
        gap[on] = np.sqrt(squares.max(axis=1))
        facets.append(facet)
        coordinates.append(x.reshape(-1, surface.dim))
    return np.concatenate(facets), np.concatenate(coordinates), gap


def _lattice(shape: Shape, n: int) -> tuple[ndarray, tuple[ndarray, ...]]:
    """Return local coordinates of a lattice of n divisions a side, and the adjacent pairs."""
    numbers = np.array(list(product(range(n + 1), repeat=shape.dim)))
    if shape.triangular:
        numbers = numbers[numbers.sum(axis=1) <= n]
    apart = np.abs(numbers[:, None] - numbers).sum(axis=2)
    pairs = np.nonzero(np.triu(apart == 1))
    low = shape.corners.min(axis=0)
    high = shape.corners.max(axis=0)
    return low + (high - low) * numbers / n, pairs


def _nearest_allowed(
    tree: scipy.spatial.cKDTree,
    points: ndarray,
    facet: ndarray,
    excludes: Excludes,
) -> ndarray:
    """Return distances of points from the nearest samples of facets that are not excluded.

    They are infinite where all facets are.
    """
    # Look at more and more samples, until one is allowed or all are seen.
    nearest = np.full(len(points), np.inf)
    left = np.arange(len(points))
    count = _FIRST_SAMPLES
    while len(left):
        count = min(count, len(facet))
        farther = []
        for some in np.array_split(left, len(left) * count // (100 * _AT_ONCE) + 1):
            found = tree.query(points[some], np.arange(1, count + 1))
            distance = np.asarray(found[0])
            row = np.repeat(some, count)
            excluded = excludes(row, facet[np.ravel(found[1])]).reshape(distance.shape)
            first = np.where(excluded, np.inf, distance).min(axis=1)
            nearest[some] = first
            farther.append(some[np.isinf(first)])
        left = np.concatenate(farther)
        if count == len(facet):
            break
        count *= 4
    return nearest


def _around(
    tree: scipy.spatial.cKDTree,
    points: ndarray,
    nearest: ndarray,
    margin: ndarray,
) -> tuple[ndarray, ndarray]:
    """Return pairs (point, sample) within a margin of the nearest sample."""
    samples = tree.data
    rows = []
    found = []
    known = np.flatnonzero(np.isfinite(nearest))
    for some in np.array_split(known, len(points) // _AT_ONCE + 1):
        reach = nearest[some] + margin.max()
        around = tree.query_ball_point(points[some], reach, return_sorted=True)
        row = np.repeat(some, [len(numbers) for numbers in around])
        sample = np.fromiter(chain.from_iterable(around), int, len(row))
        offset = points[row] - samples[sample]
        near = np.sqrt(dot(offset, offset)) <= nearest[row] + margin[sample]
        rows.append(row[near])
        found.append(sample[near])
    return np.concatenate(rows), np.concatenate(found)
