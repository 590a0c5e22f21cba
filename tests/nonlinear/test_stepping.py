"""Sizes of increments: how they are cut, grow, and end at a limit."""

from __future__ import annotations

import numpy as np
import pytest

from skfem_contact.errors import NoEquilibrium, NotConverged
from skfem_contact.nonlinear.stepping import Predictor, Stepping


def follow(capacity: float, error: type[NotConverged], increments: int = 3) -> tuple[Stepping, int]:
    """Steps of a stage that has no equilibrium beyond some share of its load, and the number of
    attempts.
    """
    stepping, attempts = Stepping(increments), 0
    while not stepping.exhausted:
        attempts += 1
        fraction = stepping.fraction
        if fraction <= capacity:
            stepping.accept(fraction, iterations=20)
        else:
            stepping.reject(error("no equilibrium"))
    return stepping, attempts


def test_collapse_next_to_an_equilibrium_is_the_limit():
    """[X] Collapse beyond 0.35: the limit lies between both, 2 % of the load apart at most."""
    stepping, attempts = follow(0.35, NoEquilibrium)
    assert attempts < 20
    reached, beyond = (float(word.rstrip("%,")) for word in str(stepping).split() if "%" in word)
    assert 0.34 < reached / 100 <= 0.35 < beyond / 100 <= 0.3571


def test_stalls_are_no_limit():
    """[X] Stalls beyond 0.35: increments are cut to 1/1024, and no limit is claimed."""
    stepping, _ = follow(0.35, NotConverged)
    assert stepping.size < 1 / 1024 and "beyond" not in str(stepping)
    assert 0.35 - 2 / 1024 < float(str(stepping).split()[2].rstrip("%")) / 100 <= 0.35


def test_bodies_that_no_contact_holds_end_at_once():
    """[N] Where contact may hold less than the smallest increment, smaller ones are not tried."""
    stepping = Stepping(1)
    stepping.reject(NoEquilibrium("collapse"), held=0.01)
    assert not stepping.exhausted
    stepping.reject(NoEquilibrium("collapse"), held=0.001)
    assert stepping.exhausted and "no contact forces hold" in str(stepping)


def test_collapse_that_was_passed_is_forgotten():
    """[X] What a large increment could not reach, small ones did."""
    stepping = Stepping(1)
    stepping.reject(NoEquilibrium("too far at once"))
    assert stepping.fraction == pytest.approx(0.25) and stepping.try_recovery and stepping.cut
    for _ in range(4):
        assert not stepping.exhausted
        stepping.accept(stepping.fraction, iterations=20)
        assert not stepping.cut
    assert "beyond" not in str(stepping)


def test_known_failures_are_approached_cheaply():
    """[X] After equilibria, what failed is tried again with little effort, and thoroughly in small
    increments.
    """
    stepping = Stepping(2)
    stepping.accept(0.5, iterations=20)
    assert stepping.try_recovery
    stepping.reject(NotConverged("stall"))
    assert stepping.fraction == pytest.approx(0.625) and not stepping.try_recovery
    while stepping.size > 1 / 128:
        assert not stepping.try_recovery
        stepping.reject(NotConverged("stall"))
    assert stepping.try_recovery


def test_errors_in_time_shorten_steps():
    """An error four times as large as allowed: half the step would do."""
    stepping = Stepping(1)
    stepping.reject(NoEquilibrium("collapse"))
    assert stepping.fraction == 0.25 and stepping.try_recovery
    stepping.accept(stepping.fraction, iterations=5)
    assert stepping.fraction == 0.75
    # .225 of the stage would do; four equal steps lead to its end
    assert stepping.too_long({"water": (4.0, 1.0)}) and stepping.fraction == pytest.approx(
        0.4375, rel=1e-12
    )


def test_extrapolation_of_proportional_steps_only():
    """On the way back bodies stick at first."""
    predictor = Predictor(fixed=np.array([0]))
    for step in (0.0, 1.0):
        predictor.accept(x=step * np.array([1.0, 0.4]), load=np.zeros(2))
    np.testing.assert_allclose(
        predictor.start(load=np.zeros(2), prescribed=np.array([3.0])), [3.0, 1.2], rtol=1e-14
    )
    assert predictor.start(load=np.zeros(2), prescribed=np.array([0.5])) is None
