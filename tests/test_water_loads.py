"""Seepage as a load: level ground, slopes, joints between bodies and factors of safety."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from helpers import grid, vector_basis
from infinite_slope import BETA, DEPTH, GAMMA, infinite_slope

import skfem_contact as sc

WATER = 9.81


def test_upward_flow_in_level_ground():
    """[X] With a gradient i upwards the effective stress is (gamma - gamma_w (1 + i)) z; the K0 procedure finds it."""
    basis = vector_basis(grid("Q2", np.linspace(0, 3, 4), np.linspace(0, 5, 6)), "Q2", intorder=4)
    water = sc.water.seepage(basis, 1e-6, {"bottom": 7.0, "top": 5.0}, unit_weight=WATER)
    forms = {"ground": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3))}
    fixed = np.append(basis.get_dofs("bottom").all(), basis.get_dofs({"left", "right"}).all("u^1"))
    for pressure in (water.pressure, water.pressure_at):
        load = sc.weight(basis, 20.0) + sc.water_load(basis, pressure)
        start = sc.Model(forms, fixed).k0_state(load, unit_weights=20.0, K0=0.6, water=water.pressure_at)["initial"]
        assert start.residual < 1e-12
        depth = 5.0 - np.asarray(basis.global_coordinates())[1]
        effective = -(20.0 - WATER * 1.4) * depth
        np.testing.assert_allclose(start.states["ground"].stress[1], effective, atol=1e-9)
        np.testing.assert_allclose(start.states["ground"].stress[0], 0.6 * effective, atol=1e-9)


@pytest.mark.parametrize("element", ["P2", "Q2", "Q1"])
def test_infinite_slope_with_parallel_seepage(element):
    """[X] Flow parallel to the slope with the water table in its surface: exact factor within .5 %.

    Elements of one size shear as a whole; rows that shrink towards the base make the error that is left.
    """
    soil = sc.MohrCoulomb(E=1e4, nu=0.3, c=5.0, phi=30.0, psi=30.0)
    basis, forms, fixed, weight = infinite_slope(soil, 8, element)
    cos, sin = np.cos(np.radians(BETA)), np.sin(np.radians(BETA))

    def head(x):
        return x[1] + (DEPTH - sin / cos * x[0] - x[1]) * cos**2

    water = sc.water.seepage(basis, 1e-5, {"left": head, "right": head}, seepage_face="top", unit_weight=WATER)
    assert water.discharge("top") == pytest.approx(0.0, abs=1e-12 * water.discharge("left"))
    depth = DEPTH - sin / cos * basis.mesh.p[0] - basis.mesh.p[1]
    np.testing.assert_allclose(water.pressure, WATER * depth[: len(water.pressure)] * cos**2, atol=1e-9)
    load = weight + sc.water_load(basis, water.pressure, ["left", "right"])
    factor = sc.Model(forms, fixed).strength_reduction(load, tolerance=0.004, progress=False).factor
    normal, shear = (GAMMA - WATER) * DEPTH * cos**2, GAMMA * DEPTH * sin * cos
    assert factor == pytest.approx((5.0 + normal * np.tan(np.radians(30.0))) / shear, rel=5e-3)


@pytest.mark.parametrize("open_joint", [True, False], ids=["open", "tight"])
def test_contact_carries_the_effective_stress(open_joint):
    """[X] Two layers in contact: its pressure is the weight above less that of the water below the upper layer.

    Water that passes the joint has one pressure on both sides, in a tight joint it has two.
    """
    low = grid("Q1", np.linspace(0, 2, 5), np.linspace(0, 1, 4))
    top = grid("Q1", np.linspace(0, 2, 9), np.linspace(1, 3, 6))
    basis = vector_basis(sc.join_bodies({"low": low, "top": top}), "Q1", intorder=2)
    heads = {"low:bottom": 3.6, "top:top": 3.0}
    joint = {"connected": [("low:top", "top:bottom")]} if open_joint else {}
    water = sc.water.seepage(basis, {"low": 1.0, "top": 2.0}, heads, unit_weight=WATER, **joint)
    pressure = WATER * ((3.3 if open_joint else 3.0) - 1.0)
    sides = ["low:top", "top:bottom"]
    load = sc.weight(basis, 20.0) + sc.water_load(basis, water.pressure, sides)
    forms = {"ground": sc.SolidForm(basis, sc.LinearElastic(E=1e5, nu=0.0)),
             "joint": sc.ContactPair(basis, *reversed(sides), sc.Coulomb(mu=0.5), quadrature="segments")}  # fmt: skip
    walls = {"low:left", "low:right", "top:left", "top:right"}
    fixed = np.append(basis.get_dofs("low:bottom").all(), basis.get_dofs(walls).all("u^1"))
    stage = sc.Model(forms, fixed).run([sc.Stage("weight", load)], progress=False)["weight"]
    joint = stage.tractions("joint")
    np.testing.assert_allclose(joint.pressure, 40.0 - pressure, rtol=1e-6)


def test_water_above_the_ground_is_warned_of():
    """Nodal pressures of ground under water: without its surface among the boundaries the user is warned."""
    basis = vector_basis(grid("P2", np.linspace(0, 2, 3), np.linspace(0, 1, 3)), "P2")
    water = sc.water.seepage(basis, 1.0, {"top": 2.0, "bottom": 2.0}, unit_weight=9.81)
    with pytest.warns(sc.AnalysisWarning, match="there is water above the surface"):
        sc.water_load(basis, water.pressure)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        load = sc.water_load(basis, water.pressure, ["top", "bottom", "left", "right"])
    assert load[1::2].sum() == pytest.approx(2 * WATER, rel=1e-12)
