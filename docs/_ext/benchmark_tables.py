"""Tables of the benchmarks, made from the figures that their full runs have printed.

``examples/4_benchmarks/results/<example>.json`` is the last line of ``<example>.py --full``; nothing else holds these
numbers.
"""

from __future__ import annotations

import ast
import json
from pathlib import Path

#: Columns of all tables by the key of the row, and keys that no table shows.
COLUMNS = {"method": "method", "unknowns": "unknowns", "error": "error", "cpu_s": "CPU s", "iterations": "iterations"}
HIDDEN = {"n", "case", "solver", "peer"}


def write_page(app, config) -> None:
    """Write the tables before Sphinx looks for its sources."""
    examples = Path(app.srcdir).parent / "examples" / "4_benchmarks"
    target = Path(app.srcdir, "_build", "generated", "benchmarks.md")
    target.parent.mkdir(parents=True, exist_ok=True)
    sections = [section(examples, path) for path in sorted((examples / "results").glob("*.json"))]
    target.write_text("\n\n".join(sections) + "\n", encoding="utf-8")


def section(examples: Path, path: Path) -> str:
    """Heading, a link to the example, the comparison with other programs and the table of a benchmark."""
    rows = json.loads(path.read_text(encoding="utf-8"))["rows"]
    source = (examples / f"{path.stem}.py").read_text(encoding="utf-8")
    title = str(ast.get_docstring(ast.parse(source))).split("\n")[0]
    parts = [f"## {title}", f"{{doc}}`The example <gallery/4_benchmarks/{path.stem}>`", *compared(rows), table(rows)]
    return "\n\n".join(parts)


def table(rows: list[dict]) -> str:
    """A table in Markdown, its columns those of any row."""
    keys = list(dict.fromkeys(key for row in rows for key in (*COLUMNS, *row) if key not in HIDDEN))
    keys = [key for key in keys if any(row.get(key) is not None for row in rows)]
    lines = [[COLUMNS.get(key, key.replace("_", " ")) for key in keys], [":--"] + ["--:"] * (len(keys) - 1)]
    lines += [[text(key, row.get(key)) for key in keys] for row in rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def text(key: str, value: object) -> str:
    """A figure with as many digits as it deserves."""
    if value is None:
        return ""
    if not isinstance(value, float):
        return str(value)
    return f"{value:.1e}" if key == "error" and 0 < abs(value) < 1e-4 else f"{value:.3g}"


def compared(rows: list[dict]) -> list[str]:
    """Our time over that of the fastest other program whose error is no larger, for the finest mesh of both."""
    peers = [row for row in rows if row.get("peer")]
    if not peers:
        return []
    n = max(row["n"] for row in peers)
    lines = ["| method | error | CPU s | fastest program with no larger error | its CPU s | times faster |",
             "|:--|--:|--:|:--|--:|--:|"]  # fmt: skip
    for row in rows:
        if row.get("peer") or row["n"] != n or row["error"] is None:
            continue
        better = [peer for peer in peers if peer["n"] == n and peer["error"] <= row["error"]]
        best = min(better, key=lambda peer: peer["cpu_s"], default=None)
        end = (f"{best['method']} | {best['cpu_s']:.3g} | {best['cpu_s'] / row['cpu_s']:.1f}" if best else "none | |")
        lines.append(f"| {row['method']} | {row['error']:.3g} | {row['cpu_s']:.3g} | {end} |")
    return ["\n".join(lines)]


def setup(app):
    """Register the extension."""
    app.connect("config-inited", write_page)
    return {"parallel_read_safe": True}
