"""Saturated ground in motion: displacements and pore pressures."""

import warnings
from itertools import pairwise

import numpy as np
import pytest
from skfem import Basis, ElementQuad2, ElementVector, MeshQuad

import skfem_contact as sc
from tests.dynamics.saturated_layer import Layer

QUIET = {"progress": False}
#: A layer of 10 m: M = 1e5, rho = 2, water with K_f / n = 5e6.
HEIGHT, M, RHO, S, GRAVITY = 10.0, 1e5, 2.0, 2e-7, 10.0
FIRST = 0.5 * np.pi * np.sqrt(M / RHO) / HEIGHT
DAMPING = sc.Rayleigh(0.1, f=(FIRST / 6.3, FIRST * 5.0))


def layer(k, n=16, water=True, E=M, drained=True):
    """A column, finer towards its top, and its model."""
    z = HEIGHT * (1.0 - np.linspace(1.0, 0.0, n + 1) ** 2)
    mesh = MeshQuad.init_tensor(np.array([0.0, 0.5]), z).with_defaults()
    basis = Basis(mesh, ElementVector(ElementQuad2()), intorder=4)
    forms = {"soil": sc.SolidForm(basis, sc.LinearElastic(E=E, nu=0.0), unit_weight=20.0)}
    fixed = [basis.get_dofs("bottom").all(), basis.get_dofs().all("u^1")]
    if water:
        forms["water"] = sc.PoreWater(basis, k, unit_weight=10.0, storage=S)
        if drained:
            fixed.append(forms["water"].dofs("top"))
    return basis, sc.Model(forms, fixed, gravity_acceleration=GRAVITY)


def rested(model):
    """The model under its weight, with all water drained."""
    water = model.forms.get("water")
    time = 1.0
    if water is not None:
        time = 1e3 * HEIGHT**2 / (water.mobility.max() / (1.0 / M + S))
    rest = [sc.Stage(name, duration=time) for name in ("weight", "rest")]
    return model.run(rest, **QUIET)


def shaken(model, basis, load, duration, step, **settings):
    """The stage, and times, displacements of the top and pressures of the base, from rest on."""
    top = basis.get_dofs("top").all("u^2")[0]
    base = int(np.argmin(basis.mesh.p[1]))
    rows = []

    def see(stage):
        pressure = 0.0
        if "water" in model.forms:
            pressure = stage.x[model.forms["water"].first + base]
        rows.append((stage.time, stage.x[top], pressure))

    settings = {"mass": "consistent", **settings}
    shake = sc.Stage("shake", load, duration=duration, dynamic=sc.Dynamic(step, **settings))
    rest = rested(model)
    x = rest[-1].x
    result = model.run([shake], start=rest, on_increment=see, **QUIET)
    t, u, p = np.array(rows).T
    return result["shake"], np.array([t - rest[-1].time, u - x[top], p])


def pressed(basis, amplitude):
    """A load as a function of time."""
    unit = sc.traction(basis, "top", (0.0, -1.0))
    return lambda time: amplitude(time) * unit


@pytest.mark.parametrize(
    ("k", "times", "cycles"), [(1e-1, 0.5, 7), pytest.param(1e-3, 2.0, 9, marks=pytest.mark.slow)]
)
@pytest.mark.filterwarnings("ignore:stage 'shake'. the inertia of the pore water")
def test_harmonic_load(k, times, cycles):
    """[X] Displacement of the top and pressure at the base within 1 %, in size and phase."""
    omega = times * FIRST
    period = 2.0 * np.pi / omega
    basis, model = layer(k)

    def growing(time):
        return min(time / (4.0 * period), 1.0) * np.sin(omega * time)

    load = pressed(basis, growing)
    _, (t, *found) = shaken(model, basis, load, cycles * period, period / 80, damping=DAMPING)
    # the harmonic part of the last two periods, beside what fades
    last = t > (cycles - 2) * period
    phase, late = omega * t[last], (t[last] - (cycles - 1) * period) / period
    columns = np.column_stack([np.sin(phase), np.cos(phase), *(late**j for j in range(4))])
    sizes = np.linalg.lstsq(columns, np.transpose(found)[last], rcond=None)[0]
    damped = Layer(
        M=M * (1 + 1j * omega * DAMPING.beta), rho=RHO * (1 - 1j * DAMPING.alpha / omega), b=k / 10
    )
    u, p = damped.under(omega, [HEIGHT, 0.0])
    assert abs(sizes[0, 0] + 1j * sizes[1, 0] - u[0]) < 0.01 * abs(u[0])
    assert abs(sizes[0, 1] + 1j * sizes[1, 1] - p[1]) < 0.01 * abs(p[1])


def test_what_darcys_law_leaves_out():
    """[X] Against Biot's equations u and p err by at most omega k rho / gamma_w."""
    undrained = FIRST * np.sqrt(1.0 + 1.0 / (M * S))
    z = np.linspace(0.0, HEIGHT, 21)
    for omega in (0.1 * FIRST, 0.5 * FIRST, 1.05 * FIRST, 2.0 * FIRST, 0.5 * undrained):
        for share in (0.001, 0.01, 0.1):
            ground = Layer(b=share / (omega * RHO))
            wanted = ground.under(omega, z, biot=True)
            errors = np.abs(ground.under(omega, z) - wanted).max(axis=1)
            assert (errors < 1.001 * share * np.abs(wanted).max(axis=1)).all()


def test_undrained_limit():
    """[X] Without flow, waves run with the modulus M + 1 / S."""
    period = 4.0 * HEIGHT / np.sqrt((M + 1.0 / S) / RHO)
    runs = []
    for settings in ({"k": 1e-12, "drained": False}, {"k": 0.0, "water": False, "E": M + 1.0 / S}):
        basis, model = layer(**settings)
        load = pressed(basis, lambda time: min(time / period, 1.0))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", sc.AnalysisWarning)  # no pressure is held
            runs.append(shaken(model, basis, load, 2 * period, period / 100)[1])
    wet, dry = runs
    np.testing.assert_allclose(wet[1], dry[1], rtol=0, atol=5e-3 * np.abs(dry[1]).max())


def test_drained_limit():
    """[X] Pores that drain at once leave the motion of the skeleton with the whole density."""
    period = 2.0 * np.pi / FIRST
    runs = []
    for settings in ({"k": 1e3}, {"k": 0.0, "water": False}):
        basis, model = layer(**settings)
        load = pressed(basis, lambda time: 1.0)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", sc.AnalysisWarning)  # Darcy's law without inertia
            runs.append(shaken(model, basis, load, 2 * period, period / 60)[1])
    wet, dry = runs
    np.testing.assert_allclose(wet[1], dry[1], rtol=0, atol=2e-3 * np.abs(dry[1]).max())
    assert np.abs(wet[2]).max() < 2e-3


def test_consolidation_is_the_slow_limit():
    """[X] Terzaghi's settlement, and the same as without inertia."""
    k = 1e-5
    cv = k / 10.0 / (1.0 / M + S)
    time = 0.197 * HEIGHT**2 / cv
    basis, model = layer(k)
    top = basis.get_dofs("top").all("u^2")[0]
    load = sc.traction(basis, "top", (0.0, -100.0))
    rest = rested(model)
    start = sc.Stage("load", load, duration=1e-4 * time)
    still = model.run([start, sc.Stage("wait", load, duration=time)], start=rest, **QUIET)
    settings = sc.Dynamic(time / 50.0, rho_inf=0.0)
    wait = sc.Stage("wait", load, duration=time, dynamic=settings)
    moving = model.run([start, wait], start=rest, **QUIET)
    final = 100.0 * HEIGHT / M
    undrained = final * M / (M + 1.0 / S)
    wanted = -(undrained + 0.5 * (final - undrained))
    settled = moving["wait"].x[top] - rest[-1].x[top]
    assert settled == pytest.approx(wanted, rel=0.01)
    assert settled == pytest.approx(still["wait"].x[top] - rest[-1].x[top], rel=2e-3)


def test_energy():
    """[X] The balance closes by the trapezoidal rule, and flow loses what p H p says."""
    basis, model = layer(1e-2, n=8)
    period = 2.0 * np.pi / FIRST
    load = pressed(basis, lambda time: np.sin(3.0 * FIRST * time))
    states = []
    shake = sc.Stage(
        "shake", load, duration=period, dynamic=sc.Dynamic(period / 50, rho_inf=1.0), keep="all"
    )
    stage = model.run([shake], start=rested(model), on_increment=states.append, **QUIET)["shake"]
    energy = stage.energy
    assert np.abs(energy["missing"]).max() < 1e-11 * energy["work"].max()
    pressures = [np.zeros(model.forms["water"].fields[0].n)]
    pressures += [each.states["water"].pressure for each in states]
    flow = model.forms["water"].conductivity
    lost = 0.0
    for before, after in pairwise(pressures):
        mean = 0.5 * (before + after)
        lost += period / 50 * float(mean @ flow.leaving(mean, None))
    assert energy["damping"][-1] == pytest.approx(lost, rel=1e-9)
    assert lost > 0.1 * energy["work"].max()


@pytest.mark.parametrize("rho_inf", [1.0, 0.8, 0.0])
@pytest.mark.one_in(3)
def test_second_order(rho_inf):
    """[N] Half the step gives a quarter of the error."""
    basis, model = layer(1e-2, n=6)
    period = 2.0 * np.pi / FIRST
    load = pressed(basis, lambda time: np.sin(0.5 * FIRST * time) ** 4)
    ends = []
    for steps in (40, 80, 160):
        _, rows = shaken(model, basis, load, period, period / steps, rho_inf=rho_inf)
        ends.append(rows[1:, steps // 40 - 1 :: steps // 40])
    first, second = np.linalg.norm(np.diff(ends, axis=0), axis=2)
    assert (first / second > 3.5).all()


def test_continued():
    """[X] Two stages are one, and consolidation follows a motion with its pressures."""
    basis, model = layer(1e-4, n=6)
    period = 2.0 * np.pi / FIRST
    load = sc.traction(basis, "top", (0.0, -1.0))
    settings = sc.Dynamic(period / 40)
    rest = rested(model)
    shake = sc.Stage("shake", load, duration=period, dynamic=settings)
    whole = model.run([shake], start=rest, **QUIET)
    half = sc.Stage("half", load, duration=0.5 * period, dynamic=settings)
    later = sc.Stage("later", load, duration=0.5 * period, dynamic=settings)
    parts = model.run([half, later], start=rest, **QUIET)
    again = model.run([later], start=parts["half"], **QUIET)
    largest = np.abs(whole[-1].x).max()
    np.testing.assert_array_equal(again[-1].x, parts[-1].x)
    np.testing.assert_allclose(parts[-1].x, whole[-1].x, rtol=0, atol=1e-11 * largest)
    with pytest.warns(sc.AnalysisWarning, match="has no inertia and starts from rest"):
        settled = model.run([sc.Stage("wait", load, duration=1e8)], start=whole, **QUIET)
    top = basis.get_dofs("top").all("u^2")[0]
    assert settled[-1].x[top] - rest[-1].x[top] == pytest.approx(-HEIGHT / M, rel=1e-4)


def test_outside_of_its_range():
    """[X] Motions in which water has inertia are refused or told, other water is refused."""
    quick = sc.Record(0.01, np.sin(2.0 * np.pi * 5.0 * np.arange(0.0, 2.0, 0.01)))
    basis, model = layer(1e-1, n=4)
    shake = sc.Stage("shake", duration=1.0, dynamic=sc.Dynamic(0.01), base={"y": quick})
    with pytest.raises(ValueError, match=r"inertia of the water is 0\.6.* of its resistance"):
        model.run([shake], **QUIET)
    load = pressed(basis, lambda time: np.sin(10.0 * np.pi * time) ** 2)
    with pytest.warns(sc.AnalysisWarning, match="inertia of the pore water, which is left out"):
        shaken(model, basis, load, 0.4, 0.01)
    explicit = sc.Stage("shake", duration=1.0, dynamic=sc.Dynamic(explicit=True))
    with pytest.raises(ValueError, match="pore pressures have no mass, and no explicit steps"):
        model.run([explicit], **QUIET)
    soil = sc.SolidForm(basis, sc.LinearElastic(E=M, nu=0.0), unit_weight=20.0)
    forms = {"soil": soil, "water": sc.PoreWater(basis, 1e-3, unit_weight=10.0)}
    side = sc.ViscousBoundary(soil, "right")
    with pytest.raises(ValueError, match=r"\['side'\] continue the ground without its water"):
        fixed = basis.get_dofs("bottom").all()
        model = sc.Model({**forms, "side": side}, fixed, gravity_acceleration=10.0)
        model.run([sc.Stage("shake", duration=1.0, dynamic=sc.Dynamic(0.1))], **QUIET)
    silt = sc.water.VanGenuchten(alpha=1.0, n=3.0, content=(0.05, 0.4))
    water = sc.PoreWater(basis, 1e-3, retention=silt, start=1.0, unit_weight=10.0)
    with pytest.raises(ValueError, match="'water': inertia needs saturated ground of constant"):
        model = sc.Model({"soil": soil, "water": water}, fixed, gravity_acceleration=GRAVITY)
        model.run([sc.Stage("shake", duration=1.0, dynamic=sc.Dynamic(0.1))], **QUIET)
