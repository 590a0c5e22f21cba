"""Report as a Word document, by python-docx."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from datetime import datetime
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from ..display import Table
from ..results.cuts import Cuts
from ..results.result import Result
from ..versions import own_version, versions
from . import report_tables
from .model import shades
from .report_parts import diagrams_of, facts_of, image, run_of, searches_of, stages_of

#: Width of a picture in inches, and of one of two side by side.
_WIDE = 6.0
_NARROW = 3.1
#: Columns of a table of stages: more of them continue below.
_COLUMNS = 5


def write(
    result: Result,
    file: Path,
    title: str,
    quantity: str,
    sections: Mapping[str, Cuts],
    searches: Mapping[str, Any],
    pictures: Mapping[str, Any],
) -> Path:
    """Write a report as a Word document, see :func:`report`; the file appears once it is whole."""
    try:
        import docx
    except ImportError as error:
        raise ValueError(
            "a report in .docx needs python-docx: pip install skfem-contact[report], or write .html"
        ) from error

    # Compute all tables and the colours before the first page.
    table = result.table(sections=sections, searches=searches)
    colors = shades(result)
    text = docx.Document()
    text.add_heading(title, 0)
    _table(text, _pairs(facts_of(result, table, searches), ("figure", "value")))

    # Describe the model.
    text.add_heading("Model", 1)
    _table(text, report_tables.parameters(result, colors))
    for heading, parts in {
        "Supports": (report_tables.supports(result),),
        "Stresses at rest and water": (report_tables.at_rest(result), report_tables.water(result)),
    }.items():
        text.add_heading(heading, 2)
        for part in parts:
            _table(text, part)

    # Show the stages, with forces and loads.
    text.add_heading("Stages", 1)
    for name, changes, drawn in stages_of(result, colors, quantity):
        text.add_heading(name, 2)
        text.add_paragraph(changes)
        _pictures(text, drawn.items(), _NARROW if len(drawn) > 1 else _WIDE)
    text.add_heading("Loads and reactions", 1)
    _table(text, report_tables.loads(result))
    text.add_heading("Largest displacements and forces", 1)
    for part in _by_stages(table):
        _table(text, part)
    _pictures(text, diagrams_of(result, sections), _WIDE)

    # Show the searches and further pictures.
    text.add_heading("Safety", 1)
    for name, lines, drawn in searches_of(searches):
        text.add_heading(name, 2)
        text.add_paragraph(lines)
        _pictures(text, drawn.items(), _WIDE)
    if pictures:
        text.add_heading("Pictures", 1)
        _pictures(text, pictures.items(), _WIDE)

    # Add remarks, the run and versions.
    text.add_heading("Remarks", 1)
    for stage in result:
        for remark in stage.remarks:
            text.add_paragraph(f"{stage.name}: {remark}", style="List Bullet")
    text.add_heading("Run", 1)
    _table(text, run_of(result))
    _table(text, _pairs(versions(), ("package", "version")))
    text.add_paragraph(f"skfem_contact {own_version()}, {datetime.now():%Y-%m-%d %H:%M}")
    content = BytesIO()
    text.save(content)
    file.write_bytes(content.getvalue())
    return file


def _pairs(values: Mapping[str, str], head: tuple[str, str]) -> Table:
    return Table(head, tuple(values.items()))


def _table(text: Any, table: Table) -> None:
    """Add a table; one without rows is left out."""
    if not len(table):
        return
    grid = text.add_table(rows=1, cols=len(table.head), style="Light Grid Accent 1")
    for cell, title in zip(grid.rows[0].cells, table.titles, strict=True):
        cell.text = title
    for row in table.texts():
        cells = grid.add_row().cells
        for cell, content in zip(cells, row, strict=True):
            cell.text = content
    text.add_paragraph()


def _by_stages(table: Table) -> Iterable[Table]:
    """Yield the table of stages with a column for each stage, some columns at a time."""
    head, *rows = zip(table.titles, *table.texts(), strict=True)
    stages = head[1:]
    n_tables = -(-len(stages) // _COLUMNS)
    for part in np.array_split(np.arange(len(stages)), n_tables):
        lines = []
        for row in rows:
            lines.append((row[0], *(row[1 + k] for k in part)))
        yield Table(("", *(stages[k] for k in part)), tuple(lines))


def _pictures(text: Any, pictures: Iterable[tuple[str, Any]], width: float) -> None:
    """Add pictures with their captions, small ones side by side."""
    from docx.shared import Inches

    paragraph: Any = None
    captions = []
    for caption, picture in pictures:
        captions.append(caption)
        if picture is None:  # this machine cannot draw it
            continue
        kind, content = image(caption, picture)
        if kind == "svg+xml":
            raise ValueError(f"picture '{caption}': a .docx file takes no .svg, give a .png")
        if paragraph is None or width > _NARROW:
            paragraph = text.add_paragraph()
        paragraph.add_run().add_picture(BytesIO(content), width=Inches(width))
    if captions:
        text.add_paragraph("; ".join(captions), style="Caption")
