"""Pairs that stages change to another law."""

from __future__ import annotations

import numpy as np
import pytest

import skfem_contact as sc
from tests.tools.helpers import grid, vector_basis

PRESSURE, PUSH, SPRING = 10.0, 4.0, 50.0
JOINT = ("block:bottom", "base:top")


def blocks():
    """Basis of a block of 1 m on a base."""
    side = np.linspace(0.0, 1.0, 3)
    base, block = grid("Q1", 2.0 * side, side - 1.0), grid("Q1", side, side)
    return vector_basis(sc.join_bodies({"base": base, "block": block}), "Q1")


@pytest.mark.filterwarnings("ignore:.*penalty compliance")
@pytest.mark.parametrize(
    "enforcement", [None, sc.AugmentedLagrangian(), sc.DualMultipliers()], ids=repr
)
def test_friction_that_falls_in_later_stages(enforcement) -> None:
    """[X] A block under p = 10 that is pushed by 4 sticks with mu = .5; then a spring holds what
    the friction does not, 4 - mu p.
    """
    basis = blocks()

    def joint(mu):
        return sc.ContactPair(basis, *JOINT, sc.Coulomb(mu), "nodal", enforcement=enforcement)

    forms = {
        "bodies": sc.SolidForm(basis, sc.LinearElastic(E=1e7, nu=0.0)),
        "joint": joint(0.5),
        "spring": sc.Spring(basis, (1.0, 0.0), (SPRING, 0.0), part="block"),
    }
    model = sc.Model(forms, basis.get_dofs("base:bottom").all())
    pressed = model.traction("block:top", (0.0, -PRESSURE))
    pushed = pressed + model.traction("block:bottom", (PUSH, 0.0))
    stages = [sc.Stage("pressed", pressed), sc.Stage("pushed", pushed)]
    stages += [sc.Stage(f"mu = {mu}", pushed, change={"joint": joint(mu)}) for mu in (0.3, 0.1)]
    result = model.run(stages, progress=False)
    corner = sc.dofs_at(basis, (1.0, 0.0), "block")
    held = [SPRING * stage.x[corner].item(0) for stage in result]
    # A block that sticks moves by the compliance of base and penalty, 1e-5 of the spring's; the
    # base tilts by about p / E = 1e-6.
    assert held == pytest.approx([0.0, 0.0, PUSH - 3.0, PUSH - 1.0], abs=1e-3)
    assert result[-1].contact("joint").force == pytest.approx([-1.0, PRESSURE], abs=1e-3)


@pytest.mark.filterwarnings("ignore:.*penalty compliance")
@pytest.mark.parametrize("coordinates", [None, "axisymmetric"])
@pytest.mark.parametrize("kinematics", ["small", "finite"])
def test_the_same_law_anew_moves_nothing(coordinates, kinematics) -> None:
    """[X] The new pair takes over axis, kinematics and default penalty: no iteration."""
    basis = blocks()

    def joint():
        return sc.ContactPair(basis, *JOINT, sc.Coulomb(mu=0.3, adhesion=2.0))

    solid = sc.SolidForm(
        basis,
        sc.LinearElastic(E=1e3, nu=0.3),
        coordinates=coordinates,
        kinematics=kinematics,
    )
    fixed = [basis.get_dofs("base:bottom").all(), basis.get_dofs("block:left").all("u^1")]
    model = sc.Model({"bodies": solid, "joint": joint()}, fixed)
    load = model.traction("block:top", (0.0, -PRESSURE))
    stages = [sc.Stage("load", load), sc.Stage("anew", load, change={"joint": joint()})]
    load, anew = model.run(stages, progress=False)
    assert anew.iterations == (0,) and (anew.x == load.x).all()
    assert anew.forms["joint"].finite == (kinematics == "finite")
    given = sc.ContactPair(basis, *JOINT, sc.Coulomb(mu=0.3), penalty=7.0)
    assert given.continues(load.forms["joint"]).penalty == (7.0, 7.0)


def test_pairs_that_continue_no_other_one() -> None:
    """A pair with other surfaces or points, or with multipliers after one without, and in turn."""
    basis = blocks()
    law = sc.Coulomb(mu=0.3)
    plain = sc.ContactPair(basis, *JOINT, law, "nodal")
    dual = sc.ContactPair(basis, *JOINT, law, "nodal", enforcement=sc.DualMultipliers())
    others = {
        "its surfaces are others": (
            sc.ContactPair(basis, *JOINT[::-1], law, "nodal"),
            sc.ContactPair(basis, *JOINT, law, quadrature=3),
            sc.SolidForm(basis, sc.LinearElastic(E=1.0, nu=0.0)),
        ),
        "keep the enforcement": (dual,),
    }
    for message, pairs in others.items():
        for pair in pairs:
            with pytest.raises(ValueError, match=message):
                plain.continues(pair)
    with pytest.raises(ValueError, match="keep the enforcement"):
        dual.continues(plain)
