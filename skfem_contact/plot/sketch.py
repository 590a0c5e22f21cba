"""Sketches of sections before they are meshed, by matplotlib."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch
from matplotlib.path import Path as Outlines
from numpy import ndarray

from ..section.outline import Outline
from ..section.section import Section
from ..units import labelled
from .diagram import saved

#: Colours of areas in their order, of lifts and of lines.
_AREAS = ("#e8d8a8", "#c9b184", "#a8b89a", "#d9c3b0", "#b8a6a0", "#9fb3c2", "#8f8f8f", "#c6c6c6")
_LIFT = "#7a4a1e"
_LINES = ("#b3007d", "#1468b3", "#2a7f3f", "#d55e00", "#222222")
#: Width of the picture in inches, and limits of its height.
_WIDTH = 9.0
_LOW = 2.6
_HIGH = 8.0


def sketch(section: Section, file: str | Path | None = None, show: bool = False) -> Figure:
    """Draw the areas, lifts, lines and holes of a section with their names.

    Parameters
    ----------
    section
        A :class:`~skfem_contact.section.Section`.
    file
        Name of a picture to write.
    show
        Open a window.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> import skfem_contact.plot as plot
    >>> ground = {"clay": sc.section.rectangle((0., 20.), (-8., 0.))}
    >>> plot.sketch(sc.section.Section(ground, size=1., lines={"wall": [(8., 0.), (8., -5.)]}))
    <Figure size ...>
    """
    # Fit the figure to the points of all outlines.
    points: list[ndarray] = []
    for outlines in section.outlines.values():
        points += map(_corners, outlines)
    x = np.vstack(points)
    low = x.min(axis=0)
    high = x.max(axis=0)
    width, depth = high - low
    height = float(np.clip((_WIDTH - 2.0) * depth / width + 1.0, _LOW, _HIGH))
    figure, axes = plt.subplots(figsize=(_WIDTH, height), layout="constrained")

    # Fill the areas, holes and lifts in this order, and draw the lines.
    for k, name in enumerate(section.areas):
        color = _AREAS[k % len(_AREAS)]
        _fill(
            axes,
            section,
            name,
            label=name,
            facecolor=color,
            edgecolor="#333333",
            linewidth=0.8,
        )
    for name in section.holes:
        _fill(axes, section, name, facecolor="white", edgecolor="#333333", linewidth=1.2)
        _write(axes, section, name, "#333333")
    for name in section.lifts:
        dashed = {"edgecolor": _LIFT, "linewidth": 1.2, "linestyle": "--"}
        _fill(axes, section, name, facecolor="none", **dashed)
        _write(axes, section, name, _LIFT)
    for k, name in enumerate(section.lines):
        label: str | None = name
        for outline in section.outlines[name]:
            color = _LINES[k % len(_LINES)]
            axes.plot(*_corners(outline).T, color=color, linewidth=2.5, label=label)
            label = None  # in the legend once

    # Leave a margin, and write the titles and the legend.
    free = 0.02 * (high - low).max()
    axes.set(
        xlim=(low[0] - free, high[0] + free),
        ylim=(low[1] - free, high[1] + free),
        aspect="equal",
        xlabel=labelled("r" if section.coordinates == "axisymmetric" else "x", "length"),
        ylabel=labelled("y", "length"),
    )
    figure.legend(loc="outside right upper", frameon=False)
    saved(figure, file)
    if show:
        plt.show()
    return figure


def _fill(axes: Any, section: Any, name: str, **style: Any) -> None:
    """Fill outlines below the surface."""
    patch = PathPatch(_path(section.outlines[name]), **style)
    axes.add_patch(patch)
    if section.plan.below:
        patch.set_clip_path(_path([section.plan.below]), axes.transData)


def _write(axes: Any, section: Any, name: str, color: str) -> None:
    """Write a name into the first of its outlines."""
    x, y = section.outlines[name][0].points.mean(axis=0)
    axes.text(
        x,
        y,
        name,
        color=color,
        ha="center",
        va="center",
        fontsize=8,
    )


def _path(outlines: Any) -> Outlines:
    """Return outlines as matplotlib's path."""
    return Outlines.make_compound_path(
        *(Outlines(_corners(outline), closed=outline.closed) for outline in outlines)
    )


def _corners(outline: Outline) -> ndarray:
    """Return the corners of an outline whose arcs are chords."""
    a, b, _ = outline.chords()
    return np.vstack((a, b[-1:]))
