"""Stretches in space; what they share with the plane is in test_stretch_plane."""

from __future__ import annotations

import numpy as np

from skfem_contact.forms.stretch_plane import PlaneStretch
from skfem_contact.forms.stretch_space import SpaceStretch


def test_a_plane_stretch_in_space() -> None:
    """[N] Eigenvectors give what closed forms in the plane give: strains, stresses and moduli."""
    rng = np.random.default_rng(5)
    plane = 0.2 * rng.normal(size=(5, 6))
    space = np.zeros((9, 6))
    space[[0, 4, 8, 1, 3]] = plane
    elastic, t = 0.1 * rng.normal(size=(2, 4, 6))
    D = np.zeros((6, 6, 6))
    D[:, :4, :4] = rng.normal(size=(6, 4, 4))

    def in_space(values: np.ndarray) -> np.ndarray:
        return np.concatenate((values, np.zeros((2, 6))))

    a, b = PlaneStretch(plane), SpaceStretch(space)
    plastic = a.inverse_plastic(elastic)
    # round-off of eigenvectors
    assert np.abs(b.inverse_plastic(in_space(elastic)) - in_space(plastic)).max() < 1e-13
    assert np.abs(b.log_strain(in_space(plastic)) - in_space(a.log_strain(plastic))).max() < 1e-13
    S = a.second(t)
    assert np.abs(b.second(in_space(t)) - in_space(S)).max() < 1e-13
    moduli = b.moduli(D, in_space(S))[:, :4, :4]
    assert np.abs(moduli - a.moduli(D[:, :4, :4], S)).max() < 1e-12 * np.abs(moduli).max()


def test_growth_is_the_determinant() -> None:
    """[X] det F - 1, with full digits for small gradients."""
    rng = np.random.default_rng(8)
    gradient = 0.3 * rng.normal(size=(9, 7))
    F = np.eye(3) + gradient.T.reshape(-1, 3, 3)
    np.testing.assert_allclose(SpaceStretch.growth(gradient), np.linalg.det(F) - 1.0, rtol=1e-12)
    small = 1e-12 * gradient
    trace = small[[0, 4, 8]].sum(axis=0)
    np.testing.assert_allclose(SpaceStretch.growth(small), trace, rtol=1e-10)
