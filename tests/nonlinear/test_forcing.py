"""Forcing terms of an inexact Newton method."""

from __future__ import annotations

import numpy as np
import pytest

from skfem_contact.nonlinear.forcing import Forcing
from skfem_contact.nonlinear.newton import Evaluation


def at(norm: float, lag: float = 0.0) -> Evaluation:
    return Evaluation(np.zeros(1), {}, np.zeros(1), norm, lag)


def test_terms() -> None:
    """[X] Equation 2.6 of Eisenstat and Walker, exponent 2: at most .03, or .01 near equilibrium,
    and enough there.
    """
    forcing = Forcing(1e-8)
    terms = [forcing.at(at(norm)) for norm in (1.0, 0.5, 1e-2, 1e-3, 5e-4, 1e-5, 2e-9)]
    assert terms == pytest.approx([3e-2, 3e-2, 3e-2, 0.9 * 0.1**2, 1e-2, 0.9 * 0.02**2, 1e-2])
    assert Forcing(1e-12).at(at(1.0)) == 3e-2
    tight = Forcing(1e-12)
    assert [tight.at(at(norm)) for norm in (1.0, 1e-6)] == pytest.approx([3e-2, 1e-7])


def test_step_of_the_supports_is_no_reduction() -> None:
    """[X] Before the supports have moved the residual is small, and says nothing of what comes."""
    forcing = Forcing(1e-8)
    assert [forcing.at(now) for now in (at(1e-9, lag=1.0), at(1e-4), at(5e-6))] == pytest.approx(
        [3e-2, 3e-2, 0.00225]
    )
