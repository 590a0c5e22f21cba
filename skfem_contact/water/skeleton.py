"""Stiffness of the ground around the water, by which its pressures are scaled and stabilised."""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy import ndarray
from skfem import CellBasis

from ..errors import place
from ..forms import Form
from ..materials import Undrained
from ..solid import SolidForm
from ..unknowns import elements_of


@dataclass(frozen=True, eq=False)
class Skeleton:
    """Elastic ground, element by element.

    Attributes
    ----------
    modulus
        Stiffness in compression without lateral strain, (n_elements,).
    shear
        Shear modulus.
    size
        Edge of a square or cube of the same size.
    """

    modulus: ndarray
    shear: ndarray
    size: ndarray

    @classmethod
    def of(cls, basis: CellBasis, forms: Mapping[str, Form]) -> Skeleton:
        """From the solids among the forms.

        Raises
        ------
        ValueError
            Elements without a solid, or of an undrained material.
        """
        mesh, here, dim = basis.mesh, elements_of(basis), basis.mesh.dim()
        modulus, shear = np.full(mesh.nelements, np.nan), np.full(mesh.nelements, np.nan)
        for name, form in forms.items():
            if not isinstance(form, SolidForm):
                continue
            for region in form.regions:
                elements = form.elements[region.elements]
                stiffness = region.material.elasticity(4 if dim == 2 else 6)
                modulus[elements], shear[elements] = stiffness[..., 0, 0], stiffness[..., 3, 3]
                if isinstance(region.material, Undrained) and np.isin(elements, here).any():
                    raise ValueError(f"region '{region.name}' of '{name}' is Undrained and has PoreWater too: its "
                                     f"water would count twice; give its soil alone, {region.material.soil!r}")
        lost = here[np.isnan(modulus[here])]
        if len(lost):
            raise ValueError(f"there is PoreWater in {len(lost)} elements of no SolidForm, the first at "
                             f"{place(mesh.p[:, mesh.t[:, lost[0]]].mean(axis=1))}")
        return cls(modulus[here], shear[here], basis.dx.sum(axis=1) ** (1.0 / dim))
