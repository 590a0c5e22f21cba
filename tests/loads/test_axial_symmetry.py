"""Loads, water and pores in axial symmetry, beside closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import (
    Basis,
    ElementQuad2,
    ElementVector,
    MeshQuad,
)

import skfem_contact as sc
from tests.tools.scenes import disc

QUIET = {"progress": False}


def test_weight_in_axial_symmetry():
    """[X] sigma_yy = -gamma (1 - y), whoever makes the load; a plane load vector is refused."""
    basis, fixed = disc()
    soil = sc.SolidForm(
        basis, sc.LinearElastic(E=1e3, nu=0.2), coordinates="axisymmetric", unit_weight=20.0
    )
    bare = sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.2), coordinates="axisymmetric")
    model = sc.Model({"soil": bare}, fixed)
    own = sc.Model({"soil": soil}, fixed).run([sc.Stage("weight")], **QUIET)["weight"]
    given = model.run([sc.Stage("weight", model.weight(20.0))], **QUIET)["weight"]
    y = np.asarray(bare.basis.global_coordinates())[1]
    for stage in (own, given):
        np.testing.assert_allclose(stage.states["soil"].stress[1], -20.0 * (1.0 - y), atol=1e-9)
    with pytest.raises(
        ValueError, match="integrated in plane coordinates, but the model is axisymmetric"
    ):
        model.run([sc.Stage("weight", sc.weight(basis, 20.0))], **QUIET)


def test_sums_of_loads_in_axial_symmetry():
    """A plane load vector does not pass in the sum with another one, on either side."""
    basis, _ = disc()
    soil = sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.2), coordinates="axisymmetric")
    own, plane = sc.weight(soil, 20.0), sc.traction(basis, "top", (0.0, -5.0))
    for combine in (
        lambda: own + plane,
        lambda: plane + own,
        lambda: own - 2.0 * plane,
        lambda: sum([own, plane]),
    ):
        with pytest.raises(
            ValueError, match="plane coordinates cannot be combined with an axisymmetric one"
        ):
            combine()
    with pytest.raises(ValueError, match="axisymmetric"):
        own += plane
    total = basis.zeros() + 2.0 * own + own
    assert total.coordinates == "axisymmetric"
    np.testing.assert_allclose(total, 3.0 * np.asarray(own))


@pytest.mark.parametrize("by_stage", [False, True])
def test_water_in_axial_symmetry(by_stage):
    """[X] Saturated ground with water to its surface: sigma'_yy = -(gamma - gamma_w) (1 - y) for
    every x.
    """
    basis, fixed = disc(2.0)
    soil = sc.SolidForm(
        basis, sc.LinearElastic(E=1e3, nu=0.2), coordinates="axisymmetric", unit_weight=20.0
    )
    model = sc.Model({"soil": soil}, fixed, water_unit_weight=10.0)
    stage = (
        sc.Stage("wet", water=1.0)
        if by_stage
        else sc.Stage("wet", model.water_load(sc.hydrostatic(1.0, unit_weight=10.0)))
    )
    y = np.asarray(soil.basis.global_coordinates())[1]
    stress = model.run([stage], **QUIET)["wet"].states["soil"].stress[1]
    np.testing.assert_allclose(stress, -10.0 * (1.0 - y), atol=1e-9)


def test_pores_in_axial_symmetry():
    """[X] Terzaghi's column as a disc: half of the settlement at T = .197; the water takes its
    coordinates.
    """
    mesh = MeshQuad.init_tensor(
        np.linspace(0, 1, 4), 1 - np.linspace(1, 0, 13) ** 1.5
    ).with_defaults()
    basis = Basis(mesh, ElementVector(ElementQuad2()), intorder=4)
    E, nu, k = 1e3, 0.2, 1e-4
    M = E * (1 - nu) / (1 + nu) / (1 - 2 * nu)
    time = 0.197 / (k / 10.0 * M)
    soil = sc.SolidForm(basis, sc.LinearElastic(E=E, nu=nu), coordinates="axisymmetric")
    water = sc.PoreWater(basis, permeability=k, unit_weight=10.0)
    fixed = [
        basis.get_dofs("bottom").all("u^2"),
        basis.get_dofs({"left", "right"}).all("u^1"),
        water.dofs("top"),
    ]
    model = sc.Model({"soil": soil, "water": water}, fixed)
    load = model.traction("top", (0.0, -10.0))
    stages = [
        sc.Stage("load", load, duration=0.01 * time),
        sc.Stage("wait", load, duration=0.99 * time),
    ]
    x = model.run(stages, **QUIET)["wait"].x
    assert -x[basis.get_dofs("top").all("u^2")].mean() / (10.0 / M) == pytest.approx(0.5, abs=0.01)
