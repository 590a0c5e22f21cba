"""Bounds: closed forms, contact, water, invariance, damaged solutions and bad input."""

from __future__ import annotations

import warnings
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from bound_cases import CASES, ground, slope_mesh
from skfem import (
    Basis,
    ElementQuad1,
    ElementTriP1,
    ElementTriP2,
    ElementVector,
    MeshQuad,
    MeshTri,
    MeshTri2,
)

import skfem_contact as sc
from skfem_contact.limit_analysis import Bounds, certify, interior_point, search
from skfem_contact.limit_analysis.model import named_loads
from skfem_contact.limit_analysis.reading import read
from skfem_contact.limit_analysis.search import Search
from tests.tools.helpers import analysis, bounds_of

HARDENING = sc.HardeningMohrCoulomb(
    1e4, 0.3, c=20.0, c_end=5.0, phi=0.0, phi_end=0.0, strain_end=0.1
)
SOIL = sc.MohrCoulomb(E=1e5, nu=0.3, c=10.0, phi=20.0, psi=20.0)


def bounds(*args, **given) -> Bounds:
    """Bounds whose gap does not matter."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "the bounds .* differ", sc.AnalysisWarning)
        return analysis("bounds", *args, **({"elements": 400, "progress": False} | given))


def column(material, mesh=None, element=None) -> tuple[dict, np.ndarray]:
    """A square that can spread between its base and a smooth left side."""
    mesh = (mesh or MeshTri().refined(1)).with_defaults()
    basis = Basis(mesh, ElementVector(element or ElementTriP2()), intorder=2)
    fixed = np.hstack([basis.get_dofs("bottom").all("u^2"), basis.get_dofs("left").all("u^1")])
    return {"soil": sc.SolidForm(basis, material)}, fixed


# -- closed forms


@pytest.mark.parametrize(
    ("material", "strength"),
    [
        (sc.Tresca(E=1e3, nu=0.3, c=10.0), 20.0),
        (sc.VonMises(E=1e3, nu=0.3, strength=10.0), 20.0 / np.sqrt(3)),
        (
            sc.MohrCoulomb(E=1e3, nu=0.3, c=10.0, phi=30.0, psi=30.0),
            20.0 * np.tan(np.radians(60.0)),
        ),
        (
            sc.MohrCoulomb(E=1e3, nu=0.3, c=10.0, phi=30.0, psi=30.0, tension=1.0),
            20.0 * np.tan(np.radians(60.0)),
        ),
    ],
)
@pytest.mark.parametrize("element", [ElementTriP1(), ElementTriP2(), ElementQuad1()])
def test_column(material, strength: float, element) -> None:
    """[X] Uniaxial strength; triangles and quadrilaterals, linear and quadratic."""
    mesh = MeshQuad().refined(1) if isinstance(element, ElementQuad1) else MeshTri().refined(1)
    forms, fixed = column(material, mesh, element)
    found = bounds(forms, fixed, tractions={"top": (0.0, -1.0)}, live="top")
    # the solver's accuracy on its first mesh, and the strength that it keeps in reserve
    assert found.lower == pytest.approx(strength, rel=5e-4) and found.upper == pytest.approx(
        strength, rel=5e-4
    )
    assert found.lower <= strength * (1 + 1e-12) and found.upper >= strength * (1 - 1e-12)


@pytest.mark.parametrize(("tension", "strength"), [(None, 20.0 / np.sqrt(3)), (4.0, 4.0)])
def test_tension(tension: float | None, strength: float) -> None:
    """[X] A pulled column: 2 c cos(phi) / (1 + sin(phi)), or the cut-off."""
    soil = sc.MohrCoulomb(E=1e3, nu=0.3, c=10.0, phi=30.0, psi=30.0, tension=tension)
    found = bounds(*column(soil), tractions={"top": (0.0, 1.0)}, live="top")
    assert found.lower <= strength + 1e-9 and found.upper >= strength - 1e-9
    assert found.upper - found.lower < 5e-3 * strength


@pytest.mark.slow
def test_water_and_acceleration() -> None:
    """[X] A flooded column weighs what it weighs in water; a wall of water beside it does not
    matter then.
    """
    forms, fixed = column(sc.MohrCoulomb(E=1e3, nu=0.3, c=10.0, phi=30.0, psi=30.0))
    dry = bounds(forms, fixed, weight=10.0, tractions={"top": (0.0, -1.0)}, live="top")
    water = sc.hydrostatic(3.0, unit_weight=10.0)
    wet = bounds(
        forms,
        fixed,
        weight=20.0,
        water=water,
        submerged=("top", "right"),
        tractions={"top": (0.0, -1.0)},
        live="top",
    )
    assert wet.lower == pytest.approx(dry.lower, rel=1e-4) and wet.upper == pytest.approx(
        dry.upper, rel=1e-4
    )
    pushed = bounds(
        forms, fixed, weight=10.0, seismic=0.1, tractions={"top": (0.0, -1.0)}, live="top"
    )
    back = bounds(
        forms, fixed, weight=10.0, seismic=-0.1, tractions={"top": (0.0, -1.0)}, live="top"
    )
    assert pushed.upper < dry.lower < dry.upper < back.upper


@pytest.mark.parametrize("quadrilaterals", [False, True])
def test_water_at_nodes_of_a_slope(quadrilaterals) -> None:
    """[X] A slope under water at rest has the bounds of its weight in water, also at sloping sides.

    The pressures of a seepage are values at nodes; nodes of a slope lie beside it, by round-off.
    """
    run = 10.0 * np.sqrt(3.0)
    flat = MeshQuad.init_tensor(
        np.concatenate([[-12.0, -6.0], run * np.linspace(0.0, 1.0, 4), [run + 9.0, run + 18.0]]),
        np.linspace(0.0, 1.0, 4),
    )
    surface = np.clip(flat.p[0] / run, 0.0, 1.0) * 10.0
    flat = MeshQuad(np.stack([flat.p[0], flat.p[1] * (surface + 6.0) - 6.0]), flat.t)
    mesh = (flat if quadrilaterals else flat.to_meshtri()).with_boundaries(
        {
            "sides": lambda x: (x[0] < -12.0 + 1e-6) | (x[0] > run + 18.0 - 1e-6),
            "bottom": lambda x: x[1] < -6.0 + 1e-6,
            "ground": lambda x: x[1] > np.clip(x[0] / run, 0.0, 1.0) * 10.0 - 1e-6,
        }
    )
    element = ElementQuad1() if quadrilaterals else ElementTriP2()
    basis = Basis(mesh, ElementVector(element), intorder=4)
    soil = sc.MohrCoulomb(E=1e5, nu=0.3, c=8.0, phi=25.0, psi=25.0)
    flow = sc.water.Flow(basis, 1e-5, unit_weight=10.0).steady(
        sc.water.Conditions(head={"ground": 15.0})
    )
    fixed = np.append(basis.get_dofs("bottom").all(), basis.get_dofs("sides").all("u^1"))
    forms = {"soil": sc.SolidForm(basis, soil)}
    settings = {"gap": 0.3, "elements": 400}
    dry = bounds(forms, fixed, weight=10.0, **settings)
    wet = bounds(forms, fixed, weight=20.0, water=flow.pressure, submerged="ground", **settings)
    assert wet.lower == pytest.approx(dry.lower, rel=1e-4)
    assert wet.upper == pytest.approx(dry.upper, rel=1e-4)


# -- contact


def block(law, strength: bool, soil=None, elements: int = 600) -> Bounds:
    """A block on a base, pushed with 1 or, for a factor, 30 kN/m; the meshes of their faces do not
    match.
    """
    base = MeshTri.init_tensor(np.linspace(0, 8, 9), np.linspace(-1, 0, 2)).with_defaults()
    upper = MeshTri.init_tensor(np.linspace(2, 6, 4), np.linspace(0, 1, 2)).with_defaults()
    basis = Basis(
        sc.join_bodies({"base": base, "block": upper}), ElementVector(ElementTriP2()), intorder=2
    )
    forms = {
        "bodies": sc.SolidForm(basis, soil or replace(SOIL, c=1000.0)),
        "joint": sc.ContactPair(basis, "block:bottom", "base:top", law, "nodal"),
    }
    push = {"tractions": {"block:left": (30.0, 0.0)}, "reduce": "joint"}
    if not strength:
        push = {"tractions": {"block:left": (1.0, 0.0)}, "live": "block:left"}
    fixed = basis.get_dofs("base:bottom").all()
    return bounds(forms, fixed, weight={"block": 25.0}, gap=2e-4, elements=elements, **push)


LAW = sc.Coulomb(mu=np.tan(np.radians(26.6)), adhesion=2.5)
PUSH = 4 * 2.5 + 100 * np.tan(np.radians(26.6))


@pytest.mark.parametrize("soil", [None, sc.LinearElastic(E=1e5, nu=0.2)])
def test_sliding_block(soil) -> None:
    """[X] Adhesion and friction times the weight, and the factor on both of them; strong bodies and
    rigid ones.
    """
    load, factor = block(LAW, False, soil), block(LAW, True, soil)
    assert load.lower <= PUSH * (1 + 1e-12) and load.upper >= PUSH * (1 - 1e-12) and load.gap < 2e-4
    if soil is None:
        assert load.lower > PUSH * (
            1 - 1e-5
        )  # fans on both sides of the joint's ends; the solver's reserve is 1e-6
    assert (
        factor.lower <= PUSH / 30 * (1 + 1e-12)
        and factor.upper >= PUSH / 30 * (1 - 1e-12)
        and factor.gap < 2e-4
    )


@pytest.mark.slow
def test_smooth_and_tied() -> None:
    """[X] Without friction nothing resists; a tied block is crushed at 2 c, not sheared off at 4 c
    along its base.
    """
    # zero: the load moves a smooth block by what round-off, 1e-12 of the bodies' cohesion of 1000,
    # dissipates in them
    assert block(sc.Coulomb(), False, elements=50).upper < 1e-8
    tied = block(sc.Tied(), False, sc.Tresca(E=1e5, nu=0.3, c=20.0), elements=2000)
    assert (
        0.999 * 40.0 < tied.lower < tied.upper < 1.05 * 40.0
    )  # its weight and the base add a little
    with pytest.warns(sc.AnalysisWarning, match="fixed loads alone"):
        block(sc.Tied(), False, sc.Tresca(E=1e5, nu=0.3, c=4.0), elements=50)


@pytest.mark.parametrize(
    ("live", "high", "least", "too_much"),
    [
        (True, 2.0, -np.inf, False),  # they are held at no multiplier, too
        (True, 2.0, 1.0, False),  # a multiplier from 1 to 2 holds them
        (True, 2.0, 3.0, True),
        (True, -1.0, -np.inf, True),
        (True, 0.0, -1.0, False),
        (False, 0.5, 3.0, False),  # a factor of safety has no multiplier
    ],
)
def test_fixed_loads_that_no_multiplier_from_zero_holds(live, high, least, too_much) -> None:
    """[X] The highest multiplier is negative, or less than the least one that holds them."""
    upper = SimpleNamespace(proof=SimpleNamespace(value=high))
    found = SimpleNamespace(live=live, upper=upper, least=least)
    assert Search.overloaded.fget(found) is too_much


# -- invariance


@pytest.mark.slow
def test_units_rotation_and_place() -> None:
    """[X] The same bounds in MN and mm, turned by 37 degrees with its loads, and far from the
    origin.
    """
    reference = bounds(**ground(slope_mesh(10, 20, 12), 10.0, 20.0, 20.0), elements=300)
    mesh = slope_mesh(10, 20, 12)

    def same(mesh: MeshTri, stress: float, gamma: float) -> None:
        found = bounds(**ground(mesh, 10.0 * stress, 20.0, gamma), elements=300)
        assert found.lower == pytest.approx(reference.lower, rel=1e-6)
        assert found.upper == pytest.approx(reference.upper, rel=1e-6)

    def moved(p: np.ndarray) -> MeshTri:
        return MeshTri(p, mesh.t).with_boundaries(
            {name: np.asarray(f) for name, f in mesh.boundaries.items()}
        )

    same(moved(1e3 * mesh.p), 1e-3, 20e-6)
    same(moved(mesh.p + 1e5), 1.0, 20.0)


@pytest.mark.slow
def test_rotation(monkeypatch) -> None:
    """[X] Weight as a body force at an angle: the base is held, and so is the side, wholly."""
    monkeypatch.setattr(search, "_ACCURACY", 1e-4)  # of a gap of 3 %
    mesh, factors = slope_mesh(10, 20, 12), []
    for angle in (0.0, np.radians(37.0)):
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        turned = MeshTri(turn @ mesh.p, mesh.t).with_boundaries(
            {k: np.asarray(f) for k, f in mesh.boundaries.items()}
        )
        basis = Basis(turned, ElementVector(ElementTriP2()), intorder=2)
        fixed = basis.get_dofs({"base", "sides"}).all()
        # (seismic, -1) times the weight is gravity turned
        down = turn @ [0.0, -20.0]
        factors.append(
            bounds(
                {"soil": sc.SolidForm(basis, SOIL)},
                fixed,
                weight=-down[1],
                seismic=-down[0] / down[1],
                elements=300,
            )
        )
    assert factors[1].lower == pytest.approx(
        factors[0].lower, rel=1e-5
    )  # iterations stop at 3e-6 of the gap
    assert factors[1].upper == pytest.approx(
        factors[0].upper, rel=1e-5
    )  # iterations stop at 3e-6 of the gap


# -- damaged solutions


def damaged(monkeypatch, change) -> Bounds:
    """Bounds of a slope whose solver does not do its work."""
    whole = search.solve
    monkeypatch.setattr(search, "solve", lambda *args: change(whole(*args)))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", sc.AnalysisWarning)
        return bounds_of(**CASES["Griffiths and Lane 1"][0], elements=700, progress=False)


@pytest.mark.slow
def test_noise(monkeypatch) -> None:
    """[X] Stresses and velocities that are off by 1e-4: the bracket holds the factor all the same,
    or there is none.
    """
    random = np.random.default_rng(0)

    def noisy(found):
        return replace(
            found,
            stress=found.stress * (1 + 1e-4 * random.standard_normal(found.stress.shape)),
            velocity=found.velocity * (1 + 1e-4 * random.standard_normal(found.velocity.shape)),
        )

    found = damaged(monkeypatch, noisy)
    assert found.lower < 1.3793 and found.upper > 1.3752  # the factor lies between these two
    assert found.lower > 1.3  # equilibrium is restored at little cost


def test_overlap(monkeypatch) -> None:
    """[X] Velocities of a block that is pressed into its base by 1e-3 of the slip are parted: the
    bound is not lost.
    """
    whole = search.solve

    def pressed(program, *args):
        found, pressing = whole(program, *args), program.forces(program.volume)
        pressing *= 1e-3 * np.abs(found.velocity).max() / np.abs(pressing).max()
        return replace(found, velocity=found.velocity + pressing, inner=[])

    monkeypatch.setattr(search, "solve", pressed)
    found = block(
        sc.Coulomb(mu=0.0, adhesion=2.5), True, sc.LinearElastic(E=1e5, nu=0.2), elements=100
    )
    assert found.upper == pytest.approx(
        4 * 2.5 / 30, rel=0.05
    )  # its weight, 10 times the force, is lifted a little


@pytest.mark.parametrize("iterations", [3, 8, 12])
@pytest.mark.one_in(3)
def test_early_stop(monkeypatch, iterations: int) -> None:
    """[X] An iteration that stops early proves less, or nothing, and never too much."""
    monkeypatch.setattr("skfem_contact.limit_analysis.interior_point.MOST", iterations)
    found = damaged(monkeypatch, lambda solution: solution)
    assert found.lower < 1.3800 and found.upper > 1.3748


def lower_of_a_slope():
    """Lower certificate of a slope, and its program."""
    case = CASES["Griffiths and Lane 1"][0]
    problem = read(
        case["forms"],
        case["fixed"],
        lambda site: named_loads(site, case["weight"], {}, None, (), 0.0, ()),
        False,
        None,
        (),
        False,
    )
    found = Search(problem, _Silent()).lower
    return found, found.program


def test_more_plain_stiffness_where_round_off_keeps_stresses_from_equilibrium(monkeypatch) -> None:
    """[X] The stiffness of the last iterate is useless, as that of a strong pile is by chance: the
    bound stays.
    """
    found, program = lower_of_a_slope()
    balanced = certify._balanced

    def by_chance(program, found, theta, plain):
        stress, residual = balanced(program, found, theta, plain)
        return stress, 1e-2 if plain == certify._PLAIN[0] else residual

    monkeypatch.setattr(certify, "_balanced", by_chance)
    again = certify.prove_lower(program, found.solution, False)
    # ten times the plain stiffness moves stresses elsewhere, within the gap of the solver
    assert (
        again.value == pytest.approx(found.proof.value, rel=1e-3)
        and again.residual <= certify.UNBALANCED
    )


def test_equilibrium_that_is_not_reached_proves_nothing() -> None:
    """[X] A stress that is out of balance is refused."""
    found, program = lower_of_a_slope()
    assert certify.prove_lower(program, found.solution, False).value == pytest.approx(
        found.proof.value
    )
    program.dead = program.dead + 1e9  # more than the metric can balance within its repetitions
    assert certify.prove_lower(program, found.solution, False).value < found.proof.value


def test_a_point_on_the_surface_of_its_cone_ends_an_iteration() -> None:
    """[X] A curvature without a value is found before any matrix has a factor."""
    _, program = lower_of_a_slope()
    path = interior_point._Path(program, interior_point.Goal(1.0, 0.0, True, 1e-6), 1e-3)
    path.residuals()
    path.step()
    path.scaled.squared[0] = np.nan
    with pytest.raises(ArithmeticError, match="surface of its cone"):
        path._factor()


def test_singular_points() -> None:
    """[X] The ends of a load, also at a corner, and of a rigid foot; not the ends of supports at
    corners, nor nodes within a load.
    """
    lines = np.linspace(0, 8, 9), np.linspace(0, 3, 4)
    mesh = MeshTri.init_tensor(*lines).with_subdomains(
        {"clay": lambda x: x[1] < 2, "foot": lambda x: (x[1] > 2) & (abs(x[0] - 5) < 1)}
    )
    kept = np.concatenate(list(mesh.subdomains.values()))
    mesh = mesh.restrict(kept).with_boundaries(
        {"base": lambda x: x[1] == 0, "load": lambda x: (x[1] == 2) & (x[0] < 2)}
    )
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    materials = {"clay": sc.Tresca(E=1e4, nu=0.3, c=10.0), "foot": sc.LinearElastic(1e6, 0.2)}
    problem = read(
        {"soil": sc.SolidForm(basis, materials)},
        basis.get_dofs("base").all(),
        lambda site: named_loads(site, 0.0, {"load": (0.0, -1.0)}, None, (), 0.0, ("load",)),
        True,
        None,
        (),
        False,
    )
    points = search._singular_points(problem.model, problem.model.triangles)
    # The model has its middle at zero and the length one.
    x, y = 8.0 * points + np.array([[4.0], [1.5]])
    np.testing.assert_allclose(np.sort(x), [0.0, 2.0, 4.0, 6.0], atol=1e-12)
    np.testing.assert_allclose(y, 2.0)


class _Silent:
    def set_postfix_str(self, text: str) -> None:
        """Nothing is shown."""


# -- flow, elastic moduli, results


@pytest.mark.slow
def test_less_dilation() -> None:
    """[X] The upper bound is that of associated flow, the lower one an estimate that is named
    so.
    """
    associated = ground(slope_mesh(10, 20, 12), 10.0, 20.0, 20.0)
    basis = associated["forms"]["soil"].basis
    given = associated | {
        "forms": {"soil": sc.SolidForm(basis, replace(SOIL, psi=0.0))},
        "elements": 400,
    }
    estimate, proven = bounds(**given), bounds(**given, flow="associated")
    assert estimate.estimate and not proven.estimate and "no bound" in str(estimate)
    assert estimate.upper == pytest.approx(proven.upper, rel=1e-12)
    # beta = cos(phi) at psi = 0 divides the whole strength
    assert estimate.lower == pytest.approx(np.cos(np.radians(20.0)) * proven.lower, rel=0.01)


def test_result_is_in_the_users_units() -> None:
    """[X] Names, mechanism and shares of the dissipation; stresses of the ground's size."""
    found = bounds(**CASES["Griffiths and Lane 1"][0], elements=700)
    assert set(found.mesh.boundaries) == {"base", "sides"}
    assert np.allclose([found.mesh.p.min(axis=1), found.mesh.p.max(axis=1)], [[-32, 0], [0, 10]])
    assert np.abs(found.mechanism).max() == 1.0
    assert found.mechanism.shape[1] == found.mesh.nvertices + found.mesh.nfacets
    assert found.dissipation.sum() == pytest.approx(1.0) and found.dissipation.min() > -1e-12
    assert 100 < -found.stress[1].min() < 1000  # some 200 kPa below 10 m
    assert found.certificates[0].value == found.lower and found.certificates[1].value == found.upper
    assert "gap" in str(found)


def test_curved_sides_are_warned_of() -> None:
    """A mesh of second order with a curved side is straightened."""
    mesh = MeshTri2.from_mesh(MeshTri().refined(1))
    x = mesh.doflocs.copy()
    right = np.isclose(x[0], 1.0)
    x[0, right] += 0.1 * x[1, right] * (1 - x[1, right])
    curved = MeshTri2(x, mesh.t).with_boundaries(
        {
            "bottom": lambda p: p[1] < 1e-9,
            "left": lambda p: p[0] < 1e-9,
            "top": lambda p: p[1] > 1 - 1e-9,
        }
    )
    basis = Basis(curved, ElementVector(ElementTriP2()), intorder=2)
    fixed = np.hstack([basis.get_dofs("bottom").all("u^2"), basis.get_dofs("left").all("u^1")])
    found = bounds(
        {"soil": sc.SolidForm(basis, SOIL)}, fixed, tractions={"top": (0.0, -1.0)}, elements=50
    )
    assert any("curved" in remark for remark in found.remarks)


# -- bad input


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({}, "there is no load"),
        ({"weight": np.nan}, "finite"),
        ({"weight": {"sand": 20.0}}, "no subdomain 'sand'"),
        (
            {"tractions": {"roof": (0, -1)}},
            "no boundary 'roof'; existing: bottom, left, right, top",
        ),
        ({"tractions": {"top": (0, -1, 0)}}, "must be"),
        ({"tractions": {"top": (0, np.nan)}}, "must be"),
        ({"weight": 20.0, "live": "top"}, "no load 'top' to multiply; existing: weight"),
        ({"weight": 20.0, "gap": 0.0}, "positive"),
        ({"weight": 20.0, "flow": "davis_b"}, "flow"),
        ({"weight": 20.0, "reduce": "rock"}, "no form or region 'rock'"),
        (
            {"weight": 20.0, "water": np.ones(3)},
            "a water level needs the unit weight of water.* or pressures at the 9 vertices",
        ),
        (
            {"weight": 20.0, "water": 3.0},
            "a water level needs the unit weight of water",
        ),
        ({"weight": 20.0, "fixed": np.zeros(0, int)}, "without supports"),
        ({"weight": 20.0, "fixed": np.array([0, 1])}, "though no facet"),
    ],
)
def test_bad_loads(change: dict, message: str) -> None:
    """One clear error, before anything is computed."""
    forms, fixed = column(SOIL)
    with pytest.raises(ValueError, match=message):
        bounds_of(**({"forms": forms, "fixed": fixed, "progress": False} | change))


def test_what_has_no_bounds() -> None:
    """Other materials, elastic bodies alone, axial symmetry, forms that are neither solids nor
    contact.
    """
    for material, message in (
        (HARDENING, "HardeningMohrCoulomb"),
        (sc.LinearElastic(E=1e3, nu=0.3), "nothing to reduce"),
        (sc.MohrCoulomb(E=1e3, nu=0.3, c=1.0, phi=0.01), "between 0 and"),
        (sc.MohrCoulomb(E=1e3, nu=0.3, c=0.0, phi=0.0), "neither cohesion"),
    ):
        forms, fixed = column(material)
        with pytest.raises(ValueError, match=message):
            sc.Model(forms, fixed).bounds(weight=20.0, progress=False)
    forms, fixed = column(SOIL)
    basis = forms["soil"].basis
    with pytest.raises(ValueError, match="axially symmetric"):
        sc.Model({"soil": sc.SolidForm(basis, SOIL, coordinates="axisymmetric")}, fixed).bounds(
            weight=20.0, progress=False
        )
    with pytest.raises(ValueError, match="no bounds with 'spring'"):
        spring = sc.Spring(basis, basis.doflocs[:, 0], 1.0)
        sc.Model(forms | {"spring": spring}, fixed).bounds(weight=20.0, progress=False)


@pytest.mark.slow
def test_no_bound_is_computed_once_the_gap_is_closed() -> None:
    """An upper bound that closes the bracket is the last one."""
    gap = 0.012
    slope = ground(slope_mesh(10, 20, 12), 10.0, 20.0, 20.0)
    found = bounds(**slope, gap=gap, elements=20_000)
    before = found.history[:-1]
    lower = max(each.value for each in before if each.kind == "lower")
    upper = min(each.value for each in before if each.kind == "upper")
    assert found.gap <= gap < search.relative_gap(lower, upper)


@pytest.mark.slow
def test_clean_sand() -> None:
    """[X] The factor tan 30 / tan 20 = 1.5863 is met from above; there is no lower bound, which a
    warning says with the meshes that were tried; they are not refined for nothing.
    """
    mesh = slope_mesh(3.0, 3.0 / np.tan(np.radians(20.0)), 4.0, 1.0, 3.0)
    with pytest.warns(
        sc.AnalysisWarning,
        match=r"without cohesion resists nothing at a free surface.*of up to \d+ triangles, in",
    ):
        found = bounds(**ground(mesh, 0.0, 30.0, 20.0), elements=20_000)
    assert max(each.elements for each in found.history) < 2_000
    assert 1.5863 < found.upper < 1.61 and found.lower < 1.5863
    assert any("without cohesion" in remark for remark in found.remarks)


@pytest.mark.slow
def test_clay_without_tensile_strength_may_have_a_lower_bound() -> None:
    """A coarse mesh proves none; the warning speaks of these meshes and not of the soil."""
    mesh = slope_mesh(5.0, 10.0, 10.0, 5.0, 10.0)
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    clay = sc.MohrCoulomb(E=1e4, nu=0.3, c=15.0, phi=0.0, tension=0.0)
    forms = {"soil": sc.SolidForm(basis, clay)}
    with pytest.warns(
        sc.AnalysisWarning, match="no lower bound could be proven on these meshes.*of up to"
    ):
        found = bounds(forms, sc.box_supports(basis), weight=18.0, elements=1)
    assert found.lower < 1e-3 * found.upper < 10.0


def test_no_collapse() -> None:
    """Soil in a box cannot fail."""
    forms, _ = column(SOIL)
    with pytest.raises(ValueError, match="no collapse"):
        sc.Model(forms, forms["soil"].basis.get_dofs({"left", "right", "bottom"}).all()).bounds(
            weight=1.0, progress=False
        )


def test_a_gap_that_was_not_reached_is_warned_of() -> None:
    """The limit of the triangles."""
    with pytest.warns(sc.AnalysisWarning, match="allow more `elements`"):
        bounds_of(**CASES["Griffiths and Lane 1"][0], elements=100, progress=False)


@pytest.mark.parametrize(
    ("gap", "elements", "solved"), [(0.9, 400, 1), (1e-9, 10, 1), (1e-9, 200, 2)]
)
def test_no_lower_bound_is_proven_twice_on_a_mesh(monkeypatch, gap, elements, solved) -> None:
    """[X] The first one, where it is close enough or no finer mesh is allowed; one on each finer
    mesh, or on the last of them.
    """
    meshes = []
    solve = Search._solve_lower

    def counted(self, model):
        meshes.append(self.triangles.mesh)
        return solve(self, model)

    monkeypatch.setattr(Search, "_solve_lower", counted)
    forms, fixed = column(SOIL, MeshTri().refined(1), ElementTriP2())
    tractions = {"top": (0.0, -1.0)}
    bounds(forms, fixed, tractions=tractions, live="top", gap=gap, elements=elements)
    assert len(meshes) == len({id(mesh) for mesh in meshes}) >= solved


@pytest.mark.parametrize(("low", "overloaded"), [(0.0, True), (5.0, True), (20.0, False)])
def test_least_multiplier_of_a_thrust(monkeypatch, low, overloaded) -> None:
    """[X] A column under a pressure q stands where the thrust on its side is from q - 2 c to q + 2
    c. Under 50 it needs 30, and one under 0, 5 or 20 bears 20, 25 or 40: there is none, or some.
    """
    found = []
    monkeypatch.setattr(Search, "run", lambda self, *given: found.append(self))
    square = MeshTri().refined(1).with_defaults()
    mesh = sc.join_bodies({"a": square, "b": square.translated((3.0, 0.0))})
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    fixed = np.hstack(
        [
            basis.get_dofs({"a:bottom", "b:bottom"}).all("u^2"),
            basis.get_dofs({"a:left", "b:left"}).all("u^1"),
        ]
    )
    forms = {"soil": sc.SolidForm(basis, sc.Tresca(E=1e5, nu=0.3, c=10.0))}
    thrust = dict.fromkeys(("a:right", "b:right"), (-1.0, 0.0))
    tractions = {"a:top": (0.0, -50.0), "b:top": (0.0, -low), **thrust}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", sc.AnalysisWarning)
        bounds(forms, fixed, tractions=tractions, live=tuple(thrust))
    (search_,) = found
    assert bool(search_.overloaded) is overloaded
    if overloaded:
        assert search_.least == pytest.approx(30.0, rel=1e-3)
        assert search_.fixed_factor == pytest.approx(2.0 * 10.0 / 50.0, rel=1e-3)
    else:
        assert search_.upper.proof.value == pytest.approx(low + 20.0, rel=1e-3)
        assert (search_.least, search_.fixed_factor) == (-np.inf, np.inf)
