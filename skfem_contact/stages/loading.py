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

#: Facets that are tried first as the one that another faces, and how far off one that touches may lie, over its size:
#: the rise of an arc of 16 chords is .05 of a chord.
_NEAR, _OFF = 16, 0.1


def as_pressure(water: Any, mesh: Mesh, unit_weight: float | None) -> Any:
    """Return water as a seepage, a function of the coordinates, pressures at the vertices, or such by region."""
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
        raise ValueError("a water level needs the unit weight of water: give the model `water_unit_weight`")
    return hydrostatic(water, unit_weight=unit_weight)


def water_at_rest(solids: Mapping[str, Any], water: Any, unit_weight: float | None) -> ndarray:
    """Return the load of water in the pores and on all boundaries of active bodies, (N,).

    The pressure acts on every facet that bounds the active elements: free surfaces, excavated faces, both sides of
    contacts. Levels by region apply to the elements of these regions, a seepage to the elements of its basis: others
    are dry. A facet of a body without pores takes the head of the nearest facet of a porous one.
    """
    first = next(iter(solids.values()))
    mesh, axisymmetric = first.basis.mesh, first.coordinates == "axisymmetric"
    pressure = as_pressure(water, mesh, unit_weight)
    total = np.zeros(first.basis.N)
    for form in solids.values():
        if form.porous:
            total += pore_load(form.basis, _in_elements(form.basis, pressure, form.elements), axisymmetric)
    outside = FacetBasis(mesh, first.basis.elem, facets=_bounding(mesh, solids))
    owner, faced = np.asarray(outside.tind), None
    if isinstance(pressure, Mapping) or hasattr(pressure, "pressure_at"):
        faced = _faced(outside, np.concatenate([f.elements for f in solids.values() if f.porous]))
        owner = owner[faced]
    return total + face_load(outside, _in_elements(outside, pressure, owner, faced), axisymmetric)


def _bounding(mesh: Mesh, solids: Mapping[str, Any]) -> OrientedBoundary:
    """Return the facets that bound the elements of some bodies, seen from these elements."""
    active = np.zeros(mesh.nelements, bool)
    for form in solids.values():
        active[form.elements] = True
    first, second = active[mesh.f2t[0]], active[mesh.f2t[1]] & (mesh.f2t[1] >= 0)
    facets = np.flatnonzero(first != second)
    return OrientedBoundary(facets, second[facets].astype(int))


def _faced(outside: FacetBasis, porous: ndarray) -> ndarray:
    """Return for each facet itself where its element is porous, else the nearest porous facet that it faces.

    Ground on the other side of a wall is not faced: it lies behind, or its normal has the same direction.
    """
    middle, normal = (np.asarray(values).mean(axis=2).T for values in (outside.global_coordinates(), outside.normals))
    wet = np.flatnonzero(np.isin(outside.tind, porous))
    faced, size = np.arange(len(middle)), outside.dx.sum(axis=1) ** (1.0 / (outside.mesh.dim() - 1))
    if len(wet):
        tree = cKDTree(middle[wet])
        for facet in np.setdiff1d(faced, wet):
            for n in (min(_NEAR, len(wet)), len(wet)):
                near = wet[np.atleast_1d(tree.query(middle[facet], n)[1])]
                distance = middle[near] - middle[facet]
                ahead, turned = distance @ normal[facet], normal[near] @ normal[facet]
                apart = np.linalg.norm(distance, axis=1)
                close = apart < 0.495 * (size[facet] + size[near])
                touching = close & (turned < -0.5) & (abs(ahead) < _OFF * size[facet])
                facing = touching | ((turned < 0.5) & (ahead > _OFF**2 * apart))
                if facing.any():
                    faced[facet] = near[facing.argmax()]
                    break
    return faced


def _in_elements(basis: Any, pressure: Any, elements: ndarray, faced: ndarray | None = None) -> ndarray:
    """Return the pressure at the integration points of elements or facets, by the region of given elements.

    A facet above the ground of a seepage, such as a wall's, has the head of the porous facet that it faces.
    """
    x = np.asarray(basis.global_coordinates())
    values = np.zeros(x.shape[1:])
    if hasattr(pressure, "pressure_at"):
        wet = np.isin(elements, elements_of(pressure.basis))
        if wet.any():
            head = None if faced is None else pressure.head_at(x[:, faced[wet]].mean(axis=2))[:, None]
            values[wet] = pressure.pressure_at(x[:, wet], head)
        return values
    if not isinstance(pressure, Mapping):
        return at_points(basis, pressure)
    for name, given in pressure.items():
        here = np.isin(elements, basis.mesh.subdomains[name])
        values[here] = at_points(basis, given)[here]
    return values
