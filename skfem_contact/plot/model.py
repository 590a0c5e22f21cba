"""Picture of a model by matplotlib: materials, beams, bars, contact and the water table of a
stage.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy import ndarray

from ..checks import check_plane
from ..forms.base import solids_of
from ..results.fields import basis_of, solids
from ..results.stage import StageResult
from ..results.tractions import interfaces
from .diagram import saved
from .marks import WATER, pressures_of, water_tables
from .scene import Scene
from .sheet import Window

#: Colours of materials: sand, clay, silt, rock, fill, concrete, and lighter ones of these.
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
_BEAM, _BAR, _CONTACT = "#22313f", "#c0392b", "#7b3294"
_WIDTH, _LEGEND, _FREE = 6.0, 0.26, 0.02  # inches, inches a row of the legend, share of the size


class Shade(NamedTuple):
    """Material in pictures and tables: names of its regions, itself, and its colour."""

    names: tuple[str, ...]
    material: Any
    color: str


def shades(stages: Iterable[StageResult]) -> dict[str, Shade]:
    """Return all materials of some stages by their text; equal ones have one colour."""
    found: dict[str, tuple[dict[str, None], Any]] = {}
    for stage in stages:
        for name, form in solids_of(stage.forms).items():
            for region in getattr(form, "regions", ()):
                names, _ = found.setdefault(repr(region.material), ({}, region.material))
                names[name if region.name == "all" else region.name] = None
    return {
        key: Shade(tuple(names), material, _MATERIALS[k % len(_MATERIALS)])
        for k, (key, (names, material)) in enumerate(found.items())
    }


def model(
    stage: StageResult, *, window: Window | None = None, file: str | Path | None = None
) -> Figure:
    """Draw the active parts of a stage: bodies by their materials, beams, bars, contact, and the
    water table.

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
    figure, ax = plt.subplots(figsize=(_WIDTH, _WIDTH), layout="constrained")
    if any(form.materials for form in solids_of(stage.forms).values()):
        check_plane(basis_of(stage), "plot.model")
        handles += _bodies(ax, stage, colors)
    handles += _lines(ax, stage)
    ax.autoscale_view()
    ax.set(aspect="equal", **({} if window is None else {"xlim": window[:2], "ylim": window[2:]}))
    ax.margins(_FREE)
    ax.tick_params(labelsize=9, color="#999999", labelcolor="#555555")
    ax.spines[:].set_visible(False)
    (left, right), (low, high) = ax.get_xlim(), ax.get_ylim()
    rows = -(-len(handles) // 3)
    figure.set_size_inches(
        _WIDTH, min(max((high - low) / (right - left), 0.25), 1.4) * _WIDTH + 0.3 + _LEGEND * rows
    )
    if handles:
        figure.legend(handles=handles, loc="outside lower left", ncols=3, frameon=False, fontsize=9)
    return figure


def _bodies(ax: Axes, stage: StageResult, colors: Mapping[str, Shade]) -> list[Any]:
    """Draw the elements in the colours of their materials, with outlines; return the legend."""
    scene, there = Scene(stage), solids(stage)
    keys = [repr(region.material) for form in there.values() for region in form.regions]
    corners = scene.coordinates[scene.nodes[scene.cells[:, : scene.corners]]]
    face = [colors[keys[k]].color for k in scene.region]
    ax.add_collection(
        PolyCollection(list(corners), facecolors=face, edgecolors="#00000022", linewidths=0.3)
    )
    for sides, width in ((scene.sides.borders, 0.6), (scene.sides.outline, 1.0)):
        ax.add_collection(
            LineCollection(
                list(scene.coordinates[sides[:, [0, -1]]]), colors="#555555", linewidths=width
            )
        )
    water = pressures_of(stage.water)
    lines = [line for one in water for line in water_tables(scene, one)]
    for line in lines:
        ax.plot(*line.T, color=WATER, linewidth=1.6, linestyle="--")
    used = [colors[key] for key in dict.fromkeys(keys)]
    names = [", ".join(shade.names[:3]) + (", …" if len(shade.names) > 3 else "") for shade in used]
    return [
        *(
            Patch(
                facecolor=shade.color, edgecolor="#555555", label=f"{name}: {shade.material.label}"
            )
            for shade, name in zip(used, names)
        ),
        *([Line2D([], [], color=WATER, linestyle="--", label="water table")] if lines else []),
    ]


def _lines(ax: Axes, stage: StageResult) -> list[Line2D]:
    """Draw beams, bars and contact; return the legend."""
    found: list[tuple[str, str, float, list[ndarray]]] = []
    for name, state in stage.states.items():
        form = stage.forms[name]
        if (along := form.line_points(stage.x, state)) is not None:
            found.append(
                (name, _BEAM, 2.4, list(along[0].reshape(-1, 3, along[0].shape[1])[:, :2, :2]))
            )
        elif "end x" in (bars := form.members(state)):
            ends = np.column_stack([bars[key] for key in ("x", "y", "end x", "end y")])
            found.append((name, _BAR, 1.6, list(ends.reshape(-1, 2, 2))))
    if any(form.materials for form in solids_of(stage.forms).values()):
        points = solids(stage)[next(iter(solids(stage)))].basis.doflocs[:, ::2].T
        facets = [points[pair.facets[:, :2]] for pair in interfaces(stage).values()]
        if facets:
            found.append(("contact", _CONTACT, 1.2, list(np.concatenate(facets))))
    for _, color, width, segments in found:
        ax.add_collection(
            LineCollection(segments, colors=color, linewidths=width, capstyle="round", zorder=3)
        )
    return [
        Line2D([], [], color=color, linewidth=width, label=name) for name, color, width, _ in found
    ]
