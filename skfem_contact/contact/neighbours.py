"""Candidate facets for the closest points, searched once and kept while little moves."""

from __future__ import annotations

from itertools import chain, product
from typing import NamedTuple

import numpy as np
from numpy import ndarray
from scipy.spatial import cKDTree

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


class Neighbours(NamedTuple):
    """Pairs (point, facet) that contain the closest facet of every point, and lower bounds of the
    distances.

    No part of the surface, beyond its rim included, is nearer to a point than its `clearance`;
    points known to lie outside the body are True in `outside`.
    """

    point: ndarray
    facet: ndarray
    clearance: ndarray
    outside: ndarray

    def of(self, chosen: ndarray) -> Neighbours:
        """Return the pairs of the points that a mask chooses."""
        kept = chosen[self.point]
        return self._replace(point=self.point[kept], facet=self.facet[kept])

    def within(self, gap: ndarray, depth: ndarray) -> ndarray:
        """Return a mask of points that may be as near as a gap or, inside, as deep as a depth."""
        return np.asarray(
            self.clearance <= np.where(self.outside & (depth < np.inf), gap, np.maximum(depth, gap))
        )


class NeighbourList:
    """Neighbours of some points, searched anew only after motion that could matter (L. Verlet,
    1967).
    """

    def __init__(self, surface: Surface) -> None:
        self._surface, self._moved = surface, 0.0
        self._list: tuple[Neighbours, float, ndarray | None, ndarray, ndarray] | None = None

    def at(self, nodes: ndarray, points: ndarray, own: ndarray | None = None) -> Neighbours:
        """Return neighbours at present coordinates of the surface's nodes and of the points.

        `own` : ndarray, shape (n,), are the facets on which pieces in space lie, -1 for none.
        """
        if self._list is not None:
            found, lasts, facets, there, before = self._list
            if own is facets and len(points) == len(before):
                self._moved = _relative_motion(nodes - there, points - before)
                if self._moved <= lasts:
                    return found._replace(clearance=found.clearance - self._moved)
        found, lasts = (
            neighbours(self._surface, nodes, points, _SLACK)
            if own is None or (own < 0).all()
            else _neighbours_of_pieces(self._surface, nodes, points, own)
        )
        self._list, self._moved = (found, lasts, own, nodes, points), 0.0
        return found

    def learn(self, chosen: ndarray, distance: ndarray, gap: ndarray) -> None:
        """Remember distances and gaps of the points that a mask chooses, at their present
        coordinates.

        Points that have moved less than their distance have not passed the surface: if outside,
        they remain so.
        """
        assert self._list is not None
        known, at = self._list[0], np.flatnonzero(chosen)
        there = distance[at] - self._moved
        known.clearance[at] = np.maximum(known.clearance[at], there)
        known.outside[at] |= (gap[at] > 0.0) & (gap[at] < np.inf) & (there > 0.0)


def _relative_motion(nodes: ndarray, points: ndarray) -> float:
    """Return the largest possible change of distances; a common translation changes none."""
    common = nodes.sum(axis=0) / len(nodes)
    return sum(
        float(np.sqrt(dot(motion - common, motion - common).max())) for motion in (nodes, points)
    )


def neighbours(
    surface: Surface, nodes: ndarray, points: ndarray, slack: float = 0.0
) -> tuple[Neighbours, float]:
    """Return neighbours of points, shape (n, dim), and the motion for which they last: `slack`
    times the spacing.

    The facets are sampled at a uniform spacing.  The sample next to the closest point is at most
    half a spacing (half a diagonal in space) farther away than that point.  So all samples within
    this distance of the nearest one, and a margin for curved facets, are candidates.
    """
    m = len(surface.facets)
    spacing = max(surface.spacing, surface.size.sum() / (4 * m)) / _SAMPLES[surface.dim]
    length = _longest_side(surface)
    facet, samples, gap = _samples(surface, nodes, np.ceil(length / spacing).astype(int))
    stretch = np.maximum(1.0, gap / spacing)
    margin, motion = 0.75 * np.sqrt(surface.dim - 1) * spacing * stretch, slack * spacing
    row, sample, distance = _nearest(samples, points, margin[facet] + 2.0 * motion)
    pair = row * m + facet[sample]
    pair = pair[np.diff(pair, prepend=-1) != 0]  # samples of a facet follow each other
    point, neighbour = np.divmod(np.unique(pair), m)
    if surface.dim == 3:
        flat = Flat.of(surface, nodes)
        foot = flat.foot(surface.shape, neighbour, points[point])
        kept = promising(
            surface,
            nodes,
            flat,
            points[point],
            point,
            neighbour,
            foot,
            2.0 * motion + FROZEN * surface.size[neighbour],
        )
        point, neighbour = point[kept], neighbour[kept]
    last = length[surface.at_rim.any(axis=1)].max(initial=0.0)
    beyond = surface.extension * stretch.max() * (last + spacing)
    return Neighbours(
        point, neighbour, distance - margin.max() - beyond, np.zeros(len(points), bool)
    ), motion


def _neighbours_of_pieces(
    surface: Surface, nodes: ndarray, points: ndarray, own: ndarray
) -> tuple[Neighbours, float]:
    """Return neighbours of points of which many stay on their own facets, which alone are those of
    these.
    """
    flat, motion = Flat.of(surface, nodes), _SLACK_OF_PIECES * surface.spacing / _SAMPLES[3]
    at = np.flatnonzero(own >= 0)
    foot, limit = (
        flat.foot(surface.shape, own[at], points[at]),
        np.where(surface.at_rim, surface.reach, 2.0 * FROZEN),
    )
    aside, height, bulge = flat.apart(surface, nodes, own[at], points[at], foot, limit)
    stays = (aside <= -2.0 * bulge - motion) & (
        np.abs(height) <= FROZEN * surface.size[own[at]] - 2.0 * bulge
    )
    at, height = at[stays], (np.abs(height) - 2.0 * bulge)[stays]
    others = np.delete(np.arange(len(points)), at)
    found, _ = neighbours(surface, nodes, points[others], _SLACK_OF_PIECES)
    clearance = np.zeros(len(points))
    clearance[at], clearance[others] = height, found.clearance
    point, facet = np.concatenate((at, others[found.point])), np.concatenate((own[at], found.facet))
    return Neighbours(point, facet, clearance, np.zeros(len(points), bool)), motion


class Flat(NamedTuple):
    """Facets linearised at their centres: coordinates, tangents and their inverse metric."""

    centre: ndarray
    tangents: ndarray
    inverse: ndarray

    @classmethod
    def of(cls, surface: Surface, nodes: ndarray) -> Flat:
        """Return the facets at present coordinates of the nodes."""
        coordinates, (values, slopes) = nodes[surface.facets], surface.shape.at_centre
        tangents = slopes @ coordinates
        return cls(
            np.einsum("nk,nkc->nc", values, coordinates),
            tangents,
            inverse(products(tangents, tangents)),
        )

    def foot(self, shape: Shape, facet: ndarray, points: ndarray) -> ndarray:
        """Return local coordinates of orthogonal projections, shape (n, dim - 1): exact on affine
        facets.
        """
        along = self.tangents[facet] @ (points - self.centre[facet])[:, :, None]
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
        """Return distances beyond a reach at the sides of facets, heights, and the facets' bulges
        from flat ones.
        """
        shape = surface.shape
        corners = self.centre[:, None] + (shape.nodes - shape.centre) @ self.tangents
        bulge = np.sqrt(((corners - nodes[surface.facets]) ** 2).sum(axis=2).max(axis=1))
        slope = np.sqrt(((self.inverse @ shape.outward.T) * shape.outward.T).sum(axis=1))
        aside = ((shape.beyond(foot) - reach[facet]) / slope[facet]).max(axis=1)
        height = dot(points - self.centre[facet], unit(across(self.tangents))[facet])
        return aside, height, bulge[facet]


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
    """Return a mask of pairs (point, facet) in space that may be the closest by the measure of flat
    facets.

    A facet is excluded if the distance of its flat image, less the largest distance between the two
    and a slack, exceeds that of some point on another facet.
    """
    shape, rivals = surface.shape, np.flatnonzero(np.bincount(row)[row] > 1)
    if len(rivals) < len(row):
        kept = np.ones(len(row), bool)
        few = slack[rivals] if isinstance(slack, ndarray) else slack
        kept[rivals] = promising(
            surface, nodes, flat, points[rivals], row[rivals], facet[rivals], foot[rivals], few
        )
        return kept
    aside, height, bulge = flat.apart(surface, nodes, facet, points, foot, surface.reach)
    least = np.sqrt(height**2 + np.maximum(aside, 0.0) ** 2) - 2.0 * bulge - slack
    inside = np.clip(foot, shape.corners.min(axis=0), shape.corners.max(axis=0))
    if shape.triangular:
        inside /= np.maximum(inside.sum(axis=1), 1.0)[:, None]
    x = surface.at(facet, inside, nodes, 0).x[0]
    most = np.full(row.max(initial=-1) + 1, np.inf)
    np.minimum.at(most, row, np.sqrt(dot(points - x, points - x)))
    return np.asarray(least <= most[row] * (1.0 + ON_FACET) + ON_FACET * surface.size[facet])


def _longest_side(surface: Surface) -> ndarray:
    if surface.dim == 2:
        return surface.area
    corners = surface.nodes[surface.facets[:, : len(surface.shape.corners)]]
    return np.asarray(np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2).max(axis=1))


def _samples(
    surface: Surface, nodes: ndarray, divisions: ndarray
) -> tuple[ndarray, ndarray, ndarray]:
    facets, coordinates, gap = [], [], np.zeros(len(divisions))
    for n in np.unique(divisions):
        on = np.flatnonzero(divisions == n)
        lattice, pairs = _lattice(surface.shape, int(n))
        M = surface.shape.at(np.repeat(on, len(lattice)), np.tile(lattice, (len(on), 1)), 0)[0]
        x = np.einsum(
            "fqk,fkc->fqc", M.reshape(len(on), len(lattice), -1), nodes[surface.facets[on]]
        )
        gap[on] = np.sqrt(((x[:, pairs[0]] - x[:, pairs[1]]) ** 2).sum(axis=2).max(axis=1))
        facets.append(np.repeat(on, len(lattice)))
        coordinates.append(x.reshape(-1, x.shape[2]))
    return np.concatenate(facets), np.concatenate(coordinates), gap


def _lattice(shape: Shape, n: int) -> tuple[ndarray, ndarray]:
    """Return local coordinates of a lattice of n divisions a side, and the adjacent pairs."""
    numbers = np.array(
        [k for k in product(range(n + 1), repeat=shape.dim) if not shape.triangular or sum(k) <= n]
    )
    apart = np.abs(numbers[:, None] - numbers).sum(axis=2)
    low, high = shape.corners.min(axis=0), shape.corners.max(axis=0)
    return low + (high - low) * numbers / n, np.array(np.nonzero(np.triu(apart == 1)))


def _nearest(
    samples: ndarray, points: ndarray, margin: ndarray
) -> tuple[ndarray, ndarray, ndarray]:
    """Return ordered pairs (point, sample) within the margin of the nearest sample, and its
    distance.
    """
    tree, pairs = cKDTree(samples), []
    nearest = np.asarray(tree.query(points)[0])
    for some in np.array_split(np.arange(len(points)), len(points) // _AT_ONCE + 1):
        around = tree.query_ball_point(
            points[some], nearest[some] + margin.max(), return_sorted=True
        )
        row = np.repeat(some, [len(one) for one in around])
        sample = np.fromiter(chain.from_iterable(around), int, len(row))
        offset = points[row] - samples[sample]
        near = np.sqrt(dot(offset, offset)) <= nearest[row] + margin[sample]
        pairs.append((row[near], sample[near]))
    rows, found = (np.concatenate(part) for part in zip(*pairs, strict=True))
    return rows, found, nearest
