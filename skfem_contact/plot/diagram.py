"""Diagrams by matplotlib: of tractions and section forces, and over stages."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy import ndarray
from numpy.typing import ArrayLike

from ..checks import check_plane, format_point, look_up
from ..contact.laws import Status
from ..errors import warn
from ..layout import nodes as nodes_of
from ..results.cuts import SectionForces
from ..results.fields import Shown, basis_of, has_excess, nodal_field, quantities, solids
from ..results.result import Result
from ..results.stage import StageResult
from ..results.tractions import Tractions
from .scene import Scene
from .sheet import Window
from .units import labelled

_COLORS = ("#d55e00", "#1f4e8c", "#2a7f3f", "#7b3294", "#444444")
_POSITIVE, _NEGATIVE = "#cf4b41", "#3b78b4"
#: Titles of the quantities, and kinds of their units, of tractions and of section forces.
_TRACTIONS = {"pressure": ("contact pressure", "stress"), "shear": ("friction", "stress")}
_FORCES = {
    "N": ("normal force N", "line"),
    "V": ("shear force V", "line"),
    "M": ("moment M", "moment"),
    "N_hoop": ("hoop force", "line"),
    "M_hoop": ("hoop moment", "moment"),
}
#: Longest ordinate as a share of the size of what the diagram is drawn on.
_LONGEST = 0.28
#: Nodes are the same point below this share of their elements' size; gaps of meshes that touch are
#: smaller.
_SAME = 1e-3
#: Share of a curve by which values of bodies that touch may differ: the width of a line.
_DIFFERENT = 0.02


def diagram(
    values: Any,
    quantity: str | None = None,
    *,
    on: StageResult | None = None,
    angle: ArrayLike | None = None,
    along: Literal["arc", "x", "y"] = "arc",
    upright: bool | None = None,
    scale: float | None = None,
    window: Window | None = None,
    file: str | Path | None = None,
) -> Figure:
    """Draw tractions or section forces along a body, around a ring, or as ordinates on the
    structure itself.

    Along an axis and around a ring, the first of several series is dashed; contact points that slip
    are marked by open circles. On a structure the extremes are written, and moments are drawn on
    the side of the fibres in tension.

    Parameters
    ----------
    values
        :class:`~skfem_contact.results.Tractions`, :class:`~skfem_contact.results.SectionForces`, or
        several of one kind by their labels; on a structure those of its members. Around a ring also
        arrays (n,) by their labels.
    quantity
        ``"pressure"`` or ``"shear"`` of tractions; ``"N"``, ``"V"``, ``"M"``, ``"N_hoop"`` or
        ``"M_hoop"`` of section forces; by default all of them. Of arrays, the label of the axis.
        Needed around a ring and on a structure.
    on
        Stage whose bodies are drawn in the background, with the values on them.
    angle : ndarray, (n,)
        Central angles of the values in degrees, from the crown clockwise: a polar diagram and a
        plain one are drawn.
    along
        Coordinate: position along the interface or body, or x or y.
    upright
        Draw the coordinate upright, for walls and piles, positions along a body downwards; by
        default y only.
    scale
        Length of the ordinates on a structure per unit; by default the largest is 28 % of the
        structure's size.
    window
        Part of the structure to show, ``(xmin, xmax, ymin, ymax)``; by default the surroundings of
        the values.
    file
        Name of a picture to write.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> from skfem_contact.demo import culvert
    >>> import skfem_contact.plot as plot
    >>> result = culvert().result
    >>> cuts = sc.Sections.ring((0., 0.), .72, .90)
    >>> forces = {stage.name: stage.section_forces("culvert", cuts) for stage in result}
    >>> along = plot.diagram({stage.name: stage.tractions("skin") for stage in result}, along="x")
    >>> around = plot.diagram(forces, "M", angle=cuts.position)
    >>> on_it = plot.diagram(forces["surcharge"], "M", on=result["surcharge"])
    """
    if on is not None:
        return saved(_on_structure(values, quantity, on, scale, window), file)
    series = values if isinstance(values, Mapping) else {"": values}
    if len({type(part) for part in series.values()}) != 1:
        raise ValueError(
            "a diagram has one or several series of one kind, not "
            f"{[type(part).__name__ for part in series.values()]}"
        )
    if angle is not None:
        return saved(_ring(series, quantity, np.asarray(angle, float) % 360.0), file)
    return saved(
        _along(series, quantity, along, (along == "y") if upright is None else upright), file
    )


def history(
    result: Result,
    quantity: str,
    points: Mapping[str, ArrayLike],
    *,
    time: bool = False,
    water: Shown | None = None,
    file: str | Path | None = None,
) -> Figure:
    """Draw a field at some points through all stages.

    Parameters
    ----------
    result
        Result of an analysis.
    quantity
        Field of :meth:`~skfem_contact.results.StageResult.field`.
    points
        Coordinates (x, y) by their labels; the nearest nodes are taken. They have no value in
        stages without a body there. Where bodies touch, the value is that of one of them; a warning
        states how much they differ.
    time
        Draw over the times at which the stages end, which have durations, instead of their names.
    water
        Pore pressure besides the excess, as in :meth:`~skfem_contact.results.StageResult.field`:
        True, of each stage.
    file
        Name of a picture to write.

    Examples
    --------
    >>> from skfem_contact.demo import culvert
    >>> import skfem_contact.plot as plot
    >>> figure = plot.history(culvert().result, "uy", {"crown": (0., .9), "surface": (.9, 3.5)})
    """
    basis, field = basis_of(result[-1]), look_up(quantity, quantities(result[-1], water), "field")
    coordinates = basis.doflocs[:, :: basis.mesh.dim()].T
    nodes = np.vstack([nodes_of(form.basis) for stage in result for form in solids(stage).values()])
    later = (
        quantity == "pore" and water is None and has_excess(result[-1])
    )  # none before the first water
    values = np.array(
        [
            np.zeros(basis.N // basis.mesh.dim())
            if later and not has_excess(stage)
            else nodal_field(stage, quantity, water=water)
            for stage in result
        ]
    )
    times = [stage.time for stage in result] if time else list(range(len(result)))
    figure, ax = plt.subplots(figsize=(8.0, 4.2), layout="constrained")
    for style, (label, point) in zip(styles(len(points)), points.items()):
        ax.plot(
            times,
            _at_point(coordinates, nodes, values, point, label),
            label=label,
            **{**style, "linestyle": "-", "marker": "o", "markersize": 5},
        )
    if time:
        ax.set_xlabel("time")
    else:
        ax.set_xticks(times, [stage.name for stage in result])
    ax.set_ylabel(labelled(field.title, field.unit))
    tidy(ax, len(points))
    return saved(figure, file)


def _at_point(
    coordinates: ndarray, nodes: ndarray, values: ndarray, point: ArrayLike, label: str
) -> ndarray:
    """Return values, (stages, nodes), at the node nearest to a point; warn where those of other
    bodies differ.
    """
    at = np.asarray(point, float)
    if at.shape != coordinates.shape[1:]:
        raise ValueError(
            f"point '{label}' has {coordinates.shape[1]} coordinates in these bodies, not {point!r}"
        )
    distance = np.linalg.norm(coordinates - at, axis=1)
    node = int(distance.argmin())
    there = coordinates[nodes[(nodes == node).any(axis=1)]]
    if distance[node] > (
        reach := float(np.linalg.norm(np.ptp(there, axis=1), axis=1).max(initial=0.0))
    ):
        raise ValueError(
            f"point '{label}' lies outside the bodies: the nearest node, at "
            f"{format_point(coordinates[node])}, is {distance[node]:.4g} away"
        )
    same = values[:, np.linalg.norm(coordinates - coordinates[node], axis=1) < _SAME * reach]
    apart = np.ptp(np.nan_to_num(same), axis=1).max()
    if apart > _DIFFERENT * np.nanmax(np.abs(np.append(same, 0.0))):
        warn(
            f"at point '{label}' bodies touch whose values differ by up to {apart:.3g}: the value "
            f"of one of them is "
            "drawn; give the coordinates of a node within the body that is meant"
        )
    return values[:, node]


def _titles(values: Any) -> dict[str, tuple[str, str]]:
    """Return titles and kinds of units of the quantities of tractions or section forces."""
    if isinstance(values, Tractions):
        return _TRACTIONS
    if isinstance(values, SectionForces) and values.M.ndim == 1:
        return {name: _FORCES[name] for name in values.names}
    raise ValueError(
        f"a diagram is drawn of Tractions or of SectionForces in a plane, not of "
        f"{type(values).__name__}; "
        "of section forces in space take forces.towards(direction), of arrays give angle="
    )


def _axis_of(values: Any, along: str = "arc") -> ndarray:
    """Return the coordinate of tractions or section forces, (n,)."""
    return np.asarray(
        getattr(
            values, "position" if along == "arc" and isinstance(values, SectionForces) else along
        )
    )


def _along(series: Mapping[str, Any], quantity: str | None, along: str, upright: bool) -> Figure:
    """Draw panels side by side over an upright coordinate, or below each other; its name is written
    once.
    """
    first = next(iter(series.values()))
    titles = _titles(first)
    names = list(titles) if quantity is None else [quantity]
    labels = [
        labelled(*look_up(name, titles, f"quantity of {type(first).__name__}")) for name in names
    ]
    n = len(names)
    size = (6.0 + n, 6.0) if upright else (8.0, 3.0 + 1.5 * n)
    figure, grid = plt.subplots(
        *((1, n) if upright else (n, 1)),
        figsize=size,
        sharex=not upright,
        sharey=upright,
        squeeze=False,
        layout="constrained",
    )
    axes = grid.ravel()
    for style, (label, part) in zip(styles(len(series)), series.items()):
        position, slips = _axis_of(part, along), getattr(part, "status", np.zeros(0)) == Status.SLIP
        for ax, name in zip(axes, names):
            pairs = np.stack((position, getattr(part, name)))[:: -1 if upright else 1]
            ax.plot(*pairs, label=label, **style)
            if slips.any():
                ax.plot(
                    *pairs[:, slips],
                    color=style["color"],
                    linestyle="none",
                    marker="o",
                    markersize=4,
                    markerfacecolor="white",
                )
    kind = (
        along
        if along != "arc"
        else "position along the slave"
        if isinstance(first, Tractions)
        else "position"
    )
    for ax, title in zip(axes, labels):
        tidy(ax, 1)
        ax.set(**{"xlabel" if upright else "ylabel": title})
    axes[0 if upright else -1].set(**{"ylabel" if upright else "xlabel": labelled(kind, "length")})
    tidy(axes[0], len(series))
    if upright and along == "arc":
        axes[0].invert_yaxis()
    return figure


def _ring(series: Mapping[str, Any], quantity: str | None, angle: ndarray) -> Figure:
    """Draw a polar diagram, and one against the central angle."""
    if quantity is None:
        raise ValueError("a diagram around a ring needs a quantity, its second argument")
    order = np.argsort(angle)
    closed = np.concatenate((order, order[:1]))
    figure = plt.figure(figsize=(10.0, 4.2), layout="constrained")
    polar: Any = figure.add_subplot(1, 2, 1, projection="polar")
    plain = figure.add_subplot(1, 2, 2)
    polar.set_theta_zero_location("N")
    polar.set_theta_direction(-1)
    turns, title = np.concatenate((angle[order], angle[order[:1]] + 360.0)), quantity
    for style, (label, part) in zip(styles(len(series)), series.items()):
        if isinstance(part, Tractions | SectionForces):
            title = labelled(
                *look_up(quantity, _titles(part), f"quantity of {type(part).__name__}")
            )
            part = getattr(part, quantity)
        if np.shape(part) != angle.shape:
            raise ValueError(
                f"the values of '{label}', {np.shape(part)}, do not fit the angles, {angle.shape}"
            )
        around = np.asarray(part, float)[closed]
        polar.plot(np.radians(turns), around, **style)
        plain.plot(turns, around, label=label, **style)
    low, high = plain.get_ylim()
    polar.set_ylim(min(low, 0.0) - 0.35 * (max(high, 0.0) - min(low, 0.0)), max(high, 0.0))
    polar.plot(
        np.linspace(0.0, 2.0 * np.pi, 181), np.zeros(181), color="black", linewidth=0.8, zorder=3
    )
    polar.set_rlabel_position(22.5)
    polar.yaxis.set_major_locator(MaxNLocator(4))
    polar.tick_params(axis="y", labelsize=8)
    polar.set_axisbelow(False)  # the figures of the circles, above the curves
    for text in polar.get_yticklabels():
        text.set_bbox({"facecolor": "white", "alpha": 0.7, "edgecolor": "none", "pad": 0.8})
    plain.set(
        xlim=(0.0, 360.0),
        xticks=range(0, 361, 45),
        ylabel=title,
        xlabel="central angle from the crown, clockwise [°]",
    )
    tidy(plain, len(series))
    return figure


def _on_structure(
    values: Any,
    quantity: str | None,
    stage: StageResult,
    scale: float | None,
    window: Window | None,
) -> Figure:
    """Draw ordinates on the bodies of a stage or on several members of one scale, with their
    extremes.
    """
    bodies = any(form.basis is not None for form in stage.forms.values())  # none beside frames
    if bodies:
        check_plane(basis_of(stage), "plot.diagram")
    members = list(values.values()) if isinstance(values, Mapping) else [values]
    title, unit = look_up(
        quantity or "", _titles(members[0]), f"quantity of {type(members[0]).__name__}"
    )
    along = [_along_axis(part, quantity or "") for part in members]
    every = np.vstack([axis for axis, *_ in along])
    size, largest = (
        float(np.ptp(every, axis=0).max()),
        max(float(np.abs(ordinate).max()) for _, ordinate, *_ in along),
    )
    length = scale if scale is not None else _LONGEST * size / (largest or 1.0)
    figure, ax = plt.subplots(figsize=(7.5, 6.5), layout="constrained")
    if bodies:
        _draw_bodies(ax, Scene(stage))
    for axis, ordinate, left, closed in along:
        tips = axis + length * ordinate[:, None] * left
        every = np.vstack((every, tips))
        _draw_ordinates(ax, axis, tips, ordinate, closed)
        _write_extremes(ax, tips, ordinate, left)
    if window is None:
        (west, south), (east, north) = (
            every.min(axis=0) - 0.12 * size,
            every.max(axis=0) + 0.12 * size,
        )
        window = (west, east, south, north)
    ax.set(xlim=window[:2], ylim=window[2:], aspect="equal")
    ax.set_title(f"{labelled(title, unit)}, {stage.name}", loc="left", fontsize=12)
    ax.axis("off")
    return figure


def _along_axis(values: Any, quantity: str) -> tuple[ndarray, ndarray, ndarray, bool]:
    """Return points of an axis, (n, 2), ordinates, (n,), directions of positive ones, (n, 2), and
    if it is closed.

    At a node of a beam, which has values of both elements, directions are those of the elements.
    """
    _titles(values)
    order = np.argsort(_axis_of(values), kind="stable")
    axis, ordinate = np.column_stack((values.x, values.y))[order], getattr(values, quantity)[order]
    steps = np.linalg.norm(np.diff(axis, axis=0), axis=1)
    steps = steps[steps > 0.0]  # none between the two values at a node of a beam
    closed = bool(len(steps) > 2 and np.linalg.norm(axis[0] - axis[-1]) < 2.5 * np.median(steps))
    tangent = (
        np.roll(axis, -1, axis=0) - np.roll(axis, 1, axis=0)
        if closed
        else np.gradient(axis, axis=0)
    )
    tangent = tangent / np.linalg.norm(tangent, axis=1)[:, None]
    left = np.column_stack((-tangent[:, 1], tangent[:, 0]))
    return (
        axis,
        ordinate,
        left * (1.0 if isinstance(values, SectionForces) else -1.0),
        closed,
    )  # tractions: into slave


def _draw_bodies(ax: Axes, scene: Scene) -> None:
    """Draw the bodies in light grey with their outlines and the borders of regions."""
    corners = scene.coordinates[scene.nodes[scene.cells[:, : scene.corners]]]
    ax.add_collection(
        PolyCollection(list(corners), facecolor="#ece9e2", edgecolor="#ece9e2", linewidth=0.3)
    )
    for sides, width in ((scene.sides.borders, 0.8), (scene.sides.outline, 1.2)):
        ends = list(scene.coordinates[sides[:, [0, -1]]])
        ax.add_collection(LineCollection(ends, colors="#555555", linewidths=width))


def _draw_ordinates(
    ax: Axes, axis: ndarray, tips: ndarray, ordinate: ndarray, closed: bool
) -> None:
    """Draw filled pieces between neighbours, coloured by their sign, and the line through the
    tips.
    """
    ring = np.arange(len(axis) + closed) % len(axis)
    first, second = ring[:-1], ring[1:]
    pieces = np.stack((axis[first], axis[second], tips[second], tips[first]), axis=1)
    positive = ordinate[first] + ordinate[second] > 0.0
    for sign, color in ((positive, _POSITIVE), (~positive, _NEGATIVE)):
        style: dict[str, Any] = {
            "facecolor": color,
            "edgecolor": color,
            "alpha": 0.45,
            "linewidth": 0.4,
        }
        ax.add_collection(PolyCollection(list(pieces[sign]), **style))
    ax.plot(*tips[ring].T, color="#222222", linewidth=1.4)
    ax.plot(*axis[ring].T, color="#222222", linewidth=0.8)


def _write_extremes(ax: Axes, tips: ndarray, ordinate: ndarray, left: ndarray) -> None:
    """Write the largest and the smallest value beside their ordinates."""
    for at in dict.fromkeys((int(np.argmax(ordinate)), int(np.argmin(ordinate)))):
        out = left[at] * (1.0 if ordinate[at] >= 0.0 else -1.0)
        ax.annotate(
            f"{ordinate[at]:.4g}".replace("-", "−"),
            tips[at],
            xytext=9.0 * out,
            textcoords="offset points",
            ha="left" if out[0] > 0.3 else "right" if out[0] < -0.3 else "center",
            va="bottom" if out[1] > 0.3 else "top" if out[1] < -0.3 else "center",
            fontsize=11,
            bbox={"facecolor": "white", "alpha": 0.75, "edgecolor": "none", "pad": 1.0},
        )


def styles(n: int) -> list[dict[str, Any]]:
    """Return line styles of n series; the first of several is dashed."""
    colors = _COLORS[1:2] if n == 1 else _COLORS
    return [
        {
            "color": colors[i % len(colors)],
            "linestyle": "--" if n > 1 and i == 0 else "-",
            "linewidth": 1.8,
        }
        for i in range(n)
    ]


def tidy(ax: Axes, n: int) -> None:
    """Draw a grid, and a legend where there are several series."""
    ax.grid(color="#dddddd", linewidth=0.6)
    ax.spines[["top", "right"]].set_visible(False)
    if n > 1:
        ax.legend(frameon=False)


def saved(figure: Figure, file: str | Path | None) -> Figure:
    """Write the figure to a file if one is given, and return it."""
    if file is not None:
        figure.savefig(file, dpi=160)
    return figure
