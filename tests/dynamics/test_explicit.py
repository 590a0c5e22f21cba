"""Explicit steps: stable length, fronts, energy, impact, refusals."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import csr_matrix, diags_array
from skfem import Basis, ElementQuad1, ElementTriP2, ElementVector, MeshQuad

import skfem_contact as sc
from skfem_contact.dynamics.explicit import critical_step
from tests.dynamics.cases import QUIET, bar, oscillator, pushed


@pytest.mark.parametrize("n", [3, 60])
def test_critical_step_of_a_chain(n):
    """[X] Springs k between masses m, free ends: w = 2 sqrt(k/m) cos(pi / 2n); h = 2 / w."""
    K = diags_array([-1.0, 2.0, -1.0], offsets=[-1, 0, 1], shape=(n, n)).tolil()
    K[0, 0] = K[n - 1, n - 1] = 1.0
    found = critical_step(csr_matrix(5.0 * K), csr_matrix((n, n)), np.full(n, 0.2), np.arange(n))
    exact = 1.0 / (5.0 * np.cos(np.pi / (2 * n)))
    # found from below, with the accuracy of the highest frequency
    assert exact * (1.0 - 2e-3) < found <= exact * (1.0 + 1e-9)


def test_critical_step_with_damping():
    """[X] One mass: 2 / w (sqrt(1 + z^2) - z)."""
    K, C = csr_matrix([[400.0]]), csr_matrix([[8.0]])
    z = 8.0 / (2.0 * 20.0)
    found = critical_step(K, C, np.ones(1), np.zeros(1, int))
    assert found == pytest.approx(2.0 / 20.0 * (np.sqrt(1.0 + z * z) - z), rel=1e-9)


def test_oscillator_is_of_second_order():
    """[X] Half of the step leaves a quarter of the error under a sudden load."""
    period = 2.0 * np.pi / 100.0
    errors = []
    for n in (40, 80):
        model, basis, _ = oscillator()
        settings = sc.Dynamic(period / n, explicit=True, points=[(0.0, 1.0)])
        stage = sc.Stage("swing", pushed(basis, 3.0), duration=period, dynamic=settings)
        found = model.run([sc.Stage("weight"), stage], **QUIET)["swing"]
        moved = found.history((0.0, 1.0)).values[:, 1]
        exact = 1.0 - np.cos(np.arange(n + 1) / n * 2.0 * np.pi)
        errors.append(np.abs((moved - moved[0]) / 3e-4 - exact).max())
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.05)


@pytest.mark.parametrize("power", [1, 2])
def test_load_that_rises_from_zero(power):
    """[X] A load t/T gives u/u_s = t/T - sin(w t) / w T, and (t/T)² gives
    (t/T)² - 2 (1 - cos(w t)) / (w T)²: the first steps gain no energy from nowhere.
    """
    period = 2.0 * np.pi / 100.0
    model, basis, _ = oscillator()
    load = pushed(basis, 3.0)
    settings = sc.Dynamic(period / 40, explicit=True, points=[(0.0, 1.0)])

    def rising(t):
        return load * (t / period) ** power

    stage = sc.Stage("rise", rising, duration=period, dynamic=settings)
    found = model.run([sc.Stage("weight"), stage], **QUIET)["rise"]
    moved = found.history((0.0, 1.0)).values[:, 1]
    share = np.arange(41) / 40
    angle = 2.0 * np.pi * share
    exact = share - np.sin(angle) / (2.0 * np.pi)
    if power == 2:
        exact = share**2 - 2.0 * (1.0 - np.cos(angle)) / (2.0 * np.pi) ** 2
    # (w h)² / 24 is .1 %
    assert np.abs((moved - moved[0]) / 3e-4 - exact).max() < 2e-3


def test_damped_oscillator_is_of_second_order():
    """[X] A sudden load on 20 % of critical damping, by the mass alone."""
    w, z = 100.0, 0.2
    period, damped = 2.0 * np.pi / w, w * np.sqrt(1.0 - z * z)
    errors = []
    for n in (40, 80):
        model, basis, _ = oscillator()
        damping = sc.Rayleigh(z, f=(1.0 / period, 1e6 / period))
        settings = sc.Dynamic(period / n, explicit=True, damping=damping, points=[(0.0, 1.0)])
        stage = sc.Stage("swing", pushed(basis, 3.0), duration=period, dynamic=settings)
        found = model.run([sc.Stage("weight"), stage], **QUIET)["swing"]
        moved = found.history((0.0, 1.0)).values[:, 1]
        t = np.arange(n + 1) / n * period
        swing = np.cos(damped * t) + z * w / damped * np.sin(damped * t)
        exact = 1.0 - np.exp(-z * w * t) * swing
        errors.append(np.abs((moved - moved[0]) / 3e-4 - exact).max())
    assert errors[1] < 1e-3
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.05)


def test_front_in_a_bar():
    """[X] With steps that pass one element the front is exact: u of the end is p t / (rho c)."""
    solid, basis, across = bar(100)
    fixed = [basis.get_dofs("right").all("u^1"), across]
    model = sc.Model({"bar": solid}, fixed, gravity_acceleration=10.0)
    load = sc.traction(basis, "left", (1.0, 0.0))
    settings = sc.Dynamic(explicit=True, points=[(0.0, 0.0)])
    stage = sc.Stage("step", load, duration=0.06, dynamic=settings)
    found = model.run([stage], **QUIET)["step"]
    # the longest step is that of a wave through one element, h / c
    assert len(found.iterations) == int(np.ceil(0.06 / (0.9e-3)))
    assert found.history((0.0, 0.0)).values[-1, 0] == pytest.approx(0.1 * 0.06, rel=0.005)
    assert np.abs(found.energy["missing"]).max() < 0.01 * found.energy["work"].max()


def test_restart_and_files(tmp_path):
    """[X] Two halves end like one run, and implicit steps may follow explicit ones."""
    solid, basis, across = bar(20)
    fixed = [basis.get_dofs("right").all("u^1"), across]
    model = sc.Model({"bar": solid}, fixed, gravity_acceleration=10.0)
    load = sc.traction(basis, "left", (1.0, 0.0))
    settings = sc.Dynamic(1e-3, explicit=True, damping=sc.Rayleigh(0.02, f=(1.0, 10.0)))
    one = model.run([sc.Stage("all", load, duration=0.1, dynamic=settings)], **QUIET)[-1]
    half = [sc.Stage(name, load, duration=0.05, dynamic=settings) for name in ("first", "second")]
    first = model.run(half[:1], **QUIET)
    first.save(tmp_path / "first.npz")
    again = sc.load_result(tmp_path / "first.npz", model)
    two = model.run(half[1:], start=again, **QUIET)[-1]
    for name in ("x", "velocity", "acceleration"):
        values = getattr(one, name)
        np.testing.assert_allclose(getattr(two, name), values, atol=1e-11 * np.abs(values).max())
    more = sc.Stage("more", load, duration=0.01, dynamic=sc.Dynamic(1e-3))
    assert model.run([more], start=again, **QUIET)["more"].time == pytest.approx(0.06)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::skfem_contact.AnalysisWarning")
def test_impact():
    """[X] Penalties: contact lasts 2 L / c and velocities are exchanged, without gain of energy."""
    n = 50
    h = 1.0 / n
    left = MeshQuad.init_tensor(np.linspace(-1.0, 0.0, n + 1), [0.0, h]).with_defaults()
    right = MeshQuad.init_tensor(np.linspace(0.0, 1.0, n + 1), [0.0, h]).with_defaults()
    mesh = sc.join_bodies({"a": left, "b": right})
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    solid = sc.SolidForm(basis, sc.LinearElastic(E=100.0, nu=0.0), unit_weight=10.0)
    pair = sc.ContactPair(basis, "a:right", "b:left", sc.Coulomb(), penalty=100.0 / h)
    across = basis.get_dofs().all("u^2")
    model = sc.Model({"bars": solid, "pair": pair}, across, gravity_acceleration=10.0)
    v = basis.zeros()
    v[basis.get_dofs(elements="a").all("u^1")] = 0.1
    settings = sc.Dynamic(0.5 * h / 10.0, explicit=True, velocity=v)
    seen = []
    stage = sc.Stage("fly", duration=0.3, dynamic=settings)
    found = model.run(
        [stage], on_increment=lambda s: seen.append(abs(s.contact("pair").force[0])), **QUIET
    )["fly"]
    time = np.arange(1, len(seen) + 1) * 0.05 * h
    # two elements of a compliance like that of an element
    assert time[np.array(seen) > 1e-6].max() == pytest.approx(0.2, rel=0.03)
    M = solid.weight_matrix(False).diagonal()
    b = basis.get_dofs(elements="b").all("u^1")
    # waves with the mass of contact nodes, see the chatter of implicit steps
    assert M[b] @ found.velocity[b] / M[b].sum() == pytest.approx(0.1, rel=0.03)
    energy = found.energy
    total = energy["kinetic"] + energy["elastic"] + energy["friction"]
    # central differences swing about the energy by (w h)^2
    assert total.max() < 1.1 * total[0]
    assert total[-1] == pytest.approx(total[0], rel=0.02)


def test_refusals():
    """[X] One sentence each: too long steps, nodes without mass, other masses."""
    model, basis, _ = oscillator()
    load = pushed(basis, 3.0)
    # w = 100, so that steps are at most 0.02
    stage = sc.Stage("swing", load, duration=1.0, dynamic=sc.Dynamic(0.03, explicit=True))
    with pytest.raises(ValueError, match=r"0.03, is longer than the longest stable one, 0.02"):
        model.run([stage], **QUIET)
    with pytest.raises(ValueError, match="explicit steps have lumped masses at all nodes"):
        sc.Dynamic(0.1, explicit=True, mass="consistent")
    with pytest.raises(ValueError, match="only explicit steps have a default"):
        sc.Dynamic()
    light = sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.0), unit_weight=20.0)
    line = [[0.0, 1.0], [0.0, 2.0]]
    mast = sc.Beam(basis, line, EI=10.0, EA=100.0, unit_weight=1.0)
    forms = {"solid": light, "mast": mast}
    fixed = [model.fixed, *mast.dofs((0.0, 1.0))]
    both = sc.Model(forms, fixed, gravity_acceleration=10.0)
    explicit = sc.Stage("swing", duration=1.0, dynamic=sc.Dynamic(explicit=True))
    with pytest.raises(ValueError, match="need a mass at every free dof"):
        both.run([explicit], **QUIET)


def test_unstable_contact_is_told():
    """[X] A penalty that is too stiff for the steps gains energy, and the run ends."""
    mesh = MeshQuad.init_tensor(np.linspace(0, 1, 5), np.linspace(0, 1, 5)).with_defaults()
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    solid = sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.2), unit_weight=10.0)
    plate = sc.rigid.line((-5.0, -0.01), (5.0, -0.01))
    pair = sc.ContactPair(basis, "bottom", plate, sc.Coulomb(), "nodal", penalty=1e8)
    model = sc.Model(
        {"solid": solid, "pair": pair},
        basis.get_dofs().all("u^1"),
        gravity_acceleration=10.0,
    )
    stage = sc.Stage("fall", duration=1.0, dynamic=sc.Dynamic(explicit=True))
    with pytest.raises(sc.NotConverged, match=r"gains energy|run away"):
        model.run([stage], **QUIET)


def test_quadratic_elements():
    """[X] Scaled diagonals are positive at all nodes of elements of second order."""
    mesh = MeshQuad.init_tensor(np.linspace(0, 1, 4), [0.0, 0.3]).to_meshtri().with_defaults()
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=4)
    solid = sc.SolidForm(basis, sc.LinearElastic(E=100.0, nu=0.2), unit_weight=10.0)
    model = sc.Model({"solid": solid}, basis.get_dofs("right").all(), gravity_acceleration=10.0)
    load = sc.traction(basis, "left", (1.0, 0.0))
    stage = sc.Stage("push", load, duration=0.1, dynamic=sc.Dynamic(explicit=True))
    implicit = sc.Stage("push", load, duration=0.1, dynamic=sc.Dynamic(1e-4, rho_inf=1.0))
    one, other = (model.run([each], **QUIET)["push"].x for each in (stage, implicit))
    np.testing.assert_allclose(one, other, atol=0.02 * np.abs(other).max())


def test_dashpots_keep_steps_stable():
    """[X] A wave leaves at dashpots with steps of 0.9 of the longest one without dashpots."""
    solid, basis, across = bar(100)
    forms = {"bar": solid, "end": sc.ViscousBoundary(solid, "right")}
    held = np.union1d(across, basis.get_dofs("right").all())
    model = sc.Model(forms, held, gravity_acceleration=10.0)
    load = np.asarray(sc.traction(basis, "left", (1.0, 0.0)))

    def push(t):
        return load * np.exp(-(((t - 0.03) / 0.01) ** 2))

    settings = sc.Dynamic(0.9e-3, explicit=True)
    stage = sc.Stage("push", push, duration=0.25, dynamic=settings, fixed=across)
    energy = model.run([stage], **QUIET)["push"].energy
    assert energy["kinetic"].max() > 0.4 * energy["work"][-1]
    assert energy["kinetic"][-1] < 1e-3 * energy["kinetic"].max()
