"""Embedded beams: skin, foot, pull-out, rows, and what is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from skfem import (
    Basis,
    ElementHex1,
    ElementHexS2,
    ElementTriP2,
    ElementVector,
    MeshHex,
    MeshQuad,
    MeshQuad2,
    MeshTri,
    MeshTri2,
)

import skfem_contact as sc
from tests.tools.helpers import grid, vector_basis

QUIET = {"progress": False}
ELASTIC = sc.LinearElastic(E=3e4, nu=0.3)


def ground(n=2) -> Basis:
    mesh = MeshTri.init_tensor(
        np.linspace(-15.3, 15, 6 * n + 1), np.linspace(-20, 0, 5 * n + 1)
    ).with_defaults()
    return Basis(mesh, ElementVector(ElementTriP2()), intorder=2)


def pile(basis, T_max=20.0, F_max=60.0, **settings):
    """Pile of 10 m: model and load vector of a unit force down on its head."""
    beam = sc.Beam(None, np.linspace((0, 0), (0, -10), 11), EI=1e5, EA=3e6, GA=1e6)
    skin = sc.Embedded(basis, beam, T_max, F_max, **settings)
    forms = {"soil": sc.SolidForm(basis, ELASTIC), "pile": beam, "skin": skin}
    model = sc.Model(forms, sc.box_supports(basis))
    return model, model.forms["pile"].load((0.0, -1.0), at=(0.0, 0.0))


def test_skin_then_foot():
    """[X] The limit is that of the skin, 10 m of 20, and of the foot, 60: 260 on any mesh."""
    for n in (2, 3):
        model, load = pile(ground(n))
        found = model.limit_load(load, step=50.0, **QUIET)
        assert found.multiplier == pytest.approx(
            260.0, rel=1e-4
        )  # 2e-5 measured, of the search's tolerance
        assert found.stop.kind == "plateau"


def test_skin_that_jumps_within_an_element():
    """[X] The limit is the integral of the skin, 50 below 5.2 m, and of the foot: 300."""
    model, load = pile(ground(), T_max=lambda s: np.where(s < 5.2, 0.0, 50.0))
    found = model.limit_load(load, step=50.0, **QUIET)
    # a sample of the middle point, .0044 m, has .22 of the jump, and the search 2e-5
    assert found.multiplier == pytest.approx(300.0, rel=1e-3)


def test_balance_and_settlement():
    """[X] Skin and foot carry the load, within their resistances; settlements grow faster than the
    load.
    """
    model, load = pile(ground(), T_max=lambda s: 10.0 + 2.0 * s)
    result = model.run([sc.Stage("100", 100.0 * load), sc.Stage("180", 180.0 * load)], **QUIET)
    head = model.forms["pile"].numbers((0.0, 0.0))[1]
    for stage, force in zip(result, (100.0, 180.0), strict=True):
        state, form = stage.states["skin"], model.forms["skin"]
        weights = np.diff(np.linspace(0.0, 10.0, 11))[:, None] * np.array([5.0, 8.0, 5.0]) / 18.0
        assert -(weights.ravel() @ state.skin) - state.foot[0] == pytest.approx(force, rel=1e-6)
        assert (np.abs(state.skin) <= form.T_max * (1.0 + 1e-12)).all() and -60.0 <= state.foot[
            0
        ] <= 0.0
        forces = stage.section_forces("pile")
        assert forces.N[0] == pytest.approx(
            -force, rel=5e-3
        )  # the skin is taken as uniform in an element: 0.35 %
    assert result["180"].x[head] < 1.8 * result["100"].x[head] < 0.0
    # the points of an element stand for 5, 8 and 5 of its 18 parts, whose middles count
    middles = np.cumsum(weights) - 0.5 * weights.ravel()
    np.testing.assert_allclose(form.T_max, 10.0 + 2.0 * middles)


def test_row():
    """[X] Members 2.5 apart carry 2.5 times as much each: the same forces per metre, the same
    displacements.
    """
    one, load = pile(ground(), stiffness=1e5)
    alone = one.run([sc.Stage("load", 50.0 * load)], **QUIET)["load"]
    beam = sc.Beam(
        None, np.linspace((0, 0), (0, -10), 11), EI=2.5e5, EA=7.5e6, GA=2.5e6, spacing=2.5
    )
    forms = {
        "soil": sc.SolidForm(ground(), ELASTIC),
        "pile": beam,
        "skin": sc.Embedded(ground(), beam, 50.0, 150.0, stiffness=2.5e5),
    }
    model = sc.Model(forms, sc.box_supports(ground()))
    stage = model.run(
        [sc.Stage("load", model.forms["pile"].load((0.0, -50.0), at=(0.0, 0.0)))], **QUIET
    )["load"]
    np.testing.assert_allclose(stage.x, alone.x, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(
        stage.states["skin"].skin, 2.5 * alone.states["skin"].skin, rtol=1e-6
    )


def test_nail_is_pulled_out():
    """[X] T_max times the length, along any direction."""
    basis = ground()
    for end in ((5.4, -8.0), (4.0, -11.0)):
        way = np.array(end) - (0.4, -8.0)
        nail = sc.Beam(None, np.linspace((0.4, -8.0), end, 7), EI=10.0, EA=1e5, GA=1e3)
        forms = {
            "soil": sc.SolidForm(basis, ELASTIC),
            "nail": nail,
            "skin": sc.Embedded(basis, nail, T_max=15.0),
        }
        model = sc.Model(forms, sc.box_supports(basis), newton=sc.Newton(tolerance=1e-8))
        length = np.linalg.norm(way)
        pull = model.forms["nail"].load(-way / length, at=(0.4, -8.0))
        assert model.limit_load(pull, step=20.0, **QUIET).multiplier == pytest.approx(
            15.0 * length, rel=1e-5
        )


@pytest.mark.parametrize("T_max", [1e6, 40.0])
def test_skin_of_a_pile_with_a_bend_acts_along_each_part(T_max):
    """[X] A pile that moves through ground at rest: k times its motion along and across each part,
    up to T_max along it, and the resultant of both.
    """
    mesh = MeshQuad.init_tensor(np.linspace(-2.0, 3.0, 4), np.linspace(-5.0, 0.0, 4))
    basis = vector_basis(mesh.with_defaults(), "Q1", intorder=2)
    beam = sc.Beam(None, [(0, 0), (0, -1), (0, -2), (1, -3), (2, -4)], EI=1e4, EA=1e6)
    skin = sc.Embedded(basis, beam, T_max, stiffness=2e3)
    forms = {"soil": sc.SolidForm(basis, ELASTIC), "pile": beam, "skin": skin}
    model = sc.Model(forms, np.arange(basis.N))
    form = model.forms["skin"]
    motion = np.array([0.02, -0.03])
    x = np.zeros(model.layout.size)
    numbers = np.array([model.forms["pile"].numbers(point)[:2] for point in beam.points])
    x[numbers] = motion
    found = form.assemble(x, form.initial_state())
    resultant = np.zeros(2)
    for length, t, at in (
        (2.0, np.array([0.0, -1.0]), form.positions < 2.0),
        (np.sqrt(8.0), np.array([1.0, -1.0]) / np.sqrt(2.0), form.positions > 2.0),
    ):
        along = min(2e3 * float(motion @ t), T_max)
        across = 2e3 * (motion - (motion @ t) * t)
        np.testing.assert_allclose(found.state.skin[at][1:-1], -along, rtol=1e-9)
        np.testing.assert_allclose(
            form._lateral(x, found.state)[at][1:-1],
            [-across] * (at.sum() - 2),
            rtol=1e-9,
            atol=1e-9,
        )
        resultant += length * (along * t + across)
    force = np.zeros(model.layout.size)
    force[form.acts_on] = found.force
    np.testing.assert_allclose(force[numbers].sum(axis=0), resultant, rtol=1e-9)
    on_ground = force[: basis.N].reshape(-1, 2).sum(axis=0)
    np.testing.assert_allclose(on_ground, -resultant, rtol=1e-9)


def test_tangent_and_reset():
    """The tangent is the derivative, of points that stick and slip; displacements counted anew
    change nothing.
    """
    model, load = pile(ground())
    form = model.forms["skin"]
    rng = np.random.default_rng(0)
    for size in (1e-7, 1e-2):
        x = size * rng.standard_normal(model.layout.size)
        sc.testing.check_form(
            form, x, form.initial_state(), tolerance=1e-4
        )  # a share of 1e-6 is left where points slip
    result = model.run([sc.Stage("load", 200.0 * load)], **QUIET)
    again = model.run([sc.Stage("null", 200.0 * load)], start=result.reset(), **QUIET)["null"]
    assert np.abs(again.x).max() < 1e-6 * np.abs(result["load"].x).max()
    np.testing.assert_allclose(
        again.states["skin"].skin, result["load"].states["skin"].skin, rtol=1e-6, atol=1e-6
    )


def test_saved_and_resumed(tmp_path):
    """A second stage after loading the file is that of one run, to round-off."""
    model, load = pile(ground())
    stages = [sc.Stage("100", 100.0 * load), sc.Stage("220", 220.0 * load)]
    whole = model.run(stages, **QUIET)
    model.run(stages[:1], **QUIET).save(tmp_path / "pile")
    resumed = model.run(stages[1:], start=sc.load_result(tmp_path / "pile", model), **QUIET)
    np.testing.assert_allclose(resumed["220"].x, whole["220"].x, rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (
            lambda b, beam: sc.Embedded(b, sc.Beam(None, [(0, -19), (0, -21)], 1.0, 1.0), 5.0),
            r"leaves the mesh at \(0, -2.* joined_to",
        ),
        (lambda b, beam: sc.Embedded(b, beam, -1.0), "T_max must be a skin resistance"),
        (lambda b, beam: sc.Embedded(b, beam, lambda s: s[:2]), "T_max"),
        (lambda b, beam: sc.Embedded(b, beam, 1.0, -2.0), "F_max must not be negative"),
        (lambda b, beam: sc.Embedded(b, beam, 1.0, stiffness=0.0), "stiffness must be"),
        (lambda b, beam: sc.Embedded(b, sc.Beam(b, "top", 1.0, 1.0), 1.0), "is bonded"),
    ],
)
def test_bad_input(make, message):
    with pytest.raises(ValueError, match=message):
        make(ground(1), sc.Beam(None, [(0.0, -1.0), (0.0, -5.0)], EI=1.0, EA=1.0))


def test_without_ground_and_in_bounds():
    """No solid, bounds, and axial symmetry are refused by name."""
    basis = ground(1)
    beam = sc.Beam(None, [(0.0, -1.0), (0.0, -5.0)], EI=1.0, EA=1.0)
    with pytest.raises(ValueError, match="needs ground"):
        sc.Model({"beam": beam, "skin": sc.Embedded(basis, beam, 5.0)})
    model, _ = pile(basis)
    with pytest.raises(ValueError, match="no bounds with"):
        model.bounds(weight=20.0)
    half = ground(1).with_elements(lambda x: x[0] > 0.0)
    of_revolution = sc.SolidForm(half, ELASTIC, coordinates="axisymmetric")
    with pytest.raises(ValueError, match=r"embedded beams, .* have no other"):
        sc.Model({"soil": of_revolution, "beam": beam, "skin": sc.Embedded(basis, beam, 5.0)})


def in_space(side, fraction, pushed=False, T_max=1e6, F_max=1e6):
    """A quarter of a pile of 20 m and radius 0.4 m in elements of `side` beside it, settling or
    pushed along x.
    """
    away = side * np.array([0, 1, 2, 3, 4.6, 7.2, 11.3, 17.8])
    x = np.append(away[away < 40], 50.0)
    z = np.concatenate(
        (-50 + 30 * np.linspace(0, 1, 5) ** 0.6, -20 + 20 * np.linspace(0, 1, 9)[1:])
    )
    mesh = MeshHex.init_tensor(x, x, z).with_defaults()
    basis = Basis(mesh, ElementVector(ElementHexS2()), intorder=4)
    area, depth = np.pi * 0.4**2 * fraction, np.linspace(0, -20, 21)
    line = np.column_stack((0 * depth, 0 * depth, depth))
    E = 1e7 - 1e4
    beam = sc.Beam(
        None, line, EI=E * area * 0.04, EA=E * area, GA=4e6 * area, GJ=0.8 * E * area * 0.04
    )
    forms = {
        "soil": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3)),
        "pile": beam,
        "skin": sc.Embedded(basis, beam, T_max, F_max, radius=0.4),
    }
    sides = [
        basis.get_dofs(lambda x, c=c: np.isclose(abs(x[c]), 50.0)).all(f"u^{c + 1}") for c in (0, 1)
    ]
    planes = (
        ["u^2", "u^3"] if pushed else ["u^1"],
        ["u^2"],
    )  # a push is the opposite on the other side of its plane
    cut = [
        basis.get_dofs(lambda x, c=c: np.isclose(x[c], 0.0)).all(names)
        for c, names in enumerate(planes)
    ]
    names = ["u^2", "theta^1", "theta^3"] + (["u^3"] if pushed else ["u^1", "theta^2"])
    held = [dof for point in beam.points for dof in beam.dofs(point, names)]
    model = sc.Model(
        forms, [basis.get_dofs(lambda x: np.isclose(x[2], -50.0)).all(), *sides, *cut, *held]
    )
    return model, model.forms["pile"]


@pytest.mark.parametrize(("radius", "circle"), [(0.1, 0.5), (0.6, 0.6)])
def test_ground_around_a_shaft_is_in_series_with_the_skin(radius, circle):
    """[X] A pile that moves through ground at rest: springs ln(R / r) / (2 pi G) along the shaft,
    (3 - 4 nu) / (4 - 4 nu) of it across, and (1 - nu) / (4 G) (1 / r - 1 / R) at the foot.

    R is half an element, or the shaft. A mesh that ends at a plane of symmetry has half of it; at
    the edge of a pit the shaft has half of it, and the foot below the pit the whole.
    """
    E, nu, k = 2.6e3, 0.3, 4e3
    G = E / (2.0 * (1.0 + nu))
    around = np.log(circle / radius) / (2.0 * np.pi * G)
    below = (1.0 - nu) / (4.0 * G) * (1.0 / radius - 1.0 / circle)
    foot_length = 1.5
    y = np.arange(-3.0, 3.5)
    z = np.arange(-5.0, 0.5)
    whole = MeshHex.init_tensor(y, y, z)
    half = MeshHex.init_tensor(np.arange(0.0, 3.5), y, z)
    pit = whole.elements_satisfying(lambda x: (x[0] < 0.0) & (x[2] > -4.0))
    beside_pit = whole.remove_elements(pit)
    for mesh, start, part, part_of_foot in (
        (whole, 0.0, 1.0, 1.0),
        (half, 0.0, 0.5, 0.5),
        (beside_pit, -0.1, 0.5, 1.0),
    ):
        basis = vector_basis(mesh, "Q1", intorder=2)
        depths = start - np.array([0.0, 2.5, 2.5 + foot_length])
        beam = sc.Beam(None, [(0, 0, depth) for depth in depths], EI=1e6, EA=1e6)
        skin = sc.Embedded(basis, beam, T_max=1e6, F_max=1e6, stiffness=k, radius=radius)
        soil = sc.SolidForm(basis, sc.LinearElastic(E, nu))
        model = sc.Model({"soil": soil, "pile": beam, "skin": skin}, np.arange(basis.N))
        form = model.forms
        # Move the pile by .02 across and .03 down
        x = np.zeros(model.layout.size)
        for point in beam.points:
            x[form["pile"].numbers(point)[:3]] = 0.02, 0.0, -0.03
        found = form["skin"].assemble(x, form["skin"].initial_state())
        np.testing.assert_allclose(found.state.skin, -part * 0.03 / (1.0 / k + around), rtol=1e-9)
        at_foot = -part_of_foot * 0.03 / (1.0 / (k * foot_length) + below)
        assert found.state.foot[0] == pytest.approx(at_foot, rel=1e-9)
        across = form["skin"]._lateral(x, found.state)
        softer = (3.0 - 4.0 * nu) / (4.0 - 4.0 * nu) * around
        np.testing.assert_allclose(
            np.linalg.norm(across, axis=1), part * 0.02 / (1.0 / k + softer), rtol=1e-9
        )


@pytest.mark.slow
@pytest.mark.exhaustive
def test_pile_in_space_settles_like_a_solid_one():
    """[X] A solid pile of 1000 kN in a fine axisymmetric mesh settles by 9.32 mm: within 5 % in
    coarse elements.
    """
    found = []
    for side in (3.2, 1.6):
        model, form = in_space(side, 0.25)
        stage = model.run(
            [sc.Stage("load", form.load((0.0, 0.0, -250.0), (0.0, 0.0, 0.0)))], **QUIET
        )["load"]
        found.append(-1e3 * stage.x[form.numbers((0.0, 0.0, 0.0))[2]])
        assert stage.outputs("pile").lines[3].min() == pytest.approx(-250.0, rel=0.01)
    assert found == pytest.approx([9.32, 9.32], rel=0.05)
    assert found[0] == pytest.approx(found[1], rel=0.015)


@pytest.mark.slow
def test_pile_in_space_bends_like_a_solid_one():
    """[X] A solid pile under 100 kN at its head, in 54,000 dofs, moves by 4.74 mm; a quarter bears
    a quarter.
    """
    model, form = in_space(1.6, 0.25, pushed=True)
    stage = model.run([sc.Stage("push", form.load((25.0, 0.0, 0.0), (0.0, 0.0, 0.0)))], **QUIET)[
        "push"
    ]
    assert 1e3 * stage.x[form.numbers((0.0, 0.0, 0.0))[0]] == pytest.approx(4.74, rel=0.05)


@pytest.mark.slow
def test_limit_of_a_pile_in_space():
    """[X] A quarter of a pile: 20 m of skin with 10 kN/m and the foot with 30 kN."""
    model, form = in_space(3.2, 0.25, T_max=10.0, F_max=30.0)
    found = model.limit_load(form.load((0.0, 0.0, -1.0), (0.0, 0.0, 0.0)), step=50.0, **QUIET)
    assert found.multiplier == pytest.approx(230.0, rel=1e-3)


def test_bad_piles_in_space():
    mesh = MeshHex.init_tensor(*3 * [np.linspace(0.0, 2.0, 3)]).with_defaults()
    basis = Basis(mesh, ElementVector(ElementHexS2()), intorder=4)
    nail = sc.Beam(None, [[1.0, 1.0, 2.0], [1.0, 1.0, 0.5]], EI=1.0, EA=1.0)
    long = sc.Beam(None, [[1.0, 1.0, 2.0], [1.0, 1.0, -0.5]], EI=1.0, EA=1.0)
    with pytest.raises(ValueError, match="has a radius, not None"):
        sc.Embedded(basis, nail, T_max=1.0)
    with pytest.raises(ValueError, match=r"leaves the mesh at \(1, 1, -"):
        sc.Embedded(basis, long, T_max=1.0, radius=0.1)
    with pytest.raises(ValueError, match=r"has a radius, not 0\.1"):
        sc.Embedded(
            ground(),
            sc.Beam(None, np.linspace((0, 0), (0, -10), 11), EI=1e5, EA=3e6),
            T_max=1.0,
            radius=0.1,
        )


@pytest.mark.parametrize("kind", ["Tri", "Quad"])
def test_nail_in_a_mesh_of_second_order(kind):
    """[N] Elements whose sides have nodes in the middle, as Gmsh writes them, move a nail as linear
    ones do.
    """
    linear, second, element = {
        "Tri": (MeshTri, MeshTri2, "P2"),
        "Quad": (MeshQuad, MeshQuad2, "Q2"),
    }[kind]
    mesh = linear.init_tensor(np.linspace(0.0, 6.0, 7), np.linspace(0.0, 3.0, 4))
    heads = []
    for own in (mesh, second.from_mesh(mesh)):
        basis = vector_basis(own.with_defaults(), element, intorder=4)
        nail = sc.Beam(None, np.linspace((0.3, 1.6), (4.3, 2.1), 5), EI=10.0, EA=1e4)
        forms = {
            "soil": sc.SolidForm(basis, sc.LinearElastic(E=3e4, nu=0.3)),
            "nail": nail,
            "skin": sc.Embedded(basis, nail, T_max=15.0),
        }
        model = sc.Model(forms, basis.get_dofs("bottom").all())
        stage = model.run(
            [sc.Stage("pull", model.forms["nail"].load((-5.0, 0.0), (0.3, 1.6)))], **QUIET
        )["pull"]
        heads.append(stage.x[model.forms["nail"].numbers((0.3, 1.6))])
    np.testing.assert_allclose(heads[1], heads[0], rtol=1e-8)


def test_pile_softer_than_the_ground_is_refused():
    mesh = MeshHex.init_tensor(*(np.linspace(0.0, 4.0, 5),) * 3).with_defaults()
    basis = vector_basis(mesh, "S2", intorder=4)
    pile = sc.Beam(None, np.linspace((2.0, 2.0, 4.0), (2.0, 2.0, 1.0), 4), EI=1.0, EA=1e3)
    forms = {
        "soil": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3)),
        "pile": pile,
        "skin": sc.Embedded(basis, pile, T_max=1.0, radius=0.25),
    }
    with pytest.raises(
        ValueError, match=r"EA=1000 of the embedded beam is less than that of the ground .* 1963"
    ):
        sc.Model(forms, basis.get_dofs("bottom").all())


def test_units_of_length_of_a_pile_in_space():
    """[X] In metres and in millimetres its head moves by the same length, and springs around it
    have the same stiffness per length.
    """
    found = []
    for unit in (1.0, 1e3):
        mesh = MeshHex.init_tensor(*3 * [unit * np.linspace(0.0, 4.0, 5)]).with_defaults()
        basis = vector_basis(mesh, "Q1", intorder=2)
        line = unit * np.linspace((2.1, 2.2, 4.0), (2.1, 2.2, 2.0), 3)
        stiffness = {"EI": 1e4 * unit**4, "GJ": 1e4 * unit**4, "EA": 1e6 * unit**2}
        beam = sc.Beam(None, line, **stiffness)
        skin = sc.Embedded(basis, beam, T_max=1e9 * unit, F_max=1e9 * unit**2, radius=0.1 * unit)
        forms = {
            "soil": sc.SolidForm(basis, sc.LinearElastic(1e3, 0.3)),
            "pile": beam,
            "skin": skin,
        }
        model = sc.Model(forms, [sc.box_supports(basis), *beam.dofs(line[0], ["theta^3"])])
        pile = model.forms["pile"]
        push = pile.load((0.0, 0.0, -10.0 * unit**2), at=line[0])
        stage = model.run([sc.Stage("push", push)], **QUIET)["push"]
        found.append((stage.x[pile.numbers(line[0])[2]] / unit, model.forms["skin"]._k[0]))
    assert found[0][0] < -1e-3
    np.testing.assert_allclose(found[1], found[0], rtol=1e-6)


def test_turned_by_an_angle_in_space():
    """[X] Ground and a bent pile that are turned in space give the turned displacements, within
    1e-3: the points on the circles turn with the beam, whose axes across it have no direction.
    """
    turn = Rotation.from_euler("xyz", [0.4, 0.7, -1.1]).as_matrix()
    line = np.array([(1.2, 1.3, 3.8), (1.4, 1.5, 2.2), (1.5, 1.6, 0.8), (2.6, 2.2, 1.0)])
    force = np.array([4.0, 2.0, 6.0])
    found = []
    for R in (np.eye(3), turn):
        mesh = MeshHex.init_tensor(*3 * [np.linspace(0.0, 4.0, 5)]).with_defaults()
        mesh = MeshHex(R @ mesh.p, mesh.t, _boundaries=mesh.boundaries)
        basis = vector_basis(mesh, "Q1", intorder=2)
        points = line @ R.T
        beam = sc.Beam(None, points, EI=2e4, EA=1e6, GJ=1e4)
        skin = sc.Embedded(basis, beam, T_max=30.0, radius=0.3)
        soil = sc.SolidForm(basis, sc.LinearElastic(2e4, 0.3))
        model = sc.Model({"soil": soil, "pile": beam, "skin": skin}, basis.get_dofs("bottom").all())
        pull = model.forms["pile"].load(R @ force, at=points[0])
        x = model.run([sc.Stage("pull", pull)], **QUIET)["pull"].x
        found.append(R.T @ x[basis.nodal_dofs])
    straight, turned = found
    assert abs(turned - straight).max() < 1e-3 * abs(straight).max()


@pytest.mark.parametrize("slope", [0.0, 0.5])
def test_a_pile_alone_spins_about_its_axis(slope):
    """[X] One rotation that is held, anywhere, stops the spin of a raking pile without a moment.

    The message said that the beam is a mechanism.
    """
    mesh = MeshHex.init_tensor(*3 * [np.linspace(0.0, 4.0, 5)]).with_defaults()
    basis = vector_basis(mesh, "Q1", intorder=2)
    line = np.linspace((1.2, 1.3, 3.9), (1.2 + slope, 1.3, 0.9), 5)
    beam = sc.Beam(None, line, EI=2e4, EA=1e6)
    forms = {"soil": sc.SolidForm(basis, sc.LinearElastic(2e4, 0.3)), "pile": beam}
    forms["skin"] = sc.Embedded(basis, beam, T_max=30.0, radius=0.3)
    bottom = basis.get_dofs("bottom").all()
    with pytest.raises(ValueError, match=r"spins about its axis .* \*beam\.dofs\(.*theta\^3"):
        sc.Model(forms, bottom).run([sc.Stage("rest")], **QUIET)
    found = []
    for held in (line[0], line[-1]):
        model = sc.Model(forms, [bottom, *beam.dofs(held, ["theta^3"])])
        pile = model.forms["pile"]
        push = pile.load((3.0, 5.0, 0.0), at=line[0])
        stage = model.run([sc.Stage("push", push)], **QUIET)["push"]
        found.append(stage.x[pile.numbers(line[0])[:3]])
        assert abs(stage.reactions()[pile.numbers(held)[5]]) < 1e-9
    assert np.allclose(found[0], found[1], rtol=1e-9)


def winkler(length, m, EI, p_max=None, k=1e4, spacing=1.0):
    """Model of an upright pile of m elements in ground that does not move, springs of stiffness k
    per length.
    """
    mesh = MeshQuad.init_tensor(np.linspace(-1.0, 1.3, 3), np.linspace(-length - 1.0, 0.0, 8))
    basis = vector_basis(mesh.with_defaults(), "Q1", intorder=2)
    line = np.linspace((0.0, 0.0), (0.0, -length), m + 1)
    beam = sc.Beam(None, line, EI=EI, EA=1e8, GA=1e9, spacing=spacing)
    forms = {
        "soil": sc.SolidForm(basis, ELASTIC),
        "pile": beam,
        "skin": sc.Embedded(basis, beam, T_max=1e6, stiffness=k, p_max=p_max),
    }
    return sc.Model(forms, np.arange(basis.N))


@pytest.mark.parametrize("degrees", [35.0, -50.0, 90.0])
def test_deflections_of_an_inclined_pile(degrees):
    """[X] A pile that is turned with its force has the same deflections and resistances."""
    mesh = MeshQuad.init_tensor(np.linspace(-6.0, 6.0, 13), np.linspace(-6.0, 1.0, 8))
    basis = vector_basis(mesh.with_defaults(), "Q1", intorder=2)
    columns = ("deflection", "resistance", "share")
    found = []
    for angle in (0.0, np.radians(degrees)):
        along = np.array([np.sin(angle), -np.cos(angle)])
        line = np.linspace(0.0, 5.0, 11)[:, None] * along
        beam = sc.Beam(None, line, EI=4e4, EA=1e8, GA=1e9)
        skin = sc.Embedded(basis, beam, T_max=1e6, stiffness=1e4, p_max=30.0)
        forms = {"soil": sc.SolidForm(basis, ELASTIC), "pile": beam, "skin": skin}
        model = sc.Model(forms, np.arange(basis.N))
        force = 20.0 * np.array([np.cos(angle), np.sin(angle)]) + 7.0 * along
        push = model.forms["pile"].load(force, at=(0.0, 0.0))
        table = model.run([sc.Stage("push", push)], **QUIET)["push"].table("skin")
        found.append(np.array([table[name][table["kind"] == "p"] for name in columns]))
    assert np.abs(found[0][1]).max() > 5.0
    for upright, inclined in zip(*found, strict=True):
        np.testing.assert_allclose(inclined, upright, atol=1e-6 * np.abs(upright).max())


def test_deflections_and_resistances_of_a_long_pile():
    """[X] Hetenyi: y = 2 H b / k D(b s), p = k y, V = H C(b s), M = H / b B(b s) on springs.

    Elements of b h = 0.125; V is a mean of an element's, M at its ends.
    """
    H, k, EI, spacing = 100.0, 1e4, 4e4, 2.0
    model = winkler(20.0, 80, EI, k=k, spacing=spacing)
    push = model.forms["pile"].load((H / spacing, 0.0), at=(0.0, 0.0))
    stage = model.run([sc.Stage("push", push)], **QUIET)["push"]
    table = stage.table("skin")
    lateral = table["kind"] == "p"
    s, y, p = (table[name][lateral] for name in ("position", "deflection", "resistance"))
    b = (k / (4.0 * EI)) ** 0.25
    exact = 2.0 * H * b / k * np.exp(-b * s) * np.cos(b * s)
    np.testing.assert_allclose(y, exact, atol=2e-4 * exact.max())
    np.testing.assert_allclose(p, k * exact, atol=2e-4 * k * exact.max())
    forces = stage.section_forces("pile")
    s = forces.position
    M = H / b * np.exp(-b * s) * np.sin(b * s)
    np.testing.assert_allclose(abs(spacing * forces.M), abs(M), atol=5e-3 * M.max())
    V = H * np.exp(-b * s) * (np.cos(b * s) - np.sin(b * s))
    middle = V.reshape(-1, 2).mean(axis=1)
    found = spacing * forces.V.reshape(-1, 2).mean(axis=1)
    np.testing.assert_allclose(abs(found), abs(middle), atol=5e-3 * H)


def test_rows_of_the_table():
    """[X] Springs along the shaft and at the foot carry the load; shares are of the limits."""
    model, load = pile(ground(), p_max=1e3)
    stage = model.run([sc.Stage("load", 100.0 * load)], **QUIET)["load"]
    table = stage.table("skin")
    rows = {kind: table["kind"] == kind for kind in ("p", "t", "q")}
    np.testing.assert_allclose(
        table["resistance"][rows["t"]], -stage.states["skin"].skin, rtol=1e-12
    )
    assert table["resistance"][rows["q"]] == pytest.approx([-stage.states["skin"].foot[0]])
    assert table["position"][rows["q"]] == pytest.approx([10.0])
    head = stage.x[model.forms["pile"].numbers((0.0, 0.0))[1]]
    assert table["deflection"][rows["t"]][0] == pytest.approx(-head, rel=0.02)
    np.testing.assert_allclose(
        table["share"][rows["p"]], abs(table["resistance"][rows["p"]]) / 1e3, atol=1e-15
    )
    assert "ground across up to" in stage.outputs("skin").summary


@pytest.mark.parametrize("ground_moves", [False, True])
def test_lateral_limit_of_a_rigid_pile(ground_moves):
    """[X] A rigid pile turns about L / sqrt(2) under H = (sqrt(2) - 1) p L, in any ground.

    The springs next to this depth reach no limit in a search: 0.2 %.
    """
    if ground_moves:
        basis = ground()
        beam = sc.Beam(None, np.linspace((0, 0), (0, -10), 41), EI=1e8, EA=1e8, GA=1e8)
        skin = sc.Embedded(basis, beam, T_max=1e6, p_max=lambda s: 40.0 + 0.0 * s)
        forms = {"soil": sc.SolidForm(basis, ELASTIC), "pile": beam, "skin": skin}
        model = sc.Model(forms, sc.box_supports(basis))
    else:
        model = winkler(10.0, 40, 1e9, p_max=40.0)
    load = model.forms["pile"].load((1.0, 0.0), at=(0.0, 0.0))
    found = model.limit_load(load, step=20.0, **QUIET)
    assert found.stop.kind == "plateau"
    assert found.multiplier == pytest.approx((np.sqrt(2.0) - 1.0) * 400.0, rel=2e-3)


def test_tangent_of_lateral_limits():
    """[N] The tangent is the derivative where ground flows around a pile, in the plane and, with a
    direction that turns, in space; unloading begins with the first stiffness. In the plane the same
    points at their limits have one matrix.
    """
    rng = np.random.default_rng(0)
    for dim in (2, 3):
        if dim == 2:
            model = winkler(10.0, 4, 1e4, p_max=40.0)
        else:
            mesh = MeshHex.init_tensor(*3 * [np.linspace(0.0, 4.0, 4)]).with_defaults()
            basis = vector_basis(mesh, "Q1", intorder=2)
            line = np.linspace((2.1, 2.2, 4.0), (1.9, 2.0, 2.0), 3)
            beam = sc.Beam(None, line, EI=1e4, EA=1e6)
            skin = sc.Embedded(basis, beam, T_max=3.0, F_max=9.0, radius=0.1, p_max=2.0)
            forms = {"soil": sc.SolidForm(basis, sc.LinearElastic(1e3, 0.3)), "pile": beam}
            model = sc.Model(forms | {"skin": skin}, basis.get_dofs("bottom").all())
        form = model.forms["skin"]
        for size in (1e-5, 3e-2):
            x = size * rng.standard_normal(model.layout.size)
            sc.testing.check_form(form, x, form.initial_state(), tolerance=1e-4)
        known = [form.assemble(x, form.initial_state()).stiffness for _ in range(3)]
        assert (known[1] is known[2]) is (dim == 2)
        after = form.assemble(x, form.initial_state()).state
        used = np.linalg.norm(form._lateral(x, after), axis=1) / form.p_max
        assert used.max() == pytest.approx(1.0) and (used <= 1.0 + 1e-9).all()
        back = form.assemble(0.999 * x, after)
        used = np.linalg.norm(form._lateral(0.999 * x, back.state), axis=1) / form.p_max
        assert used.max() < 1.0


def test_wrong_lateral_limits():
    basis = ground(1)
    beam = sc.Beam(None, [(0.0, -1.0), (0.0, -5.0)], EI=1.0, EA=1.0)
    for wrong in (-1.0, np.nan, lambda s: s[:2]):
        with pytest.raises(ValueError, match="p_max"):
            sc.Embedded(basis, beam, 1.0, p_max=wrong)
    grid = sc.Reinforcement(None, [(0.0, -1.0), (0.0, -5.0)], EA=1.0)
    with pytest.raises(ValueError, match="leave out p_max"):
        sc.Embedded(basis, grid, 1.0, p_max=5.0)


def dug(pit: Basis, at: float, split: bool) -> tuple[sc.Model, list[sc.Stage]]:
    """A pile 7 long at x = `at` in ground 8 high, which is dug to 5 for x < 6 and then pressed.

    The pile is one beam, or split at the bottom of the pit, where its upper skin is deactivated.
    """
    forms = {
        name: sc.SolidForm(pit.with_elements(name), ELASTIC, unit_weight=18.0)
        for name in ("pit", "soil")
    }
    row = {"EI": 1e4, "EA": 1e6, "spacing": 2.0}
    gone = ("pit",)
    if split:
        lower = sc.Beam(None, np.linspace((at, 5), (at, 1), 5), **row)
        upper = sc.Beam(None, np.linspace((at, 8), (at, 5), 4), joined_to=lower, **row)
        forms |= {"lower": lower, "skin": sc.Embedded(pit, lower, T_max=50.0, F_max=100.0)}
        forms |= {"upper": upper, "skin above": sc.Embedded(pit, upper, T_max=50.0)}
        gone = ("pit", "skin above")
    else:
        beam = sc.Beam(None, np.linspace((at, 8), (at, 1), 8), **row)
        forms |= {"pile": beam, "skin": sc.Embedded(pit, beam, T_max=50.0, F_max=100.0)}
    load = sc.traction(pit, "right", (-5.0, 0.0))
    fixed = np.union1d(pit.get_dofs("bottom").all(), pit.get_dofs("left").all("u^1"))
    stages = [
        sc.Stage("weight"),
        sc.Stage("dig", deactivate=gone),
        sc.Stage("press", load),
    ]
    return sc.Model(forms, fixed), stages


def ground_with_pit(begin: float, element: str) -> Basis:
    """Ground of elements of length 1, whose part beyond x = `begin` and below 6 is a pit."""
    mesh = grid(element, np.linspace(0, 12, 13), np.linspace(0, 8, 9))
    x, y = mesh.p[:, mesh.t].mean(axis=1)
    gone = np.flatnonzero((begin < x) & (x < 6) & (y > 5))
    rest = np.setdiff1d(np.arange(mesh.nelements), gone)
    named = mesh.with_subdomains({"pit": gone, "soil": rest})
    return vector_basis(named, element, intorder=2)


@pytest.fixture
def pit() -> Basis:
    return ground_with_pit(0.0, "Q1")


@pytest.mark.parametrize("element", ["Q1", "P1", "P2", "QuadS2"])
@pytest.mark.parametrize(("begin", "at"), [(0.0, 4.3), (5.0, 5.3)])
def test_piles_stand_free_where_their_ground_is_dug_away(
    begin: float, at: float, element: str
) -> None:
    """[X] As if split at the bottom of the pit, with a skin above that is deactivated; the table
    has no forces there. In a slot one element wide all nodes stay in the ground.
    """
    pit = ground_with_pit(begin, element)
    model, stages = dug(pit, at, split=False)
    whole = model.run(stages, **QUIET)
    model, stages = dug(pit, at, split=True)
    parts = model.run(stages, **QUIET)
    for name in ("dig", "press"):
        # Both end where forces balance to 1e-8 of the load
        moved = np.abs(parts[name].x[: pit.N]).max()
        np.testing.assert_allclose(
            whole[name].x[: pit.N], parts[name].x[: pit.N], atol=1e-6 * moved
        )
        np.testing.assert_allclose(
            whole[name].section_forces("pile").M[-8:],
            parts[name].section_forces("lower").M,
            atol=1e-4,  # of up to 10
        )
        table = whole[name].table("skin")
        size = np.abs(table["resistance"])
        assert size[table["y"] > 5.0].max() < 1e-9  # round-off of projections
        assert size[table["y"] < 5.0].max() > 1.0


def test_piles_in_space_stand_free_in_a_shaft_one_element_wide():
    """[X] No skin acts on the ground around, all of whose nodes stay."""
    line = np.linspace(0, 3, 4)
    mesh = MeshHex.init_tensor(line, line, np.linspace(-4, 0, 5)).with_defaults()
    x, y, z = mesh.p[:, mesh.t].mean(axis=1)
    shaft = (abs(x - 1.5) < 0.1) & (abs(y - 1.5) < 0.1) & (z > -2.0)
    mesh = mesh.with_subdomains({"shaft": np.flatnonzero(shaft), "soil": np.flatnonzero(~shaft)})
    basis = Basis(mesh, ElementVector(ElementHex1()), intorder=2)
    pile = sc.Beam(None, np.linspace((1.5, 1.5, 0.0), (1.5, 1.5, -3.5), 8), EI=1e4, EA=1e6)
    forms = {
        "shaft": sc.SolidForm(basis.with_elements("shaft"), ELASTIC),
        "soil": sc.SolidForm(basis.with_elements("soil"), ELASTIC),
        "pile": pile,
        "skin": sc.Embedded(basis, pile, T_max=50.0, radius=0.2),
    }
    twist = pile.dofs((1.5, 1.5, 0.0), ["theta^3"])
    model = sc.Model(forms, [basis.get_dofs("bottom").all(), *twist])
    head = model.forms["pile"].load((1.0, 0.0, -5.0), at=(1.5, 1.5, 0.0))
    stages = [sc.Stage("dug", deactivate="shaft"), sc.Stage("press", head)]
    table = model.run(stages, **QUIET)["press"].table("skin")
    size = np.abs(table["resistance"])
    assert size[table["z"] > -2.0].max() < 1e-9  # round-off of projections
    assert size[table["z"] < -2.0].max() > 1.0


def test_piles_beside_a_pit_stay_in_the_ground(pit: Basis) -> None:
    """[X] On the side of a pit the nodes beyond it have no share in the points of the pile."""
    model, stages = dug(pit, 6.0, split=False)
    table = model.run(stages, **QUIET)["press"].table("skin")
    above = table["resistance"][(table["y"] > 5.0) & (table["kind"] == "t")]
    assert above.all()


def test_piles_that_stand_free_are_resumed_from_files(pit: Basis, tmp_path: Path) -> None:
    """[X] A stage after loading the file is that of one run, to round-off."""
    model, stages = dug(pit, 4.3, split=False)
    whole = model.run(stages, **QUIET)
    model.run(stages[:2], **QUIET).save(tmp_path / "dug")
    start = sc.load_result(tmp_path / "dug", model)
    resumed = model.run(stages[2:], start=start, **QUIET)
    np.testing.assert_allclose(resumed["press"].x, whole["press"].x, rtol=1e-9, atol=1e-12)
    modes = [
        sc.Model(model.forms, model.fixed, gravity_acceleration=9.81).frequencies(1, start=last)
        for last in (start, whole["dig"])
    ]
    np.testing.assert_allclose(modes[0], modes[1], rtol=1e-9)


def test_ground_that_returns_to_a_pile_needs_a_new_skin(pit: Basis) -> None:
    """The first point is named; another Embedded begins without force."""
    model, stages = dug(pit, 4.3, split=False)
    filled = sc.Stage("fill", activate="pit")
    with pytest.raises(ValueError, match=r"stage 'fill': 'skin': ground returns .* \(4.3, 7.88"):
        model.run([*stages[:2], filled], **QUIET)
    skin = sc.Embedded(pit, model.forms["pile"], T_max=50.0)
    again = sc.Model({**model.forms, "again": skin}, model.fixed)
    filled = sc.Stage("fill", activate=("pit", "again"), deactivate="skin")
    table = again.run([*stages[:2], filled], **QUIET)["fill"].table("again")
    assert table["resistance"][table["y"] > 5.0].any()
