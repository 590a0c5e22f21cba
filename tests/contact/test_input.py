"""Contact pairs that do not belong to the model."""

from __future__ import annotations

import numpy as np
import pytest

import skfem_contact as sc
from tests.tools.helpers import grid, vector_basis

ELASTIC = sc.LinearElastic(E=1e4, nu=0.3)


def halves(right: float = 1.0):
    """Basis of two bodies, "l" and "r", of which the second begins at an abscissa."""
    side = np.linspace(0.0, 1.0, 3)
    mesh = sc.join_bodies({"l": grid("Q1", side, side), "r": grid("Q1", right + side, side)})
    return vector_basis(mesh, "Q1", intorder=2)


def test_pair_of_another_mesh_is_named():
    basis, other = halves(), vector_basis(halves().mesh, "Q2")
    joint = sc.ContactPair(other, "l:right", "r:left", sc.Tied())
    with pytest.raises(ValueError, match=r"different bases.*<ContactPair l:right on r:left"):
        sc.Model(
            {"both": sc.SolidForm(basis, ELASTIC), "joint": joint}, basis.get_dofs("l:bottom").all()
        )
