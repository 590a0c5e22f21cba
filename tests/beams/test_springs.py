"""Springs by curves along a pile: elastic piles, limit loads, loops, API curves, wrong curves."""

from __future__ import annotations

import numpy as np
import pytest

import skfem_contact as sc
from skfem_contact.beams.springs import checked, in_parallel


def pile(length=10.0, n=41, **options):
    """An upright pile with its head at the origin."""
    return sc.Beam(None, np.linspace((0.0, 0.0), (0.0, -length), n), GA=1e9, **options)


def pushed(beam, ground, force, moment=0.0):
    """The stage of a force and a moment at the head."""
    model = sc.Model({"pile": beam, "ground": ground})
    load = model.forms["pile"].load(force, at=(0.0, 0.0), moment=moment)
    return model.run([sc.Stage("push", load)])["push"]


LINEAR = [(0.0, 0.0), (10.0, 1e5)]  # k = 1e4


def test_long_elastic_pile():
    """[X] Hetenyi: y = 2 H b / k at the head, M = 0.3224 H / b at b z = pi / 4.

    41 elements of b h = 0.25; the beam's functions are cubic, springs are at nodes.
    """
    EI = 4e4
    b = (1e4 / (4.0 * EI)) ** 0.25
    beam = pile(length=20.0, n=81, EI=EI, EA=1e8)
    stage = pushed(beam, sc.PileSprings(beam, p_y=LINEAR, t_z=LINEAR), (100.0, 0.0))
    table = stage.table("ground")
    lateral = table["kind"] == "p"
    assert np.isclose(abs(table["deflection"][lateral][0]), 2.0 * 100.0 * b / 1e4, rtol=2e-3)
    largest = np.abs(stage.section_forces("pile").M).max()
    assert np.isclose(largest, 0.3224 * 100.0 / b, rtol=2e-3)
    # forces of the ground hold the head in equilibrium
    s = table["position"][lateral]
    total = np.trapezoid(table["resistance"][lateral], s)
    assert np.isclose(abs(total), 100.0, rtol=2e-3)


def test_axial_capacity():
    """[X] Skin 30 per length over 10 and the tip 200 in compression, skin alone in tension."""
    beam = pile(EI=1e4, EA=1e7)
    t_z = [(0.0, 0.0), (0.002, 30.0)]
    q_z = [(0.0, 0.0), (0.05, 200.0)]
    ground = sc.PileSprings(beam, p_y=LINEAR, t_z=t_z, q_z=q_z)
    model = sc.Model({"pile": beam, "ground": ground})
    for force, capacity in ((-1.0, 500.0), (1.0, 300.0)):
        load = model.forms["pile"].load((0.0, force), at=(0.0, 0.0))
        found = model.limit_load(load, step=50.0, progress=False)
        assert np.isclose(found.multiplier, capacity, rtol=0.01)


def test_lateral_capacity_of_a_rigid_pile():
    """[X] A rigid pile in ground of one resistance p: H = (sqrt(2) - 1) p L at its head.

    It turns about a point at L / sqrt(2); springs at nodes 0.25 apart, tolerance of the search.
    """
    beam = pile(EI=1e9, EA=1e9)
    ground = sc.PileSprings(beam, p_y=[(0.0, 0.0), (0.01, 40.0)], t_z=LINEAR)
    model = sc.Model({"pile": beam, "ground": ground})
    load = model.forms["pile"].load((1.0, 0.0), at=(0.0, 0.0))
    found = model.limit_load(load, step=20.0, progress=False)
    assert np.isclose(found.multiplier, (np.sqrt(2.0) - 1.0) * 400.0, rtol=0.015)


def test_backbone_and_loop():
    """[X] First loading follows the points, unloading twice the curve (Masing), reloading returns
    to the backbone.
    """
    curve = np.array([[0.0, 0.0], [1.0, 10.0], [3.0, 16.0], [6.0, 19.0]])
    k, r = in_parallel([curve])
    assert np.isclose(k.sum(), 10.0) and np.isclose(r.sum(), 19.0)
    beam = sc.Beam(None, [[0.0, 0.0], [0.0, -1.0], [0.0, -2.0]], EI=1e9, EA=1e9, GA=1e9)
    ground = sc.PileSprings(beam, p_y=curve)
    model = sc.Model({"pile": beam, "ground": ground})
    form = model.forms["ground"]

    def moved(y, state):
        x = np.zeros(model.layout.size)
        x[form._dofs[:, 0]] = -y  # the pile moves to the left, positive across it
        response = form.assemble(x, state)
        return response.state, np.abs(response.force).sum() / 2.0

    state = form.initial_state()
    for y, force in (*curve[1:], (7.0, 19.0)):
        state, total = moved(y, state)
        assert np.isclose(total, force)
    start = state
    unloaded, total = moved(5.0, start)
    assert np.isclose(total, abs(19.0 - 2.0 * 10.0 * 1.0))  # twice the curve, over 2
    _, total = moved(7.0, unloaded)
    assert np.isclose(total, 19.0)


def test_tangent():
    """[N] The tangent is the derivative of the force, away from the knees."""
    curve = np.array([[0.0, 0.0], [0.1, 10.0], [0.5, 20.0]])
    beam = pile(EI=1.0, EA=1.0, n=4)
    ground = sc.PileSprings(beam, p_y=curve, t_z=curve, q_z=curve)
    form = sc.Model({"pile": beam, "ground": ground}).forms["ground"]
    rng = np.random.default_rng(0)
    x = rng.uniform(-0.4, 0.4, int(form._dofs.max()) + 1)
    state = form.assemble(0.3 * x, form.initial_state()).state
    response = form.assemble(x, state)
    h = 1e-7
    for k in range(len(x)):
        step = np.zeros(len(x))
        step[k] = h
        ahead = form.assemble(x + step, state).force
        behind = form.assemble(x - step, state).force
        quotient = (ahead - behind) / (2.0 * h)
        assert np.allclose(response.stiffness.toarray()[:, k], quotient, atol=1e-5)


def test_spacing_of_a_row():
    """[X] Piles 2 apart: the same deflection under half of the force per length of the row."""
    found = []
    for spacing, force in ((None, 100.0), (2.0, 50.0)):
        beam = pile(EI=4e4, EA=1e8, spacing=spacing)
        stage = pushed(beam, sc.PileSprings(beam, p_y=LINEAR, t_z=LINEAR), (force, 0.0))
        found.append(stage.table("ground"))
    for column in ("deflection", "resistance"):
        assert np.allclose(found[0][column], found[1][column])


def test_curves_of_the_api():
    """[P] C1, C2, C3 of API RP 2GEO for 30 and 35 degrees, read from its figure to 2 %; clay
    reaches 9 s_u D below the depth (6 D) / (gamma' D / s_u + J), tip and skin their limits.
    """
    for phi, factors in ((30.0, (1.9, 2.67, 28.8)), (35.0, (2.97, 3.42, 53.8))):
        assert np.allclose(sc.curves.sand_factors(phi), factors, rtol=0.02)
    depth = 6.0 * 1.0 / (8.0 * 1.0 / 30.0 + 0.5)
    for z, share in ((0.0, 3.0), (depth, 9.0), (2.0 * depth, 9.0)):
        curve = sc.curves.clay_p_y(z, 1.0, su=30.0, unit_weight=8.0)
        assert np.isclose(curve[-1, 1], share * 30.0)
    curve = sc.curves.sand_p_y(4.0, 1.0, phi=35.0, unit_weight=10.0, k=2e4)
    chord = np.tanh(0.15) / 0.15  # of the first step
    assert np.isclose(curve[1, 1] / curve[1, 0], chord * 2e4 * 4.0, rtol=1e-9)
    y = np.linspace(0.0, curve[-1, 0], 200)
    largest = curve[-1, 1]
    formula = largest * np.tanh(2e4 * 4.0 * y / largest)
    between = np.interp(y, *curve.T)
    assert np.abs(between - formula).max() < 0.005 * largest  # lines between the points
    assert np.isclose(sc.curves.sand_t_z(50.0, 0.5)[-1, 1], 50.0 * np.pi * 0.5)
    for known in (curve, sc.curves.clay_t_z(40.0, 1.0), sc.curves.q_z(500.0, 1.0)):
        checked(known, 1.0, "curve")
    at_surface = sc.curves.sand_p_y(0.0, 1.0, phi=35.0, unit_weight=10.0, k=2e4)
    assert not at_surface[:, 1].any()
    cyclic = sc.curves.sand_p_y(4.0, 1.0, phi=35.0, unit_weight=10.0, k=2e4, cyclic=True)
    assert np.isclose(cyclic[-1, 1], 0.9 * (2.97 * 4.0 + 3.42 * 1.0) * 10.0 * 4.0, rtol=2e-3)


def test_published_points_of_curves_in_clay():
    """[P] Matlock: p / p_u = (y / y_c)^(1/3) / 2 with y_c = 2.5 eps50 D under static load; skin and
    tip by the tables of API RP 2A-WSD, 6.7.2 and 6.7.3.
    """
    D = 0.5
    y, p = sc.curves.clay_p_y(10.0, D, su=30.0, unit_weight=8.0, eps50=0.02).T
    y_c = 2.5 * 0.02 * D
    # the table of two digits at .1, .3, 1, 3 and 8 y_c
    assert y[1:] / y_c == pytest.approx([0.1, 0.3, 1.0, 3.0, 8.0], rel=1e-12)
    assert p / p[-1] == pytest.approx(0.5 * (y / y_c) ** (1 / 3), abs=0.006)
    skin = dict(sc.curves.clay_t_z(1.0 / (np.pi * D), D).round(9))
    published = {0.0016: 0.3, 0.0031: 0.5, 0.0057: 0.75, 0.008: 0.9, 0.01: 1.0}
    assert skin == pytest.approx({0.0: 0.0, **{z * D: share for z, share in published.items()}})
    tip = dict(sc.curves.q_z(1.0, D).round(9))
    published = {0.002: 0.25, 0.013: 0.5, 0.042: 0.75, 0.073: 0.9, 0.1: 1.0}
    assert tip == pytest.approx({0.0: 0.0, **{z * D: share for z, share in published.items()}})


def test_curves_are_the_same_in_all_units():
    """[X] In GN a curve has the displacements of that in kN, and 1e-6 of the forces."""
    in_kN = sc.curves.sand_p_y(4.0, 1.0, phi=35.0, unit_weight=10.0, k=2e4)
    in_GN = sc.curves.sand_p_y(4.0, 1.0, phi=35.0, unit_weight=1e-5, k=2e-2)
    np.testing.assert_allclose(in_GN, in_kN * [1.0, 1e-6], rtol=1e-12)


def test_mobilised_share_is_told():
    """[X] Rigid supports of 10 per length under a push of 12 over a length of 2 give 60 %."""
    beam = sc.Beam(None, [[0.0, 0.0], [0.0, -1.0], [0.0, -2.0]], EI=1e9, EA=1e9)
    ground = sc.PileSprings(beam, p_y=np.array([[0.0, 0.0], [0.1, 10.0]]))
    model = sc.Model({"pile": beam, "ground": ground}, beam.dofs((0.0, -2.0), ["u^2"]))
    load = model.forms["pile"].line_load((6.0, 0.0))
    stage = model.run([sc.Stage("push", load)], progress=False)["push"]
    assert stage.summary["ground"] == "springs up to 60% of their resistance"


@pytest.mark.parametrize(
    ("curve", "message"),
    [
        ([(0.0, 1.0), (1.0, 2.0)], r"begin with \(0, 0\)"),
        ([(0.0, 0.0)], r"begin with \(0, 0\)"),
        ([(0.0, 0.0), (1.0, 5.0), (0.5, 6.0)], "displacements must grow"),
        ([(0.0, 0.0), (1.0, 5.0), (2.0, 4.0)], "must not fall"),
        ([(0.0, 0.0), (1.0, 1.0), (2.0, 5.0)], "slope must not grow"),
        ([(0.0, 0.0), (1.0, np.nan)], "finite"),
    ],
)
def test_wrong_curves(curve, message):
    """One sentence for each, with the distance from the head."""
    with pytest.raises(ValueError, match=message):
        sc.PileSprings(pile(EI=1.0, EA=1.0), p_y=curve)


def test_slopes_that_grow_by_more_than_round_off_are_refused():
    """A share of 1e-15 of the first slope is round-off, one of 1e-8 is none."""
    beam = pile(EI=1.0, EA=1.0)
    sc.PileSprings(beam, p_y=[(0.0, 0.0), (1.0, 5.0), (2.0, 10.0 + 5e-15)])
    with pytest.raises(ValueError, match="slope must not grow"):
        sc.PileSprings(beam, p_y=[(0.0, 0.0), (1.0, 5.0), (2.0, 10.0 + 5e-8)])


def test_wrong_piles():
    """Springs need a curve and a pile in the plane."""
    with pytest.raises(ValueError, match="need a curve"):
        sc.PileSprings(pile(EI=1.0, EA=1.0))
    space = sc.Beam(None, [[0.0, 0.0, 0.0], [0.0, 0.0, -1.0]], EI=1.0, EA=1.0)
    with pytest.raises(ValueError, match="in the plane"):
        sc.PileSprings(space, p_y=LINEAR)
    for phi in (-3.0, 61.0):
        with pytest.raises(ValueError, match="phi must be"):
            sc.curves.sand_factors(phi)
    with pytest.raises(ValueError, match="su must be"):
        sc.curves.clay_p_y(1.0, 1.0, su=0.0, unit_weight=8.0)
