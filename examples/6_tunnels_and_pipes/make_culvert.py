"""Make ``culvert.msh``, a concrete pipe in two layers of soil (needs Gmsh's Python module).

The pipe has the outer radius 0.90, the inner radius 0.72 and its centre in the origin. Its crown
lies 2.6 below the surface of the ground; the layers meet at the height of its centre.
Quadrilaterals: an O-grid around the pipe grows into a square, the square into the rectangular
domain. The mesh is its own mirror image in x = 0 to the last digit, and one of its elements ends at
x = -1 on the surface.

    python make_culvert.py culvert.msh           # pipe and ground share the nodes of the curve
    "skin" python make_culvert.py apart.msh --hole 64   # 72 nodes on "culvert_outer", 64 on "hole"
"""

from __future__ import annotations

import argparse
from collections import defaultdict
from typing import Any

import numpy as np

INNER, OUTER, SQUARE = 0.72, 0.90, 1.80
X = (-6.0, -SQUARE, 0.0, SQUARE, 6.0)
Y = (-4.5, -SQUARE, 0.0, SQUARE, 3.5)
THROUGH_WALL, RADIAL, SIDE, BELOW, ABOVE = 4, 8, 12, 9, 8
RADIAL_GROWTH, GROWTH = 1.13, 1.10
DIGITS = 6


class Sketch:
    """Points, lines and four-sided patches of a block-structured mesh, and the names they are saved
    under.
    """

    def __init__(self, geo: Any) -> None:
        self.geo = geo
        self.curves: dict[str, list[int]] = defaultdict(list)
        self.surfaces: dict[str, list[int]] = defaultdict(list)

    def points(self, radius: float) -> list[int]:
        """Eight points on a circle around the origin, every 45 degrees from the positive x axis
        on.
        """
        angles = np.deg2rad(45.0 * np.arange(8))
        return [self.geo.addPoint(radius * np.cos(a), radius * np.sin(a), 0) for a in angles]

    def line(
        self, start: int, end: int, count: int, growth: float = 1.0, name: str | None = None
    ) -> int:
        """A straight line with `count` elements, each `growth` times as long as the one before."""
        return self._divide(self.geo.addLine(start, end), count, growth, name)

    def arc(self, start: int, centre: int, end: int, count: int, name: str | None = None) -> int:
        """A circular arc with `count` elements of equal length."""
        return self._divide(self.geo.addCircleArc(start, centre, end), count, 1.0, name)

    def patch(self, loop: list[int], name: str) -> None:
        """A structured patch of quadrilaterals inside four curves (a negative number: run
        backwards).
        """
        surface = self.geo.addPlaneSurface([self.geo.addCurveLoop(loop)])
        self.geo.mesh.setTransfiniteSurface(surface)
        self.geo.mesh.setRecombine(2, surface)
        self.surfaces[name].append(surface)

    def _divide(self, curve: int, count: int, growth: float, name: str | None) -> int:
        self.geo.mesh.setTransfiniteCurve(curve, count + 1, "Progression", growth)
        if name is not None:
            self.curves[name].append(curve)
        return curve


def layer(y: float) -> str:
    """The soil at the height y."""
    return "soft" if y > 0 else "stiff"


def draw_pipe(sketch: Sketch, centre: int, ring: int, skin: str) -> tuple[list[int], list[int]]:
    """The concrete ring; returns the eight points and arcs of its outer circle."""
    inner, outer = sketch.points(INNER), sketch.points(OUTER)
    inside = [
        sketch.arc(inner[k], centre, inner[(k + 1) % 8], ring // 8, "culvert_inner")
        for k in range(8)
    ]
    skin_arcs = [
        sketch.arc(outer[k], centre, outer[(k + 1) % 8], ring // 8, skin) for k in range(8)
    ]
    spokes = [sketch.line(inner[k], outer[k], THROUGH_WALL) for k in range(8)]
    for k in range(8):
        sketch.patch([spokes[k], skin_arcs[k], -spokes[(k + 1) % 8], -inside[k]], "culvert")
    return outer, skin_arcs


def draw_ground(sketch: Sketch, circle: list[int], arcs: list[int], hole: int) -> None:
    """The soil: an O-grid from the circle to the square, and twelve rectangles around it."""
    n_x = (SIDE, hole // 8, hole // 8, SIDE)
    n_y = (BELOW, hole // 8, hole // 8, ABOVE)
    grow_x = (1 / GROWTH, 1.0, 1.0, GROWTH)
    grow_y = (1 / GROWTH, 1.0, 1.0, 1.0)
    outside = {(0, None): "left", (4, None): "right", (None, 0): "bottom", (None, 4): "surface"}
    point = {
        (i, j): sketch.geo.addPoint(X[i], Y[j], 0)
        for i in range(5)
        for j in range(5)
        if (i, j) != (2, 2)
    }
    across = {
        (i, j): sketch.line(point[i, j], point[i + 1, j], n_x[i], grow_x[i], outside.get((None, j)))
        for i in range(4)
        for j in range(5)
        if not (i in (1, 2) and j == 2)
    }
    up = {
        (i, j): sketch.line(point[i, j], point[i, j + 1], n_y[j], grow_y[j], outside.get((i, None)))
        for i in range(5)
        for j in range(4)
        if not (i == 2 and j in (1, 2))
    }
    for i, j in ((i, j) for i in range(4) for j in range(4) if not (i in (1, 2) and j in (1, 2))):
        sketch.patch(
            [across[i, j], up[i + 1, j], -across[i, j + 1], -up[i, j]], layer(Y[j] + Y[j + 1])
        )

    square = [(3, 2), (3, 3), (2, 3), (1, 3), (1, 2), (1, 1), (2, 1), (3, 1)]
    right, top, left, bottom = up[3, 2], -across[2, 3], -up[1, 2], across[1, 1]
    edges = [right, top, -across[1, 3], left, -up[1, 1], bottom, across[2, 1], up[3, 1]]
    rays = [sketch.line(circle[k], point[square[k]], RADIAL, RADIAL_GROWTH) for k in range(8)]
    for k in range(8):
        sketch.patch(
            [rays[k], edges[k], -rays[(k + 1) % 8], -arcs[k]], "soft" if k < 4 else "stiff"
        )


def round_nodes(mesh: Any) -> None:
    """Round the coordinates, for a small file, and insist on a mirror image to the last digit."""
    tags, coordinates, _ = mesh.getNodes()
    nodes = np.round(coordinates.reshape(-1, 3), DIGITS) + 0.0  # no -0
    for tag, x in zip(tags, nodes):
        mesh.setNode(tag, x, [])
    if {(-x, y) for x, y, _ in nodes} != {(x, y) for x, y, _ in nodes}:
        raise RuntimeError("the mesh is not symmetric in x = 0")


def make_culvert(path: str, ring: int = 72, hole: int | None = None) -> None:
    """Write the mesh.

    Parameters
    ----------
    path
        The Gmsh file (format 4.1) to write.
    ring
        Number of elements around the pipe, a multiple of 8.
    hole
        Number of elements around the hole in the ground, a multiple of 8, if it is meshed apart
        from the pipe.
    """
    import gmsh

    gmsh.initialize(readConfigFiles=False, interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        geo = gmsh.model.geo
        sketch = Sketch(geo)
        centre = geo.addPoint(0, 0, 0)
        circle, arcs = draw_pipe(sketch, centre, ring, "skin" if hole is None else "culvert_outer")
        if hole is not None:
            circle = sketch.points(OUTER)
            arcs = [
                sketch.arc(circle[k], centre, circle[(k + 1) % 8], hole // 8, "hole")
                for k in range(8)
            ]
        draw_ground(sketch, circle, arcs, ring if hole is None else hole)
        geo.synchronize()
        for dimension, groups in ((1, sketch.curves), (2, sketch.surfaces)):
            for name, entities in groups.items():
                gmsh.model.addPhysicalGroup(dimension, entities, name=name)
        gmsh.model.mesh.generate(2)
        round_nodes(gmsh.model.mesh)
        gmsh.option.setNumber("Mesh.MshFileVersion", 4.1)
        gmsh.write(path)
    finally:
        gmsh.finalize()


if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("path")
    parser.add_argument("--ring", type=int, default=72, help="elements around the pipe (72)")
    parser.add_argument(
        "--hole", type=int, default=None, help="elements around the hole, if meshed apart"
    )
    arguments = parser.parse_args()
    make_culvert(arguments.path, arguments.ring, arguments.hole)
