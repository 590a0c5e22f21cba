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
from .units import labelled

#: Colours of areas in their order, of lifts and of lines.
_AREAS = ("#e8d8a8", "#c9b184", "#a8b89a", "#d9c3b0", "#b8a6a0", "#9fb3c2", "#8f8f8f", "#c6c6c6")
_LIFT, _LINES = "#7a4a1e", ("#b3007d", "#1468b3", "#2a7f3f", "#d55e00", "#222222")
#: Width of the picture in inches, and limits of its height.
_WIDTH, _LOW, _HIGH = 9.0, 2.6, 8.0


def sketch(section: Any, file: str | Path | None = None, show: bool = False) -> Figure:
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
    x = np.vstack(
        [
            points
            for outlines in section.outlines.values()
            for o in outlines
            for points in o.chords()[:2]
        ]
    )
    low, high = x.min(axis=0), x.max(axis=0)
    height = float(np.clip((_WIDTH - 2.0) * (high - low)[1] / (high - low)[0] + 1.0, _LOW, _HIGH))
    figure, axes = plt.subplots(figsize=(_WIDTH, height), layout="constrained")
    below = section.plan.below and _path([section.plan.below])
    for k, name in enumerate(section.areas):
        _fill(
            axes,
            section,
            name,
            below,
            label=name,
            facecolor=_AREAS[k % len(_AREAS)],
            edgecolor="#333333",
            linewidth=0.8,
        )
    for name in section.holes:
        _fill(axes, section, name, below, facecolor="white", edgecolor="#333333", linewidth=1.2)
        _write(axes, section, name, "#333333")
    for name in section.lifts:
        _fill(
            axes,
            section,
            name,
            below,
            facecolor="none",
            edgecolor=_LIFT,
            linewidth=1.2,
            linestyle="--",
        )
        _write(axes, section, name, _LIFT)
    for k, name in enumerate(section.lines):
        for label, outline in zip(
            (name, *[None] * len(section.outlines[name])), section.outlines[name]
        ):
            axes.plot(
                *_corners(outline).T, color=_LINES[k % len(_LINES)], linewidth=2.5, label=label
            )
    free = 0.02 * (high - low).max()
    axes.set(
        xlim=(low[0] - free, high[0] + free),
        ylim=(low[1] - free, high[1] + free),
        aspect="equal",
        xlabel=labelled("r" if section.coordinates == "axisymmetric" else "x", "length"),
        ylabel=labelled("y", "length"),
    )
    figure.legend(loc="outside right upper", frameon=False)
    if file is not None:
        figure.savefig(file, dpi=160)
    if show:
        plt.show()
    return figure


def _fill(axes: Any, section: Any, name: str, below: Outlines | None, **style: Any) -> None:
    """Fill outlines, without what lies above the surface."""
    patch = PathPatch(_path(section.outlines[name]), **style)
    axes.add_patch(patch)
    if below is not None:
        patch.set_clip_path(below, axes.transData)


def _write(axes: Any, section: Any, name: str, color: str) -> None:
    """Write a name into the first of its outlines."""
    x, y = section.outlines[name][0].points.mean(axis=0)
    axes.text(x, y, name, color=color, ha="center", va="center", fontsize=8)


def _path(outlines: Any) -> Outlines:
    """Return outlines as matplotlib's path."""
    return Outlines.make_compound_path(
        *(Outlines(_corners(outline), closed=outline.closed) for outline in outlines)
    )


def _corners(outline: Outline) -> ndarray:
    """Return the corners of an outline whose arcs are chords."""
    a, b, _ = outline.chords()
    return np.vstack((a, b[-1:]))
