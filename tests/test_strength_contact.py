"""Strength reduction of contact: a block on an inclined plane, whose factor of safety is known."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import Basis, ElementQuad1, ElementVector, MeshQuad

import skfem_contact as sc

SLOPE = 0.4
WEIGHT = 20.0
ADHESION = 10.0 * np.sin(np.arctan(SLOPE))  # carries half of the driving force, 20 sin(beta)


def on_an_incline(law: sc.Coulomb) -> tuple[dict, sc.Result, np.ndarray]:
    """An elastic unit block at rest on a plane that is inclined by the slope; gravity is, in fact."""
    block = MeshQuad().refined(1).with_defaults()
    plane = block.scaled((3.0, 1.0)).translated((-1.0, -1.0))
    basis = Basis(sc.join_bodies({"plane": plane, "block": block}), ElementVector(ElementQuad1()), intorder=2)
    angle = np.arctan(SLOPE)
    load = sc.weight(basis, {"block": WEIGHT}, direction=(np.sin(angle), -np.cos(angle)))
    forms = {"bodies": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.2)),
             "joint": sc.ContactPair(basis, "block:bottom", "plane:top", law)}
    fixed = basis.get_dofs("plane:bottom").all()
    return forms, sc.run(forms, [sc.Stage("weight", load)], fixed), fixed


@pytest.mark.parametrize(
    ("law", "factor"),
    [(sc.Coulomb(mu=0.6), 1.5), (sc.Coulomb(mu=0.3, adhesion=ADHESION), 0.3 / SLOPE + 0.5)],
    ids=["friction", "friction and adhesion"],
)
def test_block_slides_when_friction_and_adhesion_are_used_up(law: sc.Coulomb, factor: float) -> None:
    """[X] F = mu / tan(beta) + a A / (W sin(beta)): both parts of the contact's strength are divided by the factor."""
    forms, rest, fixed = on_an_incline(law)
    result = sc.strength_reduction(forms, fixed, start=rest, reduce={"joint"}, tol=0.01)
    # the curve is followed to within the tolerance; the forces balance to 3e-4 of the largest, the weight, which is
    # 1 / 0.37 times what drives the block
    assert factor - 0.01 < result.factor < factor + 0.002


def test_mechanism_is_the_block_that_slides_down() -> None:
    """The block moves as a whole and downhill, the plane stays."""
    forms, rest, fixed = on_an_incline(sc.Coulomb(mu=0.6))
    result = sc.strength_reduction(forms, fixed, start=rest, reduce={"joint"})
    basis = forms["bodies"].basis
    ux = result.mechanism[basis.nodal_dofs[0]]
    block = np.unique(basis.mesh.t[:, basis.mesh.subdomains["block"]])
    # a rigid motion of 1 beside what bodies and penalty yield elastically
    np.testing.assert_allclose(ux[block], 1.0, atol=0.05)
    assert np.abs(np.delete(ux, block)).max() < 0.05


def test_contact_that_is_not_named_keeps_its_strength() -> None:
    """With elastic bodies there is then nothing to reduce."""
    forms, rest, fixed = on_an_incline(sc.Coulomb(mu=0.6))
    with pytest.raises(ValueError, match="nothing to reduce"):
        sc.strength_reduction(forms, fixed, start=rest)
