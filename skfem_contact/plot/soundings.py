"""Cone penetration tests and the section that is interpolated between them, by matplotlib."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from .diagram import saved

#: Colours of soils in the order in which they are met.
_SOILS = ("#e8d8a8", "#c9b184", "#a8b89a", "#d9c3b0", "#b8a6a0", "#9fb3c2", "#8f8f8f", "#c6c6c6")
_MEASURED = "#222222"
_HEIGHT = 4.6
_PANEL = 1.6
_SECTION = 6.0


def soundings(
    tests: Sequence[Any],
    columns: Sequence[Any] = (),
    section: Any = None,
    file: str | Path | None = None,
) -> Figure:
    """Draw cone resistances by height, the layers of columns, and a section.

    Depths without readings are hatched. Layers of columns are drawn in the colours of the section,
    whose layers between the columns are interpolated.

    Parameters
    ----------
    tests
        :class:`~skfem_contact.ground.Sounding`, one panel for each.
    columns
        :class:`~skfem_contact.ground.Column`, boreholes and layers of soundings; a column of the
        name of a sounding colours its panel.
    section
        A :class:`~skfem_contact.section.Section`, as from ``ground.section``.
    file
        Name of a picture to write.

    Examples
    --------
    >>> import numpy as np
    >>> import skfem_contact as sc
    >>> import skfem_contact.plot as plot
    >>> z = np.arange(0.1, 8.0, 0.1)
    >>> sand = sc.ground.Sounding("C1", (0., 0.), 1., z, 1e4 + 0*z, 80. + 0*z, np.nan*z, water=2.)
    >>> plot.soundings([sand], [sand.column()])
    <Figure size ...>
    """
    if not tests and section is None:
        raise ValueError("there is nothing to draw: give soundings or a section")
    colors = _colors_of(columns, section)
    # Arrange tests and section side by side.
    widths = [_PANEL] * len(tests) + [_SECTION] * (section is not None)
    figure, panels = plt.subplots(
        ncols=len(widths),
        figsize=(sum(widths) + 1.0, _HEIGHT),
        width_ratios=widths,
        sharey=True,
        squeeze=False,
        layout="constrained",
    )
    # Draw them.
    by_name = {column.name: column for column in columns}
    for axes, test in zip(panels[0], tests):
        _draw_test(axes, test, by_name.get(test.name), colors)
    if section is not None:
        _draw_section(panels[0, -1], section, colors)
    panels[0, 0].set_ylabel("height [m]")
    handles = [Rectangle((0, 0), 1, 1, color=color) for color in colors.values()]
    if handles:
        figure.legend(handles, list(colors), loc="outside lower center", ncols=4, frameon=False)
    saved(figure, file)
    return figure


def _colors_of(columns: Sequence[Any], section: Any) -> dict[str, Any]:
    """Return the colours of the soils of a section and of columns."""
    names: list[str] = []
    if section is not None:
        names += section.areas
    for column in columns:
        names += [soil for soil in column.soils if soil not in names]
    return {name: _SOILS[k % len(_SOILS)] for k, name in enumerate(names)}


def _draw_test(axes: Any, test: Any, column: Any, colors: dict[str, str]) -> None:
    """Draw cone resistance in MPa, layers behind it, and hatches where nothing was measured."""
    height = test.level - test.depth
    if column is not None:
        upper = column.level
        for soil, (_, lower) in zip(column.soils, column.layers):
            axes.axhspan(lower, upper, color=colors[soil], linewidth=0.0)
            upper = lower
    gap = ~test.measured
    edges = np.flatnonzero(np.diff(np.concatenate(([False], gap, [False]))))
    for start, end in edges.reshape(-1, 2):
        upper = height[max(start - 1, 0)]
        lower = height[min(end, len(height) - 1)]
        axes.axhspan(lower, upper, facecolor="white", edgecolor="#999999", hatch="////", alpha=0.8)
    axes.plot(1e-3 * test.resistance, height, color=_MEASURED, linewidth=1.0)
    axes.set(xlim=(0.0, None), xlabel="$q_t$ [MPa]", title=test.name)


def _draw_section(axes: Any, section: Any, colors: dict[str, str]) -> None:
    """Fill the areas of the section."""
    for name in section.areas:
        for outline in section.outlines[name]:
            a, b, _ = outline.chords()
            corners = np.vstack((a, b[-1:]))
            axes.fill(*corners.T, facecolor=colors[name], edgecolor="#333333", linewidth=0.8)
    axes.set(xlabel="x [m]", title="interpolated between the columns")
