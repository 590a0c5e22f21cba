"""Results as VTU files for ParaView and other programs."""
from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy import ndarray

from ..mesh.join import bodies
from ..solid import SolidForm
from ..stages.result import StageResult
from .fields import element_nodes, plastic_strain, solids, solids_there

#: VTK's cells by the numbers of dimensions and of nodes.
_CELLS = {(2, 3): "triangle", (2, 4): "quad", (2, 6): "triangle6", (2, 8): "quad8", (2, 9): "quad9",
          (3, 4): "tetra", (3, 10): "tetra10", (3, 8): "hexahedron", (3, 20): "hexahedron20", (3, 27): "hexahedron27"}


def export_vtu(file: str | Path, forms: Mapping[str, Any], step: StageResult) -> None:
    """Write the solids of a stage to a ``.vtu`` file.

    Points carry the ``displacement``; cells carry the mean ``stress`` (xx, yy, zz, xy, yz, xz), the mean
    equivalent ``plastic_strain``, the number of the ``body``, in the order of :func:`bodies`, and of the
    ``region``, counted through the materials of all solids.  Bodies share no points, quadratic elements stay
    quadratic.

    Parameters
    ----------
    file
        Name of the file.
    forms
        Forms by name; the solids among them that are there in the stage are written.
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
    >>> sorted(mesh.cell_data), mesh.cell_data["stress"][0].round(6)[0, 1].item()
    (['body', 'plastic_strain', 'region', 'stress'], -10.0)
    """
    import meshio
    from skfem.io.meshio import HEX_MAPPING

    given = solids(forms)  # their regions have the same numbers in all stages
    first = dict(zip(given, np.cumsum([0] + [len(form.regions) for form in given.values()])))
    forms = solids_there(forms, step)
    basis = next(iter(forms.values())).basis
    dim = basis.mesh.dim()
    plane = np.zeros((basis.N // dim, 3 - dim))
    points = np.column_stack((basis.doflocs[:, 0::dim].T, plane))
    displacement = np.column_stack((step.x.reshape(-1, dim), plane))
    nodes = np.concatenate([element_nodes(form) for form in forms.values()])
    kind = _CELLS[dim, nodes.shape[1]]
    if kind.startswith("hexahedron"):  # of all others the nodes come in the same order
        nodes = nodes[:, HEX_MAPPING[:nodes.shape[1]]]
    data = [_cell_data(form, step.states[name]) for name, form in forms.items()]
    merged = {key: np.concatenate([d[key] for d in data]) for key in data[0]}
    merged["region"] = np.concatenate([d["region"] + first[name] for d, name in zip(data, forms)])
    used, cells = np.unique(nodes, return_inverse=True)
    meshio.Mesh(points[used], [(kind, cells.reshape(nodes.shape))],
                point_data={"displacement": displacement[used]},
                cell_data={key: [values] for key, values in merged.items()}).write(file, file_format="vtu")


def _cell_data(form: SolidForm, state: Any) -> dict[str, ndarray]:
    """Means over the elements of a solid, and the numbers of their body and region."""
    elements = np.arange(form.basis.mesh.nelements) if form.basis.tind is None else form.basis.tind
    share = form.weight / form.weight.sum(axis=1)[:, None]
    stress = np.zeros((len(elements), 6))
    stress[:, :len(state.stress)] = np.einsum("ceq,eq->ec", state.stress, share)
    body = np.empty(form.basis.mesh.nelements, dtype=int)
    for number, members in enumerate(bodies(form.basis.mesh).values()):
        body[members] = number
    region = np.empty(len(elements), dtype=int)
    for number, part in enumerate(form.regions):
        region[part.elements] = number
    return {"stress": stress, "plastic_strain": np.einsum("eq,eq->e", plastic_strain(state)[0], share),
            "body": body[elements], "region": region}
