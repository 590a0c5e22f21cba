"""Results for other programs: meshes for VTU files and pyvista, and data frames."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy import ndarray

from ..forms.solid import SolidForm
from ..layout import elements_in
from ..mesh import bodies as joined_bodies
from ..mesh.kinds import BY_NODES, HEXAHEDRON, oriented
from .fields import basis_of, has_excess, has_solids, nodal_field, quantities, region_field, solids
from .files import StageData
from .patch_recovery import RegionMesh, recovered_together, region_mesh, within_points
from .strength import plastic_strain, total_stress
from .tractions import interfaces

if TYPE_CHECKING:
    import meshio


def frame(stage: StageData) -> Any:
    """Return fields at the nodes of solids as a pandas data frame.

    ``DataFrame(vars(stage.tractions(name)))`` holds tractions.
    """
    import pandas

    basis = basis_of(stage)
    dim = basis.mesh.dim()
    columns = dict(zip("xyz", basis.doflocs[:, 0::dim]))
    for name in quantities(stage):
        if name != "pore" or has_excess(stage):
            columns[name] = nodal_field(stage, name)
    nodes = pandas.RangeIndex(basis.N // dim, name="node")
    table = pandas.DataFrame(columns, index=nodes)
    return table[np.isfinite(table["u"])]


def grid(stage: StageData, known: Mapping[str, SolidForm] | None = None) -> meshio.Mesh:
    """Return the solids, the facets of contact pairs, beams and shells of a stage as a mesh.

    Solids are divided into regions, which are numbered through all known solids, by default through
    the solids of the stage.
    """
    import meshio

    if not has_solids(stage):
        return _structures_alone(stage)

    # Add the solids with fields at nodes, and means over elements.
    bodies = solids(stage)
    basis = basis_of(stage)
    dim = basis.mesh.dim()
    mesh = region_mesh(*bodies.values())
    points = _in_space(basis.doflocs[:, dim * mesh.nodes].T, 3)
    kind, cells = vtk_cells(mesh.cells, dim)
    blocks = [(kind, oriented(points, cells, kind))]
    numbers = _numbers_of_regions(bodies, known or bodies)
    parts = [_of_elements(stage, bodies) | {"region": numbers[mesh.region]}]

    # Add the facets of contact pairs, whose nodes are on both sides of borders of regions.
    point = np.full(mesh.nodes.max() + 1, -1)
    point[mesh.nodes] = np.arange(len(mesh.nodes))
    for interface in interfaces(stage).values():
        blocks.append(vtk_cells(point[interface.facets], dim - 1))
        parts.append(interface.on_facets())

    # Add beams and shells, and fill up missing data of cells.
    point_data = _at_nodes(stage, bodies, mesh)
    points, point_data = _with_structures(stage, points, point_data, blocks)
    parts += [{}] * (len(blocks) - len(parts))
    sizes = [len(cells) for _, cells in blocks]
    return meshio.Mesh(points, blocks, point_data, _filled(parts, sizes))


def _structures_alone(stage: StageData) -> meshio.Mesh:
    """Return beams and shells of a stage without solids; refuse one that has neither."""
    import meshio

    blocks: list[tuple[str, ndarray]] = []
    points, data = _with_structures(stage, np.zeros((0, 3)), {}, blocks)
    if not blocks:
        raise ValueError(
            f"there are no solids, beams or shells in stage '{stage.name}', which holds "
            f"{list(stage.states)}"
        )
    return meshio.Mesh(points, blocks, data)


def _at_nodes(
    stage: StageData, bodies: Mapping[str, SolidForm], mesh: RegionMesh
) -> dict[str, ndarray]:
    """Return displacements, stresses, strains and excess pore pressures at nodes of the regions."""
    basis = basis_of(stage)
    u = stage.x[: basis.N].reshape(-1, basis.mesh.dim())
    stress = []
    strain = []
    plastic = []
    for name, form in bodies.items():
        state = stage.states[name]
        balanced = form.kinematics != "finite"  # forces are of the undeformed body
        yielded = plastic_strain(form, state)[None]
        fields = (total_stress(form, state), form.total_strain(state), yielded)
        fitted = recovered_together(form, *fields, balanced=balanced)
        stress.append(_in_space(fitted[0].T, 6))
        strain.append(_in_space(fitted[1].T, 6))
        plastic.append(within_points(fitted[2], yielded, region_mesh(form))[0])
    # Files hold vectors of three components, tensors of six.
    found = {
        "displacement": _in_space(u[mesh.nodes], 3),
        "stress": np.concatenate(stress),
        "strain": np.concatenate(strain),
        "plastic_strain": np.concatenate(plastic),
    }
    if has_excess(stage):
        found["pore_pressure"] = region_field(stage, "pore", None, None)
    return found


def _numbers_of_regions(bodies: Mapping[str, SolidForm], known: Mapping[str, SolidForm]) -> ndarray:
    """Return the numbers of the regions of solids, counted through all known solids."""
    first = {}
    n = 0
    for name, form in known.items():
        first[name] = n
        n += len(form.regions)
    parts = [first[name] + np.arange(len(form.regions)) for name, form in bodies.items()]
    return np.concatenate(parts)


def _with_structures(
    stage: StageData,
    points: ndarray,
    data: dict[str, ndarray],
    blocks: list[tuple[str, ndarray]],
) -> tuple[ndarray, dict[str, ndarray]]:
    """Return points and data, beams and shells at the end; add a block of each."""
    for name in stage.states:
        outputs = stage.outputs(name)
        # Their cells have three points of their own: ends and middle of a beam, or corners.
        for kind, given in (("line3", outputs.points), ("triangle", outputs.triangles)):
            if given is None:
                continue
            own, values = given
            own = _in_space(own, 3)
            values = values | {"displacement": _in_space(values["displacement"], 3)}
            cells = np.arange(len(own)).reshape(-1, 3)
            blocks.append((kind, len(points) + cells))
            # Values that only one of both has are gaps at the others.
            filled = _filled([data, values], [len(points), len(own)])
            data = {key: np.concatenate(parts) for key, parts in filled.items()}
            points = np.concatenate((points, own))
    return points, data


def _filled(parts: Sequence[Mapping[str, ndarray]], sizes: Sequence[int]) -> dict[str, Any]:
    """Return the data of all parts by their keys: NaN, or -1 of integers, where a part has none."""
    known: dict[str, ndarray] = {}
    for part in parts:
        known |= part
    filled: dict[str, Any] = {}
    for key, like in known.items():
        nothing = np.nan
        if like.dtype.kind == "i":
            nothing = -1
        filled[key] = []
        for part, n in zip(parts, sizes):
            missing = np.full((n, *like.shape[1:]), nothing)
            filled[key].append(part.get(key, missing))
    return filled


def series(file: str | Path, stages: Sequence[StageData]) -> list[Path]:
    """Write a ``.pvd`` file and a ``.vtu`` file for each stage, and return their names."""
    file = Path(file)
    if not file.name:
        raise ValueError("the file of a series needs a name, such as 'result.pvd'")
    # Write the meshes; regions have the same numbers in all of them.
    known: dict[str, SolidForm] = {}
    for stage in stages:
        if has_solids(stage):
            known |= solids(stage)
    paths = [file.with_name(f"{file.stem}_{number}.vtu") for number in range(len(stages))]
    for path, stage in zip(paths, stages, strict=True):
        grid(stage, known).write(path, file_format="vtu")

    # Write the series over the times of the stages, or over their numbers.
    times = [stage.time for stage in stages]
    if not any(times):
        times = list(range(len(stages)))
    lines = ['<?xml version="1.0"?>', '<VTKFile type="Collection" version="0.1">', "  <Collection>"]
    for time, stage, path in zip(times, stages, paths, strict=True):
        name = escape(stage.name)
        part = escape(path.name)
        lines.append(f'    <DataSet timestep="{time:g}" name="{name}" file="{part}"/>')
    lines += ["  </Collection>", "</VTKFile>", ""]
    file.write_text("\n".join(lines), encoding="utf-8")
    return [file, *paths]


def vtk_cells(cells: ndarray, dim: int) -> tuple[str, ndarray]:
    """Return the kind of elements in meshio's words, and their nodes in VTK's order."""
    kind = BY_NODES[dim, cells.shape[1]]
    if kind.startswith("hexahedron"):  # the only elements whose nodes have another order
        cells = cells[:, HEXAHEDRON[: cells.shape[1]]]
    return kind, cells


def _in_space(values: ndarray, n: int) -> ndarray:
    """Pad plane vectors or tensors to n components: xx, yy, zz, xy, yz, xz."""
    return np.pad(values, ((0, 0), (0, n - values.shape[1])))


def _of_elements(stage: StageData, bodies: Mapping[str, SolidForm]) -> dict[str, ndarray]:
    """Return means over the elements of solids, and the numbers of their bodies."""
    # Take means over the elements, weighted by the volumes of their points.
    stress = []
    plastic = []
    for name, form in bodies.items():
        state = stage.states[name]
        share = form.weight / form.weight.sum(axis=1)[:, None]
        mean = np.einsum("ceq,eq->ec", total_stress(form, state), share)
        stress.append(_in_space(mean, 6))
        plastic.append(np.einsum("eq,eq->e", plastic_strain(form, state), share))

    # Number the bodies of the mesh.
    mesh = basis_of(stage).mesh
    body = np.empty(mesh.nelements, dtype=int)
    for number, members in enumerate(joined_bodies(mesh).values()):
        body[members] = number
    elements = elements_in(bodies.values())
    return {
        "stress": np.concatenate(stress),
        "plastic_strain": np.concatenate(plastic),
        "body": body[elements],
    }
