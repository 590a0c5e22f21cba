"""Tractions on a boundary."""

from __future__ import annotations

import numpy as np
import pytest

import skfem_contact as sc
from skfem_contact.loads import Domain
from tests.tools.helpers import grid, resultant, vector_basis


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
    [
        ((1.0,), "must have 2 finite components"),
        ((1.0, np.nan), "each a finite number"),
        (lambda x: (np.nan, 1.0), r"not \[nan, 1.0\], the first values of its function"),
    ],
)
def test_wrong_forces_are_refused(force, message):
    basis = vector_basis(grid("Q1", [0, 1], [0, 1]), "Q1")
    with pytest.raises(ValueError, match=message):
        sc.traction(basis, "top", force)
    with pytest.raises(ValueError, match="no boundary 'roof'; existing: bottom, left, right, top"):
        sc.traction(basis, "roof", (0.0, 1.0))


def test_load_on_the_surface_of_a_footing_acts_on_its_top() -> None:
    """[X] 75 kPa on a footing 2 m wide that stands .5 m high on the ground are 150 kN/m; its sides,
    1 m, have their own name.
    """
    section = sc.section.footing(2.0, 0.5, {"sand": -6.0}, size=2.0)
    basis = vector_basis(section.mesh(), "P1")
    loads = {
        name: sc.traction(basis, f"footing:{name}", (0.0, -75.0)).sum()
        for name in ("surface", "top", "sides")
    }
    right = {"surface": -150.0, "top": -150.0, "sides": -75.0}
    assert loads == pytest.approx(right, rel=1e-12)
