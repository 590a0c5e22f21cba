"""Sizes of elements along the curves of a section: as asked for, no coarser than what is near,
growing gently.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy import ndarray
from scipy.spatial import cKDTree

from ..checks import format_point
from .pieces import Pieces, Plan, sides_of

#: Growth of the size of elements per distance along curves, and size over the distance to the
#: nearest other curve.
_GROWTH, _GAP = 0.4, 1.5
#: Sides of second order along a full circle at least: their middles leave it by 2e-6 of the radius.
_ROUND = 24
#: Chords of a curved curve by which distances are measured.
_CHORDS = 24
#: Elements of curves from which sizes inside grow.
_NEIGHBOURS = 3
#: Curves that meet nowhere must not come nearer than this share of the section.
_NEAREST = 1e-6
#: Sides of elements along one curve at most that the distance to others asks for, and points that
#: estimate them.
_SIDES, _SAMPLES = 20_000, 16
SizeCallback = Callable[[int, int, float, float, float, float], float]


class Curves:
    """Curves of a model as chords, with the curves that meet at their ends and the sizes that
    belong to them.
    """

    def __init__(self, gmsh: Any) -> None:
        model, starts, stops, owner = gmsh.model, [], [], []
        self.tags = [tag for _, tag in model.getEntities(1)]
        self.length = np.array([model.occ.getMass(1, tag) for tag in self.tags])
        self.radius = np.full(len(self.tags), np.inf)
        ends = []
        for k, tag in enumerate(self.tags):
            low, high = (float(value[0]) for value in model.getParametrizationBounds(1, tag))
            straight = model.getType(1, tag) == "Line"
            at = np.linspace(low, high, 2 if straight else _CHORDS + 1)
            x = np.reshape(model.getValue(1, tag, at), (-1, 3))[:, :2]
            if not straight:
                self.radius[k] = 1.0 / float(model.getCurvature(1, tag, [0.5 * (low + high)])[0])
            starts.append(x[:-1])
            stops.append(x[1:])
            owner += [k] * (len(x) - 1)
            ends.append(
                {
                    point
                    for _, point in model.getBoundary([(1, tag)], combined=False, oriented=False)
                }
            )
        self.a, self.b, self.owner = np.vstack(starts), np.vstack(stops), np.array(owner)
        meets = np.array([[bool(one & two) for two in ends] for one in ends])
        self.apart = {tag: ~meets[k][self.owner] for k, tag in enumerate(self.tags)}
        self.along = self.b - self.a
        self.squared = (self.along**2).sum(axis=1)

    def distances(self, x: float, y: float) -> ndarray:
        """Return the distances of a point from all chords."""
        offset = np.array([x, y]) - self.a
        share = np.clip((offset * self.along).sum(axis=1) / self.squared, 0.0, 1.0)
        return np.asarray(np.hypot(*(offset - share[:, None] * self.along).T))

    def check(self, plan: Plan) -> None:
        """Refuse curves that come so near to each other that no mesh fits between them."""
        size = np.ptp(np.vstack((self.a, self.b)), axis=0).max()
        for k, tag in enumerate(self.tags):
            for x in (self.a[self.owner == k][0], self.b[self.owner == k][-1]):
                gap = self.distances(*x)[self.apart[tag]].min(initial=np.inf)
                if min(gap, self.length[k]) < _NEAREST * size:
                    raise ValueError(
                        f"outlines or lines are {min(gap, self.length[k]):.2g} apart near "
                        f"{format_point(x + plan.shift)}: let them meet there, or keep a distance "
                        f"of at "
                        f"least {_NEAREST * size:.2g}"
                    )
            self._check_band(k, plan)

    def _check_band(self, k: int, plan: Plan) -> None:
        """Refuse a curve that has another one so near along it that elements between them are too
        many.
        """
        chords, share = np.flatnonzero(self.owner == k), (np.arange(_SAMPLES) + 0.5) / _SAMPLES
        x = (self.a[chords, None] + share[:, None] * self.along[chords, None]).reshape(-1, 2)
        gaps = np.array(
            [self.distances(*point)[self.apart[self.tags[k]]].min(initial=np.inf) for point in x]
        )
        if (sides := self.length[k] * (1.0 / (_GAP * gaps)).mean()) > _SIDES:
            at = format_point(x[gaps.argmin()] + plan.shift)
            raise ValueError(
                f"outlines or lines are {gaps.min():.2g} apart near {at}, which takes {sides:.2g} "
                f"sides "
                f"of elements along one of them, more than {_SIDES}: let them meet, or keep a "
                f"larger "
                "distance"
            )


class Sizes:
    """Sizes of elements in the current model, as functions that Gmsh calls; `scale` multiplies what
    is asked for.
    """

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
        self._curves = curves = Curves(gmsh)
        curves.check(plan)
        self._faces = {
            face: scale * min(sizes.get(name, size) for name in labels if name)
            for face, labels in pieces.faces.items()
        }
        wanted = dict.fromkeys(curves.tags, scale * size)
        for face, value in self._faces.items():
            for curve in sides_of(gmsh, face):
                wanted[curve] = min(wanted[curve], value)
        for name, members in (*pieces.lines.items(), *pieces.holes.items()):
            for curve in wanted.keys() & set(members):
                wanted[curve] = min(wanted[curve], scale * sizes.get(name, size))
        each = np.minimum(np.array([wanted[tag] for tag in curves.tags]), curves.length)
        self._each = np.minimum(each, 2.0 * np.pi / _ROUND * curves.radius)[curves.owner]
        self._at = np.array([point for point, _ in near]).reshape(-1, 2)
        self._there = scale * np.array([value for _, value in near])

    def along(self, dim: int, tag: int, x: float, y: float, z: float, lc: float) -> float:
        """Return the size at a point of a curve."""
        away = self._curves.distances(x, y)
        found = min(self._near(x, y), float((self._each + _GROWTH * away).min()))
        return (
            found
            if dim == 0
            else min(found, _GAP * away[self._curves.apart[tag]].min(initial=np.inf))
        )

    def inside(self, gmsh: Any) -> SizeCallback:
        """Return the size at a point of a face, which grows from the nearest elements of the
        curves.

        Gmsh alone takes the mean of a fine and a coarse side, which leaves needles on the fine one.
        """
        number = {int(tag): k for k, tag in enumerate(gmsh.model.mesh.getNodes()[0])}
        x = np.reshape(gmsh.model.mesh.getNodes()[1], (-1, 3))[:, :2]
        nodes = np.concatenate(
            [gmsh.model.mesh.getElements(1, curve)[2][0] for curve in self._curves.tags]
        )
        ends = x[[number[int(node)] for node in nodes]].reshape(-1, 2, 2)
        length, tree = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1), cKDTree(ends.mean(axis=1))
        count = min(_NEIGHBOURS, len(length))

        def callback(dim: int, tag: int, x: float, y: float, z: float, lc: float) -> float:
            away, nearest = tree.query((x, y), count)
            grown = float(np.min(length[nearest] + _GROWTH * away))
            return min(self._faces.get(tag, lc), self._near(x, y), grown)

        return callback

    def _near(self, x: float, y: float) -> float:
        """Return the size that grows from points given with their sizes."""
        return float((self._there + _GROWTH * np.hypot(*(self._at - (x, y)).T)).min(initial=np.inf))
