"""Results for other programs: meshes for VTU files and pyvista, and data frames."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr

import meshio
import numpy as np
from numpy import ndarray
from skfem.io.meshio import HEX_MAPPING

from ..forms.solid import SolidForm
from ..mesh import bodies
from .fields import basis_of, has_excess, nodal_field, quantities, solids
from .files import StageData
from .patch_recovery import recovered, region_mesh
from .strength import plastic_strain, total_stress
from .tractions import interfaces

#: meshio's names of cells by the numbers of dimensions and of nodes.
_CELLS = {
    (2, 3): "triangle",
    (2, 4): "quad",
    (2, 6): "triangle6",
    (2, 8): "quad8",
    (2, 9): "quad9",
    (3, 4): "tetra",
    (3, 10): "tetra10",
    (3, 8): "hexahedron",
    (3, 20): "hexahedron20",
    (3, 27): "hexahedron27",
    (1, 2): "line",
    (1, 3): "line3",
}


def frame(stage: StageData) -> Any:
    """Return coordinates and all fields at the nodes of solids as a pandas data frame."""
    import pandas

    basis = basis_of(stage)
    dim = basis.mesh.dim()
    coordinates = dict(zip("xyz", basis.doflocs[:, 0::dim]))
    names = [name for name in quantities(stage) if name != "pore" or has_excess(stage)]
    values = {name: nodal_field(stage, name) for name in names}
    table = pandas.DataFrame(
        coordinates | values, index=pandas.RangeIndex(basis.N // dim, name="node")
    )
    return table[np.isfinite(table["u"])]


def grid(stage: StageData, known: Mapping[str, SolidForm] | None = None) -> meshio.Mesh:
    """Return the solids of a stage, region by region, the facets of its contact pairs and its beams
    as a mesh.

    Regions are numbered through all known solids, by default those of the stage.
    """
    there = solids(stage)
    basis, mesh = basis_of(stage), region_mesh(*there.values())
    dim = basis.mesh.dim()
    data = [(form, stage.states[name]) for name, form in there.items()]
    point_data = {
        "displacement": _in_space(stage.x[: basis.N].reshape(-1, dim)[mesh.nodes], 3),
        "stress": np.concatenate(
            [_in_space(recovered(f, total_stress(f, s), balanced=True).T, 6) for f, s in data]
        ),
        "strain": np.concatenate([_in_space(recovered(f, s.strain).T, 6) for f, s in data]),
        "plastic_strain": np.concatenate(
            [recovered(f, plastic_strain(f, s)[None], limited=True)[0] for f, s in data]
        ),
    }
    blocks = [vtk_cells(mesh.cells, dim)]
    known = known or there
    first = dict(zip(known, np.cumsum([0] + [len(form.regions) for form in known.values()])))
    regions = np.concatenate(
        [first[name] + np.arange(len(form.regions)) for name, form in there.items()]
    )
    parts = [_of_elements(data) | {"region": regions[mesh.region]}]
    point = np.full(mesh.nodes.max() + 1, -1)
    point[mesh.nodes] = np.arange(len(mesh.nodes))
    for interface in interfaces(stage).values():
        blocks.append(vtk_cells(point[interface.facets], dim - 1))
        parts.append(interface.on_facets())
    points, point_data = _with_beams(
        stage, _in_space(basis.doflocs[:, dim * mesh.nodes].T, 3), point_data, blocks
    )
    parts += [{}] * (len(blocks) - len(parts))
    kinds = {key: values for part in parts for key, values in part.items()}
    cell_data = {
        key: [part.get(key, _nothing(like, len(cells))) for part, (_, cells) in zip(parts, blocks)]
        for key, like in kinds.items()
    }
    return meshio.Mesh(points, blocks, point_data, cell_data)


def _with_beams(
    stage: StageData, points: ndarray, data: dict[str, ndarray], blocks: list[tuple[str, ndarray]]
) -> tuple[ndarray, dict[str, ndarray]]:
    """Return points and their data with those of beams behind them, whose elements become a block
    each.
    """
    for name, state in stage.states.items():
        if (along := stage.forms[name].line_points(stage.x, state)) is not None:
            where, new = (
                _in_space(along[0], 3),
                {**along[1], "displacement": _in_space(along[1]["displacement"], 3)},
            )
            blocks.append(("line3", len(points) + np.arange(len(where)).reshape(-1, 3)))
            both = (data, len(points)), (new, len(where))
            data = {
                key: np.concatenate([part.get(key, _nothing(like, n)) for part, n in both])
                for key, like in {**data, **new}.items()
            }
            points = np.concatenate((points, where))
    return points, data


def series(file: str | Path, stages: Sequence[StageData]) -> list[Path]:
    """Write a ``.pvd`` file and a ``.vtu`` file for each stage beside it, and return their
    names.
    """
    file = Path(file)
    paths = [file.with_name(f"{file.stem}_{number}.vtu") for number in range(len(stages))]
    known = {name: form for stage in stages for name, form in solids(stage).items()}
    for path, stage in zip(paths, stages, strict=True):
        grid(stage, known).write(path, file_format="vtu")
    times = (
        [stage.time for stage in stages]
        if any(stage.time for stage in stages)
        else range(len(stages))
    )
    lines = [
        f'    <DataSet timestep="{time:g}" name={quoteattr(stage.name)} '
        f"file={quoteattr(path.name)}/>"
        for time, stage, path in zip(times, stages, paths, strict=True)
    ]
    file.write_text(
        "\n".join(
            [
                '<?xml version="1.0"?>',
                '<VTKFile type="Collection" version="0.1">',
                "  <Collection>",
                *lines,
                "  </Collection>",
                "</VTKFile>",
                "",
            ]
        ),
        encoding="utf-8",
    )
    return [file, *paths]


def vtk_cells(cells: ndarray, dim: int) -> tuple[str, ndarray]:
    """Return the kind of elements in the words of meshio and VTK, and their nodes in VTK's
    order.
    """
    kind = _CELLS[dim, cells.shape[1]]
    # hexahedra alone have their nodes in another order
    return kind, cells[:, HEX_MAPPING[: cells.shape[1]]] if kind.startswith("hexahedron") else cells


def _in_space(values: ndarray, n: int) -> ndarray:
    """Pad plane vectors or tensors to n components: xx, yy, zz, xy, yz, xz."""
    return np.pad(values, ((0, 0), (0, n - values.shape[1])))


def _of_elements(data: list[tuple[SolidForm, Any]]) -> dict[str, ndarray]:
    """Return means over the elements of solids, and the numbers of their bodies."""
    stress, plastic = [], []
    for form, state in data:
        share = form.weight / form.weight.sum(axis=1)[:, None]
        stress.append(_in_space(np.einsum("ceq,eq->ec", total_stress(form, state), share), 6))
        plastic.append(np.einsum("eq,eq->e", plastic_strain(form, state), share))
    mesh = data[0][0].basis.mesh
    body = np.empty(mesh.nelements, dtype=int)
    for number, members in enumerate(bodies(mesh).values()):
        body[members] = number
    elements = np.concatenate([form.elements for form, _ in data])
    return {
        "stress": np.concatenate(stress),
        "plastic_strain": np.concatenate(plastic),
        "body": body[elements],
    }


def _nothing(like: ndarray, n: int) -> ndarray:
    """Return values of n cells without data of a kind."""
    return np.full((n, *like.shape[1:]), -1 if like.dtype.kind == "i" else np.nan)
