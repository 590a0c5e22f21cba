"""Consolidation: exact solutions, orders in time, its tangent, stages of construction, and what is
refused.
"""

from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse import csr_matrix
from skfem import (
    Basis,
    ElementHex1,
    ElementTetP2,
    ElementTriP2,
    ElementVector,
    MeshHex,
    MeshQuad,
    MeshTet,
    MeshTri,
)

import skfem_contact as sc
from skfem_contact.laboratory import oedometer
from skfem_contact.nonlinear.increment import PART
from skfem_contact.solvers.direct import DirectSolver
from tests.oracles.consolidation import mandel, terzaghi
from tests.tools.helpers import vector_basis

E, NU, MOBILITY, LOAD = 1e4, 0.2, 1e-3, 100.0
OEDOMETER = E * (1 - NU) / (1 + NU) / (1 - 2 * NU)
C_V = OEDOMETER * MOBILITY
FINAL = LOAD / OEDOMETER
QUIET = {"progress": False}


def ground(element: str, n: int = 20, width: float = 0.1, grade: float = 1.8):
    """A layer of height 1 and its basis, elements thinner towards its top."""
    kind = MeshTri if element[0] == "P" else MeshQuad
    mesh = kind.init_tensor(
        np.array([0.0, width]), 1 - np.linspace(1, 0, n + 1) ** grade
    ).with_defaults()
    return vector_basis(mesh, element, intorder=4 if element[1] == "2" else 2)


def layer(element: str = "P2", n: int = 20, k: float = MOBILITY, **options):
    """Forms, supports and load of a layer that drains at its top."""
    basis = ground(element, n)
    strain = "b_bar" if element == "Q1" else "full"
    forms = {
        "clay": sc.SolidForm(basis, sc.LinearElastic(E=E, nu=NU), strain=strain),
        "water": sc.PoreWater(basis, k, unit_weight=1.0, **options),
    }
    fixed = [sc.box_supports(basis, base="rollers"), forms["water"].dofs("top")]
    return basis, forms, fixed, sc.traction(basis, "top", (0.0, -LOAD))


def settlement(basis, stage) -> float:
    return float(-stage.x[basis.get_dofs("top").all("u^2")].mean())


def after(times, load, ramp: float = 0.25):
    """Stages that end at degrees T after a load at once, which comes in a short time about T =
    0.
    """
    ends = np.append(ramp * times[0], np.asarray(times) + 0.5 * ramp * times[0])
    return [
        sc.Stage(f"{k}", load, duration=d / C_V) for k, d in enumerate(np.diff(ends, prepend=0.0))
    ]


# -- exact solutions


@pytest.mark.parametrize("element", ["P2", "Q2", "QuadS2", "Q1", "P1"])
def test_terzaghi(element):
    """[X] Settlement and pressures of a layer within .002 with 42 steps over three decades, and no
    water lost.
    """
    basis, forms, fixed, load = layer(element)
    times = np.geomspace(1e-3, 1.0, 32)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        result = sc.Model(forms, fixed).run(after(times, load), **QUIET)
    U = [settlement(basis, stage) / FINAL for stage in result][1:]
    assert sum(len(stage.iterations) for stage in result) <= 42
    assert np.abs(U - terzaghi(times)).max() < 0.002
    water, heights = forms["water"], basis.mesh.p[1]
    exact = LOAD * terzaghi(times, 1 - heights)
    pressures = np.array([stage.forms["water"].pressure(stage.x) for stage in result])[1:]
    assert (
        np.abs(pressures - exact)[times > 0.01].max() < 0.01 * LOAD
    )  # elements of .1 where the profile is curved
    state = result[-1].states["water"]
    assert water.volume(state) == pytest.approx(
        -settlement(basis, result[-1]) * 0.1, rel=1e-6
    )  # a mean over nodes
    assert water.inflow(state, "top") == pytest.approx(water.volume(state), rel=1e-9)
    assert water.inflow(state, "bottom") == pytest.approx(0.0, abs=1e-9 * abs(water.volume(state)))
    nodal = result[-1].field("pore")
    np.testing.assert_allclose(nodal[: len(heights)], pressures[-1], atol=1e-12 * LOAD)


def test_mandel():
    """[X] The pressure in the middle of a block rises by 10.69 % before it falls, at T = .072."""
    mesh = MeshTri.init_tensor(np.linspace(0, 1, 21), np.linspace(0, 0.5, 11)).with_defaults()
    basis = vector_basis(mesh, "P2", intorder=4)
    top = basis.get_dofs("top").all("u^2")
    top = top[np.argsort(basis.doflocs[0, top])]
    m = len(top) - 1
    D = csr_matrix(
        (np.repeat([-1e5, 1e5], m), (np.tile(np.arange(m), 2), np.r_[top[:-1], top[1:]])),
        (m, basis.N),
    )
    forms = {
        "block": sc.SolidForm(basis, sc.LinearElastic(E=E, nu=NU)),
        "plate": sc.MatrixForm(csr_matrix(D.T @ D)),
        "water": sc.PoreWater(basis, MOBILITY, unit_weight=1.0),
    }
    smooth = np.append(basis.get_dofs("bottom").all("u^2"), basis.get_dofs("left").all("u^1"))
    fixed = [smooth, forms["water"].dofs("right")]
    times = np.array([0.01, 0.03, 0.072, 0.2, 0.5])
    result = sc.Model(forms, fixed).run(
        after(times, sc.traction(basis, "top", (0.0, -LOAD))), **QUIET
    )
    below = np.flatnonzero(mesh.p[1] == 0.0)
    p = np.array([stage.forms["water"].pressure(stage.x)[below] for stage in result])[1:] / (
        LOAD / 2
    )
    exact = mandel(times, mesh.p[0, below], NU)
    assert exact[2].max() == pytest.approx(1.1069, abs=1e-4)
    assert p[2].max() == pytest.approx(exact[2].max(), rel=2e-3)
    # elements of .05; at T = .01 the drained layer is .1 deep
    assert np.abs(p - exact).max() < 0.02 and np.abs(p - exact)[1:].max() < 0.005


@pytest.mark.parametrize(("kind", "element"), [(MeshTet, ElementTetP2), (MeshHex, ElementHex1)])
def test_in_space(kind, element):
    """[X] The same layer of tetrahedra or stabilised hexahedra."""
    x = np.array([0.0, 0.2])
    mesh = kind.init_tensor(x, x, 1 - np.linspace(1, 0, 13) ** 1.8).with_boundaries(
        {"top": lambda x: x[2] > 1 - 1e-9}
    )
    basis = Basis(mesh, ElementVector(element()), intorder=2)
    strain = "b_bar" if kind is MeshHex else "full"
    forms = {
        "clay": sc.SolidForm(basis, sc.LinearElastic(E=E, nu=NU), strain=strain),
        "water": sc.PoreWater(basis, MOBILITY, unit_weight=1.0),
    }
    fixed = [sc.box_supports(basis, base="rollers"), forms["water"].dofs("top")]
    times = np.array([0.03, 0.197, 0.5])
    result = sc.Model(forms, fixed).run(
        after(times, sc.traction(basis, "top", (0.0, 0.0, -LOAD))), **QUIET
    )
    U = [-stage.x[basis.get_dofs("top").all("u^3")].mean() / FINAL for stage in result][1:]
    assert np.abs(U - terzaghi(times)).max() < 0.003  # fewer elements than in the plane


def test_axial_symmetry():
    """[X] The layer as a cylinder: settlement and, per radian, the water pressed out."""
    basis = ground("P2", width=0.1)
    forms = {
        "clay": sc.SolidForm(basis, sc.LinearElastic(E=E, nu=NU), coordinates="axisymmetric"),
        "water": sc.PoreWater(basis, MOBILITY, unit_weight=1.0),
    }
    fixed = [sc.box_supports(basis, base="rollers"), forms["water"].dofs("top")]
    load = sc.traction(forms["clay"], "top", (0.0, -LOAD))
    result = sc.Model(forms, fixed).run(after([0.197], load), **QUIET)
    assert settlement(basis, result[-1]) / FINAL == pytest.approx(terzaghi([0.197])[0], abs=0.002)
    volume = forms["water"].volume(result[-1].states["water"])
    assert volume == pytest.approx(
        -settlement(basis, result[-1]) * 0.1**2 / 2, rel=1e-5
    )  # a mean over nodes


def test_storage_of_the_water():
    """[X] Compressible water carries 1 / (1 + S M) of the load at first, and slows the flow by as
    much.
    """
    storage = 0.5 / OEDOMETER
    basis, forms, fixed, load = layer(storage=storage)
    times = np.array([0.01, 0.1, 0.4]) * 1.5
    result = sc.Model(forms, fixed).run(after(times, load), **QUIET)
    p = result[1].forms["water"].pressure(result[1].x)[basis.mesh.p[1] == 0.0]
    np.testing.assert_allclose(p, LOAD / 1.5, rtol=1e-3)  # the drained layer has not come there yet
    U = np.array([settlement(basis, stage) / FINAL for stage in result])[1:]
    np.testing.assert_allclose(U, (0.5 + terzaghi(times / 1.5)) / 1.5, atol=0.002)


# -- steps in time


def test_order_in_time():
    """[X] Second order: equal steps from a pressure that one mode describes, which decays at the
    rate of the mesh.
    """
    basis, forms, fixed, _ = layer("Q2", time_error=1e6)
    quiet = sc.Model(forms, fixed).run([sc.Stage("quiet", basis.zeros(), duration=1.0)], **QUIET)
    water = sc.Model(forms, fixed).forms["water"]
    # the load of this pressure on ground that does not move yet: its water then flows as the mode
    # does
    mode = np.zeros(water.size)
    mode[water.carries] = LOAD * np.cos(0.5 * np.pi * basis.mesh.p[1])
    errors = []
    for steps in (4, 8, 16, 32, 64):
        load = -water.over(1.0).assemble(mode, water.initial_state()).force[: basis.N]
        stages = [
            sc.Stage("load", load, duration=1e-6 / C_V),
            sc.Stage("wait", load, duration=0.4 / C_V, increments=steps),
        ]
        result = sc.Model(forms, fixed, newton=sc.Newton(tolerance=1e-12)).run(
            stages, start=quiet, **QUIET
        )
        errors.append(settlement(basis, result["wait"]))
    change = np.abs(np.diff(errors))
    np.testing.assert_allclose(np.log2(change[:-1] / change[1:]), 2.0, atol=0.15)


def test_hardening_clay_takes_few_iterations():
    """[N] A step solves two equilibria of at most five iterations; the settlement ends as that of
    the oedometer.
    """
    law, P = sc.CamClay(0.02, 0.1, 1.2, 0.25, 50.0, OCR=1.5), 50.0
    basis = ground("P2", 6)
    clay, water = (
        sc.SolidForm(basis, law),
        sc.PoreWater(basis, 2e-4, unit_weight=10.0, time_error=0.03),
    )
    sides, load = sc.box_supports(basis, base="rollers"), sc.traction(basis, "top", (0.0, -1.0))
    start = sc.Model({"clay": clay}, sides).k0_state(
        P * load, unit_weights=0.0, K0=0.6, surcharge=P
    )
    model = sc.Model({"clay": clay, "water": water}, [sides, water.dofs("top")])
    stages = [
        sc.Stage("load", 3 * P * load, duration=2.0, increments=5, activate="water"),
        sc.Stage("wait", 3 * P * load, duration=150.0),
    ]
    result = model.run(stages, start=start, **QUIET)
    counts = np.concatenate([stage.iterations for stage in result.stages[1:]])
    assert (
        counts.max() <= 8 and counts.mean() < 5.0
    )  # 9 and 5.9 where the second equilibrium begins at the first
    path = oedometer(stress=-3 * P, increments=20)
    test = sc.element_test(law, np.array([-0.6 * P, -P, -0.6 * P, 0.0])[:, None], path)
    # 7e-5: the history of each point differs slightly
    assert settlement(basis, result["wait"]) == pytest.approx(-test.axial[-1, 0], rel=3e-4)


def test_steps_follow_their_error():
    """[X] One stage of any length: short steps first, long ones later, the end right; and finer
    where asked for.
    """
    counts = {}
    for allowed in (0.03, 0.01, 0.003):
        basis, forms, fixed, load = layer(time_error=allowed)
        stages = [
            sc.Stage("load", load, duration=1e-4 / C_V),
            sc.Stage("wait", load, duration=20.0 / C_V),
        ]
        result = sc.Model(forms, fixed).run(stages, **QUIET)
        counts[allowed] = len(result["wait"].iterations)
        assert settlement(basis, result["wait"]) == pytest.approx(
            FINAL, rel=1e-5
        )  # 2e-6 in long steps at the end
        assert result["wait"].time == pytest.approx(20.0001 / C_V)
    assert counts[0.03] < counts[0.01] < counts[0.003] < 60


def test_equal_steps_share_their_factor(monkeypatch):
    """Steps that are equal but for round-off have the same matrix, to the last bit: it is factored
    once a stage.
    """
    basis, forms, fixed, load = layer("Q1", n=4, time_error=1e6)
    factored = []
    engine = type(DirectSolver(basis.doflocs, np.arange(2))._engine)
    factor = engine.factor
    monkeypatch.setattr(
        engine, "factor", lambda self, A, *more: factored.append(A.nnz) or factor(self, A, *more)
    )
    stages = [
        sc.Stage("load", load, duration=0.01, increments=9),
        sc.Stage("wait", load, duration=0.1, increments=7),
    ]
    result = sc.Model(forms, fixed).run(stages, **QUIET)
    assert [len(stage.iterations) for stage in result] == [9, 7]
    assert len(factored) == 2


def test_beside_a_form_of_first_order():
    """[X] A damper below a plate on the layer takes the whole step: in the end it has moved as far
    as the ground.
    """
    basis, forms, fixed, load = layer(n=8)
    top = int(basis.get_dofs("top").all("u^2")[0])

    class Dashpot(sc.Form, sc.roles.Timed):
        size, taken = basis.N, []

        def over(self, duration):
            self.taken.append(duration)
            return self

        def assemble(self, x, state):
            K = csr_matrix(([1e-6], ([top], [top])), shape=(basis.N, basis.N))
            return sc.Response(K @ x, lambda: None, lambda: K)

    sc.Model(forms | {"damper": Dashpot()}, fixed).run(
        [sc.Stage("load", load, duration=8.0)], **QUIET
    )
    parts = np.reshape(Dashpot.taken, (-1, 2))
    np.testing.assert_allclose(parts[:, 0] / parts.sum(axis=1), PART)


# -- form


@pytest.mark.parametrize("element", ["P2", "Q1"])
def test_form_answers_as_it_should(element):
    """Tangent by differences, symmetric, over a step and while the pressures stand."""
    basis, forms, _, _ = layer(element, n=3)
    water = sc.Model(forms).forms["water"]
    rng = np.random.default_rng(0)
    x = rng.standard_normal(water.size) * np.where(np.arange(water.size) < basis.N, 1e-3, 10.0)
    state = water.initial_state(rng.standard_normal(water.size))
    sc.testing.check_form(water, x, state)
    step = water.over(0.3)
    K = step.assemble(x, state).stiffness
    d = rng.standard_normal(water.size) * np.where(np.arange(water.size) < basis.N, 1e-3, 10.0)
    change = step.assemble(x + d, state).force - step.assemble(x, state).force
    np.testing.assert_allclose(K @ d, change, atol=1e-12 * np.abs(change).max())  # it is linear
    assert abs(K - K.T).max() <= 1e-15 * abs(K).max()
    again = step.assemble(x, water.initial_state(x))
    # what leaves the nodes by flow alone adds up to nothing
    assert abs(again.force[basis.N :].sum()) < 1e-12 * np.abs(again.force[basis.N :]).sum()


def test_saved_resumed_and_counted_anew(tmp_path):
    """A result goes on from a file, and from displacements counted anew, to the same pressures."""
    _, forms, fixed, load = layer(n=8)
    stages = [
        sc.Stage("load", load, duration=1e-2 / C_V),
        sc.Stage("wait", load, duration=0.1 / C_V),
    ]
    whole = sc.Model(forms, fixed).run(stages, **QUIET)
    first = sc.Model(forms, fixed).run(stages[:1], **QUIET)
    first.save(tmp_path / "first")
    read = sc.load_result(tmp_path / "first", forms)
    assert read["load"].time == first["load"].time
    water = forms["water"]
    for start in (read, first.reset()):
        again = sc.Model(forms, fixed).run(stages[1:], start=start, **QUIET)["wait"]
        pressures = [stage.forms["water"].pressure(stage.x) for stage in (again, whole["wait"])]
        np.testing.assert_allclose(*pressures, atol=1e-8 * LOAD)
        assert water.volume(again.states["water"]) == pytest.approx(
            water.volume(whole["wait"].states["water"])
        )


# -- construction


def test_levels_that_change():
    """[X] A level that falls by dh at the top settles the layer by gamma dh H / M: pressures end
    uniform.
    """
    basis, forms, fixed, _ = layer(n=8)
    down = sc.Model(forms, fixed).forms["water"].prescribed({"top": lambda x: 0.0 * x[0] - 5.0})
    # the load of the water at first is part of the load, and goes with the level outside
    push = sc.traction(basis, "top", (0.0, 5.0))
    result = sc.Model(forms, fixed).run(
        [sc.Stage("down", push, prescribed=down, duration=50.0 / C_V)], **QUIET
    )
    np.testing.assert_allclose(
        result["down"].forms["water"].pressure(result["down"].x), -5.0, rtol=1e-6
    )
    np.testing.assert_allclose(
        result["down"].x[: basis.N], 0.0, atol=1e-9
    )  # total stress and pressure fall alike
    stages = [
        sc.Stage("down", basis.zeros(), prescribed=down, duration=0.1 / C_V),
        sc.Stage("wait", basis.zeros(), duration=50.0 / C_V),
    ]
    alone = sc.Model(forms, fixed).run(stages, **QUIET)
    assert settlement(basis, alone["wait"]) == pytest.approx(5.0 / OEDOMETER, rel=1e-6)


def test_seepage_face():
    """[X] A face that water leaves drains a layer under load; unloaded this keeps its volume, and
    its water sucks.
    """
    basis, forms, fixed, load = layer()
    fixed = fixed[:1]
    forms["face"] = sc.water.SeepageFace(forms["water"], "top")
    times, water = np.array([0.01, 0.05, 0.197, 0.5]), forms["water"]
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # it is not sealed
        result = sc.Model(forms, fixed).run(after(times, load), **QUIET)
    U = np.array([settlement(basis, stage) / FINAL for stage in result])[1:]
    assert np.abs(U - terzaghi(times)).max() < 0.002
    state = result[-1].states["water"]
    assert water.inflow(state, "top") == pytest.approx(water.volume(state), rel=1e-9)
    stages = [
        sc.Stage("long", load, duration=10.0 / C_V),
        sc.Stage("half", 0.5 * load, duration=1.0 / C_V),
        sc.Stage("double", 2.0 * load, duration=1e3 / C_V),
    ]
    result = sc.Model(forms, fixed).run(stages, start=result, **QUIET)
    np.testing.assert_allclose(
        [settlement(basis, result[name]) / FINAL for name in ("long", "half", "double")],
        [1.0, 1.0, 2.0],
        rtol=1e-3,
    )
    np.testing.assert_allclose(
        result["half"].forms["water"].pressure(result["half"].x), -0.5 * LOAD, rtol=1e-3
    )
    same = sc.Stage("same", 2.0 * load, duration=1.0 / C_V, change={"water": layer()[1]["water"]})
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # nor is it after a change of the water
        sc.Model(forms, fixed).run([same], start=result, **QUIET)
    sc.testing.check_form(result["half"].forms["face"].over(0.1), result["half"].x, None)


def test_seepage_face_below_zero():
    """[X] It opens where the pressure at the beginning and the excess pressure add up to more than
    zero.
    """
    basis, forms, fixed, load = layer("Q1", n=8)
    forms["face"] = sc.water.SeepageFace(
        forms["water"], ["top"], lambda x: -0.3 * LOAD + 0.0 * x[0]
    )
    stages = [sc.Stage("wait", load, duration=1e4 / C_V)]
    end = sc.Model(forms, fixed[:1]).run(stages, **QUIET)["wait"]
    np.testing.assert_allclose(end.forms["water"].pressure(end.x), 0.3 * LOAD, rtol=1e-3)
    assert settlement(basis, end) / FINAL == pytest.approx(0.7, rel=1e-3)


def test_wet_fill_that_comes_and_goes():
    """[X] Two parts of the ground share the pressures at their interface; the lower one drains
    through the fill.
    """
    mesh = MeshTri.init_tensor(np.array([0.0, 0.1]), np.linspace(0, 1, 21)).with_defaults()
    mesh = mesh.with_subdomains(
        {"low": lambda x: x[1] < 0.5, "high": lambda x: x[1] > 0.5}
    ).with_boundaries({"middle": lambda x: x[1] == 0.5}, boundaries_only=False)
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=4)
    material, forms = sc.LinearElastic(E=E, nu=NU), {}
    for name in ("low", "high"):
        part = basis.with_elements(name)
        forms[name] = sc.SolidForm(part, material)
        forms[f"water {name}"] = sc.PoreWater(part, MOBILITY, unit_weight=1.0)
    sides = sc.box_supports(basis, base="rollers")
    on_low, on_high = (sc.traction(basis, name, (0.0, -LOAD)) for name in ("middle", "top"))
    lower, upper = forms["water low"], forms["water high"]
    stages = [
        sc.Stage("low", on_low, duration=1e5 / C_V),
        sc.Stage(
            "both",
            on_low + on_high,
            duration=1e5 / C_V,
            activate=["high", "water high"],
            fixed=[sides, upper.dofs("top")],
        ),
        sc.Stage(
            "dug",
            on_low,
            duration=1e5 / C_V,
            deactivate=["high", "water high"],
            fixed=[sides, lower.dofs("middle")],
        ),
    ]
    model = sc.Model(forms, [sides, lower.dofs("middle")])
    dry = sc.Stage("dug", on_low, duration=1.0, deactivate="high")
    with pytest.raises(ValueError, match="stage 'dug': PoreWater is active in inactive ground"):
        model.run([*stages[:2], dry], **QUIET)
    result = model.run(stages, **QUIET)
    middle = basis.nodal_dofs[1, mesh.p[1] == 0.5]
    lower, upper = (result["both"].forms[f"water {name}"] for name in ("low", "high"))
    half = 0.5 * LOAD / OEDOMETER
    np.testing.assert_allclose(
        [-stage.x[middle].mean() / half for stage in result], [1.0, 2.0, 1.0], rtol=1e-5
    )
    both = result["both"]
    assert upper.inflow(both.states["water high"], "top") == pytest.approx(
        -2 * half * 0.1, rel=1e-4
    )
    assert np.isnan(lower.pressure(both.x)[mesh.p[1] > 0.5]).all()
    # halfway the interface carries pressure: it is no drain
    soon = sc.Stage(
        "both",
        on_low + on_high,
        duration=0.01 / C_V,
        activate=["high", "water high"],
        fixed=stages[1].fixed,
    )
    quick = model.run([stages[0], soon], **QUIET)["both"]
    p = lower.pressure(quick.x)[mesh.p[1] == 0.5]
    np.testing.assert_allclose(p, upper.pressure(quick.x)[mesh.p[1] == 0.5])
    assert (p > 0.5 * LOAD).all()


def test_water_that_returns_without_pressure():
    """[X] Drained ground is in equilibrium: water that comes back, compressible too, moves
    nothing.
    """
    basis, forms, fixed, load = layer(n=4)
    forms["water"] = sc.PoreWater(basis, MOBILITY, unit_weight=1.0, storage=1.0 / E)
    stages = [
        sc.Stage("press", load, duration=0.01 / C_V),
        sc.Stage("drained", load, deactivate="water"),
        sc.Stage("wet", load, activate="water", duration=0.01 / C_V),
    ]
    result = sc.Model(forms, fixed[:1]).run(stages, **QUIET)
    assert (result["press"].forms["water"].pressure(result["press"].x) > 0.3 * LOAD).all()
    assert abs(result["wet"].forms["water"].pressure(result["wet"].x)).max() < 1e-9 * LOAD
    np.testing.assert_allclose(
        result["wet"].x[: basis.N],
        result["drained"].x[: basis.N],
        rtol=0.0,
        atol=1e-9 * abs(result["drained"].x[: basis.N]).max(),
    )


@pytest.mark.parametrize("K0", [None, 0.5])
def test_initial_states(K0):
    """[X] Ground at rest has no excess pressure: it goes on as if the water came with the first
    stage.
    """
    basis, forms, fixed, load = layer(n=4)
    weight = sc.weight(basis, 10.0)
    starts = [sc.Model(forms, fixed).gravity_state(weight, K0=K0)]
    if K0 is not None:
        starts.append(sc.Model(forms, fixed).k0_state(weight, unit_weights=10.0, K0=K0))
    press = sc.Stage("press", weight + load, duration=0.1 / C_V)
    dry = sc.Model({"clay": forms["clay"]}, fixed[:1]).gravity_state(weight, K0=K0)
    wet = sc.Stage("press", press.load, duration=press.duration, activate="water")
    later = sc.Model(forms, fixed).run([wet], start=dry, **QUIET)["press"]
    for start in starts:
        assert not start["initial"].x.any() and not forms["water"].volume(
            start["initial"].states["water"]
        )
        result = sc.Model(forms, fixed).run([press], start=start, **QUIET)["press"]
        np.testing.assert_allclose(result.x, later.x, atol=1e-9 * np.abs(later.x).max())
        np.testing.assert_allclose(
            result.states["clay"].stress, later.states["clay"].stress, atol=1e-7 * LOAD
        )


@pytest.mark.slow
def test_pressures_stand_in_a_search_for_a_collapse():
    """[X] The factor of a column under water pressure is that of its effective stresses, and reads
    the same later.
    """
    mesh = MeshQuad.init_tensor(np.linspace(0, 1, 3), np.linspace(0, 1, 3)).with_defaults()
    basis = vector_basis(mesh, "Q2", intorder=4)
    soil = sc.MohrCoulomb(E=1e4, nu=0.3, c=10.0, phi=30.0, psi=0.0)
    forms = {
        "clay": sc.SolidForm(basis, soil),
        "water": sc.PoreWater(basis, MOBILITY, unit_weight=1.0),
    }
    fixed = np.append(basis.get_dofs("bottom").all("u^2"), basis.get_dofs("left").all("u^1"))
    model = sc.Model(forms, [fixed, forms["water"].dofs()])
    water = model.forms["water"]
    load = sc.traction(basis, "top", (0.0, -20.0)) + sc.traction(basis, "right", (-8.0, 0.0))
    with_water = water.prescribed({"top": 5.0})
    with_water[water.carries] = 5.0
    result = model.run([sc.Stage("load", load, prescribed=with_water, duration=1.0)], **QUIET)
    found = sc.Model(forms, fixed).strength_reduction(start=result, **QUIET)
    # effective stresses 15 and 3: sin(phi_F) (15 + 3) / 2 + c_F cos(phi_F) = 6
    factors = np.linspace(0.5, 6.0, 100001)
    phi = np.arctan(np.tan(np.radians(30.0)) / factors)
    exact = factors[np.argmin(np.abs(9.0 * np.sin(phi) + 10.0 / factors * np.cos(phi) - 6.0))]
    assert found.factor == pytest.approx(exact, abs=0.02)  # twice its `tol`
    np.testing.assert_allclose(found.end.x[water.carries], 5.0)


@pytest.mark.parametrize(
    "soil", [sc.LinearElastic(E=1e3, nu=0.3), sc.MohrCoulomb(E=1e3, nu=0.3, c=8.0, phi=10.0)]
)
def test_contact_carries_the_total_stress(soil):
    """[X] A wet column on a rough base: contact carries the load at any time, whoever carries it
    above.
    """
    grids = {
        "base": MeshTri.init_tensor(np.linspace(-1, 2, 10), np.linspace(-1, 0, 4)),
        "column": MeshTri.init_tensor(np.linspace(0, 1, 5), np.linspace(0, 2, 9)),
    }
    mesh = sc.join_bodies({name: grid.with_defaults() for name, grid in grids.items()})
    basis = vector_basis(mesh, "P2", intorder=4)
    wet = basis.with_elements("column")
    forms = {
        "base": sc.SolidForm(basis.with_elements("base"), sc.LinearElastic(E=1e5, nu=0.3)),
        "column": sc.SolidForm(wet, soil),
        "water": sc.PoreWater(wet, 1e-2, unit_weight=9.81),
        "joint": sc.ContactPair(basis, "column:bottom", "base:top", sc.Coulomb(mu=0.5)),
    }
    drained = forms["water"].dofs("column:top", "column:left", "column:right")
    fixed = [basis.get_dofs("base:bottom").all(), drained]
    load = sc.traction(basis, "column:top", (0.0, -10.0))
    stages = [sc.Stage("load", load, duration=0.3), sc.Stage("wait", load, duration=100.0)]
    with pytest.warns(
        sc.AnalysisWarning, match="'joint' transfers the pressure of the water as well, at 3 nodes"
    ):
        result = sc.Model(forms, fixed).run(stages, **QUIET)
    for stage in result:
        assert stage.contact("joint").pressure == pytest.approx(
            10.0, rel=1e-3
        )  # along turned facets
    p = [np.nanmax(stage.forms["water"].pressure(stage.x)) for stage in result]
    assert p[0] > 1.0 and p[1] < 1e-3
    dry = {name: form for name, form in forms.items() if name != "water"}
    slow = sc.Model(dry, fixed[:1]).run([sc.Stage("load", load)], **QUIET)["load"]
    if isinstance(soil, sc.LinearElastic):
        np.testing.assert_allclose(
            result["wait"].x[: basis.N], slow.x, atol=1e-2 * np.abs(slow.x).max()
        )  # friction


# -- what is warned of


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"permeability": 0.0}, "positive and finite"),
        ({"permeability": -1e-3}, "positive and finite"),
        ({"permeability": np.nan}, "permeability must be finite numbers"),
        ({"permeability": {"cly": 1.0}}, "no subdomain 'cly'"),
        ({"permeability": 1.0, "storage": -1.0}, "storage must be finite and not negative"),
        ({"permeability": 1.0, "storage": np.nan}, "storage must be a finite number"),
        ({"permeability": 1.0, "unit_weight": 0.0}, "unit_weight must be a finite number above 0"),
        (
            {"permeability": 1.0, "time_error": np.nan},
            "time_error must be a finite number, not nan",
        ),
    ],
)
def test_bad_values(options, message):
    with pytest.raises(ValueError, match=message):
        sc.PoreWater(ground("P2", 2), **{"unit_weight": 1.0, **options})


def test_a_seepage_face_without_boundaries_holds_nothing():
    """None of the nodes leaks."""
    _, forms, _, _ = layer(n=3)
    face = sc.water.SeepageFace(forms["water"], ())
    assert len(face.leaks) == 0
    assert repr(face) == "<SeepageFace 0 nodes>"


def test_bad_analyses():
    """Refused before anything is computed."""
    basis, forms, fixed, load = layer(n=3)
    water = forms["water"]
    with pytest.raises(ValueError, match="stage 'load': PoreWater needs time"):
        sc.Model(forms, fixed).run([sc.Stage("load", load)], **QUIET)
    with pytest.raises(ValueError, match="no boundary 'tpo'; existing: bottom"):
        water.dofs("tpo")
    with pytest.raises(ValueError, match="each a finite number or a function"):
        sc.Model(forms, fixed).forms["water"].prescribed({"top": np.nan})
    with pytest.raises(ValueError, match="no boundary 'tpo'; existing: bottom"):
        sc.water.SeepageFace(water, "tpo")
    with pytest.raises(ValueError, match="must be a finite number"):
        sc.water.SeepageFace(water, "top", np.nan)
    plate, stages = (
        sc.MatrixForm(csr_matrix((basis.N, basis.N))),
        [sc.Stage("load", load, duration=1.0)],
    )
    with pytest.raises(ValueError, match="PoreWater in 6 elements of no SolidForm"):
        sc.Model({"water": water, "plate": plate}, fixed).run(stages, **QUIET)
    clay = sc.Undrained(sc.LinearElastic(E=E, nu=NU), bulk_modulus_water=1e6)
    with pytest.raises(ValueError, match="Undrained and has PoreWater too"):
        sc.Model({**forms, "clay": sc.SolidForm(basis, clay)}, fixed).run(stages, **QUIET)
    gravel = sc.PoreWater(basis, permeability=1e12, unit_weight=1.0)
    with pytest.raises(ValueError, match=r"after 1.1e.16 times H² / c_v"):
        sc.Model({**forms, "water": gravel}, fixed).run(stages, **QUIET)
    sealed = np.concatenate(
        (sc.box_supports(basis, base="rollers"), basis.get_dofs("top").all("u^2"))
    )
    with pytest.raises(ValueError, match="the pore pressure is not determined"):
        sc.Model(forms, sealed).run(stages, **QUIET)


@pytest.mark.parametrize(
    ("k", "duration", "drained", "message"),
    [
        (
            MOBILITY,
            1e-6,
            True,
            r"ends after 1e-06, less than h² / 3 c_v = .* of the elements beside drains",
        ),
        (1e-20, 1.0, True, r"times H² / c_v.*in the same units"),
        (1e6, 1.0, True, r"times H² / c_v.*in the same units"),
        (MOBILITY, 1.0, False, "no water can leave the ground"),
    ],
)
def test_what_is_warned_of(k, duration, drained, message):
    _, forms, fixed, load = layer(n=4, k=k)
    fixed = fixed if drained else fixed[:1]
    with pytest.warns(sc.AnalysisWarning, match=message):
        sc.Model(forms, fixed).run([sc.Stage("load", load, duration=duration)], **QUIET)


def test_undrained_ground_keeps_its_water() -> None:
    """[X] Its stiffness is the same with any permeability; that of a duration is not."""
    undrained, drained = [], []
    for k in (1e-3, 1e3):
        basis, forms, fixed, _ = layer("P2", k=k)
        water = sc.Model(forms, fixed).forms["water"]
        x = np.zeros(water.first + basis.mesh.nvertices)
        state = water.initial_state()
        undrained.append(water.undrained().assemble(x, state).stiffness)
        drained.append(water.over(0.1).assemble(x, state).stiffness)
    assert abs(undrained[1] - undrained[0]).max() == 0.0
    assert abs(drained[1] - drained[0]).max() > 1.0


def test_water_of_a_step_is_what_flows_through() -> None:
    """[X] Errors of a step are relative to it, half of what enters and leaves."""
    _, forms, fixed, _ = layer("P2")
    water = sc.Model(forms, fixed).forms["water"].over(1.0)
    before = water.initial_state()
    entered = np.zeros_like(before.entered)
    entered[:2] = 3.0, -3.0
    assert water.time_error(before, replace(before, entered=entered))[1] == 3.0
