"""Coulomb friction as a pure function of gap and slip (equations 4 to 10), no bodies."""

from __future__ import annotations

import numpy as np
import pytest

from skfem_contact import Coulomb, Status, Tied


def drag(law: Coulomb, gaps, slips, penalties=(1e6, 1e4)):
    """Lead one point along a path of gaps and slips as a pair does; the answers of all steps."""
    eps = [np.array([p]) for p in penalties]
    stick, status, answers = 0.0, Status.OPEN, []
    for gap, slip in zip(gaps, slips, strict=True):
        normal, tangential, elastic, closed = 0.0, 0.0, 0.0, np.array([status != Status.OPEN])
        status = Status.OPEN
        if law.reaches(np.array([gap]), eps[0], closed)[0]:
            out = law.update(np.array([gap]), np.array([slip - stick]), *eps)
            normal, tangential, elastic, status = (
                out.normal[0],
                out.tangential[0],
                out.elastic_slip[0],
                out.status[0],
            )
        stick = slip - elastic
        answers.append((normal, tangential, stick, status))
    return np.array(answers).T


def cycle(amplitude: float, steps: int = 400) -> np.ndarray:
    """Slip from 0 to +a, then n cycles between +a and -a."""
    quarter = np.linspace(0, amplitude, steps // 4 + 1)
    return np.concatenate((quarter, quarter[-2::-1], -quarter[1:], -quarter[-2::-1]))


def work(slip: np.ndarray, traction: np.ndarray) -> float:
    """Trapezoidal rule: exact for the piecewise linear law if its kinks are among the points."""
    return float((0.5 * (traction[1:] + traction[:-1]) * np.diff(slip)).sum())


def test_cyclic_slip():
    """[X] Case A7: plateau 30, elastic slip 0.003, energy per cycle 4 mu N (a - mu N / eps_T) = 0.84."""
    first = cycle(0.01)
    slip = np.concatenate((first, first[1:]))
    normal, traction, stick, status = drag(Coulomb(mu=0.3), np.full(len(slip), -1e-4), slip)
    # products of two numbers of five digits: a few roundings
    np.testing.assert_allclose(normal, -100, rtol=1e-12)
    assert np.abs(traction).max() == pytest.approx(30.0, rel=1e-12)
    plateau = status == Status.SLIP
    np.testing.assert_allclose(np.abs(slip - stick)[plateau], 0.003, rtol=1e-12)
    loop = slice(len(first) - 1, None)  # the second cycle begins and ends in the same point of the loop
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
    """[X] Case A7: the pressure falls while the point sticks; the friction falls with it along the cone."""
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
    for closed in (np.zeros(1000, bool), np.ones(1000, bool)):
        assert np.array_equal(law.reaches(gap, eps_n, closed), gap <= 0)
    gap = -np.abs(gap)
    out = law.update(gap, slip, eps_n, eps_t)
    limit = adhesion + mu * np.abs(out.normal)
    np.testing.assert_array_equal(out.normal, eps_n * gap)  # equation 4
    assert (np.abs(out.tangential) <= limit).all()
    slipping, sticking = out.status == Status.SLIP, out.status == Status.STICK
    assert (slipping ^ sticking).all()
    np.testing.assert_array_equal(np.abs(out.tangential)[slipping], limit[slipping])
    np.testing.assert_array_equal(out.tangential[sticking], (eps_t * slip)[sticking])
    assert (out.tangential * slip >= 0).all()  # it drags the slave back
    np.testing.assert_allclose(out.elastic_slip * eps_t, out.tangential, rtol=1e-14)
    if mu == adhesion == 0:
        assert not sticking.any() and not out.tangential.any()
    else:
        assert sticking.any() and slipping.any()


@pytest.mark.parametrize("law", [Coulomb(), Coulomb(0.4), Coulomb(0.4, 2.0), Coulomb(0.4, 2.0, 1.0), Tied()])
def test_derivatives(law, rng):
    """[X] Central differences; the laws are piecewise linear, so they are exact but for round-off."""
    h = 1e-7
    gap, slip = 1e-3 * rng.standard_normal((2, 500))
    eps_n, eps_t = 10.0 ** rng.uniform(3, 5, (2, 500))
    if isinstance(law, Coulomb) and law.tension == 0:
        gap = -np.abs(gap) - h
    out = law.update(gap, slip, eps_n, eps_t)
    change = {}
    for name, dg, ds in (("gap", h, 0), ("slip", 0, h)):
        up, down = (law.update(gap + k * dg, slip + k * ds, eps_n, eps_t) for k in (1, -1))
        same = (up.status == down.status) & (up.status == out.status) & (np.abs(gap) > h)
        assert same.mean() > 0.95
        for what in ("normal", "tangential"):
            change[what, name] = (same, (getattr(up, what) - getattr(down, what)) / (2 * h))
    expected = {
        ("normal", "gap"): out.normal_by_gap,
        ("normal", "slip"): np.zeros(500),
        ("tangential", "gap"): out.tangential_by_gap,
        ("tangential", "slip"): out.tangential_by_slip,
    }
    for key, (same, value) in change.items():
        # tractions of 1e2 with round-off 1e-14 over 2e-7
        np.testing.assert_allclose(value[same], expected[key][same], atol=1e-6)


def test_dissipation_is_never_negative(rng):
    """[X] Case S14: 2000 random increments of slip and pressure; what is not stored is dissipated."""
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
    """[X] A gap of exactly zero carries nothing but is stiff: bodies that touch need it to begin with."""
    law, zero, eps_n, eps_t = Coulomb(mu=0.3), np.zeros(1), np.array([1e3]), np.array([1e2])
    assert law.reaches(zero, eps_n, np.array([False]))[0]
    out = law.update(zero, zero, eps_n, eps_t)
    assert out.normal[0] == 0 and out.tangential[0] == 0
    assert out.status[0] == Status.STICK and out.normal_by_gap[0] == 1e3 and out.tangential_by_slip[0] == 1e2


def test_tension_cut_off():
    """[X] A closed point holds up to the cut-off, then opens for good; the cone ends at zero pressure."""
    gap = np.array([-1e-5, 1e-6, 4e-6, 6e-6, 4e-6, -1e-6])
    slip = np.full(6, 1.0)
    normal, traction, _, status = drag(Coulomb(mu=0.5, adhesion=2.0, tension=5.0), gap, slip)
    np.testing.assert_allclose(normal, [-10, 1, 4, 0, 0, -1], atol=1e-12)
    np.testing.assert_allclose(traction, [7, 2, 2, 0, 0, 0], atol=1e-12)
    assert (status == Status.OPEN).tolist() == [False, False, False, True, True, False]


def test_bond():
    """[X] A tied point is a spring both ways, and stays one."""
    one = np.ones(3)
    gap, slip = np.array([-1.0, 0.0, 2.0]), np.array([3.0, -4.0, 0.5])
    out = Tied().update(gap, slip, 5 * one, 7 * one)
    np.testing.assert_array_equal(out.normal, 5 * gap)
    np.testing.assert_array_equal(out.tangential, 7 * slip)
    closed = np.array([True, False, True])
    assert np.array_equal(Tied().reaches(gap, one, closed), closed)


def test_pure(rng):
    """[X] The arguments are not written to."""
    arguments = [-np.abs(rng.standard_normal(9)), rng.standard_normal(9), np.full(9, 3.0), np.full(9, 2.0)]
    before = [a.copy() for a in arguments]
    Coulomb(0.5).update(*arguments)
    for a, b in zip(arguments, before, strict=True):
        assert np.array_equal(a, b)


def test_limits_of_the_coefficient():
    """[X] Case S23: mu = 1e-12 is frictionless, mu = 1e6 sticks."""
    gap, slip, eps = np.full(3, -1e-3), np.array([-1.0, 1e-3, 1.0]), np.full(3, 1e4)
    assert np.abs(Coulomb(1e-12).update(gap, slip, eps, eps).tangential).max() <= 1e-11
    np.testing.assert_array_equal(Coulomb(1e6).update(gap, slip, eps, eps).tangential, 1e4 * slip)


@pytest.mark.parametrize("name", ["mu", "adhesion", "tension"])
@pytest.mark.parametrize("value", [-0.1, np.nan, np.inf])
def test_bad_parameters(name, value):
    with pytest.raises(ValueError, match=f"{name} must be a non-negative number"):
        Coulomb(**{name: value})
