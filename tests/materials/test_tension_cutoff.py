"""Tension cut-off of Mohr-Coulomb: all regions, tangent, histories."""

from __future__ import annotations

import numpy as np
import pytest

from skfem_contact.materials import MohrCoulomb
from tests.oracles.koiter import pyramid_return
from tests.tools.material_points import (
    Specimen,
    assert_history,
    assert_tangent,
    components,
    principal_stresses,
    random_points,
    random_strains,
    rotations,
    update,
)

COMPONENTS = pytest.mark.parametrize("ncomp", [4, 6])
# phi, psi, tension; E = 2e4, nu = 0.3, c = 10.
LAWS = {
    "associated": (30.0, 30.0, 5.0),
    "dilatant": (35.0, 10.0, 10.0),
    "psi = 0": (30.0, 0.0, 5.0),
    "no tension": (30.0, 0.0, 0.0),
    "Tresca": (0.0, 0.0, 4.0),
    "near the apex": (30.0, 10.0, 17.0),
}
ALL_LAWS = pytest.mark.parametrize("law", LAWS.values(), ids=LAWS.keys())


def soil(law: tuple[float, float, float], nu: float = 0.3) -> MohrCoulomb:
    phi, psi, tension = law
    return MohrCoulomb(E=2e4, nu=nu, c=10.0, phi=phi, psi=psi, tension=tension)


def excess(material: MohrCoulomb, stress: np.ndarray) -> np.ndarray:
    s = principal_stresses(stress)
    sine, cosine = np.sin(np.radians(material.phi)), np.cos(np.radians(material.phi))
    shear = (1 + sine) * s[..., 2] - (1 - sine) * s[..., 0] - 2 * material.c * cosine
    return np.maximum(shear, s[..., 2] - material.tension)


@COMPONENTS
@ALL_LAWS
@pytest.mark.parametrize("nu", [-0.9, 0.3, 0.49])
@pytest.mark.one_in(3)
def test_random_returns_against_active_sets(
    law: tuple[float, float, float], nu: float, ncomp: int
) -> None:
    """[X] Random points in all regions, where faces, tension planes, and both meet."""
    rng = np.random.default_rng(1)
    n = 8000
    material = soil(law, nu)
    principal = random_strains(n, rng)
    rotation = rotations(n, ncomp, rng)
    result = update(material, components(principal, rotation, ncomp, shear=2))
    lam, mu = material.lame
    trial = lam * principal.sum(axis=1, keepdims=True) + 2 * mu * principal
    phi, psi = np.radians(law[:2])
    expected, active = pyramid_return(
        trial, lam, mu, np.sin(phi), np.sin(psi), 20 * np.cos(phi), law[2]
    )

    s = -np.sort(-expected, axis=1)
    torn = np.abs(s - law[2]) < 1e-10
    on_pyramid = (
        np.abs((1 + np.sin(phi)) * s[:, 0] - (1 - np.sin(phi)) * s[:, 2] - 20 * np.cos(phi)) < 1e-10
    )
    regions = {(int(t), bool(p), int(a)) for t, p, a in zip(torn.sum(axis=1), on_pyramid, active)}
    assert regions >= {
        (1, False, 1),
        (2, False, 2),
        (3, False, 3),
        (1, True, 2),
        (1, True, 3),
        (2, True, 3),
    }
    # The trial stresses are up to some 100 (nu = -0.9: 1e4) times the cohesion.
    scale = np.maximum(np.abs(trial).max(axis=1), 10.0)
    assert (np.abs(result.stress - components(expected, rotation, ncomp)) / scale).max() <= 1e-12
    assert (excess(material, result.stress) / 10.0).max() <= 1e-11


@COMPONENTS
@ALL_LAWS
@pytest.mark.one_in(3)
def test_tangent(law: tuple[float, float, float], ncomp: int) -> None:
    """[X] Finite differences in all regions, equal principal stresses included."""
    assert_tangent(soil(law), random_points(10_000, ncomp, np.random.default_rng(2)))


@COMPONENTS
@ALL_LAWS
def test_random_history(law: tuple[float, float, float], ncomp: int) -> None:
    """[X] Dissipation, no excess, no drift."""
    material = soil(law)
    assert_history(material, lambda stress, _: excess(material, stress), ncomp)


@COMPONENTS
@pytest.mark.parametrize("tension", [10.0 / np.tan(np.radians(30.0)), 20.0, 1e6])
def test_cut_off_above_the_apex_is_none(tension: float, ncomp: int) -> None:
    """[X] It cannot be reached."""
    strain = random_points(5000, ncomp, np.random.default_rng(3))
    capped, plain = (
        update(MohrCoulomb(2e4, 0.3, 10.0, 30.0, 5.0, tension=t), strain) for t in (tension, None)
    )
    # at the apex itself the two may differ by its round-off
    np.testing.assert_allclose(capped.stress, plain.stress, atol=1e-13)
    np.testing.assert_allclose(capped.tangent(), plain.tangent(), atol=1e-13 * 2e4)


@COMPONENTS
def test_tension_test(ncomp: int) -> None:
    """[X] A bar is pulled to its tensile strength, cracks at constant stress, and unloads
    elastically.
    """
    specimen = Specimen(soil(LAWS["psi = 0"]), [0.0] * 4, ncomp)
    for _ in range(4):
        specimen.step({0: 1e-4}, {1: 0.0, 2: 0.0})
    np.testing.assert_allclose(specimen.stress[:, 0], [5.0] + [0.0] * (ncomp - 1), atol=1e-12)
    assert specimen.plastic_strain[0] == pytest.approx(4e-4 - 5.0 / 2e4, rel=1e-11)
    np.testing.assert_allclose(specimen.plastic_strain[1:], 0, atol=1e-16)
    specimen.step({0: -1e-4}, {1: 0.0, 2: 0.0})
    assert specimen.stress[0, 0] == pytest.approx(3.0, rel=1e-12)


def test_parameters_of_each_element() -> None:
    """[X] Arrays give what the elements give one by one; above the apex is no cut-off."""
    rng = np.random.default_rng(4)
    strain = rng.normal(size=(4, 3, 40)) * 3e-3
    tension = np.array([0.0, 5.0, 1e9])
    whole = update(MohrCoulomb(2e4, 0.3, 10.0, 30.0, tension=tension), strain)
    tangent = np.zeros((3, 40, 4, 4))
    tangent.reshape(-1, 4, 4)[whole.plastic] = whole.tangent()
    for i, value in enumerate((0.0, 5.0, None)):
        part = update(MohrCoulomb(2e4, 0.3, 10.0, 30.0, tension=value), strain[:, i])
        np.testing.assert_allclose(whole.stress[:, i], part.stress, atol=1e-12)
        np.testing.assert_allclose(tangent[i, part.plastic], part.tangent(), atol=1e-8)


def test_parameters() -> None:
    with pytest.raises(ValueError, match=r"tension must not be negative, got -1\.0"):
        MohrCoulomb(2e4, 0.3, 10.0, 30.0, tension=-1.0)
    with pytest.raises(ValueError, match="tension must be a finite number"):
        MohrCoulomb(2e4, 0.3, 10.0, 30.0, tension=np.inf)
    assert MohrCoulomb(2e4, 0.3, 10.0, 30.0, tension=5.0).reduced(2.0).tension == 2.5
