"""Hysteretic damping of soil at small strains, for shaking."""

from __future__ import annotations

import numpy as np
import pytest

import skfem_contact as sc
from skfem_contact.materials.base import updated

pytestmark = pytest.mark.filterwarnings("ignore::skfem_contact.AnalysisWarning")


def loop(sand, pressure, amplitude, n=100):
    """Return secant modulus and damping ratio of the second closed loop of shear."""
    stress = np.array([-pressure, -pressure, -pressure, 0.0])[:, None, None] * np.ones((1, 1, 1))
    memory = sand.initial_internal(stress)
    parts = [np.linspace(0, 1, n)]
    for end in (1, -1, 1, -1):
        parts.append(np.linspace(end, -end, 2 * n)[1:])
    strains = amplitude * np.concatenate(parts)
    stresses = [0.0]
    for step in np.diff(strains):
        increment = np.array([0.0, 0.0, 0.0, step])[:, None, None]
        new = updated(sand, increment, stress, memory, 0.0)
        stress, memory = new.stress, new.internal
        stresses.append(float(stress[3, 0, 0]))
    tau = np.array(stresses[-4 * n + 1 :])
    gamma = strains[-4 * n + 1 :]
    closing = 0.5 * (tau[0] + tau[-1]) * (gamma[0] - gamma[-1])
    work = abs(np.sum(0.5 * (tau[1:] + tau[:-1]) * np.diff(gamma)) + closing)
    secant = (tau.max() - tau.min()) / (2.0 * amplitude)
    return secant, work / (2.0 * np.pi * secant * amplitude**2)


@pytest.mark.slow
@pytest.mark.parametrize("amplitude", [3e-5, 2e-4])
def test_damping_ratio_by_masing(amplitude):
    """[X] Masing's rule on the hyperbola G / G0 = 1 / (1 + .385 gamma / gamma_07)."""
    sand = sc.HardeningSoil(
        30e3,
        30e3,
        90e3,
        m=0.0,
        c=1.0,
        phi=40.0,
        psi=0.0,
        G0_ref=120e3,
        gamma_07=2e-4,
        OCR=20.0,
        nu_ur=0.2,
    )
    secant, ratio = loop(sand, 100.0, amplitude)
    # the shear strain of the model is sqrt(3) / 2 of that of simple shear
    x = 0.385 * np.sqrt(3.0) / 2.0 * amplitude / 2e-4
    assert secant == pytest.approx(120e3 / (1.0 + x), rel=0.01)
    masing = 2.0 / np.pi * (2.0 * (1.0 + x) / x**2 * (x - np.log(1.0 + x)) - 1.0)
    assert ratio == pytest.approx(masing, rel=0.02)
