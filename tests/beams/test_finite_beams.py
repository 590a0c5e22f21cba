"""Beams and bars that turn far, snap through and buckle."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_bvp
from scipy.optimize import brentq
from scipy.special import ellipe, ellipeinc, ellipk, ellipkinc
from skfem import Basis, ElementQuad2, ElementVector, MeshQuad

import skfem_contact as sc
from skfem_contact.beams.corotation import Turned
from tests.tools.helpers import moved_rigidly

L, EI = 10.0, 100.0


def straight(n, end=(L, 0.0), EA=1e5, **options):
    """Beam from the origin of n elements."""
    line = np.linspace((0.0, 0.0), end, n + 1)
    return sc.Beam(None, line, EI=EI, EA=EA, **options)


def cantilever(n, **options):
    """Model of a beam that is clamped at the origin."""
    beam = straight(n, kinematics="finite", **options)
    return sc.Model({"beam": beam}, beam.dofs((0.0, 0.0)))


def elements(seed=0):
    """Two curved elements, motions of their nodes and a stiffness without rigid translations."""
    rng = np.random.default_rng(seed)
    points = np.array([[[0, 0], [1, 0.3], [0.45, 0.2]], [[1, 0.3], [2, 0], [1.5, 0.15]]])
    u = 0.4 * rng.normal(size=(2, 9))
    u[:, 6:] += 1.0
    K = rng.normal(size=(2, 9, 9))
    K = K + K.transpose(0, 2, 1)
    rigid = np.zeros((9, 2))
    rigid[0:6:2, 0] = rigid[1:6:2, 1] = 1.0 / np.sqrt(3.0)
    away = np.eye(9) - rigid @ rigid.T
    return points, u, away @ K @ away


def differences(function, u, h=1e-6):
    """Differences of an array by the motions (m, 9), along a last axis."""
    columns = []
    for k in range(9):
        step = np.zeros(u.shape)
        step[:, k] = h
        columns.append((function(u + step) - function(u - step)) / (2.0 * h))
    return np.stack(columns, axis=-1)


def test_force_is_gradient_and_tangent_its_derivative():
    """[N] Differences of the energy give the force, those of the force the tangent."""
    points, u, K = elements()

    def energy(u):
        motions = Turned(points, u).motions
        return 0.5 * np.einsum("mi,mij,mj->m", motions, K, motions)

    def force(u):
        turned = Turned(points, u)
        return turned.force(np.einsum("mij,mj->mi", K, turned.motions))

    turned = Turned(points, u)
    local = np.einsum("mij,mj->mi", K, turned.motions)
    tangent = turned.tangent(K, local)
    assert np.allclose(differences(energy, u), force(u), atol=1e-8)
    # central differences of 1e-6 leave 1e-9 of the entries
    assert np.abs(differences(force, u) - tangent).max() < 1e-8 * np.abs(tangent).max()
    assert np.allclose(tangent, tangent.transpose(0, 2, 1))


def test_two_turns_of_an_element_leave_no_strain():
    """[X] Rigid rotations, also by more than one turn, have no motions in the frame."""
    points, _, _ = elements()
    for angle in (0.1, 3.0, 4.0 * np.pi, -7.0):
        R = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        moved = points @ R.T + (3.0, -1.0)
        u = np.hstack(((moved - points).reshape(-1, 6), np.full((2, 3), angle)))
        # displacements of 3 lose 1e-16 of their size
        assert np.abs(Turned(points, u).motions).max() < 1e-14


def test_beam_rolls_up_to_a_circle():
    """[X] The moment 2 pi EI / L bends a cantilever to a full circle, whatever the mesh."""
    model = cantilever(8)
    beam = model.forms["beam"]
    stage = sc.Stage("roll", beam.load((0.0, 0.0), (L, 0.0), 2 * np.pi * EI / L), increments=16)
    end = model.run([stage])["roll"]
    tip = end.x[beam.numbers((L, 0.0))]
    assert tip == pytest.approx([-L, 0.0, 2 * np.pi], abs=1e-6)
    moment = end.section_forces("beam").M
    assert np.allclose(moment, -2 * np.pi * EI / L, rtol=1e-6)


def elastica(load):
    """Tip of a cantilever: displacements back and across over L, and slope, by P L^2 / EI."""
    a = np.sqrt(load)

    def missing(k):
        return ellipk(k * k) - ellipkinc(np.arcsin(1 / (k * np.sqrt(2))), k * k) - a

    k = brentq(missing, 1 / np.sqrt(2) + 1e-12, 1 - 1e-14)
    begin = np.arcsin(1 / (k * np.sqrt(2)))
    across = 1 - 2 / a * (ellipe(k * k) - ellipeinc(begin, k * k))
    back = 1 - np.sqrt(2) / a * np.sqrt(2 * k * k - 1)
    return np.array([back, across, np.arcsin(2 * k * k - 1)])


@pytest.mark.slow
def test_elastica_by_order():
    """[X] Large deflections of a cantilever under a force, closed form by elliptic integrals."""
    errors = []
    for n in (4, 8, 16):
        model = cantilever(n, EA=1e6, GA=1e7)
        beam = model.forms["beam"]
        load = beam.load((0.0, -10 * EI / L**2), (L, 0.0))
        end = model.run([sc.Stage("bend", load, increments=5)])["bend"]
        tip = -end.x[beam.numbers((L, 0.0))] / (L, L, 1.0)
        errors.append(np.abs(tip / elastica(10.0) - 1).max())
    assert errors[-1] < 7e-4
    # order 2
    assert errors[0] / errors[1] > 3.0
    assert errors[1] / errors[2] > 3.0


def toggle_by_ode(span, rise, EI, EA, GA, deflection):
    """Force on half a toggle frame at a deflection of its apex, by Reissner's beam."""
    length = np.hypot(span, rise)
    slope = np.arctan2(rise, span)

    # x, y, theta, M, with the forces H and V on a section as parameters
    def rates(s, z, p):
        _, _, theta, M = z
        c, sn = np.cos(theta), np.sin(theta)
        N = p[0] * c + p[1] * sn
        Q = -p[0] * sn + p[1] * c
        eps, gamma = N / EA, Q / GA
        along, across = 1 + eps, gamma
        return np.stack(
            (along * c - across * sn, along * sn + across * c, M / EI, across * N - along * Q)
        )

    def ends(a, b, p):
        return np.array(
            [a[0], a[1], a[2] - slope, b[0] - span, b[1] - rise + deflection, b[2] - slope]
        )

    s = np.linspace(0.0, length, 41)
    guess = np.stack((s / length * span, s / length * (rise - deflection), 0 * s + slope, 0 * s))
    found = solve_bvp(rates, ends, s, guess, p=[-10.0, -10.0], tol=1e-8, max_nodes=20000)
    assert found.success
    return -found.p[1]


def toggle_forces(n, deflections, span, rise, EI, EA):
    """Forces on half a toggle frame of n elements at deflections of its apex."""
    line = np.linspace((0.0, 0.0), (span, rise), n + 1)
    beam = sc.Beam(None, line, EI=EI, EA=EA, kinematics="finite")
    model = sc.Model({"b": beam}, [*beam.dofs((0.0, 0.0)), *beam.dofs((span, rise))])
    form = model.forms["b"]
    apex = form.numbers((span, rise))[1]
    stages = []
    for deflection in deflections:
        prescribed = np.zeros(model.layout.size)
        prescribed[apex] = -deflection
        stages.append(sc.Stage(f"{deflection}", prescribed=prescribed, increments=2))
    found = []
    for stage in model.run(stages):
        found.append(-form.assemble(stage.x, stage.states["b"]).force[apex])
    return np.array(found)


def test_toggle_frame_passes_its_limit():
    """[N] Half of a shallow clamped frame that snaps through, beside Reissner's beam by an ODE."""
    frame = {"span": 12.943, "rise": 0.386, "EI": 9.27e3, "EA": 1.885e6}
    deflections = (0.1, 0.25, 0.4, 0.5, 0.6)
    exact = [toggle_by_ode(**frame, GA=frame["EA"] / 3, deflection=each) for each in deflections]
    assert exact[2] < exact[1]  # it has passed the limit
    errors = [np.abs(toggle_forces(n, deflections, **frame) / exact - 1).max() for n in (8, 16, 32)]
    assert errors[-1] < 2e-3
    # order 2
    assert errors[0] / errors[1] > 3.5
    assert errors[1] / errors[2] > 3.5


def test_thrust_amplifies_a_sway():
    """[X] A column under P and H at its free top sways by H (tan(kL) - kL) / (P k)."""
    k = 1.0 / L
    P = k**2 * EI
    H = 1e-4 * P
    column = straight(32, (0.0, L), EA=1e6, GA=1e7, kinematics="finite")
    model = sc.Model({"column": column}, column.dofs((0.0, 0.0)))
    form = model.forms["column"]
    end = model.run([sc.Stage("sway", form.load((H, -P), (0.0, L)))])["sway"]
    sway = end.x[form.numbers((0.0, L))[0]]
    # elements of L / 32 are 1.4e-4 too stiff
    assert sway == pytest.approx(H * (np.tan(k * L) - k * L) / (P * k), rel=3e-4)


def test_plastic_hinge_sways_under_thrust():
    """[X] A column with a plastic hinge at its foot resists H = (Mp - P u) / height."""
    Mp, P = 5.0, 0.5
    column = straight(4, (0.0, L), EA=1e5, Mp=Mp, kinematics="finite")
    model = sc.Model({"column": column}, column.dofs((0.0, 0.0)))
    form = model.forms["column"]
    top = form.numbers((0.0, L))[0]
    thrust = form.load((0.0, -P), (0.0, L))
    swayed = model.layout.size * [0.0]
    swayed[top] = 2.5
    fixed = [*column.dofs((0.0, 0.0)), *column.dofs((0.0, L), ["u^1"])]
    end = model.run(
        [
            sc.Stage("thrust", thrust),
            sc.Stage("push", thrust, prescribed=np.array(swayed), fixed=fixed, increments=20),
        ]
    )["push"]
    H = form.assemble(end.x, end.states["column"]).force[top]
    # moments balance about the foot with displacements as found; hinges flow at Mp
    height = L + end.x[form.numbers((0.0, L))[1]]
    assert H * height + P * 2.5 == pytest.approx(Mp, rel=1e-5)


def test_truss_of_two_bars_snaps_through():
    """[X] Von Mises' truss: P = 2 EA (l0 - l) / l0 (h - v) / l."""
    EA, a, h = 1e3, 1.0, 0.5
    mesh = MeshQuad.init_tensor([-0.1, 0.0, 0.1], [0.4, h]).with_defaults()
    basis = Basis(mesh, ElementVector(ElementQuad2()), intorder=4)
    bars = sc.Bar(
        basis,
        [(0.0, h), (0.0, h)],
        [(-a, 0.0), (a, 0.0)],
        EA=EA,
        fixed_end=True,
        kinematics="finite",
    )
    body = sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.0), kinematics="finite")
    everything = np.arange(basis.N)
    model = sc.Model({"bars": bars, "body": body}, everything)
    apex = basis.nodal_dofs[1, np.argmin(np.hypot(*(mesh.p - [[0.0], [h]])))]
    l0 = np.hypot(a, h)
    for v in (0.1, 0.4, 0.5, 0.9, 1.2):
        moved = basis.zeros()
        moved[1::2] = -v
        end = model.run([sc.Stage("press", prescribed=moved)])["press"]
        response = model.forms["bars"].assemble(end.x, end.states["bars"])
        length = np.hypot(a, h - v)
        exact = 2 * EA * (l0 - length) / l0 * (h - v) / length
        whole = np.zeros(basis.N)
        whole[model.forms["bars"].acts_on] = response.force
        assert -whole[apex] == pytest.approx(exact, abs=1e-9 * EA)


@pytest.mark.parametrize("fixed_end", [True, False])
def test_tangent_of_a_bar_is_the_derivative_of_its_force(fixed_end):
    """[N] Differences of forces, in space, where both ends move or one."""
    beam = sc.Beam(None, [[0.0, 0.0, 0.0], [1.0, 0.3, 0.2]], EI=1.0, EA=1.0)
    ends = (beam.at((0.0, 0.0, 0.0)), [(0.0, 0.0, 2.0)] if fixed_end else beam.at((1.0, 0.3, 0.2)))
    bar = sc.Bar(None, *ends, EA=50.0, fixed_end=fixed_end, kinematics="finite")
    numbers = {beam.displacement: np.arange(beam.displacement.n)}
    bar = bar.numbered(numbers)
    x = 0.3 * np.random.default_rng(2).normal(size=beam.displacement.n)
    state = bar.initial_state(0.5 * x)

    def force(x):
        return bar.assemble(x, state).force

    K = bar.assemble(x, state).stiffness.toarray()
    h = 1e-6
    for column, dof in enumerate(bar.acts_on):
        step = np.zeros(len(x))
        step[dof] = h
        found = (force(x + step) - force(x - step)) / (2 * h)
        assert np.allclose(K[:, column], found, atol=1e-7)


def test_wall_turns_with_its_ground():
    """[X] A beam bonded to a body that turns by 40 degrees has no section forces."""
    mesh = MeshQuad.init_tensor([0.0, 0.5, 1.0], [0.0, 0.5, 1.0]).with_defaults()
    basis = Basis(mesh, ElementVector(ElementQuad2()), intorder=4)
    body = sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.3), kinematics="finite")
    wall = sc.Beam(basis, "left", EI=1.0, EA=100.0, kinematics="finite")
    held = np.unique(np.concatenate([basis.get_dofs(name).all() for name in ("left", "right")]))
    model = sc.Model({"body": body, "wall": wall}, held)

    def turning(share):
        values = np.zeros(model.layout.size)
        values[: basis.N] = moved_rigidly(basis, 40.0 * share, (0.0, 0.0))
        return values

    end = model.run([sc.Stage("turn", prescribed=turning, increments=16)])["turn"]
    forces = end.section_forces("wall")
    assert np.abs(forces.N).max() < 1e-7
    assert np.abs(forces.M).max() < 1e-8
    assert np.allclose(end.x[basis.N :], np.radians(40.0))


def test_state_is_saved_and_resumed(tmp_path):
    """[N] A run that continues from a file gives the digits of one that goes on."""
    model = cantilever(4)
    beam = model.forms["beam"]
    half = sc.Stage("half", beam.load((0.0, -2.0), (L, 0.0)), increments=2)
    whole = sc.Stage("whole", beam.load((0.0, -5.0), (L, 0.0)), increments=2)
    straight_on = model.run([half, whole])[-1]
    model.run([half]).save(tmp_path / "half")
    resumed = model.run([whole], start=sc.load_result(tmp_path / "half", model))[-1]
    assert np.allclose(resumed.x, straight_on.x, rtol=0, atol=1e-8)


#: Buckling load over pi^2 EI / L^2 of a column by its ends; 4.4934 is the root of tan x = x.
ENDS = {
    ("clamped", "free"): 0.25,
    ("pinned", "pinned"): 1.0,
    ("clamped", "pinned"): 4.493409458**2 / np.pi**2,
    ("clamped", "clamped"): 4.0,
}


def column(n, foot, top):
    """Model of a column with its supports."""
    beam = straight(n, (0.0, L), EA=1e6, GA=1e7)
    fixed = [*beam.dofs((0.0, 0.0), None if foot == "clamped" else ["u^1", "u^2"])]
    if top != "free":
        fixed += beam.dofs((0.0, L), ["u^1"] + ["theta"] * (top == "clamped"))
    return sc.Model({"column": beam}, fixed)


@pytest.mark.parametrize("ends", ENDS, ids="-".join)
@pytest.mark.parametrize("n", [16, 130])
def test_columns_buckle_at_eulers_loads(ends, n):
    """[X] Euler's four columns, by a full eigenvalue problem and by Lanczos' method."""
    model = column(n, *ends)
    thrust = model.run([sc.Stage("thrust", model.forms["column"].load((0.0, -0.01), (0.0, L)))])
    found = model.buckling(1, start=thrust)
    # sixteen elements err by 7e-5 of the load with the shortest waves
    assert found.factors[0] == pytest.approx(ENDS[ends] * np.pi**2 * EI / L**2 / 0.01, rel=1e-4)
    assert np.abs(found.shapes).max() == 1.0
    assert "buckling" in str(found) and found.stage(0).name.startswith("mode 1")


def test_column_follows_the_elastica_beyond_its_buckling_load():
    """[X] Pushed aside, loaded by 1.1 P and left alone it sways by 2 k L / K(k), P by K(k)."""
    euler = np.pi**2 * EI / (2 * L) ** 2
    beam = straight(16, (0.0, L), EA=1e6, GA=1e7, kinematics="finite")
    model = sc.Model({"column": beam}, beam.dofs((0.0, 0.0)))
    form = model.forms["column"]
    aside = form.load((0.05 * euler, 0.0), (0.0, L))
    sway = {}
    for share in (0.8, 1.1):
        thrust = form.load((0.0, -share * euler), (0.0, L))
        stages = [
            sc.Stage("push", aside),
            sc.Stage("press", aside + thrust, increments=8),
            sc.Stage("leave", thrust, increments=4),
        ]
        end = model.run(stages)["leave"]
        sway[share] = abs(end.x[form.numbers((0.0, L))[0]])
    k = brentq(lambda k: (2 * ellipk(k * k) / np.pi) ** 2 - 1.1, 1e-6, 0.9)
    assert sway[0.8] < 1e-6 * L
    # sixteen elements buckle .05 % later, and the sway grows by a root above the load
    assert sway[1.1] == pytest.approx(2 * k / ellipk(k * k) * L, rel=5e-3)


def test_bad_input_is_refused():
    """One sentence each."""
    beam = straight(4)
    model = sc.Model({"beam": beam}, beam.dofs((0.0, 0.0)))
    rest = model.run([sc.Stage("pull", model.forms["beam"].load((1.0, 0.0), (L, 0.0)))])
    with pytest.raises(ValueError, match="no member has a thrust"):
        model.buckling(1, start=rest)
    with pytest.raises(ValueError, match="number of modes must be at least 1"):
        model.buckling(0, start=rest)
    with pytest.raises(ValueError, match="kinematics must be"):
        straight(4, kinematics="large")
    with pytest.raises(ValueError, match="lie in the plane"):
        sc.Beam(None, [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]], EI=1.0, EA=1.0, kinematics="finite")
    finite = cantilever(4)
    bent = finite.run([sc.Stage("bend", finite.forms["beam"].load((0.0, -1.0), (L, 0.0)))])
    with pytest.raises(ValueError, match="keeps its displacements"):
        bent.reset()
    with pytest.raises(ValueError, match="finite ones follow the path"):
        finite.buckling(1, start=bent)
