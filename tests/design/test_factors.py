"""Partial factors: recommended values of EN 1997-1, design loads and wrong factors."""

from __future__ import annotations

import numpy as np
import pytest

import skfem_contact as sc
from skfem_contact.design import EC7, PartialFactors

#: Tables A.1 to A.5, A.13, A.15 and A.16 of EN 1997-1:2004, recommended values: gamma_G (with the
#: favourable one), gamma_Q, gamma_phi, gamma_c, gamma_cu, gamma_Rv, gamma_Rh, gamma_Re.
TABLES = {
    "DA1-1": (1.35, 1.0, 1.5, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0),
    "DA1-2": (1.0, 1.0, 1.3, 1.25, 1.25, 1.4, 1.0, 1.0, 1.0),
    "DA2": (1.35, 1.0, 1.5, 1.0, 1.0, 1.0, 1.4, 1.1, 1.4),
    "DA2*": (1.35, 1.0, 1.5, 1.0, 1.0, 1.0, 1.4, 1.1, 1.4),
    "DA3": (1.0, 1.0, 1.3, 1.25, 1.25, 1.4, 1.0, 1.0, 1.0),
    "EQU": (1.1, 0.9, 1.5, 1.25, 1.25, 1.4, 1.0, 1.0, 1.0),
    "UPL": (1.0, 0.9, 1.5, 1.25, 1.25, 1.4, 1.0, 1.0, 1.0),
}


@pytest.mark.parametrize("name", TABLES)
def test_recommended_values(name):
    """[P] The values of annex A."""
    one = EC7[name]
    assert TABLES[name] == (
        one.permanent,
        one.favourable,
        one.variable,
        one.phi,
        one.cohesion,
        one.undrained,
        one.bearing,
        one.sliding,
        one.passive,
    )


def test_design_loads():
    """[X] On actions all loads are factored, on effects only the ratio of variable ones."""
    G = np.array([10.0, 0.0])
    Q = np.array([0.0, 3.0])
    assert np.allclose(EC7["DA2"].load(permanent=G, variable=Q), [13.5, 4.5])
    assert np.allclose(EC7["DA2*"].load(permanent=G, variable=Q), [10.0, 3.0 / 0.9])
    assert np.allclose(EC7["EQU"].load(favourable=G), [9.0, 0.0])
    assert EC7["DA2*"].effect(10.0) == 13.5
    assert EC7["DA2"].effect(10.0) == 10.0
    assert np.isclose(np.tan(np.radians(EC7["DA3"].friction_angle(45.0))), 0.8)


@pytest.mark.parametrize("value", [0.0, -1.0, np.nan, np.inf, True])
def test_factors_are_positive(value):
    """The name and the value of a wrong factor."""
    with pytest.raises(ValueError, match="phi"):
        PartialFactors(name="mine", phi=value)


def test_loads_are_needed():
    """A design load of nothing is refused."""
    with pytest.raises(ValueError, match="give a load"):
        EC7["DA2"].load()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"width": 0.0, "vertical": 10.0, "phi": 30.0}, "width"),
        ({"width": 1.0, "vertical": -1.0, "phi": 30.0}, "vertical"),
        ({"width": 1.0, "vertical": 10.0}, "no strength"),
        ({"width": 1.0, "vertical": 10.0, "phi": 75.0}, "phi is an angle"),
        ({"width": 1.0, "vertical": 10.0, "phi": 30.0, "c": -1.0}, "c must not be negative"),
        ({"width": 2.0, "vertical": 10.0, "phi": 30.0, "length": 1.0}, "length"),
        ({"width": 1.0, "vertical": 10.0, "phi": 30.0, "horizontal": 11.0}, "larger than"),
        ({"width": 1.0, "vertical": 10.0, "c": 5.0, "horizontal": 6.0}, "slides"),
    ],
)
def test_wrong_bearing(arguments, message):
    """One sentence for each wrong value."""
    with pytest.raises(ValueError, match=message):
        sc.design.bearing_resistance(**arguments)


def test_bearing_of_clay_is_that_of_prandtl():
    """[X] (pi + 2) c + q without a horizontal force, half of it where the base slides."""
    level = sc.design.bearing_resistance(2.0, vertical=50.0, c=20.0, surcharge=5.0)
    assert np.isclose(level.pressure, (np.pi + 2.0) * 20.0 + 5.0)
    assert level.capacity == (np.pi + 2.0, 1.0, 0.0)
    sliding = sc.design.bearing_resistance(2.0, vertical=50.0, c=20.0, horizontal=40.0)
    assert np.isclose(sliding.pressure, 0.5 * (np.pi + 2.0) * 20.0)


def test_bearing_of_a_square():
    """[P] Factors of annex D for 30 degrees, as published in many worked examples: Nq = 18.4,
    Nc = 30.14, Ngamma = 20.09; a square has sq = 1.5, sgamma = 0.7, sc = 1.529.
    """
    found = sc.design.bearing_resistance(1.5, vertical=300.0, length=1.5, phi=30.0, c=5.0)
    assert np.allclose(found.capacity, (30.14, 18.40, 20.09), atol=0.005)
    assert np.allclose(found.shape, (1.529, 1.5, 0.7), atol=0.0005)


@pytest.mark.parametrize("length", [2.0, np.inf])
def test_cohesion_acts_as_a_pressure_all_round(length):
    """[X] Caquot: c cot(phi) added to the surcharge and to the resistance, under inclined loads."""
    c, cot = 10.0, 1.0 / np.tan(np.radians(25.0))
    found = sc.design.bearing_resistance(
        2.0, vertical=100.0, horizontal=30.0, length=length, c=c, phi=25.0, surcharge=5.0
    )
    Nq, sq, iq = found.capacity[1], found.shape[1], found.inclination[1]
    of_cohesion = found.capacity[0] * found.shape[0]
    assert np.isclose(of_cohesion, cot * (Nq * sq - 1.0))
    assert np.isclose(found.inclination[0] * (Nq - 1.0), Nq * iq - 1.0)
    pressure = c * of_cohesion * found.inclination[0] + 5.0 * Nq * sq * iq
    assert np.isclose(found.pressure, pressure)


def test_bearing_beside_a_limit_load():
    """[B] The weightless strip on cohesive sand: Prandtl's Nc is exact, the formula returns it."""
    phi = np.radians(25.0)
    Nq = np.exp(np.pi * np.tan(phi)) * np.tan(np.pi / 4 + phi / 2) ** 2
    found = sc.design.bearing_resistance(2.0, vertical=100.0, c=10.0, phi=25.0)
    assert np.isclose(found.pressure, 10.0 * (Nq - 1.0) / np.tan(phi))


def test_inclined_load_beside_a_surcharge():
    """[X] A strip without weight and cohesion bears q N_q (1 - H/V)^2."""
    found = sc.design.bearing_resistance(
        2.0, vertical=100.0, horizontal=20.0, phi=30.0, surcharge=18.0
    )
    Nq = np.exp(np.pi * np.tan(np.pi / 6)) * np.tan(np.pi / 3) ** 2
    assert found.pressure == pytest.approx(18.0 * Nq * 0.8**2, rel=1e-12)


@pytest.mark.parametrize(
    ("length", "m", "sq", "sy"), [(2.0, 1.5, 1.5, 0.7), (4.0, 5 / 3, 1.25, 0.85)]
)
def test_inclined_load_on_a_rectangle(length, m, sq, sy):
    """[P] EN 1997-1, D.4, at 30 degrees: a surcharge bears by (1 - H/V)^m with m = 3/2 for a square
    and 5/3 for a rectangle twice as long as wide, weight by (1 - H/V)^(m + 1).
    """
    load = {"vertical": 100.0, "horizontal": 20.0, "length": length, "phi": 30.0}
    Nq = np.exp(np.pi * np.tan(np.pi / 6)) * np.tan(np.pi / 3) ** 2
    beside = sc.design.bearing_resistance(2.0, surcharge=18.0, **load)
    assert beside.pressure == pytest.approx(18.0 * Nq * sq * 0.8**m, rel=1e-12)
    assert beside.resistance == pytest.approx(2.0 * length * beside.pressure, rel=1e-12)
    below = sc.design.bearing_resistance(2.0, unit_weight=18.0, **load)
    Ny = 2.0 * (Nq - 1.0) * np.tan(np.pi / 6)
    assert below.pressure == pytest.approx(18.0 * Ny * sy * 0.8 ** (m + 1), rel=1e-12)


def test_clay_below_a_rectangle():
    """[P] EN 1997-1, D.3: 1 + 0.2 B/L, and no shear resistance is left where H = A c."""
    load = {"vertical": 100.0, "length": 4.0, "c": 20.0}
    level = sc.design.bearing_resistance(2.0, **load)
    assert level.pressure == pytest.approx((np.pi + 2.0) * 20.0 * 1.1, rel=1e-12)
    sliding = sc.design.bearing_resistance(2.0, horizontal=160.0, **load)
    assert sliding.resistance == pytest.approx(0.5 * level.resistance, rel=1e-12)
    with pytest.raises(ValueError, match="larger than the shear resistance 160"):
        sc.design.bearing_resistance(2.0, horizontal=160.1, **load)
