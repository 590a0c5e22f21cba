"""Picture of a model by matplotlib: materials, beams, bars, contact and the water table."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from itertools import chain
from pathlib import Path
from typing import Any, NamedTuple

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy import ndarray

from ..checks import check_plane
from ..forms.base import solids_of
from ..results.fields import basis_of, has_solids, solids
from ..results.stage import StageResult
from ..results.tractions import interfaces
from .diagram import draw_sides, fill_elements, saved
from .marks import WATER, pressures_of, water_tables
from .scene import Scene
from .sheet import Window
from .structures import BEAM, structures

#: Colours of materials: sand, clay, silt, rock, fill, concrete, and lighter ones.
_MATERIALS = (
    "#e3cd9b",
    "#b9a38a",
    "#c5cfa8",
    "#a7b3bd",
    "#d9b596",
    "#c9c9c9",
    "#efe2c0",
    "#d3c3b0",
    "#dfe6cf",
    "#ccd5db",
)
_CONTACT = "#7b3294"
_WIDTH = 6.0  # inches
_LEGEND = 0.26  # inches a row of the legend
_SIDE, _TICKS = 0.6, 0.4  # inches beside the axes and above and below them
_FREE = 0.02  # share of the size that is left free


class Shade(NamedTuple):
    """Material in pictures and tables: names of its regions, itself, and its colour."""

    names: tuple[str, ...]
    material: Any
    color: str


def shades(stages: Iterable[StageResult]) -> dict[str, Shade]:
    """Return all materials of some stages by their text; equal ones have one colour."""
    materials: dict[str, Any] = {}
    names: dict[str, dict[str, None]] = {}
    for stage in stages:
        for name, form in solids_of(stage.forms).items():
            for region in getattr(form, "regions", ()):
                key = repr(region.material)
                materials.setdefault(key, region.material)
                label = region.name
                if region.name == "all":
                    label = name
                names.setdefault(key, {})[label] = None
    found = {}
    for k, (key, material) in enumerate(materials.items()):
        found[key] = Shade(tuple(names[key]), material, _MATERIALS[k % len(_MATERIALS)])
    return found


def model(
    stage: StageResult, *, window: Window | None = None, file: str | Path | None = None
) -> Figure:
    """Draw the active parts of a stage: bodies by their materials, beams, contact and water table.

    Parameters
    ----------
    stage
        Stage of a plane model, with or without solids.
    window
        Part to show, ``(xmin, xmax, ymin, ymax)``; by default everything.
    file
        Name of a picture to write.

    Raises
    ------
    ValueError
        Bodies in space.

    Examples
    --------
    >>> from skfem_contact.demo import culvert
    >>> import skfem_contact.plot as plot
    >>> figure = plot.model(culvert().result["gravity"])
    """
    return saved(drawn(stage, shades([stage]), window), file)


def drawn(stage: StageResult, colors: Mapping[str, Shade], window: Window | None = None) -> Figure:
    """Return the picture of a stage with given colours of materials."""
    handles: list[Any] = []
    figure, ax = plt.subplots(figsize=(_WIDTH, _WIDTH))
    if has_solids(stage):
        check_plane(basis_of(stage), "plot.model")
        handles += _bodies(ax, stage, colors)
    handles += _lines(ax, stage)

    # Show everything, or the window.
    ax.autoscale_view()
    ax.set_aspect("equal")
    if window is not None:
        ax.set(xlim=window[:2], ylim=window[2:])
    ax.margins(_FREE)
    ax.tick_params(labelsize=9, color="#999999", labelcolor="#555555")
    ax.spines[:].set_visible(False)

    # Fit the height of the figure to the bodies and to the rows of the legend, in inches.
    left, right = ax.get_xlim()
    low, high = ax.get_ylim()
    aspect = min(max((high - low) / (right - left), 0.25), 1.4)
    foot = 0.1 + _LEGEND * -(-len(handles) // 3)
    height = aspect * (_WIDTH - _SIDE) + _TICKS + foot
    figure.set_size_inches(_WIDTH, height)
    figure.subplots_adjust(
        left=(_SIDE - 0.1) / _WIDTH,
        right=1.0 - 0.1 / _WIDTH,
        bottom=(foot + _TICKS - 0.1) / height,
        top=1.0 - 0.1 / height,
    )
    if handles:
        figure.legend(handles=handles, loc="lower left", ncols=3, frameon=False, fontsize=9)
    return figure


def _bodies(ax: Axes, stage: StageResult, colors: Mapping[str, Shade]) -> list[Any]:
    """Draw the elements in the colours of their materials, with outlines; return the legend."""
    scene = Scene(stage)
    regions = list(chain.from_iterable(form.regions for form in solids(stage).values()))
    keys = [repr(region.material) for region in regions]
    fill_elements(ax, scene, [colors[keys[k]].color for k in scene.region], "#00000022")
    draw_sides(ax, scene, borders=0.6, outline=1.0)

    # Draw the water tables.
    has_water = False
    for water in pressures_of(stage.water):
        for line in water_tables(scene, water):
            ax.plot(*line.T, color=WATER, linewidth=1.6, linestyle="--")
            has_water = True

    # Make the legend.
    handles: list[Any] = []
    for key in dict.fromkeys(keys):
        shade = colors[key]
        names = ", ".join(shade.names[:3])
        if len(shade.names) > 3:
            names += ", …"
        label = f"{names}: {shade.material.label}"
        handles.append(Patch(facecolor=shade.color, edgecolor="#555555", label=label))
    if has_water:
        handles.append(Line2D([], [], color=WATER, linestyle="--", label="water table"))
    return handles


def _lines(ax: Axes, stage: StageResult) -> list[Line2D]:
    """Draw beams, bars and contact; return the legend."""
    # Collect the segments of each form, (n, points, 2), with colour and width.
    found: list[tuple[str, str, float, ndarray]] = []
    for line in structures(stage):
        width = 2.4 if line.color == BEAM else 1.6
        found.append((line.name, line.color, width, line.points[:, :, :2]))
    if has_solids(stage):
        points = basis_of(stage).doflocs[:, ::2].T
        facets = [points[pair.facets[:, :2]] for pair in interfaces(stage).values()]
        if facets:
            found.append(("contact", _CONTACT, 1.2, np.concatenate(facets)))

    # Draw them.
    handles = []
    for name, color, width, segments in found:
        style: dict[str, Any] = {"colors": color, "linewidths": width, "capstyle": "round"}
        ax.add_collection(LineCollection(list(segments), zorder=3, **style))
        handles.append(Line2D([], [], color=color, linewidth=width, label=name))
    return handles
