"""How searches for a collapse end: what shows a limit, what is warned of, flows that a material has
not.
"""

from __future__ import annotations

import re

import numpy as np
import pytest
from skfem import (
    Basis,
    ElementQuad1,
    ElementQuadS2,
    ElementTetP2,
    ElementVector,
    FacetBasis,
    LinearForm,
    MeshQuad,
    MeshTet,
)

import skfem_contact as sc
from skfem_contact.collapse.result import CollapseResult, Stop
from tests.tools.helpers import analysis, grid, vector_basis

CONE = {"E": 1e4, "nu": 0.3, "k": 10.0, "alpha": 0.2}
CHANGING = {"E": 1e4, "nu": 0.3, "c": 10.0, "c_end": 5.0, "strain_end": 0.1}


@pytest.mark.parametrize(
    ("kind", "shown"),
    [
        ("plateau", True),
        ("collapse", True),
        ("stall", False),
        ("max_value", False),
        ("steps", False),
    ],
)
def test_what_shows_a_limit(kind, shown):
    """The curve has levelled off, or there is no equilibrium above; nothing else."""
    stop = Stop(kind, "so it is")
    assert stop.shows_limit is shown and str(stop) == f"{kind}: so it is"


def locked_ground():
    """Clay under a footing beside an elastic post that holds it, quadrilaterals that lock in plane
    strain.
    """
    mesh = MeshQuad.init_tensor(np.linspace(0, 5, 16), np.linspace(-3, 0, 10))
    mesh = mesh.with_boundaries(
        {
            "foot": lambda x: (x[0] < 1 + 1e-9) & (x[1] > -1e-9),
            "bottom": lambda x: x[1] < -3 + 1e-9,
            "sides": lambda x: (x[0] < 1e-9) | (x[0] > 5 - 1e-9),
        }
    )
    mesh = mesh.with_subdomains(
        {"post": lambda x: abs(x[0] - 1.5) < 1 / 6, "clay": lambda x: abs(x[0] - 1.5) > 1 / 6}
    )
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    materials = {"clay": sc.Tresca(E=3e4, nu=0.3, c=10.0), "post": sc.LinearElastic(E=1e6, nu=0.2)}
    forms = {"ground": sc.SolidForm(basis, materials, strain="full")}
    fixed = np.append(basis.get_dofs("bottom").all(), basis.get_dofs("sides").all("u^1"))
    load = LinearForm(lambda v, w: -30.0 * v[1]).assemble(
        FacetBasis(mesh, basis.elem, facets="foot")
    )
    return forms, fixed, load


@pytest.mark.slow
def test_locked_ground_has_no_factor():
    """[X] Full integration admits no mechanism of constant volume: the search ends at its bound,
    and says so.
    """
    with pytest.warns(
        sc.AnalysisWarning,
        match="no collapse was shown: .* max_value: there is no collapse below 20",
    ):
        found = analysis(
            "strength_reduction",
            *locked_ground(),
            max_value=20.0,
            step=0.5,
            progress=False,
        )
    assert (
        found.stop.kind == "max_value" and 20.0 < found.factor < 200.0
    )  # the last step may double its factor


@pytest.mark.slow
def test_one_result_for_both_searches():
    """A limit load and a factor of safety answer the same names; their ends are stages."""
    forms, fixed, load = locked_ground()
    forms = {
        "ground": sc.SolidForm(forms["ground"].basis, forms["ground"].materials, strain="b_bar")
    }
    safety = sc.Model(forms, fixed).strength_reduction(load, progress=False)
    limit = sc.Model(forms, fixed).limit_load(load, progress=False)
    assert type(safety) is type(limit) is CollapseResult
    assert safety.what == "factor of safety" and limit.what == "limit load"
    for found in (safety, limit):
        assert found.stop.shows_limit and found.bracket[0] == found.value
        assert (
            found.x is found.end.x
            and found.load is found.end.load
            and set(found.bands) == {"ground"}
        )
        assert (
            len(found.path) == len(found.curve) or len(found.path) == len(found.curve) + 1
        )  # the unloaded start
    assert safety.factor == pytest.approx(
        limit.multiplier, rel=0.01
    )  # strength / F or load * F: a Tresca body


# -- strength and flow belong to the material


@pytest.mark.parametrize("flow", ["given", "associated"])
def test_cone_with_its_flow(flow):
    """[X] k and alpha are divided; the dilatancy is capped by the friction, or equals it."""
    cone = sc.DruckerPrager(**CONE, beta=0.05).reduced(2.0, flow)
    assert (cone.k, cone.alpha, cone.beta) == (5.0, 0.1, 0.05 if flow == "given" else 0.1)


@pytest.mark.parametrize("flow", ["davis_a", "davis_b", "davis_c", "lagged"])
def test_cone_without_that_flow(flow):
    """A cone of less dilatancy has no c and phi; an associated one stays as it is under every
    flow.
    """
    with pytest.raises(
        ValueError, match=f"flow '{flow}' needs cohesion and friction angle, which a DruckerPrager"
    ):
        sc.DruckerPrager(**CONE, beta=0.05).reduced(2.0, flow)
    cone = sc.DruckerPrager(**CONE, beta=0.2).reduced(2.0, flow)
    assert (cone.k, cone.alpha, cone.beta) == (5.0, 0.1, 0.1)


@pytest.mark.parametrize("flow", ["associated", "davis_a", "davis_b", "davis_c"])
def test_hardening_soil_of_one_friction_angle(flow):
    """[X] First and last strength are those of two soils without hardening."""
    soil = sc.HardeningMohrCoulomb(**CHANGING, phi=30.0, phi_end=30.0, psi=10.0).reduced(1.5, flow)
    for c, own in ((10.0, soil.c), (5.0, soil.c_end)):
        plain = sc.MohrCoulomb(E=1e4, nu=0.3, c=c, phi=30.0, psi=10.0).reduced(1.5, flow)
        assert (own, soil.phi, soil.phi_end, soil.psi) == (plain.c, plain.phi, plain.phi, plain.psi)


@pytest.mark.parametrize("flow", ["associated", "davis_a", "davis_b", "davis_c", "lagged"])
def test_hardening_soil_whose_friction_changes(flow):
    """Its constant psi cannot follow phi, and that is said."""
    with pytest.raises(ValueError, match=f"flow '{flow}'"):
        sc.HardeningMohrCoulomb(**CHANGING, phi=30.0, phi_end=20.0, psi=10.0).reduced(1.5, flow)


@pytest.mark.parametrize(
    "material", [sc.Tresca(E=1.0, nu=0.3, c=4.0), sc.VonMises(E=1.0, nu=0.3, strength=4.0)]
)
def test_materials_of_one_flow(material):
    """Flow at constant volume is associated; a misspelt flow is refused all the same."""
    weaker = [material.reduced(2.0, flow) for flow in ("given", "associated", "davis_b", "lagged")]
    assert {getattr(m, "c", None) or m.strength for m in weaker} == {2.0}
    with pytest.raises(ValueError, match="flow must be one of given"):
        material.reduced(2.0, "davis")


def test_material_without_strength():
    with pytest.raises(ValueError, match="LinearElastic has no strength to reduce"):
        sc.LinearElastic(E=1.0, nu=0.3).reduced(2.0)


@pytest.mark.slow
def test_a_cube_that_is_crushed_as_a_whole_has_collapsed(recwarn) -> None:
    """[X] Quadratic tetrahedra with two equal stresses: 2 c, and nothing above it; every point is
    at a corner.
    """
    mesh = MeshTet().with_boundaries({"top": lambda x: x[2] > 1.0 - 1e-9})
    basis = Basis(mesh, ElementVector(ElementTetP2()), intorder=2)
    fixed = [basis.get_dofs(lambda x, i=i: x[i] < 1e-9).all(f"u^{i + 1}") for i in range(3)]
    model = sc.Model({"cube": sc.SolidForm(basis, sc.Tresca(E=1e3, nu=0.3, c=10.0))}, fixed)
    found = model.limit_load(model.traction("top", (0.0, 0.0, -1.0)), step=5.0, progress=False)
    assert found.multiplier == pytest.approx(20.0, rel=1e-9) and found.bracket[1] < 20.2
    assert found.stop.kind == "collapse"
    reduced = model.strength_reduction(model.traction("top", (0.0, 0.0, -10.0)), progress=False)
    assert reduced.factor == pytest.approx(2.0, abs=0.01) and reduced.stop.kind == "collapse"
    assert not recwarn.list  # nor does the mesh add anything


def test_load_of_zeros_has_no_limit():
    """A load of zeros, or on supports alone, cannot be multiplied."""
    basis = Basis(MeshQuad().refined(1).with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    soil = sc.MohrCoulomb(1e4, 0.3, c=10.0, phi=20.0)
    form = sc.SolidForm(basis, soil, unit_weight=20.0)
    model = sc.Model({"soil": form}, sc.box_supports(basis))
    on_supports = basis.zeros()
    on_supports[basis.get_dofs("bottom").all()] = 1.0
    for load in (basis.zeros(), on_supports):
        with pytest.raises(ValueError, match="the load to be multiplied is zero"):
            model.limit_load(load, progress=False)


def test_result_is_that_of_the_last_equilibrium() -> None:
    """[X] A strip of clay, 2 wide, bears 2 c: it has shortened by the strain of this load, and
    steps that end at once have no iterations.
    """
    E, nu, c = 1e3, 0.3, 10.0
    basis = vector_basis(grid("Q1", [0, 1, 2], [0, 1]), "Q1", intorder=2)
    clay = sc.SolidForm(basis, sc.Tresca(E=E, nu=nu, c=c), strain="b_bar")
    fixed = [basis.get_dofs("bottom").all("u^2"), basis.get_dofs("left").all("u^1")]
    load = sc.traction(basis, "top", (0.0, -1.0))
    found = sc.Model({"clay": clay}, fixed).limit_load(load, progress=False)
    assert found.value == pytest.approx(2.0 * c, rel=1e-6)
    settled = -found.x[basis.get_dofs("top").all("u^2")]
    np.testing.assert_allclose(settled, 2.0 * c * (1.0 - nu**2) / E, rtol=1e-6)
    assert min(step.iterations for step in found.steps if step.outcome != "equilibrium") == 0


def test_a_value_that_needs_large_displacements_is_told():
    """[X] A bar flows at 20 beside a spring of 10: the value at a displacement u is 20 + 10 u, 21
    at u = 0.1.
    """
    bar = sc.Reinforcement(None, [[0.0, 0.0], [1.0, 0.0]], EA=1e4, Np=20.0)
    spring = sc.Bar(None, bar.at((0.0, 0.0)), bar.at((1.0, 0.0)), EA=10.0)
    held = [*bar.dofs((0.0, 0.0)), *bar.dofs((1.0, 0.0), ["u^2"]), *bar.dofs((0.5, 0.0), ["u^2"])]
    model = sc.Model({"bar": bar, "spring": spring}, held)
    pull = model.forms["bar"].load((1.0, 0.0), at=(1.0, 0.0))
    with pytest.warns(sc.AnalysisWarning) as told:
        found = model.limit_load(
            pull, step=5.0, min_displacement=0.8, max_value=30.0, progress=False
        )
    text = next(str(w.message) for w in told if "belongs to displacements" in str(w.message))
    moved, near, reached = (float(x) for x in re.findall(r"\d[\d.]*\d", text)[1:4])
    assert moved > 0.8 and found.multiplier == pytest.approx(20.0 + 10.0 * moved, rel=5e-3)
    assert (near, reached) == (
        0.1,
        pytest.approx(21.0, rel=5e-3),
    )  # the search's tolerance and the printed digits


@pytest.mark.parametrize(
    "element, order, told",
    [
        (ElementQuad1(), 2, "corner nodes alone.*take ElementTriP2 or ElementQuadS2 with intor"),
        (ElementQuadS2(), 4, "no collapse was shown.*QuadS2 of 9 points, which lock.*intorder=2"),
        (ElementQuadS2(), 2, ""),
    ],
)
def test_locking_around_a_sphere_is_told(element, order, told, recwarn) -> None:
    """[X] A spherical cavity in clay, a = 1 and b = 10, yields throughout at 4 c ln(b / a). Without
    reduced integration no axisymmetric element keeps its volume: the load grows without end, up to
    1e13, where shear stresses are small beside the mean ones but no round-off.
    """
    flat = MeshQuad.init_tensor(np.geomspace(1.0, 10.0, 9), np.linspace(0.0, 0.5 * np.pi, 9))
    r, angle = flat.p
    mesh = MeshQuad(np.array([r * np.sin(angle), r * np.cos(angle)]), flat.t[::-1])
    mesh = mesh.with_boundaries(
        {
            "wall": lambda x: np.hypot(*x) < 1.02,
            "axis": lambda x: x[0] < 1e-9,
            "base": lambda x: x[1] < 1e-9,
        }
    )
    basis = Basis(mesh, ElementVector(element), intorder=order)
    clay = sc.Tresca(E=300.0, nu=0.49, c=1.0)
    forms = {"clay": sc.SolidForm(basis, clay, coordinates="axisymmetric")}
    fixed = np.append(basis.get_dofs("axis").all("u^1"), basis.get_dofs("base").all("u^2"))
    pressure = LinearForm(lambda v, w: -(v[0] * w.n[0] + v[1] * w.n[1]) * w.x[0])
    load = pressure.assemble(FacetBasis(mesh, basis.elem, facets="wall"))
    found = analysis("limit_load", forms, fixed, load, progress=False)
    texts = [str(w.message) for w in recwarn if "lock" in str(w.message) or "alone" in str(w)]
    if told:
        assert found.multiplier > 100.0
        assert any(re.search(told, text) for text in texts)
        assert not any("b_bar" in text for text in texts)
    else:
        assert found.multiplier == pytest.approx(4.0 * np.log(10.0), rel=2e-3)
        assert not texts
