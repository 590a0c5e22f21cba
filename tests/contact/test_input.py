"""Contact pairs that do not belong to the model."""

from __future__ import annotations

import pytest

import skfem_contact as sc
from tests.tools.helpers import vector_basis
from tests.tools.scenes import halves

ELASTIC = sc.LinearElastic(E=1e4, nu=0.3)


def test_pair_of_another_mesh_is_named():
    basis, other = halves(), vector_basis(halves().mesh, "Q2")
    joint = sc.ContactPair(other, "l:right", "r:left", sc.Tied())
    with pytest.raises(ValueError, match=r"different bases.*<ContactPair l:right on r:left"):
        sc.Model(
            {"both": sc.SolidForm(basis, ELASTIC), "joint": joint}, basis.get_dofs("l:bottom").all()
        )
