"""Results for other programs: VTU files and their series, pyvista's grids, data frames."""
from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr

import meshio
import numpy as np
from numpy import ndarray
from skfem.io.meshio import HEX_MAPPING

from ..forms.solid import SolidForm
from ..mesh.join import bodies
from ..stages.result import Result, StageResult
from .fields import has_excess, nodal_field, quantities, solids, solids_there
from .recovery import recovered, region_mesh
from .strength import plastic_strain
from .tractions import interfaces

#: meshio's names of cells by the numbers of dimensions and of nodes.
_CELLS = {(2, 3): "triangle", (2, 4): "quad", (2, 6): "triangle6", (2, 8): "quad8", (2, 9): "quad9",
          (3, 4): "tetra", (3, 10): "tetra10", (3, 8): "hexahedron", (3, 20): "hexahedron20", (3, 27): "hexahedron27",
          (1, 2): "line", (1, 3): "line3"}


def export_vtu(file: str | Path, forms: Mapping[str, Any], step: StageResult) -> None:
    """Write the solids and the contact of a stage to a ``.vtu`` file.

    Points carry the ``displacement``, the recovered ``stress`` and ``strain`` (xx, yy, zz, xy, yz, xz; engineering
    shear) and the equivalent ``plastic_strain``; regions share no points, so that nothing is averaged between them.
    Cells carry means of ``stress`` and ``plastic_strain``, the number of the ``body``, in the order of
    :func:`bodies`, and of the ``region``, counted through the materials of all solids. The slave's facets of every
    contact pair are cells with ``pressure``, ``shear``, ``gap``, ``slip`` and ``status``. Quadratic elements
    stay quadratic.

    Parameters
    ----------
    file
        Name of the file.
    forms
        Forms by name; those that are there in the stage are written.
    step
        A stage of the result of these forms.

    Raises
    ------
    ValueError
        No solid among the forms is there in the stage.

    Examples
    --------
    >>> import tempfile, meshio
    >>> import numpy as np
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> basis = Basis(MeshQuad().with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    >>> forms = {"block": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.))}
    >>> fixed = np.hstack((basis.get_dofs("bottom").all(), basis.get_dofs({"left", "right"}).all("u^1")))
    >>> result = sc.run(forms, [sc.Stage("weight", sc.weight(basis, 20.))], fixed=fixed)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     sc.export_vtu(folder + "/weight.vtu", forms, result["weight"])
    ...     mesh = meshio.read(folder + "/weight.vtu")
    >>> sorted(mesh.point_data), mesh.cell_data["stress"][0].round(6)[0, 1].item()
    (['displacement', 'plastic_strain', 'strain', 'stress'], -10.0)
    """
    _grid(forms, step).write(file, file_format="vtu")


def export_pvd(file: str | Path, forms: Mapping[str, Any], result: Result) -> list[Path]:
    """Write all stages as a series that ParaView plays: a ``.pvd`` file and a ``.vtu`` file for each stage beside it.

    Parameters
    ----------
    file
        Name of the series, ``"dig.pvd"``; the stages are ``dig_0.vtu``, ``dig_1.vtu``, ...
    forms, result
        Forms by name and the result of their analysis.

    Returns
    -------
    list of Path
        The files that were written, the series first.

    Examples
    --------
    >>> import tempfile
    >>> from skfem_contact.demo import culvert
    >>> import skfem_contact as sc
    >>> model = culvert()
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     [path.name for path in sc.export_pvd(folder + "/culvert.pvd", model.forms, model.result)]
    ['culvert.pvd', 'culvert_0.vtu', 'culvert_1.vtu']
    """
    file = Path(file)
    parts = [file.with_name(f"{file.stem}_{number}.vtu") for number in range(len(result))]
    for part, stage in zip(parts, result, strict=True):
        export_vtu(part, forms, stage)
    lines = [f'    <DataSet timestep="{number}" name={quoteattr(stage.name)} file={quoteattr(part.name)}/>'
             for number, (part, stage) in enumerate(zip(parts, result, strict=True))]
    file.write_text("\n".join(['<?xml version="1.0"?>', '<VTKFile type="Collection" version="0.1">', "  <Collection>",
                               *lines, "  </Collection>", "</VTKFile>", ""]), encoding="utf-8")
    return [file, *parts]


def to_pyvista(forms: Mapping[str, Any], step: StageResult) -> Any:
    """A stage as pyvista's ``UnstructuredGrid``, with the data of :func:`export_vtu`, for all that pyvista can do.

    Parameters
    ----------
    forms
        Forms by name, or one form of them: ``{"ground": forms["ground"]}``.
    step
        A stage of the result of these forms.

    Examples
    --------
    >>> from skfem_contact.demo import culvert
    >>> import skfem_contact as sc
    >>> model = culvert()
    >>> grid = sc.to_pyvista(model.forms, model.result["surcharge"])
    >>> moved = grid.warp_by_vector("displacement", factor=100.)
    >>> grid.point_data["stress"].shape[1], grid.n_cells == len(grid.cell_data["pressure"])
    (6, True)
    """
    import pyvista

    return pyvista.from_meshio(_grid(forms, step))


def to_frame(forms: Mapping[str, Any], step: StageResult) -> Any:
    """All nodal fields of a stage as a pandas data frame: a row for each node that a solid uses.

    Columns are the place, ``x``, ``y`` (and ``z``), and the quantities of :func:`nodal_field`. Tractions, section
    forces and other dataclasses of arrays become one by ``pandas.DataFrame(vars(tractions))``.

    Raises
    ------
    ImportError
        pandas is not installed.

    Examples
    --------
    >>> from skfem_contact.demo import culvert
    >>> import skfem_contact as sc
    >>> model = culvert()
    >>> frame = sc.to_frame(model.forms, model.result["surcharge"])
    >>> list(frame.columns[:5]), len(frame)
    (['x', 'y', 'ux', 'uy', 'u'], 2195)
    """
    import pandas

    found = solids_there(forms, step)
    basis = next(iter(found.values())).basis
    dim = basis.mesh.dim()
    places = dict(zip("xyz", basis.doflocs[:, 0::dim]))
    names = [name for name in quantities(found) if name != "pore" or has_excess(forms, found)]
    fields = {name: nodal_field(forms, step, name) for name in names}
    frame = pandas.DataFrame(places | fields, index=pandas.RangeIndex(basis.N // dim, name="node"))
    return frame[np.isfinite(frame["u"])]


def _grid(forms: Mapping[str, Any], step: StageResult) -> meshio.Mesh:
    """The solids of a stage, region by region, and the facets of its contact pairs."""
    found = solids_there(forms, step)
    basis, mesh = next(iter(found.values())).basis, region_mesh(*found.values())
    dim = basis.mesh.dim()
    data = [(form, step.states[name]) for name, form in found.items()]
    point_data = {
        "displacement": _in_space(step.x[:basis.N].reshape(-1, dim)[mesh.nodes], 3),
        "stress": np.concatenate([_in_space(recovered(f, s.stress, balanced=True).T, 6) for f, s in data]),
        "strain": np.concatenate([_in_space(recovered(f, s.strain).T, 6) for f, s in data]),
        "plastic_strain": np.concatenate([recovered(f, plastic_strain(f, s)[None], limited=True)[0] for f, s in data]),
    }
    blocks = [vtk_cells(mesh.cells, dim)]
    parts = [_of_elements(data) | {"region": _numbers_of_regions(forms, found)[mesh.region]}]
    point = np.full(mesh.nodes.max() + 1, -1)
    point[mesh.nodes] = np.arange(len(mesh.nodes))
    for interface in interfaces(forms, step).values():
        blocks.append(vtk_cells(point[interface.facets], dim - 1))
        parts.append(interface.on_facets())
    kinds = {key: values for part in parts for key, values in part.items()}
    cell_data = {key: [part.get(key, _nothing(like, len(cells))) for part, (_, cells) in zip(parts, blocks)]
                 for key, like in kinds.items()}
    return meshio.Mesh(_in_space(basis.doflocs[:, dim * mesh.nodes].T, 3), blocks, point_data, cell_data)


def vtk_cells(cells: ndarray, dim: int) -> tuple[str, ndarray]:
    """Elements of so many dimensions as meshio and VTK know them: the name of their kind, and their nodes in order."""
    kind = _CELLS[dim, cells.shape[1]]
    # of all others the nodes come in the same order
    return kind, cells[:, HEX_MAPPING[:cells.shape[1]]] if kind.startswith("hexahedron") else cells


def _in_space(values: ndarray, n: int) -> ndarray:
    """Plane vectors or tensors with all n components: xx, yy, zz, xy, yz, xz."""
    return np.pad(values, ((0, 0), (0, n - values.shape[1])))


def _of_elements(data: list[tuple[SolidForm, Any]]) -> dict[str, ndarray]:
    """Means over the elements of solids in their states, and the numbers of their bodies."""
    stress, plastic = [], []
    for form, state in data:
        share = form.weight / form.weight.sum(axis=1)[:, None]
        stress.append(_in_space(np.einsum("ceq,eq->ec", state.stress, share), 6))
        plastic.append(np.einsum("eq,eq->e", plastic_strain(form, state), share))
    mesh = data[0][0].basis.mesh
    body = np.empty(mesh.nelements, dtype=int)
    for number, members in enumerate(bodies(mesh).values()):
        body[members] = number
    elements = np.concatenate([form.elements for form, _ in data])
    return {"stress": np.concatenate(stress), "plastic_strain": np.concatenate(plastic), "body": body[elements]}


def _numbers_of_regions(forms: Mapping[str, Any], there: Mapping[str, SolidForm]) -> ndarray:
    """Numbers of the regions that are there among those of all solids: they are the same in all stages."""
    given = solids(forms)
    first = dict(zip(given, np.cumsum([0] + [len(form.regions) for form in given.values()])))
    return np.concatenate([first[name] + np.arange(len(form.regions)) for name, form in there.items()])


def _nothing(like: ndarray, n: int) -> ndarray:
    """Values of cells that have none of a kind."""
    return np.full((n, *like.shape[1:]), -1 if like.dtype.kind == "i" else np.nan)
