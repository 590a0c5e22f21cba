"""Newton's iterations that lead nowhere end with numbers, and early."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import csr_matrix

from skfem_contact import Response
from skfem_contact.errors import NotConverged
from skfem_contact.nonlinear.newton import (
    Evaluation,
    Newton,
    Problem,
    backtrack,
    iterate,
    shorten,
)


class Given(Problem):
    """Equations of given functions."""

    def __init__(self, evaluate, direction=None, leaves=lambda visited: False):
        self.evaluate = evaluate
        self.direction = direction
        self.leaves = leaves


def iterated(evaluate, direction, settings, search="residual", **given):
    """Iterate from zero."""
    return iterate(evaluate(np.zeros(1)), Given(evaluate, direction, **given), settings, search)


def scalar(residual):
    """Evaluations of a scalar equation, relative to a load of 1."""

    def evaluate(z):
        value = residual(z)
        return Evaluation(
            z, {}, value, float(np.linalg.norm(value) / max(1.0, np.linalg.norm(1.0 - value)))
        )

    return evaluate


@pytest.mark.parametrize("search", ["residual", "energy", "step", "either"])
def test_no_trial_is_a_number(search):
    """[X] Beyond z = 2 there is no answer, and every step leads there: the last answer is what is
    warned of.
    """
    evaluate = scalar(lambda z: np.where(z < 2.0, 1.0, np.nan))
    with pytest.raises(NotConverged) as failed:
        iterated(evaluate, lambda now, damped: np.full(1, 100.0), Newton(), search)
    assert np.isfinite(failed.value.x).all() and np.isfinite(failed.value.residuals).all()


@pytest.mark.parametrize("search", ["residual", "energy", "step", "either"])
def test_a_shorter_step_has_an_answer(search):
    """[X] A step of which only the first part leads to an answer is shortened: z = 1, from 0 by
    steps of 8.
    """
    evaluate = scalar(lambda z: np.where(z < 2.0, 1.0 - z, np.nan))
    found, _ = iterated(evaluate, lambda now, damped: 8.0 * now.residual, Newton(), search)
    assert found.z == pytest.approx(1.0)


@pytest.mark.parametrize("search, first", [("energy", 0.5), ("step", 0.25)])
def test_how_far_the_work_of_the_residual_leads(search, first):
    """[X] z = 1 from 0 by steps of a quarter of the way: the search along the energy goes on until
    half is left.
    """
    evaluate, seen = scalar(lambda z: 1.0 - z), []

    def direction(now, damped):
        seen.append(float(now.z[0]))
        return 0.25 * now.residual

    iterated(evaluate, direction, Newton(max_iterations=100), search)
    assert seen[1] == pytest.approx(first)


def test_runaway_ends_early():
    """[X] After a good beginning the residual goes up for good: 14 of 100 iterations are made."""
    start = iter((0.5, 0.01))
    evaluate = scalar(lambda z: np.full(1, next(start, 0.3)))
    with pytest.raises(NotConverged) as failed:
        iterated(
            evaluate,
            lambda now, damped: np.ones(1),
            Newton(max_iterations=100),
        )
    assert len(failed.value.residuals) - 1 <= 14


def test_a_step_into_a_wall_is_shortened():
    """[X] A spring and a wall behind z = 1.5: the residual relative to the wall's force stays 1,
    the force itself not.

    Of the step to z = 16, halved while the force is larger than at the start, the last share leads
    to z = 1, where the spring bears the load.
    """
    evaluate = scalar(lambda z: 1.0 - z - 1e4 * np.maximum(z - 1.5, 0.0))
    found, residuals = iterated(
        evaluate,
        lambda now, damped: np.full(1, 16.0),
        Newton(max_iterations=1),
    )
    assert found.z == 1.0
    assert residuals == (1.0, 0.0)


@pytest.mark.parametrize("share, ends", [(0.2, True), (0.5, False)])
def test_iterations_that_are_nearly_done_go_on(share, ends):
    """[X] Steps that leave a fifth reach 1e-8 in 12 iterations though 5 are allowed; those that
    leave half do not.
    """
    evaluate = scalar(lambda z: 1.0 - z)

    def iterations():
        _, residuals = iterated(
            evaluate,
            lambda now, damped: (1.0 - share) * now.residual,
            Newton(max_iterations=5),
        )
        return len(residuals) - 1

    if ends:
        assert iterations() == 12
    else:
        with pytest.raises(NotConverged, match="after 5 iterations"):
            iterations()


def test_where_no_trial_may_go_the_step_is_shortened():
    """[X] Steps that are refused by an infinite norm, whatever their forces, as those of a negative
    strength are.
    """

    def evaluate(z):
        return (
            Evaluation(z, {}, 1.0 - z, abs(float(1.0 - z[0])))
            if z < 2.0
            else Evaluation(z, {}, np.zeros(1), np.inf)
        )

    found, _ = iterated(evaluate, lambda now, damped: 8.0 * now.residual, Newton())
    assert found.z == 1.0


def test_a_step_along_a_mechanism_is_shortened_by_work_or_norm():
    """[X] Soft until z = .01 and 100 times as stiff behind: z = 2/101. The norm alone halves the
    step four times.
    """

    def residual(z):
        return 1.0 - z - 100.0 * np.maximum(z - 0.01, 0.0)

    lengths = []

    def evaluate(z):
        lengths.append(float(z[0]))
        return scalar(residual)(z)

    start = scalar(residual)(np.zeros(1))
    new = shorten(start, np.ones(1), [1.0], Given(evaluate))
    assert (
        abs(new.residual[0]) < 1.0 and len(lengths) <= 4
    )  # interpolated: 1/50 would be the sixth half
    assert abs(backtrack(start, np.ones(1), [1.0], Given(scalar(residual))).residual[0]) > 1.0


def test_near_equilibrium_the_norm_admits_the_longest_step():
    """[X] No length does half of the work, as where points yield in turn: the norm decides."""
    evaluate = scalar(lambda z: np.where(z > 0.0, -0.9, 1.0))
    assert shorten(evaluate(np.zeros(1)), np.ones(1), [1.0], Given(evaluate)).z[0] == 1.0


@pytest.mark.parametrize(
    "search, known, most", [("residual", True, 4), ("either", True, 4), ("residual", False, 25)]
)
def test_contact_that_goes_back_and_forth(search, known, most):
    """[X] A brittle bond opens with it and closes without it: the iterations end where forms know a
    way out.
    """

    def evaluate(z):
        force, active = (np.zeros(1), b"closed") if z < 0.5 else (np.full(1, 2.0), b"open")
        response = Response(force, lambda: None, lambda: csr_matrix(np.eye(1)), active=active)
        return Evaluation(z, {"bond": response}, 1.0 - force, 1.0)

    seen = []
    with pytest.raises(NotConverged) as failed:
        iterated(
            evaluate,
            lambda now, damped: now.residual,
            Newton(),
            search,
            leaves=lambda visited: seen.append(visited) or known,
        )
    assert len(failed.value.residuals) - 1 <= most and bool(failed.value.cycle) == known
    assert {float(z[0]) for z in seen[0]} == {0.0, 1.0}
