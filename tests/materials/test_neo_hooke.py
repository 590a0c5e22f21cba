"""Neo-Hookean rubber."""

from __future__ import annotations

import numpy as np
import pytest

import skfem_contact as sc


@pytest.mark.parametrize("ncomp", [4, 6])
@pytest.mark.parametrize("nu", [-0.2, 0.0, 0.3, 0.499])
def test_random_paths(nu: float, ncomp: int) -> None:
    """[N] Shapes, repetition and tangent, by the check of laws."""
    law = sc.NeoHooke(E=np.linspace(1.0, 2.0, 50), nu=nu)
    error = sc.testing.check_material(
        law,
        strain=0.1,
        dissipation=False,
        ncomp=ncomp,  # type: ignore[arg-type]
    )
    # central differences
    assert error < 1e-7


@pytest.mark.parametrize("ncomp", [4, 6])
def test_stresses_have_their_strains(ncomp: int) -> None:
    """[X] Strains of stretches from 1/20 to 20 follow from the stress to round-off."""
    rng = np.random.default_rng(0)
    law = sc.NeoHooke(E=2.0, nu=0.45)
    strain = 0.8 * rng.normal(size=(ncomp, 200))
    none = np.zeros((0, 200))
    stress = law.update(strain, np.zeros_like(strain), none).stress
    again = law.elastic_strain(stress, none)
    # stresses are a hundred moduli, which leaves 1e-13
    assert np.abs(again - strain).max() < 1e-11


def test_uniaxial_tension() -> None:
    """[X] tau = mu (l^2 - 1) + lambda ln J along each axis."""
    law = sc.NeoHooke(E=2.6, nu=0.3)
    lam, mu = law.lame
    strain = np.log([2.0, 0.8, 0.9])
    given = np.array([*strain, 0.0])[:, None]
    stress = law.update(given, np.zeros((4, 1)), np.zeros((0, 1))).stress[:, 0]
    exact = mu * (np.exp(2.0 * strain) - 1.0) + lam * strain.sum()
    assert stress[:3] == pytest.approx(exact, rel=1e-14)
    assert stress[3] == 0.0


@pytest.mark.parametrize("ncomp", [4, 6])
def test_strains_add_up(ncomp: int) -> None:
    """[X] Two updates and the response to the sum of their strains agree, tangents too."""
    law = sc.NeoHooke(E=np.array([1.0, 2.0, 3.0]), nu=0.4)
    first, second = 0.3 * np.random.default_rng(3).standard_normal((2, ncomp, 3, 2))
    none = np.zeros((0, 3, 2))
    halfway = law.update(first, np.zeros_like(first), none)
    end = law.update(second, halfway.stress, none)
    whole = law.at_strain(first + second, none)
    np.testing.assert_allclose(end.stress, whole.stress, rtol=0, atol=1e-12)
    np.testing.assert_allclose(end.tangent(), whole.tangent(), rtol=0, atol=1e-11)


def test_small_strains_are_linear() -> None:
    """[X] The stiffness without stress is Hooke's."""
    law, linear = sc.NeoHooke(E=3.0, nu=0.2), sc.LinearElastic(E=3.0, nu=0.2)
    zero = np.zeros((6, 1))
    D = law.elasticity(6, zero, np.zeros((0, 1)))[0]
    assert np.abs(D - linear.elasticity(6)).max() < 1e-14


@pytest.mark.parametrize("ncomp", [4, 6])
@pytest.mark.parametrize("gap", [1e-3, 1e-6, 1e-8, 1e-10, 0.0])
def test_stretches_that_nearly_meet(gap: float, ncomp: int) -> None:
    """[X] The shear modulus between two axes is mu exp(e_1 + e_2) sinh(e_1 - e_2) / (e_1 - e_2)."""
    law = sc.NeoHooke(E=3.0, nu=0.2)
    strain = np.zeros((ncomp, 1))
    strain[:3, 0] = 0.1 + gap, 0.1, -0.2
    update = law.update(strain, np.zeros_like(strain), np.zeros((0, 1)))
    ratio = np.sinh(gap) / gap if gap else 1.0
    exact = law.lame[1] * np.exp(0.2 + gap) * ratio
    # round-off over a gap of 1e-9, below which the limit is taken
    assert update.tangent()[0, 3, 3] == pytest.approx(exact, rel=1e-7)
