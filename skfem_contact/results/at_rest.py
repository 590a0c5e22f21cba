"""Pressure of water at rest, as stages have it: in elements, on facets, and at nodes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy import ndarray
from skfem import CellBasis, Mesh

from ..checks import look_up
from ..forms.solid import SolidForm
from ..layout import elements_of
from ..loads import at_points, hydrostatic
from .patch_recovery import region_mesh


def as_pressure(water: Any, mesh: Mesh, unit_weight: float | None) -> Any:
    """Return water as a seepage, a function of the coordinates, pressures at the vertices, or such
    by region.
    """
    if isinstance(water, str):
        raise ValueError(f"the water of the start is {water}: give the first stage its `water`")
    if isinstance(water, Mapping):
        for name in water:
            look_up(name, mesh.subdomains or {}, "subdomain")
        given = {name: getattr(level, "pressure", level) for name, level in water.items()}
        return {name: as_pressure(level, mesh, unit_weight) for name, level in given.items()}
    if hasattr(water, "pressure_at") or callable(water) or np.shape(water) == (mesh.nvertices,):
        return water
    if unit_weight is None:
        raise ValueError(
            "a water level needs the unit weight of water: give the model `water_unit_weight`"
        )
    return hydrostatic(water, unit_weight=unit_weight)


def in_elements(
    basis: Any, pressure: Any, elements: ndarray, faced: ndarray | None = None
) -> ndarray:
    """Return the pressure at the integration points of elements or facets, by the region of given
    elements.

    A facet above the ground of a seepage, such as a wall's, has the head of the porous facet that
    it faces.
    """
    x = np.asarray(basis.global_coordinates())
    values = np.zeros(x.shape[1:])
    if hasattr(pressure, "pressure_at"):
        wet, head = np.isin(elements, elements_of(pressure.basis)), at_points(basis, pressure.head)
        if faced is not None and (other := wet & (faced != np.arange(len(wet)))).any():
            head[other] = pressure.head_at(x[:, other], head[faced[other]].mean(axis=1)[:, None])
        values[wet] = pressure.pressure_at(x[:, wet], head[wet])
        if faced is None:  # suction in pores; beside them is air
            suction = at_points(basis, np.minimum(np.nan_to_num(pressure.pressure), 0.0))
            values += np.where(wet[:, None] & (values == 0.0), suction, 0.0)
        return values
    if not isinstance(pressure, Mapping):
        return at_points(basis, pressure)
    for name, given in pressure.items():
        here = np.isin(elements, basis.mesh.subdomains[name])
        values[here] = at_points(basis, given)[here]
    return values


def pressure_at_nodes(form: SolidForm, water: Any, unit_weight: float | None) -> ndarray:
    """Return the pressure at the nodes of the :func:`region_mesh` of a solid, zero without pores or
    water.
    """
    basis, (numbers, cells, _) = form.basis, region_mesh(form)
    values, corners = np.zeros(len(numbers)), np.asarray(basis.elem.elem.doflocs).T
    if form.porous and water is not None and water is not False:
        at = CellBasis(
            basis.mesh,
            basis.elem,
            elements=form.elements,
            quadrature=(corners, np.ones(corners.shape[1])),
        )
        values[cells] = in_elements(at, as_pressure(water, basis.mesh, unit_weight), form.elements)
    return values
