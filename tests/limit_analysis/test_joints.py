"""Bounds of bodies with joints between them."""

from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np
import pytest
from skfem import (
    Basis,
    ElementTriP2,
    ElementVector,
    MeshTri,
)

import skfem_contact as sc
from skfem_contact.limit_analysis import certify, search
from skfem_contact.limit_analysis.reading import _strong
from skfem_contact.limit_analysis.strength import Strength
from skfem_contact.solvers.superlu import SuperLU
from tests.fuzz import joints
from tests.fuzz.blocks import Stack
from tests.tools.scenes import sliding_blocks


@pytest.mark.parametrize("rigid", [False, True])
def test_bounds_of_a_smooth_joint_without_pardiso(rigid, monkeypatch):
    """Blocks on a slope that nothing holds without friction: no safe estimate, and no failure of
    the factor.
    """
    monkeypatch.setattr("skfem_contact.limit_analysis.elements.as_engine", SuperLU)
    drawn = Stack(1.25, (0.42,), (0.57,), float(np.radians(24.5)), "nodal")
    for name, value, tolerance in joints.bounds(drawn, True, "given", rigid):
        assert value <= tolerance, name


@pytest.mark.parametrize("gap", [0.0, 1e-4, 1e-3, 4e-3])
def test_a_joint_is_closed_or_refused(gap: float) -> None:
    """[X] A block slides at .5 * 100 + 2.5 * 4 = 60; sides that do not coincide after matching are
    refused.
    """
    strong = sc.MohrCoulomb(1e5, 0.3, c=1000.0, phi=20.0, psi=20.0)
    forms, fixed = sliding_blocks(gap, strong, strong, sc.Coulomb(mu=0.5, adhesion=2.5))
    given = {
        "weight": {"block": 25.0},
        "tractions": {"block:left": (1.0, 0.0)},
        "live": "block:left",
        "gap": 0.05,
        "elements": 120,
        "progress": False,
    }
    if gap > 5e-4:
        with pytest.raises(ValueError, match="of a facet apart"):
            sc.Model(forms, fixed).bounds(**given)
        return
    found = sc.Model(forms, fixed).bounds(**given)
    assert found.lower <= 60 * (1 + 1e-12) and found.upper >= 60 * (1 - 1e-12)
    assert any("associated flow" in remark for remark in found.remarks)


@pytest.mark.parametrize("c", [1000.0, 150.0, 15.0])
def test_a_rigid_block_on_soil(c: float) -> None:
    """[X] A rigid block on soil of any usual strength slides at (.4 * 151.2 + 2 * 4.2) / 1.5 =
    45.92.

    Weight and load are up to 3 times the cohesion of the soil. The ground's boundary goes on beside
    the block, whose edges are singular: without fans there the first stresses of weak soil are a
    third too low.
    """
    ground = MeshTri.init_tensor(np.linspace(0, 9, 8), np.linspace(-3, 0, 4)).with_defaults()
    block = MeshTri.init_tensor(np.linspace(2.1, 6.3, 6), np.linspace(0, 1.5, 3)).with_defaults()
    basis = Basis(
        sc.join_bodies({"ground": ground, "block": block}),
        ElementVector(ElementTriP2()),
        intorder=2,
    )
    soil = sc.MohrCoulomb(1e5, 0.3, c=c, phi=20.0, psi=20.0)
    forms = {
        "ground": sc.SolidForm(basis.with_elements("ground"), soil),
        "block": sc.SolidForm(basis.with_elements("block"), sc.LinearElastic(1e7, 0.2)),
        "joint": sc.ContactPair(basis, "block:bottom", "ground:top", sc.Coulomb(0.4, adhesion=2.0)),
    }
    sides = basis.get_dofs({"ground:left", "ground:right"}).all("u^1")
    model, exact = (
        sc.Model(forms, [basis.get_dofs("ground:bottom").all(), sides]),
        (0.4 * 151.2 + 2.0 * 4.2) / 1.5,
    )
    found = model.bounds(
        weight={"ground": 18.0, "block": 24.0},
        tractions={"block:left": (1.0, 0.0)},
        live="block:left",
        gap=0.03,
        elements=100,
        progress=False,
    )
    assert (
        found.lower <= exact * (1 + 1e-12)
        and found.upper >= exact * (1 - 1e-12)
        and found.gap < 0.03
    )
    assert sum(one.iterations for one in found.history[:2]) < 40


def block_on_clay(c: float, block_law: sc.Material) -> sc.Model:
    """A block of 2 m on clay, with a joint of mu = .5 and an adhesion of 2, on the least mesh."""
    ground = MeshTri.init_tensor(np.linspace(0, 6, 7), np.linspace(-2, 0, 3)).with_defaults()
    block = MeshTri.init_tensor(np.linspace(2, 4, 3), np.linspace(0, 2, 3)).with_defaults()
    basis = Basis(
        sc.join_bodies({"ground": ground, "block": block}),
        ElementVector(ElementTriP2()),
        intorder=2,
    )
    materials = {"ground": sc.Tresca(1e4, 0.3, c), "block": block_law}
    forms = {
        "bodies": sc.SolidForm(basis, materials),
        "joint": sc.ContactPair(basis, "block:bottom", "ground:top", sc.Coulomb(0.5, adhesion=2.0)),
    }
    return sc.Model(forms, basis.get_dofs("ground:bottom").all())


@pytest.mark.parametrize("c", [200.0, 50.0])
def test_a_rigid_block_slides_on_clay(c: float) -> None:
    """[X] On clay as well, which rests while the block slides at (.5 * 96 + 2 * 2) / 2 = 26. The
    least mesh proves it from above, within the accuracy of the solver.
    """
    found = block_on_clay(c, sc.LinearElastic(1e6, 0.2)).bounds(
        weight={"ground": 20.0, "block": 24.0},
        tractions={"block:left": (1.0, 0.0)},
        live="block:left",
        gap=0.1,
        elements=90,
        progress=False,
    )
    assert found.lower <= 26.0 * (1 + 1e-12)
    assert 26.0 * (1 - 1e-12) <= found.upper < 26.0 * (1 + 1e-5)


@pytest.mark.parametrize("c", [100.0, 500.0])
def test_a_block_of_clay_slides_on_clay(c: float) -> None:
    """[X] Under a push of 10 the factor is (.5 * 96 + 2 * 2) / (2 * 10) = 2.6. Neither side of the
    joint changes its volume, and the accuracy is that of the first mesh.
    """
    found = block_on_clay(200.0, sc.Tresca(1e4, 0.3, c)).bounds(
        weight={"ground": 20.0, "block": 24.0},
        tractions={"block:left": (10.0, 0.0)},
        flow="associated",
        elements=200,
        progress=False,
    )
    assert 2.6 * (1 - 3e-4) < found.lower <= 2.6 * (1 + 1e-12)
    assert 2.6 * (1 - 1e-12) <= found.upper < 2.6 * (1 + 3e-4)


def test_velocities_that_refute_nothing_are_corrected_with_one_factor(monkeypatch) -> None:
    """Bodies at rest refute nothing, with either lack of opening; the matrix of the corrections is
    the same.
    """
    given = []

    def prove(program, solution, live):
        given.append((program, solution))
        return certify.prove_upper(program, solution, live)

    monkeypatch.setattr(search, "prove_upper", prove)
    load = {"weight": {"ground": 20.0, "block": 24.0}, "tractions": {"block:left": (1.0, 0.0)}}
    block_on_clay(200.0, sc.LinearElastic(1e6, 0.2)).bounds(
        **load, live="block:left", gap=0.1, elements=90, progress=False
    )
    program, solution = given[0]
    factored = []
    factor = program.factor

    def counted(metric):
        factored.append(metric)
        return factor(metric)

    monkeypatch.setattr(program, "factor", counted)
    rest = replace(solution, velocity=0.0 * solution.velocity, inner=[])
    assert certify.prove_upper(program, rest, True).value == np.inf
    assert len(factored) == 1


@pytest.mark.filterwarnings("ignore:the bounds:skfem_contact.AnalysisWarning")
def test_no_bound_is_begun_when_time_is_over(monkeypatch) -> None:
    """But for the safe one, on the mesh of the best lower bound. Each bound takes a second here."""
    clock = []
    take = search.Search._found

    def found_in_a_second(*given):
        clock.append(1.0)
        return take(*given)

    monkeypatch.setattr(search.Search, "_found", found_in_a_second)
    monkeypatch.setattr(search, "process_time", lambda: sum(clock))
    model = block_on_clay(50.0, sc.Tresca(1e4, 0.3, 500.0))
    found = model.bounds(
        weight={"ground": 20.0, "block": 24.0},
        tractions={"block:left": (10.0, 0.0)},
        gap=1e-3,
        seconds=5.5,
        progress=False,
    )
    *before, safe = found.history
    assert before[-1].cpu == 6.0
    best = max((one for one in before if one.kind == "lower"), key=lambda one: one.value)
    assert safe.kind == "lower" and safe.elements == best.elements


def test_a_foot_beside_a_support() -> None:
    """Velocities without jumps cannot leave a support: where contact ends at one, it is named."""
    ground = MeshTri.init_tensor(np.linspace(0, 6, 13), np.linspace(-1, 0, 5)).with_defaults()
    wall = MeshTri.init_tensor(np.linspace(-0.3, 0, 2), np.linspace(-1, 0, 5)).with_defaults()
    basis = Basis(
        sc.join_bodies({"ground": ground, "wall": wall}), ElementVector(ElementTriP2()), intorder=2
    )
    soil = sc.MohrCoulomb(1e5, 0.3, c=1.0, phi=30.0, psi=30.0)
    forms = {
        "ground": sc.SolidForm(basis.with_elements("ground"), soil),
        "wall": sc.SolidForm(basis.with_elements("wall"), sc.LinearElastic(1e7, 0.2)),
        "joint": sc.ContactPair(basis, "wall:right", "ground:left", sc.Coulomb(mu=0.0)),
    }
    sides = basis.get_dofs("ground:right").all("u^1")
    fixed = [basis.get_dofs("ground:bottom").all(), basis.get_dofs("wall:bottom").all("u^2"), sides]
    with pytest.warns(
        sc.AnalysisWarning, match=r"no upper bound .*: contact ends at a support at \(0, -1\)"
    ):
        sc.Model(forms, fixed).bounds(
            weight={"ground": 20.0},
            tractions={"wall:left": (1.0, 0.0)},
            live="wall:left",
            gap=0.5,
            elements=150,
            progress=False,
        )


def plug_between_walls() -> sc.Model:
    """Plug of clay on a soft pad, between rough walls whose joints have no adhesion."""
    up = np.append([-0.5, -0.25], np.linspace(0, 1, 5))
    sides = {
        "left": lambda x: (x[0] < 1e-9) & (x[1] > 0),
        "right": lambda x: (x[0] > 1 - 1e-9) & (x[1] > 0),
        "bottom": lambda x: x[1] < -0.5 + 1e-9,
        "top": lambda x: x[1] > 1 - 1e-9,
    }
    block = MeshTri.init_tensor(np.linspace(0, 1, 5), up).with_boundaries(sides)
    block = block.with_subdomains({"pad": lambda x: x[1] < 0, "plug": lambda x: x[1] > 0})
    wall = MeshTri.init_tensor(np.linspace(-0.5, 0, 2), np.linspace(0, 1.5, 7)).with_defaults()
    mesh = sc.join_bodies({"block": block, "west": wall, "east": wall.translated((1.5, 0.0))})
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    clay = {"block:plug": sc.Tresca(1e4, 0.3, c=10.0), "block:pad": sc.Tresca(1e3, 0.3, c=0.05)}
    forms = {"block": sc.SolidForm(basis.with_elements("block"), clay)}
    for name, side, face in (("west", "left", "right"), ("east", "right", "left")):
        forms[name] = sc.SolidForm(basis.with_elements(name), sc.LinearElastic(1e6, 0.0))
        forms[side] = sc.ContactPair(
            basis,
            f"block:{side}",
            f"{name}:{face}",
            sc.Coulomb(mu=0.6),
            "nodal",
            penalty=(1e6, 1e6),
        )
    return sc.Model(
        forms, [basis.get_dofs(name).all() for name in ("west:left", "east:right", "block:bottom")]
    )


PRESSED = {
    "tractions": {"block:top": (0.0, -1.0)},
    "live": "block:top",
    "gap": 0.1,
    "elements": 150,
    "progress": False,
}


def test_joints_that_open_as_they_slip() -> None:
    """A plug jams between rough walls if joints open by mu times their slip, and falls at .300 in
    contact: a remark.
    """
    model = plug_between_walls()
    found = model.bounds(**PRESSED)
    limit = model.limit_load(model.traction("block:top", (0.0, -1.0)), step=0.2, progress=False)
    assert limit.multiplier == pytest.approx(0.300, abs=0.002) and found.lower > 10.0
    # without friction the pad alone carries: its lower bound on this mesh is a third of its limit
    assert found.estimate and 0.1 < found.safe < limit.multiplier and "safe 0.1" in str(found)
    assert any(
        "joints left, right open by mu times their slip" in remark for remark in found.remarks
    )


def test_earlier_stresses_prove_a_bound_where_the_last_ones_leave_the_strength(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """[B] At joints without adhesion the last of more iterations cannot be balanced within the
    strength: the bound is nearly the solver's objective.
    """
    monkeypatch.setattr(search, "_FIRST", 1e-4)
    first = plug_between_walls().bounds(**PRESSED).history[0]
    assert first.kind == "lower"
    # the objective lies within the accuracy, 1e-4
    assert first.value == pytest.approx(first.solver, rel=1e-4)


@pytest.mark.filterwarnings("ignore:the bounds:skfem_contact.AnalysisWarning")
def test_a_stack_that_topples_has_a_lower_bound() -> None:
    """[X] Pushed blocks that lift off a joint: most of its stress is zero, and little may be moved
    there to reach equilibrium.
    """
    seed = 900007
    case = joints.joints(seed, np.random.default_rng(seed))
    checks = {check.oracle: check for check in case.look()}
    assert "gap" in checks
    assert all(check.error <= check.tolerance for check in checks.values())


def test_joints_without_adhesion_have_no_safe_bound():
    """[X] Two blocks on a slope slide at mu / tan(9.7 degrees) = 2.28: bounds, though smooth joints
    resist nothing.
    """
    drawn = Stack(0.98, (0.97, 0.51), (0.39, 0.47), np.radians(9.7), "nodal")
    found = {check.oracle: check for check in joints.bounds(drawn, False, "given", False)}
    assert found["ordered"].error == 0.0
    assert (
        found["lower"].error < 1e-9 and found["upper"].error < 1e-9 and found["safe"].error == -1.0
    )


@pytest.mark.slow
def test_a_wall_that_is_much_stronger_than_clay() -> None:
    """[B] A wall of concrete as Tresca, 500 times as strong: nearly the bounds of a rigid one, and
    what would help.
    """
    mesh = MeshTri.init_tensor(np.r_[0:10:6j, 10.5:20:6j], np.linspace(-10, 0, 11))
    x, y = mesh.p[:, mesh.t].mean(axis=1)
    mesh = mesh.restrict(np.flatnonzero((x < 10.5) | (y < -3)))
    wall = lambda x: (abs(x[0] - 10.25) < 0.25) & (x[1] > -6)  # noqa: E731
    mesh = mesh.with_subdomains({"wall": wall, "clay": lambda x: ~wall(x)})
    basis, found = Basis(mesh, ElementVector(ElementTriP2()), intorder=2), []
    for concrete in (sc.LinearElastic(E=3e7, nu=0.2), sc.Tresca(E=3e7, nu=0.2, c=1e4)):
        materials = {"wall": concrete, "clay": sc.Tresca(E=1e4, nu=0.3, c=20.0)}
        model = sc.Model(
            {"all": sc.SolidForm(basis, materials, unit_weight=20.0)}, sc.box_supports(basis)
        )
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            found.append(model.bounds(gap=0.1, elements=600, progress=False))
    rigid, strong = found
    assert (
        strong.upper == pytest.approx(rigid.upper, rel=0.02) and strong.lower > 0.75 * rigid.lower
    )
    assert "much stronger than the rest would be rigid, and bounds closer: wall" in str(
        caught[-1].message
    )


def test_strength_that_is_much_larger_counts_the_pressure() -> None:
    """[X] c + t p: 1, 1 + 2 * 100 and 250 beside 1 as a bound; what never yields is left out."""
    soil = Strength(
        c=np.array([1.0, 1.0, 250.0, np.inf]),
        t=np.array([0.0, 2.0, 0.0, 0.0]),
        tension=np.full(4, np.inf),
        reduced=np.ones(4, bool),
    )
    strong = _strong(soil, 100.0, np.arange(4))
    assert strong.tolist() == [False, True, True, False]
    assert not _strong(soil, 10.0, np.arange(4))[1]
