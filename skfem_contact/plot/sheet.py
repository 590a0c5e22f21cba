"""Sheets of pictures: colour scales, views side by side, the foot with the colour bar, files."""

from __future__ import annotations

import os
import subprocess
import sys
from functools import cache
from io import BytesIO
from pathlib import Path
from typing import Any, NamedTuple

import matplotlib
import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import BoundaryNorm, LinearSegmentedColormap, ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator
from numpy import ndarray
from PIL import Image

from ..arrays import max_abs
from ..checks import format_point
from ..errors import warn

#: Share of the area that may lie below, and above, the limits.
_TAIL = 0.01
#: Factor by which this area would make the scale longer at least.
_LONGER = 3.0
#: A field of both signs has both colours if its smaller side is this share of the larger one.
_BOTH = 0.02
#: Sizes of letters, in points at 100 dots per inch, and the width of a small one in pixels.
_SMALL = 15
_LARGE = 17
_LETTER = 13
#: Pixels of a point at 100 dots per inch, and of the mean letter per point.
_POINT = 100 / 72
_BROAD = 0.75
#: Blue for negative, red for positive values, without the darkest ends: mesh lines are seen on
#: every colour.
_DIVERGING = LinearSegmentedColormap.from_list(
    "signed", ["#3b78b4", "#8ab6d6", "#d6e6f0", "#f9f7f5", "#f8d9c6", "#ec9a79", "#cf4b41"]
)
#: From pale yellow over green to blue, light enough for dark lines.
_SEQUENTIAL = LinearSegmentedColormap.from_list(
    "one sign", ["#fdf6c9", "#d5e8a4", "#9dd3a3", "#62b8b2", "#4796b8", "#4f6fae"]
)
#: Pixels of all views together at most, of the foot, of the title of a view, and between views.
_WIDTH = 1400
_FOOT = 178
_HEAD = 46
_GAP = 24
#: Width over height of all views at least, and of a picture over the largest width.
_ASPECT = 1.4
_NARROWEST = 0.65

#: Level of compression: 6, the default, takes two to three times as long for files 8 % smaller.
PACKED = 2

Window = tuple[float, float, float, float]  # xmin, xmax, ymin, ymax


class Scale(NamedTuple):
    """Scale of n coloured bands."""

    levels: ndarray  # ends of the bands, ascending, (n + 1,)
    colors: ListedColormap  # n colours
    extend: str  # ends of the bar with arrows, in matplotlib's words


def make_scale(
    values: ndarray,
    area: ndarray,
    limits: tuple[float, float] | None,
    n: int,
    colors: str | None,
) -> Scale:
    """Return a scale of about n bands for values and their areas; given limits are not rounded."""
    # Check the arguments, and leave out nodes without a value.
    known = np.isfinite(values)
    if not known.any():
        raise ValueError("there is nothing to draw: no material of these bodies defines this field")
    if n < 1 or colors not in (None, *matplotlib.colormaps):
        raise ValueError(
            f"a scale has at least one level and a colour map of matplotlib, not levels={n!r}, "
            f"colors={colors!r}"
        )
    values = values[known]
    area = area[known]

    # Choose the levels: round values between the limits.
    if limits is not None:
        low, high = map(float, limits)
        if not -np.inf < low < high < np.inf:
            raise ValueError(
                f"limits are two finite numbers, the smaller one first, not {limits!r}"
            )
        levels = _round_levels(low, high, n)
        apart = 1e-9 * (high - low)
        inside = levels[(levels > low + apart) & (levels < high - apart)]
        levels = np.concatenate(([low], inside, [high]))
    else:
        levels = _round_levels(*_robust(values, area), n)

    # Add arrows where values lie beyond the ends.
    slack = 1e-6 * (levels[-1] - levels[0])
    below = bool(values.min() < levels[0] - slack)
    above = bool(values.max() > levels[-1] + slack)
    extend = {
        (False, False): "neither",
        (True, False): "min",
        (False, True): "max",
        (True, True): "both",
    }
    return Scale(levels, ListedColormap(_band_colors(levels, colors)), extend[below, above])


def quantile(values: ndarray, area: ndarray, share: float) -> float:
    """Return the value that a share of the area does not exceed."""
    order = np.argsort(values)
    shares = np.cumsum(area[order]) / area.sum()
    return float(np.interp(share, shares, values[order]))


def _robust(values: ndarray, area: ndarray) -> tuple[float, float]:
    """Return the extremes, or a narrower range that leaves out a little of the area."""
    low = float(values.min())
    high = float(values.max())
    low_of_most = quantile(values, area, _TAIL)
    high_of_most = quantile(values, area, 1.0 - _TAIL)
    room = 0.5 * (_LONGER - 1.0) * (high_of_most - low_of_most)
    if room > 0.0:
        if low_of_most - low > room:
            low = low_of_most
        if high - high_of_most > room:
            high = high_of_most

    # Give a constant field a scale around its value.
    apart = 1e-9 * max(abs(low), abs(high)) or 1.0
    if high - low <= apart:
        return low - apart, high + apart
    return low, high


def _round_levels(low: float, high: float, n: int) -> ndarray:
    """Return multiples of a round step from below the smallest to above the largest value."""
    locator = MaxNLocator(nbins=n, steps=[1, 2, 2.5, 5, 10])
    levels = np.asarray(locator.tick_values(low, high))
    step = levels[1] - levels[0]
    slack = 1e-6 * (high - low)

    # Leave out levels a whole step beyond the values, and make zero exact.
    room = step - slack
    levels = levels[(levels > low - room) & (levels < high + room)]
    return np.where(np.abs(levels) < 1e-9 * step, 0.0, levels)


def _band_colors(levels: ndarray, colors: str | None) -> ndarray:
    """Return colours of the bands, (n, 4): from zero on to both signs, or from light to dark."""
    middle = 0.5 * (levels[1:] + levels[:-1])
    low = float(levels[0])
    high = float(levels[-1])

    # Use both colours where there are both signs.
    smaller = min(-low, high)
    larger = max(-low, high)
    if colors is None and smaller > max(0.0, _BOTH * larger):
        largest = max_abs(middle)
        return np.asarray(_DIVERGING(0.5 + 0.5 * middle / largest))

    # Use the whole colour map otherwise, dark for large magnitudes.
    share = (middle - low) / (high - low)
    share = share - share.min()
    share = share / max(float(np.ptp(share)), 1e-12)
    if colors is not None:
        return np.asarray(matplotlib.colormaps[colors](share))
    if abs(low) > abs(high):
        share = 1.0 - share
    return np.asarray(_SEQUENTIAL(share))


def bar_figure(
    scale: Scale,
    title: str,
    note: str,
    extremes: str,
    size: tuple[int, int],
    marks: dict[str, dict[str, Any]],
) -> Figure:
    """Return the foot of a picture: colour bar, title, note, extremes and legend of marks."""
    # Leave room for the legend below the colour bar.
    figure = Figure(figsize=(size[0] / 100, size[1] / 100), dpi=100)
    axes = figure.add_axes((0.06, 0.39 if marks else 0.32, 0.88, 0.14))
    width = 0.88 * size[0]

    # Write as many levels as have room, with zero among them.
    letters = max(len(_figures(value, scale.levels)) for value in scale.levels)
    n = len(scale.levels)
    every = int(np.ceil(n * _LETTER * (1 + letters) / width))
    zero = int(np.argmin(np.abs(scale.levels))) % every
    mapped = ScalarMappable(BoundaryNorm(scale.levels, n - 1), scale.colors)
    bar = figure.colorbar(
        mapped,
        cax=axes,
        orientation="horizontal",
        extend=scale.extend,
        extendfrac=0.03,
        ticks=scale.levels[zero::every],
        spacing="proportional",
    )
    bar.ax.tick_params(labelsize=_SMALL, length=4)
    bar.ax.xaxis.set_major_formatter(lambda value, _: _figures(value, scale.levels))

    # Write the texts and the legend.
    figure.text(0.06, 0.80, title, fontsize=_LARGE)
    figure.text(0.94, 0.80, note, fontsize=_SMALL, ha="right", color="#444444")
    figure.text(0.06, 0.62, extremes, fontsize=fitting(extremes, width), color="#444444")
    if marks:
        handles = [Line2D([], [], label=label, **style) for label, style in marks.items()]
        figure.legend(
            handles=handles,
            loc="lower center",
            ncol=len(handles),
            frameon=False,
            fontsize=_SMALL,
            bbox_to_anchor=(0.5, -0.07),
            handletextpad=0.4,
        )
    return figure


def capitalised(text: str) -> str:
    """Return a text with a capital at its begin; symbols within it stay as they are."""
    return text[:1].upper() + text[1:]


def fitting(text: str, width: float) -> float:
    """Return the size of letters, in points at 100 dots per inch, of a text within a width."""
    return min(_SMALL, width / (_BROAD * max(len(text), 1)))


def _figures(value: float, levels: ndarray) -> str:
    """Return a level with the digits that distinguish it from its neighbours, and a true minus."""
    step = float(np.diff(levels).min())
    largest = max_abs(levels)
    exponent = int(np.floor(np.log10(step) + 1e-9))
    if largest >= 1e5 or largest < 1e-3:
        power = int(np.floor(np.log10(largest)))
        digits = max(0, power - exponent)
        if value == 0:
            text = "0"
        else:
            text = f"{value / 10.0**power:.{digits}f}e{power}"
    else:
        digits = max(0, -exponent)
        multiple = step * 10**digits
        if abs(round(multiple) - multiple) > 1e-6:
            digits += 1  # steps of 2.5
        text = f"{value:.{digits}f}"
    return text.replace("-", "−")


class Frame:
    """Views side by side that show points (n, 2) or a window, and the foot below them."""

    def __init__(
        self,
        points: ndarray,
        window: Window | None,
        views: int,
        titled: bool,
        margin: float,
        width: int = _WIDTH,
    ) -> None:
        # Find the corners of the part to show, with a margin.
        low = points.min(axis=0)
        high = points.max(axis=0)
        if window is not None:
            low, high = _window(window, low, high)
        free = margin * (high - low).max()
        low = low - free
        high = high + free
        self.focus = 0.5 * (low + high)

        # Arrange the views in columns, and find the size of a pixel.
        self.columns = {1: 1, 2: 2, 4: 2}.get(views, 3)
        self.rows = -(-views // self.columns)
        room = (width / self.columns, width / _ASPECT / self.rows)
        self.pixel = float(max((high - low) / room))
        wide, tall = np.ceil((high - low) / self.pixel - 1e-6).astype(int)
        narrowest = int(_NARROWEST * width) // self.columns
        self.view = (max(int(wide), narrowest), int(tall))
        self.head = _HEAD if titled else 0

    def make_even(self) -> None:
        """Round sizes to whole multiples of 16, which the codecs of films take."""
        height = 16 * -(-(self.height + _FOOT) // 16)
        self.view = (16 * -(-self.view[0] // 16), height - _FOOT - self.head)

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the whole picture."""
        return self.columns * (self.view[0] + _GAP) - _GAP, self.rows * self.height + _FOOT

    @property
    def height(self) -> int:
        """Height of a view with its title."""
        return self.view[1] + self.head

    def sheet(self, show: bool) -> Any:
        """Return a plotter with the views and an empty foot."""
        import pyvista

        if self.head:
            row = [self.head, self.view[1]]
        else:
            row = [self.view[1]]
        rows = row * self.rows + [_FOOT]
        columns = [self.view[0], _GAP] * self.columns
        # VTK complains of displays that it tries before it finds one.
        with pyvista.vtk_verbosity("off"):
            plotter = _picture()(
                off_screen=not show,
                window_size=list(self.size),
                lighting="none",
                border=False,
                shape=(len(rows), len(columns) - 1),
                row_weights=rows,
                col_weights=columns[:-1],
                groups=[(len(rows) - 1, slice(None))],
            )
        plotter.set_background("white", all_renderers=True)
        # Smooth edges in the views, once; in the foot it would shrink the figure.
        plotter.ren_win.SetMultiSamples(0)
        for renderer in list(plotter.renderers)[:-1]:
            renderer.enable_anti_aliasing("ssaa")
        return plotter

    def cell(self, number: int) -> tuple[int, int]:
        """Return row and column of a view; its title is in the row above."""
        row, column = divmod(number, self.columns)
        return (2 * row + 1 if self.head else row), 2 * column

    def aim(
        self,
        plotter: Any,
        number: int,
        title: str,
        axes: ndarray,
        depth: float,
        distance: float,
    ) -> None:
        """Look in one of the views along the last of three axes, from a distance to a depth."""
        row, column = self.cell(number)
        if self.head:
            plotter.subplot(row - 1, column)
            text = plotter.add_text(
                title, position=(0.5, 0.3), viewport=True, color="black", font="arial", name="title"
            )
            text.prop.font_size = int(_POINT * fitting(title, self.view[0]))
            text.prop.justification_horizontal = "center"
        plotter.subplot(row, column)
        plotter.enable_parallel_projection()
        focus = self.focus @ axes[:2] + depth * axes[2]
        plotter.camera_position = [focus + distance * axes[2], focus, axes[1]]
        plotter.camera.parallel_scale = 0.5 * self.view[1] * self.pixel
        plotter.renderer.ResetCameraClippingRange()

    def put_foot(
        self,
        plotter: Any,
        scale: Scale,
        title: str,
        note: str,
        extremes: str,
        marks: dict[str, dict[str, Any]],
    ) -> None:
        """Put the colour bar into the foot, with texts and a legend of marks."""
        import pyvista

        last_row, _ = self.cell(self.columns * self.rows - 1)
        plotter.subplot(last_row + 1, 0)
        figure = bar_figure(scale, title, note, extremes, (self.size[0], _FOOT), marks)
        chart = pyvista.ChartMPL(figure, redraw_on_render=False)
        chart.border_color = "white"
        chart.background_color = "white"
        plotter.add_chart(chart)
        plotter.subplot(*self.cell(0))


def _window(window: Window, low: ndarray, high: ndarray) -> tuple[ndarray, ndarray]:
    """Return the corners of a window, which must show some of the bodies between two corners."""
    begin = np.array(window[0::2], float)
    end = np.array(window[1::2], float)
    if not (begin < end).all():
        raise ValueError(f"a window is (xmin, xmax, ymin, ymax), not {window!r}")
    if (begin > high).any() or (end < low).any():
        raise ValueError(
            f"the window {window!r} shows nothing of the bodies, which lie between "
            f"{format_point(low)} and {format_point(high)}"
        )
    return begin, end


def finish(plotter: Any, file: Any, show: bool) -> Any:
    """Write the file, open the window where it is asked for, and return the plotter."""
    if file and Path(file).suffix.lower() == ".png":
        pixels = plotter.screenshot(None, return_img=True)
        Path(file).write_bytes(png(pixels))
    elif file:
        plotter.screenshot(file, return_img=False)
    elif not show:
        plotter.render()
    if show:
        plotter.show(auto_close=False)
    return plotter


def png(pixels: ndarray) -> bytes:
    """Return an image (height, width, 3) as a file."""
    content = BytesIO()
    Image.fromarray(np.asarray(pixels)).save(content, format="png", compress_level=PACKED)
    return content.getvalue()


def close(plotter: Any) -> None:
    """Close a plotter whose picture was taken; pages of a gallery do not show it again."""
    import pyvista

    plotter.close()
    pyvista.plotting.plotter._ALL_PLOTTERS.pop(plotter._id_name, None)


def can_draw(title: str, show: bool = False) -> tuple[bool, bool]:
    """Return whether VTK can draw, and whether to open a window; warn where it cannot."""
    if not _can_render():
        warn(
            f"no picture of '{title}': VTK cannot draw on this machine, it needs OpenGL "
            "(a display, or the libraries EGL or OSMesa)",
            UserWarning,
        )
        return False, False
    if show and not _has_windows():
        warn(
            f"no window for '{title}': this machine has no display; file= writes the picture",
            UserWarning,
        )
        return True, False
    return True, show


def _has_windows() -> bool:
    import pyvista

    if pyvista.OFF_SCREEN:
        return False
    return sys.platform in ("win32", "darwin") or bool(
        os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    )


@cache
def _picture() -> Any:
    """Return the class of plotters that a notebook shows; pyvista is imported at its first use."""
    import pyvista

    class Picture(pyvista.Plotter):
        def _repr_png_(self) -> bytes:
            image = BytesIO()
            self.screenshot(image, return_img=False)
            return image.getvalue()

    return Picture


@cache
def _can_render() -> bool:
    """Return whether VTK draws; without OpenGL it would crash, in a process of its own."""
    if _kind_of_window() == "vtkEGLRenderWindow":  # chosen after its display has been opened
        return True
    code = (
        "import vtkmodules.vtkRenderingOpenGL2; from vtkmodules.vtkRenderingCore import "
        "vtkRenderWindow; "
        "w = vtkRenderWindow(); w.SetOffScreenRendering(1); w.SetSize(8, 8); w.Render()"
    )
    return subprocess.run([sys.executable, "-c", code], capture_output=True).returncode == 0


def _kind_of_window() -> str:
    """Return the class of windows that VTK chooses on this machine."""
    import pyvista
    import vtkmodules.vtkRenderingOpenGL2  # noqa: F401  (it brings the classes)
    from vtkmodules.vtkRenderingCore import vtkRenderWindow

    with pyvista.vtk_verbosity("off"):  # it complains of displays that the machine lacks
        return str(vtkRenderWindow().GetClassName())
