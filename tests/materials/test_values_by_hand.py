"""Strengths and stiffnesses of materials against numbers computed by hand."""

from __future__ import annotations

import numpy as np
import pytest

import skfem_contact as sc
from skfem_contact.materials.spectral import extremes, product, square

#: Exact up to the round-off of a few operations.
EXACT = {"rtol": 1e-12, "atol": 1e-12}


def test_strengths_of_mohr_coulomb():
    """[X] c = 10, phi = 30: tension of 17.32; stresses -20, -35, -60 mobilise 20 of 8.66 + 20; s_u
    at 40 is 28.66, and none in tension.
    """
    soil = sc.MohrCoulomb(E=1e4, nu=0.3, c=10.0, phi=30.0)
    stress = np.array([-20.0, -60.0, -35.0, 0.0])[:, None, None]
    used, there = soil.mobilised(stress, np.zeros((0, 1, 1)))
    root = np.sqrt(3.0)
    np.testing.assert_allclose(soil.tensile_strength, 10.0 * root, **EXACT)
    np.testing.assert_allclose([used.item(), there.item()], [20.0, 5.0 * root + 20.0], **EXACT)
    np.testing.assert_allclose(
        soil.undrained_strength(np.array([40.0, -40.0]), np.zeros((0, 2))),
        [5.0 * root + 20.0, 0.0],
        **EXACT,
    )
    reduced = soil.reduced(2.0)
    np.testing.assert_allclose(
        [reduced.c, np.tan(np.radians(reduced.phi))], [5.0, 0.5 / root], **EXACT
    )


def test_strengths_of_cones():
    """[X] Drucker-Prager by its definition and in plane strain; von Mises; all reduced."""
    cone, stress = (
        sc.DruckerPrager(1e4, 0.3, k=8.0, alpha=0.2, beta=0.1),
        np.array([-20.0, -60.0, -40.0, 0.0]),
    )
    used, there = cone.mobilised(stress[:, None, None], np.zeros((0, 1, 1)))
    np.testing.assert_allclose([used.item(), there.item()], [20.0, 8.0 + 0.2 * 120.0], **EXACT)
    half = cone.reduced(2.0)
    np.testing.assert_allclose([half.k, half.alpha], [4.0, 0.1], **EXACT)
    plane = sc.DruckerPrager.plane_strain(1e4, 0.3, c=10.0, phi=30.0, psi=30.0)
    np.testing.assert_allclose(
        [plane.k, plane.alpha], [30.0 / np.sqrt(13.0), 1 / np.sqrt(39.0)], **EXACT
    )
    np.testing.assert_allclose(
        sc.VonMises(1e4, 0.3, strength=30.0).reduced(1.5).strength, 20.0, **EXACT
    )


def test_elasticity():
    """[X] E = 10, nu = 0.25: both of Lame's parameters are 4."""
    D = np.full((3, 3), 4.0) + 8.0 * np.eye(3)
    for ncomp in (4, 6):
        found = sc.LinearElastic(10.0, 0.25).elasticity(ncomp)
        np.testing.assert_allclose(found[:3, :3], D, **EXACT)
        np.testing.assert_allclose(found[3:, 3:], 4.0 * np.eye(ncomp - 3), **EXACT)


def test_undrained_pressure():
    """[X] The water resists the volume strain of -0.01 with 99; the soil, E = 3 and nu = 0, with
    1.
    """
    clay = sc.Undrained(sc.LinearElastic(E=3.0, nu=0.0), bulk_modulus_water=99.0)
    found = clay.update(
        np.array([[-0.01], [0.0], [0.0], [0.0]]), np.zeros((4, 1)), np.zeros((1, 1))
    )
    np.testing.assert_allclose(found.internal[-1], 0.99, **EXACT)
    np.testing.assert_allclose(found.stress[:, 0], [-1.02, -0.99, -0.99, 0.0], **EXACT)


@pytest.mark.parametrize("ncomp", [4, 6])
def test_products_of_deviators(ncomp: int) -> None:
    """[X] Shears count twice in the product of two tensors, and of one with itself."""
    places = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)][:ncomp]
    tensors = np.zeros((2, 3, 3))
    components = np.random.default_rng(3).standard_normal((2, ncomp))
    for k, (i, j) in enumerate(places):
        tensors[:, i, j] = tensors[:, j, i] = components[:, k]
    e, f = components[:, :, None]
    assert product(e, f) == pytest.approx((tensors[0] * tensors[1]).sum(), rel=1e-12)
    assert square(e) == pytest.approx((tensors[0] ** 2).sum(), rel=1e-12)


@pytest.mark.parametrize("size", [1e-120, 1.0, 1e120])
@pytest.mark.filterwarnings("error")
def test_extremes_of_stresses_of_any_size(size: float) -> None:
    """[N] Principal stresses by numpy, also of 1e120, which iterations beyond a collapse pass."""
    xx, yy, zz, xy, yz, zx = -3.0, 1.0, -2.0, 0.5, -1.5, 0.7
    right = np.linalg.eigvalsh([[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]])
    largest, smallest = extremes(size * np.array([xx, yy, zz, xy, yz, zx])[:, None])
    found = [smallest.item() / size, largest.item() / size]
    np.testing.assert_allclose(found, right[[0, 2]], rtol=2e-7)  # bounds are 1e-7 outside
    assert found[0] < right[0] and right[2] < found[1]
