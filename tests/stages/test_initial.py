"""Initial states: K0 procedure, given stresses, gravity, reset of displacements, pre-stressed
contact.
"""

from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np
import pytest
from skfem import (
    Basis,
    ElementQuad1,
    ElementTriP2,
    ElementVector,
    FacetBasis,
    LinearForm,
    MeshHex,
    MeshQuad,
    MeshTri,
)

import skfem_contact as sc
from tests.contact.test_overlaps import annulus
from tests.tools.helpers import grid, vector_basis

QUIET = {"progress": False}
SOIL = sc.MohrCoulomb(E=1e4, nu=0.3, c=2.0, phi=30.0)


def smooth_sides(basis) -> np.ndarray:
    return np.concatenate(
        (basis.get_dofs("bottom").all(), basis.get_dofs({"left", "right"}).all("u^1"))
    )


def layered(element: str = "Q1", material=SOIL):
    """Two layers, 4 x 6, the upper one 2 m thick."""
    tags = {"lower": lambda x: x[1] < 4, "upper": lambda x: x[1] > 4}
    mesh = grid(element, np.linspace(0, 4, 5), np.linspace(0, 6, 7)).with_subdomains(tags)
    basis = vector_basis(mesh, element, intorder=2 if element == "Q1" else 4)
    return (
        basis,
        {"ground": sc.SolidForm(basis, {"lower": material, "upper": material})},
        smooth_sides(basis),
    )


@pytest.mark.parametrize("element", ["P1", "Q1", "P2", "Q2", "QuadS2"])
def test_k0_procedure(element):
    """[X] Case K2: layers of different weight and K0, surcharge: the null step moves nothing."""
    basis, forms, fixed = layered(element)
    gamma, K0 = {"lower": 20.0, "upper": 16.0}, {"lower": 0.5, "upper": 0.7}
    top = basis.mesh.boundaries["top"]
    surcharge = LinearForm(lambda v, w: -10.0 * v[1]).assemble(
        FacetBasis(basis.mesh, basis.elem, facets=top)
    )
    load = sc.weight(basis, gamma) + surcharge
    start = sc.Model(forms, fixed).k0_state(load, unit_weights=gamma, K0=K0, surcharge=10.0)
    stress = start[0].states["ground"].stress
    y = np.asarray(forms["ground"].basis.global_coordinates())[1]
    vertical = -10 - np.where(y > 4, 16 * (6 - y), 32 + 20 * (4 - y))
    np.testing.assert_allclose(stress[1], vertical, rtol=1e-12)
    np.testing.assert_allclose(stress[0], np.where(y > 4, 0.7, 0.5) * vertical, rtol=1e-12)
    null = sc.Model(forms, fixed).run([sc.Stage("null", load)], start=start, **QUIET)["null"]
    assert start[0].residual < 1e-12 and null.iterations == (0,) and not null.x.any()
    assert start[0].summary == {"ground": ""}


def test_k0_procedure_in_space():
    """[X] The weight above counts along the last axis, whatever the width of the ground."""
    lengths = np.linspace(0, 1, 2), np.linspace(0, 9, 4), np.linspace(0, 6, 4)
    tags = {"lower": lambda x: x[2] < 4, "upper": lambda x: x[2] > 4}
    basis = vector_basis(MeshHex.init_tensor(*lengths).with_defaults().with_subdomains(tags), "Q1")
    gamma = {"lower": 20.0, "upper": 16.0}
    forms = {"ground": sc.SolidForm(basis, {"lower": SOIL, "upper": SOIL})}
    model = sc.Model(forms, sc.box_supports(basis))
    start = model.k0_state(sc.weight(basis, gamma), unit_weights=gamma, K0=0.5)[0]
    z = np.asarray(basis.global_coordinates())[2]
    vertical = -np.where(z > 4, 16 * (6 - z), 32 + 20 * (4 - z))
    stress = start.states["ground"].stress
    np.testing.assert_allclose(stress[2], vertical, rtol=1e-12)
    np.testing.assert_allclose(stress[:2], np.array([0.5 * vertical] * 2), rtol=1e-12)
    assert start.residual < 1e-12


@pytest.mark.parametrize("K0", [0.02, 0.5])
def test_elastic_ground_has_any_k0_below_one(K0):
    """[X] Level ground under its weight."""
    basis = vector_basis(grid("Q1", np.linspace(0, 2, 3), np.linspace(0, 2, 3)), "Q1", intorder=2)
    ground = sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3))
    model = sc.Model({"ground": ground}, sc.box_supports(basis, base="rollers"))
    stress = model.gravity_state(sc.weight(basis, 20.0), K0=K0)[0].states["ground"].stress
    np.testing.assert_allclose(stress[0], K0 * stress[1], rtol=1e-9)


def test_k0_state_of_a_body_without_one_of_the_weights():
    """[X] Two bodies share a table of weights by subdomain, of which one body holds a single
    one.
    """
    basis, _, fixed = layered()
    mesh = basis.mesh.with_subdomains(
        {
            "left": lambda x: x[0] < 3,
            "above": lambda x: (x[0] > 3) & (x[1] > 4),
            "below": lambda x: (x[0] > 3) & (x[1] < 4),
        }
    )
    basis, weights = vector_basis(mesh, "Q1", intorder=2), {"lower": 20.0, "upper": 16.0}
    forms = {
        name: sc.SolidForm(basis.with_elements(name), SOIL, unit_weight=weights)
        for name in ("left", "above", "below")
    }
    start = sc.Model(forms, fixed).k0_state(K0=0.5)
    y = np.asarray(forms["below"].basis.global_coordinates())[1]
    np.testing.assert_allclose(
        start[0].states["below"].stress[1], -32 - 20 * (4 - y), rtol=1e-12
    )  # round-off


def test_inconsistent_k0_returns_to_the_yield_surface():
    """[X] Case K2: K0 below the active ratio cannot be borne; the points are reported as
    yielded.
    """
    soil = sc.MohrCoulomb(E=1e4, nu=0.3, c=0.0, phi=30.0)
    basis, forms, fixed = layered(material=soil)
    load = sc.weight(basis, 20.0)
    with pytest.warns(
        sc.AnalysisWarning,
        match=r"initial stresses are out of balance by 0\.\d+ of the load, most at",
    ):
        start = sc.Model(forms, fixed).k0_state(load, unit_weights=20.0, K0=0.2)
    assert start[0].summary["ground"] == "100.0% yielded"
    null = sc.Model(forms, fixed).run([sc.Stage("null", load)], start=start, **QUIET)["null"]
    stress = null.states["ground"].stress
    y = np.asarray(forms["ground"].basis.global_coordinates())[1]
    np.testing.assert_allclose(stress[1].mean(axis=1), -20 * (6 - y).mean(axis=1), rtol=1e-6)
    # the first return leaves some points a little inside the yield surface, none outside
    assert (stress[0] / stress[1]).min() > 1 / 3 - 1e-9 and (stress[0] / stress[1]).max() < 0.37


def test_k0_with_groundwater():
    """[X] Effective stresses below a water table 2 m under the surface: submerged weight, K0 of the
    effective.
    """
    basis, forms, fixed = layered()
    gamma, water = {"lower": 20.0, "upper": 17.0}, sc.hydrostatic(4.0, unit_weight=10.0)
    load = sc.weight(basis, gamma) + sc.water_load(basis, water)
    start = sc.Model(forms, fixed).k0_state(load, unit_weights=gamma, K0=0.5, water=water)
    stress = start[0].states["ground"].stress
    y = np.asarray(forms["ground"].basis.global_coordinates())[1]
    np.testing.assert_allclose(
        stress[1], -np.where(y > 4, 17 * (6 - y), 34 + 10 * (4 - y)), rtol=1e-12
    )
    np.testing.assert_allclose(stress[0], 0.5 * stress[1], rtol=1e-12)
    assert start[0].residual < 1e-12


@pytest.mark.parametrize(
    ("mesh", "element"), [(MeshTri, ElementTriP2()), (MeshQuad, ElementQuad1())]
)
def test_k0_with_pressures_at_vertices(mesh, element):
    """[X] Water that rises through ground 6 m deep by 0.5 a metre leaves gamma - 1.5 times its unit
    weight.
    """
    mesh = mesh.init_tensor(np.linspace(0, 4, 5), np.linspace(0, 6, 7)).with_defaults()
    basis = Basis(mesh, ElementVector(element), intorder=2)
    form = sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3), unit_weight=20.0)
    model = sc.Model({"ground": form}, sc.box_supports(basis))
    flow = sc.water.Flow(basis, 1e-5, unit_weight=10.0).steady(
        sc.water.Conditions(head={"top": 6.0, "bottom": 9.0})
    )
    start = model.k0_state(K0=0.5, water=flow.pressure)
    depth, stress = (
        6.0 - np.asarray(basis.global_coordinates())[1],
        start["initial"].states["ground"].stress,
    )
    np.testing.assert_allclose(stress[1], -5.0 * depth, rtol=1e-9)
    np.testing.assert_allclose(stress[0], -2.5 * depth, rtol=1e-9)
    assert start["initial"].residual < 1e-12
    with pytest.raises(ValueError, match="or pressures at the vertices"):
        model.k0_state(K0=0.5, water=flow)


def test_ground_under_water():
    """[X] 3 m of water on the surface: the same effective stresses as at the water's edge."""
    basis, forms, fixed = layered()
    deep, edge = sc.hydrostatic(9.0, unit_weight=10.0), sc.hydrostatic(6.0, unit_weight=10.0)
    stages = [
        sc.Stage("edge", sc.weight(basis, 20.0) + sc.water_load(basis, edge, "top")),
        sc.Stage("deep", sc.weight(basis, 20.0) + sc.water_load(basis, deep, "top")),
    ]
    result = sc.Model(forms, fixed).run(stages, **QUIET)
    np.testing.assert_allclose(result["deep"].x, result["edge"].x, atol=1e-12)
    with pytest.warns(
        sc.AnalysisWarning,
        match=r"water above the surface at \(.*, 6\) without pressure on it.*top",
    ):
        sc.water_load(basis, deep)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        sc.water_load(basis, sc.hydrostatic(5.9, unit_weight=9.81))


def test_k0_state_under_water():
    """[X] The weight of a lake is a part of the surcharge: its pressure is told where less presses
    on the surface.
    """
    basis, _, fixed = layered()
    model = sc.Model(
        {"ground": sc.SolidForm(basis, SOIL, unit_weight=20.0)}, fixed, water_unit_weight=10.0
    )
    for water in (8.0, sc.hydrostatic([(0, 6), (4, 8)], unit_weight=10.0)):
        with pytest.raises(
            ValueError,
            match=r"presses with 20 on the surface at \(.*, 6\), .* surcharge=20 and what",
        ):
            model.k0_state(K0=0.5, water=water, surcharge=5.0)
    start = model.k0_state(K0=0.5, water=8.0, surcharge=20.0)[0]
    y = np.asarray(model.forms["ground"].basis.global_coordinates())[1]
    np.testing.assert_allclose(start.states["ground"].stress[1], -10.0 * (6 - y), rtol=1e-12)
    assert start.residual < 1e-12
    with pytest.raises(ValueError, match="the pressure must be finite"):
        model.k0_state(K0=0.5, water=lambda x: None)
    # no water is not a level of zero
    assert model.k0_state(K0=0.5, water=False)[0].residual < 1e-12


def test_water_by_values_at_nodes():
    """[X] A linear pressure given at the nodes is the hydrostatic one, also with quadratic
    elements.
    """
    for element in ("P1", "Q1", "P2", "Q2"):
        basis, *_ = layered(element)
        field = 10.0 * (6.0 - basis.mesh.p[1, : basis.mesh.nvertices])
        a = sc.water_load(basis, field, ["left", "top"])
        b = sc.water_load(basis, sc.hydrostatic(6.0, unit_weight=10.0), ["left", "top"])
        np.testing.assert_allclose(a, b, atol=1e-12 * np.abs(b).max())
    with pytest.raises(ValueError, match="the pressure has shape"):
        sc.water_load(basis, field[:-1])
    with pytest.raises(ValueError, match="there is no boundary 'lake'"):
        sc.water_load(basis, field, "lake")


@pytest.mark.parametrize("table", [[[0, 1], [0, 2]], [1, 2], np.nan, [[0, np.inf]]])
def test_bad_water_table(table):
    with pytest.raises(
        ValueError, match=r"a water table is a height, or points|table must be finite numbers"
    ):
        sc.hydrostatic(table, unit_weight=9.81)


def test_upright_gravity_is_demanded():
    """[X] The weight above a point would count along the last axis; gravity that acts along x gives
    the stress 20 times the distance from the free end.
    """
    mesh = MeshQuad.init_tensor(np.linspace(0, 4, 5), np.linspace(0, 1, 2)).with_defaults()
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    soil = sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.0), unit_weight=20.0)
    fixed = [basis.get_dofs("left").all("u^1"), basis.get_dofs(["bottom", "top"]).all("u^2")]
    model = sc.Model({"soil": soil}, fixed, gravity=(-1.0, 0.0))
    with pytest.raises(ValueError, match=r"K0 procedure needs gravity against .* \[-1.0, 0.0\]"):
        model.k0_state(K0=0.5)
    stress = model.gravity_state(K0=0.5)["initial"].states["soil"].stress
    distance = 4.0 - basis.global_coordinates()[0].mean(axis=1)
    np.testing.assert_allclose(stress[0].mean(axis=1), -20.0 * distance, atol=1e-9)


def test_level_ground_is_demanded():
    """Different weights side by side: the heights and the weights are named; elements without K0
    too.
    """
    basis = layered()[0]
    mesh = basis.mesh.with_subdomains({"wall": lambda x: x[0] > 3, "soil": lambda x: x[0] < 3})
    basis = vector_basis(mesh, "Q1", intorder=2)
    forms = {"all": sc.SolidForm(basis, SOIL)}
    fixed = smooth_sides(basis)
    with pytest.raises(ValueError, match=r"not level: from height 0 to 6 .*'wall': 25.*'soil': 20"):
        sc.Model(forms, fixed).k0_state(
            basis.zeros(), unit_weights={"wall": 25.0, "soil": 20.0}, K0=0.5
        )
    with pytest.raises(
        ValueError, match=r"6 elements have no K0; they lie in the subdomains \[.*'wall'.*\]"
    ):
        sc.Model(forms, fixed).k0_state(basis.zeros(), unit_weights=20.0, K0={"soil": 0.5})
    with pytest.raises(ValueError, match="there is no subdomain 'clay'"):
        sc.Model(forms, fixed).k0_state(basis.zeros(), unit_weights=20.0, K0={"clay": 0.5})
    with pytest.raises(ValueError, match="K0 must be a number, not negative, unlike"):
        sc.Model(forms, fixed).k0_state(basis.zeros(), unit_weights=20.0, K0=-0.5)
    with pytest.raises(ValueError, match="the stress of 'all' must be finite and of shape"):
        sc.Model(forms, fixed).initial_state(
            basis.zeros(), stress=lambda x: np.zeros((3, *x.shape[1:]))
        )


def test_ground_before_the_fill():
    """[X] The fill is not there at first: nothing moves, and no weight of it counts; its later
    weight is carried.
    """
    basis, _, fixed = layered()
    forms = {
        name: sc.SolidForm(basis.with_elements(name), sc.LinearElastic(E=1e4, nu=0.3))
        for name in ("lower", "upper")
    }
    first = {"lower": forms["lower"]}
    load = sc.weight(basis, {"lower": 20.0})
    for start in (
        sc.Model(first, fixed).k0_state(load, unit_weights=20.0, K0=3 / 7),
        sc.Model(first, fixed).gravity_state(load),
    ):
        assert start[0].residual < 1e-12 and not start[0].x.any()
        y = np.asarray(forms["lower"].basis.global_coordinates())[1]
        np.testing.assert_allclose(
            start[0].states["lower"].stress[1].mean(axis=1), -20 * (4 - y.mean(axis=1))
        )
        fill = sc.Stage("fill", sc.weight(basis, {"lower": 20.0, "upper": 16.0}), activate="upper")
        filled = sc.Model(forms, fixed).run([fill], start=start, **QUIET)["fill"]
        # the surface of the lower layer settles by that of 32 over its oedometric modulus
        surface = basis.nodal_dofs[1, basis.mesh.p[1] == 4]
        np.testing.assert_allclose(filled.x[surface], -32 * 4 / 1.346153846e4, rtol=1e-9)
    with pytest.raises(
        ValueError, match=r"load acts on inactive bodies; the solids are \['lower'\]"
    ):
        sc.Model(first, fixed).gravity_state(sc.weight(basis, 20.0))


def test_contact_with_a_body_that_is_not_there_at_first():
    basis, forms, fixed = pile(2)
    ground = sc.SolidForm(basis.with_elements("soil"), SOIL)
    with pytest.raises(ValueError, match=r"'skin': boundary 'pile|soil' belongs to no solid"):
        sc.Model({"ground": ground, "skin": forms["skin"]}, fixed).gravity_state(
            sc.weight(basis, {"soil": 20.0})
        )


def test_given_state_out_of_balance_finds_equilibrium():
    """[X] A field without equilibrium is warned of; the null step ends where gravity alone
    would.
    """
    elastic = sc.LinearElastic(E=1e4, nu=0.3)
    basis, forms, fixed = layered("Q2", elastic)
    load = sc.weight(basis, 20.0)
    with pytest.warns(sc.AnalysisWarning, match="out of balance by 1 of the load"):
        start = sc.Model(forms, fixed).initial_state(
            load, stress=lambda x: np.zeros((4, *x.shape[1:]))
        )
    result = sc.Model(forms, fixed).run([sc.Stage("null", load)], start=start, **QUIET)
    gravity = sc.Model(forms, fixed).run([sc.Stage("gravity", load)], **QUIET)
    np.testing.assert_allclose(result["null"].x, gravity["gravity"].x, atol=1e-14)


def slope():
    """A slope of 1 in 2 under its own weight."""
    x, y = np.linspace(0, 1, 13), np.linspace(0, 1, 5)
    mesh = grid("Q2", x, y)
    p = mesh.p
    mesh = mesh.__class__(
        np.stack((12 * p[0], p[1] * (6 - 3 * np.clip((12 * p[0] - 3) / 6, 0, 1)))), mesh.t
    )
    basis = vector_basis(mesh.with_defaults(), "Q2")
    left = basis.nodal_dofs[0, basis.mesh.p[0] < 1e-9]
    low = basis.get_dofs(lambda x: x[1] < 1e-9).all()
    sides = basis.get_dofs(lambda x: (x[0] < 1e-9) | (x[0] > 12 - 1e-9)).all("u^1")
    return basis, np.unique(np.concatenate((left, low, sides)))


@pytest.mark.parametrize("K0", [None, 0.6, {"all": 0.6}])
def test_gravity_in_sloping_ground(K0):
    """[X] No displacements, equilibrium, and admissible stresses; far from the slope the ratio is
    K0.
    """
    basis, fixed = slope()
    soil = sc.MohrCoulomb(E=1e4, nu=0.3, c=5.0, phi=30.0)
    forms = {"ground": sc.SolidForm(basis, soil)}
    load = sc.weight(basis, 20.0)
    start = sc.Model(forms, fixed).gravity_state(load, K0=K0, increments=2)
    assert len(start) == 1 and not start[0].x.any() and start[0].residual < 1e-8
    null = sc.Model(forms, fixed).run([sc.Stage("null", load)], start=start, **QUIET)["null"]
    assert null.iterations == (0,) and not null.x.any()
    stress = null.states["ground"].stress
    x, y = np.asarray(forms["ground"].basis.global_coordinates())
    far = (x < 1.0) & (y < 0.3)
    np.testing.assert_allclose(
        (stress[0] / stress[1])[far], 3 / 7 if K0 is None else 0.6, atol=0.01
    )
    shear = np.hypot((stress[0] - stress[1]) / 2, stress[3])
    mean = (stress[0] + stress[1]) / 2
    assert (shear + mean * 0.5 - 5 * np.cos(np.pi / 6)).max() < 1e-6
    with pytest.raises(ValueError, match="K0 must lie between 0 and 1"):
        sc.Model(forms, fixed).gravity_state(load, K0=1.2)


def pile(quadrature, element="Q1", strain="full", law=None, **options):
    """Ground with a pile that is meshed apart."""
    x, y = np.array([0, 1, 2, 2.5, 3, 3.5, 4.5, 5.5]), np.linspace(0, 6, 13)
    inside = {"pile": lambda p: (abs(p[0] - 2.75) < 0.25) & (p[1] > 2)}
    mesh = grid(element, x, y).with_subdomains({**inside, "soil": lambda p: ~inside["pile"](p)})
    mesh = sc.join_bodies(mesh, bodies={"soil": "soil", "pile": "pile"})
    basis = vector_basis(mesh, element, intorder=2 if element == "Q1" else 4)
    forms = {
        "ground": sc.SolidForm(
            basis, {"soil": SOIL, "pile": sc.LinearElastic(E=3e7, nu=0.2)}, strain
        ),
        "skin": sc.ContactPair(
            basis, "soil|pile", "pile|soil", law or sc.Coulomb(mu=0.5), quadrature, **options
        ),
    }
    return basis, forms, smooth_sides(basis)


@pytest.mark.parametrize("quadrature", [2, "segments"])
@pytest.mark.parametrize("element", ["Q1", "P2", "Q2"])
@pytest.mark.parametrize("law", [sc.Coulomb(mu=0.5), sc.Tied()])
def test_wished_in_place_pile(quadrature, element, law):
    """[X] Case J10: contact carries K0 gamma z on the vertical faces from the start, and nothing
    moves.
    """
    basis, forms, fixed = pile(quadrature, element, law=law)
    load = sc.weight(basis, 20.0)
    start = sc.Model(forms, fixed).k0_state(load, unit_weights=20.0, K0=0.5)
    result = sc.Model(forms, fixed).run([sc.Stage("null", load)], start=start, **QUIET)
    assert start[0].residual < 1e-12
    assert np.abs(result["null"].x).max() < 1e-10
    skin = result["null"].tractions("skin")
    face = skin.y > 2 + 1e-9
    np.testing.assert_allclose(skin.pressure[face], 10 * (6 - skin.y[face]), atol=1e-9)
    np.testing.assert_allclose(skin.pressure[~face], 20 * 4, atol=1e-9)
    np.testing.assert_allclose(skin.shear, 0, atol=1e-9)


def test_wished_in_place_pile_augmented():
    """[X] Case J10 with multipliers: they take the tractions over; what moves is their tolerance of
    1e-4.
    """
    basis, forms, fixed = pile(2, "Q2", enforcement=sc.AugmentedLagrangian())
    load = sc.weight(basis, 20.0)
    start = sc.Model(forms, fixed).k0_state(load, unit_weights=20.0, K0=0.5)
    result = sc.Model(forms, fixed).run([sc.Stage("null", load)], start=start, **QUIET)
    assert start[0].residual < 1e-12
    settlement = 20 * 36 / (2 * 1.35e4)
    assert np.abs(result["null"].x).max() < 1e-4 * settlement


def test_wished_in_place_pile_below_the_water_table():
    """[X] Contact carries the effective pressure if the pile has the ground's pores at first; else
    the place is named.

    Then the pile has its own: it is pressed by the water on its skin alone, and shortens by that
    over its modulus.
    """
    basis, forms, fixed = pile(2, "P2")
    water, skin = sc.hydrostatic(6.0, unit_weight=10.0), ["soil|pile", "pile|soil"]
    porous, own = (
        sc.weight(basis, 20.0) + sc.water_load(part, water, skin)
        for part in (basis, basis.with_elements("soil"))
    )
    start = sc.Model(forms, fixed).k0_state(porous, unit_weights=20.0, K0=0.5, water=water)
    assert start[0].residual < 1e-12
    pressure = start[0].tractions("skin")
    face = pressure.y > 2 + 1e-9
    np.testing.assert_allclose(pressure.pressure[face], 5 * (6 - pressure.y[face]), atol=1e-9)
    dry = sc.Model(forms, fixed).run([sc.Stage("dry", own)], start=start, **QUIET)["dry"]
    assert np.abs(dry.x).max() < 40 / 3e7 * 4  # pressure at the foot over E, times the length
    with pytest.warns(
        sc.AnalysisWarning,
        match=r"out of balance by .* most at \(.*\) of \['ground', 'skin'\]: begin",
    ):
        sc.Model(forms, fixed).k0_state(own, unit_weights=20.0, K0=0.5, water=water)


def test_gravity_with_k0_and_contact():
    """[X] The contact has one penalty in elastic ground and in the ground's own material, which
    carries K0 gamma z.

    Far from the pile, which is ten thousand times as stiff as the ground, but as heavy.
    """
    basis, forms, fixed = pile(2)
    load = sc.weight(basis, 20.0)
    start = sc.Model(forms, fixed).gravity_state(load, K0={"soil": 0.6})
    null = sc.Model(forms, fixed).run([sc.Stage("null", load)], start=start, **QUIET)["null"]
    solid = forms["ground"]
    x = np.asarray(solid.basis.global_coordinates())
    far = (x[0] < 1) & (x[1] < 1)
    ratio = null.states["ground"].stress[0] / null.states["ground"].stress[1]
    assert np.abs(ratio[far] - 0.6).max() < 0.1
    assert start[0].residual <= 1e-8


@pytest.mark.parametrize("quadrature", ["nodal", 2, "segments"])
def test_gravity_balances_where_the_bodies_are_back(quadrature):
    """[X] Contact has followed a pile that sinks: forces that are assembled at rest balance."""
    basis, forms, fixed = pile(quadrature)
    load = sc.weight(basis, {"soil": 20.0, "pile": 25.0})
    stage = sc.Model(forms, fixed).gravity_state(load)[0]
    left = load - sum(
        form.assemble(stage.x, stage.states[name]).force for name, form in stage.forms.items()
    )
    left[fixed] = 0.0
    assert not stage.x.any()
    # of what a warning is given; without the way back it is 1e-4
    assert np.linalg.norm(left) < 1e-6 * np.linalg.norm(load) and stage.residual < 1e-6


def test_pile_tied_under_gravity_then_free():
    """[X] Case J10 as it is done without K0: gravity with the tie, reset, then friction in its
    place.
    """
    basis, forms, fixed = pile(2, law=sc.Tied())
    # a weightless pile in ground without weight beside it: the tie carries the ground's settlement
    load = sc.weight(basis, {"soil": 20.0})
    start = sc.Model({**forms}, fixed).gravity_state(load)
    before = start[0].states["skin"]
    change = {"skin": forms["skin"].with_law(sc.Coulomb(mu=0.5, adhesion=1e3, tension=1e3))}
    result = sc.Model(forms, fixed).run(
        [sc.Stage("free", load, change=change)], start=start, **QUIET
    )["free"]
    # Newton's tolerance of 1e-8 of the load, in displacements
    assert not start[0].x.any() and np.abs(result.x).max() < 1e-9
    np.testing.assert_allclose(result.states["skin"].traction[0], before.traction[0], atol=1e-3)


@pytest.mark.parametrize("quadrature", ["nodal", 2, "segments"])
def test_reset_keeps_what_contact_carries(quadrature):
    """[X] After the reset the same load needs no displacement, and unloading is undone to minus the
    first one.
    """
    basis, forms, fixed = pile(quadrature)
    forms["ground"] = forms["ground"].with_materials({"soil": sc.LinearElastic(E=1e4, nu=0.3)})
    load = sc.weight(basis, {"soil": 20.0, "pile": 25.0})
    first = sc.Model(forms, fixed).run([sc.Stage("gravity", load)], **QUIET)
    start = first.reset()
    assert first["gravity"].x.any() and not start["gravity"].x.any()
    again = sc.Model(forms, fixed).run([sc.Stage("same", load)], start=start, **QUIET)["same"]
    # the contact's frame turns back with the bodies: second order in the displacements
    small = np.abs(first["gravity"].x).max() ** 2
    assert np.abs(again.x).max() < small
    pressed, before = (
        forms["skin"].points(r.states["skin"]).weight @ r.states["skin"].traction[0]
        for r in (again, first["gravity"])
    )
    # the nodal rule has one normal in the corners of the tip, and another one after the reset
    assert pressed == pytest.approx(before, rel=0.05 if quadrature == "nodal" else 0.001)


def test_axisymmetric_operator():
    """[X] A homogeneous field u = (a r, b z): strains exact at all points, work the volume per
    radian.
    """
    for element in ("P1", "Q1", "P2", "Q2"):
        basis = vector_basis(
            grid(element, np.linspace(0, 2, 4), np.linspace(0, 1, 3)), element, intorder=4
        )
        form = sc.SolidForm(basis, sc.LinearElastic(E=100.0, nu=0.2), coordinates="axisymmetric")
        x = np.where(np.arange(basis.N) % 2 == 0, 0.03 * basis.doflocs[0], -0.01 * basis.doflocs[1])
        out = form.assemble(x, form.initial_state())
        expected = np.array([0.03, -0.01, 0.03, 0.0])
        np.testing.assert_allclose(
            out.state.strain,
            np.broadcast_to(expected[:, None, None], out.state.strain.shape),
            atol=1e-14,
        )
        stress = form.regions[0].material.elasticity(4) @ expected
        assert x @ out.force == pytest.approx(
            stress @ expected * 2.0, rel=1e-12
        )  # r^2 / 2 times the height
        assert sc.weight(form, 20.0).sum() == pytest.approx(-20.0 * 2.0)
    with pytest.raises(ValueError, match="axial symmetry needs x >= 0"):
        basis = vector_basis(grid("Q1", np.linspace(-1, 1, 3), np.linspace(0, 1, 3)), "Q1")
        sc.SolidForm(basis, sc.LinearElastic(E=1.0, nu=0.0), coordinates="axisymmetric")


def test_k0_beyond_the_passive_ratio_is_told():
    """[X] Kp = 3 at 30 degrees: K0 = 5 cannot be borne, K0 = 2.9 can."""
    basis = vector_basis(grid("Q1", np.linspace(0, 6, 7), np.linspace(0, 4, 9)), "Q1", intorder=2)
    sand = sc.MohrCoulomb(E=3e4, nu=0.3, c=0.1, phi=30.0, psi=5.0)
    form = sc.SolidForm(basis, sand, unit_weight=20.0)
    model = sc.Model({"ground": form}, sc.box_supports(basis))
    with pytest.warns(sc.AnalysisWarning, match=r"'ground' are beyond its strength at 100% of"):
        start = model.k0_state(K0=5.0)
    stress = start["initial"].states["ground"].stress
    assert np.median(stress[0] / stress[1]) == pytest.approx(3.0, rel=0.01)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        start = model.k0_state(K0=2.9)
    stress = start["initial"].states["ground"].stress
    np.testing.assert_allclose(stress[0], 2.9 * stress[1], rtol=1e-9)


@pytest.mark.parametrize("enforcement", [None, sc.AugmentedLagrangian()], ids=["penalty", "aug."])
@pytest.mark.parametrize(
    ("inner", "outer", "left"), [(32, 32, 1e-8), (32, 40, 5e-4), (40, 32, 5e-4)]
)
def test_given_stresses_round_a_pipe(inner: int, outer: int, left: float, enforcement) -> None:
    """[X] Tractions are those of the stresses, n . sigma . n, and not of coordinates of 9 digits.

    The chords of 32 and 40 facets enclose areas that differ by .2 %: this weight remains.
    """
    rings = {"pipe": annulus(0.5, 1.0, inner, 3), "ground": annulus(1.0, 3.0, outer, 6)}
    rounded = {name: replace(m, doflocs=np.round(m.p, 9)) for name, m in rings.items()}
    basis = vector_basis(sc.join_bodies(rounded), "Q2", intorder=4)
    bodies = sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3), unit_weight=20.0)
    joint = sc.ContactPair(
        basis,
        "pipe:outer",
        "ground:inner",
        sc.Coulomb(mu=0.5),
        "segments",
        initial="adjusted",
        enforcement=enforcement,
    )
    held = basis.get_dofs({"pipe:inner", "ground:outer"})
    model = sc.Model({"bodies": bodies, "joint": joint}, held)

    def stress(x: np.ndarray) -> np.ndarray:
        vertical = -20.0 * (5.0 - x[1])
        return np.stack((0.5 * vertical, vertical, 0.5 * vertical, 0.0 * vertical))

    with warnings.catch_warnings():
        warnings.simplefilter("error" if inner == outer else "ignore")
        start = model.initial_state(stress=stress)["initial"]
    assert start.residual < left
    found = start.tractions("joint")
    sector = np.pi / inner  # half of the angle of a facet, whose normal shows to its middle
    angle = sector * (2 * np.floor(np.arctan2(found.y, found.x) / (2 * sector)) + 1)
    right = 20.0 * (5.0 - found.y) * (0.5 * np.cos(angle) ** 2 + np.sin(angle) ** 2)
    error = np.abs(found.pressure - right).max() / right.max()
    # normals of unmatched facets differ by up to 10 degrees, the pressure by half the sine of twice
    assert error < (1e-6 if inner == outer else 0.09)
