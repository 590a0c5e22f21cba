"""Hardening and softening Mohr-Coulomb: implicit yield condition, tangent, histories, shear
test.
"""

from __future__ import annotations

import numpy as np
import pytest

from skfem_contact.materials import HardeningMohrCoulomb, MohrCoulomb, hardening
from tests.tools.material_points import (
    assert_history,
    assert_tangent,
    principal_stresses,
    random_points,
    update,
)

COMPONENTS = pytest.mark.parametrize("ncomp", [4, 6])
# c, c_end, phi, phi_end, strain_end, psi; E = 2e4, nu = 0.3
LAWS = {
    "softening": (10.0, 2.0, 30.0, 20.0, 0.01, 5.0),
    "hardening": (2.0, 10.0, 20.0, 35.0, 0.01, 0.0),
    "clay": (20.0, 5.0, 0.0, 0.0, 0.02, 0.0),
    "both": (5.0, 0.0, 20.0, 40.0, 0.003, 20.0),
}
ALL_LAWS = pytest.mark.parametrize("law", LAWS.values(), ids=LAWS.keys())


def soil(law: tuple[float, ...]) -> HardeningMohrCoulomb:
    c, c_end, phi, phi_end, strain_end, psi = law
    return HardeningMohrCoulomb(2e4, 0.3, c, c_end, phi, phi_end, strain_end, psi)


def strength(material: HardeningMohrCoulomb, strain: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Cohesion and friction angle in degrees at an equivalent plastic shear strain."""
    progress = np.minimum(strain / material.strain_end, 1)
    return (
        material.c + progress * (material.c_end - material.c),
        material.phi + progress * (material.phi_end - material.phi),
    )


def excess(material: HardeningMohrCoulomb, stress: np.ndarray, strain: np.ndarray) -> np.ndarray:
    c, phi = strength(material, strain)
    sine, cosine = np.sin(np.radians(phi)), np.cos(np.radians(phi))
    s = principal_stresses(stress)
    return (1 + sine) * s[..., 2] - (1 - sine) * s[..., 0] - 2 * c * cosine


@COMPONENTS
@ALL_LAWS
@pytest.mark.one_in(2)
def test_end_of_increment_is_perfectly_plastic(law: tuple[float, ...], ncomp: int) -> None:
    """[X] The stress is that of the perfect law with the strength at the end of the increment."""
    material = soil(law)
    rng = np.random.default_rng(1)
    strain, stress = random_points(20_000, ncomp, rng), np.zeros((ncomp, 20_000))
    accepted = rng.uniform(0, 1.5 * material.strain_end, (1, 20_000))
    result = material.update(strain, stress, accepted)
    c, phi = strength(material, result.internal[0])
    perfect = MohrCoulomb(2e4, 0.3, c=c, phi=phi, psi=np.minimum(material.psi, phi))
    reference = perfect.update(strain, stress, accepted)
    # Strengths to the tolerance of the strain, 1e-14 of the trial strain, over strain_end.
    np.testing.assert_allclose(result.stress, reference.stress, atol=1e-10)
    np.testing.assert_allclose(result.internal, reference.internal, atol=1e-14)
    assert result.plastic.size > 5000
    progress = result.internal[0, result.plastic] / material.strain_end
    assert (progress < 1).any() and (progress > 1).any()


@ALL_LAWS
def test_steps_of_newtons_method_suffice(
    law: tuple[float, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    """[X] The bounds of the plastic strain are halved only where no step stays between them."""
    material = soil(law)
    rng = np.random.default_rng(1)
    strain, stress = random_points(2_000, 4, rng), np.zeros((4, 2_000))
    accepted = rng.uniform(0, 1.5 * material.strain_end, (1, 2_000))
    exact = material.update(strain, stress, accepted).internal
    monkeypatch.setattr(hardening, "_HALVINGS", 0)
    np.testing.assert_allclose(
        material.update(strain, stress, accepted).internal, exact, rtol=1e-12, atol=1e-14
    )


@COMPONENTS
@ALL_LAWS
@pytest.mark.one_in(2)
def test_tangent(law: tuple[float, ...], ncomp: int) -> None:
    """[X] Finite differences, the change of strength included."""
    assert_tangent(soil(law), random_points(5000, ncomp, np.random.default_rng(2), size=3e-3))


@COMPONENTS
@ALL_LAWS
@pytest.mark.one_in(2)
def test_random_history(law: tuple[float, ...], ncomp: int) -> None:
    """[X] Dissipation, no excess over the current surface, no drift."""
    material = soil(law)
    assert_history(
        material, lambda stress, strain: excess(material, stress, strain), ncomp, steps=30
    )


@COMPONENTS
def test_without_change_of_strength(ncomp: int) -> None:
    """[X] Equal first and last values are the perfect law."""
    strain = random_points(2000, ncomp, np.random.default_rng(3))
    constant = update(HardeningMohrCoulomb(2e4, 0.3, 10.0, 10.0, 30.0, 30.0, 0.1, 5.0), strain)
    perfect = update(MohrCoulomb(2e4, 0.3, 10.0, 30.0, 5.0), strain)
    np.testing.assert_allclose(constant.stress, perfect.stress, atol=1e-12)
    np.testing.assert_allclose(constant.tangent(), perfect.tangent(), atol=1e-8)


@COMPONENTS
@pytest.mark.parametrize("c_end", [5.0, 40.0])
def test_shear_of_clay(c_end: float, ncomp: int) -> None:
    """[X] In simple shear the stress is c at gamma_p / sqrt(3), whatever the steps."""
    material = HardeningMohrCoulomb(
        1e4, 0.3, c=20.0, c_end=c_end, phi=0.0, phi_end=0.0, strain_end=0.1
    )
    stress, internal = np.zeros((ncomp, 1)), np.zeros((1, 1))
    _, mu = material.lame
    gamma = 0.0
    for step in (0.001, 0.02, 0.05, 0.001, 0.1, 0.1):
        gamma += step
        increment = np.zeros((ncomp, 1))
        increment[3] = step
        result = material.update(increment, stress, internal)
        stress, internal = result.stress, result.internal
        slope = (c_end - 20.0) / 0.1 / np.sqrt(3)
        changing = max((mu * gamma - 20.0) / (mu + slope), 0.0)
        plastic = changing if changing < 0.1 * np.sqrt(3) else gamma - c_end / mu
        assert stress[3, 0] == pytest.approx(mu * (gamma - plastic), rel=1e-11)
        assert internal[0, 0] == pytest.approx(plastic / np.sqrt(3), rel=1e-11, abs=1e-15)


@COMPONENTS
def test_any_parameters(ncomp: int) -> None:
    """[X] Changes of strength over 1e-6 to 1, in each element others: the surface at the end is
    reached.

    Softening faster than elastic unloading jumps to a strength where the yield condition holds.
    """
    rng = np.random.default_rng(4)
    n = 20_000
    phi, phi_end = rng.uniform(0, 50, (2, n))
    psi = np.minimum(phi, phi_end) * rng.uniform(0, 1, n)
    c, c_end = rng.uniform(0, 20, n), rng.uniform(0, 200, n)
    material = HardeningMohrCoulomb(
        10 ** rng.uniform(2, 6, n),
        rng.uniform(0, 0.49, n),
        c,
        c_end,
        phi,
        phi_end,
        10 ** rng.uniform(-6, 0, n),
        psi,
    )
    trial = rng.normal(size=(ncomp, n)) * 50
    result = update(material, np.zeros_like(trial), trial)
    assert np.isfinite(result.tangent()).all()
    over = excess(material, result.stress, result.internal[0])
    # the round-off of stresses of some 100
    assert over.max() <= 1e-11
    np.testing.assert_allclose(over[result.plastic], 0, atol=1e-11)
    # and from outside: with this strength the perfect law returns to the same stress
    c, phi = strength(material, result.internal[0])
    perfect = MohrCoulomb(material.E, material.nu, c, phi, np.minimum(psi, phi))
    np.testing.assert_allclose(
        update(perfect, np.zeros_like(trial), trial).stress, result.stress, atol=1e-10
    )


def test_parameters_of_each_element() -> None:
    """[X] Arrays of parameters give what the elements give one by one."""
    rng = np.random.default_rng(5)
    parameters = {
        "E": [1e4, 2e4],
        "nu": [0.2, 0.3],
        "c": [5.0, 10.0],
        "c_end": [8.0, 1.0],
        "phi": [0.0, 30.0],
        "phi_end": [0.0, 20.0],
        "strain_end": [0.01, 0.02],
        "psi": [0.0, 5.0],
    }
    strain, internal = rng.normal(size=(4, 2, 30)) * 3e-3, rng.uniform(0, 0.02, (1, 2, 30))
    whole = HardeningMohrCoulomb(**parameters).update(strain, np.zeros_like(strain), internal)
    tangent = np.zeros((2, 30, 4, 4))
    tangent.reshape(-1, 4, 4)[whole.plastic] = whole.tangent()
    for i in range(2):
        single = HardeningMohrCoulomb(**{name: value[i] for name, value in parameters.items()})
        part = single.update(strain[:, i], np.zeros((4, 30)), internal[:, i])
        assert part.plastic.size
        np.testing.assert_allclose(whole.stress[:, i], part.stress, atol=1e-11)
        np.testing.assert_allclose(whole.internal[:, i], part.internal, atol=1e-15)
        np.testing.assert_allclose(tangent[i, part.plastic], part.tangent(), atol=1e-6)


@pytest.mark.parametrize(
    "bad, message",
    [
        ({"c_end": -1.0}, r"c_end must not be negative, got -1\.0"),
        ({"phi_end": 90.0}, r"phi_end must lie in \[0, 90\) degrees, got 90\.0"),
        ({"phi_end": 3.0}, r"psi must not exceed phi_end, got 5\.0"),
        ({"strain_end": 0.0}, r"strain_end must be positive, got 0\.0"),
        ({"psi": -1.0}, r"psi must not be negative, got -1\.0"),
    ],
)
def test_bad_parameters(bad: dict, message: str) -> None:
    good = {
        "E": 1e4,
        "nu": 0.3,
        "c": 1.0,
        "c_end": 2.0,
        "phi": 20.0,
        "phi_end": 30.0,
        "strain_end": 0.1,
        "psi": 5.0,
    }
    with pytest.raises(ValueError, match=message):
        HardeningMohrCoulomb(**(good | bad))


def test_reduced_strength() -> None:
    law = soil(LAWS["both"]).reduced(2.0)
    assert (law.c, law.c_end) == (2.5, 0.0)
    tangents = np.tan(np.radians([law.phi, law.phi_end]))
    np.testing.assert_allclose(tangents, np.tan(np.radians([20.0, 40.0])) / 2, rtol=1e-14)
    assert law.psi == law.phi  # it was associated


def test_mobilised_strength_follows_the_softening() -> None:
    """[X] Half way from c = 20 to c = 5 without friction the shear strength is 12.5."""
    clay = HardeningMohrCoulomb(1e4, 0.3, c=20.0, c_end=5.0, phi=0.0, phi_end=0.0, strain_end=0.1)
    _, limit = clay.mobilised(np.zeros((4, 1)), np.full((1, 1), 0.05))
    np.testing.assert_allclose(limit, 12.5, rtol=1e-12)  # three operations
