"""Diagrams by matplotlib: of tractions and section forces, and over stages."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal, NamedTuple

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy import ndarray
from numpy.typing import ArrayLike

from ..arrays import left_of, max_abs, row_norms
from ..checks import check_plane, format_point, look_up
from ..contact.laws import Status
from ..errors import warn
from ..forms.roles import Body, having
from ..layout import nodes as nodes_of
from ..results.cuts import SectionForces
from ..results.fields import Shown, basis_of, has_excess, nodal_field, quantities, solids
from ..results.result import Result
from ..results.stage import StageResult
from ..results.tractions import Tractions
from ..units import labelled
from .scene import Scene
from .sheet import PACKED, Window

_COLORS = ("#d55e00", "#1f4e8c", "#2a7f3f", "#7b3294", "#444444")
_POSITIVE = "#cf4b41"
_NEGATIVE = "#3b78b4"
#: Titles of the quantities of tractions, with kinds of their units, and of section forces.
_TRACTIONS = {"pressure": ("contact pressure", "stress"), "shear": ("friction", "stress")}
_FORCES = {
    "N": "normal force N",
    "V": "shear force V",
    "M": "moment M",
    "N_hoop": "hoop force",
    "M_hoop": "hoop moment",
}
#: Extremes below this share of the largest ordinate are not written.
_LEAST = 0.01
#: Longest ordinate as a share of the size of the structure.
_LONGEST = 0.28
#: Nodes are the same point below this share of their elements' size; gaps of meshes that touch are
#: smaller.
_SAME = 1e-3
#: Points of an axis that are the same node, as a share of its size; cosine of the least corner.
_ROUND_OFF = 1e-9
_SMOOTH = 0.7
#: Room around two panels of 10 by 4.2 inches: labels of nine letters have room. To search for it
#: takes as long as to draw them.
_BESIDE = {"left": 0.02, "right": 0.98, "bottom": 0.13, "top": 0.93, "wspace": 0.25}
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
    """Draw tractions or section forces along a body, around a ring, or on the structure.

    Along an axis and around a ring, the first of several series is dashed; contact points that slip
    are marked by open circles. On a structure the extremes are written, and moments are drawn on
    the side of the fibres in tension.

    Parameters
    ----------
    values
        :class:`~skfem_contact.results.Tractions`, :class:`~skfem_contact.results.SectionForces`, or
        several of one kind by their labels, on a structure by its members. Around a ring also
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
    >>> cuts = sc.Cuts.ring((0., 0.), .72, .90)
    >>> forces = {stage.name: stage.section_forces("culvert", cuts) for stage in result}
    >>> along = plot.diagram({stage.name: stage.tractions("skin") for stage in result}, along="x")
    >>> around = plot.diagram(forces, "M", angle=cuts.position)
    >>> on_it = plot.diagram(forces["surcharge"], "M", on=result["surcharge"])
    """
    if on is not None:
        return saved(_on_structure(values, quantity or "", on, scale, window), file)
    # One series has no label.
    if isinstance(values, Mapping):
        series = values
    else:
        series = {"": values}
    if len({type(part) for part in series.values()}) != 1:
        raise ValueError(
            "a diagram has one or several series of one kind, not "
            f"{[type(part).__name__ for part in series.values()]}"
        )
    if angle is not None:
        return saved(_ring(series, quantity, np.asarray(angle, float) % 360.0), file)
    if upright is None:
        upright = along == "y"
    return saved(_along(series, quantity, along, upright), file)


def stacked(n: int) -> tuple[Figure, list[Axes]]:
    """Return a figure with n panels below each other over one abscissa."""
    figure, panels = plt.subplots(
        n, 1, figsize=(8.0, 1.5 + 2.4 * n), sharex=True, squeeze=False, layout="constrained"
    )
    return figure, list(panels.ravel())


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
        stages without a body at the node. Where bodies touch, the value is one body's; a warning
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
    # Compute the field of all stages.
    last = result[-1]
    basis = basis_of(last)
    field = look_up(quantity, quantities(last, water), "field")
    values = _nodal_values(result, quantity, water)

    # Draw the values at the node nearest to each point.
    coordinates = basis.doflocs[:, :: basis.mesh.dim()].T
    elements = []
    for stage in result:
        elements += [nodes_of(form.basis) for form in solids(stage).values()]
    nodes = np.vstack(elements)
    if time:
        times = [stage.time for stage in result]
    else:
        times = list(range(len(result)))
    figure, ax = plt.subplots(figsize=(8.0, 4.2), layout="constrained")
    for style, (label, point) in zip(styles(len(points)), points.items()):
        at_point = _at_point(coordinates, nodes, values, point, label)
        style |= {"linestyle": "-", "marker": "o", "markersize": 5}
        ax.plot(times, at_point, label=label, **style)

    # Write the titles of the axes.
    if time:
        ax.set_xlabel("time")
    else:
        ax.set_xticks(times, [stage.name for stage in result])
    ax.set_ylabel(labelled(field.title, field.unit))
    tidy(ax, len(points))
    return saved(figure, file)


def _nodal_values(result: Result, quantity: str, water: Shown | None) -> ndarray:
    """Return a field at all nodes in all stages, (stages, nodes)."""
    starts_dry = quantity == "pore" and water is None and has_excess(result[-1])
    values = []
    for stage in result:
        if starts_dry and not has_excess(stage):  # before the first water
            basis = basis_of(stage)
            values.append(np.zeros(basis.N // basis.mesh.dim()))
        else:
            values.append(nodal_field(stage, quantity, water=water))
    return np.array(values)


def _at_point(
    coordinates: ndarray,
    nodes: ndarray,
    values: ndarray,
    point: ArrayLike,
    label: str,
) -> ndarray:
    """Return values, (stages, nodes), at the node nearest to a point; warn where bodies differ."""
    # Find the node, within the size of its elements.
    wanted = np.asarray(point, float)
    if wanted.shape != coordinates.shape[1:]:
        raise ValueError(
            f"point '{label}' has {coordinates.shape[1]} coordinates in these bodies, not {point!r}"
        )
    distance = row_norms(coordinates - wanted)
    node = int(distance.argmin())
    elements = coordinates[nodes[(nodes == node).any(axis=1)]]  # (elements, nodes, dim)
    lengths = row_norms(np.ptp(elements, axis=1))
    reach = float(lengths.max(initial=0.0))
    if distance[node] > reach:
        raise ValueError(
            f"point '{label}' lies outside the bodies: the nearest node, at "
            f"{format_point(coordinates[node])}, is {distance[node]:.4g} away"
        )

    # Compare the values of all bodies at the node.
    from_node = row_norms(coordinates - coordinates[node])
    same = values[:, from_node < _SAME * reach]
    apart = np.ptp(np.nan_to_num(same), axis=1).max()
    if apart > _DIFFERENT * np.nanmax(np.abs(np.append(same, 0.0))):
        warn(
            f"at point '{label}' bodies touch whose values differ by up to {apart:.3g}: the value "
            "of one of them is drawn; give the coordinates of a node within the body that is meant"
        )
    return values[:, node]


def _titles(values: Any) -> dict[str, tuple[str, str]]:
    """Return titles and kinds of units of the quantities of tractions or section forces."""
    if isinstance(values, Tractions):
        return _TRACTIONS
    if isinstance(values, SectionForces) and values.M.ndim == 1:
        return {name: (_FORCES[name], values.kind(name)) for name in values.names}
    raise ValueError(
        f"a diagram is drawn of Tractions or of SectionForces in a plane, not of "
        f"{type(values).__name__}; "
        "of section forces in space take forces.towards(direction), of arrays give angle="
    )


def _title(values: Any, quantity: str) -> str:
    """Return the title of a quantity with its unit."""
    found = look_up(quantity, _titles(values), f"quantity of {type(values).__name__}")
    return labelled(*found)


def _axis_of(values: Any, along: str = "arc") -> ndarray:
    """Return the coordinate of tractions or section forces, (n,)."""
    if along == "arc" and isinstance(values, SectionForces):
        along = "position"
    return np.asarray(getattr(values, along))


def _along(series: Mapping[str, Any], quantity: str | None, along: str, upright: bool) -> Figure:
    """Draw panels side by side over an upright coordinate, or below each other."""
    first = next(iter(series.values()))
    if quantity is None:
        names = list(_titles(first))
    else:
        names = [quantity]
    titles = [_title(first, name) for name in names]
    figure, axes = _panels(len(names), upright)

    # Draw the series, and open circles where contact slips.
    for style, (label, part) in zip(styles(len(series)), series.items()):
        position = _axis_of(part, along)
        slips = getattr(part, "status", np.zeros(0)) == Status.SLIP
        circles = {"linestyle": "none", "marker": "o", "markersize": 4, "markerfacecolor": "white"}
        for ax, name in zip(axes, names):
            curve = np.stack((position, getattr(part, name)))  # abscissa and ordinate
            if upright:
                curve = curve[::-1]
            ax.plot(*curve, label=label, **style)
            if slips.any():
                ax.plot(*curve[:, slips], color=style["color"], **circles)

    # Write the title of each panel, and the coordinate once.
    for ax, title in zip(axes, titles):
        tidy(ax, 1)
        ax.set(**{"xlabel" if upright else "ylabel": title})
    coordinate = _coordinate_title(first, along)
    if upright:
        axes[0].set_ylabel(coordinate)
        if along == "arc":
            axes[0].invert_yaxis()
    else:
        axes[-1].set_xlabel(coordinate)
    tidy(axes[0], len(series))
    return figure


def _panels(n: int, upright: bool) -> tuple[Figure, ndarray]:
    """Return n axes side by side over an upright coordinate, or below each other."""
    # Choose the arrangement.
    if upright:
        shape = (1, n)
        size = (6.0 + n, 6.0)
    else:
        shape = (n, 1)
        size = (8.0, 3.0 + 1.5 * n)
    figure, axes = plt.subplots(
        *shape,
        figsize=size,
        sharex=not upright,
        sharey=upright,
        squeeze=False,
        layout="constrained",
    )
    return figure, axes.ravel()


def _coordinate_title(values: Any, along: str) -> str:
    """Return the title of the coordinate of tractions or section forces, with its unit."""
    if along == "arc":
        if isinstance(values, Tractions):
            along = "position along the slave"
        else:
            along = "position"
    return labelled(along, "length")


def _ring(series: Mapping[str, Any], quantity: str | None, angle: ndarray) -> Figure:
    """Draw a polar diagram, and one against the central angle."""
    if quantity is None:
        raise ValueError("a diagram around a ring needs a quantity, its second argument")
    figure = plt.figure(figsize=(10.0, 4.2))
    figure.subplots_adjust(**_BESIDE)
    polar: Any = figure.add_subplot(1, 2, 1, projection="polar")
    plain = figure.add_subplot(1, 2, 2)
    polar.set_theta_zero_location("N")
    polar.set_theta_direction(-1)

    # Draw the series over angles that end where they begin.
    order = np.argsort(angle)
    closed = np.append(order, order[:1])
    turns = np.append(angle[order], angle[order[:1]] + 360.0)
    title = quantity
    for style, (label, part) in zip(styles(len(series)), series.items()):
        if isinstance(part, Tractions | SectionForces):
            title = _title(part, quantity)
            part = getattr(part, quantity)
        if np.shape(part) != angle.shape:
            raise ValueError(
                f"the values of '{label}', {np.shape(part)}, do not fit the angles, {angle.shape}"
            )
        around = np.asarray(part, float)[closed]
        polar.plot(np.radians(turns), around, **style)
        plain.plot(turns, around, label=label, **style)

    # Leave a third of the radius free inside, and draw the circle of zero.
    low, high = plain.get_ylim()
    low = min(low, 0.0)
    high = max(high, 0.0)
    polar.set_ylim(low - 0.35 * (high - low), high)
    circle = np.linspace(0.0, 2.0 * np.pi, 181)
    polar.plot(circle, np.zeros(181), color="black", linewidth=0.8, zorder=3)

    # Write the figures of the circles above the curves.
    polar.set_rlabel_position(22.5)
    polar.yaxis.set_major_locator(MaxNLocator(4))
    polar.tick_params(axis="y", labelsize=8)
    polar.set_axisbelow(False)
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
    quantity: str,
    stage: StageResult,
    scale: float | None,
    window: Window | None,
) -> Figure:
    """Draw ordinates of one scale on the bodies of a stage or on members, with their extremes."""
    # Collect the ordinates of all members.
    if isinstance(values, Mapping):
        members = list(values.values())
    else:
        members = [values]
    has_bodies = bool(having(stage.forms, Body))  # no frame alone
    if has_bodies:
        check_plane(basis_of(stage), "plot.diagram")
    title = _title(members[0], quantity)
    lines = [_ordinates(part, quantity) for part in members]
    points = np.vstack([line.axis for line in lines])
    size = float(np.ptp(points, axis=0).max())
    if scale is None:
        largest = max(max_abs(line.ordinate) for line in lines)
        scale = _LONGEST * size / (largest or 1.0)

    # Draw the ordinates.
    figure, ax = plt.subplots(figsize=(7.5, 6.5), layout="constrained")
    if has_bodies:
        scene = Scene(stage)
        fill_elements(ax, scene, "#ece9e2", "#ece9e2")
        draw_sides(ax, scene, borders=0.8, outline=1.2)
    for line in lines:
        tips = line.axis + scale * line.ordinate[:, None] * line.left
        points = np.vstack((points, tips))
        _draw_ordinates(ax, line, tips)
        _write_extremes(ax, line, tips)
    if window is None:
        west, south = points.min(axis=0) - 0.12 * size
        east, north = points.max(axis=0) + 0.12 * size
        window = (west, east, south, north)
    ax.set(xlim=window[:2], ylim=window[2:], aspect="equal")
    ax.set_title(f"{title}, {stage.name}", loc="left", fontsize=12)
    ax.axis("off")
    return figure


class _Ordinates(NamedTuple):
    """Ordinates on an axis, which may be closed."""

    axis: ndarray  # points, (n, 2)
    ordinate: ndarray  # (n,)
    left: ndarray  # directions of positive ordinates, (n, 2)
    closed: bool


def _ordinates(values: Any, quantity: str) -> _Ordinates:
    """Return the ordinates of tractions, into the slave, or of section forces.

    A node of a beam has one value of each of its elements. Their ordinates have one direction, but
    at a corner.
    """
    # Check the kind of the values, and sort the points along the axis.
    _titles(values)
    order = np.argsort(_axis_of(values), kind="stable")
    axis = np.column_stack((values.x, values.y))[order]

    # An axis is closed where its ends are neighbours; two values at a node have no distance.
    steps = row_norms(np.diff(axis, axis=0))
    steps = steps[steps > 0.0]
    gap = np.linalg.norm(axis[0] - axis[-1])
    closed = bool(len(steps) > 2 and gap < 2.5 * np.median(steps))

    # Find the directions to the left of the tangents.
    if closed:
        tangent = np.roll(axis, -1, axis=0) - np.roll(axis, 1, axis=0)
    else:
        tangent = np.gradient(axis, axis=0)
    tangent = tangent / row_norms(tangent)[:, None]
    left = left_of(tangent)

    # Give both values at a node the mean of their directions.
    n = len(axis)
    first = np.arange(n if closed else n - 1)
    second = (first + 1) % n
    apart = row_norms(axis[second] - axis[first])
    smooth = (left[first] * left[second]).sum(axis=1) > _SMOOTH
    at_node = (apart <= _ROUND_OFF * np.ptp(axis)) & smooth
    first = first[at_node]
    second = second[at_node]
    mean = left[first] + left[second]
    mean = mean / row_norms(mean)[:, None]
    left[first] = mean
    left[second] = mean
    if not isinstance(values, SectionForces):
        left = -left
    ordinate = getattr(values, quantity)[order]
    return _Ordinates(axis, ordinate, left, closed)


def fill_elements(ax: Axes, scene: Scene, face: Any, edge: str) -> None:
    """Fill the elements of bodies with a colour, or with one for each of them."""
    corners = scene.coordinates[scene.nodes[scene.cells[:, : scene.corners]]]
    ax.add_collection(
        PolyCollection(list(corners), facecolors=face, edgecolors=edge, linewidths=0.3)
    )


def draw_sides(ax: Axes, scene: Scene, borders: float, outline: float) -> None:
    """Draw borders of regions and outlines of bodies in lines of some widths."""
    for sides, width in ((scene.sides.borders, borders), (scene.sides.outline, outline)):
        ends = list(scene.coordinates[sides[:, [0, -1]]])
        ax.add_collection(LineCollection(ends, colors="#555555", linewidths=width))


def _draw_ordinates(ax: Axes, line: _Ordinates, tips: ndarray) -> None:
    """Draw filled pieces between neighbours, coloured by sign, and the line through the tips."""
    # Fill the pieces; the last point of a closed axis is joined to the first one.
    ring = np.arange(len(tips) + line.closed) % len(tips)
    first = ring[:-1]
    second = ring[1:]
    axis = line.axis
    corners = (axis[first], axis[second], tips[second], tips[first])
    pieces = np.stack(corners, axis=1)  # (n, 4, 2)
    positive = line.ordinate[first] + line.ordinate[second] > 0.0
    for sign, color in ((positive, _POSITIVE), (~positive, _NEGATIVE)):
        filled = PolyCollection(list(pieces[sign]), alpha=0.45, linewidth=0.4)
        filled.set_color(color)
        ax.add_collection(filled)

    # Draw the axis and the line through the tips.
    ax.plot(*tips[ring].T, color="#222222", linewidth=1.4)
    ax.plot(*axis[ring].T, color="#222222", linewidth=0.8)


def _write_extremes(ax: Axes, line: _Ordinates, tips: ndarray) -> None:
    """Write the largest and the smallest value next to their ordinates."""
    # Write the value on the outer side; one that is small beside the other says nothing.
    extremes = (int(line.ordinate.argmax()), int(line.ordinate.argmin()))
    least = _LEAST * max_abs(line.ordinate)
    for i in dict.fromkeys(extremes):
        value = line.ordinate[i]
        if abs(value) < least:
            continue
        outward = line.left[i]
        if value < 0.0:
            outward = -outward
        ax.annotate(
            f"{value:.4g}".replace("-", "−"),
            tips[i],
            xytext=9.0 * outward,
            textcoords="offset points",
            ha=_aligned(outward[0], "left", "right"),
            va=_aligned(outward[1], "bottom", "top"),
            fontsize=11,
            bbox={"facecolor": "white", "alpha": 0.75, "edgecolor": "none", "pad": 1.0},
        )


def _aligned(component: float, positive: Any, negative: Any) -> Any:
    """Return the alignment of a text that is moved along an axis."""
    if abs(component) <= 0.3:
        return "center"
    if component > 0.0:
        return positive
    return negative


def styles(n: int) -> list[dict[str, Any]]:
    """Return line styles of n series; the first of several is dashed."""
    if n == 1:
        return [{"color": _COLORS[1], "linestyle": "-", "linewidth": 1.8}]
    found = []
    for i in range(n):
        color = _COLORS[i % len(_COLORS)]
        found.append({"color": color, "linestyle": "-" if i else "--", "linewidth": 1.8})
    return found


def tidy(ax: Axes, n: int) -> None:
    """Draw a grid, and a legend of several series."""
    ax.grid(color="#dddddd", linewidth=0.6)
    ax.spines[["top", "right"]].set_visible(False)
    if n > 1:
        ax.legend(frameon=False)


def check_ending(figure: Figure, file: str | Path) -> None:
    """Refuse files whose endings Matplotlib does not know; it adds ``.png`` where there is none."""
    known = figure.canvas.get_supported_filetypes()
    ending = Path(file).suffix[1:].lower()
    if ending and ending not in known:
        raise ValueError(f"pictures end in {', '.join(sorted(known))}, not in '{ending}': {file}")


def saved(figure: Figure, file: str | Path | None) -> Figure:
    """Write the figure to a file if one is given, and return it."""
    if file is not None:
        check_ending(figure, file)
        options: dict[str, Any] = {}
        if Path(file).suffix.lower() == ".png":
            options["pil_kwargs"] = {"compress_level": PACKED}
        figure.savefig(file, dpi=160, **options)
    return figure
