"""Diagrams of values along a line, and of histories at points."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy import ndarray

from ..results.points import PointValues
from ..units import labelled
from .diagram import saved, stacked, styles, tidy


def values(
    found: PointValues, *, upright: bool | None = None, file: str | Path | None = None
) -> Figure:
    """Draw values along a line over the position, or histories at points over the stages.

    Parameters
    ----------
    found
        Values of :meth:`~skfem_contact.results.StageResult.along` or of
        :meth:`~skfem_contact.results.Result.at`.
    upright
        Draw the coordinate of a line upright; by default where the line is.
    file
        Name of a picture to write.

    Returns
    -------
    Figure
        One panel for each field.

    Examples
    --------
    >>> from skfem_contact.demo import culvert
    >>> import skfem_contact.plot as plot
    >>> result = culvert().result
    >>> trough = plot.values(result["surcharge"].along([(-3., 3.5), (3., 3.5)], "uy"))
    >>> history = plot.values(result.at({"surface": (.9, 3.5)}, "uy", "ux"))
    """
    columns = found.columns
    if "stage" in columns:
        return saved(_histories(found), file)
    if "position" not in columns:
        raise ValueError(
            "values at points have no order to draw them in: take stage.along(line, ...) or "
            "result.at(points, ...)"
        )

    # Draw an upright line over its height, any other over the distance along it.
    height = columns["y" if "z" not in columns else "z"]
    is_upright = bool(np.isclose(np.ptp(height), np.ptp(columns["position"])))
    if upright is None:
        upright = is_upright
    coordinate = columns["position"]
    label = labelled("position", "length")
    if upright and is_upright:
        coordinate = height
        label = labelled("y" if "z" not in columns else "z", "length")
    return saved(_lines(found, coordinate, label, upright), file)


def _lines(found: PointValues, coordinate: ndarray, label: str, upright: bool) -> Figure:
    """Draw a panel for each field over a coordinate."""
    # Choose the arrangement.
    n = len(found.titles)
    shape = (1, n) if upright else (n, 1)
    if upright:
        size = (3.0 + 2.5 * n, 5.5)
    else:
        size = (8.0, 1.5 + 2.2 * n)
    figure, panels = plt.subplots(
        *shape,
        figsize=size,
        sharex=not upright,
        sharey=upright,
        squeeze=False,
        layout="constrained",
    )
    axes = panels.ravel()
    style = styles(1)[0]
    # Draw the fields, and name the axes.
    for ax, (name, title) in zip(axes, found.titles.items(), strict=True):
        if upright:
            curve = (found[name], coordinate)
        else:
            curve = (coordinate, found[name])
        ax.plot(*curve, **style)
        ax.set(**{"xlabel" if upright else "ylabel": labelled(*title)})
        tidy(ax, 1)
    if upright:
        axes[0].set_ylabel(label)
    else:
        axes[-1].set_xlabel(label)
    figure.suptitle(found.caption, fontsize="medium")
    return figure


def _histories(found: PointValues) -> Figure:
    """Draw a panel for each field over the times, or the shares of the stages."""
    # Number the points of every step.
    columns = found.columns
    labels = columns.get("point")
    if labels is None:
        pairs = zip(columns["x"], columns["y"], strict=True)
        labels = np.array([f"({x:g}, {y:g})" for x, y in pairs])
    different = list(dict.fromkeys(labels))
    steps = _abscissa(found, len(different))

    # Draw every field in its panel.
    figure, axes = stacked(len(found.titles))
    for ax, (name, title) in zip(axes, found.titles.items(), strict=True):
        for style, label in zip(styles(len(different)), different, strict=True):
            style |= {"linestyle": "-", "marker": "o", "markersize": 4}
            ax.plot(steps, found[name][labels == label], label=label, **style)
        ax.set_ylabel(labelled(*title))
        tidy(ax, len(different))
    _write_abscissa(axes[-1], found)
    return figure


def _abscissa(found: PointValues, n: int) -> ndarray:
    """Return the time of every step, or the number of its stage less the share that remains."""
    columns = found.columns
    if "time" in columns:
        return np.asarray(columns["time"][::n])
    names = list(dict.fromkeys(columns["stage"]))
    number = np.array([names.index(name) for name in columns["stage"][::n]], float)
    if "load" in columns:
        number += columns["load"][::n] - 1.0
    return number


def _write_abscissa(ax: Axes, found: PointValues) -> None:
    """Write the times or the names of the stages below the last panel."""
    if "time" in found.columns:
        ax.set_xlabel("time")
        return
    names = list(dict.fromkeys(found.columns["stage"]))
    ax.set_xticks(range(len(names)), names)
