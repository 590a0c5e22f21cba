"""Bodies that slide to and fro, topple, and slide off: contact with large motions in time."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import ellipk
from skfem import Basis, ElementQuad1, ElementVector, MeshQuad

import skfem_contact as sc
from tests.dynamics.cases import QUIET

pytestmark = pytest.mark.filterwarnings("ignore::skfem_contact.AnalysisWarning")


def slips(record, mu, g=9.81, parts=20):
    """Return the displacement of a rigid block on a plane that shakes, in both directions."""
    dt = record.step / parts
    v, moved = 0.0, [0.0]
    for a0, a1 in zip(record.values, record.values[1:], strict=False):
        for j in range(parts):
            drive = -(a0 + (j + 0.5) / parts * (a1 - a0))
            if v == 0.0 and abs(drive) <= mu * g:
                new = 0.0
            else:
                against = np.sign(v) if v != 0.0 else np.sign(drive)
                new = v + dt * (drive - against * mu * g)
                # a block that stops may stick
                if v * new < 0.0:
                    new = 0.0
            if j == 0:
                moved.append(moved[-1])
            moved[-1] += 0.5 * dt * (v + new)
            v = new
    return np.array(moved)


def block_on_a_plane(b, h, mu, E=2e6, edge=5.0, shape=(2, 1), **options):
    """Return a model and its basis: a block of b x h on a rigid plane that ends at an edge."""
    x, y = np.linspace(-b / 2, b / 2, shape[0] + 1), np.linspace(0.0, h, shape[1] + 1)
    basis = Basis(
        MeshQuad.init_tensor(x, y).with_defaults(), ElementVector(ElementQuad1()), intorder=2
    )
    solid = sc.SolidForm(basis, sc.LinearElastic(E=E, nu=0.0), unit_weight=20.0, **options)
    floor = sc.rigid.line((-5.0, 0.0), (edge, 0.0))
    pair = sc.ContactPair(basis, "bottom", floor, sc.Coulomb(mu=mu), "nodal")
    return sc.Model({"block": solid, "pair": pair}, gravity_acceleration=9.81), basis


@pytest.mark.slow
@pytest.mark.exhaustive
def test_friction_that_turns_round():
    """[N] A block on a level plane slides to both sides like a rigid block, and dissipates."""
    mu, step = 0.2, 1.25e-3
    time = step * np.arange(481)
    record = sc.Record(step, 6.0 * np.sin(4.0 * np.pi * time) * (time <= 0.5))
    exact = slips(record, mu)
    model, _ = block_on_a_plane(2.0, 0.5, mu)
    settings = sc.Dynamic(step, damping=sc.Rayleigh(0.02, f=(1e-3, 32.0)), points=[(0.0, 0.0)])
    stage = sc.Stage("shake", duration=time[-1], dynamic=settings, base=record)
    found = model.run([sc.Stage("weight"), stage], **QUIET)["shake"]
    slip = found.history((0.0, 0.0)).values[:, 0]
    slip = slip - slip[0]
    span = exact.max() - exact.min()
    # both directions count
    assert exact.min() < -0.2 * span or exact.max() > 0.2 * span
    way = np.abs(np.diff(exact)).sum()
    assert way > 1.5 * abs(exact[-1])
    assert np.abs(slip - exact).max() < 0.01 * span
    # friction takes mu N on the way, whatever its direction
    weight = 20.0 * 2.0 * 0.5
    energy = found.energy
    assert energy["friction"][-1] == pytest.approx(mu * weight * way, rel=0.01)
    assert (np.diff(energy["friction"]) > -1e-6 * energy["friction"][-1]).all()


def rocks(share, step, duration, E):
    """Return angles of a rocking block, and its energies; share 1 turns its diagonal upright."""
    b, h, g = 0.5, 1.0, 9.81
    R = 0.5 * np.hypot(b, h)
    # 1/2 I w^2 = m g (R - h / 2) with I = 4/3 m R^2 about the corner
    turning = share * np.sqrt(1.5 * g * (R - 0.5 * h)) / R
    model, basis = block_on_a_plane(b, h, 2.0, E, shape=(2, 4), kinematics="finite")
    v = basis.zeros()
    v[0::2] = turning * basis.mesh.p[1]
    v[1::2] = -turning * (basis.mesh.p[0] - b / 2)
    settings = sc.Dynamic(
        step,
        mass="consistent",
        contact_mass="kept",
        velocity=v,
        points=[(-b / 2, 0.0), (b / 2, 0.0)],
    )
    found = model.run([sc.Stage("fall", duration=duration, dynamic=settings)], **QUIET)["fall"]
    left, right = (found.history(x).values for x in settings.points)
    apart = left - right
    angle = np.unwrap(np.arctan2(apart[:, 1], b - apart[:, 0]))
    return angle, found.energy


@pytest.mark.slow
@pytest.mark.parametrize(("share", "topples"), [(0.96, False), (1.04, True)])
def test_a_block_topples(share, topples):
    """[X] A block that turns about its corner topples if its diagonal passes the vertical."""
    angle, energy = rocks(share, 0.01, 1.6, 2e5)
    slender = np.arctan2(0.5, 1.0)
    if topples:
        assert angle[-1] > 1.2 * slender
    else:
        # cos(slender - angle) - cos(slender) = share^2 (1 - cos(slender))
        cosine = np.cos(slender) + share**2 * (1.0 - np.cos(slender))
        assert angle.max() == pytest.approx(slender - np.arccos(cosine), rel=0.01)
        assert angle[-1] < 0.5 * angle.max()
    # bodies and penalties gain nothing, through the impact too
    total = energy["kinetic"] + energy["elastic"] - energy["work"]
    assert total.max() < total[0] * (1.0 + 1e-3)


@pytest.mark.filterwarnings("default::skfem_contact.AnalysisWarning")
def test_energy_that_contact_gives_is_told():
    """A stiff block that meets the plane within a long step bounces higher than it fell."""
    with pytest.warns(sc.AnalysisWarning, match=r"contact that closes and opens gives \d+% of the"):
        _, energy = rocks(0.5, 0.01, 0.5, 2e6)
    assert energy["friction"].min() < -0.02 * energy["kinetic"].max()


@pytest.mark.slow
def test_a_block_slides_off():
    """[X] Without friction a block keeps its velocity, and falls freely beyond the edge."""
    b, h, g, speed = 1.0, 0.5, 9.81, 8.0
    model, basis = block_on_a_plane(b, h, 0.0, edge=1.0, kinematics="finite")
    v = basis.zeros()
    v[0::2] = speed
    settings = sc.Dynamic(0.0025, mass="consistent", contact_mass="kept", velocity=v)
    mass = np.asarray(sc.weight(basis, 1.0, (1.0, 0.0)))[::2]
    mass = mass / mass.sum()
    rows = []

    def watch(stage):
        if stage.velocity is None:
            return
        speeds = [mass @ stage.velocity[k::2] for k in (0, 1)]
        force = stage.contact("pair").force[1]
        rows.append((stage.time, mass @ stage.x[::2], *speeds, force))

    held, free = np.arange(0, basis.N, 2), np.zeros(0, int)
    slide = sc.Stage("slide", duration=0.3, dynamic=settings, fixed=free)
    stages = [sc.Stage("weight", fixed=held), slide]
    found = model.run(stages, on_increment=watch, **QUIET)["slide"]
    time, x, vx, vy, force = np.array(rows).T
    # no horizontal force acts
    np.testing.assert_allclose(vx, speed, rtol=1e-6)
    np.testing.assert_allclose(x, speed * time, rtol=1e-6)
    # it rests on the plane at first, and has left it at the end
    weight = 20.0 * b * h
    assert np.abs(force[time < 0.05]) == pytest.approx(weight, rel=0.02)
    free = x > 1.0 + b / 2 + 0.05
    assert free.sum() > 20
    assert np.abs(force[free]).max() == 0.0
    rate = np.diff(vy[free]) / np.diff(time[free])
    # the scheme forgets the last contact by half a step
    np.testing.assert_allclose(rate[-20:], -g, rtol=1e-5)
    energy = found.energy
    total = energy["kinetic"] + energy["elastic"] - energy["work"]
    assert total.max() < total[0] + 1e-3 * weight * b


@pytest.mark.slow
@pytest.mark.parametrize("angle", [30.0, 150.0])
def test_a_rod_swings_as_a_pendulum(angle):
    """[X] The period of a physical pendulum, 4 K(sin(a / 2)) sqrt(2 L / 3 g), for any angle."""
    a = np.radians(angle)
    end = (np.sin(a), -np.cos(a))
    line = np.linspace((0.0, 0.0), end, 5)
    rod = sc.Beam(None, line, EI=1e3, EA=1e6, unit_weight=10.0, kinematics="finite")
    model = sc.Model({"rod": rod}, rod.dofs((0.0, 0.0), ["u^1", "u^2"]), gravity_acceleration=9.81)
    period = 4.0 * ellipk(np.sin(0.5 * a) ** 2) * np.sqrt(2.0 / (3.0 * 9.81))
    settings = sc.Dynamic(period / 400.0, rho_inf=1.0, points=rod.at(end))
    swing = model.run([sc.Stage("swing", duration=period, dynamic=settings)], progress=False)[-1]
    # it comes back; steps of a 400th leave 2e-5 of the way
    tip = model.forms["rod"].numbers(end)[:2]
    assert np.abs(swing.x[tip]).max() < 5e-5
    # half a period before it was on the other side, at rest
    path = swing.history(rod.at(end))
    np.testing.assert_array_equal(path.values[-1], swing.x[tip])
    np.testing.assert_allclose(path.values[200], (-2.0 * np.sin(a), 0.0), atol=5e-5)
    np.testing.assert_array_equal(path.point, end)
    energy = swing.energy
    assert abs(energy["missing"][-1]) < 1e-8 * np.abs(energy["work"]).max()
