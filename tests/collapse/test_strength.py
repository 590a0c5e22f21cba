"""Strength reduction: invariances, closed forms, Davis' soils, what is reduced, and bad input."""

from __future__ import annotations

import re

import numpy as np
import pytest
from skfem import Basis, ElementQuad1, ElementTriP2, ElementVector, MeshQuad, MeshTri

import skfem_contact as sc
from skfem_contact.collapse.result import Stop
from tests.oracles.fixed_factors import enclosed_factor
from tests.tools.helpers import analysis

SOIL = {"E": 1e5, "nu": 0.3, "c": 10.0, "phi": 20.0, "psi": 20.0}


def slope_mesh(height=10.0, crest=12.0, face=20.0, rows=6, columns=4) -> MeshTri:
    """Rows of triangles that step down the face."""
    number = {}
    for j in range(rows + 1):
        for i in range(columns + j + 1):
            number[i, j] = len(number)
    x = [
        crest * i / columns if i <= columns else crest + face * (i - columns) / rows
        for i, _ in number
    ]
    y = [height * (1 - j / rows) for _, j in number]
    triangles = []
    for j in range(rows):
        for i in range(columns + j):
            a, b, c, d = (number[k] for k in ((i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)))
            triangles += [(a, c, d), (a, d, b)]
        triangles.append(
            (number[columns + j, j], number[columns + j, j + 1], number[columns + j + 1, j + 1])
        )
    return MeshTri(np.array([x, y]), np.ascontiguousarray(np.transpose(triangles)))


def slope(unit_weight=20.0, mesh=None, **soil):
    """Forms, fixed unknowns and load of a slope on a rigid base."""
    basis = Basis(mesh or slope_mesh(), ElementVector(ElementTriP2()), intorder=2)
    lowest, left = basis.doflocs[1].min(), basis.doflocs[0].min()
    across = np.zeros(basis.N, dtype=bool)
    across[basis.nodal_dofs[0]] = across[basis.facet_dofs[0]] = True
    fixed = np.flatnonzero((basis.doflocs[1] == lowest) | (across & (basis.doflocs[0] == left)))
    form = sc.SolidForm(basis, sc.MohrCoulomb(**{**SOIL, **soil}))
    return {"soil": form}, fixed, sc.weight(basis, unit_weight)


def reduce(*problem, **settings):
    return analysis("strength_reduction", *problem, progress=False, **settings)


@pytest.fixture(scope="module")
def reference():
    return reduce(*slope(), certify=False)


@pytest.fixture(scope="module")
def without_dilatancy():
    return reduce(*slope(psi=0.0), certify=False)


def test_factor_lies_above_the_rigorous_lower_bound(reference):
    """H1 [B]: limit analysis has 1.375 to 1.385; a coarse mesh of quadratic triangles reads up to 7
    % more.
    """
    assert 1.375 < reference.factor < 1.07 * 1.385
    assert (
        reference.bracket[1] - reference.bracket[0] <= 0.0025
    )  # a quarter of the default tolerance
    assert reference.stop.kind == "plateau"


@pytest.mark.slow
@pytest.mark.parametrize("psi", [20.0, 0.0])
def test_factor_agrees_with_trials_at_fixed_factors(psi):
    """K7 [X]: the bracket is at most 0.01 wide; the curve ends at most 0.0025 below its plateau."""
    problem = slope(psi=psi, mesh=slope_mesh(rows=4, columns=3))
    low, high = enclosed_factor(*problem)
    assert low - 0.0025 <= reduce(*problem).factor <= high


@pytest.mark.parametrize("change", [{"E": 1e3}, {"E": 1e7}, {"nu": 0.45}])
def test_factor_does_not_depend_on_elasticity(reference, change):
    """K7 [X]: collapse loads are rigid-plastic; both curves may end 0.0025 below their plateaus.
    They end at displacements in proportion to 1 / E.
    """
    found = reduce(*slope(**change))
    assert found.factor == pytest.approx(reference.factor, abs=0.003)
    stiffer = change.get("E", SOIL["E"]) / SOIL["E"]
    # Steps double: a curve that ends with another step has twice the displacements
    assert stiffer * np.abs(found.x).max() < 4.0 * np.abs(reference.x).max()


def test_factor_does_not_depend_on_units(reference):
    """K7, S3 [X]: Pa and mm instead of kPa and m; round-off alone differs."""
    problem = slope(20.0, slope_mesh().scaled(1e3), E=1e8, c=1e4)
    assert reduce(*problem).factor == pytest.approx(reference.factor, abs=1e-6)


def test_factor_depends_on_strength_over_weight_and_height_only(reference):
    """K7 [X]: twice as high, and twice the cohesion."""
    assert reduce(*slope(20.0, slope_mesh().scaled(2.0), c=20.0, E=2e5)).factor == pytest.approx(
        reference.factor, abs=1e-6
    )  # the same equations up to round-off


@pytest.mark.filterwarnings("ignore:the structure is unstable")
def test_soil_that_was_reduced_by_its_factor_has_factor_one(reference):
    """K7 [X]: the curve ends up to 0.0025 below its plateau, twice."""
    soil = sc.MohrCoulomb(**SOIL).reduced(reference.factor)
    result = reduce(*slope(c=soil.c, phi=soil.phi, psi=soil.psi))
    assert result.factor == pytest.approx(1.0, abs=0.003)
    assert "elastic" not in str(result.stop)  # the plateau, or that the first equilibrium is on it


def test_what_is_elastic_until_it_collapses():
    """[X] A column of strength 2 c under half of that: no curve, as the first point that flows is
    the last.
    """
    basis = Basis(MeshQuad().refined(1).with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    fixed = np.hstack([basis.get_dofs("bottom").all("u^2"), basis.get_dofs("left").all("u^1")])
    load = basis.zeros()
    load[basis.get_dofs("top").nodal["u^2"]] = -10.0 * np.array([0.25, 0.25, 0.5])
    column = sc.SolidForm(basis, sc.MohrCoulomb(E=1e3, nu=0.3, c=10.0, phi=0.0), strain="b_bar")
    result = reduce({"soil": column}, fixed, load)
    assert result.factor == pytest.approx(2.0, abs=0.0025)  # a quarter of the tolerance
    assert result.stop == Stop("collapse", "the bodies are elastic up to there")


def test_start_from_a_stage_gives_the_same_factor(reference):
    """K7 [X]: restarted and from scratch; with associated flow the path has no influence."""
    forms, fixed, load = slope()
    stages = sc.Model(forms, fixed).run([sc.Stage("weight", load, increments=4)], progress=False)
    result = reduce(forms, fixed, start=stages)
    assert result.factor == pytest.approx(reference.factor, abs=0.001)


@pytest.mark.parametrize(
    "settings",
    [
        {"step": 0.02},
        {"step": 0.4},
        {"newton": sc.Newton(1e-6, 30)},
        {"newton": sc.Newton(2e-3, 30)},
        {"tolerance": 0.004},
    ],
)
@pytest.mark.parametrize("psi", [20.0, 0.0])
@pytest.mark.one_in(3)
def test_settings_do_not_make_a_collapse(reference, without_dilatancy, settings, psi):
    """S21 [X]: step and tolerance; the curve may end 0.0025 below its plateau, non-associated paths
    differ too.
    """
    usual = reference if psi else without_dilatancy
    assert reduce(*slope(psi=psi), **settings).factor == pytest.approx(usual.factor, abs=0.006)


def test_davis_soils_follow_from_the_associated_factor(reference):
    """F4 [X]: in uniform soil beta scales the strength alone: the factors follow from the
    associated one.
    """
    associated = reduce(*slope(psi=0.0), flow="associated").factor
    assert associated == pytest.approx(reference.factor, abs=1e-9)  # the same problem
    tangent = np.tan(np.radians(20.0))
    a, b, c = (reduce(*slope(psi=0.0), flow=f"davis_{kind}").factor for kind in "abc")
    assert a == pytest.approx(
        np.cos(np.radians(20.0)) * associated, abs=0.003
    )  # ends of the curves
    assert b == pytest.approx(associated * np.cos(np.arctan(tangent / b)), abs=0.003)
    assert c == b  # psi = 0 cannot be reduced


def test_davis_soil_takes_arrays():
    """F4 [X]: elementwise, and psi = phi is left as it is."""
    soil = sc.MohrCoulomb(
        E=1e4, nu=0.3, c=np.array([1.0, 2.0]), phi=np.array([30.0, 20.0]), psi=np.array([30.0, 0.0])
    )
    weaker = soil.reduced(1.0, "davis_b")
    np.testing.assert_allclose(
        weaker.c, [1.0, 2.0 * np.cos(np.radians(20.0))], rtol=1e-14
    )  # round-off
    np.testing.assert_allclose(weaker.psi, weaker.phi)


@pytest.mark.filterwarnings("ignore:the structure is unstable")
def test_cut_of_dawson_is_about_to_fail():
    """H12 [B]: 45 degrees, c = 12.38: 0.990 to 1.0002; coarse meshes read up to 7 % more, 1.013 on
    a fine one.
    """
    result = reduce(*slope(mesh=slope_mesh(face=10.0), c=12.38))
    assert 0.99 < result.factor < 1.07


def test_unstable_slope_is_warned_of():
    """[X] 0.8 times the strength of a slope with a factor near 1."""
    problem = slope(mesh=slope_mesh(face=10.0), c=9.9, phi=16.2, psi=16.2)
    with pytest.warns(sc.AnalysisWarning, match="unstable under its own load"):
        assert 0.75 < reduce(*problem).factor < 0.9


@pytest.mark.slow
def test_unstable_slope_collapses_in_a_stage():
    """[X] The error of a load stage says collapse, not stall, and from where to where: about the
    limit load.
    """
    forms, fixed, load = slope(c=2.0, phi=10.0, psi=10.0)
    with pytest.raises(sc.NotConverged, match="collapse") as error:
        sc.Model(forms, fixed).run([sc.Stage("weight", load)], progress=False)
    reached = error.value.result["weight"].fraction
    beyond = float(re.search(r"the displacements run away at ([\d.]+)%", str(error.value))[1]) / 100
    limit = sc.Model(forms, fixed).limit_load(load, progress=False)
    assert (
        reached < limit.bracket[1] and limit.bracket[0] < beyond
    )  # associated flow: one limit, whatever the way
    assert (
        beyond < 1.03 * reached
    )  # where the stage ends: 2 % between them, and the digits of the message


def test_mechanism_is_a_slide_towards_the_toe(reference):
    """The largest displacement increment points out of the slope; shear strain concentrates."""
    assert np.abs(reference.mechanism).max() == 1.0
    assert reference.mechanism.max() > -reference.mechanism.min() * 0.5
    band = reference.bands["soil"]
    assert np.quantile(band, 0.5) < 0.2 * band.max()


def test_result_prints_its_trials(reference):
    """One line a trial, and what stopped the search."""
    text = str(reference)
    assert "factor of safety" in text and "plateau" in text and "dofs" in text
    assert text.count("equilibrium") == len(reference.curve)
    assert reference.iterations == sum(trial.iterations for trial in reference.steps)


def two_layers():
    mesh = slope_mesh().with_subdomains(
        {"upper": lambda x: x[1] > 5.0, "lower": lambda x: x[1] <= 5.0}
    )
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    _, fixed, load = slope(mesh=mesh)
    soil = sc.MohrCoulomb(**SOIL)
    return {"soil": sc.SolidForm(basis, {"upper": soil, "lower": soil})}, fixed, load


def test_regions_are_reduced_by_name(reference):
    """[X] Both layers named are the whole slope; one that keeps its strength makes it safer."""
    problem = two_layers()
    both = reduce(*problem, reduce={"upper", "lower"})
    assert both.factor == pytest.approx(reference.factor, abs=1e-3)  # another order of the elements
    assert both.reduced == ("soil.upper", "soil.lower")
    assert reduce(*problem, exclude={"lower"}).factor > both.factor + 0.1


def blocks(mu=0.5):
    """A block on a plate that is pressed by 10 and pushed by 2: it slides at mu = 0.2."""
    plate = MeshQuad.init_tensor(np.linspace(0, 3, 7), np.linspace(0, 1, 3)).with_defaults()
    block = MeshQuad.init_tensor(np.linspace(1, 2, 4), np.linspace(1, 2, 4)).with_defaults()
    mesh = sc.join_bodies({"plate": plate, "block": block})
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    forms = {
        "solid": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3)),
        "joint": sc.ContactPair(
            basis, "block:bottom", "plate:top", sc.Coulomb(mu=mu), quadrature="nodal"
        ),
    }
    top = basis.get_dofs("block:bottom").nodal
    load = basis.zeros()
    load[top["u^2"]] = -10.0 * np.array([0.5, 0.5, 1.0, 1.0]) / 3.0
    load[top["u^1"]] = 2.0 * np.array([0.5, 0.5, 1.0, 1.0]) / 3.0
    return forms, basis.get_dofs("plate:bottom").all(), load


def test_contact_is_reduced_like_all_other_strength():
    """[X] Coulomb: the factor of a block is mu N / T = 2.5; elastic up to there, so a quarter of
    0.01 is the width.
    """
    forms, fixed, load = blocks()
    result = reduce(forms, fixed, load)
    assert result.reduced == ("joint",)
    assert result.bracket[0] <= 2.5 * (1 + 1e-3) and result.bracket[1] >= 2.5 * (1 - 1e-3)
    assert repr(result) == str(result)
    with pytest.raises(ValueError, match="nothing to reduce"):
        reduce(forms, fixed, load, exclude="joint")


def test_stall_is_no_collapse():
    """One iteration is too few on the way to the factor of 1.44: the warning says that no collapse
    was shown.
    """
    with pytest.warns(
        sc.AnalysisWarning, match=r"no collapse was shown: .* ended at .* stopped by stall"
    ) as caught:
        result = reduce(*slope(), newton=sc.Newton(tolerance=3e-4, max_iterations=1))
    assert [str(warning.message)[:11] for warning in caught] == ["no collapse"]
    assert result.factor < 1.4 and result.bracket[1] > 1.44


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"reduce": {"sand"}}, "no form or region 'sand'.*existing: all, soil"),
        ({"exclude": {"sand"}}, "no form or region 'sand'"),
        ({"flow": "davis"}, "flow must be one of 'given', 'associated'"),
        ({"tolerance": 0.0}, "must be positive"),
        ({"step": -1.0}, "must be positive"),
        ({"exclude": {"soil"}}, "nothing to reduce"),
        ({"exclude": "soil"}, "nothing to reduce"),  # one name, not four letters
        ({"reduce": "sand"}, "no form or region 'sand'"),
    ],
)
def test_bad_input(settings, message):
    with pytest.raises(ValueError, match=message):
        reduce(*slope(), **settings)


@pytest.mark.parametrize(
    ("load", "message"),
    [(None, "there is no load"), (np.zeros(3), "shape"), (0.0, "zero"), (np.nan, "NaN")],
)
def test_bad_load(load, message):
    forms, fixed, weight = slope()
    load = np.full_like(weight, load) if isinstance(load, float) else load
    with pytest.raises(ValueError, match=message):
        reduce(forms, fixed, load)


def test_elastic_body_has_nothing_to_reduce():
    forms, fixed, load = slope()
    elastic = {"soil": sc.SolidForm(forms["soil"].basis, sc.LinearElastic(E=1e4, nu=0.3))}
    with pytest.raises(ValueError, match="LinearElastic has no strength"):
        reduce(elastic, fixed, load, reduce={"all"})


@pytest.mark.parametrize(
    ("phi", "c", "exact"),
    [pytest.param(0.0, 25.0, 1.25, marks=pytest.mark.slow), (10.0, 20.0, 1.16298)],
)
def test_vertical_cut_without_tensile_strength(phi: float, c: float, exact: float) -> None:
    """[X] Drucker (1953): the face slides off behind a crack when gamma H = 2 c tan(45 + phi / 2),
    with the reduced strength; elements at the toe of H / 40 add 1 %.
    """
    steps = 0.05 * 1.4 ** np.arange(10)
    away = np.concatenate(([0.0], np.cumsum(steps)))
    up = np.append(away[away < 2.0][:-1], 2.0)
    mesh = MeshTri.init_tensor(
        np.concatenate((-away[:0:-1], away)), np.concatenate((-away[away < 2.0][:0:-1], up))
    )
    outside = mesh.elements_satisfying(lambda x: (x[0] < 0) & (x[1] > 0))
    basis = Basis(mesh.remove_elements(outside), ElementVector(ElementTriP2()), intorder=2)
    soil = sc.MohrCoulomb(E=1e4, nu=0.3, c=c, phi=phi, psi=phi, tension=0.0)
    model = sc.Model({"cut": sc.SolidForm(basis, soil, unit_weight=20.0)}, sc.box_supports(basis))
    found = model.strength_reduction(tolerance=0.02, certify=False, progress=False)
    assert found.stop.shows_limit
    assert exact < found.factor < 1.02 * exact
    assert found.iterations <= 150
    true = found.factor / exact - 1.0
    assert 0.5 * true < found.added < 2.0 * true


@pytest.mark.slow
@pytest.mark.parametrize("tolerance", [0.01, 0.02])
def test_vertical_cut_without_tensile_strength_on_tall_elements(tolerance: float) -> None:
    """[N] A linear programme on the same mesh gives 1.3187; elements at the face are 8 times as
    tall as wide, and much of the ground is without stress.
    """
    away = 0.0625 * np.cumsum(1.18 ** np.arange(17))
    x = np.append(np.linspace(-4.0, 0.0, 5), away)
    mesh = MeshTri.init_tensor(x, np.append(np.arange(-4.0, 0.0), np.linspace(0.0, 4.0, 9)))
    outside = mesh.elements_satisfying(lambda x: (x[0] < 0) & (x[1] > 0))
    basis = Basis(mesh.remove_elements(outside), ElementVector(ElementTriP2()), intorder=2)
    clay = sc.MohrCoulomb(E=1e5, nu=0.3, c=50.0, phi=0.0, tension=0.0)
    model = sc.Model({"cut": sc.SolidForm(basis, clay, unit_weight=20.0)}, sc.box_supports(basis))
    found = model.strength_reduction(tolerance=tolerance, certify=False, progress=False)
    assert found.stop.shows_limit
    assert found.factor == pytest.approx(1.3187, abs=0.5 * tolerance)
    true = found.factor / 1.25 - 1.0  # Drucker
    assert 0.5 * true < found.added < 2.0 * true
