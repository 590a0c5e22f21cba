"""Undrained ground: Skempton's pore pressure, undrained strengths, a short-term factor of
safety.
"""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from skfem import (
    Basis,
    ElementTetP2,
    ElementTriP2,
    ElementVector,
    FacetBasis,
    LinearForm,
    MeshTet,
    MeshTri,
)

import skfem_contact as sc
from skfem_contact.results import StageResult
from skfem_contact.results.strength import (
    PointStatus,
    mobilised,
    plastic_strain,
    point_status,
    pore_pressure,
    undrained_strength,
)
from tests.tools.helpers import grid, vector_basis
from tests.tools.slope_meshes import held, slope_mesh

E, NU, P0 = 1e4, 0.25, 100.0
BULK = E / 3 / (1 - 2 * NU)
SOIL = sc.MohrCoulomb(E=E, nu=NU, c=5.0, phi=25.0, psi=0.0)


def compressed(soil, axisymmetric: bool, steps: tuple[float, ...]):
    """A sample under an isotropic effective stress, compressed while its side is pressed: p and q
    after steps.
    """
    mesh = grid("Q1", [0.0, 1.0], [0.0, 1.0])
    basis = vector_basis(mesh, "Q1", intorder=2)
    form = sc.SolidForm(basis, soil, coordinates="axisymmetric" if axisymmetric else "plane")
    fixed = np.union1d(
        basis.get_dofs({"bottom", "top"}).all("u^2"), basis.get_dofs("left").all("u^1")
    )
    side = FacetBasis(mesh, basis.elem, facets="right")
    load = LinearForm(lambda v, w: -P0 * (w.x[0] if axisymmetric else 1.0) * v[0]).assemble(side)
    with warnings.catch_warnings():
        warnings.simplefilter(
            "ignore", sc.AnalysisWarning
        )  # the top holds the stress: no load of the start does
        isotropic = lambda x: np.stack(3 * [0 * x[0] - P0] + [0 * x[0]])  # noqa: E731
        start = sc.Model({"soil": form}, fixed).initial_state(load, stress=isotropic)
    stages = []
    for k, settlement in enumerate(steps):
        moved = basis.zeros()
        moved[basis.get_dofs("top").all("u^2")] = -settlement
        stages.append(sc.Stage(f"{k}", load, prescribed=moved))
    result = sc.Model({"soil": form}, fixed).run(stages, start=start, progress=False)
    states = [result[stage.name].states["soil"] for stage in stages]
    return [(pore_pressure(form, s).mean(), (s.stress[0] - s.stress[1]).mean()) for s in states]


@pytest.mark.parametrize(
    ("axisymmetric", "share"), [(False, 1 / 2), (True, 1 / 3)], ids=["plane", "triaxial"]
)
@pytest.mark.parametrize(
    "soil", [sc.LinearElastic(E=E, nu=NU), SOIL], ids=["elastic", "Mohr-Coulomb"]
)
def test_skempton(soil, axisymmetric, share):
    """[X] Pore pressure of an elastic sample under a deviator q: B q / 2 in plane strain, B q / 3
    in the triaxial test.

    Of the finite modulus of the water, 1000 K, comes an error of about a thousandth.
    """
    ((pressure, q),) = compressed(
        sc.Undrained(soil, bulk_modulus_water=1e3 * BULK), axisymmetric, (1e-3,)
    )
    assert q > 0
    assert pressure / q == pytest.approx(share, rel=1.5e-3)


def test_skempton_for_compressible_water():
    """[X] Skempton's B = 1 / (1 + K / Kw), A = 1/3: exact for any water."""
    ((pressure, q),) = compressed(sc.Undrained(SOIL, bulk_modulus_water=BULK), True, (1e-3,))
    assert pressure / q == pytest.approx(0.5 / 3, rel=1e-9)


def test_strengths():
    """[X] 2 s_u = 2 (c cos phi + p0 sin phi) in plane strain, M p0 + q0 in the triaxial test,
    within .06 %.
    """
    clay, s, c = (
        sc.Undrained(SOIL, bulk_modulus_water=1e3 * BULK),
        np.sin(np.radians(25.0)),
        np.cos(np.radians(25.0)),
    )
    exact = {False: 2 * (5.0 * c + P0 * s), True: 6 * s / (3 - s) * P0 + 6 * 5.0 * c / (3 - s)}
    for axisymmetric, q in exact.items():
        assert compressed(clay, axisymmetric, (0.01, 0.02, 0.04))[-1][1] == pytest.approx(
            q, rel=6e-4
        )


def test_poisson_ratio_of_soil_and_water():
    """[X] With nu_u the moduli are those of an elastic body of that Poisson's ratio and the same
    shear modulus.
    """
    clay = sc.Undrained(sc.LinearElastic(E=E, nu=NU), nu_undrained=0.49)
    whole = sc.LinearElastic(E=E / (1 + NU) * 1.49, nu=0.49)
    for ncomp in (4, 6):
        np.testing.assert_allclose(clay.elasticity(ncomp), whole.elasticity(ncomp), rtol=1e-12)


@pytest.mark.parametrize(
    "soil",
    [
        SOIL,
        sc.LinearElastic(E=E, nu=NU),
        sc.Tresca(E=E, nu=NU, c=10.0),
        sc.DruckerPrager(E=E, nu=NU, alpha=0.2, beta=0.0, k=5.0),
    ],
    ids=repr,
)
@pytest.mark.parametrize("ncomp", [4, 6])
def test_any_material(soil, ncomp):
    """The tangent is that of differences and stresses are admissible, for any law and for
    parameters by element.
    """
    sc.testing.check_material(
        sc.Undrained(soil, bulk_modulus_water=20 * BULK), ncomp=ncomp, dissipation=ncomp == 4
    )
    varying = sc.Undrained(soil, bulk_modulus_water=BULK * np.linspace(1, 20, 50))
    sc.testing.check_material(varying, ncomp=ncomp, dissipation=False)


def test_pressure_is_not_taken_for_plastic_strain():
    """An elastic soil has not yielded, whatever the pressure; its pressure lives on where others
    yield.
    """
    mesh = grid("Q1", [0.0, 1.0, 2.0], [0.0, 1.0]).with_subdomains(
        {"a": lambda x: x[0] < 1, "b": lambda x: x[0] > 1}
    )
    basis = vector_basis(mesh, "Q1", intorder=2)
    clay = sc.Undrained(sc.LinearElastic(E=E, nu=NU), bulk_modulus_water=BULK)
    form = sc.SolidForm(basis, {"a": clay, "b": SOIL})
    x = basis.zeros()
    x[basis.get_dofs("top").all("u^2")] = -0.01
    state = form.assemble(x, form.initial_state()).state
    plastic = plastic_strain(form, state)
    assert plastic[0].max() == 0 < plastic[1].min()
    pressure = pore_pressure(form, state)
    assert pressure[0] == pytest.approx(BULK * 0.01) and not pressure[1].any()
    assert "50.0% yielded" in form.outputs(np.zeros(form.size), state).summary
    stage = StageResult("now", x, 0 * x, {"soil": state}, (), 0.0, forms={"soil": form})
    field = stage.field("pore")
    # nodes between both regions get the mean of both
    assert sorted(set(np.round(field / BULK / 0.01, 9))) == [0.0, 0.5, 1.0]
    # what is given is below it; a change since a stage does not hold what stays
    still = sc.hydrostatic(0.5, unit_weight=9.81)
    whole = stage.field("pore", water=still)
    np.testing.assert_allclose(whole, field + still(mesh.p))
    np.testing.assert_allclose(stage.field("pore", since=stage, water=still), 0.0)


def test_mobilised_strength_is_that_of_the_soil():
    """[X] Effective stresses count: with water in its pores the soil uses as much of its strength
    as without.
    """
    form = sc.SolidForm(vector_basis(grid("Q1", [0, 1], [0, 1]), "Q1", intorder=2), SOIL)
    wet = form.with_materials({"all": sc.Undrained(SOIL, bulk_modulus_water=BULK)})
    state, filled = form.initial_state(), wet.initial_state()
    state.stress[:3] = np.array([-10.0, -16.0, -12.0])[:, None, None]
    filled.stress[:3], filled.internal[-1] = state.stress[:3] - 30.0, 30.0
    assert 0 < mobilised(form, state).max() < 1
    np.testing.assert_allclose(mobilised(wet, filled), mobilised(form, state), rtol=1e-12)
    torn = sc.SolidForm(form.basis, sc.Undrained(SOIL, bulk_modulus_water=BULK)).initial_state()
    torn.stress[:3], torn.internal[-1] = 5.0 / np.tan(np.radians(25.0)) - 30.0, 30.0
    assert (point_status(wet, torn) == PointStatus.TENSION).all()


@pytest.mark.parametrize("how", ["change", "start"])
def test_drains_later(how):
    """[X] Ground that was undrained and is not any more loses its excess pressure, and settles as
    drained ground.
    """
    basis = vector_basis(grid("Q1", [0.0, 1.0], np.linspace(0.0, 2.0, 4)), "Q1", intorder=2)
    drained = sc.SolidForm(basis, SOIL, strain="b_bar")
    quick = drained.with_materials({"all": sc.Undrained(SOIL, bulk_modulus_water=1e3 * BULK)})
    fixed = np.append(
        basis.get_dofs("bottom").all("u^2"), basis.get_dofs({"left", "right"}).all("u^1")
    )
    top = FacetBasis(basis.mesh, basis.elem, facets="top")
    load = LinearForm(lambda v, w: -10.0 * v[1]).assemble(top)
    first = sc.Model({"soil": quick}, fixed).run([sc.Stage("quick", load)], progress=False)
    assert first["quick"].pore_pressure("soil").min() > 9.9
    if how == "change":
        stages = [sc.Stage("quick", load), sc.Stage("later", load, change={"soil": drained})]
        later = sc.Model({"soil": quick}, fixed).run(stages, progress=False)["later"]
    else:
        later = sc.Model({"soil": drained}, fixed).run(
            [sc.Stage("later", load)], start=first, progress=False
        )["later"]
    slow = sc.Model({"soil": drained}, fixed).run([sc.Stage("slow", load)], progress=False)["slow"]
    np.testing.assert_allclose(later.x, slow.x, atol=1e-9)
    np.testing.assert_allclose(later.states["soil"].stress, slow.states["soil"].stress, atol=1e-6)


def test_soil_that_drains_has_no_such_pressure():
    """Zero would be taken for the pressure of a consolidating solid, which its nodes have."""
    basis = vector_basis(grid("Q1", [0.0, 1.0], [0.0, 1.0]), "Q1", intorder=2)
    model = sc.Model({"soil": sc.SolidForm(basis, SOIL)}, sc.box_supports(basis))
    stage = model.run([sc.Stage("weight", model.weight(20.0))], progress=False)["weight"]
    with pytest.raises(ValueError, match=r"'soil' has no Undrained soil: field\('pore'\)"):
        stage.pore_pressure("soil")


def test_in_space():
    """[X] A cube of tetrahedra under a quick load between smooth walls: Kw / (Kw + M) of it is
    carried by the water.
    """
    sides = [("bottom", 2, 0), ("x", 0, 0), ("X", 0, 1), ("y", 1, 0), ("Y", 1, 1)]
    mesh = (
        MeshTet()
        .refined(1)
        .with_boundaries(
            {name: lambda x, axis=axis, at=at: np.isclose(x[axis], at) for name, axis, at in sides}
        )
    )
    basis = Basis(mesh, ElementVector(ElementTetP2()), intorder=2)
    form = sc.SolidForm(basis, sc.Undrained(SOIL, bulk_modulus_water=BULK), strain="full")
    names = {"u^1": {"x", "X"}, "u^2": {"y", "Y"}, "u^3": {"bottom"}}
    fixed = np.concatenate([basis.get_dofs(where).all(u) for u, where in names.items()])
    top = FacetBasis(mesh, basis.elem, facets=mesh.facets_satisfying(lambda x: np.isclose(x[2], 1)))
    load = LinearForm(lambda v, w: -1.0 * v[2]).assemble(top)
    state = (
        sc.Model({"soil": form}, fixed)
        .run([sc.Stage("load", load)], progress=False)["load"]
        .states["soil"]
    )
    modulus = E * (1 - NU) / (1 + NU) / (1 - 2 * NU)
    np.testing.assert_allclose(pore_pressure(form, state), BULK / (BULK + modulus), rtol=1e-9)


def test_pressures_and_total_stresses_under_a_strip():
    """[X] Elastic half-plane at constant volume: pressure q/pi times the angle under which the
    strip is seen.

    Half a width and more from the strip's edges, on elements of an eighth to a third of its width,
    fields of order h² are .02 q off, the pressure .019; the boundaries of the model, 40 widths
    away, change .002 q. Single points are more than q off.
    """
    q, x = 10.0, np.r_[np.linspace(0, 2, 17)[:-1], 2 + 38 * np.linspace(0, 1, 15) ** 2.2]
    mesh = MeshTri.init_tensor(x, -40 * (1 - np.linspace(0, 1, 25)) ** 2.6).with_defaults()
    mesh = mesh.with_boundaries({"strip": lambda x: (x[1] > -1e-9) & (x[0] < 1)})
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    clay = sc.SolidForm(basis, sc.Undrained(sc.LinearElastic(E=2 * E, nu=NU), nu_undrained=0.4999))
    model = sc.Model({"clay": clay}, sc.box_supports(basis, base="fixed"))
    stage = model.run([sc.Stage("q", sc.traction(basis, "strip", (0.0, -q)))], progress=False)["q"]
    x, z = basis.doflocs[:, ::2]
    left, right = np.arctan2(x - 1, -z), np.arctan2(x + 1, -z)
    seen, turned = right - left, np.sin(right - left) * np.cos(left + right)
    asked = (abs(x - 1) + abs(z) > 0.6) & (x < 4) & (z > -4)
    exact = {"pore": seen, "mean": -seen, "sxx": turned - seen, "syy": -turned - seen}
    for name, expected in exact.items():
        error = abs(stage.field(name) - q / np.pi * expected)[asked].max()
        assert error < (0.02 if name != "sxx" else 0.027) * q
    assert abs(stage.states["clay"].internal[-1] - stage.pore_pressure("clay")).max() > q


def test_pressure_around_a_cavity():
    """[X] A cavity that widens at constant volume presses no water.

    Of its pressure, 2 G u / a, the first of 40 layers takes 15 %; a tenth of that is left in the
    projection.
    """
    mesh = MeshTri.init_tensor(20.0 ** np.linspace(0, 1, 41), np.array([0.0, 0.2])).with_defaults()
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=4)
    inner, outer = basis.get_dofs("left").all("u^1"), basis.get_dofs("right").all("u^1")
    moved = basis.zeros()
    moved[inner], moved[outer] = 0.02, 0.001
    fixed = np.concatenate((basis.get_dofs({"bottom", "top"}).all("u^2"), inner, outer))
    soil = sc.Undrained(sc.LinearElastic(E=E, nu=NU), nu_undrained=0.4999)
    model = sc.Model({"clay": sc.SolidForm(basis, soil, coordinates="axisymmetric")}, fixed)
    stage = model.run([sc.Stage("in", basis.zeros(), prescribed=moved)], progress=False)["in"]
    assert abs(stage.field("pore")).max() < 0.02 * E / (1 + NU) * 0.02


def test_short_term_factor_of_a_slope():
    r"""[N] Effective strength without drainage against phi = 0 with the strength that follows from
    the stresses.

    Reduced by F the effective strength is (c + s' tan phi) cos(phi_F) / F with tan phi_F = tan phi
    / F, that of phi = 0 is (c + s' tan phi) cos(phi) / F: so F of the one is that of the other
    times cos(phi_F) / cos(phi).
    """
    basis = Basis(slope_mesh(20.0, 12.0, 5.0, 12.0, 4), ElementVector(ElementTriP2()), intorder=2)
    soil = sc.MohrCoulomb(E=1e5, nu=0.3, c=12.0, phi=18.0, psi=0.0)
    form, fixed, load = sc.SolidForm(basis, soil), held(basis), sc.weight(basis, 20.0)
    start = sc.Model({"soil": form}, fixed).gravity_state(load)
    strength = start[-1].undrained_strength("soil")["all"]
    wet = form.with_materials({"all": sc.Undrained(soil, nu_undrained=0.495)})
    quick = sc.Model({"soil": wet}, fixed).strength_reduction(
        load, start=start, tolerance=0.004, progress=False
    )
    dry = form.with_materials({"all": sc.Tresca(E=1e5, nu=0.495, c=strength)})
    total = sc.Model({"soil": dry}, fixed).strength_reduction(load, tolerance=0.004, progress=False)
    phi = np.radians(18.0)
    expected = total.factor * np.cos(np.arctan(np.tan(phi) / quick.factor)) / np.cos(phi)
    assert quick.factor == pytest.approx(expected, rel=5e-3)


def test_reduction_reaches_the_soil():
    """Strength reduction acts on the soil inside, which must not dilate by any flow; what has no
    strength says so.
    """
    clay = sc.Undrained(SOIL, bulk_modulus_water=BULK)
    assert clay.reduced(2.0).soil.c == 2.5 and clay.reduced(2.0).bulk_modulus_water == BULK
    assert (
        not sc.Undrained(sc.LinearElastic(E=E, nu=NU), bulk_modulus_water=BULK).reducible
        and clay.reducible
    )
    davis, given = clay.reduced(1.5, "davis_b").soil, SOIL.reduced(1.5)
    assert (davis.c, davis.phi, davis.psi) == (given.c, given.phi, 0.0)
    with pytest.raises(ValueError, match="flow must be one of"):
        clay.reduced(1.5, "davis")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({}, "either bulk_modulus_water or nu_undrained"),
        (
            {"bulk_modulus_water": 1.0, "nu_undrained": 0.4},
            "either bulk_modulus_water or nu_undrained",
        ),
        ({"bulk_modulus_water": -1.0}, "bulk_modulus_water must not be negative"),
        ({"bulk_modulus_water": np.nan}, "bulk_modulus_water must be a finite number"),
        ({"nu_undrained": 0.5}, "nu_undrained must be less than 0.5"),
        ({"nu_undrained": 0.1}, r"bulk_modulus_water \(from nu_undrained\) must not be negative"),
    ],
)
def test_bad_input(options, message):
    with pytest.raises(ValueError, match=message):
        sc.Undrained(SOIL, **options)


def test_strength_in_axial_symmetry():
    """The formula is that of plane strain: in the triaxial test another mean stress stays."""
    form = sc.SolidForm(
        vector_basis(grid("Q1", [0, 1], [0, 1]), "Q1", intorder=2), SOIL, coordinates="axisymmetric"
    )
    with pytest.raises(ValueError, match="is that of plane strain; this solid is axisymmetric"):
        undrained_strength(form, form.initial_state())


def test_bad_soil():
    with pytest.raises(ValueError, match="must be a material in effective stresses"):
        sc.Undrained(sc.Undrained(SOIL, bulk_modulus_water=1.0), bulk_modulus_water=1.0)
    form = sc.SolidForm(
        vector_basis(grid("Q1", [0, 1], [0, 1]), "Q1", intorder=2), sc.LinearElastic(E=E, nu=NU)
    )
    with pytest.raises(
        ValueError, match=r"no region has an undrained strength; the regions are \['all'\]"
    ):
        undrained_strength(form, form.initial_state())


@pytest.mark.parametrize(
    ("quick", "mu", "told"), [(True, 0.3, True), (True, 0.0, False), (False, 0.3, False)]
)
def test_friction_beside_undrained_ground(quick: bool, mu: float, told: bool) -> None:
    """[X] A block on confined ground: its water takes K_w / (K_w + M) of the pressure, which
    friction counts.
    """
    bodies = {
        "bed": grid("Q1", np.linspace(0, 1, 4), np.linspace(-1, 0, 4)),
        "cap": grid("Q1", [0.0, 1.0], [0.0, 1.0]),
    }
    basis = vector_basis(sc.join_bodies(bodies), "Q1", intorder=2)
    soil = sc.LinearElastic(E=E, nu=NU)
    bed = sc.Undrained(soil, bulk_modulus_water=9.0 * 1.2 * E) if quick else soil  # M = 1.2 E
    forms = {
        "solids": sc.SolidForm(basis, {"bed": bed, "cap": sc.LinearElastic(E=1e3 * E, nu=NU)}),
        "joint": sc.ContactPair(basis, "cap:bottom", "bed:top", sc.Coulomb(mu)),
    }
    sides = basis.get_dofs({"bed:left", "bed:right", "cap:left", "cap:right"}).all("u^1")
    model = sc.Model(forms, [basis.get_dofs("bed:bottom").all("u^2"), sides])
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        model.run([sc.Stage("press", model.traction("cap:top", (0.0, -P0)))], progress=False)
    text = (
        "'press', joint: the ground beside it is undrained, "
        "with an excess pressure of 90 on average"
    )
    assert any(text in str(w.message) for w in caught) == told
