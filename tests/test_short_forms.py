"""What every script repeats: supports of a box, forces on a boundary."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import Basis, ElementHex1, ElementQuad1, ElementVector, MeshHex, MeshQuad

import skfem_contact as sc
from skfem_contact.loads import Domain
from tests.tools.helpers import grid, resultant, vector_basis


@pytest.mark.parametrize("element", ["P1", "P2", "Q1", "Q2"])
def test_rollers_are_those_of_the_boundaries(element):
    basis = vector_basis(grid(element, [0, 1, 3], [-2, 0, 1]), element)
    sides = basis.get_dofs({"left", "right"}).all("u^1")
    np.testing.assert_array_equal(
        sc.box_supports(basis), np.union1d(basis.get_dofs("bottom").all(), sides)
    )
    np.testing.assert_array_equal(
        sc.box_supports(basis, base="rollers"),
        np.union1d(basis.get_dofs("bottom").all("u^2"), sides),
    )
    with pytest.raises(ValueError, match="base must be one of 'fixed', 'rollers'"):
        sc.box_supports(basis, base="free")


def test_rollers_of_a_part_and_in_space():
    plate = grid("Q1", [0, 1, 2], [0, 1])
    basis = vector_basis(sc.join_bodies({"a": plate, "b": plate.translated((0.0, 1.0))}), "Q1")
    upper = sc.box_supports(basis, part="b")
    assert (basis.doflocs[1, upper] >= 1.0).all() and len(upper) == 3 * 2 + 2
    cube = Basis(MeshHex().refined(1), ElementVector(ElementHex1()))
    held = sc.box_supports(cube)  # 9 nodes of the base, 6 + 6 others on each pair of sides
    assert len(held) == 9 * 3 + 2 * 12


def test_traction_has_the_resultant_of_its_forces():
    """[X] A triangle of pressure on a side: half of its peak, at a third of the height."""
    basis = vector_basis(grid("Q2", [0, 1, 2], [0, 1, 3]), "Q2")
    load = sc.traction(basis, "right", lambda x: (-10.0 * (3.0 - x[1]), 0.0 * x[1]))
    np.testing.assert_allclose(
        resultant(basis, basis.zeros(), load), (-45.0, 0.0, 45.0), atol=1e-12
    )
    ring = sc.traction(Domain(basis, "axisymmetric"), "top", (0.0, -1.0))
    np.testing.assert_allclose(ring.sum(), -2.0)  # the integral of the radius from 0 to 2


@pytest.mark.parametrize(
    "force, message",
    [((1.0,), "must have 2 finite components"), ((1.0, np.nan), "each a finite number")],
)
def test_wrong_forces_are_refused(force, message):
    basis = vector_basis(grid("Q1", [0, 1], [0, 1]), "Q1")
    with pytest.raises(ValueError, match=message):
        sc.traction(basis, "top", force)
    with pytest.raises(ValueError, match="no boundary 'roof'; existing: bottom, left, right, top"):
        sc.traction(basis, "roof", (0.0, 1.0))


def test_interference_is_a_number():
    """[X] Two bars between walls, a number too long for them: E d / (h1 + h2), which stays."""
    lower = MeshQuad.init_tensor(np.linspace(0, 1, 4), np.linspace(0, 1, 3)).with_defaults()
    upper = MeshQuad.init_tensor(np.linspace(0, 1, 6), np.linspace(1, 3, 4)).with_defaults()
    basis = Basis(
        sc.join_bodies({"lower": lower, "upper": upper}), ElementVector(ElementQuad1()), intorder=2
    )
    pair = sc.ContactPair(
        basis, "upper:bottom", "lower:top", sc.Coulomb(), initial=0.003, penalty=1e8
    )
    forms = {"bars": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.0)), "fit": pair}
    fixed = np.hstack([basis.get_dofs(side).all() for side in ("lower:bottom", "upper:top")])
    still = [sc.Stage(name, basis.zeros()) for name in ("fit", "still")]
    for stage in sc.Model(forms, fixed).run(still):
        assert stage.tractions("fit").pressure == pytest.approx(
            10.0, rel=1e-3
        )  # the penalty gives way by 1e-7
    with pytest.raises(ValueError, match="positive interference"):
        sc.ContactPair(basis, "upper:bottom", "lower:top", sc.Coulomb(), initial=-0.003)
