"""The bodies of a stage as pyvista's meshes, seen from above."""
from __future__ import annotations

from collections.abc import Mapping
from copy import copy
from typing import Any, Literal

import meshio
import numpy as np
from numpy import ndarray

from ..results.export import vtk_cells
from ..results.fields import solids
from ..results.patch_recovery import region_mesh
from ..results.result import StageResult
from .scales import Scale

#: Largest displacement in a picture with deformed="auto", as a share of the bodies' size.
_VISIBLE = 0.04
#: VTK leaves out what lies on the last level; values at the ends are moved into their bands by this share of one.
_INSIDE = 1e-4
#: Heights of what is drawn above each other, in pixels: bodies, their meshes, borders, outlines, marks.
FIELD, MESH, BORDER, OUTLINE, MARK = range(5)


class Scene:
    """The bodies of some forms in a stage.

    Parameters
    ----------
    forms, step
        Forms by name, and a stage of their result.
    deformed
        Factor of the displacements, or ``"auto"`` for a round one with which they are seen.
    since
        Stage from which displacements are counted.
    """

    def __init__(self, forms: Mapping[str, Any], step: StageResult, deformed: float | Literal["auto"],
                 since: StageResult | None = None) -> None:
        bodies = list(solids(step).values())
        basis = bodies[0].basis
        self.nodes, self.cells, region = region_mesh(*bodies)
        self.corners = len(basis.mesh.t)  # of an element
        self.places = basis.doflocs[:, 0::2].T
        self.displacement = (step.x if since is None else step.x - since.x)[:basis.N].reshape(-1, 2)
        self.factor = float(deformed) if deformed != "auto" else round_factor(self.places[self.nodes],
                                                                              self.displacement[self.nodes])
        areas = np.concatenate([np.asarray(form.basis.dx).sum(axis=1) for form in bodies])
        self.area = np.bincount(self.cells.ravel(), np.repeat(areas, self.cells.shape[1]))  # equal shares of elements
        self.pixel = 1.0
        self._find_lines(region)

    @property
    def moved(self) -> ndarray:
        """Places of all nodes after the bodies have moved, (n_nodes, 2)."""
        return self.places + self.factor * self.displacement

    def _find_lines(self, region: ndarray) -> None:
        """Sides of elements: all of them, those between regions, and those on the outside of bodies."""
        k, n = self.cells.shape[1], self.corners
        corner = np.arange(n)
        side = np.column_stack((corner, *((n + corner,) if k > n else ()), (corner + 1) % n))
        sides = self.nodes[self.cells][:, side].reshape(-1, side.shape[1])
        of = np.repeat(region, n)
        ends = np.sort(sides[:, [0, -1]], axis=1)
        _, first, inverse, count = np.unique(ends, axis=0, return_index=True, return_inverse=True, return_counts=True)
        low, high = np.full(len(first), region.max()), np.zeros(len(first), int)
        np.minimum.at(low, inverse.ravel(), of)
        np.maximum.at(high, inverse.ravel(), of)
        self.sides, self.borders, self.outline = sides[first], sides[first[low < high]], sides[first[count == 1]]

    @property
    def seen(self) -> ndarray:
        """Places of the bodies before and after they have moved, (n, 2)."""
        return np.concatenate((self.places[self.nodes], self.moved[self.nodes]))

    def between(self, other: Scene, share: float) -> Scene:
        """The bodies on their way from another stage to this one."""
        new = copy(self)
        new.displacement = (1.0 - share) * other.displacement + share * self.displacement
        return new

    def draw_field(self, plotter: Any, values: ndarray, scale: Scale) -> None:
        """Bands of a field, values at `nodes`, with lines between them."""
        displacement = np.pad(self.displacement[self.nodes], ((0, 0), (0, 1)))
        grid = grid_of(self.in_space(self.places[self.nodes], FIELD), *vtk_cells(self.cells, 2), displacement)
        grid["values"] = values
        surface, lines = banded(surface_of(grid, self.factor), scale)
        plotter.add_mesh(surface, scalars="colors", rgb=True, lighting=False, show_scalar_bar=False)
        if lines.n_cells:
            plotter.add_mesh(lines, color="#333333", opacity=0.25, line_width=1, lighting=False)

    def draw_lines(self, plotter: Any, mesh: bool, undeformed: bool) -> None:
        """Mesh, borders of regions, outlines, and the outlines before bodies moved."""
        if mesh:
            plotter.add_mesh(self.lines(self.sides, self.moved, MESH), color="#1a1a1a", opacity=0.30, line_width=1.6)
        if undeformed:
            plotter.add_mesh(self.lines(self.outline, self.places, MESH), color="#8a8a8a", line_width=2.5)
        if len(self.borders):
            plotter.add_mesh(self.lines(self.borders, self.moved, BORDER), color="#222222", line_width=3)
        plotter.add_mesh(self.lines(self.outline, self.moved, OUTLINE), color="black", line_width=4)

    def lines(self, sides: ndarray, points: ndarray, level: int) -> Any:
        """Lines through points (n, 2), each given by the numbers of its ends and, between them, its middle."""
        import pyvista

        cells = np.column_stack((np.full(len(sides), sides.shape[1]), sides))
        return pyvista.PolyData(self.in_space(points, level), lines=cells.ravel())

    def in_space(self, points: ndarray, level: int) -> ndarray:
        """Points (n, 3), lifted by some pixels so that they are seen on top of what lies lower."""
        return np.column_stack((points, np.full(len(points), level * self.pixel)))


def grid_of(points: ndarray, kind: str, cells: ndarray, displacement: ndarray) -> Any:
    """Elements of a kind, in meshio's words, as pyvista's grid: points and displacements (n, 3)."""
    import pyvista

    return pyvista.from_meshio(meshio.Mesh(points, [(kind, cells)], point_data={"displacement": displacement}))


def surface_of(grid: Any, factor: float, subdivision: int = 2) -> Any:
    """The outside of bodies that have moved, in flat polygons."""
    moved = grid.warp_by_vector("displacement", factor=factor)
    return moved.extract_surface(nonlinear_subdivision=subdivision, algorithm="dataset_surface")


def round_factor(places: ndarray, displacement: ndarray) -> float:
    """A factor with which displacements (n, dim) are seen: 1, 2 or 5 times a power of ten."""
    size = np.ptp(places, axis=0).max()
    largest = np.linalg.norm(displacement, axis=1).max()
    if largest == 0.0:
        return 1.0
    wanted = _VISIBLE * size / largest
    power = 10.0 ** np.floor(np.log10(wanted))
    return float(power * max(step for step in (1.0, 2.0, 5.0) if step * power <= wanted * (1 + 1e-9)))


def banded(surface: Any, scale: Scale) -> tuple[Any, Any]:
    """Bands of the field "values" of a surface, with their colours, and the lines between them."""
    n = len(scale.levels) - 1
    bands = np.interp(surface["values"], scale.levels, np.arange(n + 1.0))  # their numbers
    surface["values"] = np.clip(bands, _INSIDE, n - _INSIDE)
    result, lines = surface.contour_banded(n + 1, rng=(0.0, float(n)), scalars="values", scalar_mode="index")
    band = np.clip(np.asarray(result.cell_data["Scalars"]).astype(int), 0, n - 1)
    result.cell_data["colors"] = (255 * np.asarray(scale.colors(band))[:, :3]).round().astype(np.uint8)
    return result, lines
