"""Results of CalculiX, read with its own order of components and nodes, and compared."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import scipy
from numpy import ndarray

from ..mesh.content import to_vtk
from ..mesh.kinds import N_NODES, UPRIGHT_FIRST
from ..results.fields import basis_of, solids

#: Kinds of elements by their numbers in .frd files, from one on.
_KINDS = (
    *("hexahedron", "wedge", "tetra", "hexahedron20", "wedge15", "tetra10"),
    *("triangle", "triangle6", "quad", "quad8", "line", "line3"),
)
#: Order of components here: xx, yy, zz, xy, yz, xz; .dat files have xz before yz, .frd files not.
_FROM_DAT = [0, 1, 2, 3, 5, 4]
#: Widths of the fields of lines of .frd files.
_HEAD = 13
_WIDTH = 12
#: Distance over the size of a mesh up to which nodes are the same: .frd files have six digits.
_SAME = 1e-4


@dataclass(frozen=True)
class Frd:
    """Nodes, elements and fields of a ``.frd`` file.

    Attributes
    ----------
    ids, points
        Numbers and coordinates of the nodes, (n,) and (n, 3).
    cells
        Rows of `points` of the elements by meshio's kinds, in the order of VTK.
    steps
        Times and fields at nodes by name, ``"DISP"``, ``"STRESS"``, (n, components), NaN at nodes
        without a value. Tensors are xx, yy, zz, xy, yz, xz, tension positive.
    """

    ids: ndarray
    points: ndarray
    cells: Mapping[str, ndarray]
    steps: tuple[tuple[float, dict[str, ndarray]], ...]


@dataclass(frozen=True)
class Printed:
    """Block of a ``.dat`` file.

    Attributes
    ----------
    quantity, group, time
        Printed quantity, set and time.
    ids
        Numbers of nodes, or of elements and integration points, (n, 1 or 2); empty for totals.
    values
        Values, (n, components). Tensors are xx, yy, zz, xy, yz, xz.
    """

    quantity: str
    group: str
    time: float
    ids: ndarray
    values: ndarray


@dataclass(frozen=True)
class Comparison:
    """Largest differences of two results, over the largest value of the other one.

    Attributes
    ----------
    displacement
        Of displacements at nodes.
    stress
        Of mean stresses of elements; None without a ``.dat`` file.
    nodes
        Number of nodes that were compared.
    """

    displacement: float
    stress: float | None
    nodes: int


def read_frd(file: str | Path) -> Frd:
    """Read a result file of CalculiX, as text.

    Nodes of bricks and wedges of second order are put into the order of VTK: CalculiX 2.20 swaps
    their last two groups against its input.

    Raises
    ------
    ValueError
        If the file is binary, damaged, or has no nodes.
    """
    # Read the blocks; a damaged file ends in one sentence.
    blocks = _Blocks()
    try:
        blocks.read(_lines(file))
    except (IndexError, KeyError) as error:
        raise ValueError(f"{file} is damaged or not complete") from error
    except ValueError as error:
        raise ValueError(f"{file}: {error}") from error
    if not blocks.ids:
        raise ValueError(f"{file} is not a result file of CalculiX: it has no nodes")
    # Put the nodes of elements into the order of VTK.
    cells = {}
    for kind, rows in blocks.elements.items():
        cells[kind] = to_vtk(np.array(rows), UPRIGHT_FIRST.get(kind))
    ids = np.array(blocks.ids)
    points = np.array(blocks.points)
    return Frd(ids, points, cells, tuple(blocks.steps))


class _Blocks:
    """Blocks of a result file: nodes, elements by kind, and fields by time."""

    def __init__(self) -> None:
        self.ids: list[int] = []
        self.points: list[list[float]] = []
        self.elements: dict[str, list[list[int]]] = {}
        self.steps: list[tuple[float, dict[str, ndarray]]] = []
        self._row: dict[int, int] = {}
        self._time = 0.0

    def read(self, lines: list[str]) -> None:
        """Read all blocks."""
        position = 0
        while position < len(lines):
            position = self._read_block(lines, position)

    def _read_block(self, lines: list[str], position: int) -> int:
        """Read the block that begins in a line, and return the line after it."""
        line = lines[position]
        position += 1
        # Refuse binary blocks.
        if line[:6] in ("    2C", "    3C") and line.split()[-1] not in ("0", "1"):
            raise ValueError("it is binary: use *NODE FILE without OUTPUT=BINARY")
        if line.startswith("    2C"):
            position = _read_nodes(lines, position, self.ids, self.points)
            self._row = {number: k for k, number in enumerate(self.ids)}
        elif line.startswith("    3C"):
            position = _read_elements(lines, position, self._row, self.elements)
        elif line.startswith("  100C"):
            self._time = float(line[12:24])
        elif line.startswith(" -4"):
            position, values = _read_field(lines, position, self._row)
            self._add(line.split()[1], values)
        return position

    def _add(self, name: str, values: ndarray) -> None:
        """Add a field; one that the last step has begins another step."""
        if not self.steps or self.steps[-1][0] != self._time or name in self.steps[-1][1]:
            self.steps.append((self._time, {}))
        self.steps[-1][1][name] = values


def read_dat(file: str | Path) -> list[Printed]:
    """Read the printed results of CalculiX.

    Stresses and strains, which the file has as xx, yy, zz, xy, xz, yz, are put into the order here.

    Raises
    ------
    ValueError
        If the file has no printed results.
    """
    # A title ends the block before it.
    blocks = []
    title = re.compile(r"^ (.+?) \((.+?)\) for set (\S+) and time\s+(\S+)")
    current: tuple[str, str, str, float] | None = None
    rows: list[list[float]] = []
    for line in [*_lines(file), " end (x) for set - and time 0"]:
        match = title.match(line)
        if match:
            if current is not None and rows:
                blocks.append(_printed(current, rows))
            current = (match[1], match[2], match[3], float(match[4]))
            rows = []
        elif line.strip() and current is not None:
            try:
                rows.append([float(word) for word in line.split()])
            except ValueError:
                raise ValueError(f"{file}: the line '{line.strip()[:60]}' has no numbers") from None
    if not blocks:
        raise ValueError(f"{file} has no printed results of CalculiX")
    return blocks


def compare(stage: Any, frd: Frd, dat: list[Printed] | None = None) -> Comparison:
    """Compare a stage with the last step of CalculiX on the same mesh.

    Parameters
    ----------
    stage
        Stage of an analysis whose mesh was written by ``save_mesh``.
    frd
        Result file with ``*NODE FILE`` U; nodes are found by their coordinates.
    dat
        Printed results with ``*EL PRINT`` S of all elements, by the numbers of ``save_mesh``.

    Raises
    ------
    ValueError
        If nodes of one mesh are not in the other one.
    """
    # Find the nodes of both results.
    basis = basis_of(stage)
    dim = basis.mesh.dim()
    nodes = basis.doflocs[:, ::dim].T
    size = np.ptp(nodes, axis=0).max()
    tree = scipy.spatial.cKDTree(frd.points[:, :dim])
    distance, row = map(np.asarray, tree.query(nodes))
    if distance.max() > _SAME * size:
        raise ValueError(
            f"{np.count_nonzero(distance > _SAME * size)} of {len(nodes)} nodes are not in the "
            f"result of CalculiX, by up to {distance.max():.3g}"
        )
    # Compare the last displacements, then the stresses.
    moved = [fields["DISP"] for _, fields in frd.steps if "DISP" in fields]
    if not moved:
        raise ValueError("the result of CalculiX has no displacements: add *NODE FILE with U")
    own = stage.x[: basis.N].reshape(-1, dim)
    other = moved[-1][row, :dim]
    displacement = np.abs(own - other).max() / np.abs(other).max()
    if dat is None:
        stress = None
    else:
        stress = _stress_difference(stage, dat)
    return Comparison(float(displacement), stress, len(nodes))


def _stress_difference(stage: Any, dat: list[Printed]) -> float:
    """Return the largest difference of mean stresses of elements."""
    printed = [block for block in dat if block.quantity == "stresses"]
    if not printed:
        raise ValueError("the printed results have no stresses: add *EL PRINT with S")
    last = printed[-1]
    elements = last.ids[:, 0].astype(int) - 1
    count = basis_of(stage).mesh.nelements
    if elements.min() < 0 or elements.max() >= count:
        raise ValueError(f"the printed elements are not the {count} elements of the mesh")
    points = np.bincount(elements, minlength=count)
    sums = [np.bincount(elements, column, minlength=count) for column in last.values.T]
    known = points > 0
    other = np.stack(sums, axis=1)[known] / points[known, None]

    # Take means of the elements of all solids
    own = np.full((count, 6), np.nan)
    for name, form in solids(stage).items():
        share = form.weight / form.weight.sum(axis=1)[:, None]
        mean = np.einsum("ceq,eq->ec", stage.states[name].stress, share)
        own[form.elements, : mean.shape[1]] = mean
    own = own[known]
    width = np.isfinite(own).all(axis=0)
    difference = np.abs(own[:, width] - other[:, width]).max()
    return float(difference / np.abs(other).max())


def _printed(head: tuple[str, str, str, float], rows: list[list[float]]) -> Printed:
    """Return a block with its numbers in front, and its components in the order here."""
    quantity, names, group, time = head
    columns = [name.strip() for name in names.split(",")]
    keys = [name for name in columns if name in ("elem", "integ.pnt.")]
    table = np.array(rows)
    components = len(columns) - len(keys)
    n_ids = table.shape[1] - components
    values = table[:, n_ids:]
    if components == 6 and columns[-2:] in (["sxz", "syz"], ["exz", "eyz"]):
        values = values[:, _FROM_DAT]
    return Printed(quantity, group, time, table[:, :n_ids].astype(int), values)


def _lines(file: str | Path) -> list[str]:
    text = Path(file).read_bytes()
    return text.decode("ascii", "replace").splitlines()


def _read_nodes(lines: list[str], position: int, ids: list[int], points: list[list[float]]) -> int:
    """Read lines " -1", number, three coordinates; return the position behind " -3"."""
    while lines[position][:3] == " -1":
        line = lines[position]
        ids.append(int(line[3:_HEAD]))
        points.append(_numbers(line, 3))
        position += 1
    return position + 1


def _read_elements(
    lines: list[str],
    position: int,
    row: dict[int, int],
    elements: dict[str, list[list[int]]],
) -> int:
    """Read the lines of elements: head, then ten or fifteen nodes a line."""
    while lines[position][:3] == " -1":
        number = int(lines[position].split()[2])
        if not 1 <= number <= len(_KINDS):
            raise ValueError(f"elements of type {number} are not read")
        kind = _KINDS[number - 1]
        nodes: list[int] = []
        position += 1
        while len(nodes) < N_NODES[kind]:
            line = lines[position]
            nodes += [int(line[k : k + 10]) for k in range(3, len(line.rstrip()), 10)]
            position += 1
        elements.setdefault(kind, []).append([row[node] for node in nodes])
    return position + 1


def _read_field(lines: list[str], position: int, row: dict[int, int]) -> tuple[int, ndarray]:
    """Read the names of components and the lines of a field."""
    # Count the components, without the total.
    components = 0
    while lines[position][:3] == " -5":
        words = lines[position].split()
        components += not words[-1].endswith("ALL")
        position += 1
    # Read the values, which continue on lines of their own.
    values = np.full((len(row), components), np.nan)
    while lines[position][:3] == " -1":
        line = lines[position]
        node = row[int(line[3:_HEAD])]
        found = _numbers(line, min(components, 6))
        position += 1
        while len(found) < components:
            found += _numbers(lines[position], min(components - len(found), 6))
            position += 1
        values[node] = found
    if lines[position][:3] != " -3":
        raise ValueError("it ends within a field")
    return position + 1, values


def _numbers(line: str, count: int) -> list[float]:
    """Return numbers of twelve letters behind the head of a line."""
    starts = range(_HEAD, _HEAD + count * _WIDTH, _WIDTH)
    return [float(line[start : start + _WIDTH]) for start in starts]
