"""Scenes with water that cannot be meant: what is refused by name."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

import skfem_contact as sc
from tests.tools.scenes import layer_with_water


def test_two_waters_of_the_same_elements():
    """Their storage and flow would add up; parts of the ground that share an interface may have a
    water each.
    """
    basis, clay, water = layer_with_water()
    again = sc.PoreWater(basis.with_elements("left"), permeability=2e-4, unit_weight=9.81)
    with pytest.raises(
        ValueError, match="'water': 'again' is PoreWater of 128 of the same elements"
    ):
        sc.Model({"clay": clay, "water": water, "again": again})
    other = sc.PoreWater(basis.with_elements("right"), permeability=2e-4, unit_weight=9.81)
    sc.Model({"clay": clay, "water": other, "again": again})


def test_water_of_another_mesh():
    _, clay, _ = layer_with_water()
    with pytest.raises(ValueError, match="the forms belong to different bases"):
        sc.Model({"clay": clay, "water": layer_with_water(7)[2]})


def test_pressures_that_are_prescribed_but_not_held():
    """They would do nothing; values of all dofs may be given, as in scikit-fem."""
    basis, clay, water = layer_with_water()
    fixed = sc.box_supports(basis, base="fixed")
    load = sc.traction(basis, "top", (0.0, -50.0))
    model = sc.Model({"clay": clay, "water": water}, [fixed, water.dofs("top")])
    below = model.forms["water"].prescribed({"bottom": 30.0})
    with pytest.warns(
        sc.AnalysisWarning, match="the pore pressure is prescribed at 17 dofs that are not held"
    ):
        model.run([sc.Stage("a", load, duration=1.0, prescribed=below)], progress=False)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        stage = model.run([sc.Stage("a", load, duration=1.0)], progress=False)["a"]
        held = sc.Stage(
            "b", load, duration=1.0, prescribed=below, fixed=[fixed, water.dofs("top", "bottom")]
        )
        model.run([held], start=stage, progress=False)
        model.run(
            [sc.Stage("b", load, duration=1.0, prescribed=stage.x)], start=stage, progress=False
        )
    assert not any("prescribed" in str(w.message) for w in caught)


def test_a_load_on_pressures():
    """It would be water in every increment, whatever its length."""
    basis, clay, water = layer_with_water()
    model = sc.Model(
        {"clay": clay, "water": water}, [sc.box_supports(basis, base="fixed"), water.dofs("top")]
    )
    well = np.zeros(model.forms["water"].size)
    well[model.forms["water"].first] = 1e-3
    with pytest.raises(
        ValueError, match="stage 'well': the load acts on the pore pressure at 1 dofs"
    ):
        model.run([sc.Stage("well", well, duration=1.0)], progress=False)


def test_water_that_is_not_activated():
    """The start holds the ground alone: without `activate` it would settle at once, and nothing
    would tell so.
    """
    basis, clay, water = layer_with_water()
    fixed, load = sc.box_supports(basis, base="fixed"), sc.traction(basis, "top", (0.0, -50.0))
    start = sc.Model({"clay": clay}, fixed).run([sc.Stage("rest")], progress=False)
    model = sc.Model({"clay": clay, "water": water}, [fixed, water.dofs("top")])
    for active, duration in (((), 1.0), ((), 0.0), ("water", 1.0)):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            model.run(
                [sc.Stage("load", load, duration=duration, activate=active)],
                start=start,
                progress=False,
            )
        told = any(
            "['water'] is not active in a stage with a duration" in str(w.message) for w in caught
        )
        assert told == (duration > 0.0 and not active)


def test_ground_that_becomes_undrained_beside_its_water():
    """It has PoreWater already, which would count twice: a stage refuses it as the model does, or
    deactivates it.
    """
    basis, clay, water = layer_with_water()
    quick = {
        "clay": clay.with_materials(
            {"all": sc.Undrained(sc.LinearElastic(E=8e3, nu=0.3), nu_undrained=0.499)}
        )
    }
    model = sc.Model({"clay": clay, "water": water}, [sc.box_supports(basis), water.dofs("top")])
    start = model.run([sc.Stage("rest", duration=1.0)], progress=False)
    load = model.traction("top", lambda x: np.stack((0 * x[0], -50.0 * (x[0] < 2.0))))
    with pytest.raises(
        ValueError, match="'quick': 256 elements are Undrained and have PoreWater too"
    ):
        model.run(
            [sc.Stage("quick", load, change=quick, duration=1.0)], start=start, progress=False
        )
    stage = model.run(
        [sc.Stage("quick", load, change=quick, deactivate="water")], start=start, progress=False
    )["quick"]
    assert stage.pore_pressure("clay").max() > 25.0
