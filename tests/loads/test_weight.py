"""Weights of all subdomains, seismic shares and pressures of water."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import Basis, ElementQuad1, ElementVector, MeshQuad

import skfem_contact as sc
from tests.tools.scenes import halves

#: Exact up to the round-off of a few operations.
EXACT = {"rtol": 1e-12, "atol": 1e-12}


def test_loads():
    """[X] Weight, seismic share of it and pressure of water on a unit square."""
    basis = Basis(MeshQuad().with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    solid = sc.SolidForm(basis, sc.LinearElastic(1e4, 0.3), unit_weight=20.0)
    model = sc.Model({"square": solid}, basis.get_dofs("bottom").all(), seismic=0.2)
    force = model.weights(model.forms).reshape(-1, 2).sum(axis=0)
    np.testing.assert_allclose(force, [4.0, -20.0], **EXACT)
    pressure = sc.hydrostatic(3.0, unit_weight=10.0)
    np.testing.assert_allclose(pressure(np.array([[0.0, 0.0], [1.0, 4.0]])), [20.0, 0.0], **EXACT)


ELASTIC = sc.LinearElastic(E=1e4, nu=0.3)


def test_subdomain_without_weight():
    basis = halves()
    with pytest.raises(
        ValueError, match=r"4 elements of the subdomains \['r'\] have no unit weight"
    ):
        sc.SolidForm(basis, ELASTIC, unit_weight={"l": 20.0})
    left = sc.SolidForm(
        basis.with_elements("l"), ELASTIC, unit_weight={"l": 20.0}
    )  # weight of all that it has
    assert left.own_weight(np.array([0.0, -1.0])).sum() == pytest.approx(-20.0)
    model = sc.Model({"both": sc.SolidForm(basis, ELASTIC)}, basis.get_dofs("l:bottom").all())
    with pytest.warns(sc.AnalysisWarning, match=r"4 elements .* of 'both' are weightless") as told:
        model.weight({"l": 20.0})
    assert told[0].filename == __file__
    model.weight({"l": 20.0, "r": 0.0})
    assert len(told) == 1
