"""Round levels, limits that one corner does not spoil, and colours."""
from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from matplotlib.colors import LinearSegmentedColormap, ListedColormap
from matplotlib.ticker import MaxNLocator
from numpy import ndarray

#: Share of the area that may lie below, and above, the limits where it would make the scale so much longer.
_TAIL, _LONGER = 0.01, 3.0
#: A field with both signs has them in both colours if the smaller side is at least this share of the larger one.
_BOTH = 0.02
#: Sizes of letters, in points at 100 dots per inch.
_SMALL, _LARGE = 15, 17
_LETTER = 13  # width of a small one in pixels


class Scale(NamedTuple):
    """Levels between the bands of a picture, and their colours.

    Attributes
    ----------
    levels
        Ends of the bands, ascending, (n + 1,).
    colors
        Colour map with one colour for each band.
    extend
        Where values lie beyond the ends and the colour bar has arrows, in matplotlib's words: ``"neither"``, ``"min"``,
        ``"max"`` or ``"both"``.
    """

    levels: ndarray
    colors: ListedColormap
    extend: str


def make_scale(values: ndarray, area: ndarray, limits: tuple[float, float] | None, n: int, colors: str | None) -> Scale:
    """A scale for values: given limits as they are, others rounded so that zero is a level.

    Parameters
    ----------
    values
        Of everything that is drawn with this scale.
    area
        Of the bodies at each of the values.
    limits
        Ends of the scale.
    n
        Number of bands, about; with given limits exactly.
    colors
        Name of a matplotlib colour map; by default one colour for one sign and two for both.
    """
    if limits is not None:
        low, high = float(limits[0]), float(limits[1])
        if not -np.inf < low < high < np.inf:
            raise ValueError(f"limits are two finite numbers, the smaller one first, not {limits!r}")
        levels = _round_levels(low, high, n)
        levels = np.unique(np.concatenate(([low], levels[(levels > low) & (levels < high)], [high])))
        apart = np.diff(levels, prepend=-np.inf) > 1e-9 * (high - low)
        levels = levels[apart]
    else:
        levels = _round_levels(*_robust(values, area), n)
    slack = 1e-6 * (levels[-1] - levels[0])
    below, above = values.min() < levels[0] - slack, values.max() > levels[-1] + slack
    extend = ("both" if above else "min") if below else ("max" if above else "neither")
    return Scale(levels, ListedColormap(_band_colors(levels, colors)), extend)


def _robust(values: ndarray, area: ndarray) -> tuple[float, float]:
    """Smallest and largest value, or where all but a little of the area lies if that little would spoil the scale."""
    order = np.argsort(values)
    share = np.cumsum(area[order]) / area.sum()
    most = [float(np.interp(part, share, values[order])) for part in (_TAIL, 1.0 - _TAIL)]
    low, high = float(values.min()), float(values.max())
    if (room := 0.5 * (_LONGER - 1.0) * (most[1] - most[0])) > 0.0:
        low = low if most[0] - low <= room else most[0]
        high = high if high - most[1] <= room else most[1]
    apart = 1e-9 * max(abs(low), abs(high)) or 1.0
    return (low, high) if high - low > apart else (low - apart, high + apart)


def _round_levels(low: float, high: float, n: int) -> ndarray:
    """Multiples of a round step from below the smallest to above the largest value."""
    levels = np.asarray(MaxNLocator(nbins=n, steps=[1, 2, 2.5, 5, 10]).tick_values(low, high))
    step, slack = levels[1] - levels[0], 1e-6 * (high - low)
    levels = levels[(levels > low - step + slack) & (levels < high + step - slack)]
    return np.where(np.abs(levels) < 1e-9 * step, 0.0, levels)


def _band_colors(levels: ndarray, colors: str | None) -> ndarray:
    """Colours of the bands, (n, 4): around zero where there are both signs, from light to dark where there is one."""
    import matplotlib

    middle = 0.5 * (levels[1:] + levels[:-1])
    low, high = float(levels[0]), float(levels[-1])
    if colors is None and low < 0.0 < high and min(-low, high) > _BOTH * max(-low, high):
        largest = float(np.abs(middle).max())
        return np.asarray(_diverging()(0.5 + 0.5 * middle / largest))
    place = (middle - low) / (high - low)
    place = (place - place.min()) / max(float(np.ptp(place)), 1e-12)
    if colors is not None:
        return np.asarray(matplotlib.colormaps[colors](place))
    return np.asarray(_sequential()(1.0 - place if abs(low) > abs(high) else place))


def _diverging() -> LinearSegmentedColormap:
    """Blue for negative, red for positive values, without the darkest ends: mesh lines are seen on every colour."""
    colors = ["#3b78b4", "#8ab6d6", "#d6e6f0", "#f9f7f5", "#f8d9c6", "#ec9a79", "#cf4b41"]
    return LinearSegmentedColormap.from_list("signed", colors)


def _sequential() -> LinearSegmentedColormap:
    """From pale yellow over green to blue, light enough for dark lines."""
    colors = ["#fdf6c9", "#d5e8a4", "#9dd3a3", "#62b8b2", "#4796b8", "#4f6fae"]
    return LinearSegmentedColormap.from_list("one sign", colors)


def bar_figure(scale: Scale, title: str, note: str, size: tuple[int, int],
               marks: dict[str, dict[str, Any]]) -> Any:
    """A matplotlib figure with the colour bar, its title, a note and a legend of marks, for the foot of a picture.

    Parameters
    ----------
    scale
        What the bar shows.
    title, note
        Above the bar, on the left and on the right.
    size
        Width and height in pixels.
    marks
        Line styles of what else is drawn, by their labels.
    """
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import BoundaryNorm
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

    figure = Figure(figsize=(size[0] / 100, size[1] / 100), dpi=100)
    axes = figure.add_axes((0.06, 0.46 if marks else 0.38, 0.88, 0.17))
    norm = BoundaryNorm(scale.levels, len(scale.levels) - 1)
    words = [_figures(value, scale.levels) for value in scale.levels]
    every = int(np.ceil(len(words) * _LETTER * (1 + max(map(len, words))) / (0.88 * size[0])))
    zero = int(np.argmin(np.abs(scale.levels))) % every  # if there is one, it is written
    bar = figure.colorbar(ScalarMappable(norm, scale.colors), cax=axes, orientation="horizontal", extend=scale.extend,
                          extendfrac=0.03, ticks=scale.levels[zero::every], spacing="proportional")
    bar.ax.tick_params(labelsize=_SMALL, length=4)
    bar.ax.xaxis.set_major_formatter(lambda value, _: _figures(value, scale.levels))
    figure.text(0.06, 0.74, title, fontsize=_LARGE)
    figure.text(0.94, 0.74, note, fontsize=_SMALL, ha="right", color="#444444")
    if marks:
        handles = [Line2D([], [], label=label, **style) for label, style in marks.items()]
        figure.legend(handles=handles, loc="lower center", ncol=len(handles), frameon=False, fontsize=_SMALL,
                      bbox_to_anchor=(0.5, -0.07), handletextpad=0.4)
    return figure


def _figures(value: float, levels: ndarray) -> str:
    """A level with as many digits as tell it from its neighbours, and a true minus sign."""
    step = float(np.diff(levels).min())
    largest = float(np.abs(levels).max())
    if largest >= 1e5 or largest < 1e-3:
        power = int(np.floor(np.log10(largest)))
        digits = max(0, power - int(np.floor(np.log10(step) + 1e-9)))
        text = "0" if value == 0 else f"{value / 10.0**power:.{digits}f}e{power}"
    else:
        digits = max(0, -int(np.floor(np.log10(step) + 1e-9)))
        if abs(round(step * 10**digits) - step * 10**digits) > 1e-6:
            digits += 1  # steps of 2.5
        text = f"{value:.{digits}f}"
    return text.replace("-", "−")
