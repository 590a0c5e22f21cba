"""Levels beside suction and inclined gravity, and rain that ponds."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from skfem import Basis, ElementTriP2, ElementVector, MeshTri

import skfem_contact as sc
from tests.tools.scenes import layer_with_water


@pytest.mark.parametrize(
    ("rate", "face", "ponds"), [(2.0, False, True), (2.0, True, False), (-0.5, False, False)]
)
def test_rain_that_the_ground_does_not_take(rate, face, ponds):
    """[X] Twice the permeability on a column that drains at its base: p at the top is 2 gamma_w H,
    as told.
    """
    basis, clay, water = layer_with_water()
    forms = {"clay": clay, "water": water, "rain": sc.water.Inflow(water, {"top": rate * 2e-4})}
    if face:
        forms["face"] = sc.water.SeepageFace(water, "top", 0.0)
    model = sc.Model(forms, [sc.box_supports(basis, base="rollers"), water.dofs("bottom")])
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        stage = model.run([sc.Stage("rain", duration=1e5)], progress=False)["rain"]
    assert any("does not take ponds, 4 deep at (" in str(w.message) for w in caught) == ponds
    if not face:
        top = stage.forms["water"].pressure(stage.x)[basis.mesh.p[1] == 0.0]
        np.testing.assert_allclose(
            top, rate * 9.81 * 2.0, rtol=1e-3
        )  # a tenth of the allowed error in time


@pytest.mark.slow
def test_level_beside_suction():
    """[X] The pressure at the start as `water=` is that of `water_load`; a level lacks its suction,
    which is told.
    """
    basis, clay, _ = layer_with_water()
    law = sc.water.VanGenuchten(alpha=0.5, n=2.0, content=(0.05, 0.4))
    moist = sc.PoreWater(basis, 1e-3, retention=law, start=-1.0, unit_weight=9.81)
    fixed = [sc.box_supports(basis, base="rollers"), moist.dofs("bottom")]
    model = sc.Model({"clay": clay, "water": moist}, fixed, water_unit_weight=9.81)
    initial = model.forms["water"].initial
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        given = model.run([sc.Stage("rest", water=initial, duration=1e3)], progress=False)[-1]
        load = model.run(
            [sc.Stage("rest", sc.water_load(basis, initial), duration=1e3)], progress=False
        )[-1]
        # Full pores have no suction.
        full = sc.PoreWater(basis, 1e-3, unit_weight=9.81)
        held = [sc.box_supports(basis, base="rollers"), full.dofs("bottom")]
        saturated = sc.Model({"clay": clay, "water": full}, held, water_unit_weight=9.81)
        saturated.run([sc.Stage("rest", water=-1.0, duration=1e3)], progress=False)
    np.testing.assert_allclose(given.x, load.x, atol=1e-12)
    with pytest.warns(
        sc.AnalysisWarning,
        match=f"none of the suction, up to {-initial.min():.3g}, with which 'water'",
    ):
        model.run([sc.Stage("rest", water=-1.0, duration=1e3)], progress=False)


def test_levels_beside_inclined_gravity():
    """[X] A level would stand along the last axis; as a function of the coordinates water is 10
    times the depth.
    """
    mesh = MeshTri.init_tensor(np.linspace(0, 2, 3), np.linspace(0, 4, 5)).with_defaults()
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    soil = sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3), unit_weight=20.0)
    model = sc.Model(
        {"soil": soil}, basis.get_dofs("right").all(), gravity=(1.0, 0.0), water_unit_weight=10.0
    )
    for level in (3.0, [(0.0, 3.0), (2.0, 3.0)]):
        with pytest.raises(
            ValueError, match=r"levels need gravity against the last axis, not \[1.0, 0.0\]"
        ):
            model.run([sc.Stage("rest", water=level)], progress=False)
    stage = model.run([sc.Stage("rest", water=lambda x: 10.0 * x[0])], progress=False)["rest"]
    np.testing.assert_allclose(
        stage.reactions().reshape(-1, 2).sum(axis=0), (-(20.0 - 10.0) * 8.0, 0.0), atol=1e-9
    )
