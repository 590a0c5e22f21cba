"""The plate of the GRECO benchmarks on a rigid plane: one contact that opens, slips and sticks.
Case C3.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import skfem_contact as sc
from skfem_contact.contact.laws import Status
from tests.tools.helpers import grid, traction, vector_basis

SIZE, E, NU = 0.04, 1.3e11, 0.2
TOP, LEFT = 5e7, 15e7
#: Displacements along the plane, 1e-5 m, at these places. The first row was published (code_aster,
#: SSNV128, after Feijoo, Barbosa and Zouain; scatter 5 %); the second has converged with exact
#: Coulomb friction, by block Gauss-Seidel iterations on the condensed stiffness (Q1, 128 elements
#: to a side; Q2, 64).
PLACES = np.array([0.0, 1.25e-3, 5e-3, 7.5e-3, 11.25e-3])
PUBLISHED = np.array([2.86, 2.72, 2.28, 1.98, 1.54])
CONVERGED = np.array([2.8602, 2.7225, 2.2867, 1.9807, 1.5414])
AUGMENTED = sc.AugmentedLagrangian()


class Plate:
    """The plate after its load.

    Attributes
    ----------
    x, along, up
        Nodes of the bottom and their displacements.
    joint
        Contact tractions.
    """

    def __init__(self, n: int, element: str, increments: int = 1, **options) -> None:
        basis = vector_basis(grid(element, *[np.linspace(0, SIZE, n + 1)] * 2), element)
        load = traction(basis, "top", (0.0, -TOP)) + traction(basis, "left", (LEFT, 0.0))
        right = basis.get_dofs("right").all("u^1")
        corner = np.flatnonzero((basis.doflocs[0] == SIZE) & (basis.doflocs[1] == 0.0))
        plane = sc.rigid.line((-SIZE, 0.0), (2 * SIZE, 0.0))
        pair = sc.ContactPair(
            basis, "bottom", plane, sc.Coulomb(1.0), **{"quadrature": "nodal", **options}
        )
        forms = {"plate": sc.SolidForm(basis, sc.LinearElastic(E=E, nu=NU)), "plane": pair}
        stage = sc.Stage("press", load, increments=increments)
        end = sc.Model(forms, np.union1d(right, corner)).run([stage], progress=False)[-1]
        bottom = basis.get_dofs("bottom")
        along = bottom.all("u^1")
        order = np.argsort(basis.doflocs[0, along])
        self.x = basis.doflocs[0, along][order]
        self.along, self.up = end.x[along][order], end.x[bottom.all("u^2")][order]
        self.joint = end.tractions("plane")
        self.increments = len(end.iterations)

    @property
    def displacements(self) -> np.ndarray:
        """At the places of the benchmark, 1e-5 m."""
        return 1e5 * np.interp(PLACES, self.x, self.along)

    @property
    def friction(self) -> float:
        """Force of the plane on the plate."""
        return -float(self.joint.shear @ self.joint.weight)


@cache
def plate(n: int, element: str, increments: int = 1, **options) -> Plate:
    return Plate(n, element, increments, **options)


@pytest.mark.parametrize(("n", "element", "tolerance"), [(64, "Q1", 2e-4), (32, "Q2", 5e-4)])
def test_augmented(n: int, element: str, tolerance: float) -> None:
    """[N], [P] C3: without penetration the converged values, whose digits end at 3e-5, are met as
    the mesh can. Tractions of the corner, which is held, follow its neighbours: friction is off by
    1.7e-3 and 4e-4 with 16 and 32 facets.
    """
    one = plate(n, element, quadrature="segments", enforcement=AUGMENTED)
    np.testing.assert_allclose(one.displacements, CONVERGED, rtol=tolerance)
    np.testing.assert_allclose(one.displacements, PUBLISHED, rtol=0.05)  # its scatter
    assert one.friction == pytest.approx(-1.40536e6, rel=1e-3)
    x, status, h = one.joint.x, one.joint.status, SIZE / n
    assert x[status == Status.OPEN].max() == pytest.approx(3.1e-3, abs=h)
    assert x[status == Status.SLIP].max() == pytest.approx(29.7e-3, abs=h)
    # the gap is largest at the corner, where the mesh resolves it least
    assert one.up.max() == pytest.approx(5.91e-7, rel=0.05)


@pytest.mark.parametrize("quadrature", ["nodal", 2, "segments"])
def test_bias_of_the_default_penalty(quadrature) -> None:
    """[N] C3: penetration and elastic slip take 0.1 to 0.2 % of the displacements at 64 elements to
    a side.
    """
    one = plate(64, "Q1", quadrature=quadrature)
    np.testing.assert_allclose(one.displacements, CONVERGED, rtol=3e-3)  # the tolerance of the case
    assert (one.displacements < CONVERGED).all()
    assert one.friction == pytest.approx(-1.40536e6, rel=2e-3)


def test_one_step_or_ten() -> None:
    """[X] C3: the load is proportional: status, slip and stick do not depend on the number of
    steps.
    """
    for options in ({"quadrature": "nodal"}, {"quadrature": "segments", "enforcement": AUGMENTED}):
        one, ten = plate(32, "Q1", **options), plate(32, "Q1", 10, **options)
        assert one.increments == 1 and ten.increments == 10
        # the augmented method stops at 1e-4 of the tractions, and the steps add up
        np.testing.assert_allclose(
            ten.displacements, one.displacements, rtol=1e-6 if len(options) == 1 else 3e-4
        )
