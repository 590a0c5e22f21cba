"""Layers and parameters from the table of a borehole."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from ..checks import is_number

#: Names of the column with the lower ends of the layers.
_DEPTH = ("depth", "bottom", "to")
#: Names of the column with the soils.
_SOIL = ("soil", "layer", "name")


@dataclass(frozen=True)
class Borehole:
    """Layers and soils of a borehole.

    Attributes
    ----------
    layers
        Pairs of soil and height of the lower end of each layer, from the top to the bottom, as
        :func:`~skfem_contact.section.layers` takes them.
    parameters
        Numbers of each soil by the names of their columns.
    """

    layers: tuple[tuple[str, float], ...]
    parameters: dict[str, dict[str, float]]


def borehole(file: str | Path, surface: float = 0.0) -> Borehole:
    r"""Read the layers of a borehole from a CSV file, or from its text.

    Parameters
    ----------
    file
        Name of the file, or text of several lines. The first line names the columns: ``depth``,
        down to which a layer reaches below the surface, ``soil``, and parameters such as ``E``,
        ``nu``, ``c``, ``phi``, ``unit_weight``. Columns are separated by commas, semicolons or
        tabulators. Empty cells are left out.
    surface
        Height of the surface.

    Raises
    ------
    ValueError
        Columns without a name or missing ones, texts instead of numbers, depths that do not
        increase, a soil that comes twice with other parameters. The line is named.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> bore = sc.section.borehole("depth, soil, E, phi\n2.5, sand, 4e4, 34\n9.0, clay, 9e3,")
    >>> bore.layers, bore.parameters["sand"]
    ((('sand', -2.5), ('clay', -9.0)), {'E': 40000.0, 'phi': 34.0})
    """
    rows = _rows(file)
    names = next(iter(rows), [])
    depth = _column(names, _DEPTH)
    soil = _column(names, _SOIL)
    if len(set(names)) < len(names) or "" in names:
        raise ValueError(f"the columns of a borehole need different names, not {names}")

    layers: list[tuple[str, float]] = []
    parameters: dict[str, dict[str, float]] = {}
    upper = surface
    for number, row in enumerate(rows[1:], 2):
        name, values = _cells(row, names, soil, number)

        # Place it below the layer above
        bottom = surface - values.pop(names[depth], -float("inf"))
        if not bottom < upper or not is_number(bottom):
            raise ValueError(
                f"line {number} of the borehole: the depth {row[depth]!r} of '{name}' is not "
                f"below the layer above, which ends at {surface - upper:g}"
            )
        if parameters.setdefault(name, values) != values:
            raise ValueError(
                f"line {number} of the borehole: '{name}' has the parameters {values}, but "
                f"{parameters[name]} above; give it another name"
            )
        layers.append((name, bottom))
        upper = bottom
    if not layers:
        raise ValueError("the borehole has no layers")
    return Borehole(tuple(layers), parameters)


def _rows(file: str | Path) -> list[list[str]]:
    """Return the stripped cells of all lines that are not empty."""
    text = str(file)
    if "\n" not in text:
        text = Path(file).read_text(encoding="utf-8-sig")
    lines = [line for line in text.splitlines() if line.strip()]
    rows = []
    if lines:
        separator = max(",;\t", key=lines[0].count)
        for row in csv.reader(io.StringIO("\n".join(lines)), delimiter=separator):
            rows.append([cell.strip() for cell in row])
    return rows


def _column(names: list[str], known: tuple[str, ...]) -> int:
    """Return the number of a column of one of several names."""
    columns = [k for k, name in enumerate(names) if name.lower() in known]
    if len(columns) != 1:
        raise ValueError(f"a borehole needs one column {' or '.join(known)}, not {names}")
    return columns[0]


def _number(cell: str, name: str, line: int) -> float:
    """Return the number in a cell."""
    try:
        return float(cell)
    except ValueError as error:
        raise ValueError(
            f"line {line} of the borehole: '{name}' must be a number, not {cell!r}"
        ) from error


def _cells(
    row: Sequence[str],
    names: Sequence[str],
    soil: int,
    number: int,
) -> tuple[str, dict[str, float]]:
    """Return the name of the soil in a row, and the numbers of the other cells by column."""
    if len(row) != len(names) or not row[soil]:
        raise ValueError(
            f"line {number} of the borehole has {len(row)} cells, not {len(names)}, or no "
            f"soil: {row}"
        )
    cells = dict(zip(names, row))
    name = cells.pop(names[soil])
    return name, {key: _number(cell, key, number) for key, cell in cells.items() if cell}
