"""Weights of all subdomains, seismic shares and pressures of water."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import (
    Basis,
    ElementHex1,
    ElementQuad1,
    ElementTriP2,
    ElementVector,
    MeshHex,
    MeshQuad,
    MeshTri,
)

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


@pytest.mark.parametrize(
    ("gravity", "total"),
    [
        ((1.0, 0.0), (20.0, 4.0)),
        ((-1.0, 0.0), (-20.0, 4.0)),
        ((0.0, 1.0), (4.0, 20.0)),
        ((0.6, -0.8), (0.6 * 20.0 + 0.8 * 4.0, -0.8 * 20.0 + 0.6 * 4.0)),
    ],
)
def test_seismic_acceleration_is_across_gravity(gravity, total):
    """It acted along x always: with gravity along x it made the weight larger."""
    basis = Basis(MeshQuad().with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    solid = sc.SolidForm(basis, ELASTIC, unit_weight=20.0)
    held = basis.get_dofs("bottom").all()
    model = sc.Model({"square": solid}, held, gravity=gravity, seismic=0.2)
    force = model.weights(model.forms).reshape(-1, 2).sum(axis=0)
    np.testing.assert_allclose(force, total, **EXACT)


def test_seismic_acceleration_in_space_where_another_axis_is_upright():
    basis = Basis(MeshHex().with_defaults(), ElementVector(ElementHex1()), intorder=2)
    solid = sc.SolidForm(basis, ELASTIC, unit_weight=20.0)
    held = basis.get_dofs("bottom").all()

    def total(gravity, seismic):
        model = sc.Model({"cube": solid}, held, gravity=gravity, seismic=seismic)
        return model.weights(model.forms).reshape(-1, 3).sum(axis=0)

    np.testing.assert_allclose(total((0, -1, 0), (0.1, 0.2)), [2.0, -20.0, 4.0], **EXACT)
    np.testing.assert_allclose(total((-1, 0, 0), 0.1), [-20.0, 2.0, 0.0], **EXACT)
    with pytest.raises(ValueError, match="seismic needs gravity along one of the axes in space"):
        total((0.6, 0.0, -0.8), 0.1)


def test_bounds_with_a_seismic_acceleration_of_their_own_need_upright_gravity():
    """They took gravity against the last axis without a word."""
    basis = Basis(MeshTri().refined(2).with_defaults(), ElementVector(ElementTriP2()))
    clay = sc.SolidForm(basis, sc.Tresca(1e4, 0.3, c=10.0), unit_weight=20.0)
    model = sc.Model({"clay": clay}, basis.get_dofs("bottom").all(), gravity=(1.0, 0.0))
    with pytest.raises(ValueError, match="bounds need gravity against the last axis"):
        model.bounds(seismic=0.1)


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
