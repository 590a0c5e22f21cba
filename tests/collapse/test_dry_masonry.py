"""Collapse of arches and stacks of blocks with dry joints."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from skfem import (
    Basis,
    ElementQuad1,
    ElementVector,
    MeshQuad,
)

import skfem_contact as sc
from tests.fuzz.blocks import Stack


def arch(n=12, thickness=0.2):
    """Meshes of the voussoirs of a semicircular arch of mean radius 1."""
    angle = np.pi - np.linspace(0, np.pi, n + 1)
    rays = np.stack((np.cos(angle), np.sin(angle)))
    inner, outer = (1 - thickness / 2) * rays, (1 + thickness / 2) * rays
    flat = MeshQuad.init_tensor(np.linspace(0, 1, 3), np.linspace(0, 1, 5)).with_boundaries(
        {"left": lambda x: x[0] < 1e-9, "right": lambda x: x[0] > 1 - 1e-9}
    )
    u, v = flat.p
    corners = (
        ((1 - u) * (1 - v), inner, 0),
        (u * (1 - v), inner, 1),
        ((1 - u) * v, outer, 0),
        (u * v, outer, 1),
    )
    return {
        f"b{k}": replace(flat, doflocs=sum(w * p[:, k + i, None] for w, p, i in corners))
        for k in range(n)
    }


@pytest.mark.parametrize("quadrature, tolerance", [("nodal", 0.005), ("segments", 0.016)])
def test_arch_becomes_a_mechanism_of_hinges(quadrature, tolerance):
    """[N] Horizontal acceleration at which an arch (t/R = .2) gets four hinges: .285159 by a linear
    programme.
    """
    basis = Basis(sc.join_bodies(arch()), ElementVector(ElementQuad1()), intorder=2)
    law = sc.Coulomb(mu=0.8)
    sides = {
        "b0:left": sc.rigid.line((-3.0, 0.0), (-0.2, 0.0)),
        "b11:right": sc.rigid.line((0.2, 0.0), (3.0, 0.0)),
    }
    sides |= {f"b{k}:left": f"b{k - 1}:right" for k in range(1, 12)}
    forms = {
        slave: sc.ContactPair(basis, slave, master, law, quadrature)
        for slave, master in sides.items()
    }
    model = sc.Model(
        {"blocks": sc.SolidForm(basis, sc.LinearElastic(E=1e6, nu=0.2), unit_weight=1.0), **forms}
    )
    own = model.run([sc.Stage("own weight")], progress=False)
    found = model.limit_load(
        sc.weight(basis, 1.0, direction=(1.0, 0.0)),
        start=own,
        step=0.014,
        tolerance=0.005,
        progress=False,
    )
    assert found.stop.kind in ("collapse", "plateau")
    # elastic blocks with soft joints deform before: the hinges move inwards by less than the
    # tolerance of the search; the outermost of the Gauss points lies .011 of a facet inside the
    # joint, which costs 1.1 % of the load
    assert found.bracket[0] * (1 - tolerance) < 0.285159 < found.bracket[1] * (1 + tolerance)


def pushed_block(quadrature, width=0.6, height=2.0, mu=0.8):
    """Model of a block on a base, whose matching facets are a quarter of its width, and a push of 1
    at its left.
    """
    base = MeshQuad.init_tensor(
        np.linspace(-width, 2 * width, 13), np.linspace(-0.3, 0.0, 3)
    ).with_defaults()
    block = MeshQuad.init_tensor(
        np.linspace(0, width, 5), np.linspace(0, height, 5)
    ).with_defaults()
    basis = Basis(
        sc.join_bodies({"base": base, "block": block}), ElementVector(ElementQuad1()), intorder=2
    )
    bodies = sc.SolidForm(
        basis, sc.LinearElastic(E=1e6, nu=0.2), unit_weight={"base": 0.0, "block": 20.0}
    )
    joint = sc.ContactPair(
        basis, "block:bottom", "base:top", sc.Coulomb(mu), quadrature, penalty=1e8
    )
    model = sc.Model({"bodies": bodies, "joint": joint}, basis.get_dofs("base:bottom").all())
    return model, model.traction("block:left", (1.0 / height, 0.0))


@pytest.mark.slow
def test_joint_that_turns_inside_of_its_end_is_told(recwarn):
    """[X] A block topples at W b / h = 7.2; about a Gauss point .113 of a facet from its end at
    6.79, which is told.
    """
    for quadrature in ("nodal", "segments"):
        model, load = pushed_block(quadrature)
        assert model.limit_load(load, step=1.0, progress=False).multiplier == pytest.approx(
            7.2, rel=0.01
        )
        assert not model.is_stable(7.3 * load) and not recwarn.list
    model, load = pushed_block(3)
    with pytest.warns(
        sc.AnalysisWarning, match=r"joint: 'block:bottom' turns about its last point of quadrature"
    ):
        assert model.limit_load(load, step=1.0, progress=False).multiplier == pytest.approx(
            6.79, rel=0.01
        )
    with pytest.warns(sc.AnalysisWarning, match="the limit is too low"):
        assert not model.is_stable(7.1 * load)


@pytest.mark.parametrize("quadrature", ["nodal", "segments"])
@pytest.mark.parametrize("share", [0.8, 0.9, 0.97])
@pytest.mark.one_in(2)
def test_push_that_is_small_beside_the_weight(quadrature, share, recwarn):
    """[X] Stacks of weight 32 slide in their middle joint under pushes of 0.2 to 1.5: collapses,
    closed brackets.
    """
    stack = Stack(0.9, (0.6, 0.6, 0.6), (0.6, 0.37, 0.66), np.arctan(0.37 * share), quadrature)
    model = stack.model(3)
    load, exact = model.traction("b2:left", (1.0 / 0.6, 0.0)), stack.bears(3)
    found = model.limit_load(load, step=0.2 * exact, progress=False)
    assert (
        found.bracket[0] < 1.001 * exact and 0.999 * exact < found.bracket[1] < 1.006 * exact
    )  # 0.5 % wide
    assert found.stop.kind == "collapse" and found.iterations < 50 and not recwarn.list
