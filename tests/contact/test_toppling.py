"""Blocks that topple about an edge."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import (
    Basis,
    ElementQuad1,
    ElementVector,
    MeshQuad,
)

import skfem_contact as sc


@pytest.mark.parametrize(
    "slave, master", [("block:bottom", "base:top"), ("base:top", "block:bottom")]
)
@pytest.mark.parametrize("degrees, stands", [(26.0, True), (26.7, False)])
def test_block_turns_about_its_edge(slave, master, degrees, stands):
    """[X] A block twice as high as wide topples at arctan(1/2), 26.57 degrees; with .1 of a facet
    lost at 25.25.
    """
    base = MeshQuad.init_tensor(np.linspace(-2, 3, 21), np.linspace(-1, 0, 5)).with_defaults()
    block = MeshQuad.init_tensor(np.linspace(0, 1, 5), np.linspace(0, 2, 9)).with_defaults()
    basis = Basis(
        sc.join_bodies({"base": base, "block": block}), ElementVector(ElementQuad1()), intorder=2
    )
    forms = {
        "bodies": sc.SolidForm(basis, sc.LinearElastic(E=1e6, nu=0.2)),
        "joint": sc.ContactPair(basis, slave, master, sc.Coulomb(mu=0.8)),
    }
    angle = np.radians(degrees)
    load = sc.weight(basis, {"block": 1.0}, direction=(np.sin(angle), -np.cos(angle)))
    assert sc.Model(forms, basis.get_dofs("base:bottom").all()).is_stable(load) is stands
