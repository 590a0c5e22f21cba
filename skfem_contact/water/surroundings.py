"""Surroundings of the water: stiffness of the ground, contact, seepage faces, further ground."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import scipy
from numpy import ndarray
from skfem import CellBasis

from ..beams import Beam
from ..checks import format_point
from ..errors import Remark
from ..forms.base import Coordinates, Forms, solids_of
from ..forms.roles import Draining, Touching, having
from ..layout import elements_of, facet_counts

#: Distance of points that coincide, over the size of the mesh.
_ROUND_OFF = 1e-9


class Ground(NamedTuple):
    """Corners of elements, (n_p, n), their largest mobility, and their c_v, (n,) each.

    The mobility is the permeability over the unit weight of water.
    """

    corners: ndarray
    mobility: ndarray
    diffusivity: ndarray


class Surroundings(NamedTuple):
    """Ground and other forms around the water.

    Attributes
    ----------
    modulus, shear : ndarray, shape (n_elements,)
        Stiffness of the ground in compression without lateral strain, and in shear.
    leaks : ndarray
        Nodes of seepage faces.
    touching
        Forms in contact with the ground, by name.
    measure
        Strain measure and coordinates of the solids.
    waters
        Dofs and ground of further PoreWater.
    crossed
        Remarks on beams through which water passes.
    """

    modulus: ndarray
    shear: ndarray
    leaks: ndarray
    touching: Mapping[str, Any]
    measure: tuple[str, Coordinates]
    waters: tuple[tuple[ndarray, Ground], ...]
    crossed: tuple[Remark, ...]

    @classmethod
    def of(cls, basis: CellBasis, forms: Forms, waters: Sequence[Any]) -> Surroundings:
        """Collect the forms around the ground of a basis, all of which must belong to solids."""
        here = elements_of(basis)
        modulus, shear, measure = _stiffness(basis, forms)
        # Find the contact pairs that join the ground.
        touching = {}
        for name, pair in having(forms, Touching).items():
            if np.isin(pair.joins, basis.element_dofs).any():
                touching[name] = pair
        # Collect the drains, and the other waters with their diffusivity.
        drains = having(forms, Draining).values()
        leaks = [np.zeros(0, int), *(drain.leaks for drain in drains)]
        further = []
        for water in waters:
            ground = water.drainage(modulus[water.elements])
            further.append((water.ground.element_dofs, ground))
        return cls(
            modulus=modulus[here],
            shear=shear[here],
            leaks=np.concatenate(leaks),
            touching=touching,
            measure=measure,
            waters=tuple(further),
            crossed=tuple(_crossed(basis, forms)),
        )


def _stiffness(basis: CellBasis, forms: Forms) -> tuple[ndarray, ndarray, tuple[str, Coordinates]]:
    """Return oedometric and shear moduli of all elements, and the measure of the ground."""
    mesh = basis.mesh
    here = elements_of(basis)
    modulus = np.full(mesh.nelements, np.nan)
    shear = np.full(mesh.nelements, np.nan)
    measures = set()
    # Collect the elastic moduli of the solids.
    for name, form in solids_of(forms).items():
        if not form.materials:
            continue
        for region in form.regions:
            elements = form.elements[region.elements]
            D = form.elastic_moduli[region.elements]
            modulus[elements] = D[:, 0, 0]
            shear[elements] = D[:, -1, -1]
            if not np.isin(elements, here).any():
                continue
            assert form.coordinates is not None
            measures.add((form.strain, form.coordinates))
            # Refuse regions whose water would count twice.
            if region.material.undrained:
                raise ValueError(
                    f"region '{region.name}' of '{name}' is Undrained and has PoreWater too: its "
                    "water would count twice; give its soil alone"
                )
    # Refuse pore water outside of solids, and in solids of different strains.
    missing = here[np.isnan(modulus[here])]
    if len(missing):
        middle = mesh.p[:, mesh.t[:, missing[0]]].mean(axis=1)
        raise ValueError(
            f"there is PoreWater in {len(missing)} elements of no SolidForm, the first at "
            f"{format_point(middle)}"
        )
    if len(measures) > 1:
        raise ValueError(
            f"the solids of the porous ground have different strains, {sorted(measures)}: give "
            "all of them the same `strain`"
        )
    return modulus, shear, measures.pop()


def _crossed(basis: CellBasis, forms: Forms) -> Iterator[Remark]:
    """Yield remarks on plane beams along facets inside of porous ground: water passes them."""
    mesh = basis.mesh
    count = facet_counts(mesh, elements_of(basis))
    inner = mesh.facets[:, count == 2]
    middles = scipy.spatial.cKDTree(mesh.p[:, inner].mean(axis=1).T)
    tolerance = _ROUND_OFF * np.ptp(mesh.p)
    for name, form in forms.items():
        if not isinstance(form, Beam) or form.coordinates == "space" or form.spacing != 1.0:
            continue
        # Nodes of a straight quadratic line have their middle in its middle.
        points = form.points[form.cells].mean(axis=1)
        n = int((middles.query(points)[0] < tolerance).sum())
        if n:
            yield Remark(
                f"{name} crossed",
                n,
                f"water passes through '{name}', which shares nodes with the ground "
                "on both sides: a tight wall is a beam in a slit, bonded=False",
            )
