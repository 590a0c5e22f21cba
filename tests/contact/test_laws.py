"""Interface laws at single points, against numbers computed by hand."""

from __future__ import annotations

import numpy as np
import pytest

import skfem_contact as sc
from skfem_contact.contact.laws import Status, resisting

#: Exact up to the round-off of a few operations.
EXACT = {"rtol": 1e-12, "atol": 1e-12}


def coulomb(law: sc.Coulomb, gap: float, slip: float):
    """Answer of a law of a closed point in the plane with penalties of 1000 and 500."""
    return law.update(np.array([[gap], [slip]]), np.zeros((1, 1)), (1000.0, 500.0))


def test_bond_breaks_at_its_tension():
    """[X] A tension of 10 is reached at a gap of 0.01; 0.5 % more opens the point for good."""
    law = sc.Coulomb(mu=0.5, adhesion=3.0, tension=10.0)
    below, above = coulomb(law, 0.00995, 0.0), coulomb(law, 0.01005, 0.0)
    np.testing.assert_allclose(below.traction[:, 0], [9.95, 0.0], **EXACT)
    assert (
        above.status[0] == Status.OPEN and not above.traction.any() and above.internal[0, 0] == 1.0
    )


def test_bond_that_heals():
    """[X] A point that has opened adheres again where it closes, unless its bond is broken."""
    opened = coulomb(sc.Coulomb(adhesion=3.0, heals=True), 0.001, 0.02)
    assert opened.status[0] == Status.OPEN and not opened.internal.any()
    for heals, shear in ((True, 3.0), (False, 0.0)):
        law = sc.Coulomb(adhesion=3.0, heals=heals)
        opened = coulomb(law, 0.001, 0.02)
        again = law.update(np.array([[-0.008], [0.02]]), opened.internal, (1000.0, 500.0))
        np.testing.assert_allclose(again.traction[:, 0], [-8.0, shear], **EXACT)
    assert law.reduced(2.0).heals is False and sc.Coulomb(1.0, heals=True).reduced(2.0).heals


@pytest.mark.parametrize(
    ("slip", "shear", "status"), [(0.0139, 6.95, Status.STICK), (0.0141, 7.0, Status.SLIP)]
)
def test_friction_and_adhesion(slip, shear, status):
    """[X] Under a pressure of 8 the shear is at most 3 + 0.5 * 8 = 7."""
    found = coulomb(sc.Coulomb(mu=0.5, adhesion=3.0), -0.008, slip)
    np.testing.assert_allclose(found.traction[:, 0], [-8.0, shear], **EXACT)
    assert found.status[0] == status


def test_damped_tangent_of_friction():
    """[X] By hand: .3 * 5 / 2e-3 = 750 along the slip of a point that slides, nothing where it
    sticks.
    """
    jump, whole = np.array([[-1e-3, -1e-3], [2e-3, 2e-4]]), np.zeros((1, 2))
    update = sc.Coulomb(mu=0.5).update(jump, whole, (1e4, 1e4))
    more = resisting(update, jump[1:]).tangent - update.tangent
    np.testing.assert_allclose(more[1, 1], [750.0, 0.0], rtol=1e-12)
    more[1, 1] = 0.0
    assert not more.any()


def test_reduced_friction():
    """[X] Friction and adhesion are divided by the factor."""
    law = sc.Coulomb(mu=0.6, adhesion=3.0).reduced(1.5)
    np.testing.assert_allclose([law.mu, law.adhesion], [0.4, 2.0], **EXACT)


def test_tied_points():
    """[X] Penalties times gap and slip, in both directions."""
    found = sc.Tied().update(
        np.array([[0.01, -0.02], [0.003, 0.004]]), np.zeros((0, 2)), (1000.0, 500.0)
    )
    np.testing.assert_allclose(found.traction, [[10.0, -20.0], [1.5, 2.0]], **EXACT)
