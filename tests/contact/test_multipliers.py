"""Dual multipliers inside Newton's method: exact contact without penalty or tolerance."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from contact_problems import LOWER, MU, UPPER, Contact, hertz, patch, patch_errors
from skfem import LinearForm
from space_problems import MASTER, SLAVE, paraboloid, sheared_paraboloid

import skfem_contact as sc
from skfem_contact.contact.interface import Interface
from skfem_contact.contact.multipliers import nodal_forces
from skfem_contact.nonlinear.step import Step
from tests.contact.test_contact_in_space import patch as patch_in_space
from tests.tools import space
from tests.tools.helpers import grid, vector_basis

DUAL = sc.DualMultipliers()


def iterations(result) -> int:
    """All iterations of a run."""
    return sum(sum(stage.iterations) for stage in result)


# -- accuracy


@pytest.mark.parametrize("slave", [UPPER, LOWER])
@pytest.mark.parametrize("stuck", [False, True])
@pytest.mark.parametrize("element", ["Q1", "P2"])
def test_patch_on_a_slope(element: str, stuck: bool, slave: str) -> None:
    """[X] A9: uniform stress across meshes that do not match, in one equilibrium."""
    problem = patch(3, element, slope=0.3, stuck=stuck)
    pair = problem.pair(1.0 if stuck else 0.0, "segments", slave, enforcement=DUAL)
    result = problem.run(
        pair, [problem.stage("press", normal=10.0)], newton=sc.Newton(tolerance=1e-10)
    )
    assert (
        max(patch_errors(problem, result[-1].x[: problem.basis.N])) < 1e-10
    )  # round-off of the meshes


@pytest.mark.parametrize(("element", "bound"), [("Q1", 2e-7), ("P1", 1e-10), ("P2", 1e-9)])
def test_patch_in_space(element: str, bound: float) -> None:
    """[X] Skewed facets on straight ones leave Newton's tolerance of 1e-8, and on quadrilaterals
    the quadrature's.
    """
    for swapped in (False, True):
        stress = patch_in_space(element, "segments", swapped, enforcement=DUAL)
        assert np.abs(stress / stress.mean() - 1).max() < bound
        assert stress.mean() == pytest.approx(-1.0, abs=2e-6)  # nothing penetrates in the mean


@pytest.mark.slow
@pytest.mark.parametrize("n", [5, 10])
def test_hertz(n: int) -> None:
    """[X] A quarter of the augmented method's iterations, 11 and 12, and smaller errors: .83 and
    1.1 %.
    """
    problem, found = hertz(n), []
    for method in (DUAL, sc.AugmentedLagrangian()):
        result = problem.run(
            problem.pair(0.0, "segments", enforcement=method),
            [problem.stage("press", increments=4)],
        )
        found.append((iterations(result), Contact.of(problem, result[-1].x).pressure_error))
    dual, augmented = found
    assert (
        dual[0] <= 0.26 * augmented[0]
    )  # round-off elsewhere may save the augmented method an iteration
    assert dual[1] <= augmented[1]


@pytest.mark.slow
def test_hertz_in_space() -> None:
    """[N] The edge is foreseen where it has few elements, too: 11 iterations, a fifth of the
    augmented method's.
    """
    problem = paraboloid(4)
    pair = sc.ContactPair(problem.basis, SLAVE, MASTER, sc.Coulomb(), 2, enforcement=DUAL)
    model = sc.Model({"bodies": problem.solid, "joint": pair}, problem.fixed)
    result = model.run(
        [sc.Stage("press", prescribed=problem.pressed, increments=4)], progress=False
    )
    assert iterations(result) <= 11


def test_start_has_the_contact_of_the_equilibrium(monkeypatch) -> None:
    """[N] The nodes that are closed after each increment are those at its start, or two more;
    linearly up to 4.

    The contact is projected at the start and at the displacements before the last increment.
    """
    problem = hertz(10)
    stage = replace(problem.stage("press", increments=4), keep="all")
    model = sc.Model(
        {"bodies": problem.solid, "contact": problem.pair(0.0, "segments", enforcement=DUAL)},
        problem.fixed,
    )
    steps, form = model.run([stage], progress=False)[-1].increments, model.forms["contact"]
    begin = [np.zeros_like(steps[0].x), *(step.x for step in steps)]
    excess, projected, project = [], [], Interface.project
    monkeypatch.setattr(
        Interface, "project", lambda *given: projected.append(given) or project(*given)
    )
    for before, step, found in zip(begin[:-2], steps[:-1], steps[1:], strict=True):
        linear, state = 2.0 * step.x - before, step.states["contact"]
        starts = form.foreseen(linear, step.x, before, state), linear
        active = [
            np.count_nonzero(np.frombuffer(form.assemble(start, state).active, int))
            for start in starts
        ]
        assert len(projected) == 2
        projected.clear()
        excess.append(active - found.states["contact"].closed.sum())
    np.testing.assert_array_equal(excess, [[2, 4], [0, 2], [0, 2]])


@pytest.mark.slow
def test_cattaneo_and_mindlin() -> None:
    """[X] A third of the augmented method's iterations, whose errors are the mesh's too: 14.9 and
    14.5 %.
    """
    problem, found = hertz(5), {}
    stages = [
        problem.stage("press", increments=2),
        problem.stage("shift", tangential=1.0, increments=3),
    ]
    for method in (DUAL, sc.AugmentedLagrangian()):
        result = problem.run(problem.pair(MU, "segments", enforcement=method), stages)
        contact = Contact.of(problem, result[-1].x[: problem.basis.N])
        found[method] = iterations(result), contact.pressure_error, contact.shear_error(MU)
    dual, augmented = found.values()
    assert dual[0] <= 0.33 * augmented[0]
    assert dual[1] <= augmented[1] and dual[2] <= 1.05 * augmented[2]


@pytest.mark.slow
def test_friction_beside_a_plane_of_symmetry() -> None:
    """[N] Half of a paraboloid, pressed and sheared: 15 iterations, and the forces of the penalty
    method to 3 %.
    """
    problem, found = sheared_paraboloid(3), []
    top = np.flatnonzero(problem.pressed != 0.0)
    stages = [
        sc.Stage("press", prescribed=problem.pressed, increments=3),
        sc.Stage("shear", prescribed=problem.pressed + 1e-3 * problem.shifted, increments=2),
    ]
    for options in ({"enforcement": DUAL}, {"penalty": 2e4}):
        pair = sc.ContactPair(problem.basis, SLAVE, MASTER, sc.Coulomb(0.4), 2, **options)
        model = sc.Model({"bodies": problem.solid, "joint": pair}, problem.fixed)
        result = model.run(stages, progress=False)
        reactions = result[-1].reactions()
        found.append((iterations(result), [reactions[top - i].sum() for i in (0, 2)]))
    (dual, forces), (_, reference) = found
    assert dual <= 18
    np.testing.assert_allclose(forces, reference, rtol=0.03)  # compliance of the penalty


def test_no_penalty_changes_the_result() -> None:
    """[X] Displacements and multipliers are the same with a penalty of 1e6 times E/h as without
    one.
    """
    problem = hertz(3)
    stages = [
        problem.stage("press", increments=2),
        problem.stage("shift", tangential=1.0, increments=2),
    ]
    runs = [
        problem.run(problem.pair(MU, "segments", enforcement=DUAL, penalty=penalty), stages)
        for penalty in (None, 1e9)
    ]
    for other in runs[1:]:
        np.testing.assert_array_equal(other[-1].x, runs[0][-1].x)


@pytest.mark.parametrize("enforcement", [None, sc.AugmentedLagrangian()])
def test_augmented_multipliers_are_improved_at_equilibrium(enforcement, monkeypatch) -> None:
    """[X] The first equilibrium is rough where cuts alone follow, and not beside a pair of the
    augmented method.
    """
    heights = {"low": [-1.0, 0.0], "mid": [0.0, 1.0], "top": [1.0, 2.0]}
    mesh = sc.join_bodies(
        {
            name: grid("Q1", np.linspace(0, 1, 3 + k), z)
            for k, (name, z) in enumerate(heights.items())
        }
    )
    basis = vector_basis(mesh, "Q1", intorder=2)
    forms = {
        "blocks": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.3)),
        "cut": sc.ContactPair(basis, "mid:bottom", "low:top", sc.Coulomb(0.3)),
        "other": sc.ContactPair(
            basis, "top:bottom", "mid:top", sc.Coulomb(0.3), 2, enforcement=enforcement
        ),
    }
    pressed, tolerances, equilibrium = basis.zeros(), [], Step.equilibrium
    pressed[basis.get_dofs("top:top").all("u^2")] = -1e-2
    monkeypatch.setattr(
        Step,
        "equilibrium",
        lambda step, settings, attempt: (
            tolerances.append(settings.tolerance) or equilibrium(step, settings, attempt)
        ),
    )
    fixed = basis.get_dofs({"low:bottom", "top:top"}).all()
    sc.Model(forms, fixed).run([sc.Stage("press", prescribed=pressed)], progress=False)
    assert tolerances[0] == (1e-8 if enforcement else 1e-3) and tolerances[-1] == 1e-8


# -- laws


def on_incline(mu: float, **options):
    """A block on an incline of 20 degrees by its weight, held by friction alone; its displacement
    along the plane.
    """
    mesh = sc.join_bodies(
        {
            "base": grid("Q1", np.linspace(-0.5, 1.5, 4), [-0.5, 0.0]),
            "block": grid("Q1", np.linspace(0, 1, 4), [0.0, 0.5]),
        }
    )
    basis = vector_basis(mesh, "Q1", intorder=2)
    pair = sc.ContactPair(
        basis, "block:bottom", "base:top", sc.Coulomb(mu, **options), enforcement=DUAL
    )
    forms = {"bodies": sc.SolidForm(basis, sc.LinearElastic(E=1e6, nu=0.3)), "joint": pair}
    angle = np.radians(20.0)
    force = sc.weight(basis, {"base": 0.0, "block": 1.0})
    down = force.reshape(-1, 2)[:, 1].copy()
    load = np.column_stack((-down * np.sin(angle), down * np.cos(angle))).ravel()
    result = sc.Model(forms, basis.get_dofs("base:bottom").all()).run(
        [sc.Stage("weight", load)], progress=False
    )
    return basis, result[-1]


def test_block_that_friction_holds() -> None:
    """[X] It sticks: no slip at all in the mean of any node, and the shear force is the
    weight's.
    """
    _, stage = on_incline(0.5)
    joint, state = stage.tractions("joint"), stage.states["joint"]
    assert (state.status == 1).all()
    assert abs(joint.shear @ joint.weight) == pytest.approx(
        0.5 * np.sin(np.radians(20.0)), rel=1e-6
    )
    assert joint.pressure @ joint.weight == pytest.approx(0.5 * np.cos(np.radians(20.0)), rel=1e-6)


@pytest.mark.slow
def test_block_that_slides() -> None:
    """[X] tan 20 degrees is .364: with .35 there is no equilibrium, and with adhesion of .02 there
    is one.
    """
    with pytest.raises((sc.NoEquilibrium, sc.NotConverged)):
        on_incline(0.35)
    _, stage = on_incline(0.35, adhesion=0.02)
    joint = stage.tractions("joint")
    assert abs(joint.shear @ joint.weight) == pytest.approx(
        0.5 * np.sin(np.radians(20.0)), rel=1e-6
    )


def test_tie_of_matching_meshes_is_one_mesh() -> None:
    """[N] Bodies tied node to node displace as one body: no penalty lies between."""
    x, halves = np.linspace(0, 1, 5), (np.linspace(0, 1, 4), np.linspace(1, 2, 4))
    whole = vector_basis(grid("Q1", x, np.linspace(0, 2, 7)), "Q1", intorder=2)
    mesh = sc.join_bodies({"lower": grid("Q1", x, halves[0]), "upper": grid("Q1", x, halves[1])})
    split = vector_basis(mesh, "Q1", intorder=2)
    found = []
    for basis, top, bottom in ((whole, "top", "bottom"), (split, "upper:top", "lower:bottom")):
        forms = {"bodies": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.3))}
        if basis is split:
            forms["tie"] = sc.ContactPair(
                basis, "upper:bottom", "lower:top", sc.Tied(), enforcement=DUAL
            )
        prescribed = basis.zeros()
        prescribed[basis.get_dofs(top).all("u^1")] = 0.1
        fixed = np.union1d(basis.get_dofs(top).all(), basis.get_dofs(bottom).all())
        step = sc.Model(forms, fixed).run(
            [sc.Stage("shear", basis.zeros(), prescribed)], progress=False
        )[-1]
        found.append(step.reactions()[basis.get_dofs(top).all("u^1")].sum())
    assert found[1] == pytest.approx(found[0], rel=1e-8)


@pytest.mark.parametrize("quadrature", ["nodal", "segments"])
def test_loose_body_with_a_gap(quadrature: str) -> None:
    """[X] A body that nothing holds closes its gap, and then carries its load."""
    mesh = sc.join_bodies(
        {
            "lower": grid("Q1", np.linspace(0, 1, 5), np.linspace(0, 1, 3)),
            "upper": grid("Q1", np.linspace(0.2, 0.8, 4), np.linspace(1.001, 1.5, 3)),
        }
    )
    basis = vector_basis(mesh, "Q1", intorder=2)
    pair = sc.ContactPair(
        basis, "upper:bottom", "lower:top", sc.Coulomb(0.3), quadrature, enforcement=DUAL
    )
    forms = {
        "bodies": sc.SolidForm(basis, sc.LinearElastic(E=1e6, nu=0.3)),
        "joint": pair,
    }  # stiff: no slopes
    load = basis.zeros()
    load[basis.get_dofs("upper:top").all("u^2")] = -0.25
    fixed = np.union1d(basis.get_dofs("lower:bottom").all(), basis.get_dofs("upper:top").all("u^1"))
    joint = (
        sc.Model(forms, fixed).run([sc.Stage("press", load)], progress=False)[-1].tractions("joint")
    )
    assert joint.pressure @ joint.weight == pytest.approx(1.0, rel=1e-6)


def test_supports_on_both_sides_of_a_node() -> None:
    """[X] The interface ends on a fixed base, where no multiplier has an effect: uniform pressure
    of two columns.
    """
    t = np.linspace(0, 1, 5)
    mesh = sc.join_bodies({"left": grid("Q1", t - 1, t), "right": grid("Q1", t, t)})
    basis = vector_basis(mesh, "Q1", intorder=2)
    pair = sc.ContactPair(basis, "right:left", "left:right", sc.Coulomb(0.3), enforcement=DUAL)
    forms = {"bodies": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.0)), "joint": pair}
    prescribed = basis.zeros()
    prescribed[basis.get_dofs("right:right").all("u^1")] = -2e-3
    rollers = {"left:bottom", "right:bottom"}
    fixed = np.unique(
        np.concatenate(
            (
                basis.get_dofs("left:left").all("u^1"),
                basis.get_dofs("right:right").all("u^1"),
                basis.get_dofs(rollers).all("u^2"),
            )
        )
    )
    joint = (
        sc.Model(forms, fixed)
        .run([sc.Stage("press", basis.zeros(), prescribed)], progress=False)[-1]
        .tractions("joint")
    )
    np.testing.assert_allclose(joint.pressure, 1.0, rtol=1e-6)


def punched(enforcement, half: bool):
    """A round punch on a block with friction, whole or on one side of the plane of symmetry."""
    n = 1 if half else 2
    ends = (0.0, 4.0, 3.0) if half else (-4.0, 4.0, 3.0)
    low = grid("Q1", np.linspace(ends[0], 4, 12 * n + 1), np.linspace(0, 4, 9))
    up = grid("Q1", np.linspace(0.75 * ends[0], 3, 16 * n + 1), np.linspace(0, 1, 7))
    x, e = up.p
    up = replace(up, doflocs=np.array([x, 4 + 3 * e + (1 - e) * x**2 / 40]))
    basis = vector_basis(sc.join_bodies({"low": low, "up": up}), "Q1", intorder=2)
    materials = {"low": sc.LinearElastic(E=1e4, nu=0.3), "up": sc.LinearElastic(E=2e5, nu=0.3)}
    forms = {
        "solid": sc.SolidForm(basis, materials),
        "joint": sc.ContactPair(
            basis, "up:bottom", "low:top", sc.Coulomb(0.4), enforcement=enforcement
        ),
    }
    p, top = basis.mesh.p, basis.get_dofs("up:top").all("u^2")
    on_axis = np.abs(p[0]) < 1e-9
    if not half:
        on_axis &= (p[1] < 1e-9) | (p[1] > 6.99)
    rollers = basis.get_dofs("low:bottom").all("u^2")
    fixed = np.unique(np.concatenate((rollers, top, basis.nodal_dofs[0, on_axis])))
    prescribed = basis.zeros()
    prescribed[top] = -0.05
    stage = sc.Stage("press", prescribed=prescribed, increments=2)
    return sc.Model(forms, fixed).run([stage], progress=False)["press"]


@pytest.mark.filterwarnings("ignore::skfem_contact.AnalysisWarning")
@pytest.mark.parametrize("method", [DUAL, sc.AugmentedLagrangian()])
def test_half_of_a_punch_with_friction(method) -> None:
    """[X] The half on a plane of symmetry has half of the force, and the tractions of the whole."""
    whole, half = punched(method, half=False), punched(method, half=True)
    force = [stage.contact("joint").force[1] for stage in (whole, half)]
    assert 2.0 * force[1] == pytest.approx(force[0], rel=2e-3)
    right, joint = (stage.tractions("joint") for stage in (whole, half))
    assert joint.pressure.max() == pytest.approx(right.pressure.max(), rel=1e-3)
    near, beside = joint.x.argmin(), np.abs(right.x).argmin()
    assert joint.x[near] == pytest.approx(abs(right.x[beside]), rel=1e-3)
    shear, largest = abs(right.shear[beside]), right.shear.max()
    assert abs(joint.shear[near]) == pytest.approx(shear, abs=1e-3 * largest)


def test_push_out_of_a_press_fit() -> None:
    """[X] Supports move both end nodes along the joint: friction acts there, too, mu N in all."""
    inner = grid("Q1", np.linspace(10, 20.0025, 3), np.linspace(0, 20, 5))
    outer = grid("Q1", np.linspace(20, 30, 3), np.linspace(0, 20, 5))
    basis = vector_basis(sc.join_bodies({"inner": inner, "outer": outer}), "Q1", intorder=2)
    forms = {
        "solid": sc.SolidForm(basis, sc.LinearElastic(E=210e3, nu=0.3)),
        "joint": sc.ContactPair(
            basis, "inner:right", "outer:left", sc.Coulomb(0.1), enforcement=DUAL
        ),
    }
    pushed = basis.get_dofs("inner:bottom").all("u^2")
    sides = [basis.get_dofs(name).all("u^1") for name in ("outer:right", "inner:left")]
    fixed = [basis.get_dofs("outer:bottom").all("u^2"), pushed, *sides]
    model = sc.Model(forms, np.unique(np.concatenate(fixed)))
    fit = model.run([sc.Stage("fit")], progress=False)
    prescribed = fit["fit"].x.copy()
    prescribed[pushed] -= 0.05
    push = sc.Stage("push", prescribed=prescribed, increments=5)
    stage = model.run([push], start=fit, progress=False)["push"]
    force = -stage.reactions()[pushed].sum()
    assert force == pytest.approx(-0.1 * stage.contact("joint").force[0], rel=1e-3)


@pytest.mark.filterwarnings("ignore::skfem_contact.AnalysisWarning")
def test_fit_of_a_strip_with_friction() -> None:
    """[X] A strip with an interference of 1e-3 in a higher slot: friction hardly changes the
    thrust.
    """
    strip = grid("Q1", np.linspace(0.5, 1, 5), np.linspace(0.1, 0.9, 5))
    wall = grid("Q1", np.linspace(1, 2, 7), np.linspace(0, 1, 6))
    basis = vector_basis(sc.join_bodies({"s": strip, "w": wall}), "Q1", intorder=2)
    solid = sc.SolidForm(basis, sc.LinearElastic(E=1.0, nu=0.3))
    rollers = [basis.get_dofs({f"{b}:top", f"{b}:bottom"}).all("u^2") for b in "sw"]
    sides = [basis.get_dofs(name).all("u^1") for name in ("s:left", "w:right")]
    fixed = np.unique(np.concatenate((*rollers, *sides)))
    thrusts = []
    for mu in (0.0, 0.2):
        pair = sc.ContactPair(
            basis, "s:right", "w:left", sc.Coulomb(mu), initial=1e-3, enforcement=DUAL
        )
        model = sc.Model({"solid": solid, "joint": pair}, fixed)
        thrusts.append(
            model.run([sc.Stage("fit")], progress=False)["fit"].contact("joint").force[0]
        )
    assert thrusts[1] == pytest.approx(thrusts[0], rel=5e-3)


@pytest.mark.parametrize("element", ["Q1", "Q2", "P2"])
def test_uniform_pressure_about_the_axis(element: str) -> None:
    """[X] A column of revolution pressed evenly: 10 everywhere, also at r = 0, where a shape
    function of second order has no weight.
    """
    t = np.linspace(0, 1, 4)
    mesh = sc.join_bodies({"column": grid(element, t, t)})
    basis = vector_basis(mesh, element, intorder=4)
    floor = sc.rigid.line((-1.0, 0.0), (2.0, 0.0))
    forms = {
        "solid": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.3), coordinates="axisymmetric"),
        "joint": sc.ContactPair(basis, "column:bottom", floor, sc.Coulomb(), enforcement=DUAL),
    }
    model = sc.Model(forms, basis.get_dofs("column:left").all("u^1"))
    load = model.traction("column:top", (0.0, -10.0))
    joint = model.run([sc.Stage("press", load)], progress=False)["press"].tractions("joint")
    np.testing.assert_allclose(joint.pressure, 10.0, rtol=1e-6)


# -- tangent, slice, files


@pytest.mark.parametrize("mu", [0.0, 0.3])
@pytest.mark.parametrize("element", ["Q1", "P2"])
def test_tangent(element: str, mu: float) -> None:
    """[X] Against differences, with open, sticking and sliding nodes; symmetric without
    friction.
    """
    problem, rng = patch(3, element), np.random.default_rng(3)
    pair = problem.pair(mu, "segments", enforcement=DUAL)
    model = sc.Model({"bodies": problem.solid, "joint": pair}, problem.fixed)
    form, n = model.forms["joint"], problem.basis.N
    x = np.zeros(model.size if hasattr(model, "size") else n + form.multipliers.size)
    x[:n] = 3e-3 * rng.standard_normal(n)
    x[form.multipliers[0]] = -2.0 * rng.uniform(size=form.multipliers.shape[1])
    x[form.multipliers[1:]] = 0.5 * rng.standard_normal(form.multipliers[1:].shape)
    first = form.assemble(x, form.initial_state())
    assert {0, 2} <= set(np.frombuffer(first.active, dtype=int)) or mu == 0.0
    d, h = rng.standard_normal(len(x)), 1e-7
    d[form.multipliers] *= 1e3
    slope = (
        form.assemble(x + h * d, form.initial_state()).force
        - form.assemble(x - h * d, form.initial_state()).force
    ) / (2 * h)
    assert (
        np.abs(slope - first.stiffness @ d).max() < 1e-5 * np.abs(slope).max()
    )  # truncation and round-off
    skew = abs(first.stiffness - first.stiffness.T).max() / abs(first.stiffness).max()
    assert form.symmetric == (mu == 0.0) == bool(skew < 1e-13)


@pytest.mark.parametrize(
    ("quadrature", "error", "law"),
    [
        ("nodal", 1e-6, sc.Coulomb(0.2, adhesion=0.5, tension=0.5)),
        ("segments", 1e-3, sc.Coulomb(0.3)),  # cut elsewhere
    ],
    ids=["bond", "friction"],
)
def test_slice_of_a_plane_case(quadrature: str, error: float, law) -> None:
    """[N] Pressed, dragged to and fro across facets and lifted off: a slice in space has the
    plane's tractions.
    """
    lower = grid("Q1", np.linspace(-0.5, 1.6, 8), [-0.5, -0.2, 0.0])
    upper = grid("Q1", np.linspace(0, 1, 5), [0.0, 0.2, 0.5])
    basis = vector_basis(sc.join_bodies({"lower": lower, "upper": upper}), "Q1", intorder=2)
    forms = {
        "blocks": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.3), "full"),
        "joint": sc.ContactPair(
            basis, "upper:bottom", "lower:top", law, quadrature, enforcement=DUAL
        ),
    }
    fixed, stages = basis.get_dofs({"lower:bottom", "upper:top"}).all(), []
    for name, (along, up) in {
        "press": (0.0, -3e-3),
        "drag": (0.4, -3e-3),
        "back": (0.3, -2e-3),
        "lift": (0.3, 0.02),
    }.items():
        values, top = basis.zeros(), basis.get_dofs("upper:top")
        values[top.all("u^1")], values[top.all("u^2")] = along, up
        stages.append(sc.Stage(name, basis.zeros(), values, increments=2))
    result = sc.Model(forms, fixed).run(stages, progress=False)
    again = space.Slice(forms)
    solid = again.run(stages, fixed)
    largest = np.abs(result["press"].states["joint"].multiplier).max()
    for one, other in zip(result, solid, strict=True):
        plane, sliced = one.states["joint"].multiplier, other.states["joint"].multiplier
        order, twin = np.argsort(forms["joint"].slave.nodes[:, 0]), again.forms["joint"].slave.nodes
        for z in np.unique(twin[:, 2]):
            level = np.flatnonzero(twin[:, 2] == z)
            level = level[np.argsort(twin[level, 0])]
            np.testing.assert_allclose(sliced[:2, level], plane[:, order], atol=error * largest)


def test_files_and_reset(tmp_path) -> None:
    """[X] A run continues from a file as it does without one, and tractions outlast a reset of
    displacements.
    """
    problem = hertz(3)
    forms = {"bodies": problem.solid, "contact": problem.pair(MU, "segments", enforcement=DUAL)}
    model = sc.Model(forms, problem.fixed)
    press, shift = (
        problem.stage("press", increments=2),
        problem.stage("shift", tangential=1.0, increments=2),
    )
    whole = model.run([press, shift], progress=False)
    half = model.run([press], progress=False)
    half.save(tmp_path / "half.npz")
    again = model.run([shift], start=sc.load_result(tmp_path / "half.npz", forms), progress=False)
    np.testing.assert_allclose(again[-1].x, whole[-1].x, atol=1e-12 * np.abs(whole[-1].x).max())
    reset = half.reset()[-1]
    np.testing.assert_array_equal(
        reset.states["contact"].multiplier, half[-1].states["contact"].multiplier
    )
    assert not reset.x[: problem.basis.N].any() and reset.x[problem.basis.N :].any()


@pytest.mark.parametrize("mu", [0.0, MU])
def test_reported_forces_balance_the_bodies(mu: float) -> None:
    """[X] Resultants in space, with friction, are the internal forces of the slave's body, to
    Newton's tolerance.
    """
    problem = paraboloid(3)
    pair = sc.ContactPair(problem.basis, SLAVE, MASTER, sc.Coulomb(mu), 2, enforcement=DUAL)
    model = sc.Model(
        {"bodies": problem.solid, "joint": pair}, problem.fixed, newton=sc.Newton(tolerance=1e-10)
    )
    stage = model.run(
        [sc.Stage("press", prescribed=problem.pressed, increments=2)], progress=False
    )[-1]
    joint, n = stage.forms["joint"], problem.basis.N
    inner = problem.solid.assemble(stage.x[:n], stage.states["bodies"]).force[joint.slave.dofs]
    normal, friction = (
        -force[joint.slave.dofs] for force in nodal_forces(joint, stage.x, stage.states["joint"])
    )
    free = ~np.isin(joint.slave.dofs, problem.fixed)
    np.testing.assert_allclose(
        (normal + friction)[free], inner[free], atol=1e-9 * inner.max()
    )  # hats: 3e-3
    np.testing.assert_allclose(stage.contact("joint").normal, normal.sum(axis=0), rtol=1e-12)
    np.testing.assert_allclose(stage.contact("joint").tangential, friction.sum(axis=0), rtol=1e-12)


@pytest.mark.parametrize(("way", "new"), [(0.0, []), (0.4, [12, 13]), (-0.4, [4, 5])])
def test_points_that_come_under_a_rim_take_part_after_equilibrium(way, new) -> None:
    """[X] A block that moves along a slab covers further points, which have slipped as far as the
    others; all others stay as they are.
    """
    slab = grid("Q1", np.linspace(0.0, 4.0, 9), [0.0, 1.0])
    block = grid("Q1", np.linspace(1.0, 2.0, 3), [1.0, 2.0])
    basis = vector_basis(sc.join_bodies({"slab": slab, "block": block}), "Q1")
    bodies = sc.SolidForm(basis, sc.NeoHooke(E=1e3, nu=0.3), kinematics="finite")
    joint = sc.ContactPair(basis, "slab:top", "block:bottom", sc.Coulomb(0.3), 3, enforcement=DUAL)
    model = sc.Model({"bodies": bodies, "joint": joint}, basis.get_dofs("slab:bottom").all())
    pair = model.forms["joint"]
    accepted = pair.initial_state()
    x = np.zeros(model.layout.size)
    x[basis.get_dofs(elements="block").all("u^1")] = way
    found = pair.assemble(x, accepted).state
    state, _ = pair.enforcement.after_equilibrium(pair, accepted, found)
    assert (state is accepted) == (not new)
    assert np.flatnonzero(state.facet != accepted.facet).tolist() == new
    slip = pair.interface.elastic_slip(state, found)[0]
    np.testing.assert_allclose(slip[found.facet >= 0], way, atol=1e-12)


# -- what it does not do


def test_refusals() -> None:
    """Settings and analyses that need another method are named with it."""
    problem = hertz(2)
    options = {"enforcement": DUAL}
    with pytest.raises(ValueError, match=r"in one pass: share must be 1"):
        sc.ContactPair.two_pass(problem.basis, UPPER, LOWER, sc.Coulomb(), **options)
    with pytest.raises(ValueError, match=r"at least 2 points along a facet, not 1"):
        problem.pair(0.0, 1, **options)
    plane = sc.rigid.line((-30.0, 0.0), (30.0, 0.0))
    with pytest.raises(ValueError, match=r"is rigid, make it the master"):
        sc.ContactPair(problem.basis, plane, UPPER, sc.Coulomb(), **options)
    pair = problem.pair(MU, "segments", **options)
    with pytest.raises(ValueError, match=r"take the pair from Model\(forms\)\.forms"):
        pair.assemble(problem.basis.zeros(), pair.initial_state())
    model = sc.Model({"bodies": problem.solid, "contact": pair}, problem.fixed)
    with pytest.raises(ValueError, match=r"searches for a collapse are for the penalty method"):
        model.limit_load(problem.basis.zeros() + 1.0, progress=False)
    with pytest.raises(
        ValueError, match=r"initial states of the ground are for the penalty method"
    ):
        model.gravity_state(problem.basis.zeros() - 1e-3)


@pytest.mark.slow
def test_friction_at_the_rim_of_a_block_on_its_way() -> None:
    """[X] A block is drawn along a slab: all nodes under it slip its way, also beside its rim.

    Nodes there slipped backwards, and H fell by a fifth, by means of dual functions on the parts of
    facets under the rim, and where points that come under it slipped from there on alone.
    """
    n, radius = 3, 0.75
    slab = grid("Q1", np.linspace(0.0, 4.0, 12 + 1), np.linspace(0.0, 2.4, 8 + 1))
    block = grid("Q1", np.linspace(-0.6, 0.6, 2 * n + 1), np.linspace(0.0, 1.0, n + 1))
    x, y = block.p
    arch = radius - np.sqrt(radius**2 - x**2)
    block = replace(block, doflocs=np.stack((1.2 + x, 2.6 + arch + y * (1.2 - arch))))
    basis = vector_basis(sc.join_bodies({"slab": slab, "block": block}), "Q1")
    laws = {"slab": sc.NeoHooke(E=690.0, nu=0.32), "block": sc.NeoHooke(E=6900.0, nu=0.32)}
    bodies = sc.SolidForm(basis, laws, kinematics="finite")
    joint = sc.ContactPair(basis, "slab:top", "block:bottom", sc.Coulomb(0.3), 5, enforcement=DUAL)
    top, bottom = basis.get_dofs("block:top"), basis.get_dofs("slab:bottom")
    model = sc.Model({"bodies": bodies, "joint": joint}, np.union1d(top.all(), bottom.all()))
    stages = []
    pressed = [(0.1 * k, 0.0) for k in range(1, 11)]
    drawn = [(1.0, 0.0625 * k) for k in range(1, 21)]
    for down, along in pressed + drawn:
        u = basis.zeros()
        u[top.all("u^2")], u[top.all("u^1")] = -down, along
        stages.append(sc.Stage(f"{down:.2f} {along:.2f}", prescribed=u))
    result = model.run(stages, progress=False)
    forces = []
    for stage in list(result)[-10:]:
        pressure, shear = stage.states["joint"].multiplier
        assert (shear[pressure < 0.0] > 0.0).all()
        forces.append(stage.reactions()[top.all("u^1")].sum())
    # the last steps, on which all slides
    assert np.abs(np.diff(forces[-6:])).max() < 0.03 * np.mean(forces)


@pytest.mark.parametrize(("n", "m"), [(2, 5), (3, 3), (5, 2)])
def test_coarse_slaves_carry_moments_to_finer_masters(n: int, m: int) -> None:
    """[X] Pure bending of two quadratic blocks tied across it: stresses in proportion to x, without
    jumps at the nodes of a coarse slave. On coarser masters duals have the mean alone.
    """
    E, nu, slope = 1e4, 0.3, 10.0
    bodies = {
        "low": grid("Q2", np.linspace(-1, 1, m + 1), [-1, -0.5, 0]),
        "up": grid("Q2", np.linspace(-1, 1, n + 1), [0, 0.5, 1]),
    }
    basis = vector_basis(sc.join_bodies(bodies), "Q2", intorder=4)
    method = sc.DualMultipliers()
    pair = sc.ContactPair(basis, "up:bottom", "low:top", sc.Tied(), enforcement=method)
    forms = {"solid": sc.SolidForm(basis, sc.LinearElastic(E=E, nu=nu)), "joint": pair}
    bent = basis.project(
        lambda x: (
            slope
            * (1 - nu**2)
            / E
            * np.stack([-0.5 * (x[1] ** 2 + nu / (1 - nu) * x[0] ** 2), x[0] * x[1]])
        )
    )
    fixed = basis.get_dofs({"low:bottom", "up:top"}).all()
    prescribed = basis.zeros()
    prescribed[fixed] = bent[fixed]
    stage = sc.Model(forms, fixed).run([sc.Stage("bend", prescribed=prescribed)], progress=False)[0]
    exact = slope * np.asarray(basis.global_coordinates())[0]
    error = np.abs(stage.states["solid"].stress[1] - exact).max()
    assert error < (1e-6 if n <= m else 0.05) * slope


@pytest.mark.parametrize("overlap, fit", [(1e-3, "as meshed"), (1e-9, "as meshed"), (0.0, 1e-3)])
def test_joints_that_supports_hold_need_no_multipliers(overlap, fit, recwarn) -> None:
    """[X] Both sides of a joint are held: a layer of weight w and height one beside it moves as if
    its side were clamped, by w / 2 E with nu = 0, and an overlap is told, not resolved.
    """
    low = grid("Q1", np.linspace(0.0, 2.0, 5), np.linspace(0.0, 1.0, 3))
    high = grid("Q1", np.linspace(0.0, 2.0, 7), np.linspace(1.0, 2.0, 3))
    mesh = sc.join_bodies(
        {
            "low": low.with_boundaries({"top": lambda x: x[1] == 1.0}),
            "up": high.translated((0.0, -overlap)).with_boundaries(
                {"base": lambda x: x[1] < 1.01, "top": lambda x: x[1] > 1.99}
            ),
        }
    )
    basis = vector_basis(mesh, "Q1")
    law = sc.Coulomb(0.2)
    forms = {
        "solid": sc.SolidForm(basis, sc.LinearElastic(E=10.0, nu=0.0)),
        "joint": sc.ContactPair(
            basis, "up:base", "low:top", law, initial=fit, enforcement=sc.DualMultipliers()
        ),
    }
    fixed = basis.get_dofs(["low:top", "up:base"]).all()
    weight = LinearForm(lambda v, w: -2e-2 * v[1]).assemble(basis)
    stage = sc.Model(forms, fixed).run([sc.Stage("weight", weight)], progress=False)[-1]
    top = basis.get_dofs("up:top").all("u^2")
    assert stage.x[top] == pytest.approx(-1e-3, rel=1e-6)
    assert not stage.states["joint"].traction.any()
    told = [str(w.message) for w in recwarn if "supports hold 'up:base'" in str(w.message)]
    assert len(told) == (overlap + (fit == 1e-3) * 1e-3 > 1e-8)
