"""Diagrams drawn on the structure that they belong to."""
from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from numpy import ndarray

from ..errors import check_plane, look_up
from ..results.fields import basis_of
from ..results.result import StageResult
from ..results.sections import SectionForces
from ..results.tractions import Tractions
from .diagrams import saved
from .scene import Scene
from .units import labelled

_TITLES = {"N": ("normal force N", "line"), "V": ("shear force V", "line"), "M": ("moment M", "moment"),
           "pressure": ("contact pressure", "stress"), "shear": ("friction", "stress")}
_POSITIVE, _NEGATIVE = "#cf4b41", "#3b78b4"
#: Longest ordinate as a share of the size of what the diagram is drawn on.
_LONGEST = 0.28


def diagram_on(forms: Mapping[str, Any], step: StageResult, quantity: str, values: SectionForces | Tractions, *,
               scale: float | None = None, window: tuple[float, float, float, float] | None = None,
               file: str | Path | None = None) -> Figure:
    """Section forces or contact pressures as ordinates on the structure, with their extremes.

    Moments stand on the side of the fibres in tension, as engineers of structures draw them.

    Parameters
    ----------
    forms, step
        Forms by name, and a stage of their result: the bodies in the background.
    quantity
        ``"N"``, ``"V"`` or ``"M"`` of section forces; ``"pressure"`` or ``"shear"`` of tractions.
    values
        ``stage.section_forces(...)`` or ``stage.tractions(...)``.
    scale
        Length of the ordinates per unit; by default the largest is 28 % of the structure's size.
    window
        Part to show, ``(xmin, xmax, ymin, ymax)``; by default the surroundings of the structure.
    file
        Name of a picture to write.

    Examples
    --------
    >>> from skfem_contact.demo import culvert
    >>> import skfem_contact as sc
    >>> import skfem_contact.plot as plot
    >>> model = culvert()
    >>> stage = model.result["surcharge"]
    >>> cuts = sc.Sections.ring((0., 0.), .72, .90)
    >>> moment = stage.section_forces("culvert", cuts)
    >>> figure = plot.diagram_on(model.forms, stage, "M", moment)
    """
    check_plane(basis_of(step), "plot.diagram_on")
    names = ("N", "V", "M") if isinstance(values, SectionForces) else ("pressure", "shear")
    title, unit = look_up(quantity, {name: _TITLES[name] for name in names}, f"quantity of {type(values).__name__}")
    axis, ordinate = np.column_stack((values.x, values.y)), getattr(values, quantity)
    order = np.argsort(values.position if isinstance(values, SectionForces) else values.arc)
    axis, ordinate = axis[order], ordinate[order]
    closed = bool(len(axis) > 3 and np.linalg.norm(axis[0] - axis[-1])
                  < 2.5 * np.median(np.linalg.norm(np.diff(axis, axis=0), axis=1)))
    left = _left(axis, closed) * (1.0 if isinstance(values, SectionForces) else -1.0)  # tractions: into the slave
    size, largest = float(np.ptp(axis, axis=0).max()), float(np.abs(ordinate).max())
    length = scale if scale is not None else _LONGEST * size / (largest or 1.0)
    tips = axis + length * ordinate[:, None] * left
    figure, ax = plt.subplots(figsize=(7.5, 6.5), layout="constrained")
    _bodies(ax, Scene(forms, step, 0.0))
    _ordinates(ax, axis, tips, ordinate, closed)
    _extremes(ax, tips, ordinate, left)
    if window is None:
        low, high = np.minimum(axis.min(axis=0), tips.min(axis=0)), np.maximum(axis.max(axis=0), tips.max(axis=0))
        free = 0.12 * size
        window = (low[0] - free, high[0] + free, low[1] - free, high[1] + free)
    ax.set(xlim=window[:2], ylim=window[2:], aspect="equal")
    ax.set_title(f"{labelled(title, unit)}, {step.name}", loc="left", fontsize=12)
    ax.axis("off")
    return saved(figure, file)


def _left(axis: ndarray, closed: bool) -> ndarray:
    """Unit normals to the left of a line, (n, 2)."""
    along = np.roll(axis, -1, axis=0) - np.roll(axis, 1, axis=0) if closed else np.gradient(axis, axis=0)
    along = along / np.linalg.norm(along, axis=1)[:, None]
    return np.column_stack((-along[:, 1], along[:, 0]))


def _bodies(ax: Axes, scene: Scene) -> None:
    """The bodies in light grey with their outlines and the borders of regions."""
    corners = scene.places[scene.nodes[scene.cells[:, :scene.corners]]]
    ax.add_collection(PolyCollection(list(corners), facecolor="#ece9e2", edgecolor="#ece9e2", linewidth=0.3))
    for sides, width in ((scene.borders, 0.8), (scene.outline, 1.2)):
        ax.add_collection(LineCollection(list(scene.places[sides[:, [0, -1]]]), colors="#555555", linewidths=width))


def _ordinates(ax: Axes, axis: ndarray, tips: ndarray, ordinate: ndarray, closed: bool) -> None:
    """Filled pieces between neighbours, coloured by their sign, and the line through the tips."""
    n = len(axis)
    first = np.arange(n if closed else n - 1)
    second = (first + 1) % n
    pieces = np.stack((axis[first], axis[second], tips[second], tips[first]), axis=1)
    positive = ordinate[first] + ordinate[second] > 0.0
    for sign, color in ((positive, _POSITIVE), (~positive, _NEGATIVE)):
        style: dict[str, Any] = {"facecolor": color, "edgecolor": color, "alpha": 0.45, "linewidth": 0.4}
        ax.add_collection(PolyCollection(list(pieces[sign]), **style))
    line = np.concatenate((tips, tips[:1])) if closed else tips
    ax.plot(*line.T, color="#222222", linewidth=1.4)
    axis = np.concatenate((axis, axis[:1])) if closed else axis
    ax.plot(*axis.T, color="#222222", linewidth=0.8)


def _extremes(ax: Axes, tips: ndarray, ordinate: ndarray, left: ndarray) -> None:
    """The largest and the smallest value beside their ordinates."""
    for at in dict.fromkeys((int(np.argmax(ordinate)), int(np.argmin(ordinate)))):
        out = left[at] * (1.0 if ordinate[at] >= 0.0 else -1.0)
        ax.annotate(f"{ordinate[at]:.4g}".replace("-", "−"), tips[at], xytext=9.0 * out, textcoords="offset points",
                    ha="left" if out[0] > 0.3 else "right" if out[0] < -0.3 else "center",
                    va="bottom" if out[1] > 0.3 else "top" if out[1] < -0.3 else "center", fontsize=11,
                    bbox={"facecolor": "white", "alpha": 0.75, "edgecolor": "none", "pad": 1.0})
