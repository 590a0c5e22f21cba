"""Strains that round-off hides."""

from __future__ import annotations

import numpy as np
import pytest

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


def test_strains_that_round_off_hides():
    """They converge, or the message says why not."""
    _, forms, load, fixed = model()
    with pytest.raises(sc.NotConverged, match="round-off alone may leave"):
        sc.Model(forms, fixed, newton=sc.Newton(max_iterations=8)).run(
            [sc.Stage("a", 1e-8 * load)], progress=False
        )
