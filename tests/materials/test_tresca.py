"""Tresca: the same as Mohr-Coulomb without friction, and its own strength."""

from __future__ import annotations

import numpy as np
import pytest

from skfem_contact.materials import MohrCoulomb, Tresca
from tests.tools.material_points import (
    assert_history,
    assert_tangent,
    principal_stresses,
    random_points,
    update,
)

COMPONENTS = pytest.mark.parametrize("ncomp", [4, 6])
CLAY = Tresca(E=2e4, nu=0.3, c=10.0)


@COMPONENTS
def test_is_mohr_coulomb_without_friction(ncomp: int) -> None:
    """[X] Bit for bit, since it is the same return mapping."""
    strain = random_points(2000, ncomp, np.random.default_rng(1))
    tresca, coulomb = update(CLAY, strain), update(MohrCoulomb(2e4, 0.3, c=10.0, phi=0.0), strain)
    np.testing.assert_array_equal(tresca.stress, coulomb.stress)
    np.testing.assert_array_equal(tresca.tangent(), coulomb.tangent())


@COMPONENTS
def test_largest_shear_stress(ncomp: int) -> None:
    """[X] Plastic points have the shear strength, and no plastic change of volume."""
    strain = random_points(5000, ncomp, np.random.default_rng(2))
    result = update(CLAY, strain)
    s = principal_stresses(result.stress[:, result.plastic])
    np.testing.assert_allclose((s[:, 2] - s[:, 0]) / 2, 10.0, rtol=1e-12)
    bulk = CLAY.E / (3 * (1 - 2 * CLAY.nu))
    # round-off of trial stresses up to 1e3
    np.testing.assert_allclose(
        result.stress[:3].mean(axis=0), bulk * strain[:3].sum(axis=0), atol=1e-12
    )


@COMPONENTS
def test_tangent(ncomp: int) -> None:
    """[X] Finite differences."""
    assert_tangent(CLAY, random_points(5000, ncomp, np.random.default_rng(3)))


@COMPONENTS
def test_random_history(ncomp: int) -> None:
    """[X] Dissipation, no excess, no drift."""
    assert_history(
        CLAY, lambda stress, _: np.ptp(principal_stresses(stress), axis=-1) - 20.0, ncomp
    )


def test_parameters() -> None:
    with pytest.raises(ValueError, match=r"c must not be negative, got -1\.0"):
        Tresca(1e4, 0.3, c=-1.0)
    with pytest.raises(ValueError, match=r"factor must be positive, got -2\.0"):
        CLAY.reduced(-2.0)
    np.testing.assert_array_equal(
        Tresca(1e4, 0.3, c=np.array([10.0, 20.0])).reduced(2.0).c, [5.0, 10.0]
    )
