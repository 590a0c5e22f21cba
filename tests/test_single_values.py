"""Single expressions of laws and materials against numbers computed by hand."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import Basis, ElementQuad1, ElementVector, MeshQuad

import skfem_contact as sc
from skfem_contact.contact.laws import Status, resisting
from tests import mutate

#: Exact up to the round-off of a few operations.
EXACT = {"rtol": 1e-12, "atol": 1e-12}


def coulomb(law: sc.Coulomb, gap: float, slip: float):
    """Answer of a law of a closed point in the plane with penalties of 1000 and 500."""
    return law.update(np.array([[gap], [slip]]), np.zeros((1, 1)), (1000.0, 500.0))


def test_bond_breaks_at_its_tension():
    """[X] A tension of 10 is reached at a gap of 0.01; 0.5 % more opens the point for good."""
    law = sc.Coulomb(mu=0.5, adhesion=3.0, tension=10.0)
    below, above = coulomb(law, 0.00995, 0.0), coulomb(law, 0.01005, 0.0)
    np.testing.assert_allclose(below.traction[:, 0], [9.95, 0.0], **EXACT)
    assert (
        above.status[0] == Status.OPEN and not above.traction.any() and above.internal[0, 0] == 1.0
    )


@pytest.mark.parametrize(
    ("slip", "shear", "status"), [(0.0139, 6.95, Status.STICK), (0.0141, 7.0, Status.SLIP)]
)
def test_friction_and_adhesion(slip, shear, status):
    """[X] Under a pressure of 8 the shear is at most 3 + 0.5 * 8 = 7."""
    found = coulomb(sc.Coulomb(mu=0.5, adhesion=3.0), -0.008, slip)
    np.testing.assert_allclose(found.traction[:, 0], [-8.0, shear], **EXACT)
    assert found.status[0] == status


def test_damped_tangent_of_friction():
    """[X] By hand: .3 * 5 / 2e-3 = 750 along the slip of a point that slides, nothing where it
    sticks.
    """
    jump, whole = np.array([[-1e-3, -1e-3], [2e-3, 2e-4]]), np.zeros((1, 2))
    update = sc.Coulomb(mu=0.5).update(jump, whole, (1e4, 1e4))
    more = resisting(update, jump[1:]).tangent - update.tangent
    np.testing.assert_allclose(more[1, 1], [750.0, 0.0], rtol=1e-12)
    more[1, 1] = 0.0
    assert not more.any()


def test_reduced_friction():
    """[X] Friction and adhesion are divided by the factor."""
    law = sc.Coulomb(mu=0.6, adhesion=3.0).reduced(1.5)
    np.testing.assert_allclose([law.mu, law.adhesion], [0.4, 2.0], **EXACT)


def test_tied_points():
    """[X] Penalties times gap and slip, in both directions."""
    found = sc.Tied().update(
        np.array([[0.01, -0.02], [0.003, 0.004]]), np.zeros((0, 2)), (1000.0, 500.0)
    )
    np.testing.assert_allclose(found.traction, [[10.0, -20.0], [1.5, 2.0]], **EXACT)


def test_errors_of_multipliers_at_nodes_that_stick():
    """[X] Shear whose best multipliers act at a node beside points that slide counts for nothing.

    The facets are 3 and 1 long; points of the second slide, so that three quarters of the middle
    node stick.
    """
    mesh = MeshQuad.init_tensor(np.array([0.0, 3.0, 4.0]), np.array([0.0, 1.0])).with_defaults()
    basis = Basis(sc.join_bodies({"block": mesh}), ElementVector(ElementQuad1()))
    pair = sc.ContactPair(
        basis,
        "block:bottom",
        sc.rigid.line((-9.0, 0.0), (9.0, 0.0)),
        sc.Coulomb(0.5),
        2,
        penalty=100.0,
        enforcement=sc.AugmentedLagrangian(),
    )
    state = pair.initial_state()
    points, penalties = pair.points(state), (100.0, 100.0)
    nodal = np.isclose(pair.slave.nodes[:, 0], 3.0) * 1.0
    traction = np.stack((np.full(4, -1.0), points.at(nodal)))
    stick = np.where(
        points.positions(pair.slave.nodes)[:, 0] < 3.0, int(Status.STICK), int(Status.SLIP)
    )
    both = [
        vars(state)
        | {
            "traction": traction,
            "multiplier": np.stack((-np.ones(3), np.zeros(3))),
            "status": status,
        }
        for status in (stick, np.full(4, int(Status.STICK)))
    ]
    error = [pair.enforcement.error(type(state)(**one), points, penalties, 100.0) for one in both]
    assert error[0] < 1e-6 and error[1] == pytest.approx(
        1.0, rel=1e-3
    )  # the little mass of _INDIFFERENT


def test_multipliers_do_not_pull():
    """[X] Pressures of 1 and 0 at two points of a facet: the best line would pull at its end, by
    (3**.5 - 1) / 2.
    """
    basis = Basis(
        sc.join_bodies({"block": MeshQuad().with_defaults()}), ElementVector(ElementQuad1())
    )
    pair = sc.ContactPair(
        basis,
        "block:bottom",
        sc.rigid.line((-9.0, 0.0), (9.0, 0.0)),
        sc.Coulomb(0.0),
        2,
        penalty=100.0,
        enforcement=sc.AugmentedLagrangian(),
    )
    state = pair.initial_state()
    points = pair.points(state)
    traction = np.stack(
        (np.where(points.positions(pair.slave.nodes)[:, 0] < 0.5, -1.0, 0.0), np.zeros(2))
    )
    given = vars(state) | {
        "traction": traction,
        "multiplier": np.zeros((2, 2)),
        "status": np.ones(2, int),
    }
    moves = np.ones((2, 2), dtype=bool)
    found = type(state)(**given)
    after, _, _ = pair.enforcement._corrected(
        found, np.zeros((2, 2)), points, (100.0, 100.0), 100.0, moves
    )
    np.testing.assert_allclose(
        np.sort(after[0]), [-0.5 * (1 + np.sqrt(3.0)), 0.0], rtol=1e-3, atol=1e-12
    )


def test_strengths_of_mohr_coulomb():
    """[X] c = 10, phi = 30: tension of 17.32; stresses -20, -35, -60 mobilise 20 of 8.66 + 20; s_u
    at 40 is 28.66.
    """
    soil = sc.MohrCoulomb(E=1e4, nu=0.3, c=10.0, phi=30.0)
    stress = np.array([-20.0, -60.0, -35.0, 0.0])[:, None, None]
    used, there = soil.mobilised(stress, np.zeros((0, 1, 1)))
    root = np.sqrt(3.0)
    np.testing.assert_allclose(soil.tensile_strength, 10.0 * root, **EXACT)
    np.testing.assert_allclose([used.item(), there.item()], [20.0, 5.0 * root + 20.0], **EXACT)
    np.testing.assert_allclose(
        soil.undrained_strength(np.full(1, 40.0), np.zeros((0, 1))), 5.0 * root + 20.0, **EXACT
    )
    reduced = soil.reduced(2.0)
    np.testing.assert_allclose(
        [reduced.c, np.tan(np.radians(reduced.phi))], [5.0, 0.5 / root], **EXACT
    )


def test_strengths_of_cones():
    """[X] Drucker-Prager by its definition and in plane strain; von Mises; all reduced."""
    cone, stress = (
        sc.DruckerPrager(1e4, 0.3, k=8.0, alpha=0.2, beta=0.1),
        np.array([-20.0, -60.0, -40.0, 0.0]),
    )
    used, there = cone.mobilised(stress[:, None, None], np.zeros((0, 1, 1)))
    np.testing.assert_allclose([used.item(), there.item()], [20.0, 8.0 + 0.2 * 120.0], **EXACT)
    half = cone.reduced(2.0)
    np.testing.assert_allclose([half.k, half.alpha], [4.0, 0.1], **EXACT)
    plane = sc.DruckerPrager.plane_strain(1e4, 0.3, c=10.0, phi=30.0, psi=30.0)
    np.testing.assert_allclose(
        [plane.k, plane.alpha], [30.0 / np.sqrt(13.0), 1 / np.sqrt(39.0)], **EXACT
    )
    np.testing.assert_allclose(
        sc.VonMises(1e4, 0.3, strength=30.0).reduced(1.5).strength, 20.0, **EXACT
    )


def test_elasticity():
    """[X] E = 10, nu = 0.25: both of Lame's parameters are 4."""
    D = np.full((3, 3), 4.0) + 8.0 * np.eye(3)
    for ncomp in (4, 6):
        found = sc.LinearElastic(10.0, 0.25).elasticity(ncomp)
        np.testing.assert_allclose(found[:3, :3], D, **EXACT)
        np.testing.assert_allclose(found[3:, 3:], 4.0 * np.eye(ncomp - 3), **EXACT)


def test_retention():
    """[X] Ramp in the middle, at a quarter and at its end; van Genuchten with m = 1/2 and alpha s =
    1: S = 1/sqrt 2.
    """
    ramp = sc.water.Ramp(width=0.5, least=0.1)
    k, slope = ramp.relative(np.array([0.0, 0.25, 0.6]), np.full(3, 2.0))
    np.testing.assert_allclose(
        k, [0.55, 0.1 + 0.9 * 0.15625, 0.1], **EXACT
    )  # s**2 (3 - 2 s) at s = 1/2, 1/4, 0
    np.testing.assert_allclose(slope, [-1.35, -0.9 * 6 * 0.1875, 0.0], **EXACT)
    k, _ = sc.water.VanGenuchten(alpha=2.0, n=2.0, least=1e-9).relative(np.array([0.5]), np.ones(1))
    np.testing.assert_allclose(k, [2**-0.25 * (1 - np.sqrt(0.5)) ** 2], rtol=1e-8)


def test_undrained_pressure():
    """[X] The water resists the volume strain of -0.01 with 99; the soil, E = 3 and nu = 0, with
    1.
    """
    clay = sc.Undrained(sc.LinearElastic(E=3.0, nu=0.0), bulk_modulus_water=99.0)
    found = clay.update(
        np.array([[-0.01], [0.0], [0.0], [0.0]]), np.zeros((4, 1)), np.zeros((1, 1))
    )
    np.testing.assert_allclose(found.internal[-1], 0.99, **EXACT)
    np.testing.assert_allclose(found.stress[:, 0], [-1.02, -0.99, -0.99, 0.0], **EXACT)


def test_loads():
    """[X] Weight, seismic share of it and pressure of water on a unit square."""
    basis = Basis(MeshQuad().with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    solid = sc.SolidForm(basis, sc.LinearElastic(1e4, 0.3), unit_weight=20.0)
    model = sc.Model({"square": solid}, basis.get_dofs("bottom").all(), seismic=0.2)
    force = model.weights(model.forms).reshape(-1, 2).sum(axis=0)
    np.testing.assert_allclose(force, [4.0, -20.0], **EXACT)
    pressure = sc.hydrostatic(3.0, unit_weight=10.0)
    np.testing.assert_allclose(pressure(np.array([[0.0, 0.0], [1.0, 4.0]])), [20.0, 0.0], **EXACT)


@pytest.mark.parametrize("water", [None, 2.0])
def test_stresses_at_rest(water):
    """[X] Layers of 20 and 16 kN/m3, a surcharge of 5, K0 = 0.6: at 0.5 and 1.5 m below the
    surface.
    """
    mesh = (
        MeshQuad.init_tensor(np.array([0.0, 1.0]), np.linspace(0, 2, 3))
        .with_defaults()
        .with_subdomains({"lower": lambda x: x[1] < 1, "upper": lambda x: x[1] > 1})
    )
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=1)
    soil = sc.SolidForm(
        basis,
        sc.MohrCoulomb(1e4, 0.3, c=1.0, phi=30.0),
        "b_bar",
        unit_weight={"lower": 20.0, "upper": 16.0},
    )
    model = sc.Model({"soil": soil}, sc.box_supports(basis), water_unit_weight=10.0)
    load = sc.traction(basis, "top", (0.0, -5.0))
    stress = model.k0_state(load, K0=0.6, surcharge=5.0, water=water)[-1].states["soil"].stress
    found = np.sort(stress[:2].mean(axis=2), axis=1)
    vertical = -np.array([5.0 + 16.0 + 10.0, 5.0 + 8.0]) + (
        0.0 if water is None else np.array([15.0, 5.0])
    )
    np.testing.assert_allclose(found, [0.6 * vertical, vertical], rtol=1e-9)


def test_lines_of_the_table_exist() -> None:
    """At least sixty lines of the table in the documentation stand in the package, once each."""
    assert len({(one.file, one.new) for one in mutate.table()}) >= 60
