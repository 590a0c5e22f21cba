"""Drains that open later, and undrained clay that consolidates."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from skfem import Basis, ElementTriP1, ElementTriP2, ElementVector, MeshTri

import skfem_contact as sc


@pytest.mark.parametrize("by", ["a stage", "another model", "a file"])
def test_drain_that_is_opened_later(by, tmp_path):
    """[X] Terzaghi: a layer that drains at its base is opened at its top too, and half consolidates
    by T = .197.
    """
    mesh = MeshTri.init_tensor(np.array([0.0, 0.2]), np.linspace(0, 2, 21)).with_defaults()
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    sides, water = (
        sc.box_supports(basis, base="rollers"),
        sc.PoreWater(basis, 1e-4, unit_weight=1.0),
    )
    forms = {"clay": sc.SolidForm(basis, sc.LinearElastic(E=8e3, nu=0.0)), "water": water}
    model = sc.Model(forms, [sides, water.dofs("bottom")])
    load = sc.traction(basis, "top", (0.0, -50.0))
    start = model.run([sc.Stage("load", load, duration=1e-3)], progress=False)
    open_, time = [sides, water.dofs("top", "bottom")], 0.197 / 0.8
    if by == "a file":
        start.save(tmp_path / "load.npz")
        start = sc.load_result(tmp_path / "load.npz", forms)
    if by == "another model":
        model = sc.Model(forms, open_)
    wait = sc.Stage("wait", load, duration=time, fixed=None if by == "another model" else open_)
    stage = model.run([wait], start=start, progress=False)["wait"]
    settled = -stage.x[basis.get_dofs("top").all("u^2")].mean() / (50.0 * 2.0 / 8e3)
    assert settled == pytest.approx(
        0.5, abs=0.01
    )  # what leaves while the load comes, in a step as long as h^2 / 8 c_v
    assert not stage.forms["water"].pressure(stage.x)[mesh.p[1] == 2.0].any()


@pytest.mark.parametrize("element", [ElementTriP2, ElementTriP1])
def test_consolidation_after_undrained_loading(element):
    """[X] Terzaghi: the pressure of Undrained clay is that of its water at first, and half is gone
    by T = .197.
    """
    mesh = MeshTri.init_tensor(np.array([0.0, 0.2]), np.linspace(0, 2, 21)).with_defaults()
    basis = Basis(mesh, ElementVector(element()), intorder=2)
    soil = sc.LinearElastic(E=8e3, nu=0.0)
    clay, water = sc.SolidForm(basis, soil), sc.PoreWater(basis, 1e-4, unit_weight=1.0)
    quick = clay.with_materials({"all": sc.Undrained(soil, nu_undrained=0.4999)})
    sides, load = sc.box_supports(basis, base="rollers"), sc.traction(basis, "top", (0.0, -50.0))
    start = sc.Model({"clay": quick}, sides).run([sc.Stage("load", load)], progress=False)
    model = sc.Model({"clay": clay, "water": water}, [sides, water.dofs("top")])
    wait = sc.Stage(
        "wait", load, duration=0.197 * 2.0**2 / 0.8, activate="water", increments=100, keep="all"
    )
    result = model.run([wait], start=start, progress=False)
    first = result["wait"].increments[0]
    pressure = first.forms["water"].pressure(first.x)
    np.testing.assert_allclose(
        pressure[mesh.p[1] < 1.5], 50.0, rtol=2e-3
    )  # the water of Undrained is compressible
    settled = -result["wait"].x[basis.get_dofs("top").all("u^2")].mean() / (50.0 * 2.0 / 8e3)
    assert settled == pytest.approx(0.5, abs=0.005)  # the allowed error in time


def test_drains_of_water_that_is_not_active():
    """They hold nothing: clay whose only drain belongs to a fill that comes later is sealed."""
    mesh = MeshTri.init_tensor(np.linspace(0, 2, 5), np.linspace(0, 4, 9)).with_defaults()
    mesh = mesh.with_subdomains({"clay": lambda x: x[1] < 2, "fill": lambda x: x[1] > 2})
    basis, forms = Basis(mesh, ElementVector(ElementTriP2()), intorder=2), {}
    for name in ("clay", "fill"):
        part = basis.with_elements(name)
        forms |= {
            name: sc.SolidForm(part, sc.LinearElastic(E=8e3, nu=0.3), unit_weight=9.0),
            f"water of {name}": sc.PoreWater(part, 1e-3, unit_weight=9.81),
        }
    fixed = sc.box_supports(basis, base="rollers")
    model = sc.Model(forms, [fixed, forms["water of fill"].dofs("top")])
    fill = sc.Stage("fill", activate=["fill", "water of fill"], duration=1.0)
    with pytest.warns(
        sc.AnalysisWarning, match="stage 'clay'.*water of clay: no pore pressure is held"
    ):
        model.run([sc.Stage("clay", duration=1.0), fill], progress=False)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        model.run([sc.Stage("both", duration=1.0)], progress=False)
    assert not any("no pore pressure is held" in str(w.message) for w in caught)


def test_wet_fill_on_undrained_clay():
    """[X] The pressure of clay that stays Undrained is none of the water of a weightless fill that
    is placed on it.
    """
    mesh = MeshTri.init_tensor(np.array([0.0, 0.2]), np.linspace(0, 2, 11)).with_defaults()
    mesh = mesh.with_subdomains({"clay": lambda x: x[1] < 1, "fill": lambda x: x[1] > 1})
    mesh = mesh.with_boundaries({"middle": lambda x: x[1] == 1}, boundaries_only=False)
    basis, soil = (
        Basis(mesh, ElementVector(ElementTriP2()), intorder=2),
        sc.LinearElastic(E=8e3, nu=0.0),
    )
    forms = {
        "clay": sc.SolidForm(basis.with_elements("clay"), sc.Undrained(soil, nu_undrained=0.499)),
        "fill": sc.SolidForm(basis.with_elements("fill"), soil),
        "water": sc.PoreWater(basis.with_elements("fill"), 1e-4, unit_weight=1.0),
    }
    load = sc.traction(forms["clay"], "middle", (0.0, -50.0))
    model = sc.Model(forms, [sc.box_supports(basis, base="rollers"), forms["water"].dofs("top")])
    stages = [
        sc.Stage("load", load),
        sc.Stage("fill", load, activate=["fill", "water"], duration=0.1),
    ]
    stage = model.run(stages, progress=False)["fill"]
    assert np.nanmax(abs(stage.forms["water"].pressure(stage.x))) < 1e-6  # round-off of 50
    assert stage.pore_pressure("clay").max() == pytest.approx(50.0, rel=5e-3)
