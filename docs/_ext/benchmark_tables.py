"""Tables of the benchmarks, made from the figures that their full runs have printed.

``examples/benchmarks/results/<example>.json`` is the last line of ``<example>.py --full``;
nothing else holds these numbers.
"""

from __future__ import annotations

import ast
import json
from collections.abc import Iterable
from pathlib import Path

from benchmark_charts import chart

#: Columns of all tables by the key of the row, and keys that no table shows.
COLUMNS = {
    "method": "method",
    "unknowns": "unknowns",
    "error": "error",
    "cpu_s": "CPU s",
    "iterations": "iterations",
}
HIDDEN = {"n", "case", "solver", "peer"}


def write_page(app, config) -> None:
    """Write the tables before Sphinx looks for its sources."""
    examples = Path(app.srcdir).parent / "examples" / "benchmarks"
    target = Path(app.srcdir, "_build", "generated", "benchmarks.md")
    target.parent.mkdir(parents=True, exist_ok=True)
    sections = [
        section(examples, path, target.parent)
        for path in sorted((examples / "results").glob("*.json"))
    ]
    target.write_text(
        "\n\n".join(["## Beside other programs", overview(examples), *sections]) + "\n",
        encoding="utf-8",
    )


def section(examples: Path, path: Path, target: Path) -> str:
    """Heading, a link to the example, the chart and, folded, the table of a benchmark."""
    rows = json.loads(path.read_text(encoding="utf-8"))["rows"]
    title = heading(examples, path)
    link = f"{{doc}}`The example <gallery/benchmarks/{path.stem}>`"
    picture = f"![{title}]({path.stem}.png)\n\n" if chart(rows, target / f"{path.stem}.png") else ""
    return f"## {title}\n\n{link}\n\n{picture}:::{{dropdown}} All figures\n\n{table(rows)}\n:::"


def heading(examples: Path, path: Path) -> str:
    """Title of an example."""
    source = (examples / f"{path.stem}.py").read_text(encoding="utf-8")
    return str(ast.get_docstring(ast.parse(source))).split("\n")[0]


def table(rows: list[dict]) -> str:
    """A table in Markdown, its columns those of any row."""
    keys = list(dict.fromkeys(key for row in rows for key in (*COLUMNS, *row) if key not in HIDDEN))
    keys = [key for key in keys if any(row.get(key) is not None for row in rows)]
    lines = [
        [COLUMNS.get(key, key.replace("_", " ")) for key in keys],
        [":--"] + ["--:"] * (len(keys) - 1),
    ]
    lines += [[text(key, row.get(key)) for key in keys] for row in rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def text(key: str, value: object) -> str:
    """A figure with as many digits as it deserves."""
    if value is None:
        return ""
    if not isinstance(value, float):
        return str(value)
    if key in ("lower", "upper"):  # bounds, which differ in the fourth digit
        return f"{value:.5g}"
    return f"{value:.1e}" if key == "error" and 0 < abs(value) < 1e-4 else f"{value:.3g}"


def overview(examples: Path) -> str:
    """A line for every other program on its largest mesh, and what of ours stands against it."""
    head = [
        "times faster",
        "case",
        "other program",
        "its error",
        "its CPU s",
        "ours",
        "our error",
        "our CPU s",
    ]
    lines = [head, ["--:", ":--", ":--", "--:", "--:", ":--", "--:", "--:"]]
    for path in sorted((examples / "results").glob("*.json")):
        rows = json.loads(path.read_text(encoding="utf-8"))["rows"]
        for peer in largest(row for row in rows if row.get("peer") and "unknowns" in row):
            ours = rival(peer, rows)
            ratio = f"**{peer['cpu_s'] / ours['cpu_s']:.1f}**"
            lines.append([ratio, heading(examples, path), *figures(peer), *figures(ours)])
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def largest(peers: Iterable[dict]) -> list[dict]:
    """The last row, that of the largest mesh, of every other program."""
    return list({peer["method"]: peer for peer in peers}.values())


def rival(peer: dict, rows: list[dict]) -> dict:
    """Our fastest row on a mesh like the peer's whose error is no larger; if there is none, the
    most accurate."""
    same = [
        row
        for row in rows
        if not row.get("peer")
        and row["error"] is not None
        and 0.8 < row["unknowns"] / peer["unknowns"] < 1.25
        and row.get("psi") == peer.get("psi")
        and row.get("case") == peer.get("case")
        and "flow davis" not in row["method"]
    ]
    better = [row for row in same if row["error"] <= peer["error"]]
    return (
        min(better, key=lambda row: row["cpu_s"])
        if better
        else min(same, key=lambda row: row["error"])
    )


def figures(row: dict) -> list[str]:
    """Method, with the version of another program where it is known, error and time of a row."""
    version = f" ({row['peer']})" if isinstance(row.get("peer"), str) else ""
    return [row["method"] + version, *(text(key, row[key]) for key in ("error", "cpu_s"))]


def setup(app):
    """Register the extension."""
    app.connect("config-inited", write_page)
    return {"parallel_read_safe": True}
