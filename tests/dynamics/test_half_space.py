"""Half-spaces: plane waves on dashpots by angle, Lamb's problem, the impedance of a rigid strip."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import spsolve
from skfem import Basis, ElementQuad1, ElementQuad2, ElementVector, MeshQuad

import skfem_contact as sc
from skfem_contact.dynamics.boundaries import Masses
from tests.dynamics.cases import QUIET
from tests.dynamics.half_space import impedance, lamb, reflected

#: Velocities for nu = 1/4, with the density 1 and the shear modulus 1.
VP, VS = np.sqrt(3.0), 1.0
GROUND = sc.LinearElastic(E=2.5, nu=0.25)


@pytest.mark.parametrize("kind", ["P", "S"])
def test_exact_reflection(kind):
    """[X] A free surface returns all of the energy, dashpots none of a normal wave."""
    for degrees in (0.0, 10.0, 30.0, 45.0, 70.0):
        angle = np.radians(degrees)
        assert reflected(kind, angle, VP, VS, free=True) == pytest.approx(1.0, abs=1e-12)
    assert reflected(kind, 0.0, VP, VS) == pytest.approx(0.0, abs=1e-12)
    assert reflected(kind, np.radians(89.99), VP, VS) == pytest.approx(1.0, abs=2e-3)


@pytest.mark.parametrize("degrees", [0.0, 15.0, 30.0, 45.0, 60.0])
@pytest.mark.parametrize("kind", ["P", "S"])
def test_reflection_by_angle(kind, degrees):
    """[X] Reflected energy of plane waves on the dashpots of a boundary, by their angle."""
    # a column one element wide, which moves like its neighbours but for the phase along x
    n, h, height = 60, 0.05, 3.0
    mesh = MeshQuad.init_tensor([0.0, h], np.linspace(-height, 0.0, n + 1)).with_defaults()
    basis = Basis(mesh, ElementVector(ElementQuad2()), intorder=4)
    solid = sc.SolidForm(basis, GROUND, unit_weight=10.0)
    boundary = sc.ViscousBoundary(solid, "top")
    w = 2.0 * np.pi
    velocity = {"P": VP, "S": VS}
    along = w * np.sin(np.radians(degrees)) / velocity[kind]
    # with exp(i w t) what fades downwards returns: the roots have negative imaginary parts
    square = {name: (w / c) ** 2 - along**2 for name, c in velocity.items()}
    across = {name: np.conj(np.sqrt(complex(value))) for name, value in square.items()}
    _, C = boundary.matrices(Masses(10.0, True, {}, basis.N))
    M = solid.weight_matrix(True) / 10.0
    A = solid.elastic_stiffness - w**2 * M + 1j * w * C

    # tie the right side to the left one: u(x + h) = exp(-i k h) u(x)
    x, y = np.asarray(basis.doflocs)
    right = np.flatnonzero(np.isclose(x, h))
    left = np.flatnonzero(np.isclose(x, 0.0))
    left = left[np.lexsort((left % 2, y[left]))]
    right = right[np.lexsort((right % 2, y[right]))]
    np.testing.assert_allclose(y[left], y[right])
    target = np.arange(basis.N)
    target[right] = left
    phase = np.ones(basis.N, complex)
    phase[right] = np.exp(-1j * along * h)
    T = coo_matrix((phase, (np.arange(basis.N), target)), shape=A.shape).tocsr()
    A = (T.conj().T @ A @ T).tocsc()
    held = np.isclose(y, -height)
    held[right] = False
    free = np.setdiff1d(np.arange(basis.N), np.concatenate((right, np.flatnonzero(held))))

    # fields by both displacements of the bottom, and their four plane waves
    line = left[(y[left] > -2.0) & (y[left] < -0.2)]
    depth = y[line]

    def wave(name, sign):
        k = np.array([along, sign * across[name]]) / (w / velocity[name])
        d = k if name == "P" else np.array([-k[1], k[0]])
        return np.where(line % 2 == 0, d[0], d[1]) * np.exp(-1j * sign * across[name] * depth)

    waves = np.column_stack([wave(*each) for each in (("P", 1), ("S", 1), ("P", -1), ("S", -1))])
    parts = []
    for c in range(2):
        u = np.zeros(basis.N, complex)
        u[np.flatnonzero(held & (np.arange(basis.N) % 2 == c))] = 1.0
        middle = np.isclose(x, 0.5 * h) & held
        u[middle] *= np.exp(-0.5j * along * h)
        u[free] = spsolve(A[free][:, free], -(A[free] @ u))
        amounts, *_ = np.linalg.lstsq(waves, u[line], rcond=None)
        parts.append(amounts)
    arriving, returning = np.array(parts).T[:2], np.array(parts).T[2:]
    first = returning @ np.linalg.solve(arriving, np.eye(2)["PS".index(kind)])
    flow = np.array([velocity[name] ** 2 * across[name].real for name in "PS"])
    found = float((abs(first) ** 2 @ flow) / flow["PS".index(kind)])
    exact = reflected(kind, np.radians(degrees), VP, VS)
    # twenty elements of second order in a wave of shear
    assert found == pytest.approx(exact, abs=1e-4)


def half_plane(x, y):
    """Return the model of a half-plane of one symmetric half, and its basis and forms."""
    mesh = MeshQuad.init_tensor(x, y).with_defaults()
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    # hardly any weight, and the density 1
    solid = sc.SolidForm(basis, GROUND, "full", unit_weight=1e-6)
    forms = {"ground": solid}
    forms |= {name: sc.ViscousBoundary(solid, name) for name in ("right", "bottom")}
    middle = basis.get_dofs("left").all("u^1")
    outside = basis.get_dofs({"right", "bottom"}).all()
    model = sc.Model(forms, [middle, outside], gravity_acceleration=1e-6)
    return model, basis, middle


@pytest.mark.slow
def test_lambs_problem():
    """[X] Vertical displacements of the surface under a pulse of a line load: within 3 %."""
    h, size, step, width = 0.05, 4.0, 0.02, 0.4
    line = np.arange(0.0, size + h / 2, h)
    model, basis, middle = half_plane(line, line - size)
    points = [(1.0, 0.0), (2.0, 0.0)]
    corner = (basis.mesh.p[0] == 0.0) & (np.abs(basis.mesh.p[1]) < 1e-9)
    unit = basis.zeros()
    unit[basis.nodal_dofs[1][corner]] = -0.5e-3  # half of the load, downwards
    middle_of_pulse = 3.4 * width

    def pulse(t):
        return np.exp(-(((t - middle_of_pulse) / width) ** 2)) if t > 0.0 else 0.0

    settings = sc.Dynamic(step, rho_inf=1.0, points=points)
    stage = sc.Stage(
        "pulse", lambda t: unit * pulse(t), duration=4.9, dynamic=settings, fixed=middle
    )
    found = model.run([sc.Stage("weight"), stage], **QUIET)["pulse"]
    for point in points:
        history = found.history(point)
        # the Rayleigh wave with the whole pulse passes at x / .92 + 2 t_0
        now = (history.time > 0.0) & (history.time < point[0] / 0.92 + 2.0 * middle_of_pulse)
        time = history.time[now][1::4]
        exact = -1e-3 * lamb(point[0], time, pulse, VP, VS, 1.0)
        moved = history.values[now, 1][1::4] - history.values[0, 1]
        assert np.abs(moved - exact).max() < 0.03 * np.abs(exact).max()
        # it lifts ahead of Rayleigh's wave
        assert exact.max() > 0.05 * np.abs(exact).max()


def graded(n, growth, largest, far):
    """Return coordinates: n elements up to 1, then growing ones up to a distance."""
    h = 1.0 / n
    found = list(np.linspace(0.0, 1.0, n + 1))
    while found[-1] < far:
        h = min(growth * h, largest)
        found.append(found[-1] + h)
    return np.array(found)


#: Impedances over the shear modulus for nu = 1/4 by five polynomials, which the gallery shows.
IMPEDANCE = {0.5: 1.4363 + 1.7738j, 1.0: 1.3294 + 3.3038j, 2.0: 1.1151 + 6.9311j}


@pytest.mark.slow
@pytest.mark.parametrize("a0", [0.5, 1.0, 2.0])
def test_impedance_of_a_strip(a0):
    """[N] Force over displacement of a rigid smooth strip that vibrates: within 2 %."""
    exact = impedance(a0, 0.25)
    assert exact == pytest.approx(IMPEDANCE[a0], rel=1e-4)
    assert impedance(a0, 0.25, 3) == pytest.approx(exact, rel=1e-6)
    x = graded(16, 1.08, 0.5 / a0, 20.0 / a0)
    model, basis, middle = half_plane(x, -x[::-1])
    under = (basis.mesh.p[0] < 1.0 + 1e-9) & (basis.mesh.p[1] > -1e-9)
    strip = basis.nodal_dofs[1][under]
    held = np.union1d(middle, strip)
    rest = model.run([sc.Stage("weight", fixed=np.union1d(model.fixed, strip))], **QUIET)
    period, size = 2.0 * np.pi / a0, 1e-4

    def moved(t):
        rise = min(1.0, t / period)
        found = rest["weight"].x.copy()
        found[strip] += size * np.sin(a0 * t) * rise**2 * (3.0 - 2.0 * rise)
        return found

    rows = []

    def watch(stage):
        rows.append((stage.time, stage.reactions()[strip].sum()))

    settings = sc.Dynamic(period / 60.0, rho_inf=0.9)
    stage = sc.Stage("shake", prescribed=moved, duration=4 * period, dynamic=settings, fixed=held)
    model.run([stage], start=rest, on_increment=watch, **QUIET)
    time, force = np.array(rows)[-60:].T
    # the last period: half of the force is Re K sin + Im K cos
    phase = a0 * time
    waves = np.column_stack((np.sin(phase), np.cos(phase), np.ones(60)))
    (real, imaginary, _), *_ = np.linalg.lstsq(waves, force, rcond=None)
    found = 2.0 * complex(real, imaginary) / size
    assert abs(found - exact) < 0.02 * abs(exact)
