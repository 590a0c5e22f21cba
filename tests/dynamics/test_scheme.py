"""Generalised-alpha method: order of accuracy, energy, damping, fronts of waves."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import Basis, ElementQuad1, ElementVector, MeshQuad

import skfem_contact as sc
from tests.dynamics.cases import QUIET, bar, oscillator, pushed


def swing(rho_inf: float, n: int, periods: float = 2.0, **settings):
    """Return the displacement under a sudden force 3 over the static one, and the result."""
    model, basis, top = oscillator()
    period = 2.0 * np.pi / 100.0
    moved = []
    dynamic = sc.Dynamic(period / n, rho_inf=rho_inf, **settings)
    stage = sc.Stage("swing", pushed(basis, 3.0), duration=periods * period, dynamic=dynamic)
    result = model.run(
        [sc.Stage("weight"), stage], on_increment=lambda s: moved.append(s.x[top[0]]), **QUIET
    )
    return (np.array(moved[1:]) - moved[0]) / 3e-4, result


@pytest.mark.parametrize("rho_inf", [1.0, 0.8, 0.5, 0.0])
def test_order_is_two(rho_inf):
    """[X] Under a sudden load u = F / k (1 - cos w t): halving the step leaves a quarter."""
    errors = []
    for n in (40, 80):
        found, _ = swing(rho_inf, n)
        exact = 1.0 - np.cos(np.arange(1, 2 * n + 1) / n * 2.0 * np.pi)
        errors.append(np.abs(found - exact).max() / 2.0)
    # the next term of the error is of fourth order, 2 % of the largest one
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.06)
    assert errors[1] < 0.016


def test_trapezoidal_rule_keeps_the_energy():
    """[X] Without damping kinetic and elastic energy are the work of the load, to round-off."""
    _, result = swing(1.0, 40)
    energy = result["swing"].energy
    largest = np.abs(energy["work"]).max()
    assert np.abs(energy["missing"]).max() < 1e-12 * largest
    assert " 0.00% of the energy missing" in result["swing"].summary["motion"]
    # at rest at the top of the swing all of the work is elastic, with that of the weight
    assert energy["kinetic"][20] < 1e-4 * largest


def test_scheme_damps_high_frequencies_only():
    """[X] The energy left after one period is rho_inf ** 2 each step for steps of many periods."""
    for rho_inf in (0.9, 0.5):
        model, basis, top = oscillator()
        period = 2.0 * np.pi / 100.0
        v = basis.zeros()
        v[top] = 1.0
        h = 1000.0 * period
        dynamic = sc.Dynamic(h, rho_inf=rho_inf, velocity=v)
        stage = sc.Stage("shake", duration=20 * h, dynamic=dynamic, keep="all")
        parts = model.run([sc.Stage("weight"), stage], **QUIET)["shake"].increments
        rate = np.abs(parts[19].velocity[top[0]] / parts[9].velocity[top[0]]) ** 0.1
        # a pair of equal roots: t rho^t for rho^t, 20 / 10 over ten steps at most
        assert rho_inf * 0.99 < rate < rho_inf * 2.0**0.1 * 1.01


def test_overshoot_of_damped_oscillator():
    """[X] Rayleigh damping of 5 % at the frequency: the overshoot is exp(-pi z / sqrt(1 - z^2))."""
    f = 100.0 / (2.0 * np.pi)
    damping = sc.Rayleigh(0.05, f=(f, 3.0 * f))
    found, result = swing(1.0, 400, periods=1.0, damping=damping)
    exact = np.exp(-np.pi * 0.05 / np.sqrt(1.0 - 0.05**2))
    assert found.max() - 1.0 == pytest.approx(exact, rel=1e-4)
    energy = result["swing"].energy
    largest = np.abs(energy["work"]).max()
    # the energy of the swing about the static displacement, after one period
    lost = 0.5 * 3.0 * 3e-4 * (1.0 - np.exp(-4.0 * np.pi * 0.05))
    assert energy["damping"][-1] == pytest.approx(lost, rel=0.02)
    assert np.abs(energy["missing"]).max() < 1e-12 * largest


def test_energies_of_a_body_that_yields():
    """[X] Elastic energy is s : C^-1 : s / 2, what else the stresses do is plastic."""
    mesh = MeshQuad.init_tensor([0.0, 1.0], np.linspace(0.0, 2.0, 5)).with_defaults()
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    law = sc.MohrCoulomb(E=1e4, nu=0.2, c=20.0, phi=20.0, psi=0.0)
    solid = sc.SolidForm(basis, law, unit_weight=20.0)
    model = sc.Model({"solid": solid}, basis.get_dofs("bottom").all(), gravity_acceleration=10.0)
    push = np.asarray(sc.traction(basis, "top", (15.0, 0.0)))
    settings = sc.Dynamic(0.002, rho_inf=1.0)
    shake = sc.Stage("shake", lambda t: push * (t < 0.1), duration=0.3, dynamic=settings)
    result = model.run([sc.Stage("weight"), shake], **QUIET)
    energy = result["shake"].energy

    def stored(stage):
        stress = stage.states["solid"].stress
        strain = np.tensordot(np.linalg.inv(law.elasticity(4)), stress, 1)
        return 0.5 * float((solid.weight * (stress * strain).sum(axis=0)).sum())

    change = stored(result["shake"]) - stored(result["weight"])
    assert energy["elastic"][-1] == pytest.approx(change, rel=1e-6)
    plastic = energy["plastic"]
    assert plastic[-1] > 0.1 * energy["work"].max()
    assert np.diff(plastic).min() > -1e-9 * plastic[-1]
    # the trapezoidal rule and steps in which points begin to flow
    assert np.abs(energy["missing"]).max() < 1e-9 * plastic[-1]


@pytest.mark.parametrize("case", [(False, "lumped"), (False, "consistent"), (True, "consistent")])
def test_bar_under_a_step_load(case):
    """[X] The front is at c t; behind it v = p / (rho c), sigma = -p; the end has moved v t."""
    quadratic, kind = case
    n = 50 if quadratic else 100
    solid, basis, across = bar(n, quadratic)
    fixed = [basis.get_dofs("right").all("u^1"), across]
    model = sc.Model({"bar": solid}, fixed, gravity_acceleration=10.0)
    load = sc.traction(basis, "left", (1.0, 0.0))
    end = 0.06
    settings = sc.Dynamic(5e-4, mass=kind, points=[(0.0, 0.0)])
    stage = sc.Stage("step", load, duration=end, dynamic=settings)
    found = model.run([stage], **QUIET)["step"]

    x = basis.doflocs[0]
    line = basis.nodal_dofs[0, basis.mesh.p[1] == 0.0]
    line = line[np.argsort(x[line])]
    v = 10.0 * found.velocity[line]
    # the front is smeared over 4 elements of the 60 that it has passed
    assert np.interp(0.5, v[::-1], x[line][::-1]) == pytest.approx(10.0 * end, rel=0.02)
    mass = solid.weight_matrix(False).diagonal() * (x > 0.05) * (x < 0.5)
    mass[across] = 0.0
    behind = 10.0 * mass @ found.velocity / mass.sum()
    assert behind == pytest.approx(1.0, abs=0.01)
    centres = solid.basis.mesh.p[0][solid.basis.mesh.t].mean(axis=0)
    stress = found.states["bar"].stress[0][(centres > 0.05) & (centres < 0.5)]
    assert -stress.mean() == pytest.approx(1.0, abs=0.01)
    moved = found.history((0.0, 0.0)).values[-1, 0]
    assert moved == pytest.approx(0.1 * end, rel=0.01)


def test_much_missing_energy_is_told():
    """[X] Two steps a period with rho_inf = 0 take most of the energy, which a warning says."""
    with pytest.warns(sc.AnalysisWarning, match=r"of the energy is missing, taken by the scheme"):
        _, result = swing(0.0, 2, periods=10.0)
    assert "of the energy missing" in result["swing"].summary["motion"]
