"""Hoek-Brown: strengths in closed form, tangent and admissibility of all branches, GSI, a tunnel,
refusals.
"""

from __future__ import annotations

import numpy as np
import pytest

import skfem_contact as sc
from skfem_contact.errors import IncrementTooLarge
from skfem_contact.laboratory import isotropic, oedometer, triaxial
from skfem_contact.testing import check_material

ROCK = {"E": 5.7e6, "nu": 0.25, "sigma_ci": 30e3, "m_b": 1.7, "s": 0.0039}
QUIET = {"progress": False}


def rock(a=0.51, psi=0.0, **changes):
    """Rock mass of these constants with another curvature or dilatancy."""
    return sc.HoekBrown(**(ROCK | {"a": a, "psi": psi} | changes))


def strength(s1, law):
    """Difference of the principal stresses at a largest one."""
    return law.sigma_ci * (law.s - law.m_b * s1 / law.sigma_ci) ** law.a


@pytest.mark.parametrize("a", [0.5, 0.51, 0.65])
@pytest.mark.parametrize("psi", [0.0, 5.0, 40.0])
@pytest.mark.one_in(3)
def test_triaxial(a, psi):
    """[X] Compression: strength at the cell pressure, and the volume of a dilatancy that the
    friction caps.
    """
    law, cell = rock(a, psi), np.array([-500.0, -5e3])
    test = sc.element_test(law, cell, triaxial(-0.02, increments=25))
    np.testing.assert_allclose(-test.stress[-1, 1] + cell, strength(cell, law), rtol=1e-8)
    slope = a * law.m_b * (law.s - law.m_b * cell / law.sigma_ci) ** (a - 1)
    sine = np.minimum(np.sin(np.radians(psi)), slope / (2 + slope))
    volume, axial = test.volume[-1] - test.volume[-2], test.axial[-1] - test.axial[-2]
    np.testing.assert_allclose(
        volume, -2 * sine / (1 - sine) * axial, rtol=1e-6, atol=1e-12
    )  # differences


@pytest.mark.parametrize("psi", [0.0, 40.0])
def test_extension_and_tension(psi):
    """[X] Extension ends on the other edge, isotropic tension at the apex."""
    law, cell = rock(psi=psi), -5e3
    test = sc.element_test(law, cell, triaxial(0.02))
    s1 = test.stress[-1, 1, 0]
    assert s1 - cell == pytest.approx(strength(s1, law), rel=1e-8)
    increment = np.array([2e-3, 2e-3, 2e-3, 0.0])[:, None, None]
    apex = law.update(increment, np.zeros((4, 1, 1)), np.zeros((1, 1, 1))).stress
    np.testing.assert_allclose(apex[:3], law.s * law.sigma_ci / law.m_b, rtol=1e-8)
    assert law.tensile_strength == pytest.approx(law.s * law.sigma_ci / law.m_b)


@pytest.mark.parametrize("ncomp", [4, 6])
@pytest.mark.parametrize("a", [0.5, 0.51, 0.65])
@pytest.mark.parametrize("psi", [0.0, 20.0, 45.0])
@pytest.mark.parametrize("strain", [1e-4, 1e-3, 1e-2])
@pytest.mark.one_in(3)
def test_contract(ncomp, a, psi, strain):
    """Tangent within 1e-6 of the largest modulus at smooth points, admissibility, and dissipation
    at every point.
    """
    assert check_material(rock(a, psi), strain, ncomp=ncomp, tolerance=1e-6) < 1e-6


@pytest.mark.parametrize("size", 10.0 ** np.arange(-6, 0))
@pytest.mark.parametrize("psi", [0.0, 20.0])
def test_yield_condition_at_random_points(size, psi):
    """20,000 points: the stress is admissible, and a zero increment does not change it."""
    rng, n, law = np.random.default_rng(5), 20_000, rock(psi=psi)
    stress = np.zeros((6, n, 1))
    stress[:3] = -(10.0 ** rng.uniform(1, 4, n)[:, None])
    increment = size * rng.standard_normal(stress.shape)
    new = law.update(increment, stress, law.initial_internal(stress))
    again = law.update(np.zeros_like(increment), new.stress, new.internal)
    largest = np.abs(new.stress).max(axis=0)
    assert (np.abs(again.stress - new.stress).max(axis=0) / largest).max() < 1e-8
    shear, limit = law.mobilised(new.stress, new.internal)
    below = limit > 1e-3 * law.sigma_ci  # near the apex the slope of the strength is infinite
    assert (shear[below] / limit[below]).max() < 1 + 1e-8


def test_limit_of_a_straight_strength():
    """[X] A nearly straight strength is that of Mohr-Coulomb along a path of all branches."""
    law = rock(0.999999, m_b=2.0, s=0.1)
    sine = 2.0 / (2 + 2.0)
    c = 0.1 * law.sigma_ci / (1 + 2.0) ** 0.5 / 2
    soil = sc.MohrCoulomb(law.E, law.nu, c, np.degrees(np.arcsin(sine)))
    path = [triaxial(-0.01), oedometer(strain=-0.005)]
    np.testing.assert_allclose(
        sc.element_test(law, -1e3, path).stress,
        sc.element_test(soil, -1e3, path).stress,
        rtol=2e-5,
        atol=1.0,
    )


def test_chords_hold_up_to_the_end_of_the_last_one():
    """[X] Both ends of the last chord lie on the envelope of Mohr's circles, all below it."""
    law = rock()
    lines, most = law.lines(1e4)
    intercept, slope = lines[-2:, :, 0].T
    knot = -np.diff(intercept) / np.diff(slope)  # where the last two chords meet
    sigma = np.concatenate((knot, most * [0.1, 0.5, 1.0]))

    # the envelope, as the highest of many circles
    s1 = -np.geomspace(1e3, 1e8, 400001)
    radius = 0.5 * strength(s1, law)
    squares = radius**2 - (sigma[:, None] + s1 - radius) ** 2
    envelope = np.sqrt(squares.max(axis=1))
    share = (intercept[-1] + slope[-1] * sigma) / envelope
    np.testing.assert_allclose(share[[0, -1]], 1.0, rtol=1e-5)
    assert (share[1:-1] < 0.999).all()
    assert (knot < 0.01 * most).all()


def test_last_tangent_touches_beyond_the_bearing_capacity():
    """[X] At least at three times that of two wedges of weightless rock, ci (s^a + (m_b s^a +
    s)^a), where the stresses of the search are lower.
    """
    law = rock()
    uniaxial = law.s**law.a
    capacity = law.sigma_ci * (uniaxial + (law.m_b * uniaxial + law.s) ** law.a)
    growth = law.a * law.m_b * (3.0 * law.m_b * capacity / law.sigma_ci + law.s) ** (law.a - 1.0)
    lines, _ = law.lines(0.0, inner=False)
    sine = growth / (2.0 + growth)
    assert lines[-1, 1, 0] == pytest.approx(sine / np.sqrt(1.0 - sine**2), rel=1e-9)


def test_tangents_of_a_reduced_strength():
    """[X] Both the shear stress and tan(phi) of the whole strength are divided by the factor, at
    the same normal stress.
    """
    whole, reduced = (
        law.lines(0.0, inner=False)[0][:, :, 0] for law in (rock(), rock().reduced(2.0))
    )
    np.testing.assert_allclose(reduced, whole / 2.0, rtol=1e-9)


def test_dilatancy_of_a_reduced_strength():
    """[X] The given one stays; with the associated flow it is as large as the friction."""
    law = rock(psi=5.0)
    assert law.reduced(2.0).psi == 5.0
    assert law.dilates_less and law.reduced(2.0).dilates_less
    assert not law.reduced(2.0, "associated").dilates_less


def test_index():
    """[P] Hoek, Carranza-Torres and Corkum (2002): the equations at GSI 50, and intact rock at GSI
    100.
    """
    law = sc.HoekBrown.from_gsi(5.7e6, 0.25, 30e3, m_i=10.0, gsi=50.0, disturbance=0.5)
    assert law.m_b == pytest.approx(10 * np.exp(-50 / 21)) and law.s == pytest.approx(
        np.exp(-50 / 7.5)
    )
    assert law.a == pytest.approx(0.5 + (np.exp(-50 / 15) - np.exp(-20 / 3)) / 6)
    intact = sc.HoekBrown.from_gsi(5.7e6, 0.25, 30e3, m_i=[7.0, 10.0], gsi=100.0)
    np.testing.assert_allclose(intact.m_b, [7.0, 10.0])
    assert intact.s == 1.0 and intact.a == pytest.approx(0.5, abs=1e-6)


def test_bad_input():
    """Constants out of range are refused with the figure; searches are refused in words."""
    for message, changes in [
        ("sigma_ci must be positive", {"sigma_ci": 0.0}),
        ("m_b must be positive", {"m_b": -1.0}),
        ("s must lie between 0 and 1, got 1.1", {"s": 1.1}),
        (r"a must lie in \[0.5, 1\)", {"a": 0.4}),
        (r"psi must lie in \[0, 90\)", {"psi": -1.0}),
        ("E must be positive", {"E": 0.0}),
    ]:
        with pytest.raises(ValueError, match=message):
            rock(**changes)
    for message, changes in [
        ("gsi must be above 0 and at most 100, got 101", {"gsi": 101.0}),
        ("disturbance must lie", {"disturbance": 2.0}),
        ("m_i must", {"m_i": 0.0}),
    ]:
        with pytest.raises(ValueError, match=message):
            sc.HoekBrown.from_gsi(
                **({"E": 1e6, "nu": 0.2, "sigma_ci": 1e4, "m_i": 10.0, "gsi": 50.0} | changes)
            )
    with pytest.raises(ValueError, match="outside the yield surface"):
        sc.element_test(rock(), 100.0, isotropic(-1.0))
    with pytest.raises(ValueError, match="flow 'davis_b' needs one friction angle"):
        rock().reduced(1.2, "davis_b")


def test_a_failed_return_is_refused(monkeypatch):
    """A return that ends outside of the strength raises IncrementTooLarge instead of returning a
    wrong stress.
    """
    from skfem_contact.materials import hoek_brown

    monkeypatch.setattr(hoek_brown, "_MOST", 1)
    law = rock(0.9)
    with pytest.raises(
        IncrementTooLarge, match="the return to the strength of Hoek and Brown fails at 1 point"
    ):
        law.update(
            np.array([0.0, -0.1, 0.0, 0.0])[:, None, None],
            np.zeros((4, 1, 1)) - 1.0,
            np.zeros((1, 1, 1)),
        )
