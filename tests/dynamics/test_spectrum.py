"""Response spectra."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import skfem_contact as sc


def test_spectrum_of_a_ramp():
    """[N] Linear pieces are exact: the same as a fine integration, for steps as long as T / 2."""
    values = np.array([0.0, 1.0, -0.5, 2.0, 0.0, 0.0, 0.0, 0.0])
    record = sc.Record(0.25, values)
    w = 2.0 * np.pi / 0.5

    def rate(t, y):
        return [y[1], -np.interp(t, record.time, values) - 2.0 * 0.05 * w * y[1] - w * w * y[0]]

    options = {"t_eval": record.time, "rtol": 1e-10, "atol": 1e-14, "max_step": 0.01}
    exact = solve_ivp(rate, (0.0, 1.75), [0.0, 0.0], **options)
    found = record.spectrum([0.5], ratio=0.05)
    # the largest value at the ends of the steps
    assert found.displacement[0] == pytest.approx(np.abs(exact.y[0]).max(), rel=1e-6)


def test_limits_of_a_spectrum():
    """[X] Stiff oscillators feel the peak acceleration, soft ones the peak displacement."""
    record = sc.Record.synthetic(2.0)
    found = record.spectrum([0.01, 200.0])
    assert found.acceleration[0] == pytest.approx(2.0, rel=0.02)
    assert found.displacement[1] == pytest.approx(np.abs(record.displacement).max(), rel=0.15)
    assert len(found.table()) == 2
    assert len(record.spectrum().periods) == 100
    damped = record.spectrum([0.5], ratio=0.05)
    assert (record.spectrum([0.5]).acceleration == damped.acceleration).all()


def test_resonance():
    """[X] At resonance the amplitude is 1 / (2 z), once the motion is steady."""
    t = 0.005 * np.arange(16000)
    for frequency in (1.0, 4.0):
        record = sc.Record(0.005, np.sin(2.0 * np.pi * frequency * t))
        found = record.spectrum([1.0 / frequency], ratio=0.05)
        # linear pieces lose (w step)^2 / 12 of a sine
        assert found.acceleration[0] == pytest.approx(10.0, rel=2e-3)
        assert found.velocity[0] == pytest.approx(10.0 / (2 * np.pi * frequency), rel=2e-3)
