"""Moments and curvatures of reinforced sections beside hand calculations."""

from __future__ import annotations

import numpy as np
import pytest

import skfem_contact as sc

B, H, FC, FY = 1.0, 0.8, 20e3, 435e3
#: Share of the compressed depth that the stresses fill, and depth of their resultant: 1 - 1/3 of
#: eps_c / eps_cu, and the centre of the parabola and the rectangle.
FULL = 1.0 - 0.002 / 0.0035 / 3.0
CENTRE = 0.415986


@pytest.mark.parametrize("normal", [0.0, -800.0, 200.0])
def test_moment_with_a_normal_force(normal):
    """[X] Bars that yield: x = (A f_y - N) / (0.8095 f_c b), moments about the middle.

    Layers of h / 200 leave 2e-3.
    """
    area, depth = 3e-3, 0.74
    found = sc.moment_curvature(B, H, [(area, depth)], f_c=FC, f_y=FY, normal=normal)
    x = (area * FY - normal) / (FULL * FC * B)
    thrust = FULL * FC * B * x
    by_hand = thrust * (H / 2 - CENTRE * x) + area * FY * (depth - H / 2)
    assert np.isclose(found.largest, by_hand, rtol=3e-3)
    assert (np.diff(found.moment) > -2e-3 * found.largest).all()


def test_crushed_concrete_ends_the_curve():
    """[X] Of 6e-3 of steel the bars yield at 1.3 %, far from 2.5 %: the last curvature is
    eps_cu / x.  Layers leave 2e-3.
    """
    found = sc.moment_curvature(B, H, [(6e-3, 0.74)], f_c=FC, f_y=FY)
    x = 6e-3 * FY / (FULL * FC * B)
    assert found.curvature[-1] == pytest.approx(0.0035 / x, rel=3e-3)


def test_bars_on_both_sides_are_symmetric():
    """[X] Without force equal bars at 0.06 and 0.74 give the same moment upside down."""
    bars = [(2e-3, 0.06), (2e-3, 0.74)]
    found = sc.moment_curvature(B, H, bars, f_c=FC, f_y=FY)
    turned = sc.moment_curvature(B, H, bars[::-1], f_c=FC, f_y=FY)
    assert np.isclose(found.largest, turned.largest, rtol=1e-12)
    # the lever of the yielding bars lies between the bars' distance and that to the edge
    assert 2e-3 * FY * 0.68 < found.largest < 2e-3 * FY * 0.74


def test_stiffness_before_cracking():
    """[X] M = f_t b h^2 / 6 at cracking; below it EI is that of the gross section with its bars.

    The modulus at zero strain is 2 f_c / eps_c = 2e7; the parabola is softer by 2 % at half of it.
    """
    found = sc.moment_curvature(B, H, [(1e-4, 0.74)], f_c=FC, f_y=FY, f_t=2e3)
    assert np.isclose(found.cracking, 2e3 * B * H**2 / 6.0)
    EI = 2e7 * B * H**3 / 12.0
    k = found.curvature[1]
    assert np.isclose(found.moment[1] / k, EI, rtol=0.03)
    assert found.stiffness < EI


def test_limits_of_a_beam():
    """The result gives EI and Mp of a beam, and a table with units."""
    found = sc.moment_curvature(B, H, [(3e-3, 0.74)], f_c=FC, f_y=FY)
    beam = sc.Beam(None, [[0.0, 0.0], [1.0, 0.0]], EI=found.stiffness, EA=1e7, Mp=found.largest)
    assert beam.parameters["Mp"] == found.largest
    assert len(found.table()) == len(found.curvature) and "curvature" in str(found)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"width": 0.0}, "width"),
        ({"steel": [(1e-3, 0.9)]}, r"depths between 0 and 0\.8"),
        ({"steel": [(-1e-3, 0.5)]}, "steel is pairs"),
        ({"f_c": -1.0}, "f_c"),
        ({"eps_cu": 0.001}, "eps_cu must exceed"),
        ({"normal": 1e6}, "resists normal forces between"),
    ],
)
def test_wrong_sections(change, message):
    """One sentence each."""
    given = {"width": B, "height": H, "steel": [(3e-3, 0.74)], "f_c": FC, "f_y": FY} | change
    with pytest.raises(ValueError, match=message):
        sc.moment_curvature(**given)


@pytest.mark.parametrize(
    ("f_t", "normal", "stress"),
    [
        (0.0, -800.0, 1e3),
        (2e3, -800.0, 3e3),
        (2e3, 800.0, 1e3),
        (1e3, 1200.0, 0.0),
        (0.0, 0.0, 0.0),
    ],
)
def test_cracking_under_a_normal_force(f_t, normal, stress):
    """[X] The edge cracks where M / W - N / A reaches f_t, also without tensile strength."""
    found = sc.moment_curvature(
        B, H, [(6e-3, 0.1), (6e-3, 0.7)], f_c=FC, f_y=FY, f_t=f_t, normal=normal
    )
    assert found.cracking == pytest.approx(stress * B * H**2 / 6.0)


@pytest.mark.parametrize("bar", [(1e-3, H), (1e-3, 0.0), (0.0, 0.4), (-1e-3, 0.4)])
def test_wrong_bars(bar):
    """Bars outside of the concrete, and bars without area."""
    with pytest.raises(ValueError, match=r"depths between 0 and 0\.8"):
        sc.moment_curvature(B, H, [(1e-3, 0.4), bar], f_c=FC, f_y=FY)
