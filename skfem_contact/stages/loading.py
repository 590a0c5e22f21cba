"""Loads of a stage: weights of active bodies and water at rest, beside the loads on top."""
from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy import ndarray
from scipy.spatial import cKDTree
from skfem import FacetBasis, Mesh
from skfem.generic_utils import OrientedBoundary

from ..checks import look_up
from ..layout import elements_of
from ..loads import at_points, face_load, hydrostatic, pore_load


def as_pressure(water: Any, mesh: Mesh, unit_weight: float | None) -> Any:
    """Return water as a seepage, a function of the coordinates, pressures at the vertices, or such by region."""
    if isinstance(water, Mapping):
        for name in water:
            look_up(name, mesh.subdomains or {}, "subdomain")
        given = {name: getattr(level, "pressure", level) for name, level in water.items()}
        return {name: as_pressure(level, mesh, unit_weight) for name, level in given.items()}
    if hasattr(water, "pressure_at") or callable(water) or np.shape(water) == (mesh.nvertices,):
        return water
    if unit_weight is None:
        raise ValueError("a water level needs the unit weight of water: give the model `water_unit_weight`")
    return hydrostatic(water, unit_weight=unit_weight)


def water_at_rest(solids: Mapping[str, Any], water: Any, unit_weight: float | None) -> ndarray:
    """Return the load of water in the pores and on all boundaries of active bodies, (N,).

    The pressure acts on every facet that bounds the active elements: free surfaces, excavated faces, both sides of
    contacts. Levels by region apply to the elements of these regions, a seepage to the elements of its basis: others
    are dry. A facet of a body without pores takes the pressure of the nearest facet of a porous one.
    """
    first = next(iter(solids.values()))
    mesh, axisymmetric = first.basis.mesh, first.coordinates == "axisymmetric"
    pressure = as_pressure(water, mesh, unit_weight)
    total = np.zeros(first.basis.N)
    for form in solids.values():
        if form.porous:
            total += pore_load(form.basis, _in_elements(form.basis, pressure, form.elements), axisymmetric)
    outside = FacetBasis(mesh, first.basis.elem, facets=_bounding(mesh, solids))
    owner = np.asarray(outside.tind)
    if isinstance(pressure, Mapping) or hasattr(pressure, "pressure_at"):
        owner = _porous_owner(outside, owner, np.concatenate([f.elements for f in solids.values() if f.porous]))
    return total + face_load(outside, _in_elements(outside, pressure, owner), axisymmetric)


def _bounding(mesh: Mesh, solids: Mapping[str, Any]) -> OrientedBoundary:
    """Return the facets that bound the elements of some bodies, seen from these elements."""
    active = np.zeros(mesh.nelements, bool)
    for form in solids.values():
        active[form.elements] = True
    first, second = active[mesh.f2t[0]], active[mesh.f2t[1]] & (mesh.f2t[1] >= 0)
    facets = np.flatnonzero(first != second)
    return OrientedBoundary(facets, second[facets].astype(int))


def _porous_owner(outside: FacetBasis, owner: ndarray, porous: ndarray) -> ndarray:
    """Return for each facet its own element where that is porous, else that of the nearest porous facet."""
    middle = np.asarray(outside.global_coordinates()).mean(axis=2).T
    wet = np.isin(owner, porous)
    nearest = cKDTree(middle[wet]).query(middle)[1]
    return np.where(wet, owner, owner[wet][nearest])


def _in_elements(basis: Any, pressure: Any, elements: ndarray) -> ndarray:
    """Return the pressure at the integration points of elements or facets, by the region of given elements."""
    x = np.asarray(basis.global_coordinates())
    values = np.zeros(x.shape[1:])
    if hasattr(pressure, "pressure_at"):
        wet = np.isin(elements, elements_of(pressure.basis))
        if wet.any():
            values[wet] = pressure.pressure_at(x[:, wet])
        return values
    if not isinstance(pressure, Mapping):
        return at_points(basis, pressure)
    for name, given in pressure.items():
        here = np.isin(elements, basis.mesh.subdomains[name])
        values[here] = at_points(basis, given)[here]
    return values
