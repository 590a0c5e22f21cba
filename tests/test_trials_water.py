"""Input of pore water that would give another result than intended is refused."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import Basis, ElementTriP2, ElementVector, MeshTri

import skfem_contact as sc


def ground(n: int = 8):
    """A layer with a basis, its solid and its water."""
    mesh = MeshTri.init_tensor(np.linspace(0, 4, 2 * n + 1), np.linspace(-2, 0, n + 1)).with_defaults()
    mesh = mesh.with_subdomains({"left": lambda x: x[0] < 2, "right": lambda x: x[0] > 2})
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    clay = sc.SolidForm(basis, sc.LinearElastic(E=8e3, nu=0.3))
    return basis, clay, sc.PoreWater(basis, permeability=2e-4, unit_weight=9.81)


def test_two_waters_of_the_same_elements():
    """Their storage and flow would add up; parts of the ground that share an interface may have a water each."""
    basis, clay, water = ground()
    again = sc.PoreWater(basis.with_elements("left"), permeability=2e-4, unit_weight=9.81)
    with pytest.raises(ValueError, match="'water': 'again' is PoreWater of 128 of the same elements"):
        sc.Model({"clay": clay, "water": water, "again": again})
    other = sc.PoreWater(basis.with_elements("right"), permeability=2e-4, unit_weight=9.81)
    sc.Model({"clay": clay, "water": other, "again": again})


def test_water_of_another_mesh():
    _, clay, _ = ground()
    with pytest.raises(ValueError, match="the forms belong to different bases"):
        sc.Model({"clay": clay, "water": ground(7)[2]})
