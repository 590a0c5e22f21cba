"""Stresses at rest in layered ground."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import Basis, ElementQuad1, ElementVector, MeshQuad

import skfem_contact as sc


@pytest.mark.parametrize("water", [None, 2.0])
def test_stresses_at_rest(water):
    """[X] Layers of 20 and 16 kN/m3, a surcharge of 5, K0 = 0.6: at 0.5 and 1.5 m below the
    surface.
    """
    mesh = (
        MeshQuad.init_tensor(np.array([0.0, 1.0]), np.linspace(0, 2, 3))
        .with_defaults()
        .with_subdomains({"lower": lambda x: x[1] < 1, "upper": lambda x: x[1] > 1})
    )
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=1)
    soil = sc.SolidForm(
        basis,
        sc.MohrCoulomb(1e4, 0.3, c=1.0, phi=30.0),
        "b_bar",
        unit_weight={"lower": 20.0, "upper": 16.0},
    )
    model = sc.Model({"soil": soil}, sc.box_supports(basis), water_unit_weight=10.0)
    load = sc.traction(basis, "top", (0.0, -5.0))
    stress = model.k0_state(load, K0=0.6, surcharge=5.0, water=water)[-1].states["soil"].stress
    found = np.sort(stress[:2].mean(axis=2), axis=1)
    vertical = -np.array([5.0 + 16.0 + 10.0, 5.0 + 8.0]) + (
        0.0 if water is None else np.array([15.0, 5.0])
    )
    np.testing.assert_allclose(found, [0.6 * vertical, vertical], rtol=1e-9)
