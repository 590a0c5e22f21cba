"""Marks on plane bodies: water, supports, loads, arrows, points, contact."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import chain, cycle
from typing import Any

import numpy as np
import scipy
from numpy import ndarray

from ..arrays import left_of, row_norms
from ..contact.laws import Status
from ..forms.solid import SolidForm
from ..loads import hydrostatic
from ..results.fields import Shown, Water, solids
from ..results.stage import StageResult
from ..results.strength import PointStatus, point_status
from ..results.tractions import interfaces
from ..water import Seepage
from .scene import MARK, OUTLINE, Scene
from .structures import structures

WATER = "#1468b3"
_WATER_TABLE = "water table"
#: Colours of several water tables.
_WATERS = (WATER, "#00897b", "#6a3d9a", "#5c6bc0")
_LOAD = "#b3007d"
_MOVED = "#222222"
_TRACTION = "#5b2c83"
_POINTS = {
    PointStatus.YIELDS: ("yields", "#c8102e"),
    PointStatus.TENSION: ("at tensile strength", "#ffffff"),
}
_STATUS = {
    Status.OPEN: ("open", "#ffffff"),
    Status.STICK: ("sticks", "#1a7f37"),
    Status.SLIP: ("slips", "#f28e00"),
}
#: Lengths in pixels of the longest arrows of loads, displacements and tractions.
_LONG_LOAD = 70.0
_LONG_ARROW = 55.0
_LONG_TRACTION = 60.0
#: Width of beams, reinforcement and bars, in pixels.
_THICK = 5.0
#: Size of the triangles of supports, and least distance of marked nodes, in pixels.
_SUPPORT = 15.0
_APART = 34.0
#: Points of a water table over the width of the bodies: dashes and gaps are four steps long.
_STEPS = 200
#: Number of displacements at most whose arrows are shortened.
_FEW = 3
#: Forces below this share of the largest one get no arrow.
_SMALL = 0.02


@dataclass(frozen=True)
class Marks:
    """Marks on the picture of a stage, with the arguments of :func:`contour`."""

    stage: StageResult
    water: Shown | None = None
    supports: ndarray | None = None
    loads: ndarray | None = None
    vectors: bool = False
    points: bool = False
    contact: bool = False

    @property
    def room(self) -> float:
        """Margin that the marks need, as a share of the bodies' size."""
        if self.loads is not None:
            return 0.08
        if self.supports is not None:
            return 0.045
        return 0.0

    def draw(self, plotter: Any, scene: Scene) -> None:
        """Draw structures and all marks."""
        _draw_structures(plotter, scene, self.stage)

        # Draw water, supports, loads and displacements.
        for (_, water), color in zip(self._waters, cycle(_WATERS), strict=False):
            _draw_water(plotter, scene, water, color)
        if self.supports is not None:
            _draw_supports(plotter, scene, np.asarray(self.supports))
        if self.loads is not None:
            _draw_loads(plotter, scene, np.asarray(self.loads))
        if self.vectors:
            _draw_vectors(plotter, scene)

        # Draw the marks at points on top.
        for status, form, marked in self._points():
            u = form.basis.interpolate(scene.factor * scene.displacement.ravel())
            points = np.asarray(form.basis.global_coordinates()) + np.asarray(u)
            _, color = _POINTS[status]
            _dots(plotter, scene, points[:, marked].T, color, 7.0)
        if self.contact:
            _draw_contact(plotter, scene, self.stage)

    def legend(self) -> list[tuple[str, dict[str, Any]]]:
        """Return labels and matplotlib's line styles of the marks that need an explanation."""
        # List what is drawn: water, points that yield, contact by status.
        entries: list[tuple[str, dict[str, Any]]] = []
        if self.water is not None and self.water is not False:
            names = [name for name, _ in self._waters] or [_WATER_TABLE]
            for name, color in zip(names, cycle(_WATERS), strict=False):
                entries.append((name, {"color": color, "linewidth": 3, "linestyle": "--"}))
        marked = {status for status, _, _ in self._points()}
        for status, (label, color) in _POINTS.items():
            if status in marked:
                entries.append((label, _square(color)))
        if self.contact:
            entries += _legend_of_contact(self.stage)
        return entries

    @property
    def _waters(self) -> list[tuple[str, Any]]:
        """Pressures of the water that is drawn, with names."""
        if self.water is True:
            return named_waters(self.stage.water)
        return named_waters(self.water)

    def _points(self) -> Iterator[tuple[PointStatus, SolidForm, ndarray]]:
        """Yield each status that is marked, a solid, and a mask of its points."""
        if not self.points:
            return
        for name, form in solids(self.stage).items():
            of_points = point_status(form, self.stage.states[name])
            for status in _POINTS:
                marked = of_points == status
                if marked.any():
                    yield status, form, marked


def _legend_of_contact(stage: StageResult) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield label and style of each status that contact points have."""
    present: set[int] = set()
    for pair in interfaces(stage).values():
        present.update(pair.tractions.status.tolist())
    for kind, (label, color) in _STATUS.items():
        if kind in present:
            yield f"contact {label}", _square(color)


def _square(color: str) -> dict[str, Any]:
    return {
        "marker": "s",
        "color": color,
        "linestyle": "none",
        "markersize": 11,
        "markeredgecolor": "black",
    }


def _dots(plotter: Any, scene: Scene, points: ndarray, color: str, size: float) -> None:
    """Draw points with a dark edge."""
    for level, grown, shade in ((MARK, 3.0, "black"), (MARK + 1, 0.0, color)):
        plotter.add_points(
            scene.in_space(points, level), color=shade, point_size=size + grown, lighting=False
        )


def _draw_structures(plotter: Any, scene: Scene, stage: StageResult) -> None:
    """Draw beams, reinforcement and bars as lines, displaced like the bodies."""
    for line in structures(stage):
        points = line.points + scene.factor * line.displacement
        m, n, dim = points.shape
        sides = np.arange(m * n).reshape(m, n)
        lines = scene.lines(sides, points.reshape(-1, dim), OUTLINE)
        plotter.add_mesh(lines, color=line.color, line_width=_THICK, lighting=False)


def _draw_water(plotter: Any, scene: Scene, water: Water, color: str) -> None:
    """Draw water tables as dashed lines, the longest with a triangle on it."""
    # Four of eight pieces of a line are drawn.
    lines = water_tables(scene, water)
    for line in lines:
        starts = line[:-1]
        ends = line[1:]
        dashes = np.arange(len(starts)) % 8 < 4
        _segments(plotter, scene, starts[dashes], ends[dashes], color, 5)
    if lines:
        # The usual triangle of a water table.
        corners = np.array([[-0.6, 1.0], [0.6, 1.0], [0.0, 0.0]])
        triangle = 14.0 * scene.pixel * corners
        tip = lines[0][len(lines[0]) // 20]
        _polygons(plotter, scene, (tip + triangle)[None], color)


def named_waters(water: Any) -> list[tuple[str, Any]]:
    """Return the pressures of water that can be drawn, with names: by region where they differ."""
    if not isinstance(water, Mapping):
        return [(_WATER_TABLE, pressure) for pressure in pressures_of(water)]
    # One line may be that of several regions.
    names: dict[int, list[str]] = {}
    pressures: dict[int, Any] = {}
    for region, part in water.items():
        names.setdefault(id(part), []).append(region)
        pressures[id(part)] = part
    found = []
    for key, part in pressures.items():
        if len(pressures) == 1:
            name = _WATER_TABLE
        else:
            name = f"water table, {', '.join(names[key])}"
        found += [(name, pressure) for pressure in pressures_of(getattr(part, "pressure", part))]
    return found


def pressures_of(water: Any) -> list[Any]:
    """Return the pressures of water, without water that cannot be drawn."""
    if water is None or water is False or isinstance(water, str):
        return []
    if isinstance(water, Mapping):
        parts = [getattr(part, "pressure", part) for part in water.values()]
        return list(chain.from_iterable(map(pressures_of, parts)))
    # Objects with a pressure, functions, levels and polylines.
    pressure = getattr(water, "pressure_at", water)
    if callable(pressure):
        return [pressure]
    level = np.asarray(water, float)
    is_level = level.ndim == 0 or level.shape[-1:] == (2,)
    if is_level:
        return [hydrostatic(water, unit_weight=1.0)]
    return []


def water_tables(scene: Scene, water: Water) -> list[ndarray]:
    """Return free surfaces of seepage; of another pressure, the line at which it falls to zero."""
    points = scene.coordinates[scene.nodes]
    west, south = points.min(axis=0)
    east, north = points.max(axis=0)
    seepage = getattr(water, "__self__", water)  # of a method `pressure_at`
    if isinstance(seepage, Seepage):
        return [_evenly(line, (east - west) / _STEPS) for line in seepage.free_surface]
    x = np.linspace(west, east, _STEPS + 1)
    y = _table(water, x, south, north + (north - south))
    line = np.column_stack((x, y))[np.isfinite(y)]
    if len(line):
        return [line]
    return []


def _evenly(line: ndarray, step: float) -> ndarray:
    """Return points (n, 2) along a polyline, about `step` from each other."""
    lengths = row_norms(np.diff(line, axis=0))
    arc = np.append(0.0, lengths.cumsum())
    even = np.linspace(0.0, arc[-1], max(2, round(arc[-1] / step)))
    return np.column_stack([np.interp(even, arc, values) for values in line.T])


def _table(water: Any, x: ndarray, low: float, high: float) -> ndarray:
    """Return heights of zero pressure, (n,), by bisection; NaN where the bottom is dry."""
    below = np.full(len(x), low)
    above = np.full(len(x), high)
    wet = water(np.stack((x, below))) > 0.0
    for _ in range(40):
        middle = 0.5 * (below + above)
        inside = water(np.stack((x, middle))) > 0.0
        below = np.where(inside, middle, below)
        above = np.where(inside, above, middle)
    return np.where(wet, below, np.nan)


def _draw_supports(plotter: Any, scene: Scene, fixed: ndarray) -> None:
    """Draw triangles at fixed nodes: along the axis of a fixed dof, from below for both dofs."""
    # Find the fixed directions of each node.
    if fixed.dtype == bool:
        fixed = np.flatnonzero(fixed)
    dofs = np.arange(scene.displacement.size)
    x, y = np.isin(dofs, fixed).reshape(-1, 2).T
    used = np.unique(scene.sides.mesh)
    size = _SUPPORT * scene.pixel
    middle = scene.coordinates[used].mean(axis=0)

    # Draw the triangles of each kind outside of the bodies.
    kinds = (
        (1, x & y, "#444444"),
        (0, x & ~y, "#b0b0b0"),
        (1, y & ~x, "#b0b0b0"),
    )
    for axis, is_fixed, color in kinds:
        if not is_fixed[used].any():
            continue
        tips = scene.moved[_thinned(scene, used[is_fixed[used]])]
        out = np.zeros_like(tips)
        out[:, axis] = np.where(tips[:, axis] > middle[axis], 1.0, -1.0)
        along = out[:, ::-1]
        first = tips + size * (out + 0.6 * along)
        second = tips + size * (out - 0.6 * along)
        _polygons(plotter, scene, np.stack((tips, first, second), axis=1), color)


def _thinned(scene: Scene, nodes: ndarray) -> ndarray:
    """Return some of the nodes, no two closer to each other than a few pixels."""
    order = nodes[np.lexsort(scene.moved[nodes].T)]
    points = scene.moved[order]
    neighbours = scipy.spatial.cKDTree(points).query_ball_point(points, _APART * scene.pixel)
    kept = np.ones(len(order), bool)
    for i, near in enumerate(neighbours):
        if kept[i]:
            kept[[j for j in near if j > i]] = False
    return order[kept]


def _draw_loads(plotter: Any, scene: Scene, load: ndarray) -> None:
    """Draw nodal forces as arrows that end at their nodes."""
    n = scene.displacement.size
    if len(load) < n:
        raise ValueError(f"loads have {len(load)} dofs, the bodies {n}")
    seen, vectors = _scaled(load[:n].reshape(-1, 2), _LONG_LOAD * scene.pixel)
    tips = scene.moved[seen]
    _arrows(plotter, scene, tips - vectors, tips, _LOAD)


def _draw_vectors(plotter: Any, scene: Scene) -> None:
    """Draw displacements at nodes that are some pixels apart."""
    nodes = _thinned(scene, np.unique(scene.sides.mesh))
    moves = scene.displacement[nodes]
    # A few nodes at an edge of a rigid body may move far beyond all others.
    size = row_norms(moves)
    usual = np.sort(size)[-min(len(size), _FEW + 1)]
    if usual > 0.0:
        lengths = np.where(size > 0.0, size, usual)
        moves = moves * np.minimum(usual / lengths, 1.0)[:, None]
    seen, vectors = _scaled(moves, _LONG_ARROW * scene.pixel)
    tails = scene.moved[nodes][seen]
    _arrows(plotter, scene, tails, tails + vectors, _MOVED)


def _scaled(vectors: ndarray, longest: float) -> tuple[ndarray, ndarray]:
    """Return True for vectors (n, 2) that are large enough, and these vectors at a length."""
    size = row_norms(vectors)
    largest = size.max(initial=0.0)
    seen = size > _SMALL * largest
    return seen, vectors[seen] / largest * longest


def _draw_contact(plotter: Any, scene: Scene, stage: StageResult) -> None:
    """Draw the status of contact points, and tractions as lines that end on the master."""
    pairs = list(interfaces(stage).values())
    sizes = [np.hypot(pair.tractions.pressure, pair.tractions.shear) for pair in pairs]
    largest = max((float(size.max(initial=0.0)) for size in sizes), default=0.0)
    for pair in pairs:
        t = pair.tractions
        moved = scene.factor * pair.moved_by(scene.displacement)
        points = np.column_stack((t.x, t.y)) + moved
        if largest > 0.0:
            # The shear of the slave on the master is positive along the master's chain, which runs
            # against the slave's chain.
            along = left_of(pair.normal)
            traction = t.pressure[:, None] * pair.normal + t.shear[:, None] * along
            lines = _LONG_TRACTION * scene.pixel * (traction / largest)
            _segments(plotter, scene, points - lines, points, _TRACTION, 2.5)
        for status, (_, color) in _STATUS.items():
            chosen = t.status == status
            if chosen.any():
                _dots(plotter, scene, points[chosen], color, 9.0)


def _arrows(plotter: Any, scene: Scene, tails: ndarray, tips: ndarray, color: str) -> None:
    """Draw flat arrows with heads of one size."""
    # Directions along and across.
    vectors = tips - tails
    length = row_norms(vectors)
    along = vectors / length[:, None]
    across = left_of(along)
    # Heads of 12 pixels, or half of a short arrow.
    head = np.minimum(12.0 * scene.pixel, 0.5 * length)[:, None]
    half = 0.45 * head * across
    necks = tips - head * along
    corners = np.stack((tips, necks + half, necks - half), axis=1)  # (n, 3, 2)
    _segments(plotter, scene, tails, necks, color, 3)
    _polygons(plotter, scene, corners, color)


def _segments(
    plotter: Any,
    scene: Scene,
    starts: ndarray,
    ends: ndarray,
    color: str,
    width: float,
) -> None:
    """Draw straight lines between points (n, 2)."""
    if len(starts):
        sides = np.arange(2 * len(starts)).reshape(2, -1).T
        lines = scene.lines(sides, np.concatenate((starts, ends)), MARK)
        plotter.add_mesh(lines, color=color, line_width=width)


def _polygons(plotter: Any, scene: Scene, corners: ndarray, color: str) -> None:
    """Draw filled polygons (n, k, 2)."""
    import pyvista

    if len(corners):
        points = scene.in_space(corners.reshape(-1, 2), MARK)
        faces: ndarray = np.arange(len(points)).reshape(corners.shape[:2])
        mesh = pyvista.PolyData.from_regular_faces(points, faces)
        plotter.add_mesh(mesh, color=color, lighting=False, show_edges=False)
