"""Ends of the interior points of bounds, and factors of their steps."""

from __future__ import annotations

from collections import Counter

import pytest
from bound_cases import CASES

from skfem_contact.limit_analysis import interior_point
from skfem_contact.solvers.superlu import SuperLU
from tests.tools.helpers import bounds_of


def test_iterations_end_where_residuals_do_not_move_the_gap(monkeypatch) -> None:
    """[N] A slope's bounds are those of ten times the accuracy, within it, after fewer
    iterations.
    """
    given = CASES["ACADS 1(a)"][0] | {"gap": 0.16, "elements": 140, "progress": False}
    found = bounds_of(**given)
    solve = interior_point.solve
    monkeypatch.setattr(
        "skfem_contact.limit_analysis.search.solve",
        lambda program, goal, accuracy, start=None: solve(program, goal, accuracy / 10, start),
    )
    closer = bounds_of(**given)
    last = found.history[-1]
    assert last.kind == "lower"
    # the solver's gap is a hundredth; 10 iterations, 15 to 18 with residuals of 1e-5
    assert last.value == pytest.approx(closer.history[-1].value, rel=0.01)
    assert last.iterations <= 12


@pytest.mark.parametrize("cholesky", [True, False])
def test_cholesky_is_tried_once_in_vain(monkeypatch, cholesky: bool) -> None:
    """[X] A program whose matrices have no such factor asks for it once; SuperLU never does."""
    tries: Counter[SuperLU] = Counter()

    class Refusing(SuperLU):
        """Engine whose matrices have no factor of Cholesky."""

        def factor(self, A, symmetric, careful=False, definite=False):
            tries[self] += definite
            if definite:
                raise RuntimeError("a negative pivot")
            return super().factor(A, symmetric, careful)

    Refusing.cholesky = cholesky
    monkeypatch.setattr("skfem_contact.limit_analysis.elements.as_engine", Refusing)
    found = bounds_of(**CASES["Griffiths and Lane 1"][0], gap=0.5, elements=20, progress=False)
    assert found.gap < 0.5
    assert set(tries.values()) == {int(cholesky)}
