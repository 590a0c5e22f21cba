"""Files of VTK, .vtu and .vtk, through meshio; names are data of cells."""

from __future__ import annotations

import contextlib
import io
from typing import Any

import numpy as np

from ..content import Content, check_names
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
        known = content.cells.get(block.type)
        first = 0 if known is None else len(known)
        cells = np.asarray(block.data, dtype=int)
        content.cells[block.type] = cells if known is None else np.concatenate((known, cells))
        blocks.append((block.type, first + np.arange(len(cells))))
    # Read groups from data of cells.
    encoded = {}
    for key, parts in file.cell_data.items():
        if key.startswith("skfem:"):
            encoded[key] = np.concatenate(parts).astype(int)
        elif all(part.ndim == 1 and part.dtype.kind in "iub" for part in parts):
            _add_data(content, key, blocks, parts)
    add_encoded(content, encoded)
    return content


def _meshio(path: str) -> Any:
    """Read a file with meshio, whose messages and exits become one error."""
    import meshio

    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        try:
            return meshio.read(path)
        except (FileNotFoundError, MemoryError):
            raise
        except SystemExit as error:
            raise ValueError("it is not a file of VTK that can be read") from error
        except Exception as error:  # meshio passes errors of its parsers on
            text = " ".join(str(error).split()) or type(error).__name__
            raise ValueError(f"it is not a file of VTK that can be read: {text}") from error


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
    # Two values 0 and 1 are a mask, many values are no groups.
    low = min((int(part.min(initial=0)) for part in parts), default=0)
    high = max((int(part.max(initial=0)) for part in parts), default=0)
    masks = low == 0 and high == 1 and key not in _REGIONS
    values = np.arange(2) if masks else np.unique(np.concatenate(parts).astype(int))
    if len(values) > _MOST:
        return
    # Names joined by a hyphen are numbered in their order.
    joined = key.split("-")
    numbered = len(joined) > 1 and set(values.tolist()) <= set(range(-1, len(joined)))
    # Choose the cells of each value.
    for (kind, members), part in zip(blocks, parts):
        if masks:
            chosen = {key: part == 1}
        elif numbered:
            chosen = {name: part == k for k, name in enumerate(joined)}
        else:
            chosen = {f"{key} {value}": part == value for value in values if value >= 0}
        for name, where in chosen.items():
            if where.any():
                content.add(name, kind, members[where])


def write(content: Content, path: str) -> None:
    """Write cells, and for every name data of cells with ones among zeros."""
    import meshio

    check_names(content, "", "files of VTK")
    blocks = list(content.cells.items())
    data: dict[str, list[Integers]] = {}
    for name, group in content.groups.items():
        data[name] = []
        for kind, cells in blocks:
            mask = np.zeros(len(cells), dtype=np.int8)
            mask[group.get(kind, np.zeros(0, int))] = 1
            data[name].append(mask)
    meshio.Mesh(content.points, blocks, cell_data=data).write(path, file_format="vtu")
