"""Stages in time among other stages: starts, restarts, supports, refusals."""

from __future__ import annotations

import warnings
from types import SimpleNamespace

import numpy as np
import pytest
from skfem import Basis, ElementQuad1, ElementVector, MeshQuad

import skfem_contact as sc
from skfem_contact.stages.energies import Log
from tests.dynamics.cases import QUIET, oscillator, pushed

PERIOD = 2.0 * np.pi / 100.0


def wave(time):
    """Return a force that changes in time."""
    return 3.0 * np.sin(70.0 * time)


def test_load_is_a_function_of_time():
    """[X] Undamped oscillator under F sin(w0 t) from rest: two sines, without a ramp."""
    model, basis, _top = oscillator()
    load = pushed(basis, 1.0)
    settings = sc.Dynamic(PERIOD / 200.0, rho_inf=1.0, points=[(0.0, 1.0)])
    duration = 1.5 * PERIOD
    stage = sc.Stage("shake", lambda t: wave(t) * load, duration=duration, dynamic=settings)
    result = model.run([sc.Stage("weight"), stage], **QUIET)
    motion = result["shake"].history((0.0, 1.0))
    t = motion.time
    # u = F / k (sin(w0 t) - w0 / w sin(w t)) / (1 - (w0 / w)^2)
    exact = 3e-4 * (np.sin(70.0 * t) - 0.7 * np.sin(100.0 * t)) / (1.0 - 0.49)
    found = motion.values[:, 1] - motion.values[0, 1]
    assert np.abs(found - exact).max() < 1e-3 * np.abs(exact).max()


def test_rest_stays_rest():
    """[X] Under its own weight, without any other load, a body at rest does not move."""
    model, _basis, _top = oscillator()
    settings = sc.Dynamic(PERIOD / 10.0)
    result = model.run(
        [sc.Stage("weight"), sc.Stage("wait", duration=PERIOD, dynamic=settings)], **QUIET
    )
    at_rest = result["weight"].x
    np.testing.assert_allclose(result["wait"].x, at_rest, atol=1e-12 * np.abs(at_rest).max())


def test_restart_in_the_middle():
    """[X] Two stages of half the time, in one run or two, end like one, to round-off."""
    model, basis, _top = oscillator()
    load = pushed(basis, 1.0)
    settings = sc.Dynamic(PERIOD / 64.0, rho_inf=0.7, damping=sc.Rayleigh(0.05, f=(10.0, 30.0)))
    half = PERIOD / 2.0

    def part(name, begin, duration):
        return sc.Stage(name, lambda t: wave(begin + t) * load, duration=duration, dynamic=settings)

    one = model.run([sc.Stage("weight"), part("all", 0.0, 2 * half)], **QUIET)[-1]
    first = model.run([sc.Stage("weight"), part("first", 0.0, half)], **QUIET)
    second = model.run([part("second", half, half)], start=first, **QUIET)[-1]
    for name in ("x", "velocity", "acceleration", "inertial"):
        values = getattr(one, name)
        np.testing.assert_allclose(
            getattr(second, name), values, atol=1e-12 * np.abs(values).max(), err_msg=name
        )
    assert second.time == pytest.approx(one.time)


def test_restart_from_a_file(tmp_path):
    """[X] Motion, energies and histories survive a file, from which a run continues."""
    model, basis, _top = oscillator()
    load = pushed(basis, 3.0)
    settings = sc.Dynamic(PERIOD / 20.0, points=[(0.0, 1.0)])
    stage = sc.Stage("swing", load, duration=PERIOD, dynamic=settings)
    result = model.run([sc.Stage("weight"), stage], **QUIET)
    result.save(tmp_path / "swing.npz")
    again = sc.load_result(tmp_path / "swing.npz", model)
    assert str(again["swing"].energy) == str(result["swing"].energy)
    motion = again["swing"].history((0.0, 1.0), "velocity")
    np.testing.assert_array_equal(
        motion.values, result["swing"].history((0.0, 1.0), "velocity").values
    )
    more = sc.Stage("more", load, duration=PERIOD, dynamic=settings)
    ends = [model.run([more], start=start, **QUIET)["more"].x for start in (result, again)]
    np.testing.assert_array_equal(*ends)


def test_returns_to_statics():
    """[X] A stage without inertia ends in the static equilibrium, and tells what it drops."""
    model, basis, _top = oscillator()
    load = pushed(basis, 3.0)
    swing = sc.Stage("swing", load, duration=0.3 * PERIOD, dynamic=sc.Dynamic(PERIOD / 20.0))
    stages = [sc.Stage("weight"), swing, sc.Stage("rest", load, increments=3)]
    with pytest.warns(sc.AnalysisWarning, match="starts from rest: the kinetic energy"):
        result = model.run(stages, **QUIET)
    static = model.run([sc.Stage("rest", load)], **QUIET)["rest"]
    np.testing.assert_allclose(result["rest"].x, static.x, rtol=1e-9, atol=1e-15)
    assert result["rest"].velocity is None
    # on the way the inertial forces fade in proportion
    assert result["rest"].residual < 1e-8


def test_lost_supports_leave_their_reactions():
    """[X] A column whose lower support becomes free stays at rest, as its reaction is kept."""
    model, basis, _top = oscillator()
    side = basis.get_dofs().all("u^1")
    wait = sc.Stage("free", duration=PERIOD, fixed=side, dynamic=sc.Dynamic(PERIOD / 10.0))
    result = model.run([sc.Stage("weight"), wait], **QUIET)
    before = result["weight"].x
    np.testing.assert_allclose(result["free"].x, before, atol=1e-11 * np.abs(before).max())
    # released at once, it falls with g
    fall = sc.Stage(
        "fall", duration=PERIOD, fixed=side, dynamic=sc.Dynamic(PERIOD / 40.0), release=1.0
    )
    after = model.run([sc.Stage("weight"), fall], **QUIET)["fall"]
    M = model.forms["solid"].weight_matrix(False).diagonal()
    fallen = (M * (after.x - before))[1::2].sum() / M[1::2].sum()
    assert fallen == pytest.approx(-0.5 * 10.0 * PERIOD**2, rel=1e-3)


def test_reactions_contain_inertia():
    """[X] The reaction of a swinging column is its weight and load less mass times acceleration."""
    model, basis, top = oscillator()
    load = pushed(basis, 3.0)
    settings = sc.Dynamic(PERIOD / 50.0, rho_inf=1.0)
    stage = sc.Stage("swing", load, duration=0.45 * PERIOD, dynamic=settings)
    found = model.run([sc.Stage("weight"), stage], **QUIET)["swing"]
    bottom = basis.get_dofs("bottom").all("u^2")
    reaction = found.reactions()[bottom].sum()
    free = np.setdiff1d(np.arange(basis.N), model.fixed)
    assert np.abs(found.reactions()[free]).max() < 1e-8
    # k (u - u_static) with the whole weight of 20 at rest
    moved = (found.x - model.run([sc.Stage("w")], **QUIET)["w"].x)[top[0]]
    assert reaction == pytest.approx(20.0 - 1e4 * moved, rel=1e-6)


def test_base_moves_by_a_function():
    """[X] A rigid block follows its moving supports, whose work is its kinetic energy."""
    basis = Basis(MeshQuad().with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    block = sc.SolidForm(basis, sc.LinearElastic(E=1e9, nu=0.0), unit_weight=20.0)
    model = sc.Model({"block": block}, basis.get_dofs("bottom").all(), gravity_acceleration=10.0)

    def moved(time):
        x = basis.zeros()
        x[0::2] = 1.0 - np.cos(time)
        return x

    stage = sc.Stage("move", prescribed=moved, duration=1.0, dynamic=sc.Dynamic(0.01))
    found = model.run([sc.Stage("weight"), stage], **QUIET)["move"]
    energy = found.energy
    kinetic = 0.5 * 2.0 * np.sin(1.0) ** 2
    assert energy["kinetic"][-1] == pytest.approx(kinetic, rel=1e-3)
    assert energy["work"][-1] == pytest.approx(kinetic, rel=2e-3)


def test_supports_shake():
    """[X] An oscillator on a base that moves by a sine: relative and absolute motions."""
    model, _, _ = oscillator()
    step = PERIOD / 200.0
    time = step * np.arange(401)
    record = sc.Record(step, 2.0 * np.sin(70.0 * time))
    settings = sc.Dynamic(step, rho_inf=1.0, points=[(0.0, 1.0)])
    stage = sc.Stage("shake", duration=1.5 * PERIOD, dynamic=settings, base={"y": record})
    with pytest.warns(sc.AnalysisWarning, match="ends with"):  # the sine does not end at rest
        found = model.run([sc.Stage("weight"), stage], **QUIET)["shake"]
    motion = found.history((0.0, 1.0))
    t = motion.time
    # u'' + w^2 u = -a sin(w0 t)
    exact = -2e-4 * (np.sin(70.0 * t) - 0.7 * np.sin(100.0 * t)) / (1.0 - 0.49)
    relative = motion.values[:, 1] - motion.values[0, 1]
    assert np.abs(relative - exact).max() < 1e-3 * np.abs(exact).max()
    # the spring of the absolute motion: a = -w^2 u
    absolute = found.history((0.0, 1.0), "acceleration", absolute=True).values[:, 1]
    np.testing.assert_allclose(absolute, -1e4 * relative, atol=0.01 * np.abs(absolute).max())
    moved = found.history((0.0, 1.0), absolute=True).values - motion.values
    base = 2.0 / 70.0**2 * (70.0 * t - np.sin(70.0 * t))
    np.testing.assert_allclose(moved[:, 1], base, atol=1e-3 * base.max())
    assert not moved[:, 0].any()


def test_bad_bases():
    """[X] Axes, steps and units of records are checked before the run."""
    record = sc.Record(0.02, np.sin(np.arange(100.0)))
    refused("the base moves along one of x, y, not 'z'", base={"z": record})
    refused("longer than that of the record, 0.02", base=record)
    refused("a base moves in a stage with `dynamic` alone", base=record, dynamic=None)
    model, _, _ = oscillator()
    stage = sc.Stage(
        "shake", duration=0.1, dynamic=sc.Dynamic(0.01), base={"y": record.scaled(100.0)}
    )
    with pytest.warns(sc.AnalysisWarning, match="reaches 10 times the acceleration of gravity"):
        model.run([stage], **QUIET)


def test_step_without_equilibrium_is_cut():
    """[X] Steps that fail are cut and grow again, and the stage ends at its end."""
    model, basis, _top = oscillator()
    calls = []

    class Picky(sc.Form):
        size = basis.N  # its tangent may change: the model is not linear

        def assemble(self, x, state):
            calls.append(1)
            if 5 < len(calls) < 9:
                raise sc.NotConverged("not now")
            K = model.forms["solid"].elastic_stiffness * 0.0
            return sc.Response(0.0 * x, lambda: state, lambda: K)

    forms = {**model.forms, "picky": Picky()}
    picky = sc.Model(forms, model.fixed, gravity_acceleration=10.0)
    times = []
    stage = sc.Stage("swing", pushed(basis, 3.0), duration=PERIOD, dynamic=sc.Dynamic(PERIOD / 8.0))
    picky.run([stage], on_increment=lambda s: times.append(s.time / PERIOD), **QUIET)
    sizes = np.diff([0.0, *times])
    assert times[-1] == 1.0
    assert sizes.min() < 0.125 * 0.3
    assert sizes[-1] == pytest.approx(0.125)


def refused(text, forms=None, fixed=(), model=None, **given):
    """Check the message of a stage that cannot be run."""
    basis = Basis(MeshQuad().with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    solid = sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.0), unit_weight=20.0)
    settings = {"duration": 1.0, "dynamic": sc.Dynamic(0.1), **given}
    model = {"gravity_acceleration": 10.0, **(model or {})}
    forms = {"solid": solid} if forms is None else forms(basis)
    with pytest.raises(ValueError, match=text):
        sc.Model(forms, basis.get_dofs("bottom").all(), **model).run(
            [sc.Stage("shake", **settings)], **QUIET
        )


def test_bad_input_of_stages():
    """[X] One sentence each, before anything is computed."""
    refused("takes time: give it a duration", duration=0.0)
    refused("longer than the stage", dynamic=sc.Dynamic(2.0))
    refused("give no increments: the steps of a dynamic stage", increments=5)
    refused("give Model.gravity_acceleration=9.81", model={"gravity_acceleration": None})
    refused("the velocity has shape", dynamic=sc.Dynamic(0.1, velocity=np.zeros(3)))
    refused("there are 0 nodes at", dynamic=sc.Dynamic(0.1, points=[(5.0, 5.0)]))
    with pytest.raises(ValueError, match="gravity_acceleration must be"):
        oscillator()[0].__class__(oscillator()[0].forms, gravity_acceleration=-9.81)


def test_bad_forms():
    """[X] Solids without density and soil that creeps are refused by name."""

    def light(basis):
        return {"solid": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.0))}

    def weightless(basis):
        soil = sc.LinearElastic(E=1e4, nu=0.0)
        return {"solid": sc.SolidForm(basis, soil, unit_weight=0.0)}

    def creeping(basis):
        clay = sc.SoftSoilCreep(0.02, 0.1, 1.2, 0.25, 100.0, mu=4e-3, tau=1.0)
        return {"clay": sc.SolidForm(basis, clay, unit_weight=16.0)}

    refused("'solid' has no unit_weight, from which its mass follows", light)
    refused("no form has a mass", weightless)
    refused("creeps .SoftSoilCreep., which inertia is not", creeping)


def test_searches_start_from_rest():
    """[X] A state in motion is no start of a search."""
    model, basis, _top = oscillator()
    swing = sc.Stage(
        "swing", pushed(basis, 3.0), duration=PERIOD, dynamic=sc.Dynamic(PERIOD / 20.0)
    )
    result = model.run([swing], **QUIET)
    with pytest.raises(ValueError, match="'swing' moves, and a search starts from rest"):
        model.limit_load(pushed(basis, 1.0), start=result)


def test_load_that_is_forgotten_is_told():
    """[X] Loads of stages are whole loads: one without a load has none."""
    model, basis, _top = oscillator()
    wait = sc.Stage("wait", duration=PERIOD, dynamic=sc.Dynamic(PERIOD / 20.0))
    with pytest.warns(sc.AnalysisWarning, match="the load before, of up to 1.5, is removed"):
        model.run([sc.Stage("load", pushed(basis, 3.0)), wait], **QUIET)


def test_water_of_the_start_is_no_forgotten_load():
    """[X] Ground with water at rest stays at rest in a stage with inertia, without a remark."""
    mesh = MeshQuad.init_tensor(np.linspace(0, 2, 3), np.linspace(0, 1, 3)).with_defaults()
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    ground = sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3), unit_weight=20.0)
    model = sc.Model(
        {"ground": ground},
        sc.box_supports(basis),
        water_unit_weight=10.0,
        gravity_acceleration=10.0,
    )
    start = model.k0_state(K0=0.5, water=1.0)
    still = sc.Stage("still", duration=0.1, dynamic=sc.Dynamic(0.02))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        end = model.run([still], start=start, **QUIET)["still"]
    assert np.abs(end.x).max() < 1e-15  # round-off


def test_histories_need_records():
    """[X] Nodes that are not recorded are refused by name; kept steps serve as well."""
    model, basis, _top = oscillator()
    settings = sc.Dynamic(PERIOD / 20.0, points=[(0.0, 1.0)])
    stage = sc.Stage("swing", pushed(basis, 3.0), duration=PERIOD, dynamic=settings)
    swing = model.run([stage], **QUIET)["swing"]
    with pytest.raises(ValueError, match=r"was not recorded: give Dynamic\(points=\[\(1, 1\)\]"):
        swing.history((1.0, 1.0))
    kept = sc.Stage("swing", pushed(basis, 3.0), duration=PERIOD, dynamic=settings, keep=2)
    swing = model.run([kept], **QUIET)["swing"]
    other = swing.history((1.0, 1.0), "acceleration")
    assert other.values.shape == (10, 2)
    np.testing.assert_allclose(
        other.values[:, 1], swing.history((0.0, 1.0), "acceleration").values[2::2, 1], rtol=1e-9
    )
    assert len(swing.history((0.0, 1.0)).table()) == 21
    static = model.run([sc.Stage("weight")], **QUIET)["weight"]
    with pytest.raises(ValueError, match="has no inertia"):
        static.history((0.0, 1.0))
    with pytest.raises(ValueError, match="has no inertia"):
        _ = static.energy


def test_energy_that_friction_and_yielding_take_is_not_missing() -> None:
    """[X] Of 10 remain 4; yielding takes 1, friction 3, damping 1.5, and .5 is missing."""
    columns = ("time", "kinetic", "elastic", "plastic", "friction", "damping", "work")
    rows = np.zeros((2, len(columns)))
    rows[0, 1] = 10.0
    rows[1] = 1.0, 4.0, 0.0, 1.0, 3.0, 1.5, 0.0
    assert Log.missing(SimpleNamespace(_energies=rows)) == pytest.approx(0.05)
