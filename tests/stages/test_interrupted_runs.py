"""Runs that are stopped by hand."""

from __future__ import annotations

import pytest
from scipy.sparse import csr_matrix

import skfem_contact as sc
from tests.tools.scenes import block_on_base


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
    basis, forms, load, fixed = block_on_base()
    forms["user"] = Impatient(basis.N, 40)
    with pytest.raises(KeyboardInterrupt) as stop:
        sc.Model(forms, fixed).run(
            [sc.Stage("first", load), sc.Stage("long", 2 * load, increments=1000)], progress=False
        )
    assert 0.0 < stop.value.result["long"].fraction < 1.0
