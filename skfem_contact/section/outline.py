"""Outlines of areas and lines of a section: straight segments and circular arcs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike

from ..checks import finite, format_point, positive, vector

#: Points nearer than this share of the size of an outline are one point.
_SAME = 1e-9
#: Chords that stand for an arc where outlines are searched for crossings.
_CHORDS = 12


@dataclass(frozen=True)
class Outline:
    """A closed outline, or an open line, of straight segments and circular arcs.

    Parameters
    ----------
    points
        Corners (n, 2) in their order. A last point that repeats the first one is dropped from a
        closed outline.
    bulges
        Tangent of a quarter of the angle of each segment, as in drawings: 0 for a straight one, 1
        for a half circle, positive where the arc is to the right of its chord. One for each
        segment, or one for all.
    closed
        True for the outline of an area.

    Raises
    ------
    ValueError
        Fewer points than an outline or a line needs, numbers that are not finite, an outline
        without an area.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> half = sc.section.Outline([(-1, 0), (1, 0)], bulges=[0, 1])
    >>> f"{half.area:.6f} {half.length:.6f}"
    '1.570796 5.141593'
    """

    points: Any
    bulges: Any = 0.0
    closed: bool = True
    name: str = field(default="outline", repr=False)

    def __post_init__(self) -> None:
        points = finite(self.points, f"points of '{self.name}'")
        if points.ndim != 2 or points.shape[1] != 2:
            raise ValueError(
                f"points of '{self.name}' must be points (x, y), not of the shape {points.shape}"
            )
        bulges = finite(self.bulges, f"bulges of '{self.name}'")
        segments = len(points) if self.closed else len(points) - 1
        if self.closed and len(points) > 1 and _near(points[0], points[-1], points):
            points, segments = points[:-1], len(points) - 1
            bulges = bulges[:segments] if bulges.ndim else bulges
        if bulges.ndim and bulges.shape != (segments,):
            raise ValueError(f"'{self.name}' has {segments} segments, but {bulges.size} bulges")
        bulges = np.broadcast_to(bulges, (segments,))
        following = np.roll(points, -1, axis=0)[:segments]
        kept = [not _near(a, b, points) for a, b in zip(points, following)]
        bulges = bulges[kept]
        points = points[kept if self.closed else [*kept, True]] if segments else points
        if len(points) < 2 or (self.closed and len(points) < 3 and not bulges.any()):
            raise ValueError(
                f"'{self.name}' has {len(points)} different points: "
                f"{'an area needs three' if self.closed else 'a line needs two'}"
            )
        object.__setattr__(self, "points", points)
        object.__setattr__(self, "bulges", bulges)
        if self.closed and abs(self.area) <= _SAME * float(np.ptp(points, axis=0).max()) ** 2:
            raise ValueError(
                f"'{self.name}' has no area: its points lie on a line, or it crosses itself"
            )

    @property
    def ends(self) -> tuple[ndarray, ndarray]:
        """First and last points of the segments, (m, 2) each."""
        m = len(self.bulges)
        return self.points[:m], np.roll(self.points, -1, axis=0)[:m]

    @property
    def centres(self) -> ndarray:
        """Centres of the arcs, (m, 2); those of straight segments are not finite."""
        a, b = self.ends
        chord, t = b - a, self.bulges[:, None]
        with np.errstate(divide="ignore", invalid="ignore"):
            return 0.5 * (a + b) + np.column_stack((-chord[:, 1], chord[:, 0])) * (1.0 - t * t) / (
                4.0 * t
            )

    @property
    def length(self) -> float:
        """Length of all segments."""
        chord, t = np.linalg.norm(np.subtract(*self.ends), axis=1), np.abs(self.bulges)
        round_ = t > 0.0
        t = np.where(round_, t, 1.0)
        return float(np.where(round_, chord * (1.0 + t * t) / t * np.arctan(t), chord).sum())

    @property
    def area(self) -> float:
        """Area that the outline encloses, positive if it goes anticlockwise."""
        (x, y), (u, v) = (end.T for end in self.ends)
        chord, t = np.hypot(u - x, v - y), np.abs(self.bulges)
        t = np.where(t > 0.0, t, 1.0)
        angle, radius = 4.0 * np.arctan(t), chord * (1.0 + t * t) / (4.0 * t)
        caps = np.sign(self.bulges) * 0.5 * radius**2 * (angle - np.sin(angle))
        return float(0.5 * (x * v - u * y).sum() + caps.sum())

    def chords(self, n: int = _CHORDS) -> tuple[ndarray, ndarray, ndarray]:
        """Return first and last points of chords, (k, 2) each, n for each arc, and the segments
        that they belong to.
        """
        starts, stops, segments = [], [], []
        for k, (a, b, centre, t) in enumerate(zip(*self.ends, self.centres, self.bulges)):
            points = np.array([a, b])
            if t:
                turn = np.exp(1j * 4.0 * np.arctan(t) * np.linspace(0.0, 1.0, n + 1))
                arm = complex(*(a - centre)) * turn
                points = np.vstack((a, centre + np.column_stack((arm.real, arm.imag))[1:-1], b))
            starts.append(points[:-1])
            stops.append(points[1:])
            segments += [k] * (len(points) - 1)
        return np.vstack(starts), np.vstack(stops), np.array(segments)

    def check_simple(self, name: str) -> None:
        """Refuse an outline or a line that crosses or touches itself."""
        a, b, _ = self.chords()
        n = len(a)
        first, second = np.triu_indices(n, 1)
        apart = (second - first > 1) & ~((first == 0) & (second == n - 1) & self.closed)
        first, second = first[apart], second[apart]
        met = _meet(a[first], b[first], a[second], b[second])
        after = np.arange(n if self.closed else n - 1)
        way, next_ = (b - a)[after], (b - a)[(after + 1) % n]
        cross = way[:, 0] * next_[:, 1] - way[:, 1] * next_[:, 0]
        back = (
            np.abs(cross) <= _SAME * np.linalg.norm(way, axis=1) * np.linalg.norm(next_, axis=1)
        ) & ((way * next_).sum(axis=1) < 0.0)
        if met.any() or (back.any() and n > 2):
            at = (
                b[after[np.argmax(back)]]
                if back.any()
                else _crossing(
                    *(x[np.argmax(met)] for x in (a[first], b[first], a[second], b[second]))
                )
            )
            raise ValueError(
                f"'{name}' crosses or touches itself near {format_point(at)}; give its points in "
                f"order "
                "round the area"
                if self.closed
                else f"'{name}' crosses or touches itself near {format_point(at)}"
            )


def circle(centre: ArrayLike, radius: float) -> Outline:
    """Return the outline of a circle.

    Parameters
    ----------
    centre
        Its centre, (2,).
    radius
        Its radius.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> f"{sc.section.circle((0., -10.), 3.).area / 9:.6f}"
    '3.141593'
    """
    corners = np.array([(1, 0), (0, 1), (-1, 0), (0, -1)])
    return Outline(
        vector(centre, 2, "centre") + positive(radius, "radius") * corners, np.tan(np.pi / 8)
    )


def rectangle(x: Sequence[float], y: Sequence[float]) -> Outline:
    """Return the outline of a rectangle between two abscissas and two heights.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> sc.section.rectangle((0., 4.), (-3., 0.)).area
    12.0
    """
    (left, right), (low, high) = np.sort(vector(x, 2, "x")), np.sort(vector(y, 2, "y"))
    return Outline([(left, low), (right, low), (right, high), (left, high)])


def outlines_of(shape: Any, name: str, closed: bool) -> tuple[Outline, ...]:
    """Return the outlines of a shape: an outline, points, or a list of either; each crosses itself
    nowhere.
    """
    pieces = [shape]
    if (
        isinstance(shape, (list, tuple))
        and shape
        and (isinstance(shape[0], Outline) or np.ndim(shape[0]) == 2)
    ):
        pieces = list(shape)
    found = []
    for piece in pieces:
        outline = piece if isinstance(piece, Outline) else Outline(piece, closed=closed, name=name)
        if closed and not outline.closed:
            raise ValueError(f"'{name}' must be a closed outline")
        outline.check_simple(name)
        found.append(outline)
    return tuple(found)


def _near(a: ndarray, b: ndarray, points: ndarray) -> bool:
    return bool(np.abs(a - b).max() <= _SAME * np.ptp(points, axis=0).max())


def _side(a: ndarray, b: ndarray, c: ndarray) -> ndarray:
    """Return the side of lines through a and b on which points c lie, relative to the lengths."""
    u, v = b - a, c - a
    scale = np.linalg.norm(u, axis=1) * np.maximum(
        np.linalg.norm(v, axis=1), np.linalg.norm(u, axis=1)
    )
    value = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    return np.where(np.abs(value) <= _SAME * scale, 0.0, np.sign(value))


def _meet(a: ndarray, b: ndarray, c: ndarray, d: ndarray) -> ndarray:
    """Return which segments a-b and c-d have a point in common."""
    boxes = (
        np.maximum(np.minimum(a, b), np.minimum(c, d))
        <= np.minimum(np.maximum(a, b), np.maximum(c, d))
        + _SAME * np.abs(b - a).max(axis=1, keepdims=True)
    ).all(axis=1)
    return (
        boxes & (_side(a, b, c) * _side(a, b, d) <= 0.0) & (_side(c, d, a) * _side(c, d, b) <= 0.0)
    )


def _crossing(a: ndarray, b: ndarray, c: ndarray, d: ndarray) -> ndarray:
    """Return where two segments cross."""
    u, v, w = b - a, d - c, c - a
    cross = u[0] * v[1] - u[1] * v[0]
    return a + u * ((w[0] * v[1] - w[1] * v[0]) / cross) if cross else c
