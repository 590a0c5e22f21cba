"""Contour pictures of bodies in space, cut open."""
from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy import ndarray

from ..errors import check_basis
from ..results.export import vtk_cells
from ..results.fields import basis_of, region_field, solids
from ..results.patch_recovery import region_mesh
from ..results.result import StageResult
from .contours import headline, name_of, note_of
from .picture import Frame, can_draw, finish
from .scales import Scale, make_scale
from .scene import banded, grid_of, round_factor, surface_of

#: A plane: its normal, which points to what is cut away, and a place on it.
Cut = tuple[Sequence[float], Sequence[float]]

#: The straight cells with the corners of given ones, by their number.
_CORNERS = {4: lambda cells: ("tetra", cells[:, :4]), 8: lambda cells: ("hexahedron", cells[:, :8])}
#: Share of the size by which lines lie in front of what they are drawn on.
_FRONT = 1e-3
#: Angle between faces, in degrees, from which on an edge is drawn.
_EDGE = 30.0


def cutaway(forms: Mapping[str, Any], step: StageResult, quantity: str, *, cuts: Sequence[Cut] = (),
            since: StageResult | None = None, deformed: float | Literal["auto"] = 0.0,
            limits: tuple[float, float] | None = None, levels: int = 10, colors: str | None = None, mesh: bool = True,
            towards: Sequence[float] = (-1.0, 2.0, -1.0), file: str | Path | None = None, show: bool = False) -> Any:
    """Contour picture of a field on bodies in space, of which parts are cut away.

    Parameters
    ----------
    forms, step, quantity, since, deformed, limits, levels, colors, file, show
        As for :func:`contour`.
    cuts
        Planes, each by its normal, which points to what is cut away, and a place on it; before anything has moved.
    mesh
        Whether to draw the elements, also where the cuts go through them.
    towards
        Direction of view; the last axis is upright.

    Returns
    -------
    pyvista.Plotter or None
        As for :func:`contour`.

    Raises
    ------
    ValueError
        Bodies in the plane, unknown quantity, no solid in the stage, a plane without a normal, or nothing left.

    Examples
    --------
    >>> from skfem import Basis, ElementHex1, ElementVector, MeshHex
    >>> import skfem_contact as sc
    >>> import skfem_contact.plot as plot
    >>> basis = Basis(MeshHex().refined(2), ElementVector(ElementHex1()), intorder=2)
    >>> forms = {"block": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=.3), strain="full")}
    >>> result = sc.Model(forms, sc.box_supports(basis)).run([sc.Stage("weight", sc.weight(basis, 20.))])
    >>> picture = plot.cutaway(forms, result["weight"], "szz", cuts=[((0, -1, 0), (0, .4, 0))])
    """
    basis = basis_of(step)
    check_basis(basis)
    if basis.mesh.dim() != 3:
        raise ValueError("plot.cutaway is for bodies in space; plane ones are drawn by plot.contour")
    planes = [_plane(*cut) for cut in cuts]
    nodes, cells, region = region_mesh(*solids(step).values())
    moved = (step.x if since is None else step.x - since.x)[:basis.N].reshape(-1, 3)[nodes]
    kind, cells = vtk_cells(cells, 3)
    places = basis.doflocs[:, 3 * nodes].T
    grid = grid_of(places, kind, cells, moved)
    straight = grid_of(places, *_CORNERS[len(basis.mesh.t)](cells), moved)  # cells that are cut into polygons
    straight["region"] = region
    grid["values"] = region_field(step, quantity, since)
    factor = round_factor(grid.points, moved) if deformed == "auto" else float(deformed)
    kept = _without(grid, planes)
    if kept.n_cells == 0:
        raise ValueError("the cuts leave nothing of the bodies")
    scale = make_scale(kept["values"], _volumes(kept), limits, levels, colors)
    able, show = can_draw(f"'{quantity}'", show)
    if not able:
        return None
    camera = _Camera(towards, kept.points + factor * kept["displacement"])
    plotter = camera.frame.sheet(show)
    camera.aim(plotter)
    _draw(plotter, straight, kept, planes, factor, scale, mesh, camera)
    title, note = headline(step, quantity, since), note_of(name_of(step, since), factor)
    camera.frame.put_foot(plotter, scale, title, note)
    return finish(plotter, file, show)


class _Camera:
    """A view in parallel projection, tight around some points (n, 3)."""

    def __init__(self, towards: Sequence[float], points: ndarray) -> None:
        ahead = np.asarray(towards, float)
        right = np.cross(ahead, (0.0, 0.0, 1.0))
        if ahead.shape != (3,) or not np.linalg.norm(right) > 1e-9 * np.linalg.norm(ahead):
            raise ValueError(f"towards is a direction (x, y, z) that is not upright, not {towards!r}")
        up = np.cross(right, ahead)
        self.axes = np.stack([axis / np.linalg.norm(axis) for axis in (right, up, -ahead)])
        seen = points @ self.axes.T
        self.frame = Frame(seen[:, :2], None)
        self.size = float(np.ptp(seen, axis=0).max())
        self.middle = self.frame.focus @ self.axes[:2] + seen[:, 2].mean() * self.axes[2]

    def aim(self, plotter: Any) -> None:
        import pyvista

        plotter.subplot(0, 0)
        plotter.enable_parallel_projection()
        plotter.camera_position = [self.middle + 4.0 * self.size * self.axes[2], self.middle, self.axes[1]]
        plotter.camera.parallel_scale = 0.5 * self.frame.height * self.frame.pixel
        plotter.add_light(pyvista.Light(light_type="headlight"))

    def in_front(self, lines: Any) -> Any:
        """Lines moved towards the eye, that are seen on what they are drawn on."""
        return lines.translate(_FRONT * self.size * self.axes[2])


def _draw(plotter: Any, straight: Any, kept: Any, planes: Sequence[_Plane], factor: float, scale: Scale, mesh: bool,
          camera: _Camera) -> None:
    """Bands on the surface that is left, and lines."""
    surface = surface_of(kept, factor)
    bands, _ = banded(surface, scale)
    plotter.add_mesh(bands, scalars="colors", rgb=True, ambient=0.85, diffuse=0.2, specular=0.0, show_scalar_bar=False)
    for lines, style in _lines(straight, planes, factor, mesh):
        plotter.add_mesh(camera.in_front(lines), lighting=False, **style)


def _lines(straight: Any, planes: Sequence[_Plane], factor: float, mesh: bool) -> Iterator[tuple[Any, dict[str, Any]]]:
    """Edges of elements, and those of regions, on the surface and where planes cut it, with their styles."""
    thin, thick = {"color": "#1a1a1a", "opacity": 0.30, "line_width": 1.2}, {"color": "black", "line_width": 2.5}
    parts = [straight.extract_cells(straight["region"] == k) for k in np.unique(straight["region"])]
    outsides = [surface_of(part, 0.0, 0).compute_normals(auto_orient_normals=True) for part in parts]
    found = [(outside.extract_feature_edges(_EDGE, boundary_edges=False), planes, thick) for outside in outsides]
    found += [(outside.extract_all_edges(), planes, thin) for outside in outsides if mesh]
    for cut in planes:
        others = [plane for plane in planes if plane is not cut]
        for part, outside in zip(parts, outsides):
            found.append((outside.slice(normal=cut.normal, origin=cut.origin), others, thick))
            if mesh:
                found.append((part.slice(normal=cut.normal, origin=cut.origin).extract_all_edges(), others, thin))
    for lines, left, style in found:
        if (seen := _without(lines, left)).n_cells:
            yield seen.warp_by_vector("displacement", factor=factor), style


class _Plane(NamedTuple):
    """A unit normal, which points to what is cut away, and a place."""

    normal: ndarray
    origin: ndarray


def _plane(normal: Sequence[float], origin: Sequence[float]) -> _Plane:
    n, o = np.asarray(normal, float), np.asarray(origin, float)
    if n.shape != (3,) or o.shape != (3,) or not np.isfinite((n, o)).all() or not n.any():
        raise ValueError(f"a cut is a normal and a place, (x, y, z) each, not {(normal, origin)!r}")
    return _Plane(n / np.linalg.norm(n), o)


def _without(grid: Any, planes: Sequence[_Plane]) -> Any:
    """What is left behind the planes."""
    for plane in planes:
        if grid.n_cells:
            grid = grid.clip(normal=plane.normal, origin=plane.origin)
    return grid


def _volumes(grid: Any) -> ndarray:
    """Volume that belongs to each point, equal shares of the elements."""
    import pyvista

    volume = np.abs(grid.compute_cell_sizes(length=False, area=False)["Volume"])
    corners = np.diff(pyvista.convert_array(grid.GetCells().GetOffsetsArray()))
    return np.bincount(grid.cell_connectivity, np.repeat(volume / corners, corners), minlength=grid.n_points)
