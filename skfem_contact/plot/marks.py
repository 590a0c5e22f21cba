"""Marks on plane bodies: water, supports, loads, arrows, points, contact."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy import ndarray
from scipy.spatial import cKDTree

from ..contact.laws import Status
from ..forms.solid import SolidForm
from ..loads import hydrostatic
from ..results.fields import Shown, Water, solids
from ..results.stage import StageResult
from ..results.strength import PointStatus, point_status
from ..results.tractions import interfaces
from ..water import Seepage
from .scene import MARK, Scene

WATER, _LOAD, _MOVED, _TRACTION = "#1468b3", "#b3007d", "#222222", "#5b2c83"
_POINTS = {
    PointStatus.YIELDS: ("yields", "#c8102e"),
    PointStatus.TENSION: ("at tensile strength", "#ffffff"),
}
_STATUS = {
    Status.OPEN: ("open", "#ffffff"),
    Status.STICK: ("sticks", "#1a7f37"),
    Status.SLIP: ("slips", "#f28e00"),
}
#: Lengths in pixels: longest arrows of loads, displacements and tractions, triangles of supports,
#: and their distance.
_LONG_LOAD, _LONG_ARROW, _LONG_TRACTION, _SUPPORT, _APART = 70.0, 55.0, 60.0, 15.0, 34.0
#: Points of a water table over the width of the bodies: dashes are four of its steps long, and so
#: are the gaps.
_STEPS = 200
#: Forces below this share of the largest one get no arrow.
_SMALL = 0.02


@dataclass(frozen=True)
class Marks:
    """Marks on the picture of a stage; the arguments are those of :func:`contour`."""

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
        return 0.08 if self.loads is not None else 0.045 if self.supports is not None else 0.0

    def draw(self, plotter: Any, scene: Scene) -> None:
        """Draw all marks."""
        if self.water is not None:
            for one in pressures_of(self.stage.water) if self.water is True else [self.water]:
                _draw_water(plotter, scene, one)
        if self.supports is not None:
            _draw_supports(plotter, scene, np.asarray(self.supports))
        if self.loads is not None:
            _draw_loads(plotter, scene, np.asarray(self.loads))
        if self.vectors:
            _draw_vectors(plotter, scene)
        for status, form, at in self._points():
            u = scene.factor * scene.displacement.ravel()
            points = np.asarray(form.basis.global_coordinates()) + np.asarray(
                form.basis.interpolate(u)
            )
            _dots(plotter, scene, points[:, at].T, _POINTS[status][1], 7.0)
        if self.contact:
            _draw_contact(plotter, scene, self.stage)

    def legend(self) -> list[tuple[str, dict[str, Any]]]:
        """Return labels and matplotlib's line styles of the marks that need an explanation."""
        found = []
        if self.water is not None:
            found.append(("water table", {"color": WATER, "linewidth": 3, "linestyle": "--"}))
        marked = {status for status, _, _ in self._points()}
        found += [
            (label, _square(color))
            for status, (label, color) in _POINTS.items()
            if status in marked
        ]
        if self.contact:
            pairs = interfaces(self.stage).values()
            present = {int(s) for pair in pairs for s in np.unique(pair.tractions.status)}
            found += [
                (f"contact {label}", _square(color))
                for s, (label, color) in _STATUS.items()
                if s in present
            ]
        return found

    def _points(self) -> Iterator[tuple[PointStatus, SolidForm, ndarray]]:
        """Return the points of each status that is marked, (n_elements, n_points), solid by
        solid.
        """
        for name, form in solids(self.stage).items() if self.points else ():
            found = point_status(form, self.stage.states[name])
            for status in _POINTS:
                if (at := found == status).any():
                    yield status, form, at


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


def _draw_water(plotter: Any, scene: Scene, water: Water) -> None:
    """Draw water tables as dashed lines, the longest with a triangle on it."""
    lines = water_tables(scene, water)
    for line in lines:
        dashes = np.arange(len(line) - 1) % 8 < 4
        _segments(plotter, scene, line[:-1][dashes], line[1:][dashes], WATER, 5)
    if lines:
        triangle = 14.0 * scene.pixel * np.array([[-0.6, 1.0], [0.6, 1.0], [0.0, 0.0]])
        _polygons(plotter, scene, (lines[0][len(lines[0]) // 20] + triangle)[None], WATER)


def pressures_of(water: Any) -> list[Any]:
    """Return pressures from a stage's water: levels and points as functions; what cannot be drawn
    is left out.
    """
    if water is None or water is False or isinstance(water, str):
        return []
    if isinstance(water, Mapping):
        return [
            part for one in water.values() for part in pressures_of(getattr(one, "pressure", one))
        ]
    if callable(pressure := getattr(water, "pressure_at", water)):
        return [pressure]
    level = np.asarray(water, float)
    return (
        [hydrostatic(water, unit_weight=1.0)] if level.ndim == 0 or level.shape[-1:] == (2,) else []
    )


def water_tables(scene: Scene, water: Water) -> list[ndarray]:
    """Return free surfaces of seepage; of another pressure, the line at which it falls to zero."""
    low, high = (
        scene.coordinates[scene.nodes].min(axis=0),
        scene.coordinates[scene.nodes].max(axis=0),
    )
    seepage = getattr(water, "__self__", water)  # also that of its pressure_at
    if isinstance(seepage, Seepage):
        return [_evenly(line, (high - low)[0] / _STEPS) for line in seepage.free_surface]
    x = np.linspace(low[0], high[0], _STEPS + 1)
    y = _table(water, x, low[1], high[1] + (high - low)[1])
    line = np.column_stack((x, y))[np.isfinite(y)]
    return [line] if len(line) else []


def _evenly(line: ndarray, step: float) -> ndarray:
    """Return points (n, 2) along a polyline, about `step` from each other."""
    arc = np.append(0.0, np.linalg.norm(np.diff(line, axis=0), axis=1).cumsum())
    even = np.linspace(0.0, arc[-1], max(2, round(arc[-1] / step)))
    return np.column_stack([np.interp(even, arc, values) for values in line.T])


def _table(water: Any, x: ndarray, low: float, high: float) -> ndarray:
    """Return heights at which the pressure becomes zero, (n,), by bisection; NaN where the bottom
    is dry.
    """
    below, above = np.full(len(x), low), np.full(len(x), high)
    wet = water(np.stack((x, below))) > 0.0
    for _ in range(40):
        middle = 0.5 * (below + above)
        inside = water(np.stack((x, middle))) > 0.0
        below, above = np.where(inside, middle, below), np.where(inside, above, middle)
    return np.where(wet, below, np.nan)


def _draw_supports(plotter: Any, scene: Scene, fixed: ndarray) -> None:
    """Draw triangles that point at the nodes that are held: along the axis of one dof, from below
    for both.
    """
    fixed = np.flatnonzero(fixed) if fixed.dtype == bool else fixed
    x, y = np.isin(np.arange(scene.displacement.size), fixed).reshape(-1, 2).T
    used, size = np.unique(scene.sides.mesh), _SUPPORT * scene.pixel
    middle = scene.coordinates[used].mean(axis=0)
    for axis, held, color in (
        (1, x & y, "#444444"),
        (0, x & ~y, "#b0b0b0"),
        (1, y & ~x, "#b0b0b0"),
    ):
        if not held[used].any():
            continue
        at = scene.moved[_thinned(scene, used[held[used]])]
        out = np.zeros_like(at)
        out[:, axis] = np.where(at[:, axis] > middle[axis], 1.0, -1.0)
        along = out[:, ::-1]
        corners = np.stack(
            (at, at + size * (out + 0.6 * along), at + size * (out - 0.6 * along)), axis=1
        )
        _polygons(plotter, scene, corners, color)


def _thinned(scene: Scene, nodes: ndarray) -> ndarray:
    """Return some of the nodes, no two closer to each other than a few pixels."""
    order = nodes[np.lexsort(scene.moved[nodes].T)]
    tree = cKDTree(scene.moved[order])
    kept = np.ones(len(order), bool)
    for i, near in enumerate(tree.query_ball_point(scene.moved[order], _APART * scene.pixel)):
        if kept[i]:
            kept[[j for j in near if j > i]] = False
    return order[kept]


def _draw_loads(plotter: Any, scene: Scene, load: ndarray) -> None:
    """Draw nodal forces as arrows that end at their nodes."""
    if len(load) < scene.displacement.size:
        raise ValueError(f"loads have {len(load)} dofs, the bodies {scene.displacement.size}")
    force, moved = load[: scene.displacement.size].reshape(-1, 2), scene.moved
    size = np.linalg.norm(force, axis=1)
    seen = size > _SMALL * size.max(initial=0.0)
    vectors = force[seen] / size.max(initial=0.0) * _LONG_LOAD * scene.pixel
    _arrows(plotter, scene, moved[seen] - vectors, moved[seen], _LOAD)


def _draw_vectors(plotter: Any, scene: Scene) -> None:
    """Draw displacements at nodes that are some pixels apart."""
    nodes = _thinned(scene, np.unique(scene.sides.mesh))
    u, moved = scene.displacement[nodes], scene.moved[nodes]
    size = np.linalg.norm(u, axis=1)
    seen = size > _SMALL * size.max(initial=0.0)
    vectors = u[seen] / size.max(initial=0.0) * _LONG_ARROW * scene.pixel
    _arrows(plotter, scene, moved[seen], moved[seen] + vectors, _MOVED)


def _draw_contact(plotter: Any, scene: Scene, stage: StageResult) -> None:
    """Draw the status of contact points, and the tractions of the slave on the master as lines that
    end there.
    """
    found = interfaces(stage).values()
    sizes = [np.hypot(i.tractions.pressure, i.tractions.shear).max(initial=0.0) for i in found]
    largest = float(max(sizes, default=0.0))
    for interface in found:
        t = interface.tractions
        at = np.column_stack((t.x, t.y)) + scene.factor * interface.moved_by(scene.displacement)
        if largest > 0.0:
            # shear of the slave on the master is positive along the master's chain, which runs
            # against the slave's
            along = np.column_stack((interface.normal[:, 1], -interface.normal[:, 0]))
            drawn = (t.pressure[:, None] * interface.normal + t.shear[:, None] * -along) / largest
            _segments(plotter, scene, at - _LONG_TRACTION * scene.pixel * drawn, at, _TRACTION, 2.5)
        for status, (_, color) in _STATUS.items():
            chosen = t.status == status
            if chosen.any():
                _dots(plotter, scene, at[chosen], color, 9.0)


def _arrows(plotter: Any, scene: Scene, tails: ndarray, tips: ndarray, color: str) -> None:
    """Draw flat arrows with heads of one size."""
    length = np.linalg.norm(tips - tails, axis=1)
    head = np.minimum(12.0 * scene.pixel, 0.5 * length)[:, None]
    along = (tips - tails) / length[:, None]
    half = 0.45 * head * np.column_stack((-along[:, 1], along[:, 0]))
    necks = tips - head * along
    _segments(plotter, scene, tails, necks, color, 3)
    _polygons(plotter, scene, np.stack((tips, necks + half, necks - half), axis=1), color)


def _segments(
    plotter: Any, scene: Scene, starts: ndarray, ends: ndarray, color: str, width: float
) -> None:
    """Draw straight lines between points (n, 2)."""
    if len(starts):
        sides = np.arange(2 * len(starts)).reshape(2, -1).T
        plotter.add_mesh(
            scene.lines(sides, np.concatenate((starts, ends)), MARK), color=color, line_width=width
        )


def _polygons(plotter: Any, scene: Scene, corners: ndarray, color: str) -> None:
    """Draw filled polygons (n, k, 2)."""
    import pyvista

    if len(corners):
        points = scene.in_space(corners.reshape(-1, 2), MARK)
        faces: ndarray = np.arange(len(points)).reshape(corners.shape[:2])
        mesh = pyvista.PolyData.from_regular_faces(points, faces)
        plotter.add_mesh(mesh, color=color, lighting=False, show_edges=False)
