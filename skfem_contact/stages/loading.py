"""Loads of a stage: weights of active bodies and water at rest, beside the loads on top."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np
from numpy import ndarray
from scipy.spatial import cKDTree
from skfem import FacetBasis, Mesh
from skfem.generic_utils import OrientedBoundary

from ..beams.sides import facing, pressure_beside, surroundings
from ..checks import format_point
from ..errors import warn
from ..forms.base import Form
from ..loads import face_load, pore_load
from ..results.at_rest import as_pressure, in_elements

#: Water differs on both sides of a slit where its pressures do by more than this share of the
#: largest one.
_DIFFERS = 0.05
_SUCTION = 1e-6  # share of the largest pressure that is no round-off
_SAME = 1e-6  # distance of facets that coincide, over their size


def water_at_rest(
    solids: Mapping[str, Any], others: Iterable[Form], water: Any, unit_weight: float | None
) -> Iterator[ndarray]:
    """Yield the loads of water in the pores and on all boundaries of active bodies, and on other
    active forms.

    The pressure acts on every facet that bounds the active elements: free surfaces, excavated
    faces, both sides of contacts. Levels by region apply to the elements of these regions, a
    seepage to the elements of its basis: others are dry. A facet of a body without pores, and a
    side of a beam, take the head of the nearest facet of a porous body.
    """
    first = next(iter(solids.values()))
    mesh, axisymmetric = first.basis.mesh, first.coordinates == "axisymmetric"
    pressure = as_pressure(water, mesh, unit_weight)
    for form in solids.values():
        if form.porous:
            inside = in_elements(form.basis, pressure, form.elements)
            if (
                callable(pressure)
                and getattr(pressure, "__self__", None) is None
                and inside.min() < -_SUCTION * np.abs(inside).max()
            ):
                warn(
                    f"the function of the water has pressures down to {inside.min():.3g}: this "
                    f"suction counts as "
                    "strength; return np.maximum(pressure, 0) where it is not meant"
                )
            yield pore_load(form.basis, inside, axisymmetric)
    outside = FacetBasis(mesh, first.basis.elem, facets=_bounding(mesh, solids))
    owner, faced = np.asarray(outside.tind), None
    porous = np.isin(
        owner,
        np.concatenate([f.elements for f in solids.values() if f.porous] or [np.zeros(0, int)]),
    )
    if isinstance(pressure, Mapping) or hasattr(pressure, "pressure_at"):
        faced = facing(surroundings(outside), porous)
        owner = owner[faced]
    pressing = np.maximum(
        in_elements(outside, pressure, owner, faced), 0.0
    )  # beside suction there is air outside
    beams = [np.zeros((0, mesh.dim()))]
    yield face_load(outside, pressing, axisymmetric)

    def beside(*sides: ndarray) -> ndarray:
        beams.append(sides[0])
        return np.maximum(pressure_beside(outside, porous, pressure, sides), 0.0)

    yield from (load for form in others if (load := form.water_load(beside)) is not None)
    if not callable(pressure):
        _check_slits(outside, porous, pressing.mean(axis=1), np.concatenate(beams))


def _check_slits(outside: FacetBasis, porous: ndarray, pressure: ndarray, beams: ndarray) -> None:
    """Warn where water presses differently on both sides of a slit without a beam: nothing takes up
    the difference.
    """
    middle, normal, size = (of[porous] for of in surroundings(outside))
    pairs = cKDTree(middle).query_pairs(_SAME * size.min(initial=np.inf), output_type="ndarray")
    one, other = pairs.T
    own, opposite = pressure[porous][one], pressure[porous][other]
    apart = cKDTree(beams).query(middle[one])[0] if len(beams) else np.full(len(one), np.inf)
    lost = np.abs(own - opposite) * (
        (np.einsum("nc,nc->n", normal[one], normal[other]) < 0.0) & (apart > size[one])
    )
    if len(lost) and lost.max() > _DIFFERS * pressure.max():
        k = lost.argmax()
        warn(
            f"water presses with {own[k]:.3g} on one side of the slit at "
            f"{format_point(middle[one[k]])} and with "
            f"{opposite[k]:.3g} on the other; no beam lies there to resist the difference: it is "
            f"lost unless a "
            "Beam in the slit or a traction represents it"
        )


def _bounding(mesh: Mesh, solids: Mapping[str, Any]) -> OrientedBoundary:
    """Return the facets that bound the elements of some bodies, seen from these elements."""
    active = np.zeros(mesh.nelements, bool)
    for form in solids.values():
        active[form.elements] = True
    first, second = active[mesh.f2t[0]], active[mesh.f2t[1]] & (mesh.f2t[1] >= 0)
    facets = np.flatnonzero(first != second)
    return OrientedBoundary(facets, second[facets].astype(int))
