"""The sheet that pictures are drawn on: views side by side, a foot with the colour bar, files and windows."""
from __future__ import annotations

import os
import subprocess
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy import ndarray

from .scales import Scale, bar_figure

#: Pixels of all views together at most, and of the foot and the views' titles.
_WIDTH, _FOOT, _HEAD = 1400, 150, 46
#: Width over height of all views at least, and of a picture over the largest width.
_ASPECT, _NARROWEST = 1.4, 0.65


class Frame:
    """What a view shows and how large it is in pixels.

    Parameters
    ----------
    places
        Points (n, 2) that must be seen.
    window
        Part to show instead, ``(xmin, xmax, ymin, ymax)``.
    views
        Number of views side by side.
    titled
        Whether each of them has its title above it.
    margin
        Share of the size that is left free around the points.
    width
        Pixels of all views together at most; the height is at most as many times 5/7.
    """

    def __init__(self, places: ndarray, window: tuple[float, float, float, float] | None, views: int = 1,
                 titled: bool = False, margin: float = 0.03, width: int = _WIDTH) -> None:
        low, high = places.min(axis=0), places.max(axis=0)
        if window is not None:
            low, high = np.array(window[0::2], float), np.array(window[1::2], float)
            if not (low < high).all():
                raise ValueError(f"a window is (xmin, xmax, ymin, ymax), not {window!r}")
        free = margin * (high - low).max()
        low, high = low - free, high + free
        self.focus = 0.5 * (low + high)
        columns = 1 if views == 1 else 2 if views in (2, 4) else 3
        self.rows, self.columns = -(-views // columns), columns
        self.pixel = float(max((high - low) / (width / columns, width / _ASPECT / self.rows)))
        wide, high = np.ceil((high - low) / self.pixel - 1e-6).astype(int)
        self.view = (max(int(wide), int(_NARROWEST * width) // columns), int(high))
        self.head = _HEAD if titled else 0

    def make_even(self) -> None:
        """Sizes that the codecs of films take: whole multiples of 16."""
        self.view = (16 * -(-self.view[0] // 16), 16 * -(-(self.height + _FOOT) // 16) - _FOOT - self.head)

    @property
    def size(self) -> list[int]:
        """Width and height of the whole picture."""
        return [self.columns * self.view[0], self.rows * self.height + _FOOT]

    @property
    def height(self) -> int:
        """Height of a view with its title."""
        return self.view[1] + self.head

    def sheet(self, show: bool) -> Any:
        """A plotter with the views and an empty foot."""
        rows = [self.height] * self.rows + [_FOOT]
        with _quiet_vtk():
            plotter = _picture()(off_screen=not show, window_size=self.size, lighting="none", border=False,
                                 shape=(self.rows + 1, self.columns), row_weights=rows,
                                 groups=[(self.rows, slice(None))])
        plotter.set_background("white", all_renderers=True)
        for renderer in list(plotter.renderers)[:-1]:  # in the foot it would shrink the figure
            renderer.enable_anti_aliasing("ssaa")
        return plotter

    def aim(self, plotter: Any, number: int, title: str) -> None:
        """Look at a view from above, tight."""
        plotter.subplot(number // self.columns, number % self.columns)
        if self.head:
            plotter.add_text(title, position="upper_edge", color="black", font="arial", font_size=8)
        plotter.enable_parallel_projection()
        shift = 0.5 * (self.height - self.view[1]) * self.pixel
        x, y = self.focus[0], self.focus[1] + shift
        plotter.camera_position = [(x, y, 1.0), (x, y, 0.0), (0.0, 1.0, 0.0)]
        plotter.camera.parallel_scale = 0.5 * self.height * self.pixel
        plotter.renderer.ResetCameraClippingRange()

    def put_foot(self, plotter: Any, scale: Scale, title: str, note: str = "",
                 marks: dict[str, dict[str, Any]] | None = None) -> None:
        """Put the colour bar into the foot, with its title on the left, a note on the right and a legend of marks."""
        import pyvista

        plotter.subplot(self.rows, 0)
        figure = bar_figure(scale, title, note, (self.size[0], _FOOT), marks or {})
        chart = pyvista.ChartMPL(figure, redraw_on_render=False)
        chart.border_color, chart.background_color = "white", "white"
        plotter.add_chart(chart)
        plotter.subplot(0, 0)


def finish(plotter: Any, file: str | Path | None, show: bool) -> Any:
    """Write the file, open the window where it is asked for, and return the plotter."""
    if file:
        plotter.screenshot(file, return_img=False)
    elif not show:
        plotter.render()
    if show:
        plotter.show(auto_close=False)
    return plotter


def can_draw(what: str, show: bool = False) -> tuple[bool, bool]:
    """Whether VTK can draw here, and whether it can open a window; warns where it cannot do what is asked for."""
    if not _can_render():
        warnings.warn(f"no picture of {what}: VTK cannot draw on this machine, it needs OpenGL "
                      "(a display, or the libraries EGL or OSMesa)", stacklevel=3)
        return False, False
    if show and not _has_windows():
        warnings.warn(f"no window for {what}: this machine has no display; file= writes the picture", stacklevel=3)
        return True, False
    return True, show


def _has_windows() -> bool:
    """Whether there is a window system."""
    import pyvista

    if pyvista.OFF_SCREEN:
        return False
    return sys.platform in ("win32", "darwin") or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


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
