"""Searches end at a limit, or say why they have found none."""

from __future__ import annotations

import warnings
from contextlib import nullcontext

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve
from skfem import (
    Basis,
    ElementQuad1,
    ElementQuad2,
    ElementTriP2,
    ElementVector,
    FacetBasis,
    LinearForm,
    MeshQuad,
    MeshTri,
)

import skfem_contact as sc
from tests.oracles.fixed_factors import enclosed_factor
from tests.tools.helpers import analysis, grid
from tests.tools.scenes import pit


def supported(mesh):
    """Basis of quadratic triangles, and supports of the base and the sides."""
    x, y = mesh.p
    mesh = mesh.with_boundaries(
        {
            "base": lambda p: p[1] < y.min() + 1e-9,
            "sides": lambda p: (p[0] < x.min() + 1e-9) | (p[0] > x.max() - 1e-9),
        }
    )
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    return basis, np.append(basis.get_dofs("base").all(), basis.get_dofs("sides").all("u^1"))


@pytest.mark.parametrize(("phi", "limit"), [(20.0, 0.5949), (40.0, 1.3716)])
def test_slope_without_cohesion(phi, limit):
    """[N] Points without pressure have no strength: the bracket holds what cohesions of 0.1 and
    0.01 tend to.
    """
    flat = MeshTri.init_tensor(np.linspace(0, 1, 13), np.linspace(0, 1, 5))
    height = 10 - 10 * np.clip((30 * flat.p[0] - 10) / 15, 0, 1) + 5
    basis, fixed = supported(MeshTri(np.stack((30 * flat.p[0], height * flat.p[1])), flat.t))
    forms = {"slope": sc.SolidForm(basis, sc.MohrCoulomb(E=1e5, nu=0.3, c=0.0, phi=phi, psi=phi))}
    with pytest.warns(sc.AnalysisWarning, match="unstable") if limit < 1.0 else nullcontext():
        found = sc.Model(forms, fixed).strength_reduction(sc.weight(basis, 20.0), progress=False)
    assert found.stop.kind == "collapse"
    assert found.bracket[0] < limit + 1e-4 and limit - 1e-4 < found.bracket[1] < 1.01 * limit


def steep(psi):
    """10 m of soil at 45 degrees, 5 m of ground below the toe, phi = 40 and little cohesion."""
    x = np.concatenate(
        (np.arange(0, 15, 3.75), 15 + np.linspace(0, 10, 5), 25 + np.linspace(0, 15, 5)[1:])
    )
    flat = MeshQuad.init_tensor(x, np.concatenate(([0, 3, 5], 5 + np.linspace(0, 10, 5)[1:])))
    surface = 5 + np.clip((flat.p[0] - 15) / 10, 0, 1) * 10
    y = np.where(flat.p[1] > 3, 3 + (flat.p[1] - 3) / 12 * (surface - 3), flat.p[1])
    basis, fixed = supported(MeshQuad(np.array([flat.p[0], y]), flat.t).to_meshtri(style="x"))
    forms = {"ground": sc.SolidForm(basis, sc.MohrCoulomb(E=5e4, nu=0.3, c=5.0, phi=40.0, psi=psi))}
    return forms, fixed, sc.weight(basis, 19.0)


@pytest.mark.slow
@pytest.mark.exhaustive
@pytest.mark.filterwarnings("ignore:no collapse was shown")
def test_factor_without_dilatancy_is_enclosed():
    """[X] Radenkovic: no flow exceeds the associated factor, which follows from that of Davis."""
    free = analysis("strength_reduction", *steep(0.0), tolerance=0.005, progress=False)
    associated = analysis("strength_reduction", *steep(40.0), tolerance=0.005, progress=False)
    low, high = free.bracket
    assert high - low > 1e-6
    assert free.davis.factor < low
    assert enclosed_factor(*steep(0.0))[0] <= high
    # one soil: the bound is the associated factor; each curve may rise by a quarter of 0.005, 1.3
    # times that is left
    assert high == pytest.approx(associated.bracket[1], abs=0.005)
    assert f"{free.davis.value:.4g} after Davis" in str(free)


def test_limit_load_that_stalls_says_what_helps():
    """A strip footing, phi = 30 and psi = 0, one iteration a step: nothing is known above, the
    flows are named.
    """
    mesh = grid("P2", np.linspace(0, 6, 10), np.linspace(-3, 0, 5)).with_boundaries(
        {"foot": lambda p: (p[1] > -1e-9) & (p[0] < 1.4)}
    )
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    bottom = basis.get_dofs(lambda p: p[1] < -3 + 1e-9).all()
    fixed = np.append(
        bottom, basis.get_dofs(lambda p: (p[0] < 1e-9) | (p[0] > 6 - 1e-9)).all("u^1")
    )
    load = LinearForm(lambda v, w: -v[1]).assemble(FacetBasis(mesh, basis.elem, facets="foot"))
    forms = {"soil": sc.SolidForm(basis, sc.MohrCoulomb(E=1e4, nu=0.3, c=1.0, phi=30.0, psi=0.0))}
    with pytest.warns(sc.AnalysisWarning, match=r"psi < phi .* flow='davis_b' or 'lagged'"):
        found = sc.Model(forms, fixed, newton=sc.Newton(1.5e-4, 1)).limit_load(load, progress=False)
    assert found.stop.kind == "stall" and found.bracket[1] == np.inf
    assert sum(step.iterations for step in found.steps if step.outcome == "stall") <= 150 + 1


QUIET = {"progress": False}


def test_bar_that_yields_is_a_collapse():
    """[X] A guided block on one bar of strength 10 under a reference load of 3: 10 / 3, with both
    ends closed.
    """
    basis = Basis(MeshQuad().refined(1).with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    bar = sc.Bar(basis, (0.0, 1.0), (0.0, 3.0), EA=1e3, fixed_end=True, yield_force=10.0)
    block = sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.0))
    load = basis.zeros()
    load[basis.get_dofs("bottom").all("u^2")] = -1.0
    found = sc.Model({"block": block, "bar": bar}, basis.get_dofs().all("u^1")).limit_load(
        load, progress=False
    )
    assert found.stop.kind == "collapse"
    assert found.bracket[0] <= 10 / 3 * (1 + 1e-9) and found.bracket[1] >= 10 / 3 * (
        1 - 1e-9
    )  # Newton's tolerance
    assert found.bracket[1] - found.bracket[0] < 0.005 * 10 / 3


def test_flat_piece_before_the_last_bar_yields_is_no_limit():
    """[X] A guided block on bars of strength 10 and 1; the second one is soft, and adds its tenth
    170 times as far.
    """
    basis = Basis(MeshQuad().refined(1).with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    bars = {
        f"bar {x:g}": sc.Bar(basis, (x, 1.0), (x, 3.0), EA, fixed_end=True, yield_force=most)
        for x, EA, most in ((0.0, 1e5, 10.0), (1.0, 60.0, 1.0))
    }
    block = sc.SolidForm(basis, sc.LinearElastic(E=1e7, nu=0.0))
    load = basis.zeros()
    load[basis.get_dofs("bottom").all("u^2")[0]] = -1.0
    found = sc.Model({"block": block, **bars}, basis.get_dofs().all("u^1")).limit_load(
        load, progress=False
    )
    assert found.stop.kind == "collapse"
    assert found.bracket[0] <= 11.0 * (1 + 1e-9) and found.bracket[1] >= 11.0 * (
        1 - 1e-9
    )  # Newton's tolerance
    assert found.multiplier == pytest.approx(11.0, rel=0.005)


@pytest.mark.parametrize(
    "n, ask",
    [
        (20, lambda model, load: model.strength_reduction(load, progress=False)),
        (8, lambda model, load: model.limit_load(load, tolerance=0.02, progress=False)),
    ],
    ids=["factor of safety", "limit load"],
)
@pytest.mark.parametrize("wrong, message", [(np.nan, "not finite"), (1e30, "are no solution")])
def test_linear_solver_that_fails_is_no_collapse(n, ask, wrong, message):
    """A solver that returns NaN or nonsense after some calls: no collapse was shown, it says."""
    mesh = MeshTri.init_tensor(np.linspace(0, 2, 5), np.linspace(-1, 0, 3)).with_defaults()
    mesh = mesh.with_boundaries({"foot": lambda x: (x[1] > -1e-9) & (x[0] < 0.51)})
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    soil = sc.SolidForm(basis, sc.MohrCoulomb(E=1e4, nu=0.3, c=10.0, phi=20.0, psi=20.0))
    calls = []

    def solver(A, b):
        calls.append(1)
        return spsolve(A.tocsc(), b) if len(calls) <= n else np.full(len(b), wrong)

    model = sc.Model({"soil": soil}, sc.box_supports(basis), solver=solver)
    load = sc.traction(basis, "foot", (0.0, -60.0))
    with pytest.warns(sc.AnalysisWarning, match="no collapse was shown"):
        assert ask(model, load).stop.kind == "stall"
    with pytest.raises(sc.NotConverged, match=message):
        model.is_stable(load)


def test_search_from_a_start_without_the_footing():
    """The form that the start does not hold is named; activated in a stage, Prandtl's load
    follows.
    """
    mesh = MeshQuad.init_tensor(np.linspace(-4, 4, 17), np.linspace(-3, 0, 7)).to_meshtri()
    mesh = mesh.with_boundaries({"footing": lambda x: (x[1] > -1e-9) & (abs(x[0]) < 1 + 1e-9)})
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    clay = sc.SolidForm(basis, sc.Tresca(E=1e4, nu=0.45, c=20.0), unit_weight=18.0)
    footing = sc.RigidBoundary(basis, "footing")
    start = sc.Model({"clay": clay}, sc.box_supports(basis)).gravity_state()
    model, load = (
        sc.Model({"clay": clay, "footing": footing}, sc.box_supports(basis)),
        footing.load((0, -1), at=(0, 0)),
    )
    with pytest.raises(
        ValueError, match=r"the start does not hold \['footing'\]: activate them in a stage"
    ):
        model.limit_load(load, start=start, step=20.0, **QUIET)
    placed = model.run([sc.Stage("footing", activate="footing")], start=start, **QUIET)
    found = model.limit_load(load, start=placed, step=20.0, **QUIET)
    assert (
        2 + np.pi < found.multiplier / 40.0 < 6.2
    )  # from above, with four elements below the footing


def test_search_from_a_cut_that_is_released_in_part():
    """[X] Half of the forces of a pit still hold its sides: a search says so, and not where all are
    released.
    """
    model, _, _ = pit()
    weight = sc.Stage("weight")
    settings = {"tolerance": 0.2, "certify": False, **QUIET}
    half = model.run([weight, sc.Stage("half", deactivate="pit", release=0.5)], **QUIET)
    whole = model.run([weight, sc.Stage("dug", deactivate="pit")], **QUIET)
    with pytest.warns(sc.AnalysisWarning, match=r"the start holds back \d+% of its load"):
        held = model.strength_reduction(start=half, **settings).factor
    with pytest.warns(sc.AnalysisWarning) as told:
        free = model.strength_reduction(start=whole, **settings).factor
    assert held > 1.1 * free and not any("holds back" in str(warning.message) for warning in told)


@pytest.mark.slow
def test_limit_load_on_a_material_that_refuses_increments():
    """Clay that hardens under a footing: the search ends, whatever increments the clay refuses, and
    says how.
    """
    mesh = MeshQuad.init_tensor(np.linspace(0, 10, 6), np.linspace(-6, 0, 5)).with_defaults()
    mesh = mesh.with_boundaries({"foot": lambda x: (x[1] > -1e-9) & (x[0] < 2.1)})
    basis = Basis(mesh, ElementVector(ElementQuad2()), intorder=4)
    clay = sc.CamClay(kappa=0.02, lambda_=0.1, M=1.2, nu=0.25, p_ref=50.0, attraction=1.0)
    model = sc.Model({"clay": sc.SolidForm(basis, clay, unit_weight=18.0)}, sc.box_supports(basis))
    with pytest.warns(sc.AnalysisWarning, match="no collapse was shown"):
        found = model.limit_load(
            sc.traction(basis, "foot", (0.0, -1.0)), start=model.k0_state(K0=0.6), **QUIET
        )
    assert found.multiplier > 100.0


@pytest.mark.slow
@pytest.mark.parametrize(("intorder", "shown"), [(2, True), (3, False), (4, True)])
def test_rule_with_a_negative_weight_is_named(intorder, shown):
    """[N] A stiff foot on sand: the search ends on a plateau with three and with six points, and
    stalls at a fifth of the load with four, of which one has a negative weight; a warning says so.
    """
    x = np.r_[np.linspace(0, 1, 6), 1 + 7 * np.linspace(0, 1, 11)[1:] ** 1.5]
    mesh = MeshTri.init_tensor(x, np.r_[-5 * np.linspace(1, 0, 11) ** 1.5, 0.5])
    middle = mesh.p[:, mesh.t].mean(axis=1)
    mesh = mesh.remove_elements(np.flatnonzero((middle[1] > 0) & (middle[0] > 1)))
    mesh = mesh.with_boundaries(
        {
            "left": lambda x: x[0] < 1e-9,
            "right": lambda x: x[0] > 8 - 1e-9,
            "bottom": lambda x: x[1] < -5 + 1e-9,
            "top": lambda x: x[1] > 0.5 - 1e-9,
        }
    ).with_subdomains({"foot": lambda x: x[1] > 0, "sand": lambda x: x[1] < 0})
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=intorder)
    sand = sc.MohrCoulomb(E=3e4, nu=0.3, c=0.01, phi=30.0, psi=30.0)
    ground = sc.SolidForm(
        basis,
        {"foot": sc.LinearElastic(3e7, 0.2), "sand": sand},
        unit_weight={"foot": 0.0, "sand": 20.0},
    )
    model = sc.Model({"ground": ground}, sc.box_supports(basis))
    load = model.traction("top", (0.0, -1.0))
    start = model.gravity_state(K0=0.5)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        found = model.limit_load(load, start=start, step=10.0, progress=False)
    assert found.stop.shows_limit is shown
    assert (300.0 < found.multiplier < 450.0) is shown
    told = [str(w.message) for w in caught if "negative weight" in str(w.message)]
    assert bool(told) is not shown
    if told:
        assert "no collapse was shown" in told[-1] and "ground: its rule of quad" in told[-1]
        assert "intorder=2" in told[-1]


def test_rule_with_a_negative_weight_in_a_stage():
    """[X] Points that yield with it are warned of in a stage, too; elastic ones are not."""
    mesh = MeshTri().refined(1).with_defaults()
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=3)
    soil = sc.SolidForm(basis, sc.Tresca(1e3, 0.3, c=10.0), unit_weight=0.0)
    top = basis.get_dofs("top").all("u^2")
    model = sc.Model({"soil": soil}, [basis.get_dofs("bottom").all(), top])
    for pressed, told in ((0.001, 0), (0.04, 1)):
        moved = basis.zeros()
        moved[top] = -pressed
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            result = model.run([sc.Stage("press", prescribed=moved)], progress=False)
        assert sum("negative weight" in text for text in result[-1].remarks) == told
