"""Curves of a drawing: entities as chains of segments and arcs, joined, without doubles."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np
import scipy
from numpy import ndarray

from ..arrays import cross_in_plane, max_abs, row_norms
from ..checks import format_point
from ..sparse import parts_of
from .outline import turn

#: Largest distance of the arcs of ellipses and splines, and of the chords of curves in space, from
#: the curve, as a share of the drawing; share of it that the chords have through which arcs go.
_FLAT = 2e-5
_FINE = 0.1
#: Largest half of the angle of an arc, and the one below which it is a segment.
_HALF = 0.25 * np.pi
_STRAIGHT = 1e-9
#: Types of entities that are curves.
_CURVES = {"LINE", "LWPOLYLINE", "POLYLINE", "ARC", "CIRCLE", "ELLIPSE", "SPLINE"}
#: Types of plane curves that keep their arcs.
_ROUND = {"LWPOLYLINE", "ARC", "CIRCLE"}
#: Types of smooth curves, which become arcs.
_SMOOTH = {"ELLIPSE", "SPLINE"}
#: Types of entities that are texts; they name curves.
TEXTS = {"TEXT", "MTEXT"}
#: Decimals of coordinates and bulges by which doubles are known.
_DECIMALS = 9


class Chain(NamedTuple):
    """Points (n, 2) with the bulges of the segments between them: n if it is closed, else n - 1."""

    points: ndarray
    bulges: ndarray
    closed: bool

    @property
    def gap(self) -> float:
        """Distance of both ends."""
        return float(np.linalg.norm(self.points[0] - self.points[-1]))

    def turned(self) -> Chain:
        """Return the chain from its end to its beginning."""
        return Chain(self.points[::-1], -self.bulges[::-1], self.closed)


def plane(point: Any) -> ndarray:
    """Return the coordinates x and y of a point of a drawing."""
    return np.array([point[0], point[1]], float)


def entities(space: Any, layer: str = "0") -> Iterator[tuple[Any, str]]:
    """Yield the entities of a drawing and of its inserted blocks, each with its layer.

    Entities on layer 0 of a block have the layer of its insert. Every copy of an array is yielded.
    """
    for entity in space:
        own = entity.dxf.layer
        if own == "0":
            own = layer
        if entity.dxftype() != "INSERT":
            yield entity, own
            continue
        copies = [entity]
        if entity.mcount > 1:
            copies = entity.multi_insert()
        for copy in copies:
            yield from entities(copy.virtual_entities(), own)


def position(text: Any) -> ndarray:
    """Return the point of a text: where it is justified the point that it is aligned with."""
    dxf = text.dxf
    if text.dxftype() == "MTEXT":
        return plane(dxf.insert)
    justified = dxf.get("halign", 0) in (1, 2, 4) or dxf.get("valign", 0)
    if justified and dxf.hasattr("align_point"):
        return plane(text.ocs().to_wcs(dxf.align_point))
    return plane(text.ocs().to_wcs(dxf.insert))


def chain_of(entity: Any, size: float) -> Chain | None:
    """Return the chain of a curve, None for other entities."""
    kind = entity.dxftype()
    if kind not in _CURVES:
        return None
    dxf = entity.dxf
    if kind == "LINE":
        return Chain(np.array([plane(dxf.start), plane(dxf.end)]), np.zeros(1), False)

    # Keep the arcs of curves with the normal z, or -z in mirrored blocks, where x is opposite
    up = 1.0
    if dxf.hasattr("extrusion"):
        up = dxf.extrusion[2]
    round_ = kind in _ROUND or (kind == "POLYLINE" and entity.is_2d_polyline)
    if round_ and abs(abs(up) - 1.0) <= 1e-12:
        chain = _with_arcs(entity)
        if chain and up < 0.0:
            return Chain(chain.points * (-1.0, 1.0), -chain.bulges, chain.closed)
        return chain

    if kind in _SMOOTH:
        fine = [plane(point) for point in entity.flattening(_FINE * _FLAT * size)]
        return _through(np.array(fine), _FLAT * size)
    return _chords(entity, _FLAT * size)


def _chords(entity: Any, tolerance: float) -> Chain:
    """Return chords of a curve, as near to it as allowed."""
    from ezdxf.path import make_path

    points = np.array([plane(point) for point in make_path(entity).flattening(tolerance)])
    return Chain(points, np.zeros(len(points) - 1), False)


def _through(points: ndarray, tolerance: float) -> Chain | None:
    """Return arcs through some of the points of a smooth curve, as near to it as allowed."""
    length = row_norms(np.diff(points, axis=0))
    points = points[np.append(True, length > 0.0)]
    last = len(points) - 1
    if last < 1:
        return None
    corners = [0]
    bulges = []
    while corners[-1] < last:
        end, bulge = _longest(points[corners[-1] :], tolerance)
        corners.append(corners[-1] + end)
        bulges.append(bulge)
    return Chain(points[corners], np.array(bulges), False)


def _longest(points: ndarray, tolerance: float) -> tuple[int, float]:
    """Return the last point of the longest arc from the first one, and its bulge."""
    end = 1
    bulge = 0.0
    step = 1
    growing = True
    # Double the steps while arcs are near enough, then halve them.
    while step:
        fitting = None
        if end + step < len(points):
            fitting = _arc_between(points[: end + step + 1], tolerance)
        if fitting is not None:
            end += step
            bulge = fitting
        growing = growing and fitting is not None
        step = 2 * step if growing else step // 2
    return end, bulge


def _arc_between(points: ndarray, tolerance: float) -> float | None:
    """Return the bulge of the arc from the first to the last of some points, None if it is far.

    At every point of an arc the chords to its ends turn by half of its angle. The arc also must be
    near the middles of the chords between points, so that it cuts no corners.
    """
    # Turn at the point in the middle: half of the angle.
    start, end = points[[0, -1]]
    inner = points[len(points) // 2]
    half = turn(inner - start, end - inner)
    chord = float(np.linalg.norm(end - start))
    if abs(half) > _HALF or chord == 0.0:
        return None
    # Compare the heights of points and middles over the chord with the ones of the arc, whose
    # circle has the centre at the height chord / 2 / tan(half).
    probes = np.vstack((points[1:-1], 0.5 * (points[1:] + points[:-1])))
    along = (probes - start) @ (end - start) / chord - 0.5 * chord
    across = cross_in_plane(end - start, probes - start) / chord
    height = np.zeros(len(probes))
    if abs(half) > _STRAIGHT:
        radius = 0.5 * chord / np.sin(half)
        below = np.sqrt(np.maximum(radius**2 - along**2, 0.0))
        height = radius * np.cos(half) - np.sign(radius) * below
    if max_abs(across - height) > tolerance:
        return None
    return float(np.tan(0.5 * half))


def _with_arcs(entity: Any) -> Chain | None:
    """Return the chain of a circle, an arc or a polyline in its own coordinates."""
    kind = entity.dxftype()
    dxf = entity.dxf
    if kind == "CIRCLE":
        return _circle(plane(dxf.center), dxf.radius)
    if kind == "ARC":
        return _arc(plane(dxf.center), dxf.radius, dxf.start_angle, dxf.end_angle)
    if kind == "LWPOLYLINE":
        return _polyline(list(entity.get_points("xyb")), bool(entity.closed))
    vertices = []
    for vertex in entity.vertices:
        vertices.append((*plane(vertex.dxf.location), vertex.dxf.get("bulge", 0.0)))
    return _polyline(vertices, bool(entity.is_closed))


def _circle(centre: ndarray, radius: float) -> Chain:
    """Return four quarters of a circle."""
    corners = np.array([(1, 0), (0, 1), (-1, 0), (0, -1)])
    return Chain(centre + radius * corners, np.full(4, np.tan(np.pi / 8)), True)


def _arc(centre: ndarray, radius: float, start: float, end: float) -> Chain:
    """Return an arc between two angles in degrees, in parts of a quarter at most."""
    angle = np.radians((end - start) % 360.0 or 360.0)
    count = max(1, int(np.ceil(angle / (0.5 * np.pi))))
    turns = np.linspace(0.0, angle, count + 1) + np.radians(start)
    points = centre + radius * np.column_stack((np.cos(turns), np.sin(turns)))
    bulge = np.tan(np.diff(turns)[0] / 4.0)
    return Chain(points, np.full(count, bulge), False)


def _polyline(vertices: Sequence[tuple[float, float, float]], closed: bool) -> Chain | None:
    """Return the chain of vertices (x, y, bulge); None if it has no length."""
    values = np.array(vertices, float).reshape(-1, 3)
    points = values[:, :2]
    if len(points) < 2 or not np.ptp(points, axis=0).any():
        return None
    bulges = values[:, 2]
    if not closed:
        bulges = bulges[:-1]
    return Chain(points, bulges, closed)


def snapped(chains: Sequence[Chain], near: float) -> list[Chain]:
    """Return chains whose corners that are nearer than a distance are one point."""
    if not chains:
        return []
    counts = [len(chain.points) for chain in chains]
    x = np.vstack([chain.points for chain in chains])
    pairs = scipy.spatial.cKDTree(x).query_pairs(near, output_type="ndarray")
    label = parts_of(len(x), *pairs.T)
    first = np.unique(label, return_index=True)[1]
    parts = np.split(x[first[label]], np.cumsum(counts)[:-1])
    return [chain._replace(points=part) for chain, part in zip(chains, parts)]


def joined(chains: Sequence[Chain], near: float) -> tuple[list[Chain], int]:
    """Return chains joined at common ends and closed over gaps, and the number of doubles."""
    different: dict[tuple[Any, ...], Chain] = {}
    for chain in chains:
        different.setdefault(_key(chain), chain)
    doubles = len(chains) - len(different)
    remaining = list(different.values())
    result = []
    while remaining:
        chain = remaining.pop(0)
        while longer := _extended(chain, remaining, near):
            chain = longer
        if not chain.closed and len(chain.points) > 2 and chain.gap <= near:
            chain = Chain(chain.points[:-1], chain.bulges, True)
        result.append(chain)
    return result, doubles


def _extended(chain: Chain, others: list[Chain], near: float) -> Chain | None:
    """Return an open chain with the first of others that continues it, which leaves the others."""
    if chain.closed:
        return None
    ways = [chain]
    if chain.gap > near:
        ways.append(chain.turned())
    for begun in ways:
        for k, other in enumerate(others):
            for added in (other, other.turned()):
                distance = np.linalg.norm(added.points[0] - begun.points[-1])
                if not other.closed and distance <= near:
                    del others[k]
                    points = np.vstack((begun.points, added.points[1:]))
                    return Chain(points, np.append(begun.bulges, added.bulges), False)
    return None


def _key(chain: Chain) -> tuple[Any, ...]:
    """Return the same key for a chain and its double, turned or with another beginning."""
    points = [tuple(point) for point in np.round(chain.points, _DECIMALS).tolist()]
    bulges = np.round(np.abs(chain.bulges), _DECIMALS).tolist()
    if chain.closed:
        return True, frozenset(points), tuple(sorted(bulges))
    forward = tuple(points), tuple(bulges)
    backward = tuple(points[::-1]), tuple(bulges[::-1])
    return False, *min(forward, backward)


def open_gap(chain: Chain) -> str:
    """Return where a chain is open, in words."""
    first, last = (format_point(chain.points[end]) for end in (0, -1))
    return f"open by {chain.gap:.4g} between {first} and {last}"
