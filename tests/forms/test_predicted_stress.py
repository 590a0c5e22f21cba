"""Stresses that iterations predict."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import (
    Basis,
    ElementHex1,
    ElementQuad1,
    ElementQuad2,
    ElementTriP2,
    ElementVector,
    MeshHex,
    MeshQuad,
    MeshTri,
)

import skfem_contact as sc
from skfem_contact.errors import NotConverged
from skfem_contact.forms.predicted_stress import MeanStress, WholeStress
from skfem_contact.nonlinear import newton
from skfem_contact.nonlinear.system import System
from tests.tools.helpers import counted

BODIES = {
    "plane": (MeshTri().refined(1), ElementTriP2(), 4, {}),
    "F-bar": (MeshQuad().refined(1), ElementQuad1(), 2, {"strain": "f_bar"}),
    "axisymmetric": (MeshTri().refined(1), ElementTriP2(), 4, {"coordinates": "axisymmetric"}),
    "space": (MeshHex(), ElementHex1(), 2, {"strain": "full"}),
}


def body(name: str, law):
    """Return a form, and displacements by which volumes change."""
    mesh, element, order, options = BODIES[name]
    mesh = mesh.translated((1.0, *[0.0] * (mesh.dim() - 1)))
    basis = Basis(mesh, ElementVector(element), intorder=order)
    form = sc.SolidForm(basis, law, kinematics="finite", **options)
    return form, 0.02 * np.random.default_rng(1).standard_normal(basis.N)


LAWS = {
    "mean": sc.LinearElastic(E=100.0, nu=0.48),
    "whole": sc.LinearElastic(E=100.0, nu=0.3),
    "whole, rubber": sc.NeoHooke(E=100.0, nu=0.3),
}


def predicted(form, stress) -> np.ndarray:
    """Return the part of stresses that is predicted: mean stresses, or the ones that do work."""
    if isinstance(form.assemble(form.basis.zeros(), form.initial_state()).prediction, MeanStress):
        return stress[:3].mean(axis=0)
    return stress[form._finite.acting]


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("name", BODIES)
def test_change_of_a_step(name: str, law: str) -> None:
    """[X] They change by the derivative of the law's stress: differences."""
    form, x = body(name, LAWS[law])
    step = np.random.default_rng(2).standard_normal(len(x))
    state = form.initial_state()
    change = form.assemble(x, state).prediction.change(step)
    if law != "mean":
        change = change[form._finite.acting]
    h = 1e-5

    def of_law(share: float):
        return predicted(form, form.assemble(x + share * step, state).state.stress)

    difference = (of_law(h) - of_law(-h)) / (2.0 * h)
    # stresses are those of the law before they follow a step
    limit = 1e-6 * np.abs(difference).max()
    np.testing.assert_allclose(change, difference, rtol=0, atol=limit)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("name", BODIES)
def test_first_and_second_order(name: str, law: str) -> None:
    """[X] A step of length a leaves a difference of a^2 from the law's stresses."""
    form, x = body(name, LAWS[law])
    step = 0.1 * np.random.default_rng(2).standard_normal(len(x))
    state = form.initial_state()
    before = form.assemble(x, state)
    left = []
    for length in (0.02, 0.01):
        after = form.assemble(x + length * step, state)
        after.prediction.follow(before.prediction, step, length)
        left.append(np.abs(predicted(form, after.state.stress - after.prediction.stress)).max())
        # the forces are those of its stresses
        whole = form._finite.at(x + length * step).force(after.prediction.stress)
        limit = 1e-13 * np.abs(whole).max()
        found = after.prediction.force()
        np.testing.assert_allclose(found, whole - after.force, rtol=0, atol=limit)
    assert left[0] / left[1] == pytest.approx(4.0, rel=0.1)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("name", BODIES)
def test_beginning_of_an_increment(name: str, law: str) -> None:
    """[X] Increments begin with stresses that are off by squares of the last change, a^2."""
    form, x = body(name, LAWS[law])
    change = 0.1 * np.random.default_rng(2).standard_normal(len(x))
    accepted = form.assemble(x, form.initial_state()).state
    off = []
    for length in (0.02, 0.01):
        last = length * change
        first = form.assemble(x + 0.5 * last, accepted)
        first.prediction.begin(x, x - last, 0.5)
        difference = first.prediction.stress - first.state.stress
        off.append(np.abs(predicted(form, difference)).max())
    assert off[0] / off[1] == pytest.approx(4.0, rel=0.1)

    # without the displacements before mean stresses are those of the accepted state, whole ones
    # those of the law: bodies that swing would find other equilibria
    first = form.assemble(x + 0.5 * last, accepted)
    first.prediction.begin(x)
    expected = accepted if law == "mean" else first.state
    found = predicted(form, first.prediction.stress)
    np.testing.assert_allclose(found, predicted(form, expected.stress), rtol=1e-12)


@pytest.mark.parametrize("name", BODIES)
def test_work_of_the_missing_stress(name: str) -> None:
    """[X] It is the integral of the missing strains times the change of mean stress."""
    form, x = body(name, LAWS["mean"])
    step = 0.02 * np.random.default_rng(2).standard_normal(len(x))
    state = form.initial_state()
    before, after = form.assemble(x, state), form.assemble(x + 0.5 * step, state)
    assert after.prediction.work(before.prediction, step) == 0.0  # as long as nothing is missing
    after.prediction.follow(before.prediction, step, 0.5)
    missing = predicted(form, after.state.stress - after.prediction.stress)
    strain = missing / (100.0 / (3.0 * (1.0 - 2.0 * 0.48)))
    expected = float(np.vdot(form.weight, strain * before.prediction.change(step)))
    assert after.prediction.work(before.prediction, step) == pytest.approx(expected, rel=1e-10)


PREDICTED = {
    "elastic": (sc.LinearElastic(E=1.0, nu=0.3), WholeStress),
    "rubber": (sc.LinearElastic(E=1.0, nu=0.45), MeanStress),
    "clay": (sc.Tresca(E=1.0, nu=0.3, c=0.01), MeanStress),
    "anisotropic clay": (sc.NgiAdp.from_ratios(1.0, 0.7, 0.5, 400.0, 0.02, 0.03, 0.05), MeanStress),
    "sand": (sc.MohrCoulomb(E=1.0, nu=0.45, c=0.01, phi=30.0), type(None)),
    "cone": (sc.DruckerPrager(E=1.0, nu=0.45, k=0.01, alpha=0.2), type(None)),
    "hardening sand": (sc.HardeningSoil(3e4, 3e4, 9e4, m=0.5, c=0.1, phi=35.0), type(None)),
}


@pytest.mark.parametrize("name", PREDICTED)
def test_where_they_are_predicted(name: str) -> None:
    """[X] Mean stresses of bodies that hardly change volumes, whole ones of other elastic bodies.

    Small kinematics and others have none.
    """
    law, expected = PREDICTED[name]
    form, x = body("plane", law)
    state = form.initial_state()
    assert type(form.assemble(0.0 * x, state).prediction) is expected
    small = sc.SolidForm(form.basis, law)
    assert small.assemble(0.0 * x, small.initial_state()).prediction is None


def test_bulk_moduli_by_element() -> None:
    """[X] Moduli by element predict the law's change of p in each; a region of sand predicts none.

    Another law of the same elasticity predicts anew.
    """
    mesh = MeshTri().refined(2).with_subdomains({"clay": lambda x: x[0] < 0.5})
    mesh = mesh.with_subdomains({"sand": lambda x: x[0] > 0.5})
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=4)
    E = np.linspace(1.0, 1e3, len(mesh.subdomains["clay"]))
    rubber = sc.LinearElastic(E=E, nu=0.48)
    laws = {"clay": rubber, "sand": sc.MohrCoulomb(E=1.0, nu=0.3, c=0.1, phi=30.0)}
    form = sc.SolidForm(basis, laws, kinematics="finite")
    rng = np.random.default_rng(1)
    step = 1e-3 * rng.standard_normal(basis.N)
    state = form.initial_state()
    before = form.assemble(basis.zeros(), state)
    after = form.assemble(1e-2 * step, state)
    after.prediction.follow(before.prediction, step, 1e-2)
    exact = after.state.stress[:3].mean(axis=0)
    predicted = after.prediction.stress[:3].mean(axis=0)
    part = form.regions[0].elements
    # squares of strains of 1e-5 by element; k of another one is off by up to all of it
    size = np.abs(exact[part]).max(axis=1, keepdims=True)
    assert (np.abs(predicted - exact)[part] < 1e-3 * size).all()
    others = form.regions[1].elements
    np.testing.assert_array_equal(predicted[others], exact[others])
    assert np.isfinite(after.prediction.work(before.prediction, step))

    elastic = form.with_materials({"clay": sc.LinearElastic(E=E, nu=0.3)})
    assert elastic.assemble(step, elastic.initial_state()).prediction is None  # beside sand
    softer = form.with_materials({"clay": sc.LinearElastic(E=0.5 * E, nu=0.48)})
    change = softer.assemble(basis.zeros(), state).prediction.change(step)
    np.testing.assert_allclose(change[part], 0.5 * before.prediction.change(step)[part], rtol=1e-12)


def moved_top(form, way: float, increments: int = 1):
    """Return the stage in which the top of a body moves up by some way, and the force there."""
    top = form.basis.get_dofs("top")
    fixed = np.concatenate([form.basis.get_dofs("bottom").all(), top.all()])
    up = form.basis.zeros()
    up[top.all("u^2")] = way
    stage = sc.Stage("move", prescribed=up, increments=increments)
    end = sc.Model({"body": form}, fixed).run([stage], progress=False)["move"]
    return end, end.reactions()[top.all("u^2")].sum()


def test_equilibrium_is_the_one_of_the_law(monkeypatch) -> None:
    """[X] A block of clay squeezed by a tenth: as many digits as the tolerance without them."""
    stresses = []
    for predicts in (True, False):
        basis = Basis(
            MeshTri().refined(2).with_defaults(), ElementVector(ElementTriP2()), intorder=4
        )
        form = sc.SolidForm(basis, sc.Tresca(E=100.0, nu=0.49, c=1.0), kinematics="finite")
        if not predicts:
            monkeypatch.setattr(form, "_predicted_bulk", np.zeros((1, 1)))
        stage, _ = moved_top(form, -0.1, increments=8)
        stresses.append(stage.states["body"].stress)
    np.testing.assert_allclose(stresses[0], stresses[1], rtol=0, atol=1e-5)


def test_the_second_line_search_has_the_law(monkeypatch) -> None:
    """[X] Where full steps fail, a block of clay has the same force without predictions."""
    forces = []
    for fails in (False, True):
        basis = Basis(
            MeshTri().refined(1).with_defaults(), ElementVector(ElementTriP2()), intorder=4
        )
        form = sc.SolidForm(basis, sc.Tresca(E=100.0, nu=0.49, c=1.0), kinematics="finite")
        with monkeypatch.context() as patch:
            if fails:
                patch.setattr(newton, "full_step", fail)
            followed = counted(patch, System, "followed")
            _, force = moved_top(form, -0.05)
        assert (not followed) == fails
        forces.append(force)
    assert forces[1] == pytest.approx(forces[0], rel=1e-6)


def fail(*args) -> None:
    """Raise the error of a step without a response."""
    raise NotConverged("no response")


def test_increments_continue_with_the_last_change(monkeypatch) -> None:
    """[X] A sphere pushed into a disc of rubber takes fewer evaluations than by the accepted p."""
    n_evaluations = []
    begun = System.begun
    for continues in (True, False):
        x, y = np.linspace(0.0, 2.0, 9), np.linspace(-1.5, 0.0, 7)
        basis = Basis(
            MeshTri.init_tensor(x, y).with_defaults(), ElementVector(ElementTriP2()), intorder=4
        )
        rubber = sc.LinearElastic(E=100.0, nu=0.499)
        form = sc.SolidForm(basis, rubber, kinematics="finite", coordinates="axisymmetric")
        contact = sc.ContactPair(basis, "top", sc.rigid.circle((0.0, 0.4), 0.4), sc.Coulomb(mu=0.3))
        sides = [basis.get_dofs(name).all("u^1") for name in ("left", "right")]
        bottom = basis.get_dofs("bottom")
        fixed = np.concatenate([bottom.all(), *sides])
        model = sc.Model({"disc": form, "sphere": contact}, fixed)
        up = np.zeros(model.layout.size)
        up[bottom.all("u^2")] = 0.2
        with monkeypatch.context() as patch:
            if not continues:
                patch.setattr(
                    System, "begun", lambda self, first, x, _: begun(self, first, x, None)
                )
            calls = counted(patch, System, "evaluate")
            model.run([sc.Stage("push", prescribed=up, increments=5)], progress=False)
        n_evaluations.append(len(calls))
    # 80 for 116
    assert n_evaluations[0] < 0.8 * n_evaluations[1]


def bent(contact: bool, monkeypatch, whole: bool = True) -> tuple[float, int]:
    """Return the deflection of a slender cantilever, and the number of linear systems."""
    x, y = np.linspace(0.0, 1.0, 31), np.linspace(-0.01, 0.01, 2)
    mesh = MeshQuad.init_tensor(x, y).with_defaults()
    basis = Basis(mesh, ElementVector(ElementQuad2()), intorder=4)
    forms = {"beam": sc.SolidForm(basis, sc.LinearElastic(E=1.0, nu=0.3), kinematics="finite")}
    if contact:
        ground = sc.rigid.polyline([(-1.0, -1.0), (2.0, -1.0)])
        forms["ground"] = sc.ContactPair(basis, "bottom", ground, sc.Coulomb(), penalty=1.0)
    model = sc.Model(forms, basis.get_dofs("left").all())
    load = model.traction("right", (0.0, 6.0 * 0.02**2 / 12.0))
    with monkeypatch.context() as patch:
        if not whole:
            patch.setattr(WholeStress, "follow", lambda *args: None)
        stage = model.run([sc.Stage("bend", load, increments=4)], progress=False)[-1]
    return float(stage.x[: basis.N].max()), sum(stage.iterations)


def test_slender_bodies_take_fewer_iterations(monkeypatch) -> None:
    """[X] A cantilever bent by a load of 6 EI / L^2: a third of them, and the same deflection."""
    deflection, iterations = bent(False, monkeypatch)
    of_law, more = bent(False, monkeypatch, whole=False)
    assert deflection == pytest.approx(of_law, rel=1e-7)
    # 18 for 68
    assert iterations < 0.5 * more


def test_whole_stresses_are_not_predicted_beside_contact(monkeypatch) -> None:
    """[X] The same cantilever above rigid ground takes the iterations of the law's stresses."""
    assert bent(True, monkeypatch) == bent(True, monkeypatch, whole=False)


def test_a_swinging_bar_follows_the_law(monkeypatch) -> None:
    """[X] A bar swings under its weight by two thirds of its length in steps of a tenth second."""
    tips, iterations = [], []
    for whole in (True, False):
        x, y = np.linspace(0.0, 1.0, 21), np.linspace(-0.02, 0.02, 2)
        mesh = MeshQuad.init_tensor(x, y).with_defaults()
        basis = Basis(mesh, ElementVector(ElementQuad2()), intorder=4)
        elastic = sc.LinearElastic(E=2e4, nu=0.3)
        bar = sc.SolidForm(basis, elastic, kinematics="finite", unit_weight=10.0)
        fixed = basis.get_dofs("left").all()
        model = sc.Model({"bar": bar}, fixed, gravity_acceleration=9.81)
        with monkeypatch.context() as patch:
            if not whole:
                patch.setattr(WholeStress, "follow", lambda *args: None)
            swing = sc.Stage("swing", duration=0.5, dynamic=sc.Dynamic(0.1))
            stage = model.run([swing], progress=False)[-1]
        tips.append(stage.x[: basis.N].min())
        iterations.append(sum(stage.iterations))
    assert tips[0] == pytest.approx(tips[1], rel=1e-6)
    assert tips[0] < -0.65
    # 31 for 40
    assert iterations[0] < iterations[1]


def test_full_steps_do_not_strain_elastic_bodies_too_much() -> None:
    """[X] Rubber is pulled to 1.4 of its height; its stiffness is 1 to 1e4 from element to element.

    Steps that change strains by two found an equilibrium of 7076 in five increments.
    """
    forces = []
    for increments in (5, 20):
        x = np.linspace(0.0, 1.0, 5)
        basis = Basis(
            MeshQuad.init_tensor(x, x).with_defaults(), ElementVector(ElementQuad1()), intorder=2
        )
        E = 10.0 ** np.random.default_rng(0).uniform(0.0, 4.0, 16)
        rubber = sc.LinearElastic(E=E, nu=0.4999)
        form = sc.SolidForm(basis, rubber, kinematics="finite")
        _, force = moved_top(form, 0.4, increments)
        forces.append(force)
    assert forces[0] == pytest.approx(forces[1], rel=1e-6)
