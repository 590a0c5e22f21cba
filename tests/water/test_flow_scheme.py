"""Steps of the flow of water in time."""

from __future__ import annotations

import numpy as np
import pytest

from skfem_contact.water.flow_scheme import FlowScheme


@pytest.mark.parametrize("scheme", [FlowScheme(), *map(FlowScheme.of, (0.0, 0.5, 1.0))])
def test_step_satisfies_its_equations(scheme, rng):
    """[X] Both equations of the generalised-alpha method at random rates and flows, and the slope
    of the water that leaves.
    """
    alpha, gamma = scheme
    h, rate, before, after = 0.3, *rng.standard_normal((3, 5))
    left, end = scheme.step(h, rate, before, after)
    balance = alpha * end + (1.0 - alpha) * rate + gamma * after + (1.0 - gamma) * before
    np.testing.assert_allclose(balance, 0.0, atol=1e-14)
    np.testing.assert_allclose(left, -h * ((1.0 - gamma) * rate + gamma * end), atol=1e-14)
    further = scheme.step(h, rate, before, after + 1.0)[0]
    np.testing.assert_allclose(further - left, scheme.implicit(h), rtol=1e-12)


@pytest.mark.parametrize("rho_inf", [0.0, 0.8])
def test_second_order(rho_inf):
    """[X] w' = -w from 1: half the step has a quarter of the error at t = 1."""
    scheme = FlowScheme.of(rho_inf)
    errors = []
    for n in (100, 200):
        w, rate = np.ones(1), -np.ones(1)
        for _ in range(n):
            # w_1 = w - left(w_1), where `left` is linear in the flow w_1 at the end
            left = scheme.step(1.0 / n, rate, w, np.zeros(1))[0]
            new = (w - left) / (1.0 + scheme.implicit(1.0 / n))
            rate = scheme.step(1.0 / n, rate, w, new)[1]
            w = new
        errors.append(abs(w[0] - np.exp(-1.0)))
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.05)
    assert errors[1] < 1e-4
