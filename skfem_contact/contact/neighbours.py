"""Which segments of a surface may be the closest to a point: found once, and kept while little moves."""
from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy import ndarray
from scipy.spatial import cKDTree

from .surface import EXTENSION, Surface

#: Motion, as a share of the spacing of the samples, for which a list of neighbours lasts.
_SLACK = 0.25


class Neighbours(NamedTuple):
    """Pairs (point, segment) that contain the closest segment of every point, and how far the surface is.

    Attributes
    ----------
    point, segment
        The pairs, ordered.
    clearance
        No part of the surface, its extensions included, is nearer to the point than this, (n_points,).
    """

    point: ndarray
    segment: ndarray
    clearance: ndarray

    def of(self, chosen: ndarray) -> Neighbours:
        """Those of the points that a mask, (n_points,), chooses."""
        kept = chosen[self.point]
        return Neighbours(self.point[kept], self.segment[kept], self.clearance)


class NeighbourList:
    """Neighbours of some points that are searched anew only after motion that could matter (L. Verlet, 1967).

    Parameters
    ----------
    surface
        The surface.

    Examples
    --------
    >>> import numpy as np
    >>> import skfem_contact as sc
    >>> ground = sc.rigid_line((0.0, 0.0), (1.0, 0.0))
    >>> neighbours = NeighbourList(ground)
    >>> found = neighbours.at(ground.nodes, np.array([[0.5, 3.0]]))
    >>> found.segment, bool(2.0 < found.clearance[0] <= 3.0)
    (array([0]), True)
    """

    def __init__(self, surface: Surface) -> None:
        self._surface = surface
        self._list: tuple[Neighbours, float, ndarray, ndarray] | None = None

    def at(self, nodes: ndarray, points: ndarray) -> Neighbours:
        """Neighbours where the nodes of the surface and the points are now."""
        if self._list is not None and len(points) == len(self._list[3]):
            found, lasts, *places = self._list
            moved = _relative_motion(nodes - places[0], points - places[1])
            if moved <= lasts:
                return found._replace(clearance=found.clearance - moved)
        found, lasts = neighbours(self._surface, nodes, points, _SLACK)
        self._list = found, lasts, nodes, points
        return found


def _relative_motion(nodes: ndarray, points: ndarray) -> float:
    """By how much distances may have changed with these motions; a common translation changes none."""
    common = nodes.mean(axis=0)
    return sum(float(np.hypot(*(motion - common).T).max()) for motion in (nodes, points))


def neighbours(surface: Surface, nodes: ndarray, points: ndarray, slack: float = 0.0) -> tuple[Neighbours, float]:
    """Neighbours of points, and the motion for which they last.

    The chain is sampled at a uniform spacing.  The sample next to the closest point is at most half a
    spacing farther away than that, so all samples within half a spacing (and a margin for curved segments) of
    the nearest one are looked at.

    Parameters
    ----------
    surface, nodes
        The surface and the current coordinates of its nodes.
    points
        Places of the points, (n, 2).
    slack
        Share of the spacing that distances may change by.
    """
    spacing = max(surface.spacing, surface.total_length / (4 * len(surface.segments)))
    count = np.ceil(surface.length / spacing).astype(int) + 1
    segment = np.repeat(np.arange(len(count)), count)
    within = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
    xi = -1.0 + 2.0 * within / np.repeat(count - 1, count)
    samples = surface.curve(segment, xi, nodes, 0)[1][0]
    gaps = np.append(np.linalg.norm(np.diff(samples, axis=0), axis=1), 0.0)
    gaps[np.cumsum(count) - 1] = 0.0  # from one segment to the next
    stretch = np.maximum(1.0, np.maximum.reduceat(gaps, np.cumsum(count) - count) / spacing)
    margin, motion = 0.75 * spacing * stretch, slack * spacing
    row, sample, distance = _nearest(samples, points, margin[segment] + 2.0 * motion)
    point, neighbour = np.divmod(np.unique(row * len(count) + segment[sample]), len(count))
    beyond = EXTENSION * stretch.max() * (max(surface.length[0], surface.length[-1]) + spacing)
    return Neighbours(point, neighbour, distance - margin.max() - beyond), motion


def _nearest(samples: ndarray, points: ndarray, margin: ndarray) -> tuple[ndarray, ndarray, ndarray]:
    """Pairs (point, sample) of all samples at most their margin farther away than the nearest one, and its distance."""
    tree, k, largest = cKDTree(samples), 4, margin.max()
    while True:
        k = min(2 * k, len(samples))
        distance, sample = (np.atleast_2d(found) for found in tree.query(points, k))
        if k == len(samples) or (distance[:, -1] > distance[:, 0] + largest).all():
            near = distance <= distance[:, :1] + margin[sample]
            return np.nonzero(near)[0], sample[near], distance[:, 0]
