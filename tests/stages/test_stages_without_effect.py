"""Stages and loads that change nothing are remarked on."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

import skfem_contact as sc
from skfem_contact.stages.plan import acts_on
from tests.tools.helpers import grid, vector_basis


def ground():
    basis = vector_basis(grid("Q1", np.linspace(0, 4, 9), np.linspace(0, 2, 5)), "Q1", intorder=2)
    forms = {"ground": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3))}
    return basis, forms, sc.weight(basis, 20.0), basis.get_dofs("bottom").all()


def test_stages_that_change_nothing():
    _, forms, load, fixed = ground()
    none = np.zeros(0, int)
    with pytest.warns(
        sc.AnalysisWarning,
        match="stage 'strut', the stage: `fixed` holds what is supported already",
    ):
        stages = [
            sc.Stage("weight", load),
            sc.Stage("strut", 0.5 * load, fixed=np.append(fixed, none)),
        ]
        sc.Model(forms, fixed).run(stages, progress=False)
    with pytest.warns(sc.AnalysisWarning, match="stage 'b', the stage: it changes nothing"):
        sc.Model(forms, fixed).run([sc.Stage("a", load), sc.Stage("b", load)], progress=False)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        sc.Model(forms, fixed).run([sc.Stage("a", load), sc.Stage("b", 2.0 * load)], progress=False)


def test_displacements_of_free_dofs():
    """[X] Values at dofs that nothing holds move nothing, which is told unless supports move."""
    basis, forms, load, fixed = ground()
    model = sc.Model(forms, fixed)
    top = basis.get_dofs("top").all("u^2")
    down = basis.zeros()
    down[top] = -0.1
    weight = sc.Stage("weight", load)
    with pytest.warns(sc.AnalysisWarning, match="at 9 dofs, none of which is held"):
        idle = model.run([weight, sc.Stage("push", load, prescribed=down)], progress=False)
    assert np.allclose(idle["push"].x, idle["weight"].x, rtol=0.0, atol=1e-12)

    # values of all dofs, of which the supports are moved, also back to where they began
    both = np.append(fixed, top)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        push = sc.Stage("push", load, prescribed=down, fixed=both)
        pushed = model.run([weight, push], progress=False)
        back = pushed["push"].x.copy()
        back[top] = 0.0
        model.run([sc.Stage("back", load, prescribed=back)], start=pushed, progress=False)
        stages = [weight, push, sc.Stage("back", load, prescribed=back)]
        assert np.allclose(model.run(stages, progress=False)["back"].x[top], 0.0, atol=1e-15)


def test_displacements_after_a_model_with_fewer_dofs():
    """A start without the pressures of a model, some of which are held, has no moved supports."""
    basis, forms, load, fixed = ground()
    start = sc.Model(forms, fixed).run([sc.Stage("weight", load)], progress=False)
    water = sc.PoreWater(basis, 1e-3, unit_weight=10.0)
    model = sc.Model({**forms, "water": water}, [fixed, water.dofs("top")])
    down = np.zeros(model.layout.size)
    down[basis.get_dofs("top").all("u^2")] = -0.1
    stage = sc.Stage("push", load, duration=1.0, prescribed=down, activate="water")
    with pytest.warns(sc.AnalysisWarning, match="at 9 dofs, none of which is held"):
        model.run([stage], start=start, progress=False)


def test_water_that_presses_on_nothing():
    basis, *_ = ground()
    basis.mesh.boundaries["nowhere"] = np.zeros(0, int)
    with pytest.raises(ValueError, match="boundary 'nowhere' is empty"):
        sc.water_load(basis, sc.hydrostatic(1.0, unit_weight=10.0), ["nowhere"])
    with pytest.warns(sc.AnalysisWarning, match="there is no water"):
        sc.water_load(basis, sc.hydrostatic(-5.0, unit_weight=10.0), ["top"])


def test_water_without_a_solid():
    """A frame alone faces no ground, whose water would press on it."""
    beam = sc.Beam(None, [(0.0, 0.0), (0.0, 2.0)], EI=1e3, EA=1e5)
    model = sc.Model({"beam": beam}, beam.dofs((0.0, 0.0)), water_unit_weight=10.0)
    with pytest.raises(ValueError, match="no solid is active: give structures alone a load"):
        model.run([sc.Stage("wet", water=1.0)], progress=False)


def test_levels_of_ground_that_is_gone():
    """A pit has the water of the region at its bottom: a level of the lift is reported."""
    mesh = grid("Q1", np.linspace(0, 4, 9), np.linspace(0, 2, 5)).with_subdomains(
        {"rest": lambda x: (x[0] < 2) | (x[1] < 1), "lift": lambda x: (x[0] > 2) & (x[1] > 1)}
    )
    basis = vector_basis(mesh, "Q1", intorder=2)
    forms = {
        name: sc.SolidForm(basis.with_elements(name), sc.LinearElastic(E=1e4, nu=0.3))
        for name in ("rest", "lift")
    }
    model = sc.Model(forms, sc.box_supports(basis), water_unit_weight=10.0)
    wet = sc.Stage("wet", water={"rest": 2.0, "lift": 2.0})
    with pytest.warns(
        sc.AnalysisWarning, match=r"stage 'dig', the stage: the water of \['lift'\] counts nowhere"
    ):
        dig = sc.Stage("dig", deactivate="lift", water={"rest": 2.0, "lift": 1.0})
        model.run([wet, dig], progress=False)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        dig = sc.Stage("dig", deactivate="lift", water={"rest": 1.0})
        model.run([wet, dig], progress=False)


def test_loads_at_a_single_dof_act() -> None:
    load = np.array([0.0, 1.0, 1e-14])
    assert [acts_on(load, np.array([k])) for k in range(3)] == [False, True, False]
    assert not acts_on(load, np.array([], int))
