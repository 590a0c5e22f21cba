"""Stages in time under hard conditions: steps, contrasts, restarts, mirrors, units."""

from __future__ import annotations

import tracemalloc

import numpy as np
import pytest
from scipy.sparse import csr_matrix
from skfem import Basis, ElementQuad1, ElementVector, MeshQuad

import skfem_contact as sc
from skfem_contact.results.motion import Counts
from tests.dynamics.cases import QUIET, oscillator, pushed

PERIOD = 2.0 * np.pi / 100.0


class Nothing(sc.Form):
    """A form without force that keeps models from being linear."""

    def assemble(self, x, state):
        return sc.Response(np.zeros(len(x)), lambda: state, lambda: csr_matrix((len(x), len(x))))


def with_nothing(model, iterated):
    """Return a model, with a form without force where its steps shall be iterated."""
    if not iterated:
        return model
    g = model.gravity_acceleration
    return sc.Model({**model.forms, "nothing": Nothing()}, model.fixed, gravity_acceleration=g)


@pytest.mark.filterwarnings("ignore::skfem_contact.AnalysisWarning")
@pytest.mark.parametrize("iterated", [False, True])
@pytest.mark.parametrize("periods", [1e-6, 1e-4, 1e-2, 1.0, 1e2])
def test_steps_of_all_lengths(periods, iterated):
    """[X] Short steps are exact, long ones bounded by the swing of a sudden load."""
    model, basis, top = oscillator()
    model = with_nothing(model, iterated)
    h = periods * PERIOD
    moved = []
    stage = sc.Stage("swing", pushed(basis, 3.0), duration=40 * h, dynamic=sc.Dynamic(h))
    model.run(
        [sc.Stage("weight"), stage], on_increment=lambda s: moved.append(s.x[top[0]]), **QUIET
    )
    found = (np.array(moved[1:]) - moved[0]) / 3e-4
    time = h * np.arange(1, 41)
    assert np.abs(found - 1.0).max() < 1.05
    if periods < 0.1:
        exact = 1.0 - np.cos(100.0 * time)
        # round-off of displacements of 1e-3 in those of 3e-4 (wt)^2 / 2
        assert np.abs(found - exact).max() < 1e-3 * exact.max() + 1e-12
    if periods > 10.0:
        # 40 * 0.8 ** 40
        assert found[-1] == pytest.approx(1.0, abs=0.02)


@pytest.mark.parametrize("iterated", [False, True])
@pytest.mark.parametrize("contrast", [1e6, 1e-6])
def test_contrasts_of_stiffness(contrast, iterated):
    """[X] A stiff and a soft half: energies balance, and the soft half carries the stiff one."""
    mesh = MeshQuad.init_tensor([0.0, 1.0], np.linspace(0.0, 2.0, 5)).with_defaults()
    mesh = mesh.with_subdomains({"low": lambda x: x[1] < 1.0, "high": lambda x: x[1] > 1.0})
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    moduli = {"low": 1e4, "high": 1e4 * contrast}
    laws = {name: sc.LinearElastic(E=E, nu=0.0) for name, E in moduli.items()}
    solid = sc.SolidForm(basis, laws, unit_weight=20.0)
    fixed = [basis.get_dofs("bottom").all(), basis.get_dofs().all("u^1")]
    model = with_nothing(sc.Model({"solid": solid}, fixed, gravity_acceleration=10.0), iterated)
    load = np.asarray(sc.traction(basis, "top", (0.0, -3.0)))
    settings = sc.Dynamic(1e-3, rho_inf=1.0)
    stage = sc.Stage("push", lambda t: load * (t < 0.02), duration=0.1, dynamic=settings)
    result = model.run([sc.Stage("weight"), stage], **QUIET)
    energy = result["push"].energy
    largest = max(np.abs(energy[name]).max() for name in ("kinetic", "elastic", "work"))
    # round-off of stiff elements, and residuals of equilibria that are iterated
    assert np.abs(energy["missing"]).max() < (1e-6 if iterated else 1e-9) * largest
    moved = result["push"].x - result["weight"].x
    rows = [moved[basis.nodal_dofs[1, np.isclose(mesh.p[1], y)]].mean() for y in (1.0, 2.0)]
    if contrast > 1.0:
        assert rows[0] == pytest.approx(rows[1], rel=1e-4)


def block(shift=1.0, scale=(1.0, 1.0, 1.0), mu=0.3):
    """Return model, basis and push of a block on a plane, mirrored and in units of x, t and force.

    Parameters
    ----------
    shift
        -1 for the block that is mirrored about x = 0.
    scale
        Units of length, time and force over those of the first block.
    """
    length, time, force = scale
    stress = force / length**2
    x, y = np.linspace(0.0, 2.0, 5), np.linspace(0.0, 1.0, 3)
    mesh = MeshQuad.init_tensor(np.sort(shift * x) * length, y * length).with_defaults()
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    solid = sc.SolidForm(
        basis, sc.LinearElastic(E=1e5 * stress, nu=0.2), unit_weight=20.0 * force / length**3
    )
    floor = sc.rigid.line((-9.0 * length, 0.0), (9.0 * length, 0.0))
    pair = sc.ContactPair(basis, "bottom", floor, sc.Coulomb(mu=mu))
    model = sc.Model({"block": solid, "pair": pair}, gravity_acceleration=10.0 * length / time**2)
    side = "left" if shift > 0.0 else "right"
    push = np.asarray(sc.traction(basis, side, (shift * 30.0 * stress, 0.0)))
    return model, basis, push


def pushed_block(model, push, time=1.0, **more):
    """Return the last stage of a block that is pushed for a while, slides and stops."""
    settings = sc.Dynamic(0.0075 * time, rho_inf=0.8)
    stage = sc.Stage(
        "push", lambda t: push * (t < 0.0999 * time), duration=0.3 * time, dynamic=settings
    )
    return model.run([sc.Stage("weight"), stage], **QUIET, **more)["push"]


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::skfem_contact.AnalysisWarning")
def test_mirrored_and_in_other_units():
    """[X] A mirrored block moves the other way, and units change nothing but the numbers."""
    model, basis, push = block()
    right = pushed_block(model, push)
    slid = right.x[basis.nodal_dofs[0]].mean()
    assert slid > 1e-3

    # mirrored
    model, other, push = block(-1.0)
    left = pushed_block(model, push)
    order = [
        int(np.argmin(np.abs(other.mesh.p - p[:, None]).sum(axis=0)))
        for p in (basis.mesh.p.T * [-1.0, 1.0])
    ]
    for c, sign in enumerate((-1.0, 1.0)):
        one = right.x[basis.nodal_dofs[c]]
        two = left.x[other.nodal_dofs[c][order]]
        # the residual of equilibria
        np.testing.assert_allclose(one, sign * two, atol=1e-9 * slid)

    # in millimetres, milliseconds and newtons
    model, _, push = block(scale=(1e3, 1e3, 1e3))
    small = pushed_block(model, push, 1e3)
    np.testing.assert_allclose(small.x / 1e3, right.x, atol=1e-9 * slid)
    np.testing.assert_allclose(small.velocity, right.velocity, atol=1e-8 * slid)


@pytest.mark.filterwarnings("ignore::skfem_contact.AnalysisWarning")
@pytest.mark.parametrize("case", ["linear", pytest.param("contact", marks=pytest.mark.slow)])
def test_restart_in_the_middle(case, tmp_path):
    """[X] A motion that continues in another stage, from a file too, is the same to 1e-12."""
    if case == "linear":
        model, basis, _ = oscillator()
        push, h, n = pushed(basis, 3.0), PERIOD / 40.0, 60
    else:
        model, basis, push = block()
        h, n = 0.005, 20
    settings = sc.Dynamic(h, rho_inf=0.8)

    def load(t):
        return push * (t < 0.7 * n * h)

    whole = model.run(
        [sc.Stage("weight"), sc.Stage("all", load, duration=2 * n * h, dynamic=settings)], **QUIET
    )["all"]
    half = model.run(
        [sc.Stage("weight"), sc.Stage("first", load, duration=n * h, dynamic=settings)], **QUIET
    )
    rest = sc.Stage("second", lambda t: load(t + n * h), duration=n * h, dynamic=settings)
    file = tmp_path / "half.npz"
    half.save(file)
    for start in (half, sc.load_result(file, model)):
        found = model.run([rest], start=start, **QUIET)["second"]
        scale = np.abs(whole.x).max()
        np.testing.assert_allclose(found.x, whole.x, atol=1e-12 * scale)
        speed = np.abs(whole.velocity).max()
        # velocities of round-off over a step
        np.testing.assert_allclose(found.velocity, whole.velocity, atol=1e-9 * speed)


def test_counts_of_steps():
    """[X] Counts grow like tuples, also where two steps follow the same one."""
    counts = Counts((1, 2))
    first = counts.followed_by(3)
    second = counts.followed_by(4)
    assert counts == (1, 2)
    assert first == (1, 2, 3)
    assert second == (1, 2, 4)
    assert first != second
    assert second.followed_by(5)[1:] == (2, 4, 5)
    assert first[-1] == 3
    assert [*counts] == [1, 2]
    with pytest.raises(IndexError):
        counts[2]


def grown(model, push, settings, n):
    """Return the stage of n steps, and the memory that one of its last steps has added."""
    marks = []

    def watch(stage):
        count = len(stage.iterations)
        if count in (n // 2, n - 1):
            marks.append((count, tracemalloc.get_traced_memory()[0]))

    stage = sc.Stage("swing", push, duration=n * settings.step, dynamic=settings)
    tracemalloc.start()
    try:
        found = model.run([sc.Stage("weight"), stage], on_increment=watch, **QUIET)["swing"]
    finally:
        tracemalloc.stop()
    (first, less), (last, more) = marks
    return found, (more - less) / (last - first)


@pytest.mark.filterwarnings("ignore::skfem_contact.AnalysisWarning")
@pytest.mark.slow
@pytest.mark.parametrize("case", ["linear", "contact"])
def test_many_steps(case):
    """[X] Energy drifts by round-off alone, and a step adds its records to the memory."""
    if case == "linear":
        model, basis, _ = oscillator()
        push, n = pushed(basis, 3.0), 1_500
        settings = sc.Dynamic(PERIOD / 40.0, rho_inf=1.0)
    else:
        # a block that swings on a plane without leaving it
        model, basis, _ = block(mu=0.6)
        push = np.asarray(sc.traction(basis, "top", (0.0, -1.0)))
        n = 90
        settings = sc.Dynamic(1e-3, rho_inf=1.0)
    found, memory = grown(model, push, settings, n)
    energy = found.energy
    assert len(found.iterations) == n
    assert isinstance(found.iterations, tuple)
    # a walk of n roundings of 1e-16, to both sides, and the residual of equilibria
    drift = np.abs(energy["missing"]).max() / np.abs(energy["work"]).max()
    assert drift < (1e-11 if case == "linear" else 1e-9)
    # 7 energies and a count of 8 bytes; arrays that grow are a ninth too long, caches of contact
    # are filled now and then
    assert memory < (120.0 if case == "linear" else 1000.0)
