"""Soft Soil Creep: secondary compression in closed form, rates, tangent, bad input."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from skfem import Basis, ElementQuad1, ElementVector, MeshQuad

import skfem_contact as sc
from skfem_contact.laboratory import PathStep, oedometer
from skfem_contact.materials.soft_soil_creep import _mean

KAPPA, LAMBDA, M, NU, MU, DAY = 0.02, 0.1, 1.2, 0.25, 0.004, 1.0


def clay(**changes: Any) -> sc.SoftSoilCreep:
    soil = {
        "kappa": KAPPA,
        "lambda_": LAMBDA,
        "M": M,
        "nu": NU,
        "p_ref": 100.0,
        "mu": MU,
        "tau": DAY,
    }
    return sc.SoftSoilCreep(**(soil | changes))


@pytest.mark.parametrize("increments", [1, 4])
@pytest.mark.parametrize("ocr", [1.0, 1.3, 3.0])
def test_isotropic_stress_that_is_held(ocr: float, increments: int) -> None:
    """[X] mu ln(1 + t / tau OCR^-beta) over nine decades of time, in any number of increments."""
    held = PathStep(
        stress=dict.fromkeys(("xx", "yy", "zz")), strain={"xy": 0.0}, increments=increments
    )
    for duration in 10.0 ** np.arange(-3, 7, 3):
        step = PathStep(held.stress, held.strain, increments=increments, duration=duration)
        volume = sc.element_test(clay(OCR=ocr), -100.0, step).volume[-1, 0]
        exact = -MU * np.log1p(duration / DAY * ocr ** -((LAMBDA - KAPPA) / MU))
        assert volume == pytest.approx(
            exact, rel=1e-8, abs=1e-13
        )  # Newton's tolerance of the stress


@pytest.mark.parametrize("increments", [1, 5])
def test_oedometer_under_constant_load(increments: int) -> None:
    """[X] At the stress ratio whose flow has no lateral strain the load is held for decades: the
    logarithm of time.
    """
    eta = (9 + 4 * M**2) ** 0.5 / 2 - 1.5  # 2 eta / (M^2 - eta^2) = 2 / 3
    lateral = (1 - eta / 3) / (1 + 2 * eta / 3)
    stress = -100.0 * np.array([[lateral], [1.0], [lateral], [0.0]])
    share = 1 - (eta / M) ** 2
    path = [
        PathStep(
            stress={"yy": None},
            strain={"xx": 0.0, "zz": 0.0, "xy": 0.0},
            increments=increments,
            duration=t,
        )
        for t in (1.0, 9.0, 90.0, 900.0, 9000.0)
    ]
    test = sc.element_test(clay(), stress, path)
    strain = -test.axial[::increments, 0][1:]
    np.testing.assert_allclose(strain, MU * np.log1p(share * 10.0 ** np.arange(5)), rtol=1e-7)
    np.testing.assert_allclose(test.stress[-1, 0, 0], stress[0, 0], rtol=1e-8)
    assert strain[-1] - strain[-2] == pytest.approx(
        MU * np.log(10), rel=1e-3
    )  # C_alpha of a decade


def test_secondary_compression_after_loading() -> None:
    """[X] Loaded in a day and held for years, a normally consolidated oedometer creeps by mu an
    e-fold of time.
    """
    K0 = 0.6
    start = -50.0 * np.array([[K0], [1.0], [K0], [0.0]])
    load = oedometer(-100.0, increments=10)
    load = PathStep(load.stress, load.strain, increments=10, duration=1.0)
    held = [
        PathStep(
            stress={"yy": None}, strain={"xx": 0.0, "zz": 0.0, "xy": 0.0}, increments=5, duration=t
        )
        for t in (1e4, 9e4)
    ]
    test = sc.element_test(clay(), start, [load, *held])
    assert test.axial[-6, 0] - test.axial[-1, 0] == pytest.approx(
        MU * np.log(10), rel=0.02
    )  # K0 still drifts


@pytest.mark.parametrize("increments", [1, 4])
@pytest.mark.parametrize("ocr", [1.0, 1.5, 3.0])
def test_isotropic_load_that_grows_evenly(ocr: float, increments: int) -> None:
    """[X] R_0 is linear in time: the integral of its power beta is known, in any number of
    increments.
    """
    beta, r = (LAMBDA - KAPPA) / MU, 0.6
    for time in (0.01, 1.0, 100.0):
        load = PathStep(
            stress=dict.fromkeys(("xx", "yy", "zz"), -100.0),
            strain={"xy": 0.0},
            increments=increments,
            duration=time,
        )
        held = PathStep(
            stress=dict.fromkeys(("xx", "yy", "zz")), strain={"xy": 0.0}, increments=1, duration=9.0
        )
        volume = sc.element_test(clay(OCR=ocr), -100.0 * r, [load, held]).volume[
            [increments, -1], 0
        ]
        aged = (
            np.cumsum([time * (1 - r ** (beta + 1)) / ((beta + 1) * (1 - r)), 9.0])
            * (r * ocr) ** -beta
        )
        np.testing.assert_allclose(
            -volume, -KAPPA * np.log(r) + MU * np.log1p(aged), rtol=1e-7
        )  # Newton's tolerance


@pytest.mark.parametrize("increments", [1, 4])
def test_volume_that_is_held(increments: int) -> None:
    """[X] Isotropic stress relaxes by the logarithm of time, in any number of increments."""
    power = LAMBDA / KAPPA
    for time in (0.1, 10.0, 1e4):
        still = PathStep(
            strain=dict.fromkeys(("xx", "yy", "zz", "xy"), 0.0),
            increments=increments,
            duration=time,
        )
        p = sc.element_test(clay(), -100.0, still).p[-1, 0]
        assert p == pytest.approx(
            100.0 * (1 + power * time / DAY) ** (-MU / KAPPA / power), rel=1e-9
        )


@pytest.mark.parametrize(
    ("ocr", "error"), [pytest.param(1.0, 0.01, marks=pytest.mark.slow), (1.3, 0.04)]
)  # the stress ratio changes beside it
def test_oedometer_loaded_in_one_increment(ocr: float, error: float) -> None:
    """[N] A load of a day in one increment has the strain of 80 increments, then and a year
    later.
    """
    strains = []
    for increments in (1, 80):
        load = oedometer(-100.0, increments=increments)
        load = PathStep(load.stress, load.strain, increments=increments, duration=1.0)
        held = PathStep(
            stress={"yy": None},
            strain={"xx": 0.0, "zz": 0.0, "xy": 0.0},
            increments=increments,
            duration=364.0,
        )
        test = sc.element_test(
            clay(OCR=ocr), -60.0 * np.array([[0.6], [1.0], [0.6], [0.0]]), [load, held]
        )
        strains.append(test.axial[[increments, -1], 0])
    assert strains[0][0] == pytest.approx(
        strains[1][0], rel=error
    )  # 0.15 to 0.38 with the rate of the last stress
    assert strains[0][1] == pytest.approx(strains[1][1], rel=0.005)


@pytest.mark.slow
def test_layer_that_creeps_for_years() -> None:
    """[X] A layer at rest settles by the logarithm of time, in one step or in stages; without time
    it says so.
    """
    eta = (9 + 4 * M**2) ** 0.5 / 2 - 1.5  # as above: no lateral strain
    mesh = MeshQuad.init_tensor(np.linspace(0, 1, 2), np.linspace(0, 2, 3)).with_defaults()
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    model = sc.Model(
        {"clay": sc.SolidForm(basis, clay(), unit_weight=0.0)},
        sc.box_supports(basis, base="rollers"),
    )
    load = model.traction("top", (0.0, -100.0))
    start = model.k0_state(load, K0=(1 - eta / 3) / (1 + 2 * eta / 3), surcharge=100.0)
    years = [
        sc.Stage("a year", load, duration=365.0),
        sc.Stage("30 years", load, duration=29 * 365.0),
    ]
    result = model.run(years, start=start, progress=False)
    for stage in result.stages[1:]:
        exact = 2.0 * MU * np.log1p((1 - (eta / M) ** 2) * stage.time / DAY)
        np.testing.assert_allclose(
            -stage.x[basis.get_dofs("top").all("u^2")], exact, rtol=1e-6
        )  # K0 to seven digits
    with pytest.warns(
        sc.AnalysisWarning, match=r"\['clay'\] would creep, but no stage takes any time"
    ):
        model.run([sc.Stage("more", 1.1 * load)], start=start, progress=False)


@pytest.mark.parametrize("rate", [1e-4, 1e-2, 1.0])
@pytest.mark.one_in(3)
def test_constant_rate_of_strain(rate: float) -> None:
    """[X] Isotropic compression leaves the line of normal consolidation by a power of its rate:
    second order.
    """
    errors = []
    for increments in (40, 80):
        squeezed = PathStep(
            strain={"xx": -0.05, "yy": -0.05, "zz": -0.05, "xy": 0.0},
            increments=increments,
            duration=0.15 / rate,
        )
        test = sc.element_test(clay(), -100.0, squeezed)
        ratio = test.p[-1, 0] / test.variable("preconsolidation pressure")[-1, 0]  # type: ignore[index]
        exact = (rate * (LAMBDA - KAPPA) / LAMBDA * DAY / MU) ** (MU / (LAMBDA - KAPPA))
        errors.append(abs(ratio / exact - 1))
    assert errors[1] < 1e-4
    assert errors[1] < 0.3 * errors[0]


@pytest.mark.parametrize("change", [-3.0, -0.3, -1e-5, 1e-5, 0.3, 3.0])
def test_mean_rate_of_an_increment(change: float) -> None:
    """[X] Over its end, with the slope of differences: a rate that grows is a power of a linear
    stress, a rate that falls one of the time.
    """
    beta = np.array([2.0, 20.0])
    constants = clay()._constants((4, 2))
    value, slope = _mean(np.full(2, change), beta, constants)
    power = beta if change > 0 else np.full(2, -(LAMBDA - KAPPA) / LAMBDA)
    begin = np.exp(-change / power)
    points, weights = np.polynomial.legendre.leggauss(60)
    linear = 0.5 * (1 + begin + np.outer(points, 1 - begin))
    exact = np.log(0.5 * weights @ linear**power)
    np.testing.assert_allclose(value, exact, atol=1e-12)
    ahead, behind = (_mean(np.full(2, change * k), beta, constants)[0] for k in (1.01, 0.99))
    np.testing.assert_allclose(slope, 1 + (ahead - behind) / (0.02 * change), atol=1e-4)


@pytest.mark.parametrize("dt", [0.0, 1e-3, 1.0, 1e4])
@pytest.mark.parametrize(("extension", "conservative"), [(1.0, False), (0.75, False), (0.75, True)])
def test_tangent(extension: float, conservative: bool, dt: float) -> None:
    """[N] Differences of the stress at random points, wet and dry of the critical state."""
    law = clay(extension=extension, OCR=1.2, conservative=conservative)
    n, rng = 200, np.random.default_rng(1)
    p = 10 ** rng.uniform(1, 3, n)
    stress = p * 0.25 * rng.standard_normal((4, n))
    stress[:3] -= stress[:3].mean(axis=0) + p
    stress, strain = stress[:, :, None], 1e-3 * rng.standard_normal((4, n, 1))
    internal = law.initial_internal(stress)
    new = law.update(strain, stress, internal, dt)
    tangent, largest = new.tangent(), law.elasticity(4, stress, internal)[:, 0].max(axis=(1, 2))
    for j in range(4):
        step = np.zeros_like(strain)
        step[j] = 1e-8
        ahead, behind = (
            law.update(strain + sign * step, stress, internal, dt).stress for sign in (1, -1)
        )
        quotient = ((ahead - behind) / 2e-8)[:, :, 0].T
        assert (np.abs(tangent[:, :, j] - quotient).max(axis=1) / largest).max() < 1e-6
    if dt == 0.0:  # elastic
        assert np.array_equal(new.internal, internal)


def test_long_time_is_plasticity_that_has_aged() -> None:
    """With a small creep index and a step of tau clay is Cam Clay."""
    strain = {"xx": -0.004, "yy": -0.01, "zz": -0.004, "xy": 0.0}
    creeping = sc.element_test(
        clay(mu=1e-5), -100.0, PathStep(strain=strain, increments=20, duration=20.0)
    )
    plastic = sc.element_test(
        sc.CamClay(KAPPA, LAMBDA, M, NU, 100.0), -100.0, PathStep(strain=strain, increments=20)
    )
    np.testing.assert_allclose(creeping.stress[-1], plastic.stress[-1], rtol=2e-3, atol=1e-9)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"mu": 0.0}, "mu must lie between 0 and lambda - kappa"),
        ({"mu": 0.09}, "mu must lie between 0 and lambda"),
        ({"tau": 0.0}, "tau must be positive"),
        ({"OCR": 0.9}, "OCR must not be less than 1"),
    ],
)
def test_bad_parameters(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        clay(**changes)
