"""A chart for each benchmark: error against time, or time against size where all errors are
round-off."""

from __future__ import annotations

from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import LogFormatter, NullFormatter

#: Errors below this are round-off: no mesh or method is better than another.
ROUND_OFF = 1e-6
COLORS = (
    "#1f4e8c",
    "#d55e00",
    "#2a7f3f",
    "#7b3294",
    "#b8860b",
    "#c2185b",
    "#00838f",
    "#6d4c41",
    "#5c6bc0",
    "#9e9d24",
)
#: Rows of some benchmarks that belong on one chart; the others are in the table.
SHOWN = {
    "plot_footing": lambda row: (
        row["phi"] == row["psi"] and row["error"] < 1.0
    ),  # associated flow has an exact load
    "plot_patch": lambda row: row.get("slave", "coarser") == "coarser",
    "plot_slope_factor": lambda row: row.get("peer") or "flow given" in row["method"],
}


def chart(rows: list[dict], file: Path) -> bool:
    """Draw the rows of a benchmark; False where there is nothing to compare."""
    shown = SHOWN.get(file.stem, lambda row: True)
    drawn = [row for row in rows if row.get("cpu_s") and row["cpu_s"] > 0 and shown(row)]
    precision = [row for row in drawn if row.get("error") and row["error"] > 0]
    if precision and max(row["error"] for row in precision) > ROUND_OFF:
        x = "penalty" if "penalty" in rows[0] else "cpu_s"
        drawn, y, labels = (
            precision,
            "error",
            ("penalty" if x == "penalty" else "CPU time [s]", "error"),
        )
    elif len({row.get("unknowns") for row in drawn}) > 1:
        x, y, labels = "unknowns", "cpu_s", ("unknowns", "CPU time [s]")
    else:
        return False
    drawn = [row for row in drawn if row.get(x)]
    lines: dict[tuple[str, bool], list[dict]] = {}
    for row in drawn:
        lines.setdefault((series(row), bool(row.get("peer"))), []).append(row)
    lines = {key: part for key, part in lines.items() if len(part) > 1 or key[1]}
    if not lines:
        return False
    figure, ax = plt.subplots(figsize=(8.6, 4.4), layout="constrained")
    for number, ((name, peer), part) in enumerate(lines.items()):
        part = sorted(
            part,
            key=lambda row: row[x] if x == "penalty" else row.get("unknowns") or row.get("n") or 0,
        )
        style = (
            {"linestyle": "--", "marker": "s", "color": "#555555" if number % 2 else "#999999"}
            if peer
            else {"linestyle": "-", "marker": "o", "color": COLORS[number % len(COLORS)]}
        )
        ax.plot(
            [row[x] for row in part],
            [row[y] for row in part],
            label=name,
            markersize=4.5,
            linewidth=1.4,
            **style,
        )
    ax.set(xscale="log", yscale="log", xlabel=labels[0], ylabel=labels[1])
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_minor_formatter(
            NullFormatter()
            if np.ptp(np.log10(axis.get_view_interval())) > 1.3
            else LogFormatter(minor_thresholds=(2, 0.8))
        )
    ax.grid(color="#dddddd", linewidth=0.6, which="both")
    ax.spines[["top", "right"]].set_visible(False)
    ax.legend(frameon=False, fontsize=8, loc="center left", bbox_to_anchor=(1.0, 0.5))
    figure.savefig(file, dpi=110)
    plt.close(figure)
    return True


def series(row: dict) -> str:
    """Which line a row belongs to: its method, and what else was varied besides the size of the
    mesh."""
    extra = [
        f"{key} = {row[key]:g}" if isinstance(row[key], (int, float)) else str(row[key])
        for key in ("element", "slave", "phi", "psi")
        if key in row
    ]
    return ", ".join([row["method"], *extra])
