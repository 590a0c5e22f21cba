"""The tangent is the derivative of the force: at vertices, ends and seams, on rigid obstacles, in
tension.

Random configurations of every combination are in test_contact_tangent_random.py.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import skfem_contact as sc
from skfem_contact.contact.laws import Status
from tests.tools.differences import TOLERANCE, tangent_error
from tests.tools.helpers import (
    ELEMENTS,
    body_along,
    closest,
    facing,
    grid,
    resultant,
    rotation,
    rough_pair,
    slipped,
    unknowns_of,
    vector_basis,
)

LAWS = {
    "frictionless": sc.Coulomb(),
    "slip": sc.Coulomb(0.3, 0.5),
    "stick": sc.Coulomb(50.0),
    "tied": sc.Tied(),
}


def assert_exact(pair, state, x, directions) -> None:
    """The tangent is the derivative of the force along the directions, at most of the points at
    least.
    """
    error, status = tangent_error(pair, state, x, directions)
    assert error < TOLERANCE
    assert 2 * len(status) >= len(state.gap), (
        "many points sit on kinks: choose another configuration"
    )


def statuses(pair, state, x) -> list[int]:
    """Numbers of open, sticking and slipping points."""
    return np.bincount(pair.assemble(x, state).state.status, minlength=3).tolist()


def test_tension_and_half_share(rng):
    """[X] Closed points that pull, below the cut-off; half of the work as in two passes."""
    law = sc.Coulomb(0.3, 2.0, tension=1e3)
    _, pair, x, state = rough_pair("Q2", 3, law, rng, share=0.5)
    state = replace(state, status=np.full_like(state.status, Status.STICK))
    whole = rough_pair("Q2", 3, law, rng)[1]
    x[unknowns_of_slave(pair)] += 0.05 * rng.standard_normal(len(pair.slave.dofs.ravel()))
    out = pair.assemble(x, state)
    assert (out.state.traction[0] > 0).sum() >= 2 and (out.state.traction[0] < 0).sum() >= 2
    assert_exact(pair, state, x, rng.standard_normal((3, len(x))))
    np.testing.assert_allclose(whole.assemble(x, state).force, 2 * out.force, rtol=1e-13)


def unknowns_of_slave(pair) -> np.ndarray:
    return pair.slave.dofs.ravel()


def notch(element: str, quadrature, law, rng):
    """A V-shaped groove; a blunt wedge whose points lie beyond its bottom vertex, inside the
    master.
    """
    groove = np.array([[0.0, 1.0], [1.0, 0.0], [2.0, 1.0]])
    wedge = np.array([[1.6, 0.5], [1.05, -0.07], [0.95, -0.08], [0.4, 0.5]])
    basis = facing(body_along(wedge, element, 0.05), body_along(groove, element, 0.4), element)
    pair = sc.ContactPair(basis, "slave:face", "master:face", law, quadrature, penalty=(1e3, 7e2))
    x = 0.004 * rng.standard_normal(basis.N)
    return basis, pair, x, slipped(pair.initial_state(), 0.02, rng)


@pytest.mark.parametrize("law", ["frictionless", "slip", "stick"])
@pytest.mark.parametrize("quadrature", ["nodal", 5])
@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.one_in(3)
def test_at_a_concave_vertex(element, quadrature, law, rng):
    """[X] Points in the cone where both sides of a vertex shadow each other: the vertex itself is
    closest.
    """
    at_vertex = 0
    for _ in range(3):
        basis, pair, x, state = notch(element, quadrature, LAWS[law], rng)
        where = closest(pair, state, x)
        at_vertex += (where.vertex & (where.gap < 0)).sum()
        assert_exact(pair, state, x, rng.standard_normal((1, len(x))))
        out = pair.assemble(x, state)
        assert np.abs(resultant(basis, x, out.force)).max() < 1e-13 * np.abs(out.force).sum()
    assert at_vertex >= 3


def test_vertex_on_a_stretched_master(rng):
    """[X] Sticking at a vertex of a stretched master: its slip grows with the metric, xi stays."""
    basis, pair, x, state = notch("Q1", "nodal", LAWS["stick"], rng)
    state = replace(state, stick_point=state.stick_point - 0.4)
    x = x + 0.1 * (basis.doflocs * (np.arange(basis.N) % 2 == [[0], [1]])).sum(axis=0)
    assert (closest(pair, state, x).vertex & (closest(pair, state, x).gap < 0)).any()
    assert_exact(pair, state, x, rng.standard_normal((10, len(x))))


@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.parametrize("law", ["slip", "stick"])
@pytest.mark.one_in(2)
def test_beyond_the_ends_of_a_chain(element, law, rng):
    """[X] An open chain goes on a little beyond its ends, and points there are in contact."""
    line = np.stack((np.linspace(0, 2, 4), np.zeros(4)), axis=1)
    roof = np.stack((np.linspace(2.015, -0.015, 4), np.full(4, -0.03)), axis=1)
    basis = facing(body_along(roof, element, 0.6), body_along(line, element, 0.6), element)
    pair = sc.ContactPair(
        basis, "slave:face", "master:face", LAWS[law], quadrature="nodal", penalty=(1e3, 7e2)
    )
    state = slipped(pair.initial_state(), 0.05, rng)
    x = 0.001 * rng.standard_normal(basis.N)
    where = closest(pair, state, x)
    beyond = (np.abs(where.xi[:, 0]) > 1.0 + 1e-3) & (where.gap < 0)
    assert beyond.sum() == 2 and not where.vertex.any()
    assert_exact(pair, state, x, rng.standard_normal((8, len(x))))


def ring(n: int, radius: float, turn: float, outward: bool) -> np.ndarray:
    """Corners of a polygon; the left of the way around is outside (clockwise) or inside."""
    angle = np.radians(turn) + np.arange(n) * 2 * np.pi / n * (-1 if outward else 1)
    return radius * np.stack((np.cos(angle), np.sin(angle)), axis=1)


@pytest.mark.parametrize("pin_is_slave", [True, False])
@pytest.mark.parametrize("quadrature", ["nodal", 3, "segments"])
@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.one_in(3)
def test_closed_chains(element, quadrature, pin_is_slave, rng):
    """[X] A pin in a hole of the same size: concave and convex closed masters, the seam
    included.
    """
    pin = body_along(ring(9, 1.0, 7.0, outward=True), element, 0.4, closed=True)
    hole = body_along(ring(10, 1.0, 0.0, outward=False), element, 0.4, closed=True)
    bodies = (pin, hole) if pin_is_slave else (hole, pin)
    basis = facing(*bodies, element)
    for law in LAWS.values():
        pair = sc.ContactPair(
            basis, "slave:face", "master:face", law, quadrature, penalty=(1e3, 7e2)
        )
        assert pair.master.closed and pair.slave.closed
        x = 0.01 * rng.standard_normal(basis.N)
        dofs = unknowns_of(basis, "slave")
        places = basis.doflocs[:, dofs[:, 0]].T
        x[dofs] += places @ (rotation(3.0).T - np.eye(2)) + [0.09, 0.03]
        state = slipped(pair.initial_state(), 0.05, rng)
        closed = sum(statuses(pair, state, x)[1:])
        assert closed >= 2
        assert_exact(pair, state, x, rng.standard_normal((1, len(x))))
        out = pair.assemble(x, state)
        assert np.abs(resultant(basis, x, out.force)).max() < 1e-13 * np.abs(out.force).sum()


@pytest.mark.parametrize("obstacle", ["line", "circle", "hole", "polyline"])
@pytest.mark.parametrize("quadrature", ["nodal", 3])
@pytest.mark.one_in(2)
def test_rigid_obstacles(obstacle, quadrature, rng):
    """[X] Surfaces without unknowns: the slave's share of force and tangent is left."""
    roof = np.stack(
        (np.linspace(1.2, -1.2, 6), -0.05 + 0.1 * np.linspace(1.2, -1.2, 6) ** 2), axis=1
    )
    if obstacle == "circle":
        roof[:, 1] = -0.1 * np.linspace(1.2, -1.2, 6) ** 2 - 0.05
    basis = vector_basis(body_along(roof, "Q2", 0.4), "Q2")
    master = {
        "line": lambda: sc.rigid.line((-2.0, 0.0), (2.0, 0.0)),
        "circle": lambda: sc.rigid.circle((0.0, -5.0), 5.0),
        "hole": lambda: sc.rigid.circle((0.0, 5.0), 5.0, hole=True),
        "polyline": lambda: sc.rigid.polyline([(-2.0, 0.3), (0.1, -0.1), (2.0, 0.4)]),
    }[obstacle]()
    for law in (LAWS["frictionless"], LAWS["slip"], LAWS["stick"]):
        pair = sc.ContactPair(basis, "face", master, law, quadrature, penalty=(1e3, 7e2))
        state = slipped(pair.initial_state(), 0.05, rng)
        x = 0.01 * rng.standard_normal(basis.N)
        assert sum(statuses(pair, state, x)[1:]) >= 2
        assert_exact(pair, state, x, rng.standard_normal((3, len(x))))


@pytest.mark.slow
def test_all_entries_of_one_tangent(rng):
    """[X] Every unknown on its own."""
    for element, quadrature in (("Q1", "nodal"), ("Q2", 2)):
        basis, pair, x, state = rough_pair(element, quadrature, sc.Coulomb(0.3), rng)
        moving = pair.assemble(x, state).stiffness.toarray().any(axis=0)
        assert_exact(pair, state, x, np.eye(basis.N)[moving])


def test_primary_tangent_is_exact_for_a_flat_master_at_rest(rng):
    """[X] Equations 20 to 22 lack what vanishes with gap and slip: nothing is missing at first
    touch.
    """
    line = np.stack((np.linspace(0, 3, 6), np.zeros(6)), axis=1)
    roof = np.stack((np.linspace(2.5, 0.5, 4), np.zeros(4)), axis=1)
    basis = facing(body_along(roof), body_along(line))
    K = [
        sc.ContactPair(
            basis,
            "slave:face",
            "master:face",
            sc.Coulomb(0.3),
            quadrature="nodal",
            penalty=1e3,
            tangent=t,
        )
        .assemble(
            basis.zeros(),
            sc.ContactPair(
                basis, "slave:face", "master:face", sc.Coulomb(0.3), "nodal"
            ).initial_state(),
        )
        .stiffness
        for t in ("exact", "primary")
    ]
    assert abs(K[0] - K[1]).max() < 1e-12 * abs(K[0]).max()
    _, exact, x, state = rough_pair("Q1", "nodal", sc.Coulomb(0.3), rng)
    rng_again = np.random.default_rng(20240229)
    primary = rough_pair("Q1", "nodal", sc.Coulomb(0.3), rng_again, tangent="primary")[1]
    a, b = exact.assemble(x, state), primary.assemble(x, state)
    assert np.array_equal(a.force, b.force)
    assert abs(a.stiffness - b.stiffness).max() > 1e-3 * abs(a.stiffness).max()


def test_damped_tangent_is_the_exact_one_while_the_bodies_bear_the_tractions(rng):
    """[X] Soft bodies cannot bear them: the primary part is left, to the 1e-9 of their stiffness
    over the penalty.

    It is not left alone at once: without its geometric part a frictionless pin in a hole is free to
    turn.
    """
    _, pair, x, state = rough_pair("P1", 2, sc.Coulomb(100.0), rng)
    _, primary, _, _ = rough_pair("P1", 2, sc.Coulomb(100.0), rng, tangent="primary")
    stiff, soft = (
        pair.with_penalty(*pair.penalty, stiffness=s * pair.penalty[0]).assemble(x, state)
        for s in (1e6, 1e-9)
    )
    exact, least = stiff.stiffness, primary.assemble(x, state).stiffness
    assert abs(stiff.damped - exact).max() == 0.0
    assert (
        abs(soft.damped - least).max() < 1e-8 * abs(least).max() < 1e-2 * abs(exact - least).max()
    )


def test_slip_that_a_pair_keeps_acts_as_slip_of_the_bodies() -> None:
    """[X] A block that has moved sideways, and one whose pair is shifted by this slip."""
    bodies = {
        "base": grid("Q1", np.linspace(0, 3, 4), [-1.0, 0.0]),
        "block": grid("Q1", np.linspace(1, 2, 3), [0.0, 1.0]),
    }
    basis = vector_basis(sc.join_bodies(bodies), "Q1", intorder=2)
    pair = sc.ContactPair(basis, "block:bottom", "base:top", sc.Coulomb(10.0), penalty=(1e4, 1e4))
    lowered = basis.zeros()
    lowered[basis.get_dofs(elements="block").all("u^2")] = -1e-3
    state = pair.assemble(lowered, pair.initial_state()).state
    moved = lowered.copy()
    moved[basis.get_dofs(elements="block").all("u^1")] = 2e-3
    expected = pair.assemble(moved, state)
    slip = expected.state.slip - state.slip
    assert np.abs(slip).max() > 1e-3
    found = pair.with_(slip_shift=slip).assemble(lowered, state)
    traction = expected.state.traction
    np.testing.assert_allclose(found.state.traction, traction, atol=1e-9 * np.abs(traction).max())
