"""Solids of finite kinematics: tangent, objectivity, cycles, refusals."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy import ndarray
from skfem import (
    Basis,
    Element,
    ElementHex1,
    ElementHex2,
    ElementQuad1,
    ElementQuad2,
    ElementTetP2,
    ElementTriP1,
    ElementTriP2,
    ElementVector,
    Mesh,
    MeshHex,
    MeshQuad,
    MeshTet,
    MeshTri,
)

import skfem_contact as sc
from skfem_contact.errors import IncrementTooLarge
from skfem_contact.results.export import grid
from tests.tools.helpers import counted

LAWS: dict[str, Any] = {
    "elastic": sc.LinearElastic(E=100.0, nu=0.3),
    "tresca": sc.Tresca(E=100.0, nu=0.3, c=1.0),
    "mohr": sc.MohrCoulomb(E=100.0, nu=0.3, c=1.0, phi=30.0, psi=10.0),
}
ELEMENTS: list[tuple[Mesh, Element, int, str]] = [
    (MeshQuad().refined(1), ElementQuad1(), 2, "plane"),
    (MeshTri().refined(1), ElementTriP1(), 2, "plane"),
    (MeshTri().refined(1), ElementTriP2(), 4, "plane"),
    (MeshQuad(), ElementQuad2(), 4, "plane"),
    (MeshQuad(), ElementQuad2(), 4, "axisymmetric"),
    (MeshQuad().refined(1), ElementQuad1(), 2, "axisymmetric"),
    (MeshHex(), ElementHex1(), 2, "space"),
    (MeshHex(), ElementHex2(), 4, "space"),
    (MeshTet(), ElementTetP2(), 4, "space"),
]
#: Round-off of numbers of two.
EPS = 2.0 * float(np.finfo(float).eps)
SQUARE = Basis(MeshQuad(), ElementVector(ElementQuad1()), intorder=2)


def finite(basis: Basis, law: Any, strain: Any = None, **options: Any) -> sc.SolidForm:
    """Solid of finite kinematics."""
    return sc.SolidForm(basis, law, strain, kinematics="finite", **options)


def linear(basis: Basis, F: ndarray) -> ndarray:
    """Displacements of a uniform gradient."""
    dim = len(F)
    x = np.zeros(basis.N)
    for i in range(dim):
        x[i::dim] = (F[i] @ basis.doflocs - basis.doflocs[i])[i::dim]
    return x


def rotation(angle: float) -> ndarray:
    """Rotation in the plane by radians."""
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


def followed(form: sc.SolidForm, gradients: Any, state: Any = None) -> Any:
    """State after a sequence of uniform gradients."""
    state = form.initial_state() if state is None else state
    for F in gradients:
        state = form.assemble(linear(form.basis, F), state).state
    return state


#: Elements, and those that F-bar is for.
MEASURES = [(k, "full") for k in range(len(ELEMENTS))] + [(0, "f_bar"), (5, "f_bar"), (6, "f_bar")]


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize(("case", "strain"), MEASURES)
def test_tangent(case: int, strain: Any, law: str) -> None:
    """[N] The tangent is the derivative of the force, of turned and strained bodies that yield."""
    mesh, element, order, coordinates = ELEMENTS[case]
    rng = np.random.default_rng(case)
    dim = mesh.dim()
    basis = Basis(
        mesh.translated((1.0,) + (0.0,) * (dim - 1)), ElementVector(element), intorder=order
    )
    form = finite(basis, LAWS[law], strain, coordinates=coordinates)
    turn = np.linalg.qr(rng.normal(size=(dim, dim)))[0]
    turn[:, 0] *= np.linalg.det(turn)
    if coordinates == "axisymmetric":
        turn = np.eye(2)
    first = linear(basis, turn) + 0.02 * rng.normal(size=basis.N)
    state = form.assemble(first, form.initial_state()).state
    x = first + 0.01 * rng.normal(size=basis.N)
    direction = 1e-6 * rng.normal(size=basis.N)
    K = form.assemble(x, state).stiffness
    change = form.assemble(x + direction, state).force - form.assemble(x - direction, state).force
    error = np.linalg.norm(2.0 * K @ direction - change) / np.linalg.norm(change)
    # differences of step 1e-6 keep 1e-9, beside a corner of the yield surface 8e-9
    assert error < 1e-8
    symmetric = abs(K - K.T).max() <= 1e-12 * abs(K).max()
    assert symmetric == (strain == "full" and law != "mohr")
    assert form.symmetric == symmetric


OBJECTIVE: dict[str, tuple[Any, float, float]] = {
    "elastic": (LAWS["elastic"], 1.0, 0.0),
    "tresca": (sc.Tresca(E=100.0, nu=0.3, c=3.0), 1.0, 0.0),
    "mohr": (LAWS["mohr"], 0.3, 0.0),
    "drucker": (sc.DruckerPrager(E=100.0, nu=0.3, alpha=0.2, k=1.0), 0.3, 0.0),
    "mises": (sc.VonMises(E=100.0, nu=0.3, strength=1.0), 0.3, 0.0),
    "undrained": (sc.Undrained(LAWS["mohr"], nu_undrained=0.49), 0.1, 0.0),
    "hardening": (
        sc.HardeningSoil(
            phi=30.0,
            psi=5.0,
            c=1.0,
            E50_ref=1e4,
            Eoed_ref=1e4,
            Eur_ref=3e4,
            p_ref=100.0,
            m=0.5,
            G0_ref=5e4,
            gamma_07=1e-4,
        ),
        0.02,
        -100.0,
    ),
    "adp": (sc.NgiAdp.from_ratios(20.0, 0.7, 0.4, 500.0, 0.01, 0.02, 0.04), 0.02, 0.0),
}


@pytest.mark.parametrize("name", OBJECTIVE)
def test_objectivity(name: str) -> None:
    """[X] A strained body that turns by 770 degrees and is strained on has turned stresses."""
    law, size, pressure = OBJECTIVE[name]
    form = finite(SQUARE, law, "full")
    start = np.zeros((4, 1, 4))
    start[:3] = pressure
    first = np.eye(2) + size * np.array([[0.2, 0.1], [0.05, -0.1]])
    last = np.eye(2) + size * np.array([[0.3, 0.2], [0.05, -0.2]])
    loading = [np.eye(2) + share * (first - np.eye(2)) for share in np.linspace(0.1, 1.0, 10)]
    straight = followed(form, [*loading, last], form.initial_state(stress=start))

    whole = np.deg2rad(770.0)
    turning = [rotation(share * whole) @ first for share in np.linspace(0.0, 1.0, 15)[1:]]
    path = [*loading, *turning, rotation(whole) @ last]
    turned = followed(form, path, form.initial_state(stress=start))

    xx, yy, zz, xy = form.cauchy(straight)[:, 0, 0]
    R = rotation(whole)
    expected = R @ np.array([[xx, xy], [xy, yy]]) @ R.T
    found = form.cauchy(turned)[:, 0, 0]
    error = np.abs(found - [expected[0, 0], expected[1, 1], zz, expected[0, 1]]).max()
    size_of_stress = np.abs(found).max()

    # Gradients that differ by the round-off of displacements of twice the size, of a body that does
    # not turn: no method of 16 digits knows the stress better
    rng = np.random.default_rng(0)
    spread = 0.0
    for _ in range(10):
        path = [F + rng.uniform(-EPS, EPS, (2, 2)) for F in [*loading, *[first] * 14, last]]
        other = followed(form, path, form.initial_state(stress=start))
        spread = max(spread, np.abs(form.cauchy(other)[:, 0, 0] - [xx, yy, zz, xy]).max())
    assert error < max(1e-13 * size_of_stress, 2.0 * spread)
    # stresses of soils are a thousandth of their stiffness, or less
    assert spread < 5e-12 * size_of_stress


def test_closed_cycles_leave_no_stress() -> None:
    """[X] An elastic body has no stress after ten cycles of strain and rotation."""
    A, B = np.array([[0.3, 0.5], [0.0, 0.2]]), np.array([[0.0, 0.6], [-0.3, -0.2]])
    angles = np.linspace(0.0, 2.0 * np.pi, 11)[1:]
    cycle = [np.eye(2) + 0.5 * (np.cos(t) - 1.0) * A + 0.5 * np.sin(t) * B for t in angles]
    state = followed(finite(SQUARE, LAWS["elastic"]), cycle * 10)
    # round-off of 100 increments
    assert np.abs(state.stress).max() < 1e-13 * 100.0


@pytest.mark.parametrize("strain", ["full", "f_bar"])
def test_simple_shear_of_a_perfectly_plastic_body(strain: Any) -> None:
    """[X] The shear stress is the cohesion up to a shear of 6, whatever rotates."""
    form = finite(SQUARE, sc.Tresca(E=298.0, nu=0.49, c=1.0), strain)
    shears = np.linspace(0.0, 6.0, 121)[1:]
    state = followed(form, [np.array([[1.0, g], [0.0, 1.0]]) for g in shears])
    # strains are elastic by 1 / 200, which turns principal axes
    assert form.cauchy(state)[3] == pytest.approx(1.0, abs=1e-3)


def test_uniaxial_stretch() -> None:
    """[X] Hencky's body: axial Cauchy stress E ln(l) / l of a bar; weights keep mass."""
    form = finite(SQUARE, sc.LinearElastic(E=100.0, nu=0.0), unit_weight=3.0)
    state = followed(form, [np.diag([1.5, 1.0])])
    assert form.cauchy(state)[0] == pytest.approx(100.0 * np.log(1.5) / 1.5, rel=1e-14)
    assert form.total_strain(state)[0] == pytest.approx(np.log(1.5), rel=1e-14)
    assert form.own_weight(np.array([0.0, -1.0])).sum() == pytest.approx(-3.0)


def test_small_loads_are_those_of_small_kinematics() -> None:
    """[N] At strains of 1e-8 both kinematics have the same force, with B-bar and F-bar alike."""
    mesh = MeshQuad().refined(2)
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    law = sc.MohrCoulomb(E=1e3, nu=0.3, c=1e-6, phi=20.0)
    x = 1e-8 * np.random.default_rng(0).normal(size=basis.N)
    for strain, other in (("full", "full"), (None, None)):
        small = sc.SolidForm(basis, law, strain)
        large = finite(basis, law, other)
        f = small.assemble(x, small.initial_state()).force
        g = large.assemble(x, large.initial_state()).force
        if strain is None:
            # F-bar takes the volume of the centre and leaves zz; B-bar the mean of three axes
            assert np.linalg.norm(f - g) < 0.2 * np.linalg.norm(f)
        else:
            # strains of 1e-7 of second order
            assert np.linalg.norm(f - g) < 1e-6 * np.linalg.norm(f)


@pytest.mark.parametrize("kinematics", ["small", "finite"])
@pytest.mark.parametrize("unit", [1.0, 1e6])
def test_round_off_of_stresses_that_vanish_is_that_of_the_last_ones(
    kinematics: Any, unit: float
) -> None:
    """[X] Back at the first place, up to 1e-13, the differences of the last stresses remain, in all
    units; under load the displacements alone count.
    """
    law = sc.LinearElastic(E=100.0 * unit, nu=0.3)
    form = sc.SolidForm(SQUARE, law, kinematics=kinematics)
    x = linear(SQUARE, np.array([[1.01, 0.0], [0.0, 1.0]]))
    loaded = form.assemble(x, form.initial_state())
    on = form.assemble(x, loaded.state).round_off
    back = form.assemble(1e-11 * x, loaded.state).round_off
    assert on == pytest.approx(loaded.round_off, rel=1e-12)
    assert 0.1 < back / on < 10.0
    assert form.assemble(1e-11 * x, form.initial_state()).round_off < 1e-10 * on


def test_a_body_that_is_activated_in_displaced_ground() -> None:
    """[X] It is free of stress there; a change of its volume by 2 % is warned of."""
    form = finite(SQUARE, LAWS["elastic"])
    x = linear(SQUARE, rotation(1.0) @ np.diag([1.25, 0.8]))
    state = form.initial_state(x)
    assert np.abs(form.assemble(x, state).force).max() < 1e-13
    with pytest.warns(sc.AnalysisWarning, match="volume by up to 10%"):
        form.initial_state(linear(SQUARE, np.diag([1.1, 1.0])))


def test_an_element_inside_out_is_too_large() -> None:
    """[X] The element is named by its centre."""
    form = finite(SQUARE, LAWS["elastic"])
    with pytest.raises(IncrementTooLarge, match=r"\(0\.5, 0\.5\) turns inside out"):
        form.assemble(linear(SQUARE, np.diag([-0.1, 1.0])), form.initial_state())


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"strain": "b_bar"}, "take strain='f_bar'"),
        ({"strain": "mean"}, "one of 'full', 'b_bar', 'f_bar'"),
        ({"kinematics": "large"}, "one of 'small', 'finite'"),
    ],
)
def test_refused_options(options: dict[str, Any], words: str) -> None:
    """[X] Each by one sentence."""
    with pytest.raises(ValueError, match=words):
        sc.SolidForm(SQUARE, LAWS["elastic"], **{"kinematics": "finite", **options})


def test_f_bar_needs_corner_nodes_and_finite_kinematics() -> None:
    """[X] Other elements do not lock."""
    basis = Basis(MeshQuad(), ElementVector(ElementQuad2()), intorder=4)
    with pytest.raises(ValueError, match="other elements take 'full'"):
        finite(basis, LAWS["elastic"], "f_bar")
    with pytest.raises(ValueError, match="needs kinematics='finite'"):
        sc.SolidForm(SQUARE, LAWS["elastic"], "f_bar")  # type: ignore[arg-type]
    assert finite(SQUARE, LAWS["tresca"]).strain == "f_bar"
    assert finite(SQUARE, LAWS["elastic"]).strain == "full"


def bar() -> tuple[sc.SolidForm, Basis]:
    """Cantilever of four elements."""
    mesh = MeshQuad.init_tensor(np.linspace(0.0, 4.0, 5), np.linspace(0.0, 1.0, 2)).with_defaults()
    basis = Basis(mesh, ElementVector(ElementQuad2()), intorder=4)
    law = sc.Tresca(E=1000.0, nu=0.3, c=20.0)
    return finite(basis, law, unit_weight=1.0), basis


def test_what_stays_small_is_refused() -> None:
    """[X] Water, beams, searches for collapse, section forces and small solids beside."""
    form, basis = bar()
    fixed = basis.get_dofs("left").all()
    model = sc.Model({"bar": form}, fixed, water_unit_weight=10.0)
    with pytest.raises(ValueError, match="water acts on undeformed boundaries"):
        model.run([sc.Stage("flood", water=1.0)])
    with pytest.raises(ValueError, match="water acts on undeformed boundaries"):
        model.water_load(lambda x: 0.0 * x[0])
    with pytest.raises(ValueError, match="search for collapse is of small kinematics"):
        model.strength_reduction()
    with pytest.raises(ValueError, match="search for collapse is of small kinematics"):
        model.limit_load(model.traction("right", (0.0, -1.0)))
    with pytest.raises(ValueError, match="finite kinematics"):
        model.bounds()
    result = model.run([sc.Stage("weight")])
    with pytest.raises(ValueError, match="section forces are of small kinematics"):
        line = sc.Cuts.line((0.0, 0.5), (4.0, 0.5), 1.0)
        result["weight"].section_forces("bar", line)
    small = sc.SolidForm(basis, LAWS["elastic"])
    with pytest.raises(ValueError, match="small rotations and strains"):
        sc.Model({"bar": form, "other": small}, fixed)
    with pytest.raises(ValueError, match="kinematics are small, not finite"):
        model.run([sc.Stage("weight", change={"bar": small})])


def test_runs_are_saved_and_continued(tmp_path: Path) -> None:
    """[X] A run that continues from a file ends as the run in one; small states are refused."""
    form, basis = bar()
    model = sc.Model({"bar": form}, basis.get_dofs("left").all())
    stages = [
        sc.Stage("bend", model.traction("right", (0.0, -2.0)), increments=4),
        sc.Stage("on", model.traction("right", (0.0, -5.0)), increments=4),
    ]
    whole = model.run(stages)
    model.run(stages[:1]).save(tmp_path / "bend.npz")
    start = sc.load_result(tmp_path / "bend.npz", model)
    again = model.run(stages[1:], start=start)
    # the extrapolation of the first increment is not saved: the tolerance of Newton's method
    assert np.abs(again["on"].x - whole["on"].x).max() < 1e-7
    assert np.abs(whole["on"].x).max() > 1.0

    small = sc.Model(
        {"bar": sc.SolidForm(basis, form.materials["all"], unit_weight=1.0)},
        basis.get_dofs("left").all(),
    )
    with pytest.raises(ValueError, match="another form there"):
        sc.load_result(tmp_path / "bend.npz", small)


def test_results_are_cauchy_stresses_in_space_axes() -> None:
    """[X] A pulled strip, turned by 90 degrees, has its stress upright in every result."""
    mesh = MeshQuad().refined(1).with_defaults()
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    form = finite(basis, sc.LinearElastic(E=100.0, nu=0.0))
    ends = np.concatenate([basis.get_dofs("left").all(), basis.get_dofs("right").all()])
    model = sc.Model({"strip": form}, ends)
    stages = []
    for share in (0.25, 0.5, 0.75, 1.0):
        F = rotation(share * np.pi / 2.0) @ np.diag([1.0 + 0.2 * share, 1.0])
        stages.append(sc.Stage(f"{share}", prescribed=linear(basis, F)))
    last = model.run(stages)["1.0"]
    stress = 100.0 * np.log(1.2) / 1.2
    # the tolerance of Newton's method
    assert last.field("syy") == pytest.approx(stress, rel=1e-6)
    assert np.abs(last.field("sxx")).max() < 1e-6 * stress
    assert last.field("eyy") == pytest.approx(np.log(1.2), rel=1e-6)
    assert grid(last).point_data["stress"][:, 1] == pytest.approx(stress, rel=1e-6)


def test_slender_bodies_take_full_steps() -> None:
    """[P] A cantilever under 5 EI / L^2 at its tip (Mattiasson 1981), in one increment.

    The residual rises a thousand times in the first iteration; a search along it takes 51.
    """
    length, height, E = 10.0, 0.05, 1.2e6
    sides = np.linspace(0.0, length, 81), np.array([-height, height]) / 2.0
    mesh = MeshQuad.init_tensor(*sides).with_defaults()
    basis = Basis(mesh, ElementVector(ElementQuad2()), intorder=4)
    beam = finite(basis, sc.LinearElastic(E=E, nu=0.0))
    model = sc.Model({"beam": beam}, basis.get_dofs("left").all())
    force = 5.0 * E * height**3 / 12.0 / length**2
    stage = model.run([sc.Stage("tip", model.traction("right", (0.0, -force / height)))])["tip"]
    tip = basis.get_dofs("right")
    # 80 elements
    assert -stage.x[tip.all("u^2")].mean() / length == pytest.approx(0.71379, rel=2e-4)
    assert -stage.x[tip.all("u^1")].mean() / length == pytest.approx(0.38763, rel=2e-4)
    assert len(stage.iterations) <= 8


def test_clay_that_flows_around_a_tool_takes_few_evaluations(monkeypatch) -> None:
    """[X] A rigid circle is pushed into clay, by half an element in each of four increments.

    Where the tangent has the mean stresses of the law instead of predicted ones, the increments
    are cut, and take 213 evaluations in place of 80.
    """
    x = 3.0 * np.linspace(0.0, 1.0, 13) ** 1.5
    y = -2.0 * np.linspace(1.0, 0.0, 9) ** 1.5
    basis = Basis(
        MeshTri.init_tensor(x, y).with_defaults(), ElementVector(ElementTriP2()), intorder=4
    )
    circle = sc.rigid.circle((0.0, 0.5), 0.5)
    sides = [basis.get_dofs(name).all("u^1") for name in ("left", "right")]
    bottom = basis.get_dofs("bottom")
    up = basis.zeros()
    up[bottom.all("u^2")] = 0.2
    evaluations = counted(monkeypatch, sc.SolidForm, "assemble")
    counts = []
    stages = []
    for predicts in (True, False):
        clay = finite(basis, sc.Tresca(E=500.0, nu=0.49, c=1.0))
        if not predicts:
            monkeypatch.setattr(clay, "_predicted_bulk", np.zeros((1, 1)))
        pair = sc.ContactPair(basis, "top", circle, sc.Coulomb(), 3, 5000.0)
        model = sc.Model({"clay": clay, "tool": pair}, np.concatenate([bottom.all(), *sides]))
        stage = model.run([sc.Stage("push", prescribed=up, increments=4)], progress=False)["push"]
        stages.append(stage)
        counts.append(len(evaluations) - sum(counts))
    assert [stage.fraction for stage in stages] == [1.0, 1.0]
    assert counts[0] < 0.6 * counts[1]
    forces = [stage.reactions()[bottom.all("u^2")].sum() for stage in stages]
    # the increments differ
    assert forces[0] == pytest.approx(forces[1], rel=0.01)


def test_pictures_show_true_displacements() -> None:
    """[X] Bodies of finite kinematics are drawn at scale 1, unless another one is asked for."""
    pytest.importorskip("pyvista")
    from skfem_contact.plot.scene import Scene

    form, basis = bar()
    model = sc.Model({"bar": form}, basis.get_dofs("left").all())
    stage = model.run([sc.Stage("weight")])["weight"]
    assert Scene(stage).factor == 1.0
    assert Scene(stage, "auto").factor == 1.0
    assert Scene(stage, 5.0).factor == 5.0
    small = sc.SolidForm(basis, form.materials["all"], unit_weight=1.0)
    model = sc.Model({"bar": small}, basis.get_dofs("left").all())
    assert Scene(model.run([sc.Stage("weight")])["weight"]).factor == 0.0
