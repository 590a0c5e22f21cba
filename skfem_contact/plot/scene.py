"""Bodies of a stage as meshes of pyvista: plane ones seen from above, those in space cut open."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from copy import copy
from functools import cached_property
from typing import Any, Literal, NamedTuple

import meshio
import numpy as np
from numpy import ndarray
from typing_extensions import override

from ..results.export import vtk_cells
from ..results.fields import reference, solids
from ..results.patch_recovery import region_mesh
from ..results.stage import StageResult
from .sheet import Scale

#: Largest displacement in a picture with deformed="auto", as a share of the bodies' size.
_VISIBLE = 0.04
#: VTK leaves out what lies on the last level; values at the ends are moved into their bands by this
#: share of one.
_INSIDE = 1e-4
#: Heights of what is drawn above each other, in pixels: bodies, their meshes, borders, outlines,
#: marks.
FIELD, MESH, BORDER, OUTLINE, MARK = range(5)
#: Share of the size by which lines in space lie in front of what they are drawn on.
_FRONT = 1e-3
#: Angle between faces, in degrees, from which on an edge is drawn.
_EDGE = 30.0

#: A plane: its normal, which points to what is cut away, and a point on it.
Cut = tuple[Sequence[float], Sequence[float]]


class _Sides(NamedTuple):
    """All sides of elements, those between regions, and those outside of bodies, (n, 2 or 3)
    each.
    """

    mesh: ndarray
    borders: ndarray
    outline: ndarray


class Scene:
    """Bodies of a stage in the plane, with the values (n,) of a field on the nodes of their
    regions.
    """

    #: Axes of the view, (3, 3): to the right, upwards, towards the eye; depth of its focus, and
    #: distance of the eye.
    view: tuple[ndarray, float, float] = (np.eye(3), 0.0, 1.0)
    room = 0.025  # share of the size that is left free around the bodies

    def __init__(
        self,
        stage: StageResult,
        deformed: float | Literal["auto"] = 0.0,
        since: StageResult | None = None,
        values: ndarray | None = None,
    ) -> None:
        bodies = list(solids(stage).values())
        basis = bodies[0].basis
        dim = basis.mesh.dim()
        self.values = np.zeros(0) if values is None else values
        self.nodes, self.cells, self.region = region_mesh(*bodies)
        self.corners = len(basis.mesh.t)  # of an element
        self.coordinates = basis.doflocs[:, ::dim].T
        moved = stage.x if since is None else stage.x - _begun(stage, since)
        self.displacement = moved[: basis.N].reshape(-1, dim)
        self.factor = float(deformed) if deformed != "auto" else self._round_factor()
        areas = np.concatenate([np.asarray(form.basis.dx).sum(axis=1) for form in bodies])
        self.area = np.bincount(
            self.cells.ravel(), np.repeat(areas, self.cells.shape[1])
        )  # equal shares of elements
        self.pixel = 1.0

    def _round_factor(self) -> float:
        """Return a factor with which displacements are seen: 1, 2 or 5 times a power of ten."""
        largest = np.linalg.norm(self.displacement[self.nodes], axis=1).max()
        if largest == 0.0:
            return 1.0
        wanted = _VISIBLE * np.ptp(self.coordinates[self.nodes], axis=0).max() / largest
        power = 10.0 ** np.floor(np.log10(wanted))
        return float(
            power * max(step for step in (1.0, 2.0, 5.0) if step * power <= wanted * (1 + 1e-9))
        )

    @property
    def moved(self) -> ndarray:
        """Displaced coordinates of all nodes, (n_nodes, dim)."""
        return self.coordinates + self.factor * self.displacement

    @property
    def seen(self) -> ndarray:
        """Coordinates in the view of the bodies before and after they have moved, (n, 2)."""
        return np.concatenate((self.coordinates[self.nodes], self.moved[self.nodes]))

    @property
    def samples(self) -> tuple[ndarray, ndarray]:
        """Values of the field that are drawn, and the areas that they stand for, (n,)."""
        return self.values, self.area

    @cached_property
    def sides(self) -> _Sides:
        """Sides of elements by their nodes: ends and, between them, middle."""
        k, n = self.cells.shape[1], self.corners
        corner = np.arange(n)
        side = np.column_stack((corner, *((n + corner,) if k > n else ()), (corner + 1) % n))
        sides = self.nodes[self.cells][:, side].reshape(-1, side.shape[1])
        ends = np.sort(sides[:, [0, -1]], axis=1)
        _, first, inverse, count = np.unique(
            ends, axis=0, return_index=True, return_inverse=True, return_counts=True
        )
        low, high = np.full(len(first), self.region.max()), np.zeros(len(first), int)
        np.minimum.at(low, inverse.ravel(), np.repeat(self.region, n))
        np.maximum.at(high, inverse.ravel(), np.repeat(self.region, n))
        return _Sides(sides[first], sides[first[low < high]], sides[first[count == 1]])

    def between(self, other: Scene, share: float) -> Scene:
        """Return the bodies on their way from another stage to this one."""
        new = copy(self)
        new.displacement = (1.0 - share) * other.displacement + share * self.displacement
        new.values = (1.0 - share) * other.values + share * self.values
        return new

    def draw(self, plotter: Any, scale: Scale, mesh: bool) -> None:
        """Draw bands of the field, the mesh, borders of regions and outlines."""
        displacement = np.pad(self.displacement[self.nodes], ((0, 0), (0, 1)))
        grid = _grid_of(
            self.in_space(self.coordinates[self.nodes], FIELD),
            *vtk_cells(self.cells, 2),
            displacement,
        )
        grid["values"] = self.values
        surface, lines = _banded(_surface_of(grid, self.factor), scale)
        plotter.add_mesh(surface, scalars="colors", rgb=True, lighting=False, show_scalar_bar=False)
        if lines.n_cells:
            plotter.add_mesh(lines, color="#333333", opacity=0.25, line_width=1, lighting=False)
        every, borders, outline = self.sides
        if mesh:
            plotter.add_mesh(
                self.lines(every, self.moved, MESH), color="#1a1a1a", opacity=0.30, line_width=1.6
            )
        if self.factor != 0.0:
            plotter.add_mesh(
                self.lines(outline, self.coordinates, MESH), color="#8a8a8a", line_width=2.5
            )
        if len(borders):
            plotter.add_mesh(self.lines(borders, self.moved, BORDER), color="#222222", line_width=3)
        plotter.add_mesh(self.lines(outline, self.moved, OUTLINE), color="black", line_width=4)

    def lines(self, sides: ndarray, points: ndarray, level: int) -> Any:
        """Return lines through points (n, 2), each given by the numbers of its ends and, between
        them, its middle.
        """
        import pyvista

        cells = np.column_stack((np.full(len(sides), sides.shape[1]), sides))
        return pyvista.PolyData(self.in_space(points, level), lines=cells.ravel())

    def in_space(self, points: ndarray, level: int) -> ndarray:
        """Return points (n, 3), lifted by some pixels so that they are seen on top of what lies
        lower.
        """
        return np.column_stack((points, np.full(len(points), level * self.pixel)))


class _Plane(NamedTuple):
    """Unit normal, which points to what is cut away, and a point."""

    normal: ndarray
    origin: ndarray


class Cutaway(Scene):
    """Bodies of a stage in space, of which planes cut parts away; the last axis is upright."""

    room = 0.03

    def __init__(
        self,
        stage: StageResult,
        deformed: float | Literal["auto"],
        since: StageResult | None,
        values: ndarray,
        cuts: Sequence[Cut] = (),
        towards: Sequence[float] = (-1.0, 2.0, -1.0),
    ) -> None:
        super().__init__(stage, deformed, since, values)
        self.planes = [_plane(*cut) for cut in cuts]
        moved, points = self.displacement[self.nodes], self.coordinates[self.nodes]
        kind, cells = vtk_cells(self.cells, 3)
        grid = _grid_of(points, kind, cells, moved)
        grid["values"] = self.values
        straight = (
            "tetra" if self.corners == 4 else "hexahedron"
        )  # cells that are cut into polygons
        self.straight = _grid_of(points, straight, cells[:, : self.corners], moved)
        self.straight["region"] = self.region
        self.kept = _without(grid, self.planes)
        if self.kept.n_cells == 0:
            raise ValueError("the cuts leave nothing of the bodies")
        axes = _axes(towards)
        self._in_view = (self.kept.points + self.factor * self.kept["displacement"]) @ axes.T
        size = float(np.ptp(self._in_view, axis=0).max())
        self.view, self._front = (
            (axes, float(self._in_view[:, 2].mean()), 4.0 * size),
            _FRONT * size * axes[2],
        )

    @property
    @override
    def seen(self) -> ndarray:
        return np.asarray(self._in_view[:, :2])

    @property
    @override
    def samples(self) -> tuple[ndarray, ndarray]:
        return self.kept["values"], _volumes(self.kept)

    @override
    def draw(self, plotter: Any, scale: Scale, mesh: bool) -> None:
        import pyvista

        plotter.add_light(pyvista.Light(light_type="headlight"))
        bands, _ = _banded(_surface_of(self.kept, self.factor), scale)
        plotter.add_mesh(
            bands,
            scalars="colors",
            rgb=True,
            ambient=0.85,
            diffuse=0.2,
            specular=0.0,
            show_scalar_bar=False,
        )
        for lines, style in self.edges(mesh):
            plotter.add_mesh(lines.translate(self._front), lighting=False, **style)

    def edges(self, mesh: bool) -> Iterator[tuple[Any, dict[str, Any]]]:
        """Return edges of elements, and those of regions, on the surface and where planes cut it,
        with their styles.
        """
        thin, thick = (
            {"color": "#1a1a1a", "opacity": 0.30, "line_width": 1.2},
            {"color": "black", "line_width": 2.5},
        )
        parts = [
            self.straight.extract_cells(self.straight["region"] == k)
            for k in np.unique(self.straight["region"])
        ]
        outsides = [
            _surface_of(part, 0.0, 0).compute_normals(auto_orient_normals=True) for part in parts
        ]
        found = [
            (outside.extract_feature_edges(_EDGE, boundary_edges=False), self.planes, thick)
            for outside in outsides
        ]
        found += [(outside.extract_all_edges(), self.planes, thin) for outside in outsides if mesh]
        for cut in self.planes:
            others = [plane for plane in self.planes if plane is not cut]
            for part, outside in zip(parts, outsides):
                found.append((outside.slice(normal=cut.normal, origin=cut.origin), others, thick))
                if mesh:
                    found.append(
                        (
                            part.slice(normal=cut.normal, origin=cut.origin).extract_all_edges(),
                            others,
                            thin,
                        )
                    )
        for lines, left, style in found:
            if (seen := _without(lines, left)).n_cells:
                yield seen.warp_by_vector("displacement", factor=self.factor), style


def _begun(stage: StageResult, since: StageResult) -> ndarray:
    """Return the displacements of an earlier stage; nodes of bodies that it does not hold count
    from activation.
    """
    x, there = since.x.copy(), solids(stage)
    old = [form.basis.element_dofs.ravel() for name, form in there.items() if name in since.states]
    for name in there.keys() - since.states.keys():
        own = np.setdiff1d(there[name].basis.element_dofs, np.concatenate([np.zeros(0, int), *old]))
        x[own] = reference(stage, since, name)[own]
    return x


def _grid_of(points: ndarray, kind: str, cells: ndarray, displacement: ndarray) -> Any:
    """Return elements of a kind, in meshio's words, as pyvista's grid: points and displacements (n,
    3).
    """
    import pyvista

    return pyvista.from_meshio(
        meshio.Mesh(points, [(kind, cells)], point_data={"displacement": displacement})
    )


def _surface_of(grid: Any, factor: float, subdivision: int = 2) -> Any:
    """Return the outside of bodies that have moved, in flat polygons."""
    moved = grid.warp_by_vector("displacement", factor=factor)
    return moved.extract_surface(nonlinear_subdivision=subdivision, algorithm="dataset_surface")


def _banded(surface: Any, scale: Scale) -> tuple[Any, Any]:
    """Return bands of the field "values" of a surface, with their colours, and the lines between
    them.
    """
    n = len(scale.levels) - 1
    bands = np.interp(surface["values"], scale.levels, np.arange(n + 1.0))  # their numbers
    surface["values"] = np.clip(bands, _INSIDE, n - _INSIDE)
    result, lines = surface.contour_banded(
        n + 1, rng=(0.0, float(n)), scalars="values", scalar_mode="index"
    )
    band = np.clip(np.asarray(result.cell_data["Scalars"]).astype(int), 0, n - 1)
    result.cell_data["colors"] = (
        (255 * np.asarray(scale.colors(band))[:, :3]).round().astype(np.uint8)
    )
    return result, lines


def _axes(towards: Sequence[float]) -> ndarray:
    """Return the axes of a view in a direction: to the right, upwards, and towards the eye."""
    ahead = np.asarray(towards, float)
    right = np.cross(ahead, (0.0, 0.0, 1.0))
    if ahead.shape != (3,) or not np.linalg.norm(right) > 1e-9 * np.linalg.norm(ahead):
        raise ValueError(f"towards is a direction (x, y, z) that is not upright, not {towards!r}")
    return np.stack(
        [axis / np.linalg.norm(axis) for axis in (right, np.cross(right, ahead), -ahead)]
    )


def _plane(normal: Sequence[float], origin: Sequence[float]) -> _Plane:
    n, o = np.asarray(normal, float), np.asarray(origin, float)
    if n.shape != (3,) or o.shape != (3,) or not np.isfinite((n, o)).all() or not n.any():
        raise ValueError(f"a cut is a normal and a point, (x, y, z) each, not {(normal, origin)!r}")
    return _Plane(n / np.linalg.norm(n), o)


def _without(grid: Any, planes: Sequence[_Plane]) -> Any:
    """Return what is left behind the planes."""
    for plane in planes:
        if grid.n_cells:
            grid = grid.clip(normal=plane.normal, origin=plane.origin)
    return grid


def _volumes(grid: Any) -> ndarray:
    """Return the volume that belongs to each point, equal shares of the elements."""
    import pyvista

    volume = np.abs(grid.compute_cell_sizes(length=False, area=False)["Volume"])
    corners = np.diff(pyvista.convert_array(grid.GetCells().GetOffsetsArray()))
    return np.bincount(
        grid.cell_connectivity, np.repeat(volume / corners, corners), minlength=grid.n_points
    )
