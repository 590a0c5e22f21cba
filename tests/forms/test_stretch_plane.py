"""Stretches in the plane against matrix functions of scipy."""

from __future__ import annotations

import numpy as np
import pytest
from numpy import ndarray
from scipy.linalg import expm, logm, sqrtm

from skfem_contact.forms.stretch_plane import PlaneStretch
from skfem_contact.forms.stretch_space import SpaceStretch

PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))
KINDS = (PlaneStretch, SpaceStretch)


def matrix(gradient: ndarray) -> ndarray:
    """F, (3, 3), of the components of F - 1."""
    if len(gradient) == 9:
        return np.eye(3) + gradient.reshape(3, 3)
    F = np.eye(3)
    for value, place in zip(gradient, ((0, 0), (1, 1), (2, 2), (0, 1), (1, 0)), strict=True):
        F[place] += value
    return F


def tensor(components: ndarray, shear: float = 1.0) -> ndarray:
    """Symmetric tensor, (3, 3)."""
    T = np.zeros((3, 3))
    for value, (i, j) in zip(components, PAIRS, strict=False):
        T[i, j] = T[j, i] = value if i == j else shear * value
    return T


def components(T: ndarray, n: int, shear: float = 1.0) -> ndarray:
    """Components of a symmetric tensor, (n,)."""
    return np.array([T[i, j] * (1.0 if i == j else shear) for i, j in PAIRS[:n]])


def cases(kind: type) -> tuple[int, int]:
    """Numbers of components of gradients and stresses."""
    return (5, 4) if kind is PlaneStretch else (9, 6)


@pytest.mark.parametrize("size", [0.4, 1e-3, 0.0])
@pytest.mark.parametrize("kind", KINDS)
def test_roots_exponentials_and_logarithms(kind: type, size: float) -> None:
    """[N] Square root, exponential, logarithm and congruences agree with those of scipy."""
    rng = np.random.default_rng(1)
    n_gradient, n = cases(kind)
    before, now = 0.5 * size * rng.normal(size=(2, n_gradient, 3))
    elastic = 0.3 * size * rng.normal(size=(n, 3))
    t = rng.normal(size=(n, 3))
    plastic = kind(before).inverse_plastic(elastic)
    stretch = kind(now)
    strain, S = stretch.log_strain(plastic), stretch.second(t)
    for k in range(3):
        F = matrix(before[:, k])
        inverse = np.linalg.inv(sqrtm(F.T @ F).real)
        Cp = inverse @ expm(2.0 * tensor(elastic[:, k], 0.5)) @ inverse
        F = matrix(now[:, k])
        U = sqrtm(F.T @ F).real
        X = U @ Cp @ U
        # scipy's functions keep 1e-14
        assert np.abs(components(Cp - np.eye(3), n) - plastic[:, k]).max() < 1e-13
        assert np.abs(components(logm(X).real / 2.0, n, 2.0) - strain[:, k]).max() < 1e-13
        inverse = np.linalg.inv(U)
        assert np.abs(components(inverse @ tensor(t[:, k]) @ inverse, n) - S[:, k]).max() < 1e-13
        growth = np.linalg.det(F) - 1.0
        assert kind.growth(now)[k] == pytest.approx(growth, abs=1e-14)


@pytest.mark.parametrize("kind", KINDS)
def test_small_gradients_keep_their_digits(kind: type) -> None:
    """[X] The strain of a gradient of 1e-12 is its symmetric part to 12 digits."""
    n_gradient, n = cases(kind)
    gradient = 1e-12 * np.random.default_rng(2).normal(size=(n_gradient, 4))
    strain = kind(gradient).log_strain()
    for k in range(4):
        H = matrix(gradient[:, k] * 1e12) - np.eye(3)
        exact = 1e-12 * components((H + H.T) / 2.0, n, 2.0)
        # terms of second order are 1e-12 of the strain
        assert np.abs(strain[:, k] - exact).max() < 2e-23


@pytest.mark.parametrize("size", [0.4, 1e-4, 0.0])
@pytest.mark.parametrize("kind", KINDS)
def test_moduli_are_derivatives(kind: type, size: float) -> None:
    """[N] dS / dE against central differences, also where eigenvalues coincide."""
    rng = np.random.default_rng(3)
    n_gradient, n = cases(kind)
    gradient = 0.5 * size * rng.normal(size=(n_gradient, 1))
    elastic = 0.2 * size * rng.normal(size=(n, 1))
    t = rng.normal(size=(n, 1))
    D = rng.normal(size=(1, n, n))
    plastic = kind(0.3 * gradient).inverse_plastic(elastic)
    stretch = kind(gradient)
    e = stretch.log_strain(plastic)
    moduli = stretch.moduli(D, stretch.second(t))[0]

    def at(H: ndarray) -> tuple[ndarray, ndarray]:
        other = kind(H)
        moved = t + D[0] @ (other.log_strain(plastic) - e)
        F = matrix(H[:, 0])
        return other.second(moved)[:, 0], (F.T @ F) / 2.0

    direction = 1e-6 * rng.normal(size=gradient.shape)
    (S, E), (S0, E0) = at(gradient + direction), at(gradient - direction)
    # differences of step 1e-6 keep 1e-9
    assert (
        np.abs(moduli @ components(E - E0, n, 2.0) - (S - S0)).max() < 3e-9 * np.abs(S - S0).max()
    )


def test_plane_strain_needs_no_hoop() -> None:
    """[X] The moduli in the rows that act are those of all rows."""
    rng = np.random.default_rng(4)
    gradient = 0.1 * rng.normal(size=(5, 2))
    gradient[2] = 0.0
    stretch = PlaneStretch(gradient)
    stretch.log_strain(0.1 * rng.normal(size=(4, 2)))
    D = rng.normal(size=(2, 4, 4))
    S = stretch.second(rng.normal(size=(4, 2)))
    acting = np.ix_([0, 1], [0, 1, 3], [0, 1, 3])
    # the same sums in another order
    assert np.abs(stretch.moduli(D[acting], S) - stretch.moduli(D, S)[acting]).max() < 1e-13
