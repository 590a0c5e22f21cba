"""Contour pictures by pyvista."""
from __future__ import annotations

import subprocess
import sys
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import cache
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy import ndarray

from ..analysis.result import StageResult
from ..checks import check_plane
from ..post.fields import QUANTITIES, element_nodes, nodal_field, solids, solids_there
from ..water import Seepage

#: VTK's numbers of the cells with so many nodes.
_CELL_TYPES = {3: 5, 4: 9, 6: 22, 8: 23, 9: 28}
_BANDS = 12
_WATER = "#1f4e8c"
_WIDTH, _HEIGHT, _BAR = 1400, 1000, 120  # pixels of the bodies at most, and of the colour bar below them


def contour(forms: Mapping[str, Any], step: StageResult, quantity: str, deformed: float = 0.0,
            file: str | Path | None = None, limits: tuple[float, float] | None = None,
            window: tuple[float, float, float, float] | None = None, colors: str = "viridis",
            edges: bool = True, water: Seepage | None = None) -> Any:
    """Contour picture of a field on the bodies.

    Parameters
    ----------
    forms
        Forms by name; the solids among them that are there in the stage are drawn.
    step
        A stage of the result of these forms.
    quantity
        A field of :func:`~skfem_contact.nodal_field`: ``"ux"``, ``"syy"``, ``"mises"``, ``"plastic"``, ...
    deformed
        Factor of the displacements; with one, the undeformed outline is drawn too.
    file
        Name of a picture to write, ``.png``.
    limits
        Values at the ends of the colour scale; by default those of the field.
    window
        Part to show, ``(xmin, xmax, ymin, ymax)``; by default everything.
    colors
        Name of a matplotlib colour map.
    edges
        Whether to draw the elements.
    water
        Seepage through the bodies, whose free surface is drawn.

    Returns
    -------
    pyvista.Plotter or None
        The plotter, which a notebook shows as a picture, or None with a warning where this machine cannot draw:
        VTK needs OpenGL.

    Raises
    ------
    ValueError
        Unknown quantity, no solid among the forms is there in the stage, or bodies in three dimensions.

    Examples
    --------
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> import skfem_contact.plot as plot
    >>> basis = Basis(MeshQuad().refined(3).with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    >>> forms = {"block": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=.3))}
    >>> stage = sc.Stage("weight", sc.weight(basis, 20.))
    >>> result = sc.run(forms, [stage], fixed=basis.get_dofs("bottom").all())
    >>> picture = plot.contour(forms, result["weight"], "uy", deformed=10.)
    """
    check_plane(next(iter(solids(forms).values())).basis, "plot.contour")
    values = nodal_field(forms, step, quantity)
    if not _can_render():
        warnings.warn(f"no picture of '{quantity}': VTK cannot draw on this machine, it needs OpenGL "
                      "(a display, or the libraries EGL or OSMesa)", stacklevel=2)
        return None
    scene = _Scene(forms, step, deformed)
    with _quiet_vtk():
        plotter = _picture()(off_screen=True, window_size=scene.frame(window), lighting="none",
                             shape=(2, 1), row_weights=(scene.size[1] - _BAR, _BAR), border=False)
    plotter.set_background("white", all_renderers=True)
    plotter.enable_anti_aliasing("ssaa")
    mapper = scene.add_field(plotter, values, limits, colors)
    if edges:
        plotter.add_mesh(scene.lines(scene.edges, scene.moved, 1), color="black", opacity=0.3, line_width=2)
    if deformed:
        plotter.add_mesh(scene.lines(scene.outline, scene.points, 2), color="#999999", line_width=3)
    plotter.add_mesh(scene.lines(scene.outline, scene.moved, 3), color="black", line_width=4)
    for line in water.free_surface if water is not None else ():
        sides = np.column_stack((np.arange(len(line) - 1), np.arange(1, len(line))))
        plotter.add_mesh(scene.lines(sides, line, 4), color=_WATER, line_width=6)
    scene.look_from_above(plotter)
    _add_bar(plotter, mapper, QUANTITIES[quantity] + (f", deformed {deformed:g} times" if deformed else ""))
    plotter.screenshot(file, return_img=False) if file else plotter.render()
    return plotter


class _Scene:
    """The bodies of some forms, ready to be drawn from above."""

    def __init__(self, forms: Mapping[str, Any], step: StageResult, deformed: float) -> None:
        bodies = list(solids_there(forms, step).values())
        basis = bodies[0].basis
        self.cells = np.concatenate([element_nodes(form) for form in bodies])
        self.points = basis.doflocs[:, 0::2].T
        self.moved = self.points + deformed * step.x.reshape(-1, 2)
        n = {3: 3, 4: 4, 6: 3, 8: 4, 9: 4}[self.cells.shape[1]]
        corner = np.arange(n)
        middle = (n + corner,) if self.cells.shape[1] > n else ()
        side = np.column_stack((corner, *middle, (corner + 1) % n))
        sides = self.cells[:, side].reshape(-1, side.shape[1])
        ends = np.sort(sides[:, [0, -1]], axis=1)
        _, first, count = np.unique(ends, axis=0, return_index=True, return_counts=True)
        self.edges, self.outline = sides[first], sides[first[count == 1]]

    def frame(self, window: tuple[float, float, float, float] | None) -> list[int]:
        """Choose what is seen, and the size of the picture in pixels: the colour bar goes below."""
        shown = np.concatenate((self.moved[self.edges.ravel()], self.points[self.edges.ravel()]))
        low, high = shown.min(axis=0), shown.max(axis=0)
        if window is not None:
            low, high = np.array(window[0::2]), np.array(window[1::2])
        low, high = low - 0.02 * (high - low), high + 0.02 * (high - low)
        self.pixel = max((high - low) / (_WIDTH, _HEIGHT))
        width, height = np.ceil((high - low) / self.pixel).astype(int)
        self.size = [max(int(width), _WIDTH // 2), int(height) + _BAR]
        self.focus = 0.5 * (low + high)
        return self.size

    def lines(self, sides: ndarray, points: ndarray, level: int) -> Any:
        """Sides of elements as lines, lifted a little so that they are seen on top of the field."""
        import pyvista

        cells = np.column_stack((np.full(len(sides), sides.shape[1]), sides))
        return pyvista.PolyData(self._in_space(points, level), lines=cells.ravel())

    def add_field(self, plotter: Any, values: ndarray, limits: tuple[float, float] | None,
                  colors: str) -> Any:
        """The bodies, coloured by values at their nodes; returns the mapper of the colours."""
        import pyvista

        cells = np.column_stack((np.full(len(self.cells), self.cells.shape[1]), self.cells))
        types = np.full(len(cells), _CELL_TYPES[self.cells.shape[1]])
        grid = pyvista.UnstructuredGrid(cells.ravel(), types, self._in_space(self.moved, 0))
        grid["values"] = values
        return plotter.add_mesh(grid, scalars="values", cmap=colors, clim=limits or _limits(values),
                                n_colors=_BANDS, lighting=False, show_scalar_bar=False).mapper

    def look_from_above(self, plotter: Any) -> None:
        """Parallel view, tight."""
        plotter.enable_parallel_projection()
        plotter.camera_position = [(*self.focus, 1.0), (*self.focus, 0.0), (0.0, 1.0, 0.0)]
        plotter.camera.parallel_scale = 0.5 * (self.size[1] - _BAR) * self.pixel
        plotter.renderer.ResetCameraClippingRange()

    def _in_space(self, points: ndarray, level: int) -> ndarray:
        return np.column_stack((points, np.full(len(points), level * self.pixel)))


def _add_bar(plotter: Any, mapper: Any, title: str) -> None:
    """The colour bar of the field, with its title, below the picture."""
    plotter.subplot(1, 0)
    plotter.add_scalar_bar(title="", mapper=mapper, color="black", vertical=False, n_labels=5, fmt="%.3g",
                           n_colors=_BANDS, label_font_size=24, width=0.8, height=0.5, position_x=0.1,
                           position_y=0.05)
    plotter.add_text(title, position="upper_edge", color="black", font_size=13)
    plotter.subplot(0, 0)


def _limits(values: ndarray) -> tuple[float, float]:
    """Smallest and largest value, apart even where the field is constant."""
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    apart = 1e-9 * max(abs(low), abs(high)) or 1.0
    return (low, high) if high - low > apart else (low - apart, high + apart)


@cache
def _picture() -> Any:
    """Plotters that a notebook shows; the class is made at its first use, because pyvista is not needed before."""
    import pyvista

    class Picture(pyvista.Plotter):
        def _repr_png_(self) -> bytes:
            image = BytesIO()
            self.screenshot(image, return_img=False)
            return image.getvalue()

    return Picture


@cache
def _can_render() -> bool:
    """Whether VTK can draw here; asked in a process of its own, because without OpenGL it crashes."""
    code = ("import vtkmodules.vtkRenderingOpenGL2; from vtkmodules.vtkRenderingCore import vtkRenderWindow; "
            "w = vtkRenderWindow(); w.SetOffScreenRendering(1); w.SetSize(8, 8); w.Render()")
    return subprocess.run([sys.executable, "-c", code], capture_output=True).returncode == 0


@contextmanager
def _quiet_vtk() -> Iterator[None]:
    """Keep VTK from complaining about the displays that it tries in vain before it finds one."""
    from vtkmodules.vtkCommonCore import vtkLogger

    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
    try:
        yield
    finally:
        vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_INFO)
