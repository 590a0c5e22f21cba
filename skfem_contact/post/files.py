"""Results for other programs: VTU files and their series, pyvista's grids, data frames."""
from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np

from ..stages.result import Result, StageResult
from .fields import has_excess, nodal_field, quantities, solids_there
from .grids import grid_of


def export_vtu(file: str | Path, forms: Mapping[str, Any], step: StageResult) -> None:
    """Write the solids and the contact of a stage to a ``.vtu`` file.

    Points carry the ``displacement``, the recovered ``stress`` and ``strain`` (xx, yy, zz, xy, yz, xz; engineering
    shear) and the equivalent ``plastic_strain``; regions share no points, so that nothing is averaged between them.
    Cells carry means of ``stress`` and ``plastic_strain``, the number of the ``body``, in the order of
    :func:`bodies`, and of the ``region``, counted through the materials of all solids. The slave's facets of every
    contact pair are line cells with ``pressure``, ``shear``, ``gap``, ``slip`` and ``status``. Quadratic elements
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
    import meshio

    grid = grid_of(forms, step)
    meshio.Mesh(grid.points, grid.cells, point_data=grid.point_data, cell_data=grid.cell_data).write(
        file, file_format="vtu")


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
    import meshio
    import pyvista

    grid = grid_of(forms, step)
    return pyvista.from_meshio(meshio.Mesh(grid.points, grid.cells, point_data=grid.point_data,
                                           cell_data=grid.cell_data))


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
