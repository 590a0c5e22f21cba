"""Sizes of elements along the curves of a section, no coarser than near ones, growing gently."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import scipy
from numpy import ndarray

from ..arrays import row_norms
from ..checks import format_point
from .kernel import nodes_of
from .pieces import Pieces, Plan, sides_of

#: Growth of the size of elements per distance along curves.
_GROWTH = 0.4
#: Largest size of elements over the distance to the nearest other curve.
_GAP = 1.5
#: Sides of second order along a full circle at least: their middles leave it by 2e-6 of the radius.
_ROUND = 24
#: Chords of a curved curve by which distances are measured.
_CHORDS = 24
#: Elements of curves from which sizes inside grow.
_NEIGHBOURS = 3
#: Curves that meet nowhere must not come nearer than this share of the section.
_NEAREST = 1e-6
#: Largest number of sides of elements along one curve that the distance to others asks for.
_SIDES = 20_000
#: Number of points along a chord that estimate it.
_SAMPLES = 16
SizeCallback = Callable[[int, int, float, float, float, float], float]


class Curves:
    """Curves of a model as chords, with their lengths and radii, and the curves that they meet."""

    def __init__(self, gmsh: Any) -> None:
        model = gmsh.model
        self.tags: list[int] = []
        lengths = []
        radii = []
        starts = []
        stops = []
        counts = []
        ends = []
        for _, tag in model.getEntities(1):
            (low,), (high,) = model.getParametrizationBounds(1, tag)
            chords = 1
            radius = np.inf
            if model.getType(1, tag) != "Line":
                chords = _CHORDS
                curvature = model.getCurvature(1, tag, [0.5 * (low + high)])
                radius = 1.0 / float(curvature[0])
            x = model.getValue(1, tag, np.linspace(low, high, chords + 1))
            x = np.reshape(x, (-1, 3))[:, :2]
            boundary = model.getBoundary([(1, tag)], combined=False, oriented=False)
            self.tags.append(tag)
            lengths.append(model.occ.getMass(1, tag))
            radii.append(radius)
            starts.append(x[:-1])
            stops.append(x[1:])
            counts.append(chords)
            ends.append(set(boundary))
        self.length = np.array(lengths)
        self.radius = np.array(radii)

        # Chords, and for each curve the chords of curves that do not meet it
        self.a = np.vstack(starts)
        self.b = np.vstack(stops)
        self.owner = np.repeat(np.arange(len(counts)), counts)
        self.apart = {}
        for tag, own in zip(self.tags, ends):
            meets = np.array([not own.isdisjoint(others) for others in ends])
            self.apart[tag] = ~meets[self.owner]
        self.along = self.b - self.a
        self.squared = (self.along**2).sum(axis=1)
        self._starts = np.ascontiguousarray(self.a.T)
        self._along = np.ascontiguousarray(self.along.T)

    def distances(self, x: float | ndarray, y: float | ndarray) -> ndarray:
        """Return the distances of a point from all chords, or of points (n, 1): (n, chords)."""
        ax, ay = self._starts
        dx, dy = self._along
        right = x - ax
        up = y - ay
        share = (right * dx + up * dy) / self.squared
        share = np.minimum(np.maximum(share, 0.0), 1.0)
        return np.asarray(np.hypot(right - share * dx, up - share * dy))

    def gaps(self, tag: int, distances: ndarray) -> ndarray:
        """Return the distances of points from the curves that do not meet a curve."""
        return np.asarray(distances[..., self.apart[tag]].min(axis=-1, initial=np.inf))

    def check(self, plan: Plan) -> None:
        """Refuse curves that come so near to each other that no mesh fits between them."""
        ends = np.vstack((self.a, self.b))
        nearest = _NEAREST * np.ptp(ends, axis=0).max()
        for k, tag in enumerate(self.tags):
            chords = np.flatnonzero(self.owner == k)
            for end in (self.a[chords[0]], self.b[chords[-1]]):
                gap = min(float(self.gaps(tag, self.distances(*end))), self.length[k])
                if gap < nearest:
                    raise ValueError(
                        f"outlines or lines are {gap:.2g} apart near "
                        f"{format_point(end + plan.shift)}: let them meet there, or keep a "
                        f"distance of at least {nearest:.2g}"
                    )

            # Estimate the number of elements along the curve from the gap at sample points
            share = (np.arange(_SAMPLES) + 0.5) / _SAMPLES
            x = self.a[chords, None] + share[:, None] * self.along[chords, None]
            x = x.reshape(-1, 2)
            gaps = self.gaps(tag, self.distances(x[:, :1], x[:, 1:]))
            sides = self.length[k] * (1.0 / (_GAP * gaps)).mean()
            if sides > _SIDES:
                raise ValueError(
                    f"outlines or lines are {gaps.min():.2g} apart near "
                    f"{format_point(x[gaps.argmin()] + plan.shift)}, which takes {sides:.2g} sides "
                    f"of elements along one of them, more than {_SIDES}: let them meet, or keep a "
                    "larger distance"
                )


class Sizes:
    """Sizes of elements in the current model times a scale, as functions that Gmsh calls."""

    def __init__(
        self,
        gmsh: Any,
        plan: Plan,
        pieces: Pieces,
        size: float,
        sizes: Mapping[str, float],
        near: Sequence[tuple[ndarray, float]],
        scale: float,
    ) -> None:
        curves = Curves(gmsh)
        curves.check(plan)
        self._curves = curves
        self._faces = {}
        for face, (area, lift) in pieces.faces.items():
            value = sizes.get(area, size)
            if lift:
                value = min(value, sizes.get(lift, size))
            self._faces[face] = scale * value

        # Take the smallest size of a curve by its faces and by its own name
        wanted = dict.fromkeys(curves.tags, scale * size)
        for face, value in self._faces.items():
            for curve in sides_of(gmsh, face):
                wanted[curve] = min(wanted[curve], value)
        for name, members in (*pieces.lines.items(), *pieces.holes.items()):
            for curve in wanted.keys() & set(members):
                wanted[curve] = min(wanted[curve], scale * sizes.get(name, size))

        # Bound it by the length of the curve and by its radius
        each = np.minimum(np.array(list(wanted.values())), curves.length)
        each = np.minimum(each, 2.0 * np.pi / _ROUND * curves.radius)
        self._each = each[curves.owner]
        points, values = zip(*near) if near else ((), ())
        self._points = np.reshape(points, (-1, 2))
        self._of_points = scale * np.array(values)

    def along(
        self,
        dim: int,
        tag: int,
        x: float,
        y: float,
        z: float,
        lc: float,
    ) -> float:
        """Return the size at a point of a curve."""
        away = self._curves.distances(x, y)
        grown = float((self._each + _GROWTH * away).min())
        size = min(self._near(x, y), grown)
        if dim == 0:
            return size
        return min(size, _GAP * float(self._curves.gaps(tag, away)))

    def inside(self, gmsh: Any) -> SizeCallback:
        """Return the size at a point of a face, which grows from the nearest elements of curves.

        Gmsh alone takes the mean of a fine and a coarse side, which leaves needles on the fine one.
        """
        # Find the ends of the elements of curves
        mesh = gmsh.model.mesh
        x, row = nodes_of(gmsh)
        nodes = [mesh.getElements(1, curve)[2][0] for curve in self._curves.tags]
        rows = row[np.concatenate(nodes).astype(int)]
        ends = x[rows].reshape(-1, 2, 2)  # (elements, ends, 2)
        length = row_norms(ends[:, 1] - ends[:, 0])
        tree = scipy.spatial.cKDTree(ends.mean(axis=1))
        count = min(_NEIGHBOURS, len(length))

        def callback(dim: int, tag: int, x: float, y: float, z: float, lc: float) -> float:
            away, nearest = tree.query((x, y), count)
            grown = float(np.min(length[nearest] + _GROWTH * away))
            return min(self._faces.get(tag, lc), self._near(x, y), grown)

        return callback

    def _near(self, x: float, y: float) -> float:
        """Return the size that grows from points given with their sizes."""
        if not self._of_points.size:
            return np.inf
        away = np.hypot(*(self._points - (x, y)).T)
        return float((self._of_points + _GROWTH * away).min())
