"""Runs that are stopped by hand."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import csr_matrix

import skfem_contact as sc
from tests.tools.helpers import grid, vector_basis


def model(shift=0.0, stretch=1.0):
    """A block that rests on another one."""
    base = grid("Q1", np.linspace(0, 4, 9), np.linspace(0, 1, 3))
    block = grid("Q1", np.linspace(1, 3, 6), np.linspace(1, 2, 3))
    mesh = (
        sc.join_bodies({"base": base, "block": block})
        .scaled((1.0, stretch))
        .translated((shift, 0.0))
    )
    basis = vector_basis(mesh, "Q1", intorder=2)
    forms = {
        "bodies": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3)),
        "joint": sc.ContactPair(basis, "block:bottom", "base:top", sc.Coulomb(0.4), quadrature=2),
    }
    return (
        basis,
        forms,
        sc.weight(basis, {"base": 0.0, "block": 20.0}),
        basis.get_dofs("base:bottom").all(),
    )


class Impatient(sc.Form):
    """A user who stops the run when it has been asked so many times."""

    def __init__(self, n, calls):
        self.K, self.calls = csr_matrix((n, n)), calls

    def assemble(self, x, state):
        self.calls -= 1
        if self.calls < 0:
            raise KeyboardInterrupt
        return sc.Response(self.K @ x, lambda: None, lambda: self.K)


def test_a_run_that_is_stopped_by_hand():
    """Ctrl-C carries what was accepted."""
    basis, forms, load, fixed = model()
    forms["user"] = Impatient(basis.N, 40)
    with pytest.raises(KeyboardInterrupt) as stop:
        sc.Model(forms, fixed).run(
            [sc.Stage("first", load), sc.Stage("long", 2 * load, increments=1000)], progress=False
        )
    assert 0.0 < stop.value.result["long"].fraction < 1.0
