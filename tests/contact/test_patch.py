"""Uniform pressures pass through meshes that do not match."""

from __future__ import annotations

import numpy as np
import pytest

import skfem_contact as sc
from tests.tools.helpers import grid, traction, vector_basis


@pytest.mark.parametrize("element", ["Q1", "Q2", "P2"])
@pytest.mark.parametrize(("lower", "upper"), [(2, 3), (3, 2), (5, 7)])
def test_default_passes_the_patch_test(element: str, lower: int, upper: int) -> None:
    """[X] A uniform pressure passes through meshes that do not match, by the rule that nobody has
    to ask for.
    """
    bodies = {
        "low": grid(element, np.linspace(0, 1, lower + 1), np.linspace(-1, 0, lower + 1)),
        "up": grid(element, np.linspace(0, 1, upper + 1), np.linspace(0, 1, upper + 1)),
    }
    basis = vector_basis(sc.join_bodies(bodies), element, intorder=4)
    forms = {
        "blocks": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.3)),
        "joint": sc.ContactPair(basis, "up:bottom", "low:top", sc.Coulomb()),
    }
    guided = basis.get_dofs({"low:left", "up:left"}).all("u^1")
    stage = sc.Stage("press", traction(basis, "up:top", (0.0, -1.0)))
    result = sc.Model(forms, np.union1d(basis.get_dofs("low:bottom").all("u^2"), guided)).run(
        [stage], progress=False
    )
    # round-off: both meshes' shape functions are integrated exactly
    np.testing.assert_allclose(result["press"].states["blocks"].stress[1], -1.0, atol=1e-11)


@pytest.mark.parametrize("element", ["Q1", "Q2", "P2"])
@pytest.mark.parametrize("augmented", [False, True])
@pytest.mark.parametrize(("quadrature", "upper"), [("segments", 5), ("segments", 2), ("nodal", 3)])
def test_patch_in_axial_symmetry(quadrature, upper: int, augmented: bool, element: str) -> None:
    """[X] A uniform pressure passes from cylinder to cylinder: contact counts its forces per radian
    as solids do.
    """
    bodies = {
        "low": grid(element, np.linspace(0, 1, 4), np.linspace(-1, 0, 3)),
        "up": grid(element, np.linspace(0, 1, upper + 1), np.linspace(0, 1, 3)),
    }
    basis = vector_basis(sc.join_bodies(bodies), element, intorder=4)
    enforcement = sc.AugmentedLagrangian() if augmented else None
    options = {"quadrature": quadrature, "enforcement": enforcement}
    forms = {
        "solids": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.3), coordinates="axisymmetric"),
        "joint": sc.ContactPair(basis, "up:bottom", "low:top", sc.Coulomb(), **options),
    }
    axis = basis.get_dofs({"low:left", "up:left"}).all("u^1")
    fixed = np.union1d(basis.get_dofs("low:bottom").all("u^2"), axis)
    load = sc.traction(forms["solids"], "up:top", (0.0, -1.0))
    stage = sc.Model(forms, fixed).run([sc.Stage("press", load)], progress=False)["press"]
    # round-off: shape functions and radius are integrated exactly
    np.testing.assert_allclose(stage.states["solids"].stress[1], -1.0, atol=1e-10)
    np.testing.assert_allclose(stage.states["joint"].traction[0], -1.0, atol=1e-10)
    joint = stage.tractions("joint")
    assert (joint.pressure * joint.weight).sum() == pytest.approx(
        0.5
    )  # of a circle of radius 1, per radian


@pytest.mark.parametrize("quadrature", [1, 2, 3])
def test_fewer_points_than_multipliers(quadrature: int) -> None:
    """[X] One or two Gauss points on a quadratic facet: the blocks shorten as if they were one, and
    nothing is NaN.
    """
    bodies = {"low": grid("Q2", [0, 0.5, 1], [-1, 0]), "up": grid("Q2", [0, 0.5, 1], [0, 1])}
    basis = vector_basis(sc.join_bodies(bodies), "Q2")
    enforcement = sc.AugmentedLagrangian(tolerance=1e-6)
    forms = {
        "blocks": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.3)),
        "joint": sc.ContactPair(
            basis, "up:bottom", "low:top", sc.Coulomb(), quadrature, enforcement=enforcement
        ),
    }
    guided = basis.get_dofs({"low:left", "up:left"}).all("u^1")
    stage = sc.Stage("press", traction(basis, "up:top", (0.0, -1.0)))
    result = sc.Model(forms, np.union1d(basis.get_dofs("low:bottom").all("u^2"), guided)).run(
        [stage], progress=False
    )
    assert np.isfinite(result["press"].states["joint"].multiplier).all()
    short = -result["press"].x[basis.get_dofs("up:top").all("u^2")].mean()
    # ten times the tolerance; one point leaves the ends of the facets free to part, by less than
    # they are strained
    assert short == pytest.approx(2 * (1 - 0.3**2) / 1e3, rel=1e-5 if quadrature > 1 else 0.1)


@pytest.mark.filterwarnings("ignore::skfem_contact.AnalysisWarning")
@pytest.mark.parametrize("element", ["Q1", "P2"])
@pytest.mark.parametrize("enforcement", [sc.AugmentedLagrangian(), sc.DualMultipliers()])
def test_pull_on_a_rigid_side(enforcement, element: str) -> None:
    """[X] A tied block whose own side of the joint is rigid is pressed and then pulled evenly, in
    ten increments: some tractions there move nothing, and may not build up.
    """
    bodies = {
        "low": grid(element, np.linspace(0, 1, 3), [-1, 0]),
        "up": grid(element, np.linspace(0, 1, 4), [0, 1]),
    }
    basis = vector_basis(sc.join_bodies(bodies), element, intorder=4)
    forms = {
        "blocks": sc.SolidForm(basis, sc.LinearElastic(E=1e6, nu=0.0)),
        "joint": sc.ContactPair(basis, "up:bottom", "low:top", sc.Tied(), enforcement=enforcement),
        "cap": sc.RigidBoundary(basis, "up:bottom"),
    }
    model = sc.Model(forms, basis.get_dofs("low:bottom").all())
    press = model.traction("up:top", (0.0, -10.0))
    stages = [sc.Stage("press", press), sc.Stage("pull", -0.4 * press, increments=10)]
    result = model.run(stages, progress=False)
    for name, pressure in (("press", 10.0), ("pull", -4.0)):
        # Combinations of multipliers beyond the motions of a flat side follow round-off alone
        np.testing.assert_allclose(result[name].tractions("joint").pressure, pressure, rtol=1e-4)
