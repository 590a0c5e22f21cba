"""Viscous boundaries and rock: site response, pulses in a half-space, angles of incidence."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import Basis, ElementQuad1, ElementVector, MeshQuad

import skfem_contact as sc
from skfem_contact.dynamics.boundaries import Masses
from tests.dynamics.cases import QUIET

H, VS, DENSITY = 20.0, 200.0, 2.0
G = DENSITY * VS**2


def column(n=40, rock=None, height=H):
    """Return the model of a column that shears, on supports or on rock, and its basis."""
    mesh = MeshQuad.init_tensor([0.0, height / n], np.linspace(0, height, n + 1)).with_defaults()
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    soil = sc.LinearElastic(E=2.0 * G * 1.3, nu=0.3)
    solid = sc.SolidForm(basis, soil, "full", unit_weight=10.0 * DENSITY)
    forms = {"soil": solid}
    vertical = np.arange(1, basis.N, 2)
    bottom = basis.get_dofs("bottom").all()
    if rock is not None:
        forms["base"] = sc.ViscousBoundary(solid, "bottom", rock=rock)
    model = sc.Model(forms, [vertical, bottom], gravity_acceleration=10.0)
    return model, basis, vertical


def transfer(motion, base, step):
    """Return frequencies and the ratio of the spectra of two histories."""
    f = np.fft.rfftfreq(len(base), step)
    return f, np.abs(np.fft.rfft(motion) / np.fft.rfft(base))


@pytest.mark.parametrize("impedance", [None, 0.2])
def test_site_response(impedance):
    """[X] Amplification of a damped layer on rigid and on elastic rock at its first three modes."""
    step, duration = 0.0025, 8.0
    time = step * np.arange(int(duration / step) + 1)
    # a short pulse with all frequencies up to 15 Hz
    pulse = np.exp(-(((time - 0.1) / 0.012) ** 2))
    record = sc.Record(step, pulse - 1.2 * np.exp(-(((time - 0.15) / 0.0144) ** 2)))
    record = sc.Record(step, np.gradient(record.values, step) * 0.01)
    damping = sc.Rayleigh(0.08, f=(2.5, 12.5))
    rock = None
    if impedance is not None:
        rock = sc.Bedrock(unit_weight=25.0, vs=DENSITY * VS / (2.5 * impedance))
    model, _basis, vertical = column(40, rock)
    settings = sc.Dynamic(step, rho_inf=1.0, damping=damping, points=[(0.0, H)])
    stage = sc.Stage(
        "shake",
        duration=duration,
        dynamic=settings,
        base=record,
        fixed=None if rock is None else vertical,
    )
    found = model.run([stage], **QUIET)["shake"]
    surface = found.history((0.0, H), "acceleration", absolute=True).values[:, 0]
    f, ratio = transfer(surface, record.values, step)

    # G (1 + i beta w) u'' = -rho (w^2 - i alpha w) u; damping of masses is relative to the base
    w = 2.0 * np.pi * f[1:]
    modulus = G * (1.0 + 1j * damping.beta * w)
    squares = w**2 - 1j * damping.alpha * w
    k = np.sqrt(DENSITY * squares / modulus)
    if rock is None:
        exact = np.abs(1.0 + w**2 / squares * (1.0 / np.cos(k * H) - 1.0))
    else:
        q = k * modulus / (w * DENSITY * VS / impedance)
        exact = 1.0 / np.abs(np.cos(k * H) + 1j * q * np.sin(k * H))
    for mode in (2.5, 7.5, 12.5):
        near = np.abs(f[1:] - mode) < 0.5
        largest = np.argmax(exact * near)
        # 8 elements in the shortest wave and 32 steps in the shortest period
        assert ratio[1:][near].max() == pytest.approx(exact[largest], rel=0.01), mode


def test_pulse_in_a_half_space():
    """[X] A wave of velocity v/2 doubles at the surface and leaves without return."""
    step = 0.002
    time = step * np.arange(301)
    rise = (time - 0.1) / 0.03
    velocity = 0.1 * np.exp(-(rise**2))
    record = sc.Record(step, np.gradient(velocity, step))
    rock = sc.Bedrock(unit_weight=10.0 * DENSITY, vs=VS)
    model, _, vertical = column(40, rock)
    settings = sc.Dynamic(step, rho_inf=1.0, points=[(0.0, 0.0), (0.0, H)])
    stage = sc.Stage("pulse", duration=0.6, dynamic=settings, base=record, fixed=vertical)
    found = model.run([stage], **QUIET)["pulse"]
    surface = found.history((0.0, H), "velocity").values[:, 0]
    exact = np.interp(time - H / VS, time, record.velocity, left=0.0)
    assert np.abs(surface - exact).max() < 0.02 * 0.1
    # after the wave has left, nothing moves
    assert np.abs(found.velocity).max() < 1e-3
    energy = found.energy
    assert energy["kinetic"][-1] < 1e-4 * energy["kinetic"].max()
    assert energy["damping"][-1] == pytest.approx(energy["work"][-1], rel=1e-3)


def test_bar_without_reflection():
    """[X] A wave of pressure along a bar leaves at its end: none of its energy comes back."""
    n = 100
    mesh = MeshQuad.init_tensor(np.linspace(0, 1, n + 1), [0.0, 0.01]).with_defaults()
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    solid = sc.SolidForm(basis, sc.LinearElastic(E=100.0, nu=0.0), unit_weight=10.0)
    forms = {"bar": solid, "end": sc.ViscousBoundary(solid, "right")}
    across = np.arange(1, basis.N, 2)
    held = np.union1d(across, basis.get_dofs("right").all())
    model = sc.Model(forms, held, gravity_acceleration=10.0)
    load = np.asarray(sc.traction(basis, "left", (1.0, 0.0)))

    def push(t):
        return load * np.exp(-(((t - 0.03) / 0.01) ** 2))

    stage = sc.Stage(
        "push", push, duration=0.25, dynamic=sc.Dynamic(5e-4, rho_inf=1.0), fixed=across
    )
    energy = model.run([stage], **QUIET)["push"].energy
    assert energy["kinetic"].max() > 0.4 * energy["work"][-1]
    # elements are a twentieth of the shortest wave
    assert energy["kinetic"][-1] < 1e-3 * energy["kinetic"].max()


@pytest.mark.parametrize("of_rock", [False, True])
def test_dashpots_of_a_cylinder_are_per_radian(of_rock: bool) -> None:
    """[X] Waves that leave a cylinder of radius 2 and height 3 by its base and by its side, against
    unit velocities: rho vp times the area per radian, and rho vs along it.
    """
    mesh = MeshQuad.init_tensor(np.linspace(0, 2, 4), np.linspace(0, 3, 4)).with_defaults()
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    soil = sc.LinearElastic(E=100.0, nu=0.25)  # moduli 120 and 40 of waves of pressure and shear
    solid = sc.SolidForm(basis, soil, coordinates="axisymmetric", unit_weight=20.0)
    rock = sc.Bedrock(unit_weight=30.0, vs=7.0, vp=11.0) if of_rock else None
    normal, along = (33.0, 21.0) if of_rock else (np.sqrt(2.0 * 120.0), np.sqrt(2.0 * 40.0))
    masses = Masses(acceleration=10.0, consistent=False, damping={}, size=basis.N)
    for boundary, area, across in (("bottom", 2.0, 1), ("right", 6.0, 0)):
        stiffness, C = sc.ViscousBoundary(solid, boundary, rock=rock).matrices(masses)
        assert not stiffness.nnz
        for c in (0, 1):
            velocity = np.zeros(basis.N)
            velocity[c::2] = 1.0
            expected = area * (normal if c == across else along)
            # Gauss points integrate the radius times linear functions exactly.
            assert velocity @ C @ velocity == pytest.approx(expected, rel=1e-12)


def test_bad_boundaries():
    """[X] One sentence each: no weight, inside, no element, held."""
    model, basis, _ = column()
    light = sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3))
    with pytest.raises(ValueError, match="needs its unit_weight"):
        sc.ViscousBoundary(light, "bottom")
    solid = model.forms["soil"]
    with pytest.raises(ValueError, match="no boundary 'base'"):
        sc.ViscousBoundary(solid, "base")
    parts = {"low": lambda x: x[1] < 10.0, "high": lambda x: x[1] > 10.0}
    mesh = basis.mesh.with_subdomains(parts)
    mesh = mesh.with_boundaries({"middle": mesh.facets_satisfying(lambda x: x[1] == 10.0)})
    inner = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    soil = sc.LinearElastic(E=1e4, nu=0.3)
    with pytest.raises(ValueError, match=r"lies inside of the mesh at .0.25, 10."):
        sc.ViscousBoundary(sc.SolidForm(inner, soil, unit_weight=20.0), "middle")
    high = sc.SolidForm(inner.with_elements("high"), soil, unit_weight=20.0)
    with pytest.raises(ValueError, match="1 facets of boundary 'bottom' belong to no element"):
        sc.ViscousBoundary(high, "bottom")
    with pytest.raises(ValueError, match="vp, the velocity of pressure waves, must be"):
        sc.Bedrock(unit_weight=24.0, vs=800.0, vp=800.0)
    forms = {"soil": solid, "base": sc.ViscousBoundary(solid, "bottom")}
    held = sc.Model(forms, model.fixed, gravity_acceleration=10.0)
    stage = sc.Stage("shake", duration=1.0, dynamic=sc.Dynamic(0.1))
    with pytest.raises(ValueError, match="all 4 dofs of 'base' are held"):
        held.run([stage], **QUIET)


def test_boundaries_do_nothing_in_statics():
    """[X] The weight is held by supports alone, and a body without any is refused."""
    model, _basis, vertical = column(rock=sc.Bedrock(unit_weight=24.0, vs=800.0))
    plain, _, _ = column()
    both = [each.run([sc.Stage("weight")], **QUIET)["weight"].x for each in (model, plain)]
    np.testing.assert_array_equal(*both)
    loose = sc.Model(model.forms, vertical, gravity_acceleration=10.0)
    with pytest.raises(ValueError, match="is not held"):
        loose.run([sc.Stage("weight")], **QUIET)


def test_boundary_of_weightless_ground():
    """[X] Dashpots of nothing are refused in the stage, by name."""
    basis = Basis(MeshQuad().with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    soft = sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3), unit_weight=20.0)
    light = sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3), unit_weight=0.0)
    forms = {"ground": soft, "side": sc.ViscousBoundary(light, "left")}
    model = sc.Model(forms, basis.get_dofs("bottom").all(), gravity_acceleration=9.81)
    shake = sc.Stage("shake", duration=1.0, dynamic=sc.Dynamic(0.1))
    with pytest.raises(ValueError, match="ground at 'side' has no stiffness or no weight"):
        model.run([shake], progress=False)


@pytest.mark.parametrize("second", [sc.ViscousBoundary, sc.FreeField])
def test_two_boundaries_for_waves_at_one_side_are_refused(second):
    """Their dashpots added up, and held back the motion of the free field."""
    basis = Basis(MeshQuad().with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    soil = sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3), unit_weight=20.0)
    forms = {"soil": soil, "left": sc.ViscousBoundary(soil, "left"), "again": second(soil, "left")}
    model = sc.Model(forms, basis.get_dofs("bottom").all(), gravity_acceleration=9.81)
    shake = sc.Stage("shake", duration=1.0, dynamic=sc.Dynamic(0.1))
    with pytest.raises(ValueError, match="twice at 1 facets, through 'left' and 'again'"):
        model.run([shake], progress=False)
