"""Newton's iterations that lead nowhere end with numbers, and early."""
from __future__ import annotations

import numpy as np
import pytest

from skfem_contact.errors import NotConverged
from skfem_contact.nonlinear.newton import Evaluation, Newton, iterate


def scalar(residual):
    """Evaluations of a scalar equation, relative to a load of 1."""
    def evaluate(z):
        value = residual(z)
        return Evaluation(z, {}, value, float(np.linalg.norm(value) / max(1.0, np.linalg.norm(1.0 - value))))
    return evaluate


@pytest.mark.parametrize("search", ["residual", "energy", "step"])
def test_no_trial_is_a_number(search):
    """[X] Beyond z = 2 there is no answer, and every step leads there: the last answer is what is warned of."""
    evaluate = scalar(lambda z: np.where(z < 2.0, 1.0, np.nan))
    with pytest.raises(NotConverged) as failed:
        iterate(evaluate(np.zeros(1)), evaluate, lambda now, damped: np.full(1, 100.0), Newton(), search)
    assert np.isfinite(failed.value.x).all() and np.isfinite(failed.value.residuals).all()


@pytest.mark.parametrize("search", ["residual", "energy", "step"])
def test_a_shorter_step_has_an_answer(search):
    """[X] A step of which only the first part leads to an answer is shortened: z = 1, from 0 by steps of 8."""
    evaluate = scalar(lambda z: np.where(z < 2.0, 1.0 - z, np.nan))
    found, _ = iterate(evaluate(np.zeros(1)), evaluate, lambda now, damped: 8.0 * now.residual, Newton(), search)
    assert found.z == pytest.approx(1.0)


@pytest.mark.parametrize("search, first", [("energy", 0.5), ("step", 0.25)])
def test_how_far_the_work_of_the_residual_leads(search, first):
    """[X] z = 1 from 0 by steps of a quarter of the way: the search along the energy goes on until half is left."""
    evaluate, seen = scalar(lambda z: 1.0 - z), []

    def direction(now, damped):
        seen.append(float(now.z[0]))
        return 0.25 * now.residual

    iterate(evaluate(np.zeros(1)), evaluate, direction, Newton(max_iterations=100), search)
    assert seen[1] == pytest.approx(first)


def test_runaway_ends_early():
    """[X] After a good beginning the residual goes up for good: 14 of 100 iterations are made."""
    start = iter((0.5, 0.01))
    evaluate = scalar(lambda z: np.full(1, next(start, 0.3)))
    with pytest.raises(NotConverged) as failed:
        iterate(evaluate(np.zeros(1)), evaluate, lambda now, damped: np.ones(1), Newton(max_iterations=100))
    assert len(failed.value.residuals) - 1 <= 14


def test_a_step_into_a_wall_is_shortened():
    """[X] A spring and a wall behind z = 1.5: the residual relative to the wall's force stays 1, the force itself not.

    Of the step to z = 16, halved while the force is larger than at the start, the last share leads to z = 1, where the
    spring bears the load.
    """
    evaluate = scalar(lambda z: 1.0 - z - 1e4 * np.maximum(z - 1.5, 0.0))
    found, residuals = iterate(evaluate(np.zeros(1)), evaluate, lambda now, damped: np.full(1, 16.0),
                               Newton(max_iterations=1))
    assert found.z == 1.0
    assert residuals == (1.0, 0.0)


def test_where_no_trial_may_go_the_step_is_shortened():
    """[X] Steps that are refused by an infinite norm, whatever their forces, as those of a negative strength are."""
    def evaluate(z):
        return Evaluation(z, {}, 1.0 - z, abs(float(1.0 - z[0]))) if z < 2.0 else Evaluation(z, {}, np.zeros(1), np.inf)

    found, _ = iterate(evaluate(np.zeros(1)), evaluate, lambda now, damped: 8.0 * now.residual, Newton())
    assert found.z == 1.0
