"""Files of VTK, .vtu and .vtk, through meshio; names are data of cells."""

from __future__ import annotations

import contextlib
import io
import re
from html import escape
from mmap import ACCESS_READ, mmap
from typing import Any

import numpy as np

from ...checks import one_line
from ...errors import warn
from ..content import Content, check_names, compact
from ..kinds import KINDS, Integers
from .scikit_fem import add_encoded

#: Names of data of cells that number regions.
_REGIONS = (
    "MaterialIDs",
    "material",
    "region",
    "body",
    "CellEntityIds",
    "gmsh:physical",
    "medit:ref",
    "cell_tags",
    "PartitionId",
)
#: Most values of data of cells by which they are taken for numbers of regions.
_MOST = 256


def read(path: str) -> Content:
    """Read cells and their data."""
    file = _meshio(path)
    # Read points and cells, blocks of a kind after each other.
    points = np.asarray(file.points, dtype=float)
    content = Content(np.pad(points, ((0, 0), (0, 3 - points.shape[1]))), {})
    blocks: list[tuple[str, Integers]] = []
    for block in file.cells:
        if block.type not in KINDS:
            raise ValueError(f"it has cells of type {block.type}, which are not read")
        cells = compact(np.asarray(block.data, dtype=int))
        blocks.append((block.type, content.add_cells(block.type, cells)))
    _check_complete(path, sum(len(members) for _, members in blocks))
    _add_groups(content, file, blocks)
    return content


def _add_groups(content: Content, file: Any, blocks: list[tuple[str, Integers]]) -> None:
    """Add groups from whole numbers of cells, which files of Gmsh have as a column."""
    encoded = {}
    for key, columns in file.cell_data.items():
        parts = [part[:, 0] if part.shape[1:] == (1,) else part for part in columns]
        if key.startswith("skfem:"):
            encoded[key] = np.concatenate(parts).astype(int)
        elif all(part.ndim == 1 and part.dtype.kind in "iub" for part in parts):
            _add_data(content, key, blocks, parts)
    add_encoded(content, encoded)


def _check_complete(path: str, count: int) -> None:
    """Refuse a file of whose cells meshio reads a part: truncated, or of types it leaves out."""
    expression = rb"""<Piece\b[^>]*NumberOfCells\s*=\s*["']\s*(\d+)"""
    if path.lower().endswith(".vtk"):
        expression = rb"(?m)^CELL_TYPES\s+(\d+)"
    with open(path, "rb") as file, mmap(file.fileno(), 0, access=ACCESS_READ) as octets:
        announced = sum(map(int, re.findall(expression, octets)))
    if count < announced:
        raise ValueError(
            f"it announces {announced} cells, but {count} can be read: it is not complete, in "
            "several pieces, which ParaView joins, or has cells such as voxels, which ParaView's "
            "filter Tetrahedralize divides"
        )


def _meshio(path: str) -> Any:
    """Read a file with meshio, whose messages and exits become one error."""
    import meshio

    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        try:
            return meshio.read(path)
        except (FileNotFoundError, MemoryError):
            raise
        except SystemExit as error:
            raise ValueError(
                "it is not a file of VTK that can be read: save it as .vtu, in Gmsh as .msh"
            ) from error
        except Exception as error:  # meshio passes errors of its parsers on
            raise ValueError(
                f"it is not a file of VTK that can be read ({one_line(error)}): if ParaView reads "
                "it, save it as .vtu, compressed by ZLib or not at all"
            ) from error


def _add_data(
    content: Content,
    key: str,
    blocks: list[tuple[str, Integers]],
    parts: list[Integers],
) -> None:
    """Add groups from whole numbers of cells.

    Ones among zeros are the cells of the group of that name, else every value is a group.  meshio
    joins the names of sets by "-", and numbers them from zero.
    """
    names = _names_of_values(key, np.concatenate(parts))
    for (kind, members), part in zip(blocks, parts):
        for value, name in names.items():
            found = members[part == value]
            if len(found):
                content.add(name, kind, found)


def _names_of_values(key: str, values: Integers) -> dict[int, str]:
    """Return the names of groups by the values of their cells."""
    # Zeros and ones are a mask, but for the names and the 64 bits that meshio gives to joined sets.
    low = int(values.min(initial=0))
    high = int(values.max(initial=0))
    joined = key.split("-")
    if low == 0 and high == 1 and key not in _REGIONS:
        if len(joined) == 1 or values.dtype.itemsize < 8:
            return {1: key}
        warn(
            f"the cell data '{key}' of zeros and ones is read as the sets {joined[0]!r} and "
            f"{joined[1]!r}, which meshio joins so: save a mask of that name as integers of 8 bits"
        )
    # Many values are no groups.
    different = np.unique(values).tolist()
    if len(different) > _MOST:
        return {}
    # Names joined by a hyphen are numbered in their order.
    if len(joined) > 1 and set(different) <= set(range(-1, len(joined))):
        return dict(enumerate(joined))
    return {value: f"{key} {value}" for value in different if value >= 0}


def write(content: Content, path: str) -> None:
    """Write cells, and for every name data of cells with ones among zeros."""
    import meshio

    check_names(content, "", "files of VTK")
    blocks = list(content.cells.items())
    data: dict[str, list[Integers]] = {}
    for name, group in content.groups.items():
        # meshio writes names as they are, which "&" and '"' in XML must not be
        key = escape(name)
        data[key] = []
        for kind, cells in blocks:
            mask = np.zeros(len(cells), dtype=np.int8)
            mask[group.get(kind, np.zeros(0, int))] = 1
            data[key].append(mask)
    meshio.Mesh(content.points, blocks, cell_data=data).write(path, file_format="vtu")
