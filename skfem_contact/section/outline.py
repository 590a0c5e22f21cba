"""Outlines of areas and lines of a section: straight segments and circular arcs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike

from ..arrays import cross_in_plane, left_of, max_abs, row_norms
from ..checks import finite, format_point, positive, vector

#: Points nearer than this share of the size of an outline are one point.
_SAME = 1e-9
#: Number of chords in place of an arc where outlines are searched for crossings.
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
        self._check_count(points, 2)
        size = np.ptp(points, axis=0).max()

        # Drop a last point that repeats the first one
        repeated = self.closed and max_abs(points[0] - points[-1]) <= _SAME * size
        if repeated:
            points = points[:-1]
        segments = len(points) - (not self.closed)
        bulges = self._bulges_of(segments, repeated)

        # Drop segments without length
        steps = np.roll(points, -1, axis=0)[:segments] - points[:segments]
        kept = np.abs(steps).max(axis=1) > _SAME * size
        bulges = bulges[kept]
        if self.closed:
            points = points[kept]
            self._check_count(points, 2 if bulges.any() else 3)
        else:
            points = points[np.append(kept, True)]
            self._check_count(points, 2)

        object.__setattr__(self, "points", points)
        object.__setattr__(self, "bulges", bulges)
        if self.closed and abs(self.area) <= _SAME * float(np.ptp(points, axis=0).max()) ** 2:
            raise ValueError(
                f"'{self.name}' has no area: its points lie on a line, or it crosses itself"
            )

    def _bulges_of(self, segments: int, repeated: bool) -> ndarray:
        """Return a bulge for each segment; a last point that repeats the first one has none."""
        bulges = finite(self.bulges, f"bulges of '{self.name}'")
        if bulges.ndim and repeated:
            bulges = bulges[:segments]
        if bulges.shape not in ((), (segments,)):
            raise ValueError(f"'{self.name}' has {segments} segments, but {bulges.size} bulges")
        return np.broadcast_to(bulges, (segments,))

    def _check_count(self, points: ndarray, least: int) -> None:
        """Refuse fewer points than an area or a line needs."""
        if len(points) < least:
            need = "a line needs two"
            if self.closed:
                need = "an area needs three"
            raise ValueError(f"'{self.name}' has {len(points)} different points: {need}")

    @property
    def ends(self) -> tuple[ndarray, ndarray]:
        """First and last points of the segments, (m, 2) each."""
        m = len(self.bulges)
        return self.points[:m], np.roll(self.points, -1, axis=0)[:m]

    @property
    def centres(self) -> ndarray:
        """Centres of the arcs, (m, 2); not finite for straight segments."""
        a, b = self.ends
        chord = b - a
        normal = left_of(chord)
        t = self.bulges[:, None]
        with np.errstate(divide="ignore", invalid="ignore"):
            return 0.5 * (a + b) + normal * (1.0 - t * t) / (4.0 * t)

    @property
    def length(self) -> float:
        """Length of all segments."""
        # Arc with the tangent t of a quarter of its angle: l = chord (1 + t**2) / t arctan(t)
        chord = row_norms(np.subtract(*self.ends))
        bulge = np.abs(self.bulges)
        t = np.where(bulge > 0.0, bulge, 1.0)
        arc = chord * (1.0 + t * t) / t * np.arctan(t)
        return float(np.where(bulge > 0.0, arc, chord).sum())

    @property
    def area(self) -> float:
        """Area that the outline encloses, positive if it goes anticlockwise."""
        # Area of the polygon, and of a cap r**2 / 2 (angle - sin angle) over each chord
        (x, y), (u, v) = (end.T for end in self.ends)
        chord = np.hypot(u - x, v - y)
        bulge = np.abs(self.bulges)
        t = np.where(bulge > 0.0, bulge, 1.0)
        angle = 4.0 * np.arctan(t)
        radius = chord * (1.0 + t * t) / (4.0 * t)
        caps = np.sign(self.bulges) * 0.5 * radius**2 * (angle - np.sin(angle))
        return float(0.5 * (x * v - u * y).sum() + caps.sum())

    def chords(self, n: int = _CHORDS) -> tuple[ndarray, ndarray, ndarray]:
        """Return first and last points of chords, (k, 2) each, and their segments; n for an arc."""
        starts = []
        stops = []
        segments = []
        for k, (a, b, centre, t) in enumerate(zip(*self.ends, self.centres, self.bulges)):
            points = np.array([a, b])
            if t:
                # Turn the arm from the centre to the first point by 4 arctan(t)
                share = np.linspace(0.0, 1.0, n + 1)
                turn = np.exp(1j * 4.0 * np.arctan(t) * share)
                arm = complex(*(a - centre)) * turn
                on_arc = centre + np.column_stack((arm.real, arm.imag))
                points = np.vstack((a, on_arc[1:-1], b))
            starts.append(points[:-1])
            stops.append(points[1:])
            segments += [k] * (len(points) - 1)
        return np.vstack(starts), np.vstack(stops), np.array(segments)

    def check_simple(self, name: str) -> None:
        """Refuse an outline or a line that crosses or touches itself."""
        point = self._touching_point()
        if point is None:
            return
        problem = f"'{name}' crosses or touches itself near {format_point(point)}"
        if self.closed:
            problem += "; give its points in order round the area"
        raise ValueError(problem)

    def _touching_point(self) -> ndarray | None:
        """Return a point where the outline turns back, crosses or touches itself."""
        a, b, _ = self.chords()
        n = len(a)

        # Find chords that turn back along the chord before
        before = np.arange(n if self.closed else n - 1)
        u = (b - a)[before]
        v = (b - a)[(before + 1) % n]
        scale = _SAME * row_norms(u) * row_norms(v)
        parallel = np.abs(cross_in_plane(u, v)) <= scale
        opposite = (u * v).sum(axis=1) < 0.0
        back = parallel & opposite
        if n > 2 and back.any():
            chord = before[np.argmax(back)]
            return np.asarray(b[chord])

        # Find chords that meet others than their neighbours
        first, second = np.triu_indices(n, 1)
        at_seam = (first == 0) & (second == n - 1) & self.closed
        neighbours = (second - first == 1) | at_seam
        first = first[~neighbours]
        second = second[~neighbours]
        met = _meet(a[first], b[first], a[second], b[second])
        if not met.any():
            return None
        i = first[np.argmax(met)]
        j = second[np.argmax(met)]
        return _crossing(a[i], b[i], a[j], b[j])


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
    points = vector(centre, 2, "centre") + positive(radius, "radius") * corners
    return Outline(points, np.tan(np.pi / 8))


def rectangle(x: Sequence[float], y: Sequence[float]) -> Outline:
    """Return the outline of a rectangle between two abscissas and two heights.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> sc.section.rectangle((0., 4.), (-3., 0.)).area
    12.0
    """
    left, right = np.sort(vector(x, 2, "x"))
    low, high = np.sort(vector(y, 2, "y"))
    return Outline([(left, low), (right, low), (right, high), (left, high)])


def outlines_of(shape: Any, name: str, closed: bool) -> tuple[Outline, ...]:
    """Return the outlines of a shape: an outline, points, or a list of either."""
    first: Any = shape[0] if isinstance(shape, (list, tuple)) and shape else ()
    several = isinstance(first, Outline) or np.ndim(first) == 2
    outlines = []
    for piece in shape if several else [shape]:
        outline = piece
        if not isinstance(piece, Outline):
            outline = Outline(piece, closed=closed, name=name)
        if closed and not outline.closed:
            raise ValueError(f"'{name}' must be a closed outline")
        outline.check_simple(name)
        outlines.append(outline)
    return tuple(outlines)


def turn(u: ndarray, v: ndarray) -> float:
    """Return the angle by which the second of two vectors is turned, anticlockwise."""
    return float(np.arctan2(cross_in_plane(u, v), u @ v))


def _side(a: ndarray, b: ndarray, c: ndarray) -> ndarray:
    """Return the side of lines through a and b on which points c lie: -1, 0 or 1."""
    u = b - a
    v = c - a
    length = row_norms(u)
    scale = length * np.maximum(row_norms(v), length)
    value = cross_in_plane(u, v)
    return np.where(np.abs(value) <= _SAME * scale, 0.0, np.sign(value))


def _meet(a: ndarray, b: ndarray, c: ndarray, d: ndarray) -> ndarray:
    """Return which segments a-b and c-d have a point in common."""
    low = np.maximum(np.minimum(a, b), np.minimum(c, d))
    high = np.minimum(np.maximum(a, b), np.maximum(c, d))
    size = np.abs(b - a).max(axis=1, keepdims=True)
    near = (low <= high + _SAME * size).all(axis=1)
    parted = _side(a, b, c) * _side(a, b, d) <= 0.0
    return near & parted & (_side(c, d, a) * _side(c, d, b) <= 0.0)


def _crossing(a: ndarray, b: ndarray, c: ndarray, d: ndarray) -> ndarray:
    """Return where two segments cross."""
    u = b - a
    v = d - c
    w = c - a
    cross = u[0] * v[1] - u[1] * v[0]
    if not cross:
        return c
    share = (w[0] * v[1] - w[1] * v[0]) / cross
    return a + u * share
