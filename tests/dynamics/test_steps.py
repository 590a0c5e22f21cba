"""Automatic steps in time: their error, pulses, contact, and starts that fail."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import csr_matrix
from skfem import Basis, ElementQuad1, ElementVector, MeshQuad

import skfem_contact as sc
from skfem_contact.dynamics.scheme import Motion, Scheme
from skfem_contact.dynamics.steps import Steps
from tests.dynamics.cases import QUIET, oscillator, pushed

PERIOD = 2.0 * np.pi / 100.0


def swing(tolerance, rho_inf=0.8, step=PERIOD, load=None, periods=3.0, more=None):
    """Return times, displacements over the static ones, and the result of an oscillator."""
    model, basis, top = oscillator()
    if more is not None:
        model = sc.Model({**model.forms, "more": more}, model.fixed, gravity_acceleration=10.0)
    push = pushed(basis, 3.0)
    rows = []
    dynamic = sc.Dynamic(step, rho_inf=rho_inf, tolerance=tolerance)
    stage = sc.Stage(
        "swing",
        push if load is None else lambda t: push * load(t),
        duration=periods * PERIOD,
        dynamic=dynamic,
    )
    result = model.run(
        [sc.Stage("weight"), stage],
        on_increment=lambda s: rows.append((s.time, s.x[top[0]])),
        **QUIET,
    )
    time, moved = np.array(rows).T
    return time[1:], (moved[1:] - moved[0]) / 3e-4, result


@pytest.mark.parametrize("rho_inf", [1.0, 0.8, 0.0])
def test_error_of_a_step(rho_inf):
    """[X] The first step of u = cos w t errs by |beta + (am - af) / 2 - 1/6| h^3 w^3."""
    am, af, beta, _ = Scheme.of(rho_inf)
    errors = []
    for h in (0.02, 0.01):
        # one step of u'' = -u from the phase 1; accelerations lag by (am - af) h
        t = 1.0
        u, v, a = np.cos(t), -np.sin(t), -np.cos(t + (am - af) * h)
        factor = (1.0 - am) / (beta * h**2) + (1.0 - af)
        old = u + h * v + (0.5 - beta) * h**2 * a
        new = ((1.0 - am) / (beta * h**2) * old - am * a - af * u) / factor
        errors.append(abs(new - np.cos(t + h)) / (h**3 * np.sin(t)))
    # the next term falls with h
    limit = 2.0 * errors[1] - errors[0]
    assert Scheme.of(rho_inf).error == pytest.approx(limit, rel=2e-3)


@pytest.mark.parametrize("rho_inf", [1.0, 0.8])
def test_error_falls_with_the_tolerance(rho_inf):
    """[X] Under a sudden load the error falls like tolerance^(2/3), as steps of third order do."""
    errors, steps = [], []
    for tolerance in (1e-3, 1e-5):
        time, found, _ = swing(tolerance, rho_inf)
        errors.append(np.abs(found - 1.0 + np.cos(100.0 * time)).max() / 2.0)
        steps.append(len(time))
    # lengths are powers of two
    assert errors[0] < 0.04
    assert errors[0] / errors[1] == pytest.approx(100.0 ** (2.0 / 3.0), rel=0.6)
    assert steps[1] / steps[0] == pytest.approx(100.0 ** (1.0 / 3.0), rel=0.3)


@pytest.mark.slow
def test_steps_follow_a_pulse():
    """[X] A pulse of a hundredth of the period, at any time, gives the momentum of its area."""
    width = PERIOD / 100.0

    def load(t):
        return np.exp(-(((t - 0.4 * PERIOD) / width) ** 2))

    time, found, _ = swing(1e-5, 1.0, PERIOD / 16.0, load)
    # u = p / (m w) sin w (t - t0), with the spectrum of the pulse at w
    impulse = np.sqrt(np.pi) * width * np.exp(-0.25 * (100.0 * width) ** 2)
    later = time > 0.5 * PERIOD
    exact = 100.0 * impulse * np.sin(100.0 * (time - 0.4 * PERIOD))
    assert np.abs(found - exact)[later].max() < 0.02 * 100.0 * impulse
    lengths = np.diff(time)
    assert lengths.max() > 3.9 * lengths[np.abs(time[1:] - 0.4 * PERIOD) < width].max()
    # equal steps of the shortest length would be many times as many
    assert len(time) < 0.2 * (time[-1] / lengths.min())


class Nothing(sc.Form):
    """A form without force that keeps models from being linear."""

    def assemble(self, x, state):
        from scipy.sparse import csr_matrix

        return sc.Response(np.zeros(len(x)), lambda: state, lambda: csr_matrix((len(x), len(x))))


def test_linear_steps_are_those_of_newtons_method():
    """[N] Factors of several lengths give the steps of the general method."""
    one = swing(1e-3, load=lambda t: t < PERIOD)
    other = swing(1e-3, load=lambda t: t < PERIOD, more=Nothing())
    np.testing.assert_allclose(one[0], other[0])
    # round-off of accelerations from differences of displacements in short steps
    np.testing.assert_allclose(one[1], other[1], atol=1e-7)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::skfem_contact.AnalysisWarning")
def test_flight_and_impact():
    """[X] Long steps in flight, short ones in contact: contact ends after 2 L / c, once."""
    n, c, v0, gap = 50, 10.0, 0.1, 0.1
    h = 1.0 / n
    left = MeshQuad.init_tensor(np.linspace(-1.0, 0.0, n + 1) - gap, [0.0, h]).with_defaults()
    right = MeshQuad.init_tensor(np.linspace(0.0, 1.0, n + 1), [0.0, h]).with_defaults()
    mesh = sc.join_bodies({"a": left, "b": right})
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    solid = sc.SolidForm(basis, sc.LinearElastic(E=100.0, nu=0.0), unit_weight=10.0)
    pair = sc.ContactPair(basis, "a:right", "b:left", sc.Coulomb())
    forms = {"bars": solid, "pair": pair}
    model = sc.Model(forms, basis.get_dofs().all("u^2"), gravity_acceleration=10.0)
    moves = basis.get_dofs(elements="a").all("u^1")
    v = basis.zeros()
    v[moves] = v0
    rows = []

    def watch(stage):
        rows.append((stage.time, abs(stage.contact("pair").force[0])))

    settings = sc.Dynamic(0.1, velocity=v, tolerance=1e-3)
    stage = sc.Stage("fly", duration=2.0, dynamic=settings)
    found = model.run([stage], on_increment=watch, **QUIET)["fly"]
    time, force = np.array(rows).T
    touching = force > 0.01 * c * v0 * h
    # at most one step of h / c late at each end, and a wave passes one element more at each end
    first, last = time[touching][[0, -1]]
    assert first == pytest.approx(gap / v0, abs=h / c)
    assert last - gap / v0 == pytest.approx(0.2, abs=4.0 * h / c)
    assert np.count_nonzero(np.diff(np.r_[0, touching]) == 1) == 1
    mass = solid.weight_matrix(False).diagonal()[moves]
    # steps of 5 h / c in contact; equal steps of h / c err by 1 % in five times as many
    assert mass @ found.velocity[moves] / mass.sum() == pytest.approx(0.0, abs=0.03 * v0)
    assert len(time) < 200
    assert np.diff(time).max() > 0.049
    energy = found.energy
    total = energy["kinetic"] + energy["elastic"]
    assert total.max() < total[0] * (1.0 + 1e-9)


def test_a_first_step_that_fails_leaves_balance():
    """[X] The state that is left has the load at the start, and inertia that balances it."""
    model, basis, top = oscillator()

    class Breaks(Nothing):
        def assemble(self, x, state):
            if np.abs(x[top]).max() > 0.001 * (1.0 + 1e-5):
                raise sc.NotConverged("it breaks")
            return super().assemble(x, state)

    forms = {**model.forms, "breaks": Breaks()}
    model = sc.Model(forms, model.fixed, gravity_acceleration=10.0)
    settings = sc.Dynamic(PERIOD / 2.0)
    stage = sc.Stage("swing", pushed(basis, -300.0), duration=PERIOD, dynamic=settings)
    with pytest.raises(sc.NotConverged, match="it breaks") as caught:
        model.run([sc.Stage("weight"), stage], **QUIET)
    left = caught.value.result["swing"]
    assert left.fraction == 0.0
    free = np.setdiff1d(np.arange(basis.N), np.asarray(model.fixed))
    assert np.abs(left.reactions()[free]).max() < 1e-9 * 300.0
    assert np.abs(left.load[free]).max() > 100.0


@pytest.mark.parametrize("tolerance", [0.0, -1.0, 1.0])
def test_bad_tolerances(tolerance):
    """[X] A tolerance is a small share; explicit steps have none."""
    with pytest.raises(ValueError, match="must be a share between 0 and"):
        sc.Dynamic(0.1, tolerance=tolerance)
    with pytest.raises(ValueError, match="give no tolerance"):
        sc.Dynamic(explicit=True, tolerance=1e-3)


@pytest.mark.parametrize(("changed", "length"), [(0.1, 1.0), (0.5, 0.25)])
def test_contact_that_closes_wants_steps_of_a_wave_through_an_element(changed, length):
    """[X] A step that closes half of the points is refused, and one as long as the wave follows;
    a tenth of them may close, and so may all of them in a step as short as that.
    """
    rest = np.zeros(2)
    steps = Steps(1.0, 4, 0.01, Scheme.of(0.8), csr_matrix(np.eye(2)), rest, transit=0.25)
    before = Motion(rest, rest, rest, rest)
    after = Motion(rest + 1.0, rest, rest, rest)
    assert steps.refuses(before, after, changed) == (length < 1.0)
    assert steps.length == length
    if length < 1.0:
        assert not steps.refuses(before, after, 1.0)
        assert steps.length == length
