"""Factors of the steps of interior points."""

from __future__ import annotations

from collections import Counter

import pytest
from bound_cases import CASES

from skfem_contact.solvers.superlu import SuperLU
from tests.tools.helpers import bounds_of


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
