"""Parameters that are functions of the coordinates: elements, stages, searches, bounds, files and
bad input.
"""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from skfem import (
    Basis,
    ElementHex1,
    ElementQuad2,
    ElementTriP1,
    ElementTriP2,
    ElementVector,
    MeshHex,
    MeshQuad,
    MeshTri,
)

import skfem_contact as sc
from skfem_contact.limit_analysis.elements import stress_elements, velocity_elements
from skfem_contact.limit_analysis.model import discretise, named_loads
from skfem_contact.limit_analysis.reading import read
from tests.oracles.strip_on_profile import mean_pressure
from tests.tools.helpers import analysis

C0, RHO = 0.5, 10.0


def strength(x):
    return C0 - RHO * x[1]


def clay(**changes) -> sc.Tresca:
    return sc.Tresca(**({"E": lambda x: 1e3 * strength(x), "nu": 0.49, "c": strength} | changes))


def cut(n: int = 4, material=None, element=None) -> tuple[dict, np.ndarray]:
    """Vertical cut of height 1 below the surface y = 0, unit weight 20."""
    grid = MeshTri.init_tensor(
        np.linspace(-1.5, 1.0, 5 * n // 2 + 1), np.linspace(-1.5, 0.0, 3 * n // 2 + 1)
    )
    x, y = grid.p[:, grid.t].mean(axis=1)
    mesh = grid.restrict(np.flatnonzero((x < 0.0) | (y < -1.0)))
    basis = Basis(mesh, ElementVector(element or ElementTriP2()), intorder=2)
    sides = basis.get_dofs(lambda x: np.isclose(x[0], -1.5) | np.isclose(x[0], 1.0)).all("u^1")
    fixed = np.concatenate((basis.get_dofs(lambda x: np.isclose(x[1], -1.5)).all(), sides))
    return {"ground": sc.SolidForm(basis, material or clay(), unit_weight=20.0)}, fixed


def level(material) -> tuple[sc.Model, Basis]:
    mesh = MeshQuad.init_tensor(np.linspace(0, 4, 5), np.linspace(-2, 0, 4)).with_defaults()
    basis = Basis(mesh, ElementVector(ElementQuad2()), intorder=4)
    return sc.Model(
        {"ground": sc.SolidForm(basis, material, unit_weight=18.0)}, sc.box_supports(basis)
    ), basis


def test_values_at_the_points() -> None:
    """[X] Strength at the integration points, moduli as means of the elements, beside an array of
    the elements.
    """
    model, basis = level(
        sc.MohrCoulomb(E=lambda x: 100.0 - x[1] ** 2, nu=0.3, c=strength, phi=np.full(12, 20.0))
    )
    soil, x = model.forms["ground"].materials["all"], np.asarray(basis.global_coordinates())
    np.testing.assert_allclose(soil.c, strength(x), rtol=1e-14)
    np.testing.assert_allclose(soil.E, (100.0 - x[1] ** 2).mean(axis=1), rtol=1e-14)
    weaker = soil.reduced(2.0)
    np.testing.assert_allclose(weaker.c, 0.5 * strength(x), rtol=1e-14)
    np.testing.assert_allclose(
        np.tan(np.radians(weaker.phi)), 0.5 * np.tan(np.radians(20.0)), rtol=1e-14
    )


def test_stress_returns_to_the_strength_of_each_point() -> None:
    """[X] Simple shear of the whole body: the shear stress is the strength at every point, for the
    tangent as well.
    """
    model, basis = level(clay())
    form = model.forms["ground"]
    x = basis.zeros()
    x[basis.nodal_dofs[0]], x[basis.facet_dofs[0]] = (
        basis.mesh.p[1],
        basis.mesh.p[1, basis.mesh.facets].mean(axis=0),
    )
    x[basis.interior_dofs[0]] = basis.mesh.p[1, basis.mesh.t].mean(axis=0)
    response = form.assemble(x, form.initial_state())
    np.testing.assert_allclose(
        response.state.stress[3], strength(np.asarray(basis.global_coordinates())), rtol=1e-12
    )
    direction, h = np.random.default_rng(1).standard_normal(len(x)), 1e-7
    change = (form.assemble(x + h * direction, form.initial_state()).force - response.force) / h
    assert (
        np.abs(response.stiffness @ direction - change).max() < 1e-5 * np.abs(change).max()
    )  # differences


def test_in_space() -> None:
    """[X] The coordinates have three rows there."""
    basis = Basis(MeshHex().refined(1), ElementVector(ElementHex1()), intorder=2)
    form = sc.SolidForm(basis, sc.VonMises(E=1.0, nu=0.3, strength=lambda x: 1.0 + x[2]))
    np.testing.assert_allclose(
        form.materials["all"].strength, 1.0 + np.asarray(basis.global_coordinates())[2]
    )


def test_stages_searches_and_files(tmp_path) -> None:
    """[X] K0 state, undrained ground, change of material, fields, file: with numbers where the
    function is constant.
    """
    results = []
    for c in (30.0, lambda x: np.full(x.shape[1:], 30.0)):
        soil = sc.Undrained(sc.MohrCoulomb(E=5e3, nu=0.3, c=c, phi=0.0), nu_undrained=0.49)
        model, basis = level(soil)
        start = model.k0_state(K0=0.8)
        weaker = model.forms["ground"].with_materials({"all": sc.Tresca(E=5e3, nu=0.49, c=c)})
        load = sc.traction(
            basis, "top", lambda x: np.stack((0.0 * x[0], np.where(x[0] < 2, -60.0, 0.0)))
        )
        done = model.run(
            [sc.Stage("load", load), sc.Stage("changed", load, change={"ground": weaker})],
            start=start,
        )
        done.save(tmp_path / "run")
        again = sc.load_result(tmp_path / "run", model)
        np.testing.assert_array_equal(again["changed"].x, done["changed"].x)
        found = model.strength_reduction(load, start=start, certify=False)
        results.append(
            (
                done["changed"].x,
                done["load"].field("mobilised"),
                found.factor,
                done["load"].undrained_strength("ground")["all"],
            )
        )
    for one, other in zip(*results):
        np.testing.assert_allclose(one, other, rtol=1e-9, atol=1e-12)


@pytest.mark.slow
def test_vertical_cut_of_normally_consolidated_clay() -> None:
    """[X] Without c0 the plane through the toe is exact, 2 rho / gamma = 1; with it both bounds
    enclose the plane's.
    """
    for c0, low, most, share in ((0.0, None, 350, 0.05), (C0, 1.08, 1000, 0.03)):
        forms, fixed = cut(4, clay(c=lambda x, c0=c0: c0 - RHO * x[1]))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", sc.AnalysisWarning)
            found = sc.Model(forms, fixed).bounds(elements=most, gap=0.03, progress=False)
        plane = 4 * c0 / 20.0 + 2 * RHO / 20.0
        assert (
            plane - 1e-9 < found.upper < (1.0 + share) * plane
        )  # .03 with 350, .024 with 1,000 triangles
        assert (found.lower == 0.0) if low is None else low < found.lower < plane


def test_smooth_footing() -> None:
    """[N] Slip lines of Davis and Booker, .1 % from their limit with 8 of them, lie between the
    bounds.
    """
    x = np.concatenate((np.linspace(0.0, 0.5, 4), 0.5 + 1.5 * np.linspace(0.0, 1.0, 7)[1:] ** 1.5))
    soil = MeshTri.init_tensor(x, -(np.linspace(1.0, 0.0, 7) ** 1.5)).with_defaults()
    plate = MeshTri.init_tensor(np.linspace(0.0, 0.5, 4), np.array([0.0, 0.1])).with_defaults()
    basis = Basis(
        sc.join_bodies({"soil": soil, "plate": plate}), ElementVector(ElementTriP2()), intorder=2
    )
    forms = {
        "soil": sc.SolidForm(
            basis.with_elements("soil"), sc.Tresca(1e3, 0.49, c=lambda x: 1.0 - 2.0 * x[1])
        ),
        "plate": sc.SolidForm(basis.with_elements("plate"), sc.LinearElastic(E=1e5, nu=0.3)),
        "base": sc.ContactPair(
            basis, slave="plate:bottom", master="soil:top", law=sc.Coulomb(mu=0.0)
        ),
    }
    sides = [basis.get_dofs(name).all("u^1") for name in ("soil:left", "soil:right", "plate:left")]
    model = sc.Model(forms, np.concatenate((basis.get_dofs("soil:bottom").all(), *sides)))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", sc.AnalysisWarning)
        found = model.bounds(
            tractions={"plate:top": (0.0, -1.0)}, live="plate:top", elements=350, progress=False
        )
    exact = mean_pressure(c0=1.0, rho=2.0, width=1.0, n=8)
    assert found.lower < exact < found.upper
    assert found.gap < 0.13


def test_dissipation_of_linear_strength_and_strain() -> None:
    r"""[X] In a triangle \int c |e| with linear c and e of one sign; nodal values of c alone would
    be too little.
    """
    forms, fixed = cut(2)
    problem = read(
        forms,
        fixed,
        lambda site: named_loads(site, 20.0, {}, None, (), 0.0, ()),
        False,
        None,
        (),
        True,
    )
    triangles = problem.model.triangles
    program = discretise(problem.model, triangles, velocity_elements(triangles.mesh))
    n, mass = len(program.soft), (np.ones((3, 3)) + np.eye(3)) / 4
    corners = triangles.mesh.p[:, triangles.mesh.t[:, program.soft]]
    c = (
        strength(problem.geometry.centre[:, None, None] + problem.geometry.size * corners).T
        / problem.stress
    )
    strain = np.random.default_rng(0).uniform(size=(n, 3))
    full = np.zeros((program.n_points, 3))
    full[: 3 * n, 2] = strain.ravel()
    spent = (
        program.of_points(lambda s, points: s.dissipation(full[points], 1.0))
        .reshape(n, 3)
        .sum(axis=1)
    )
    np.testing.assert_allclose(spent, np.einsum("ni,ij,nj->n", c, mass, strain), rtol=1e-12)
    below = discretise(problem.model, triangles, stress_elements(triangles.mesh)).strengths[0]
    np.testing.assert_allclose(below.c.reshape(n, 3), c, rtol=1e-12)


def test_davis_estimate_and_linear_triangles() -> None:
    """[B] The estimate after Davis takes the same share of a cohesion that varies; one point an
    element is enough.
    """
    soil = sc.MohrCoulomb(E=1e4, nu=0.3, c=strength, phi=20.0)
    found = analysis("bounds", *cut(2, soil, ElementTriP1()), elements=200, gap=1.0, progress=False)
    constant = analysis(
        "bounds",
        *cut(2, sc.MohrCoulomb(E=1e4, nu=0.3, c=strength, phi=20.0, psi=20.0)),
        elements=200,
        gap=1.0,
        progress=False,
    )
    assert found.estimate
    assert found.lower < constant.lower < found.upper
    same = [
        analysis(
            "bounds",
            *cut(2, sc.MohrCoulomb(E=1e4, nu=0.3, c=c, phi=20.0)),
            elements=200,
            gap=1.0,
            progress=False,
        ).lower
        for c in (10.0, lambda x: np.full(x.shape[1:], 10.0))
    ]
    assert same[1] == pytest.approx(same[0], rel=1e-6)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (
            {"c": lambda x: x},
            r"material of 'all': c\(x\) must return one number for each point, shape \(12, 9\)",
        ),
        ({"c": lambda x: x[0] * np.nan}, r"c\(x\) must be finite"),
        ({"c": lambda x: x[1]}, "c must not be negative, got .* in element 0"),
        ({"E": lambda x: x[1]}, "E must be positive, got .* in element 0"),
        ({"c": "soft"}, "c must be a finite number or an array of real numbers or a function"),
    ],
)
def test_bad_functions(wrong, message: str) -> None:
    """Names of parameter and element, when the body is made."""
    with pytest.raises(ValueError, match=message):
        level(clay(**wrong))


def test_what_needs_numbers() -> None:
    """Element tests have no coordinates; bounds know a cohesion that varies, of the body that was
    given.
    """
    with pytest.raises(ValueError, match="E and c of Tresca vary with the coordinates"):
        sc.element_test(clay(), -100.0, sc.laboratory.triaxial(-0.01))
    with pytest.raises(
        ValueError, match=r"Tresca varies with the coordinates in c: reduce material\.at\(x\)"
    ):
        clay().reduced(2.0)
    forms, fixed = cut(2, sc.MohrCoulomb(E=1e4, nu=0.3, c=1.0, phi=lambda x: 20.0 - x[1]))
    with pytest.raises(
        ValueError, match=r"friction or tensile strength of 'ground\.all' vary within elements"
    ):
        sc.Model(forms, fixed).bounds()
    forms, fixed = cut(2)
    forms["ground"] = forms["ground"].reduced(1.1, "given", ["all"])
    with pytest.raises(ValueError, match="known at integration points alone"):
        sc.Model(forms, fixed).bounds()
    forms, fixed = cut(2, clay(E=1e3, c=lambda x: -0.02 - x[1]))
    with pytest.raises(ValueError, match=r"cohesion must not be negative, got -0.02 at \(.*, 0\)"):
        sc.Model(forms, fixed).bounds()
