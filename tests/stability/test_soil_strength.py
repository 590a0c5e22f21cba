"""Factors of safety and limit loads under bad conditions: extreme soils, steps and tolerances,
units, turned axes.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve
from skfem import Basis, ElementTriP2, ElementVector

import skfem_contact as sc
from skfem_contact.collapse.result import CollapseResult
from skfem_contact.results import Result
from tests.oracles import slopes
from tests.tools.helpers import analysis, grid, rotation, traction, vector_basis
from tests.tools.infinite_slope import BETA, DEPTH, GAMMA, infinite_slope
from tests.tools.slope_meshes import held, reduced_slope, slope_mesh

SOIL = {"E": 1e5, "nu": 0.3, "c": 10.0, "phi": 20.0}


@cache
def on_a_slope(psi: float, **settings) -> CollapseResult:
    """A coarse slope on a foundation."""
    return reduced_slope(
        slope_mesh(20.0, 12.0, 5.0, 15.0, 3), sc.MohrCoulomb(**SOIL, psi=psi), **settings
    )


@pytest.fixture(scope="module", params=[20.0, 0.0], ids=["associated", "psi = 0"])
def usual(request) -> tuple[float, float]:
    """The dilatancy and the factor by default settings."""
    return request.param, on_a_slope(request.param).factor


@pytest.mark.slow
@pytest.mark.parametrize(
    ("phi", "psi", "c", "nu"),
    [
        (50.0, 50.0, 1.0, 0.3),
        (50.0, 0.0, 1.0, 0.3),
        (45.0, 45.0, 1e-6, 0.3),
        (45.0, 0.0, 1e-6, 0.3),
        (40.0, 40.0, 0.0, 0.499),
        (40.0, 0.0, 0.0, 0.499),
        (0.0, 0.0, 30.0, 0.499),
    ],
)
# next to no cohesion: all points flow at once, no force depends on the factor then, and the search
# tells a stall
@pytest.mark.filterwarnings("ignore:no collapse was shown")
def test_extreme_soils_on_an_infinite_slope(phi, psi, c, nu):
    """[X] Cases S4, S5: factors of case H13, those of Davis with psi = 0; the lowest row of
    elements is 1 % high.
    """
    exact = slopes.infinite_slope(BETA, c, phi, GAMMA, DEPTH)
    if psi == 0.0:
        exact = slopes.without_dilatancy(exact, phi)
    _, forms, fixed, load = infinite_slope(sc.MohrCoulomb(E=1e4, nu=nu, c=c, phi=phi, psi=psi))
    result = sc.Model(forms, fixed).strength_reduction(load, progress=False, tolerance=0.002)
    assert result.factor == pytest.approx(exact, rel=0.005)


@pytest.mark.parametrize("psi", [25.0, 0.0])
def test_sand_just_below_and_above_its_limit(psi):
    """[X] Case S6: without cohesion an infinite slope stands at 0.999 of its strength, and
    collapses at 1.001.
    """
    exact = slopes.infinite_slope(BETA, 0.0, 25.0, GAMMA, DEPTH)
    exact = exact if psi else slopes.without_dilatancy(exact, 25.0)
    for share in (0.999, 1.001):
        sand = sc.MohrCoulomb(E=1e4, nu=0.3, c=0.0, phi=25.0, psi=psi).reduced(share * exact)
        _, forms, fixed, load = infinite_slope(sand)
        stages = [sc.Stage("weight", load)]
        if share < 1.0:
            result = sc.Model(forms, fixed).run(stages, progress=False)
            assert result["weight"].fraction == 1.0 and result["weight"].residual < 1e-8
        else:  # all loads are alike without cohesion: not even the smallest increment stands
            with pytest.raises(
                sc.NotConverged, match=r"'weight' stopped at 0.00% of its load: collapse"
            ):
                sc.Model(forms, fixed).run(stages, progress=False)


@pytest.mark.slow
@pytest.mark.parametrize("step", [1e-6, 1e3])
def test_steps_far_too_small_or_large(usual, step):
    """[X] Case S21: a first step of 1e-6 or 1000; the curves end up to 0.0025 below their
    plateaus.
    """
    psi, factor = usual
    assert on_a_slope(psi, step=step).factor == pytest.approx(factor, abs=0.004)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-4, 1e-6])
def test_tolerance_of_equilibrium(tolerance):
    """[X] Case S21: less than 0.5 % from 1e-3 to 1e-6."""
    factor = on_a_slope(20.0).factor
    assert on_a_slope(20.0, newton=sc.Newton(tolerance, 30)).factor == pytest.approx(
        factor, rel=0.002
    )


@pytest.mark.parametrize("length", [1e-6, 1e6])
@pytest.mark.parametrize("force", [1e-6, 1e6])
def test_units(length, force):
    """[X] Cases K7, S3: other units of length and force, the same factor; round-off alone
    differs.
    """
    mesh = slope_mesh(20.0, 12.0, 5.0, 15.0, 3)
    stress = force / length**2
    own = sc.MohrCoulomb(E=1e5 * stress, nu=0.3, c=10.0 * stress, phi=20.0, psi=20.0)
    result = reduced_slope(
        replace(mesh, doflocs=length * mesh.doflocs), own, 20.0 * force / length**3
    )
    assert result.factor == pytest.approx(on_a_slope(20.0).factor, abs=1e-6)


def test_turned_axes():
    """[X] Case S18: a slope on a base that holds everything, and gravity, at 37 degrees."""
    mesh = slope_mesh(20.0, 12.0, 5.0, 15.0, 3)
    found = []
    for degrees in (0.0, 37.0):
        basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
        fixed = held(basis)
        fixed = np.union1d(fixed - fixed % 2, fixed - fixed % 2 + 1)
        turned = Basis(
            replace(mesh, doflocs=rotation(degrees) @ mesh.doflocs), basis.elem, intorder=2
        )
        load = sc.weight(turned, 20.0, tuple(rotation(degrees) @ [0.0, -1.0]))
        forms = {"soil": sc.SolidForm(turned, sc.MohrCoulomb(**SOIL, psi=20.0))}
        found.append(sc.Model(forms, fixed).strength_reduction(load, progress=False).factor)
    assert found[1] == pytest.approx(found[0], abs=1e-6)


@pytest.mark.filterwarnings("ignore:the structure is unstable")
def test_tension_at_the_crest():
    """[X] Without tensile strength a slope is less safe, with a cut-off above the apex as safe as
    without any.
    """
    mesh = slope_mesh(5.0, 12.0, 0.0, 0.0, 5)
    plain, high, none = (
        reduced_slope(
            mesh, sc.MohrCoulomb(E=1e5, nu=0.3, c=20.0, phi=20.0, psi=20.0, tension=t)
        ).factor
        for t in (None, 1e3, 0.0)
    )
    assert high == pytest.approx(plain, abs=1e-6)
    assert 0.5 * plain < none < plain - 0.005


def test_soil_torn_from_all_sides():
    """[X] Hydrostatic tension beyond the apex: the stress stays there, and unloading is elastic."""
    basis = vector_basis(grid("P2", np.linspace(0, 1, 4), np.linspace(0, 1, 4)), "P2")
    forms = {"soil": sc.SolidForm(basis, sc.MohrCoulomb(E=1e4, nu=0.3, c=1.0, phi=30.0, psi=30.0))}
    x = 1e-2 * basis.doflocs[np.arange(basis.N) % 2, np.arange(basis.N)]
    edge = basis.get_dofs().all()
    step = sc.Model(forms, edge).run([sc.Stage("torn", basis.zeros(), x)], progress=False)["torn"]
    apex = 1.0 / np.tan(np.radians(30.0))
    np.testing.assert_allclose(step.states["soil"].stress[:3], apex, rtol=1e-9)
    np.testing.assert_allclose(step.states["soil"].stress[3], 0.0, atol=1e-9)
    back = sc.Model(forms, edge).run(
        [sc.Stage("back", basis.zeros(), 0.999 * x)], start=Result((step,)), progress=False
    )["back"]
    assert (back.states["soil"].stress[:3] < apex - 1e-3).all()  # unloading is elastic


@pytest.mark.slow
def test_slivers():
    """[X] Case S8: a row of elements fifty times longer than high through the middle of a clay
    block of strength 2 c.

    The block spreads between smooth plates; the stress is uniform whatever the elements.
    """
    heights = [0.0, 0.3, 0.5, 0.502, 0.7, 1.0]
    for element in ("P2", "Q1"):
        result = analysis("limit_load", *block(element, heights, 0.0), progress=False)
        assert result.multiplier == pytest.approx(20.0, rel=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("contrast", [1e-4, 1e-3, 1e4])
def test_stiffness_of_a_layer(contrast):
    """[X] Case K7: a foundation up to 1e4 times softer or stiffer: collapse loads are
    rigid-plastic.

    If it is so soft that its own weight sinks it by a hundred metres, that may be too much at once:
    then the advice is to load it in stages, not that it collapses.
    """
    regions = {"upper": lambda x: x[1] > 0, "lower": lambda x: x[1] < 0}
    mesh = slope_mesh(20.0, 12.0, 5.0, 15.0, 3).with_subdomains(regions)
    upper = sc.MohrCoulomb(**SOIL, psi=20.0)
    try:
        result = reduced_slope(
            mesh, {"upper": upper, "lower": replace(upper, E=contrast * upper.E)}
        )
    except sc.NotConverged as error:
        assert contrast == 1e-4 and "no collapse either; put the load on in stages" in str(error)
    else:
        assert result.factor == pytest.approx(
            on_a_slope(20.0).factor, abs=0.004
        )  # both curves end early


def block(element: str, heights, phi: float):
    """Forms, fixed unknowns and a unit pressure on a block (c = 10) that spreads between smooth
    plates.
    """
    basis = vector_basis(
        grid(element, np.linspace(0, 1, 11), np.asarray(heights)), element, intorder=2
    )
    soil = sc.MohrCoulomb(E=1e3, nu=0.3, c=10.0, phi=phi, psi=phi)
    forms = {"soil": sc.SolidForm(basis, soil, "b_bar" if element == "Q1" else "full")}
    fixed = np.hstack([basis.get_dofs("bottom").all("u^2"), basis.get_dofs("left").all("u^1")])
    return forms, fixed, traction(basis, "top", (0.0, -1.0))


@pytest.mark.slow
@pytest.mark.parametrize("share", [0.5, 1.0])
def test_all_points_flow_at_once(share):
    """[X] A block under 2 c, or half of that: beyond its factor the stiffness is singular:
    collapse.
    """
    forms, fixed, load = block("Q1", np.linspace(0, 1, 5), 0.0)
    result = sc.Model(forms, fixed).strength_reduction(20.0 * share * load, progress=False)
    low, high = result.bracket
    assert result.stop.kind == "collapse" and high - low <= 0.01  # tol
    assert low - 1e-4 <= 1.0 / share <= high  # equilibrium within 0.03 of tol


@pytest.mark.parametrize("step", [1e-6, 1e3])
@pytest.mark.parametrize("begun", [False, True])
def test_limit_load_by_bad_steps(step, begun):
    """[X] A column that bears 2 c tan(45 + phi/2) = 20 sqrt(3), also from half of that; 0.03 *
    0.005 of it is left.
    """
    forms, fixed, load = block("Q1", np.linspace(0, 1, 4), 30.0)
    start = (
        sc.Model(forms, fixed).run([sc.Stage("half", 10 * np.sqrt(3) * load)], progress=False)
        if begun
        else None
    )
    result = sc.Model(forms, fixed).limit_load(load, start=start, step=step, progress=False)
    # where all flows at once the load is bracketed by `tol` = .005
    assert result.multiplier == pytest.approx((10 if begun else 20) * np.sqrt(3), rel=5e-3)


def test_unsymmetric_stiffness_of_soil_and_friction():
    """[X] Case S22: sand with psi = 0 that slides on a rough base: the solver gets the whole,
    unsymmetric matrix.
    """
    basis = vector_basis(grid("Q1", np.linspace(0, 2, 7), np.linspace(0, 1, 4)), "Q1", intorder=2)
    sand = sc.MohrCoulomb(E=1e4, nu=0.3, c=4.0, phi=30.0, psi=0.0)
    base = sc.rigid.line((-1.0, 0.0), (3.0, 0.0))
    forms = {
        "sand": sc.SolidForm(basis, sand, "b_bar"),
        "base": sc.ContactPair(basis, "bottom", base, sc.Coulomb(mu=0.3), "nodal", penalty=1e6),
    }
    fixed = basis.get_dofs("left").all("u^1")
    x = basis.zeros()
    x[fixed] = 0.02
    stages = [
        sc.Stage("weight", sc.weight(basis, 20.0)),
        sc.Stage("pushed", sc.weight(basis, 20.0), x, increments=4),
    ]
    skew = []

    def direct(A, b):
        skew.append(abs(A - A.T).max() / abs(A).max())
        return spsolve(A.tocsc(), b)

    own = sc.Model(forms, fixed, solver=direct).run(stages, progress=False)["pushed"]
    usual = sc.Model(forms, fixed).run(stages, progress=False)["pushed"]
    assert max(skew) > 0.01 and "yielded" in usual.summary["sand"]
    np.testing.assert_allclose(
        own.x, usual.x, atol=1e-6 * np.abs(usual.x).max()
    )  # Newton's 1e-8 of the force
    slid = usual.tractions("base")
    assert abs((slid.weight * slid.shear).sum()) == pytest.approx(0.3 * 40.0, rel=1e-6)
