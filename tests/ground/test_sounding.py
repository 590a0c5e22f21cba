"""Soil behaviour, correlations and layers of soundings."""

from __future__ import annotations

import numpy as np
import pytest

import skfem_contact as sc
from skfem_contact.ground.sounding import _joined, _merged


def sounding(cone, sleeve, depth=None, water=0.0, **more):
    """A sounding with constant or given readings to 10 m, in kPa."""
    depth = np.arange(0.1, 10.05, 0.1) if depth is None else depth
    nothing = 0.0 * depth
    pore = np.full(len(depth), np.nan)
    return sc.ground.Sounding(
        "C1", (0.0,), 2.0, depth, cone + nothing, sleeve + nothing, pore, water=water, **more
    )


def test_index_of_soil_behaviour_by_hand():
    """[X] At 5 m with 20 kN/m3 and water at the surface, stresses are 100 and 50.95 kPa.

    For n = 1 (clay) the index follows at once from Q = (620 - 100)/50.95 and F = 24/520.
    """
    found = sounding(620.0, 24.0).behaviour(unit_weight=20.0)
    at = 49
    assert found["total"][at] == pytest.approx(100.0)
    assert found["effective"][at] == pytest.approx(100.0 - 9.81 * 5.0)
    Q = 520.0 / (100.0 - 49.05)
    F = 100.0 * 24.0 / 520.0
    index = np.hypot(3.47 - np.log10(Q), np.log10(F) + 1.22)
    assert found["Q_tn"][at] == pytest.approx(Q)
    assert found["F_r"][at] == pytest.approx(F)
    assert found["I_c"][at] == pytest.approx(index)
    assert found["zone"][at] == 3  # clay, 2.95 < I_c < 3.6


def test_ground_above_the_water_table_is_dry():
    """[X] Effective stresses are total ones down to the table, and less by 9.81 kPa/m below."""
    found = sounding(8000.0, 40.0, water=3.0)
    stresses = found.behaviour(unit_weight=20.0)
    np.testing.assert_allclose(stresses["total"], 20.0 * found.depth)
    below = np.maximum(found.depth - 3.0, 0.0)
    np.testing.assert_allclose(stresses["effective"], 20.0 * found.depth - 9.81 * below)


def test_exponent_of_stresses_is_that_of_the_index():
    """[X] In sand the exponent satisfies n = 0.381 I_c + 0.05 s'/p_a - 0.15."""
    found = sounding(8000.0, 40.0).behaviour(unit_weight=20.0)
    net = 8000.0 - found["total"]
    n = np.log(found["Q_tn"] / (net / 100.0)) / np.log(100.0 / found["effective"])
    wanted = 0.381 * found["I_c"] + 0.05 * found["effective"] / 100.0 - 0.15
    np.testing.assert_allclose(n, np.minimum(wanted, 1.0), atol=2e-3)  # end of the iteration
    assert (found["zone"] == 6).sum() > 80


def test_small_friction_counts():
    """[X] Any friction above zero has a ratio."""
    found = sounding(8000.0, 0.05).behaviour(unit_weight=20.0)
    assert found["F_r"][49] == pytest.approx(100.0 * 0.05 / 7900.0)


def test_profiles_name_their_correlations():
    """[X] Each formula, by hand, and where it is not meant for the soil."""
    sand = sounding(8000.0, 40.0)
    clay = sounding(620.0, 24.0)
    phi = sand.profile("phi", 20.0)
    Q = sand.behaviour(20.0)["Q_tn"]
    np.testing.assert_allclose(phi.values, 17.6 + 11.0 * np.log10(Q))
    assert "Kulhawy & Mayne 1990" in phi.correlation
    strength = clay.profile("su", 20.0, N_kt=15.0)
    assert strength.values[49] == pytest.approx(520.0 / 15.0)
    assert "N_kt = 15" in strength.correlation and strength.unit == "kPa"
    assert strength.between(4.95, 5.05) == pytest.approx(520.0 / 15.0)
    assert np.isnan(clay.profile("phi", 20.0).values[20:]).all()
    assert np.isnan(sand.profile("su", 20.0).values).all()
    weight = sand.profile("unit_weight").values[0]
    wanted = 9.81 * (0.27 * np.log10(0.5) + 0.36 * np.log10(80.0) + 1.236)
    assert weight == pytest.approx(wanted)
    stiffness = sand.profile("E", 20.0).values[49]
    index = sand.behaviour(20.0)["I_c"][49]
    assert stiffness == pytest.approx(0.015 * 10 ** (0.55 * index + 1.68) * 7900.0)
    with pytest.raises(ValueError, match="no correlation for 'c'; known are unit_weight, phi"):
        sand.profile("c")
    with pytest.raises(ValueError, match="'phi' has no constant 'N_kt'; known: none"):
        sand.profile("phi", 20.0, N_kt=14.0)
    with pytest.raises(ValueError, match="no su between the depths 1 and 2"):
        sand.profile("su", 20.0).between(1.0, 2.0)


def test_layers_and_a_thin_one():
    """[X] Sand to 4 m, clay below with a lens of 0.3 m, which is joined to it."""
    depth = np.arange(0.1, 10.05, 0.1)
    lens = (depth > 6.95) & (depth < 7.25)
    sand = (depth <= 4.0) | lens
    test = sounding(np.where(sand, 8000.0, 620.0), np.where(sand, 40.0, 24.0), depth)
    column = test.column(unit_weight=20.0)
    # In the sand, the zone changes where stresses are very low
    assert column.soils[-1] == "clay"
    assert column.layers[-2][1] == pytest.approx(2.0 - 4.05)
    assert column.layers[-1][1] == pytest.approx(2.0 - 10.0)
    own = {2: "soft", 3: "soft", 4: "soft", 5: "firm", 6: "firm", 7: "firm"}
    assert test.column(own, unit_weight=20.0).soils == ("firm", "soft")
    with_lens = test.column(own, unit_weight=20.0, thinnest=0.1).soils
    assert with_lens == ("firm", "soft", "firm 2", "soft 2")
    with pytest.raises(ValueError, match="soils has no name for zone 2"):
        test.column({3: "clay"})


def test_a_thin_layer_is_joined_to_the_one_that_is_like_it():
    """[X] Bounds lie between readings; the layer above or below of the nearer index grows."""
    depth, names = np.arange(0.5, 7.0), [*"AAABCCC"]
    for index, ends in ((2.1, [("A", 4.0), ("C", 6.5)]), (2.9, [("A", 3.0), ("C", 6.5)])):
        indices = np.array([2.0, 2.0, 2.0, index, 3.0, 3.0, 3.0])
        assert _joined(depth, names, indices, 1.5) == ends


def test_layers_of_one_soil_have_their_mean_index():
    """[X] Three metres of index 2 and one of index 3 are four of 2.25."""
    layers = [["A", 1.0, 4.0, 2.0], ["A", 4.0, 5.0, 3.0], ["B", 5.0, 6.0, 3.5]]
    assert _merged(layers) == [["A", 1.0, 5.0, 2.25], ["B", 5.0, 6.0, 3.5]]


def test_readings_without_values_make_no_layer():
    """[X] The gap belongs to the layer above; nothing is interpolated into it."""
    depth = np.arange(0.1, 10.05, 0.1)
    cone = np.where(depth <= 4.0, 8000.0, 620.0)
    cone[(depth > 4.05) & (depth < 5.95)] = np.nan
    test = sounding(cone, np.where(depth <= 4.0, 40.0, 24.0), depth)
    found = test.behaviour(20.0)
    assert (found["zone"][~test.measured] == 0).all()
    own = dict.fromkeys((2, 3, 4), "soft") | dict.fromkeys((5, 6, 7), "firm")
    assert test.column(own, 20.0).layers[0][1] == pytest.approx(2.0 - 0.5 * (4.0 + 6.0))
    with pytest.raises(ValueError, match="'C1' has no readings of cone and sleeve"):
        sounding(np.nan, 1.0).column(unit_weight=20.0)
    with pytest.raises(ValueError, match="'C1' has no water table"):
        sounding(620.0, 24.0, water=None).behaviour(20.0)
