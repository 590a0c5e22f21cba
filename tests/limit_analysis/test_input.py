"""Input of bounds that is refused, and bodies that nothing holds."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from skfem import Basis, ElementQuad1, ElementTriP2, ElementVector, MeshQuad, MeshTri

import skfem_contact as sc
from skfem_contact.limit_analysis.model import _unit_tractions
from tests.tools.helpers import analysis
from tests.tools.scenes import sliding_blocks

SOIL = sc.MohrCoulomb(E=1e5, nu=0.3, c=10.0, phi=20.0, psi=20.0)


def column(material) -> tuple[dict, np.ndarray]:
    """A square that can spread between its base and a smooth left side."""
    basis = Basis(MeshTri().refined(2).with_defaults(), ElementVector(ElementTriP2()), intorder=2)
    fixed = np.append(basis.get_dofs("bottom").all("u^2"), basis.get_dofs("left").all("u^1"))
    return {"ground": sc.SolidForm(basis, material)}, fixed


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"seismic": np.nan}, "seismic"),
        ({"water": lambda x: np.nan * x[0]}, "water must be finite"),
        ({"submerged": "right"}, "give `water`"),
    ],
)
def test_bad_input_is_named(given: dict, message: str) -> None:
    """Values that are not finite, and boundaries under water without water: one error that names
    the argument.
    """
    with pytest.raises(ValueError, match=message):
        analysis("bounds", *column(SOIL), weight=20.0, elements=100, progress=False, **given)


@pytest.mark.parametrize(
    ("material", "given", "message"),
    [
        (
            sc.LinearElastic(E=1e5, nu=0.3),
            {"tractions": {"top": (0.0, -1.0)}, "live": "top"},
            "nothing can yield: all solids",
        ),
        (
            sc.MohrCoulomb(E=1e5, nu=0.3, c=0.0, phi=0.0),
            {"weight": 20.0},
            "'ground.*' has neither cohesion nor friction",
        ),
        (
            SOIL,
            {"tractions": {"top": lambda x: np.ones(3)}},
            r"the traction on 'top' must have shape \(2, .*\) and finite values",
        ),
        (
            SOIL,
            {"tractions": {"top": lambda x: np.nan * x}},
            r"the traction on 'top' must have shape \(2, .*\) and finite values",
        ),
        (SOIL, {"tractions": {"top": (1.0, 2.0, 3.0)}}, r"must be \(t_x, t_y\) or a function"),
    ],
)
def test_what_has_no_bounds(material, given: dict, message: str) -> None:
    """Nothing that yields, no strength at all, and tractions of another shape."""
    with pytest.raises(ValueError, match=message):
        analysis("bounds", *column(material), elements=100, progress=False, **given)


def test_rigid_body_in_the_air() -> None:
    """A rigid body that nothing holds is refused before the iteration."""
    forms, fixed = sliding_blocks(1.0, SOIL, sc.LinearElastic(1e6, 0.2), None)
    with pytest.raises(ValueError, match="can move freely"):
        sc.Model(forms, fixed).bounds(weight=20.0, gap=0.2, elements=100, progress=False)


@pytest.mark.parametrize("apart", [False, True])
def test_rigid_bodies_that_meet_in_a_corner(apart: bool) -> None:
    """Two elastic squares in the ground are rigid, and are refused where they meet in a node."""
    mesh = MeshQuad.init_tensor(np.arange(5.0), np.arange(4.0)).with_defaults()
    second = 2 if apart else 1
    corners = {(0, 1), (second, 2)}
    stiff = [k for k, x in enumerate(mesh.p[:, mesh.t].min(axis=1).T) if tuple(x) in corners]
    soil = np.setdiff1d(np.arange(mesh.nelements), stiff)
    mesh = mesh.with_subdomains({"stiff": np.array(stiff), "soil": soil})
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    laws = {"stiff": sc.LinearElastic(E=1e6, nu=0.2), "soil": sc.Tresca(E=1e5, nu=0.3, c=10.0)}
    fixed = [basis.get_dofs("bottom").all(), basis.get_dofs({"left"}).all("u^1")]
    model = sc.Model({"ground": sc.SolidForm(basis, laws)}, fixed)
    given = {"weight": 1.0, "gap": 0.5, "elements": 60, "progress": False}
    if apart:
        assert model.bounds(**given).upper > 1.0
        return
    with pytest.raises(ValueError, match="meet in a node"):
        model.bounds(**given)


@pytest.mark.parametrize("below", [0.0, 1e-16, 1e-3])
def test_cohesion_that_begins_at_zero(below: float) -> None:
    """A strength that grows from zero with depth is taken, also with round-off below zero, and a
    negative one refused with its place.
    """

    def cohesion(x):
        return 10.0 * (1.0 - x[1]) - below

    forms, fixed = column(sc.Tresca(E=1e5, nu=0.3, c=cohesion))
    options = {"weight": 1.0, "elements": 100, "progress": False}
    if below < 1e-6:
        assert analysis("bounds", forms, fixed, **options).upper > 1.0
        return
    with pytest.raises(ValueError, match=r"must not be negative, got -0\.001 at \(.*, 1\)"):
        analysis("bounds", forms, fixed, **options)


def test_boundaries_on_which_a_load_may_be_recognised() -> None:
    """[X] Those with facets, all of them outer ones of the ground: forces of unit tractions are the
    lengths.
    """
    mesh = MeshTri.init_tensor([0.0, 1.0, 2.0, 3.0], [0.0, 1.0, 2.0]).with_defaults()
    inner = mesh.facets_satisfying(lambda x: x[1] == 1.0)
    part = mesh.facets_satisfying(lambda x: (x[1] == 2.0) & (x[0] < 2.0))
    named = {**mesh.boundaries, "inner": inner, "none": inner[:0], "part": part}
    named["both"] = np.append(inner, part)
    basis = Basis(replace(mesh, _boundaries=named), ElementVector(ElementTriP2()), intorder=2)
    # The right third is without ground
    elements = np.flatnonzero(mesh.p[0, mesh.t].mean(axis=0) < 2.0)
    found = _unit_tractions(SimpleNamespace(basis=basis, elements=elements))
    assert set(found) == {"left", "part"}
    for name in found:
        forces = found[name].reshape(-1, 2, 6).sum(axis=0)
        np.testing.assert_allclose(forces[[0, 1], [0, 3]], 2.0, rtol=1e-12)
