"""Diagrams by matplotlib: along interfaces and bodies, over stages, and on the way to a collapse."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy import ndarray
from numpy.typing import ArrayLike
from scipy.spatial import cKDTree

from ..contact.laws import Status
from ..results.fields import basis_of, nodal_field, quantities
from ..results.result import Result
from ..results.sections import SectionForces
from ..results.tractions import Tractions
from .units import labelled

_COLORS = ("#d55e00", "#1f4e8c", "#2a7f3f", "#7b3294", "#444444")


def ring_diagram(angle: ArrayLike, series: Mapping[str, ArrayLike], quantity: str,
                 file: str | Path | None = None) -> Figure:
    """A quantity around a ring: as a polar diagram and against the central angle.

    Parameters
    ----------
    angle
        Central angles in degrees, from the crown clockwise, (n,).
    series
        Values by their labels, (n,) each.  Of two, the first is dashed and the second solid, like a first and
        a second stage.
    quantity
        What it is, with its unit: the label of the axis.
    file
        Name of a picture to write.

    Examples
    --------
    >>> import numpy as np
    >>> import skfem_contact.plot as plot
    >>> angle = np.arange(0., 360., 5.)
    >>> pressure = 100. + 30. * np.cos(2 * np.radians(angle))
    >>> figure = plot.ring_diagram(angle, {"gravity": pressure}, "pressure [kPa]")
    """
    angle = np.asarray(angle, float) % 360.0
    order = np.argsort(angle)
    closed = np.concatenate((order, order[:1]))
    figure = plt.figure(figsize=(10.0, 4.2), layout="constrained")
    polar, plain = figure.add_subplot(1, 2, 1, projection="polar"), figure.add_subplot(1, 2, 2)
    polar.set_theta_zero_location("N")  # type: ignore[attr-defined]
    polar.set_theta_direction(-1)  # type: ignore[attr-defined]
    turns = np.concatenate((angle[order], angle[order[:1]] + 360.0))
    for style, (label, values) in zip(_styles(len(series)), series.items()):
        around = np.asarray(values, float)[closed]
        polar.plot(np.radians(turns), around, **style)
        plain.plot(turns, around, label=label, **style)
    low, high = plain.get_ylim()
    polar.set_ylim(min(low, 0.0) - 0.35 * (max(high, 0.0) - min(low, 0.0)), max(high, 0.0))
    polar.plot(np.linspace(0.0, 2.0 * np.pi, 181), np.zeros(181), color="black", linewidth=0.8, zorder=3)
    polar.set_rlabel_position(22.5)  # type: ignore[attr-defined]
    polar.yaxis.set_major_locator(MaxNLocator(4))
    polar.tick_params(axis="y", labelsize=8)
    polar.set_axisbelow(False)  # the figures of the circles, which stand on the curves
    for text in polar.get_yticklabels():
        text.set_bbox({"facecolor": "white", "alpha": 0.7, "edgecolor": "none", "pad": 0.8})
    plain.set(xlim=(0.0, 360.0), xticks=range(0, 361, 45), ylabel=quantity,
              xlabel="central angle from the crown, clockwise [°]")
    _tidy(plain, len(series))
    return saved(figure, file)


def contact_diagram(series: Mapping[str, Tractions], along: Literal["arc", "x", "y"] = "arc",
                    file: str | Path | None = None) -> Figure:
    """Pressure and friction along an interface; points that slip are marked by open circles.

    Parameters
    ----------
    series
        Tractions by label, of one stage or several.
    along
        Coordinate: position along the slave's chain, or x or y of the points; y is drawn upright, for walls
        and piles.
    file
        Name of a picture to write.

    Examples
    --------
    >>> import numpy as np
    >>> import skfem_contact as sc
    >>> import skfem_contact.plot as plot
    >>> y, ones = np.linspace(-5., 0., 6), np.ones(6)
    >>> joint = sc.results.Tractions(y + 5., 0. * y, y, 0. * y, -6. * y, -2. * y, 0. * y, 0. * y, ones.astype(int),
    ...                              ones, -6. * y, -2. * y)
    >>> figure = plot.contact_diagram({"gravity": joint}, along="y")
    """
    upright = along == "y"
    titles = labelled("pressure", "stress"), labelled("friction", "stress")
    figure, axes = _panels(titles, "position along the slave" if along == "arc" else along, (8.0, 6.0), upright)
    for style, (label, t) in zip(_styles(len(series)), series.items()):
        position, slips = getattr(t, along), t.status == Status.SLIP
        for ax, values in zip(axes, (t.pressure, t.shear)):
            _draw(ax, position, values, upright, label=label, **style)
            _draw(ax, position[slips], values[slips], upright, color=style["color"], linestyle="none",
                  marker="o", markersize=4, markerfacecolor="white")
    _tidy(axes[0], len(series))
    return saved(figure, file)


def section_diagram(series: Mapping[str, SectionForces], upright: bool = False,
                    file: str | Path | None = None) -> Figure:
    """Normal force, shear force and moment along a body.

    Parameters
    ----------
    series
        Section forces by label, of one stage or several.
    upright
        Draw the position downwards, for walls and piles.
    file
        Name of a picture to write.

    Examples
    --------
    >>> import numpy as np
    >>> import skfem_contact as sc
    >>> import skfem_contact.plot as plot
    >>> s = np.linspace(0., 15., 16)
    >>> forces = sc.results.SectionForces(s, 0. * s, -s, N=-5. * s, V=15. - 2. * s, M=s * (15. - s))
    >>> figure = plot.section_diagram({"failure": forces}, upright=True)
    """
    titles = labelled("normal force N", "line"), labelled("shear force V", "line"), labelled("moment M", "moment")
    figure, axes = _panels(titles, "position", (9.0, 6.0) if upright else (8.0, 7.5), upright)
    for style, (label, forces) in zip(_styles(len(series)), series.items()):
        for ax, values in zip(axes, (forces.N, forces.V, forces.M)):
            _draw(ax, forces.position, values, upright, label=label, **style)
    _tidy(axes[0], len(series))
    if upright:
        axes[0].invert_yaxis()
    return saved(figure, file)


def history(forms: Mapping[str, Any], result: Result, quantity: str, at: Mapping[str, ArrayLike], *,
            time: bool = False, file: str | Path | None = None) -> Figure:
    """A field at some points through all stages.

    Parameters
    ----------
    forms, result
        Forms by name and the result of their analysis.
    quantity
        A field of :meth:`~skfem_contact.results.StageResult.field`.
    at
        Places (x, y) by their labels; the nearest nodes are taken. Stages in which no solid is there have no value.
    time
        Over the times at which the stages end, which have durations, in place of their names.
    file
        Name of a picture to write.

    Examples
    --------
    >>> from skfem_contact.demo import culvert
    >>> import skfem_contact.plot as plot
    >>> model = culvert()
    >>> figure = plot.history(model.forms, model.result, "uy", {"crown": (0., .9), "surface": (.9, 3.5)})
    """
    basis, what = basis_of(result[-1]), quantities(result[-1])
    tree = cKDTree(basis.doflocs[:, ::basis.mesh.dim()].T)
    nodes = {label: int(tree.query(np.asarray(place, float))[1]) for label, place in at.items()}
    fields = [nodal_field(stage, quantity) for stage in result]
    names = [stage.name for stage in result]
    figure, ax = plt.subplots(figsize=(8.0, 4.2), layout="constrained")
    for given, (label, node) in zip(_styles(len(nodes)), nodes.items()):
        style = {**given, "linestyle": "-", "marker": "o", "markersize": 5}
        places = [stage.time for stage in result] if time else range(len(names))
        ax.plot(places, [field[node] for field in fields], label=label, **style)
    if time:
        ax.set_xlabel("time")
    else:
        ax.set_xticks(range(len(names)), names)
    ax.set_ylabel(labelled(what[quantity].title, what[quantity].unit))
    _tidy(ax, len(nodes))
    return saved(figure, file)


def load_curve(found: Any, *, file: str | Path | None = None) -> Figure:
    """Factor, or load multiplier, against the largest displacement on the way to a collapse.

    Parameters
    ----------
    found
        What :func:`~skfem_contact.strength_reduction` or :func:`~skfem_contact.limit_load` has found.
    file
        Name of a picture to write.

    Examples
    --------
    >>> import numpy as np
    >>> from skfem import Basis, ElementTriP2, ElementVector, MeshTri
    >>> import skfem_contact as sc
    >>> import skfem_contact.plot as plot
    >>> basis = Basis(MeshTri.init_tensor(*2 * [np.linspace(0, 5, 5)]).with_defaults(), ElementVector(ElementTriP2()),
    ...               intorder=2)
    >>> forms = {"cut": sc.SolidForm(basis, sc.Tresca(E=1e4, nu=.3, c=10.))}
    >>> fixed = np.append(basis.get_dofs("bottom").all(), basis.get_dofs("right").all("u^1"))
    >>> figure = plot.load_curve(sc.Model(forms, fixed).limit_load(sc.weight(basis, 5.), progress=False))
    """
    _, parameter, displacement = np.asarray(found.curve).T
    begin = int(np.argmin(displacement))  # what is before has moved the structure to where the search starts
    figure, ax = plt.subplots(figsize=(7.0, 4.5), layout="constrained")
    (style,) = _styles(1)
    ax.plot(displacement[begin:], parameter[begin:], marker="o", markersize=4, **style)
    ax.axhline(found.value, color="#888888", linewidth=1.0, linestyle=":")
    ax.annotate(f"{found.value:.4g}", (0.0, found.value), xycoords=("axes fraction", "data"), xytext=(6, 4),
                textcoords="offset points", fontsize=11)
    ax.set(xlabel=labelled("largest displacement", "length"), ylabel=found.what)
    ax.set_xlim(left=0.0)
    _tidy(ax, 1)
    return saved(figure, file)


def _styles(n: int) -> list[dict[str, Any]]:
    """Line styles of n series; the first of several is dashed."""
    colors = _COLORS[1:2] if n == 1 else _COLORS
    return [{"color": colors[i % len(colors)], "linestyle": "--" if n > 1 and i == 0 else "-",
             "linewidth": 1.8} for i in range(n)]


def _draw(ax: Axes, position: ndarray, values: ndarray, upright: bool, **style: Any) -> None:
    ax.plot(*((values, position) if upright else (position, values)), **style)


def _panels(titles: Sequence[str], position: str, size: tuple[float, float], upright: bool) -> tuple[Figure, ndarray]:
    """Panels side by side over an upright position, or below each other; the name of the position is written once."""
    n = len(titles)
    rows, columns = (1, n) if upright else (n, 1)
    figure, axes = plt.subplots(rows, columns, figsize=size, sharex=not upright, sharey=upright, layout="constrained")
    for ax, title in zip(axes, titles):
        _tidy(ax, 1)
        ax.set(**{"xlabel" if upright else "ylabel": title})
    axes[0 if upright else -1].set(**{"ylabel" if upright else "xlabel": labelled(position, "length")})
    return figure, axes


def _tidy(ax: Axes, n: int) -> None:
    """A grid, and a legend where there are several series."""
    ax.grid(color="#dddddd", linewidth=0.6)
    ax.spines[["top", "right"]].set_visible(False)
    if n > 1:
        ax.legend(frameon=False)


def saved(figure: Figure, file: str | Path | None) -> Figure:
    """Write the figure to a file if one is given."""
    if file is not None:
        figure.savefig(file, dpi=160)
    return figure
