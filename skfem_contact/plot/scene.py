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

from ..arrays import row_norms
from ..results.export import vtk_cells
from ..results.fields import reference, solids
from ..results.patch_recovery import region_mesh
from ..results.stage import StageResult
from .sheet import Scale

#: Largest displacement in a picture with deformed="auto", as a share of the bodies' size.
_VISIBLE = 0.04
#: Share of a band by which values at the ends are moved inwards: VTK leaves out the last level.
_INSIDE = 1e-4
#: Heights of layers of the picture, in pixels: bodies, their meshes, borders, outlines, marks.
FIELD, MESH, BORDER, OUTLINE, MARK = range(5)
#: Share of the size by which lines in space lie in front of surfaces.
_FRONT = 1e-3
#: Angle between faces, in degrees, from which on an edge is drawn.
EDGE = 30.0

#: A plane: its normal, which points to the part that is cut away, and a point on it.
Cut = tuple[Sequence[float], Sequence[float]]


class _Sides(NamedTuple):
    """Sides of elements by their nodes: ends and, between them, middle; (n, 2 or 3) each."""

    mesh: ndarray  # all sides
    borders: ndarray  # between regions
    outline: ndarray  # around bodies


class Scene:
    """Bodies of a stage in the plane, with values (n,) of a field on the nodes of the regions."""

    #: Axes of the view, (3, 3): to the right, upwards, towards the eye; depth of its focus, and
    #: distance of the eye.
    view: tuple[ndarray, float, float] = (np.eye(3), 0.0, 1.0)
    room = 0.025  # share of the size that is left free around the bodies

    def __init__(
        self,
        stage: StageResult,
        deformed: float | Literal["auto"] | None = None,
        since: StageResult | None = None,
        values: ndarray | None = None,
    ) -> None:
        # Collect the elements of all regions and the displacements of all nodes.
        bodies = list(solids(stage).values())
        basis = bodies[0].basis
        dim = basis.mesh.dim()
        self.nodes, self.cells, self.region = region_mesh(*bodies)
        self.corners = len(basis.mesh.t)  # of an element
        self.coordinates = basis.doflocs[:, ::dim].T
        self.values = np.zeros(0) if values is None else values
        moved = stage.x
        if since is not None:
            moved = stage.x - _begun(stage, since)
        self.displacement = moved[: basis.N].reshape(-1, dim)
        finite = any(form.kinematics == "finite" for form in bodies)
        if finite and deformed in (None, "auto"):
            deformed = 1.0
        self.factor = self._factor(deformed)

        # Give each node equal shares of the areas of its elements.
        volumes = [np.asarray(form.basis.dx).sum(axis=1) for form in bodies]
        areas = np.concatenate(volumes)
        repeated = np.repeat(areas, self.cells.shape[1])
        self.area = np.bincount(self.cells.ravel(), repeated)
        self.pixel = 1.0

    def _factor(self, deformed: float | Literal["auto"] | None) -> float:
        """Return the factor of the displacements."""
        if deformed == "auto":
            return self._round_factor()
        return float(deformed or 0.0)

    def _round_factor(self) -> float:
        """Return a factor with which displacements are seen: 1, 2 or 5 times a power of ten."""
        largest = row_norms(self.displacement[self.nodes]).max()
        if largest == 0.0:
            return 1.0
        size = np.ptp(self.coordinates[self.nodes], axis=0).max()
        wanted = _VISIBLE * size / largest
        power = 10.0 ** np.floor(np.log10(wanted))
        steps = []
        for step in (1.0, 2.0, 5.0):
            if step * power <= wanted * (1 + 1e-9):
                steps.append(step)
        return float(power * max(steps))

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
        """Values of the field, and the areas of their nodes, (n,)."""
        return self.values, self.area

    @cached_property
    def sides(self) -> _Sides:
        """Sides of elements."""
        # Collect the nodes of all sides: an end, in elements of second order a middle, an end.
        k = self.cells.shape[1]
        n = self.corners
        corner = np.arange(n)
        positions = [corner, (corner + 1) % n]
        if k > n:
            positions.insert(1, n + corner)
        side = np.column_stack(positions)
        sides = self.nodes[self.cells][:, side].reshape(-1, side.shape[1])

        # Find the regions on both sides of each of them.
        ends = np.sort(sides[:, [0, -1]], axis=1)
        _, first, inverse, count = np.unique(
            ends, axis=0, return_index=True, return_inverse=True, return_counts=True
        )
        region = np.repeat(self.region, n)
        low = np.full(len(first), self.region.max())
        high = np.zeros(len(first), int)
        np.minimum.at(low, inverse.ravel(), region)
        np.maximum.at(high, inverse.ravel(), region)
        return _Sides(sides[first], sides[first[low < high]], sides[first[count == 1]])

    def between(self, other: Scene, share: float) -> Scene:
        """Return the bodies on their way from another stage to this one."""
        new = copy(self)
        new.displacement = (1.0 - share) * other.displacement + share * self.displacement
        new.values = (1.0 - share) * other.values + share * self.values
        return new

    def draw(self, plotter: Any, scale: Scale, mesh: bool) -> None:
        """Draw bands of the field, the mesh, borders of regions and outlines."""
        # Make a grid of the displaced elements with the field.
        points = self.in_space(self.coordinates[self.nodes], FIELD)
        displacement = np.pad(self.displacement[self.nodes], ((0, 0), (0, 1)))
        grid = grid_of(points, *vtk_cells(self.cells, 2), displacement)
        grid["values"] = self.values

        # Draw the bands and the lines between them.
        surface, lines = banded(surface_of(grid, self.factor), scale)
        plotter.add_mesh(surface, scalars="colors", rgb=True, lighting=False, show_scalar_bar=False)
        if lines.n_cells:
            plotter.add_mesh(lines, color="#333333", opacity=0.25, line_width=1, lighting=False)

        # Draw the sides above them.
        every, borders, outline = self.sides
        if mesh:
            elements = self.lines(every, self.moved, MESH)
            plotter.add_mesh(elements, color="#1a1a1a", opacity=0.30, line_width=1.6)
        if self.factor != 0.0:
            undeformed = self.lines(outline, self.coordinates, MESH)
            plotter.add_mesh(undeformed, color="#8a8a8a", line_width=2.5)
        if len(borders):
            inner = self.lines(borders, self.moved, BORDER)
            plotter.add_mesh(inner, color="#222222", line_width=3)
        outer = self.lines(outline, self.moved, OUTLINE)
        plotter.add_mesh(outer, color="black", line_width=4)

    def lines(self, sides: ndarray, points: ndarray, level: int) -> Any:
        """Return lines through points (n, 2) by the numbers of their ends and middles."""
        import pyvista

        cells = np.column_stack((np.full(len(sides), sides.shape[1]), sides))
        return pyvista.PolyData(self.in_space(points, level), lines=cells.ravel())

    def in_space(self, points: ndarray, level: int) -> ndarray:
        """Return points (n, 3), lifted by a number of pixels so that they hide lower layers."""
        return np.column_stack((points, np.full(len(points), level * self.pixel)))


class _Plane(NamedTuple):
    """Unit normal, which points to the part that is cut away, and a point."""

    normal: ndarray
    origin: ndarray


class SpaceScene(Scene):
    """Bodies in space, seen in a direction."""

    room = 0.03

    def _look(self, towards: Sequence[float], points: ndarray) -> None:
        """Look at the middle of displaced points, (n, 3)."""
        axes = axes_of_view(towards)
        self._in_view = points @ axes.T
        size = float(np.ptp(self._in_view, axis=0).max())
        self.view = (axes, float(self._in_view[:, 2].mean()), 4.0 * size)
        self._front = _FRONT * size * axes[2]

    @property
    @override
    def seen(self) -> ndarray:
        return np.asarray(self._in_view[:, :2])

    @override
    def in_space(self, points: ndarray, level: int) -> ndarray:
        return points + self._front


class Cutaway(SpaceScene):
    """Bodies of a stage in space, of which planes cut parts away; the last axis is upright."""

    def __init__(
        self,
        stage: StageResult,
        deformed: float | Literal["auto"] | None,
        since: StageResult | None,
        values: ndarray,
        cuts: Sequence[Cut] = (),
        towards: Sequence[float] = (-1.0, 2.0, -1.0),
    ) -> None:
        super().__init__(stage, deformed, since, values)
        self.planes = [_plane(*cut) for cut in cuts]
        displacement = self.displacement[self.nodes]
        points = self.coordinates[self.nodes]
        kind, cells = vtk_cells(self.cells, 3)

        # Cut the bodies; cells with straight edges are cut into polygons.
        grid = grid_of(points, kind, cells, displacement)
        grid["values"] = self.values
        self.kept = _without(grid, self.planes)
        if self.kept.n_cells == 0:
            raise ValueError("the cuts leave nothing of the bodies")
        straight = "hexahedron"
        if self.corners == 4:
            straight = "tetra"
        self.straight = grid_of(points, straight, cells[:, : self.corners], displacement)
        self.straight["region"] = self.region

        self._look(towards, self.kept.points + self.factor * self.kept["displacement"])

    @property
    @override
    def samples(self) -> tuple[ndarray, ndarray]:
        return self.kept["values"], _volumes(self.kept)

    @override
    def draw(self, plotter: Any, scale: Scale, mesh: bool) -> None:
        import pyvista

        plotter.add_light(pyvista.Light(light_type="headlight"))
        bands, _ = banded(surface_of(self.kept, self.factor), scale)
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
        """Yield edges of regions and of elements, on the surface and on cuts, with their styles."""
        thin = {"color": "#1a1a1a", "opacity": 0.30, "line_width": 1.2}
        thick = {"color": "black", "line_width": 2.5}
        regions = np.unique(self.straight["region"])
        parts = [self.straight.extract_cells(self.straight["region"] == k) for k in regions]
        outsides = []
        for part in parts:
            surface = surface_of(part, 0.0, 0)
            outsides.append(surface.compute_normals(auto_orient_normals=True))

        # Draw the surfaces where no plane cuts them away.
        for outside in outsides:
            corners = outside.extract_feature_edges(EDGE, boundary_edges=False)
            yield from self._kept_edges(corners, self.planes, thick)
        if mesh:
            for outside in outsides:
                yield from self._kept_edges(outside.extract_all_edges(), self.planes, thin)

        # Draw the cuts where no other plane cuts them away.
        for cut in self.planes:
            others = [plane for plane in self.planes if plane is not cut]
            for part, outside in zip(parts, outsides):
                yield from self._kept_edges(outside.slice(**cut._asdict()), others, thick)
                if mesh:
                    elements = part.slice(**cut._asdict()).extract_all_edges()
                    yield from self._kept_edges(elements, others, thin)

    def _kept_edges(
        self,
        lines: Any,
        planes: Sequence[_Plane],
        style: dict[str, Any],
    ) -> Iterator[tuple[Any, dict[str, Any]]]:
        """Yield the lines behind the planes, displaced, with their style, if any."""
        kept = _without(lines, planes)
        if kept.n_cells:
            yield kept.warp_by_vector("displacement", factor=self.factor), style


def _begun(stage: StageResult, since: StageResult) -> ndarray:
    """Return displacements at an earlier stage; nodes of later bodies count from activation."""
    x = since.x.copy()
    bodies = solids(stage)
    is_old = np.zeros(len(x), bool)
    for name, form in bodies.items():
        if name in since.states:
            is_old[form.basis.element_dofs] = True
    for name in bodies.keys() - since.states.keys():
        dofs = np.unique(bodies[name].basis.element_dofs)
        own = dofs[~is_old[dofs]]
        x[own] = reference(stage, since, name)[own]
    return x


def grid_of(points: ndarray, kind: str, cells: ndarray, displacement: ndarray) -> Any:
    """Return pyvista's grid of elements of meshio's kind; points and displacements are (n, 3)."""
    import pyvista

    data = {"displacement": displacement}
    return pyvista.from_meshio(meshio.Mesh(points, [(kind, cells)], point_data=data))


def surface_of(grid: Any, factor: float, subdivision: int = 2) -> Any:
    """Return the outside of bodies that have moved, in flat polygons."""
    moved = grid.warp_by_vector("displacement", factor=factor)
    return moved.extract_surface(nonlinear_subdivision=subdivision, algorithm="dataset_surface")


def banded(surface: Any, scale: Scale) -> tuple[Any, Any]:
    """Return coloured bands of the field "values" of a surface, and the lines between them."""
    # Contour the numbers of the bands in place of the values.
    n = len(scale.levels) - 1
    bands = np.arange(n + 1.0)
    numbers = np.interp(surface["values"], scale.levels, bands)
    surface["values"] = np.clip(numbers, _INSIDE, n - _INSIDE)
    result, lines = surface.contour_banded(
        n + 1, rng=(0.0, float(n)), scalars="values", scalar_mode="index"
    )

    # Take the colour of each band.
    indices = np.asarray(result.cell_data["Scalars"]).astype(int)
    band = np.clip(indices, 0, n - 1)
    colors = 255 * np.asarray(scale.colors(band))[:, :3]
    result.cell_data["colors"] = colors.round().astype(np.uint8)
    return result, lines


def axes_of_view(towards: Sequence[float]) -> ndarray:
    """Return the axes of a view in a direction: to the right, upwards, and towards the eye.

    The last axis of space is upright; seen along it, y points upwards.
    """
    ahead = np.asarray(towards, float)
    if ahead.shape != (3,) or not np.isfinite(ahead).all() or not ahead.any():
        raise ValueError(f"towards is a direction (x, y, z) that is not zero, not {towards!r}")
    right = np.cross(ahead, (0.0, 0.0, 1.0))
    if np.linalg.norm(right) <= 1e-9 * np.linalg.norm(ahead):
        right = np.cross(ahead, (0.0, 1.0, 0.0))
    upwards = np.cross(right, ahead)
    axes = np.stack((right, upwards, -ahead))
    lengths = [np.linalg.norm(axis) for axis in axes]
    return axes / np.reshape(lengths, (3, 1))


def _plane(normal: Sequence[float], origin: Sequence[float]) -> _Plane:
    n = np.asarray(normal, float)
    o = np.asarray(origin, float)
    both_vectors = n.shape == o.shape == (3,)
    if not both_vectors or not np.isfinite((n, o)).all() or not n.any():
        raise ValueError(f"a cut is a normal and a point, (x, y, z) each, not {(normal, origin)!r}")
    return _Plane(n / np.linalg.norm(n), o)


def _without(grid: Any, planes: Sequence[_Plane]) -> Any:
    """Return the part of a grid behind the planes."""
    for plane in planes:
        if grid.n_cells:
            grid = grid.clip(**plane._asdict())
    return grid


def _volumes(grid: Any) -> ndarray:
    """Return the volume that belongs to each point, equal shares of the elements."""
    import pyvista

    volume = np.abs(grid.compute_cell_sizes(length=False, area=False)["Volume"])
    corners = np.diff(pyvista.convert_array(grid.GetCells().GetOffsetsArray()))
    shares = np.repeat(volume / corners, corners)
    return np.bincount(grid.cell_connectivity, shares, minlength=grid.n_points)
