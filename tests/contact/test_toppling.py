"""Blocks that topple about an edge."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from skfem import (
    Basis,
    ElementQuad1,
    ElementVector,
    MeshQuad,
)

import skfem_contact as sc
from skfem_contact.contact.prestress import LinearisedContact


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


@pytest.mark.parametrize("n", [2, 3, 7, 8])
def test_joints_that_turn_about_a_point_inside_of_their_end_are_told(n) -> None:
    """[X] The pressure is at the last of n Gauss points, or within .3 of the way to the next one;
    rules of more than seven points have these close to the end.
    """
    xi, weight = np.polynomial.legendre.leggauss(n)
    points = SimpleNamespace(
        nodes=np.zeros((n, 2)), facet=np.zeros(n), xi=xi[:, None], weight=weight
    )
    pair = SimpleNamespace(slave=SimpleNamespace(dim=2, name="block:bottom"))
    joint = SimpleNamespace(pair=pair, _points=points, _at=np.arange(n))

    def told(share, last, following):
        traction = np.zeros((2, n))
        traction[0, [last, following]] = -(1.0 - share) / weight[last], -share / weight[following]
        state = SimpleNamespace(traction=traction)
        return [remark.figure for remark in LinearisedContact._on_pivot(joint, state)]

    for last, following in ((0, 1), (-1, -2)):
        assert told(0.0, last, following) == [1.0] * (n < 8)
        assert told(0.29, last, following) == pytest.approx([0.71] * (n < 8))
        assert not told(0.31, last, following)
    # Nothing at the ends, in space, without pressure
    for change in ({"nodes": np.zeros((n, 1))}, {"weight": 0.0 * weight}):
        joint._points = SimpleNamespace(**(vars(points) | change))
        assert not told(0.0, 0, 1)
    joint._points = points
    pair.slave.dim = 3
    assert not told(0.0, 0, 1)
