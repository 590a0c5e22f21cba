"""Settings of stages in time."""

from __future__ import annotations

import numpy as np
import pytest

import skfem_contact as sc
from skfem_contact.dynamics.scheme import Scheme


def test_rayleigh_damping_between_its_frequencies():
    """[X] alpha / (2 w) + beta w / 2 is the ratio at both frequencies, and less between them."""
    damping = sc.Rayleigh(0.03, f=(1.0, 6.0))
    assert damping.at(1.0) == pytest.approx(0.03)
    assert damping.at(6.0) == pytest.approx(0.03)
    # the least ratio, at the geometric mean: 2 z sqrt(w1 w2) / (w1 + w2)
    assert damping.at(np.sqrt(6.0)) == pytest.approx(0.03 * 2.0 * np.sqrt(6.0) / 7.0)


@pytest.mark.parametrize("rho_inf", [0.0, 0.3, 1.0])
def test_parameters_of_the_scheme(rho_inf):
    """[X] Conditions of second order and of the largest damping of high frequencies."""
    am, af, beta, gamma = Scheme.of(rho_inf)
    assert gamma == pytest.approx(0.5 - am + af)
    assert beta == pytest.approx((1.0 - am + af) ** 2 / 4.0)
    # the double root at infinity: (beta - gamma + 1/2 ...) = rho_inf, as af / (1 - af)
    assert af / (1.0 - af) == pytest.approx(rho_inf)


@pytest.mark.parametrize(
    "call, text",
    [
        (lambda: sc.Dynamic(0.0), "step in time must be positive"),
        (lambda: sc.Dynamic(0.1, rho_inf=1.5), "between 0 and 1"),
        (lambda: sc.Dynamic(0.1, mass="row sums"), "mass must be"),
        (lambda: sc.Dynamic(0.1, contact_mass="gone"), "contact_mass must be"),
        (lambda: sc.Rayleigh(5.0, f=(1.0, 2.0)), "0.05 for 5 %"),
        (lambda: sc.Rayleigh(0.05, f=(2.0, 1.0)), "lower one first"),
        (lambda: sc.Rayleigh(0.05, f=(0.0, 1.0)), "positive frequencies"),
    ],
)
def test_bad_settings(call, text):
    """[X] One sentence about what is wrong."""
    with pytest.raises(ValueError, match=text):
        call()


@pytest.mark.parametrize("rho_inf", [0.0, 0.01, 0.5, 0.99, 1.0])
def test_spectral_radii_from_zero_to_one(rho_inf):
    """Both ends are among them; others are refused."""
    assert sc.Dynamic(0.1, rho_inf=rho_inf).rho_inf == rho_inf
    for wrong in (-1.0 + rho_inf - 1e-9, 1.0 + rho_inf + 1e-9):
        with pytest.raises(ValueError, match="rho_inf must be between 0 and 1"):
            sc.Dynamic(0.1, rho_inf=wrong)
