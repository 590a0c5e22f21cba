"""Coulomb friction as a pure function of gap and slip (equations 4 to 10), no bodies."""

from __future__ import annotations

import numpy as np
import pytest

from skfem_contact import AnalysisWarning, ContactPair, Coulomb, Tied
from skfem_contact.contact.laws import Status
from skfem_contact.results.tractions import tractions
from tests.tools.helpers import body_along, facing, unknowns_of

WHOLE = np.zeros((1, 1))


def drag(law: Coulomb, gaps, slips, penalties=(1e6, 1e4)):
    """Lead one point along a path of gaps and slips as a pair does; the answers of all steps."""
    stick, status, internal, answers = 0.0, Status.OPEN, WHOLE, []
    for gap, slip in zip(gaps, slips, strict=True):
        normal, tangential, elastic, closed = 0.0, 0.0, 0.0, np.array([status != Status.OPEN])
        status = Status.OPEN
        if law.reaches(np.array([gap]), internal, closed)[0]:
            out = law.update(np.array([[gap], [slip - stick]]), internal, penalties)
            (normal, tangential), elastic = out.traction[:, 0], out.elastic_slip[0, 0]
            status, internal = out.status[0], out.internal
        stick = slip - elastic
        answers.append((normal, tangential, stick, status))
    return np.array(answers).T


def answer(law, gap, slip, *penalty, internal=None):
    """Answer to gaps (n,) and slips (n,) in the plane, or (2, n) in space."""
    internal = np.zeros((law.n_internal, len(gap))) if internal is None else internal
    return law.update(np.concatenate((gap[None], np.atleast_2d(slip))), internal, penalty)


def cycle(amplitude: float, steps: int = 400) -> np.ndarray:
    """Slip from 0 to +a, then n cycles between +a and -a."""
    quarter = np.linspace(0, amplitude, steps // 4 + 1)
    return np.concatenate((quarter, quarter[-2::-1], -quarter[1:], -quarter[-2::-1]))


def work(slip: np.ndarray, traction: np.ndarray) -> float:
    """Trapezoidal rule: exact for the piecewise linear law if its kinks are among the points."""
    return float((0.5 * (traction[1:] + traction[:-1]) * np.diff(slip)).sum())


@pytest.mark.parametrize("name", ["mu", "adhesion"])
def test_shear_at_a_single_node_has_no_potential(name: str) -> None:
    assert Coulomb(tension=1.0).symmetric
    assert Coulomb(**{name: np.zeros(2)}).symmetric
    assert not Coulomb(**{name: np.array([0.0, 0.3])}).symmetric


def test_cyclic_slip():
    """[X] Case A7: plateau 30, elastic slip 0.003, energy per cycle 4 mu N (a - mu N / eps_T) =
    0.84.
    """
    first = cycle(0.01)
    slip = np.concatenate((first, first[1:]))
    normal, traction, stick, status = drag(Coulomb(mu=0.3), np.full(len(slip), -1e-4), slip)
    # products of two numbers of five digits: a few roundings
    np.testing.assert_allclose(normal, -100, rtol=1e-12)
    assert np.abs(traction).max() == pytest.approx(30.0, rel=1e-12)
    plateau = status == Status.SLIP
    np.testing.assert_allclose(np.abs(slip - stick)[plateau], 0.003, rtol=1e-12)
    loop = slice(
        len(first) - 1, None
    )  # the second cycle begins and ends in the same point of the loop
    assert work(slip[loop], traction[loop]) == pytest.approx(0.84, rel=1e-12)
    assert traction[loop][0] == pytest.approx(traction[loop][-1], rel=1e-12)


def test_small_cycles_are_reversible():
    """[X] Case A7: an amplitude below 0.003 dissipates nothing and leaves nothing behind."""
    slip = cycle(0.0029)
    _, traction, stick, status = drag(Coulomb(mu=0.3), np.full(len(slip), -1e-4), slip)
    assert (status == Status.STICK).all() and np.abs(stick).max() < 1e-17
    np.testing.assert_allclose(traction, 1e4 * slip, rtol=1e-12, atol=1e-13)
    assert abs(work(slip, traction)) < 1e-14  # the work of one way is 0.04


def test_force_follows_the_shrinking_cone():
    """[X] Case A7: the pressure falls while the point sticks; the friction falls with it along the
    cone.
    """
    pressure = np.linspace(100, 0, 101)
    slip = np.full(101, 0.002)  # 20 of friction: sticks down to a pressure of 66.67
    _, traction, stick, status = drag(Coulomb(mu=0.3), -pressure / 1e6, slip)
    np.testing.assert_allclose(traction, np.minimum(20.0, 0.3 * pressure), atol=1e-12)
    assert ((status == Status.STICK) == (0.3 * pressure > 20 - 1e-9)).all()
    np.testing.assert_allclose(stick, slip - traction / 1e4, atol=1e-17)


@pytest.mark.parametrize("mu, adhesion", [(0.0, 0.0), (0.4, 0.0), (0.0, 2.0), (0.4, 2.0)])
def test_cone_and_signs(mu, adhesion, rng):
    """[X] Inside the cone everywhere, on it where it slips; open points are not reached."""
    law = Coulomb(mu, adhesion)
    gap, slip = 1e-3 * rng.standard_normal((2, 1000))
    eps_n, eps_t = 10.0 ** rng.uniform(2, 6, (2, 1000))
    whole, closed = np.zeros((1, 1000)), rng.random(1000) < 0.5
    reached = law.reaches(gap, whole, closed)
    assert np.array_equal(
        reached, (gap <= 0) | (closed & (adhesion > 0))
    )  # an adhesive point opens as it is asked
    opens = answer(law, gap, slip, eps_n, eps_t).status == Status.OPEN
    assert np.array_equal(opens, gap > 0)
    gap = -np.abs(gap)
    out = answer(law, gap, slip, eps_n, eps_t)
    normal, tangential = out.traction
    limit = adhesion + mu * np.abs(normal)
    np.testing.assert_array_equal(normal, eps_n * gap)  # equation 4
    assert (np.abs(tangential) <= limit).all()
    slipping, sticking = out.status == Status.SLIP, out.status == Status.STICK
    assert (slipping ^ sticking).all()
    np.testing.assert_array_equal(np.abs(tangential)[slipping], limit[slipping])
    np.testing.assert_array_equal(tangential[sticking], (eps_t * slip)[sticking])
    assert (tangential * slip >= 0).all()  # it drags the slave back
    np.testing.assert_allclose(out.elastic_slip[0] * eps_t, tangential, rtol=1e-14)
    if mu == adhesion == 0:
        assert not sticking.any() and not tangential.any()
    else:
        assert sticking.any() and slipping.any()


LAWS = [Coulomb(), Coulomb(0.4), Coulomb(0.4, 2.0), Coulomb(0.4, 2.0, 1.0), Tied()]


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("law", LAWS, ids=repr)
def test_derivatives(law, dim, rng):
    """[X] Central differences of all components; in the plane the laws are piecewise linear."""
    h = 1e-7
    gap = 1e-3 * rng.standard_normal(500)
    if isinstance(law, Coulomb) and law.tension == 0:
        gap = -np.abs(gap) - h
    slip = 1e-3 * rng.standard_normal((dim - 1, 500))
    eps = 10.0 ** rng.uniform(3, 5, (2, 500))
    out = answer(law, gap, slip, *eps)
    for j in range(dim):
        step = h * np.eye(dim)[j][:, None]
        up, down = (answer(law, gap + k * step[0], slip + k * step[1:], *eps) for k in (1, -1))
        same = (up.status == down.status) & (up.status == out.status) & (np.abs(gap) > h)
        slope = (up.traction - down.traction) / (2 * h)
        # a slip of 1e-5 and more turns by h / 1e-5: h^2 / 6 of the third derivative, which is 1e4
        # of the first
        same &= np.linalg.norm(slip, axis=0) > 1e-5
        assert same.mean() > 0.95
        # tractions of 1e2 with round-off 1e-14 over 2e-7; in space relative to the penalty
        atol = 1e-6 if dim == 2 else 1e-4 * eps[1].max()
        np.testing.assert_allclose(out.tangent[:, j, same], slope[:, same], atol=atol)


def test_radial_return_in_space(rng):
    """[X] In space the traction is on the cone along the slip, and a turned slip has the turned
    traction.
    """
    law, gap, slip = (
        Coulomb(0.4, 2.0),
        -1e-3 * rng.random(300),
        1e-2 * rng.standard_normal((2, 300)),
    )
    out = answer(law, gap, slip, 1e4, 1e3)
    slides = out.status == Status.SLIP
    assert 0.1 < slides.mean() < 0.99
    size = np.linalg.norm(out.traction[1:], axis=0)
    np.testing.assert_allclose(
        size[slides], (2.0 + 0.4 * np.abs(out.traction[0]))[slides], rtol=1e-14
    )
    np.testing.assert_allclose(
        out.traction[1:] * np.linalg.norm(slip, axis=0), size * slip, atol=1e-14
    )
    turn = np.array([[0.6, -0.8], [0.8, 0.6]])
    turned = answer(law, gap, turn @ slip, 1e4, 1e3)
    np.testing.assert_allclose(turned.traction[1:], turn @ out.traction[1:], atol=1e-13)
    # along a line the plane's law
    line = answer(law, gap, slip[0], 1e4, 1e3)
    straight = answer(law, gap, np.stack((slip[0], 0 * slip[0])), 1e4, 1e3)
    np.testing.assert_array_equal(line.traction, straight.traction[:2])
    np.testing.assert_array_equal(line.tangent, straight.tangent[:2, :2])


def test_dissipation_is_never_negative(rng):
    """[X] Case S14: 2000 random increments of slip and pressure; what is not stored is
    dissipated.
    """
    slip = np.cumsum(0.004 * rng.standard_normal(2000))
    gap = -1e-4 * np.abs(rng.standard_normal(2000))
    normal, traction, stick, _ = drag(Coulomb(mu=0.3, adhesion=1.0), gap, slip)
    assert (np.abs(traction) <= (1.0 + 0.3 * np.abs(normal)) * (1 + 1e-12)).all()
    dissipated = traction[1:] * np.diff(stick)
    assert dissipated.min() >= -1e-14 and dissipated.max() > 0.01


def test_opening_forgets_the_friction():
    """[X] An open point has no stick point of its own: it takes the closest point along."""
    slip = np.array([0.001, 0.002, 0.5, 0.5, 0.501])
    gap = np.array([-1e-4, -1e-4, 1e-3, -1e-4, -1e-4])
    _, traction, stick, status = drag(Coulomb(mu=0.3), gap, slip)
    np.testing.assert_allclose(traction, [10, 20, 0, 0, 10], atol=1e-11)
    assert status.tolist() == [Status.STICK, Status.STICK, Status.OPEN, Status.STICK, Status.STICK]
    assert stick[2] == 0.5


def test_touching_point_is_closed():
    """[X] A gap of exactly zero carries nothing but is stiff: bodies that touch need it to begin
    with.
    """
    law, zero = Coulomb(mu=0.3), np.zeros(1)
    assert law.reaches(zero, WHOLE, np.array([False]))[0]
    out = answer(law, zero, zero, 1e3, 1e2)
    assert not out.traction.any()
    assert out.status[0] == Status.STICK and out.tangent[:, :, 0].tolist() == [
        [1e3, 0.0],
        [0.0, 1e2],
    ]


def test_tension_cut_off():
    """[X] A closed point holds up to the cut-off, then opens for good: adhesion and tension are
    gone.
    """
    gap = np.array([-1e-5, 1e-6, 4e-6, 6e-6, 4e-6, -1e-6, -1e-6, 1e-6])
    slip = np.array([1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 2.0, 2.0])
    normal, traction, _, status = drag(Coulomb(mu=0.5, adhesion=2.0, tension=5.0), gap, slip)
    np.testing.assert_allclose(normal, [-10, 1, 4, 0, 0, -1, -1, 0], atol=1e-12)
    np.testing.assert_allclose(traction, [7, 2, 2, 0, 0, 0, 0.5, 0], atol=1e-12)
    assert np.flatnonzero(status == Status.OPEN).tolist() == [3, 4, 7]


def test_adhesion_is_lost_where_it_opens():
    """[X] Closed with its bond, opened, closed again: friction alone; a point that closes late has
    its bond.
    """
    law = Coulomb(mu=0.5, adhesion=2.0)
    _, traction, _, _ = drag(
        law, np.array([-1e-5, 1e-6, -1e-5, -1e-5]), np.array([1.0, 1.0, 1.0, 2.0])
    )
    np.testing.assert_allclose(traction, [7, 0, 0, 5], atol=1e-12)
    _, traction, _, _ = drag(
        law, np.array([1e-6, 1e-6, -1e-5, -1e-5]), np.array([1.0, 1.0, 1.0, 2.0])
    )
    np.testing.assert_allclose(traction, [0, 0, 0, 7], atol=1e-12)


def test_bond():
    """[X] A tied point is a spring both ways, and stays one."""
    gap, slip = np.array([-1.0, 0.0, 2.0]), np.array([3.0, -4.0, 0.5])
    out = answer(Tied(), gap, slip, 5.0, 7.0)
    np.testing.assert_array_equal(out.traction, [5 * gap, 7 * slip])
    closed = np.array([True, False, True])
    assert np.array_equal(Tied().reaches(gap, np.zeros((0, 3)), closed), closed)


def test_pure(rng):
    """[X] The arguments are not written to."""
    jump, internal = -np.abs(rng.standard_normal((2, 9))), np.zeros((1, 9))
    before = jump.copy(), internal.copy()
    Coulomb(0.5, 1.0, 1.0).update(jump, internal, (3.0, 2.0))
    assert np.array_equal(jump, before[0]) and np.array_equal(internal, before[1])


def test_limits_of_the_coefficient():
    """[X] Case S23: mu = 1e-12 is frictionless, mu = 1e6 sticks."""
    gap, slip = np.full(3, -1e-3), np.array([-1.0, 1e-3, 1.0])
    assert np.abs(answer(Coulomb(1e-12), gap, slip, 1e4, 1e4).traction[1]).max() <= 1e-11
    np.testing.assert_array_equal(answer(Coulomb(1e6), gap, slip, 1e4, 1e4).traction[1], 1e4 * slip)


def test_parameters_along_the_slave():
    """[X] A parameter with one value for each node of the slave is interpolated at the points,
    whatever the rule.
    """
    line = np.stack((np.linspace(0, 1, 5), np.zeros(5)), axis=1)
    basis = facing(body_along(line[::-1]), body_along(line))
    for quadrature in ("nodal", 3, "segments"):
        pair = ContactPair(basis, "slave:face", "master:face", Coulomb(), quadrature, penalty=1e4)
        pair = pair.with_law(Coulomb(mu=0.1 + 0.4 * pair.slave.nodes[:, 0]))
        x = basis.zeros()
        x[unknowns_of(basis, "slave")] = (0.05, -1e-3)
        joint = tractions(pair, pair.assemble(x, pair.initial_state()).state)
        np.testing.assert_allclose(
            np.abs(joint.shear), (0.1 + 0.4 * joint.x) * joint.pressure, rtol=1e-12
        )
        assert joint.pressure.max() == pytest.approx(10.0)
    with pytest.raises(ValueError, match=r"Coulomb: mu has shape \(3,\); the slave has 5 nodes"):
        pair.with_law(Coulomb(mu=np.ones(3)))
    with pytest.raises(ValueError, match="law must be an InterfaceLaw with an `update`"):
        pair.with_law(0.3)


@pytest.mark.parametrize("name", ["mu", "adhesion", "tension"])
@pytest.mark.parametrize("value", [-0.1, np.nan, np.inf, np.array([0.1, -0.1])], ids=str)
def test_bad_parameters(name, value):
    with pytest.raises(ValueError, match=rf"{name} must be"):
        Coulomb(**{name: value})


def test_a_search_tries_any_friction_without_a_warning(recwarn):
    """Friction over a small factor is no angle in degrees, as it is told where a user gives it."""
    law = Coulomb(mu=0.4, adhesion=2.0, tension=1.0).reduced(0.02)
    assert (law.mu, law.adhesion, law.tension) == (20.0, 100.0, 50.0)
    assert not recwarn.list
    with pytest.warns(AnalysisWarning, match="tangent of the angle"):
        Coulomb(mu=20.0)
