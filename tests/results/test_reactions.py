"""Reactions: in balance with the load at every support, after strength and contact have been used
up too.
"""

from __future__ import annotations

import numpy as np
import pytest
from skfem import FacetBasis, LinearForm

import skfem_contact as sc
from tests.tools.helpers import grid, vector_basis


def pushed_block():
    """A block that slips on a base whose soil yields, and whose load leaves it in a second
    stage.
    """
    base = grid("Q1", np.linspace(0, 4, 9), [0, 0.5, 1])
    block = grid("Q1", np.linspace(1, 3, 6), [1, 2])
    basis = vector_basis(sc.join_bodies({"base": base, "block": block}), "Q1", intorder=2)
    forms = {
        "base": sc.SolidForm(
            basis.with_elements("base"), sc.MohrCoulomb(E=1e4, nu=0.3, c=5.0, phi=20.0), "b_bar"
        ),
        "block": sc.SolidForm(
            basis.with_elements("block"), sc.LinearElastic(E=1e5, nu=0.2), "b_bar"
        ),
        "joint": sc.ContactPair(
            basis, "block:bottom", "base:top", sc.Coulomb(mu=0.3), quadrature=2
        ),
    }
    weight = sc.weight(basis, {"base": 20.0, "block": 20.0})
    side = FacetBasis(basis.mesh, basis.elem, facets="block:left")
    push = LinearForm(lambda v, w: 10.0 * v[0]).assemble(side)
    own = sc.weight(basis, {"base": 20.0})
    stages = [
        sc.Stage("pushed", weight + push, increments=3),
        sc.Stage("lifted", own, deactivate=("block", "joint"), increments=2),
    ]
    fixed = basis.get_dofs("base:bottom").all()
    return forms, fixed, sc.Model(forms, fixed).run(stages, progress=False)


def test_reactions_balance_the_load():
    """[X] The supports carry weight and push; later the weight of the base, and nothing of what has
    gone.
    """
    _, fixed, result = pushed_block()
    assert "yielded" in result["pushed"].summary["base"]
    for stage, total in zip(result, ((-10.0, 120.0), (0.0, 80.0)), strict=True):
        held = stage.reactions()
        # Newton's tolerance is 1e-8 of the load, some 100
        np.testing.assert_allclose(
            [held[fixed[fixed % 2 == k]].sum() for k in (0, 1)], total, atol=1e-5
        )
        np.testing.assert_allclose(np.delete(held, fixed), 0.0, atol=1e-5)


def test_forms_of_the_right_kind_are_needed():
    stage = pushed_block()[2]["pushed"]
    with pytest.warns(DeprecationWarning, match=r"use stage\.contact"):
        assert str(stage.report("joint")) == str(stage.contact("joint"))
    with pytest.raises(
        ValueError, match=r"'base' is a SolidForm, no ContactPair; there are \['joint'\]"
    ):
        stage.contact("base")
    with pytest.raises(
        ValueError, match=r"'joint' is a ContactPair, no SolidForm; there are \['base'"
    ):
        stage.pore_pressure("joint")
    with pytest.raises(ValueError, match="no form in stage 'pushed' 'skin'"):
        stage.tractions("skin")
