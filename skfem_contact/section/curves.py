"""Curves of a drawing: entities as chains of segments and arcs, joined, without doubles."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy import ndarray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from ..checks import format_point

#: Chords of ellipses and splines leave them by this share of the drawing at most.
_FLAT = 2e-5
#: Types of entities that are curves; texts name them.
_CURVES = {"LINE", "LWPOLYLINE", "POLYLINE", "ARC", "CIRCLE", "ELLIPSE", "SPLINE"}
TEXTS = {"TEXT", "MTEXT"}


class Chain(NamedTuple):
    """Points (n, 2) with the bulges of the segments between them: n if it is closed, else n - 1."""

    points: ndarray
    bulges: ndarray
    closed: bool


def plane(point: Any) -> ndarray:
    """Return the coordinates x and y of a point of a drawing."""
    return np.array([point[0], point[1]], float)


def entities(space: Any) -> Iterator[Any]:
    """Return the entities of a drawing, those of inserted blocks included."""
    for entity in space:
        if entity.dxftype() == "INSERT":
            yield from entities(entity.virtual_entities())
        else:
            yield entity


def chain_of(entity: Any, size: float) -> Chain | None:
    """Return the chain of a curve, None for other entities."""
    kind = entity.dxftype()
    if kind not in _CURVES:
        return None
    flat = not (entity.dxf.hasattr("extrusion") and abs(entity.dxf.extrusion[2] - 1.0) > 1e-12)
    if kind == "LINE":
        return Chain(np.array([plane(entity.dxf.start), plane(entity.dxf.end)]), np.zeros(1), False)
    if flat and kind == "CIRCLE":
        x, y = plane(entity.dxf.center)
        corners = np.array([(1, 0), (0, 1), (-1, 0), (0, -1)])
        return Chain((x, y) + entity.dxf.radius * corners, np.full(4, np.tan(np.pi / 8)), True)
    if flat and kind == "ARC":
        angle = np.radians((entity.dxf.end_angle - entity.dxf.start_angle) % 360.0 or 360.0)
        turns = np.linspace(
            0.0, angle, max(2, int(np.ceil(angle / (0.5 * np.pi))) + 1)
        ) + np.radians(entity.dxf.start_angle)
        points = plane(entity.dxf.center) + entity.dxf.radius * np.column_stack(
            (np.cos(turns), np.sin(turns))
        )
        return Chain(points, np.full(len(turns) - 1, np.tan(np.diff(turns)[0] / 4.0)), False)
    if flat and kind == "LWPOLYLINE":
        return _polyline(
            [(x, y, bulge) for x, y, bulge in entity.get_points("xyb")], bool(entity.closed)
        )
    if flat and kind == "POLYLINE" and entity.is_2d_polyline:
        return _polyline(
            [
                (*plane(vertex.dxf.location), vertex.dxf.get("bulge", 0.0))
                for vertex in entity.vertices
            ],
            bool(entity.is_closed),
        )
    from ezdxf.path import make_path

    points = np.array([plane(point) for point in make_path(entity).flattening(_FLAT * size)])
    return Chain(points, np.zeros(len(points) - 1), False)


def _polyline(vertices: Sequence[tuple[float, float, float]], closed: bool) -> Chain | None:
    """Return the chain of a polyline; None if it has no length."""
    values = np.array(vertices, float).reshape(-1, 3)
    if len(values) < 2 or not np.ptp(values[:, :2], axis=0).any():
        return None
    return Chain(values[:, :2], values[:, 2] if closed else values[:-1, 2], closed)


def snapped(chains: Sequence[Chain], near: float) -> list[Chain]:
    """Return chains whose corners that are nearer than a distance are one point."""
    if not chains:
        return []
    x = np.vstack([chain.points for chain in chains])
    pairs = cKDTree(x).query_pairs(near, output_type="ndarray")
    label = connected_components(
        coo_matrix((np.ones(len(pairs)), pairs.T), shape=(len(x), len(x))), directed=False
    )[1]
    first = np.unique(label, return_index=True)[1]
    x = x[first[label]]
    ends = np.cumsum([len(chain.points) for chain in chains])[:-1]
    return [chain._replace(points=part) for chain, part in zip(chains, np.split(x, ends))]


def joined(chains: Sequence[Chain], near: float) -> tuple[list[Chain], int]:
    """Return chains joined at common ends and closed over gaps below a distance, and the number of
    doubles left out.
    """
    left, doubles = [], 0
    known: set[tuple[Any, ...]] = set()
    for chain in chains:
        key = _key(chain)
        doubles += key in known
        if key not in known:
            known.add(key)
            left.append(chain)
    found = []
    while left:
        chain = left.pop(0)
        while not chain.closed and (there := _next(chain, left, near)):
            k, turned = there
            other = _turned(left.pop(k)) if turned else left.pop(k)
            chain = Chain(
                np.vstack((chain.points, other.points[1:])),
                np.append(chain.bulges, other.bulges),
                False,
            )
        if (
            not chain.closed
            and len(chain.points) > 2
            and np.linalg.norm(chain.points[0] - chain.points[-1]) <= near
        ):
            chain = Chain(chain.points[:-1], chain.bulges, True)
        found.append(chain)
    return found, doubles


def _next(chain: Chain, others: Sequence[Chain], near: float) -> tuple[int, bool] | None:
    """Return the open chain that continues another one, and whether it must be turned."""
    for k, other in enumerate(others):
        for turned in (False, True):
            begin = other.points[-1 if turned else 0]
            if not other.closed and np.linalg.norm(begin - chain.points[-1]) <= near:
                return k, turned
    for k, other in enumerate(others):  # one that continues its beginning
        if (
            not other.closed
            and min(np.linalg.norm(other.points[end] - chain.points[0]) for end in (0, -1)) <= near
            and np.linalg.norm(chain.points[0] - chain.points[-1]) > near
        ):
            chain.points[:], chain.bulges[:] = chain.points[::-1].copy(), -chain.bulges[::-1].copy()
            return k, bool(np.linalg.norm(other.points[0] - chain.points[-1]) > near)
    return None


def _turned(chain: Chain) -> Chain:
    return Chain(chain.points[::-1], -chain.bulges[::-1], chain.closed)


def _key(chain: Chain) -> tuple[Any, ...]:
    """Return what is the same for a chain and its double, which may run the other way or begin
    elsewhere.
    """
    points = [tuple(point) for point in np.round(chain.points, 9).tolist()]
    bulges = np.round(np.abs(chain.bulges), 9).tolist()
    if chain.closed:
        return True, frozenset(points), tuple(sorted(bulges))
    return False, *min((tuple(points), tuple(bulges)), (tuple(points[::-1]), tuple(bulges[::-1])))


def open_gap(chain: Chain) -> str:
    """Return where a chain is open, in words."""
    gap = float(np.linalg.norm(chain.points[0] - chain.points[-1]))
    return f"open by {gap:.4g} between {format_point(chain.points[0])} and {format_point(chain.points[-1])}"
