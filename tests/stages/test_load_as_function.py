"""Loads that are functions of the share of a stage: the load on the way is the given one."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import csr_matrix
from skfem import Basis, ElementTriP2, ElementVector, MeshTri

import skfem_contact as sc
from tests.stages.test_stages import QUIET, column, pressed
from tests.tools.helpers import moved_rigidly


def reaction(stage, basis) -> float:
    """Return the upward force on the bottom."""
    return float(stage.reactions()[basis.get_dofs("bottom").all("u^2")].sum())


def test_load_on_the_way_is_the_given_one():
    """[X] Equilibrium: the reactions of a first stage are 1 + sin(2 pi s) / 2 of the force."""
    basis, forms, fixed = column()
    load = pressed(basis, 10.0)

    def given(share):
        return 1.0 + 0.5 * np.sin(2.0 * np.pi * share)

    stage = sc.Stage("cycle", lambda share: given(share) * load, increments=4, keep="all")
    seen = []
    with pytest.warns(sc.AnalysisWarning, match=r"begins with a jump.* 4 increments"):
        result = sc.Model(forms, fixed).run([stage], on_increment=seen.append, **QUIET)
    kept = result["cycle"].increments
    assert [part.fraction for part in kept] == [0.25, 0.5, 0.75, 1.0]
    shares = np.array([part.fraction for part in kept])
    forces = [reaction(part, basis) for part in kept]
    np.testing.assert_allclose(forces, 10.0 * given(shares), rtol=1e-9)
    before = [reaction(part, basis) for part in seen if part.fraction == 0.0]
    np.testing.assert_allclose(before, [2.5, 5.0, 7.5, 10.0], rtol=1e-9)


def test_weights_of_new_bodies_come_gradually_beside_a_jump():
    """[X] Equilibrium: the jump is in the given load alone; the weight grows with the share."""
    basis, forms, fixed = column()
    forms["column"] = sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.25), unit_weight=20.0)
    load = pressed(basis, 10.0)
    stages = [sc.Stage("hold", lambda share: load, increments=2, keep="all")]
    with pytest.warns(sc.AnalysisWarning, match="begins with a jump"):
        first = sc.Model(forms, fixed).run(stages, **QUIET)
    forces = [reaction(part, basis) for part in first["hold"].increments]
    np.testing.assert_allclose(forces, [10.0 + 20.0, 10.0 + 40.0], rtol=1e-9)


@pytest.mark.parametrize("continued", [False, True])
def test_function_that_begins_with_the_load_before_has_no_jump(continued, recwarn):
    """[X] Equilibrium: from 10 by 10 (1 + s) to 20, in the same run or in one that goes on."""
    basis, forms, fixed = column()
    forms["column"] = sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.25), unit_weight=20.0)
    load = pressed(basis, 10.0)
    model = sc.Model(forms, fixed, water_unit_weight=10.0)
    stages = [
        sc.Stage("first", load, water=1.0),  # the load of water is no part of the given one
        sc.Stage("more", lambda share: (1.0 + share) * load, increments=2, keep="all"),
    ]
    if continued:
        first = model.run(stages[:1], **QUIET)
        result = model.run(stages[1:], start=first, **QUIET)
    else:
        result = model.run(stages, **QUIET)
    assert not [text for text in recwarn if "jump" in str(text.message)]
    loads = [part.load - result["first"].load for part in result["more"].increments]
    np.testing.assert_allclose(loads, [0.5 * load, load], atol=1e-9)


def test_spring_yields_in_the_jump():
    """[X] A slider of 4 under 5 - 4 s: it slips by 1 / k in the jump, and is unloaded after it.

    The slip stays: x = 1 / k_s + F / k with k_s the stiffness beside the slider.
    """

    class Slider(sc.Form):
        """A slider of strength 4 with stiffness 100, beside a spring of stiffness 1."""

        size = 1

        def initial_state(self, x=None):
            return np.zeros(1)

        def assemble(self, x, state):
            trial = 100.0 * (x - state)
            force = np.clip(trial, -4.0, 4.0)
            stiffness = 100.0 if force[0] == trial[0] else 0.0
            return sc.Response(
                force + x, lambda: x - force / 100.0, lambda: csr_matrix([[stiffness + 1.0]])
            )

    stage = sc.Stage("less", lambda share: np.array([5.0 - 4.0 * share]), increments=4)
    with pytest.warns(sc.AnalysisWarning, match="begins with a jump"):
        x = sc.Model({"slider": Slider()}).run([stage], **QUIET)["less"].x[0]
    # in the jump x = 1, slip 0.96; then 100 (x - 0.96) + x = 1
    assert x == pytest.approx(97.0 / 101.0, rel=1e-9)


def test_consolidation_under_a_load_that_a_function_holds():
    """[X] Terzaghi: a sudden load, drained at the top, to the time factor 0.2."""
    H, k, gamma, E, q, T = 1.0, 1e-4, 10.0, 1e4, 100.0, 0.2
    mesh = MeshTri.init_tensor(np.array([0.0, 0.1]), np.linspace(0, H, 21)).with_defaults()
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    water = sc.PoreWater(basis, permeability=k, unit_weight=gamma)
    forms = {"clay": sc.SolidForm(basis, sc.LinearElastic(E=E, nu=0.0)), "water": water}
    model = sc.Model(forms, [sc.box_supports(basis, base="rollers"), water.dofs("top")])
    load = model.traction("top", (0.0, -q))
    duration = T * H**2 / (k * E / gamma)
    stage = sc.Stage("hold", lambda share: load, duration=duration, increments=20)
    with pytest.warns(sc.AnalysisWarning, match="begins with a jump"):
        result = model.run([stage], **QUIET)
    settled = -result["hold"].x[basis.get_dofs("top").all("u^2")].mean()
    m = np.pi * (2 * np.arange(200) + 1) / 2
    right = q * H / E * (1 - (2 / m**2 * np.exp(-(m**2) * T)).sum())
    assert settled == pytest.approx(right, rel=0.01)


def turned(basis, angle):
    """Return displacements of a rotation about the origin."""
    return moved_rigidly(basis, np.degrees(angle), (0.0, 0.0))


def test_body_is_turned_by_supports_that_follow_a_circle():
    """[X] Prescribed displacements are a function of the share: two turns leave no stress."""
    mesh = MeshTri.init_tensor([0.0, 1.0, 2.0], [0.0, 1.0]).with_defaults()
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=4)
    body = sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.3), kinematics="finite")
    model = sc.Model({"body": body}, basis.get_dofs("left").all())
    stage = sc.Stage(
        "turn", prescribed=lambda share: turned(basis, 4.0 * np.pi * share), increments=16
    )
    seen = []
    end = model.run([stage], on_increment=seen.append, **QUIET)["turn"]
    # round-off of displacements of 4 under E = 1e3
    assert np.abs(end.states["body"].stress).max() < 1e-9
    quarter = next(part for part in seen if part.fraction == 1.0 / 8.0)
    np.testing.assert_allclose(quarter.x, turned(basis, 0.5 * np.pi), atol=1e-10)


def test_prescribed_displacements_begin_where_they_were():
    """[X] A function that begins elsewhere is refused with the distance, the stages before kept."""
    basis, forms, fixed = column()
    model = sc.Model(forms, fixed)
    down = np.zeros(basis.N)
    down[basis.get_dofs("bottom").all("u^2")] = -0.01
    stages = [
        sc.Stage("down", prescribed=down),
        sc.Stage("up", prescribed=lambda share: share * down),
    ]
    with pytest.raises(ValueError, match=r"stage 'up': prescribed\(0\) differs by 0.01 ") as failed:
        model.run(stages, **QUIET)
    assert failed.value.result[0].name == "down"
    smooth = sc.Stage("up", prescribed=lambda share: (1.0 - share) * down)
    end = model.run([stages[0], smooth], **QUIET)["up"]
    assert np.abs(end.x[basis.get_dofs("bottom").all("u^2")]).max() == 0.0
