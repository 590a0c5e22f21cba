"""Solids and contact of a stage as the points, cells and data that VTK knows."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy import ndarray

from ..mesh.join import bodies
from ..solid import SolidForm
from ..stages.result import StageResult
from .fields import plastic_strain, solids, solids_there
from .interface import Interface, interfaces
from .recovery import RegionField, recovered, recovered_stress

#: meshio's names of cells by the numbers of dimensions and of nodes.
_CELLS = {(2, 3): "triangle", (2, 4): "quad", (2, 6): "triangle6", (2, 8): "quad8", (2, 9): "quad9",
          (3, 4): "tetra", (3, 10): "tetra10", (3, 8): "hexahedron", (3, 20): "hexahedron20", (3, 27): "hexahedron27",
          (1, 2): "line", (1, 3): "line3"}


class Grid(NamedTuple):
    """What a VTU file holds.

    Attributes
    ----------
    points
        Places, (n, 3); regions share none.
    cells
        Kind, in meshio's words, and points of the cells of each kind.
    point_data, cell_data
        Arrays (n, ...), and such arrays for every kind of cells.
    """

    points: ndarray
    cells: list[tuple[str, ndarray]]
    point_data: dict[str, ndarray]
    cell_data: dict[str, list[ndarray]]


def grid_of(forms: Mapping[str, Any], step: StageResult) -> Grid:
    """The solids of a stage, region by region, and the facets of its contact pairs."""
    given = solids(forms)  # their regions have the same numbers in all stages
    first = dict(zip(given, np.cumsum([0] + [len(form.regions) for form in given.values()])))
    found = solids_there(forms, step)
    basis = next(iter(found.values())).basis
    dim = basis.mesh.dim()
    u = step.x[:basis.N].reshape(-1, dim)
    parts, data, cell_data = [], [], []
    for name, form in found.items():
        fields = recovered_stress(form, step.states[name].stress)
        parts += fields
        data += _point_data(form, step.states[name], fields)
        cell_data += _cell_data(form, step.states[name], int(first[name]), fields)
    nodes, kind, cells = cells_of(parts, dim)
    point_data = {"displacement": _in_space(u[nodes])} | _joined(data)
    grid = Grid(_in_space(basis.doflocs[:, dim * nodes].T), [(kind, cells)], point_data,
                {key: [values] for key, values in _joined(cell_data).items()})
    for interface in interfaces(forms, step).values():
        grid = _with_facets(grid, nodes, interface)
    return grid


def cells_of(parts: Sequence[RegionField], dim: int) -> tuple[ndarray, str, ndarray]:
    """Nodes of all regions one after the other, and their cells: meshio's name of the kind, and numbers among these."""
    from skfem.io.meshio import HEX_MAPPING

    nodes = np.concatenate([part.nodes for part in parts])
    offset = np.cumsum([0] + [len(part.nodes) for part in parts])
    cells = np.concatenate([part.cells + start for part, start in zip(parts, offset)])
    kind = _CELLS[dim, cells.shape[1]]
    if kind.startswith("hexahedron"):  # of all others the nodes come in the same order
        cells = cells[:, HEX_MAPPING[:cells.shape[1]]]
    return nodes, kind, cells


def _in_space(values: ndarray) -> ndarray:
    """Vectors (n, dim) with three components."""
    return np.pad(values, ((0, 0), (0, 3 - values.shape[1])))


def _joined(data: list[dict[str, ndarray]]) -> dict[str, ndarray]:
    return {key: np.concatenate([part[key] for part in data]) for key in data[0]}


def _tensor(values: ndarray) -> ndarray:
    """Components (4 or 6, n) as (n, 6): xx, yy, zz, xy, yz, xz."""
    return np.pad(values.T, ((0, 0), (0, 6 - len(values))))


def _point_data(form: SolidForm, state: Any, stresses: list[RegionField]) -> list[dict[str, ndarray]]:
    """Recovered fields at the nodes of every region of a solid."""
    strains = recovered(form, state.strain)
    plastic = recovered(form, plastic_strain(state), limited=True)
    return [{"stress": _tensor(s.values), "strain": _tensor(e.values), "plastic_strain": p.values[0]}
            for s, e, p in zip(stresses, strains, plastic, strict=True)]


def _cell_data(form: SolidForm, state: Any, first: int, fields: list[RegionField]) -> list[dict[str, ndarray]]:
    """Means over the elements of a solid, and the numbers of their body and region."""
    elements = form.elements
    share = form.weight / form.weight.sum(axis=1)[:, None]
    stress = _tensor(np.einsum("ceq,eq->ce", state.stress, share))
    plastic = np.einsum("eq,eq->e", plastic_strain(state)[0], share)
    body = np.empty(form.basis.mesh.nelements, dtype=int)
    for number, members in enumerate(bodies(form.basis.mesh).values()):
        body[members] = number
    return [{"stress": stress[f.elements], "plastic_strain": plastic[f.elements], "body": body[elements][f.elements],
             "region": np.full(len(f.cells), first + number)} for number, f in enumerate(fields)]


def _with_facets(grid: Grid, nodes: ndarray, interface: Interface) -> Grid:
    """The grid with the facets of a contact pair: what they transmit is cell data, and NaN, or -1, elsewhere."""
    point = np.full(nodes.max() + 1, -1)
    point[nodes] = np.arange(len(nodes))
    facets = point[interface.facets]
    new = interface.on_facets()
    cells = [*grid.cells, (_CELLS[1, facets.shape[1]], facets)]
    cell_data = {}
    for key in {**grid.cell_data, **new}:
        old = grid.cell_data.get(key) or [_nothing(new[key], len(c)) for _, c in grid.cells]
        cell_data[key] = [*old, new.get(key, _nothing(old[0], len(facets)))]
    return Grid(grid.points, cells, grid.point_data, cell_data)


def _nothing(like: ndarray, n: int) -> ndarray:
    """Values of cells that have none of a kind."""
    return np.full((n, *like.shape[1:]), -1 if like.dtype.kind == "i" else np.nan)
