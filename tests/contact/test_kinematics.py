"""Residual and tangent of single contact points, objectivity, and balance of forces and moments."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import MeshTri

import skfem_contact as sc
from skfem_contact.contact.laws import Status
from tests.oracles.nts_reference import CASES, PRINTED, X0, residual, tangent
from tests.tools.helpers import (
    ELEMENTS,
    body_along,
    closest,
    dofs_at,
    facing,
    moved_rigidly,
    resultant,
    rotation,
    rough_pair,
    sticking_at,
    unknowns_of,
)

STATUS = {"frictionless": Status.SLIP, "stick": Status.STICK, "slip": Status.SLIP}


def single_point(case: str, shift: np.ndarray | None = None):
    """A pair whose only contact is that of the oracle's node and segment, in two triangles.

    Parameters
    ----------
    case
        Key of the oracle's cases.
    shift
        Displacements (6,) at which the oracle's coordinates are reached; zero by default.

    Returns
    -------
    tuple
        Basis, pair, accepted state, displacements, the six unknowns in the oracle's order, the
        weight.
    """
    reference = X0 - (np.zeros(6) if shift is None else shift)
    slave, x2, x1 = reference.reshape(3, 2)
    # the slave's face runs from the node to a point far above, out of reach; both bodies lie to its
    # right
    upper = MeshTri(
        (slave + np.array([[0.0, 0.0], [0.2, 3.0], [1.0, 2.0]])).T, np.array([[0, 1, 2]]).T
    )
    lower = MeshTri(np.array([x2, x1, 0.5 * (x1 + x2) + [0.0, -1.0]]).T, np.array([[0, 1, 2]]).T)
    bodies = []
    for mesh in (upper, lower):
        face = np.flatnonzero((np.sort(mesh.facets, axis=0) == [[0], [1]]).all(axis=0))
        bodies.append(mesh.with_boundaries({"face": face}))
    basis = facing(*bodies, element="P1")
    arguments = CASES[case]
    eps_t = arguments.get("eps_t", 1.0)
    pair = sc.ContactPair(
        basis,
        "slave:face",
        "master:face",
        sc.Coulomb(arguments.get("mu", 0.0)),
        quadrature="nodal",
        penalty=(arguments["eps_n"], eps_t),
    )
    dofs = np.concatenate(
        [
            dofs_at(basis, body, place)
            for body, place in (("slave", slave), ("master", x2), ("master", x1))
        ]
    )
    x = basis.zeros()
    x[dofs] = X0 - reference
    # the traction of the last step as a stick point: T_n = -eps_T (xi_n - xi_c)
    xi_c = arguments.get("xi_n", 0.0) + arguments.get("traction", 0.0) / eps_t
    state = pair.initial_state()
    stick = 0.5 * (1 + xi_c) * np.linalg.norm(x1 - x2)
    state = sticking_at(pair, state, np.full(len(state.gap), stick))
    weight = 0.5 * np.linalg.norm([0.2, 3.0])  # half of the face belongs to the node
    return basis, pair, state, x, dofs, weight


@pytest.mark.parametrize(
    "shift", [None, (0.4, -0.2, 0.4, -0.2, 0.4, -0.2), (0.05, 0.3, -0.1, 0.02, -0.1, 0.02)]
)
@pytest.mark.parametrize("case", CASES)
def test_residual_of_one_node(case, shift):
    """[X] Case A3; also reached by displacements that move the segment without stretching it."""
    _, pair, state, x, dofs, weight = single_point(case, None if shift is None else np.array(shift))
    out = pair.assemble(x, state)
    expected = residual(X0, **CASES[case])[0]
    np.testing.assert_allclose(expected, [float(v) for v in PRINTED[case].split()], rtol=1e-10)
    np.testing.assert_allclose(
        out.force[dofs] / weight, expected, rtol=0, atol=1e-10 * np.abs(expected).max()
    )
    assert np.abs(np.delete(out.force, dofs)).max() == 0
    closed = out.state.status != Status.OPEN
    assert closed.sum() == 1 and out.state.status[closed][0] == STATUS[case]
    # |T1| |rho_1| = eps_T s
    contravariant = residual(X0, **CASES[case])[2]
    length = 0.5 * np.linalg.norm(X0[4:] - X0[2:4])
    assert abs(out.state.traction[1][closed][0]) == pytest.approx(
        abs(contravariant) * length, rel=1e-10
    )


@pytest.mark.parametrize("shift", [None, (0.05, 0.3, -0.1, 0.02, -0.1, 0.02)])
@pytest.mark.parametrize("case", CASES)
def test_tangent_of_one_node(case, shift):
    """[X] Case A4: all 36 entries against complex steps through the oracle."""
    basis, pair, state, x, dofs, weight = single_point(
        case, None if shift is None else np.array(shift)
    )
    K = pair.assemble(x, state).stiffness.toarray()
    expected = tangent(X0, **CASES[case])
    np.testing.assert_allclose(
        K[np.ix_(dofs, dofs)] / weight, expected, atol=1e-10 * np.abs(expected).max()
    )
    rest = np.setdiff1d(np.arange(basis.N), dofs)
    assert not K[rest].any() and not K[:, rest].any()
    asymmetry = np.abs(K - K.T).max() / np.abs(K).max()
    if case == "frictionless":
        assert asymmetry < 1e-12
    if case == "slip":
        assert asymmetry == pytest.approx(0.2935, abs=5e-5)


def test_printed_entries_of_the_tangent():
    """[X] Case A4: the entries printed there, so that the oracle itself is pinned."""
    for case, (i, j), value in (
        ("frictionless", (0, 0), 220.04889976),
        ("frictionless", (1, 1), 9779.9511002),
        ("frictionless", (4, 4), -8.5912217542),
        ("stick", (0, 0), 709.04645477),
        ("slip", (0, 1), -1466.9926650),
    ):
        assert tangent(X0, **CASES[case])[i, j] == pytest.approx(value, rel=1e-10)


def test_friction_on_a_stretched_segment():
    """[X] The slip of a material length, s = (l / l_ref) (S - S_c), on a segment that was
    stretched.
    """
    stretch = np.array([0.0, 0.0, 0.05, -0.02, -0.1, 0.04])  # x2 and x1 move apart or together
    _, pair, state, x, dofs, weight = single_point("stick", stretch)
    out = pair.assemble(x, state)
    # the stick point is the same share xi of the segment: the oracle needs its xi_n only
    expected = residual(X0, **CASES["stick"])[0]
    np.testing.assert_allclose(
        out.force[dofs] / weight, expected, atol=1e-10 * np.abs(expected).max()
    )
    K = tangent(X0, **CASES["stick"])
    ours = out.stiffness.toarray()[np.ix_(dofs, dofs)] / weight
    np.testing.assert_allclose(ours, K, atol=1e-10 * np.abs(K).max())


@pytest.mark.parametrize("case", CASES)
def test_tangent_knows_rigid_motion(case):
    """[X] Case A4: no force from a translation; a rotation turns the force."""
    basis, pair, state, x, *_ = single_point(case)
    out = pair.assemble(x, state)
    K, scale = out.stiffness, abs(out.stiffness).max()
    places = basis.doflocs[:, ::2].T + x.reshape(-1, 2)
    quarter = np.array([[0, -1], [1, 0]])
    for c in range(2):
        assert np.abs(K @ np.eye(2)[np.arange(basis.N) % 2][:, c]).max() < 1e-12 * scale
    turned = (out.force.reshape(-1, 2) @ quarter.T).ravel()
    np.testing.assert_allclose(K @ (places @ quarter.T).ravel(), turned, atol=1e-11 * scale)


QUADRATURES = ["nodal", 2, 3, "segments"]


@pytest.mark.parametrize("mu", [0.0, 0.3, 50.0])
@pytest.mark.parametrize("quadrature", QUADRATURES)
@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.one_in(3)
def test_action_is_reaction(element, quadrature, mu, rng):
    """[X] Forces and moments of both bodies cancel to round-off, in the current configuration."""
    for _ in range(2):
        basis, pair, x, state = rough_pair(element, quadrature, sc.Coulomb(mu), rng)
        out = pair.assemble(x, state)
        assert (out.state.status != Status.OPEN).sum() >= 2
        scale = np.abs(out.force).sum()
        assert np.abs(resultant(basis, x, out.force)).max() < 1e-14 * scale * 10
        on_slave = np.zeros_like(out.force)
        dofs = unknowns_of(basis, "slave").ravel()
        on_slave[dofs] = out.force[dofs]
        if quadrature == "segments":  # its candidate state holds at other points
            continue
        # and it is the sum of the tractions at the points: pushed back out of the master
        points, s = pair.points(state), out.state
        where = closest(pair, state, x)
        rho1 = pair.master.at(where.facet, where.xi, pair.master.positions(x)).x[1][:, 0]
        tau = rho1 / np.linalg.norm(rho1, axis=1)[:, None]
        n = np.stack((-tau[:, 1], tau[:, 0]), axis=1)
        if not where.vertex.any():
            total = (
                points.weight[:, None] * (s.traction[0, :, None] * n + s.traction[1, :, None] * tau)
            ).sum(axis=0)
            if element in (
                "P1",
                "Q1",
            ):  # on curved masters l Xi is longer than tau by 1 / (1 - g h / l^2)
                np.testing.assert_allclose(
                    resultant(basis, x, on_slave)[:2], total, atol=1e-12 * scale
                )


@pytest.mark.parametrize("degrees", [0.0, 1e-3, 37.0, 90.0, 135.0, 180.0, 271.0, 360.0])
@pytest.mark.parametrize("quadrature", QUADRATURES)
@pytest.mark.parametrize("element", ["P1", "Q2"])
def test_objectivity(element, quadrature, degrees, rng):
    """[X] Case A5: everything is turned and shifted: forces turn, gap and slip and tractions
    stay.
    """
    basis, pair, x, state = rough_pair(element, quadrature, sc.Coulomb(0.3), rng)
    there = moved_rigidly(basis, degrees, (5.0, -3.0), x)
    out, turned = pair.assemble(x, state), pair.assemble(there, state)
    expected = (out.force.reshape(-1, 2) @ rotation(degrees).T).ravel()
    # coordinates of size 5 lose a digit
    np.testing.assert_allclose(turned.force, expected, atol=1e-11 * np.abs(expected).max())
    for name in ("gap", "slip", "traction", "stick_point", "position"):
        old, new = getattr(out.state, name), getattr(turned.state, name)
        np.testing.assert_allclose(
            new, old, atol=1e-12 * max(1.0, np.nanmax(np.abs(old[np.isfinite(old)])))
        )
    assert np.array_equal(out.state.status, turned.state.status)
    blocks = np.kron(np.eye(basis.N // 2), rotation(degrees))
    K = blocks @ out.stiffness.toarray() @ blocks.T
    np.testing.assert_allclose(turned.stiffness.toarray(), K, atol=1e-11 * np.abs(K).max())


def test_stress_free_turn_in_steps():
    """[X] Case S19: two bodies that touch turn by 90 degrees in steps and feel nothing."""
    line = np.stack((np.linspace(0, 3, 6), np.zeros(6)), axis=1)
    roof = np.stack((np.linspace(2.5, 0.5, 4), np.zeros(4)), axis=1)
    basis = facing(body_along(roof), body_along(line))
    pair = sc.ContactPair(
        basis, "slave:face", "master:face", sc.Coulomb(0.3), quadrature="nodal", penalty=1e4
    )
    state = pair.initial_state()
    for step in range(1, 91):
        out = pair.assemble(moved_rigidly(basis, float(step), (0.1 * step, 0.0)), state)
        state = out.state
        # round-off of coordinates of size 10 times the penalty
        assert np.abs(out.force).max() < 1e-9
        assert (state.status != Status.OPEN).all()
    assert np.abs(state.slip[0]).max() < 1e-12


@pytest.mark.parametrize("quadrature", QUADRATURES)
def test_same_bits_twice(quadrature, rng):
    """[X] Case S24: determinism, and assembling changes neither displacements nor state."""
    _, pair, x, state = rough_pair("Q1", quadrature, sc.Coulomb(0.3), rng)
    before = {name: value.copy() for name, value in vars(state).items()}, x.copy()
    a, b = pair.assemble(x, state), pair.assemble(x, state)
    assert np.array_equal(a.force, b.force) and np.array_equal(
        a.stiffness.toarray(), b.stiffness.toarray()
    )
    for name, value in vars(state).items():
        assert np.array_equal(value, before[0][name], equal_nan=True), name
        assert np.array_equal(getattr(a.state, name), getattr(b.state, name), equal_nan=True), name
    assert np.array_equal(x, before[1])


def test_frictionless_force_is_the_gradient_of_an_energy(rng):
    """[X] The contact energy sum w eps g^2 / 2 from gaps alone, differentiated numerically."""
    basis, pair, x, state = rough_pair("P2", 3, sc.Coulomb(), rng)

    def energy(y):
        gap = np.minimum(pair.assemble(y, state).state.gap, 0.0)
        return float((pair.points(state).weight * 1e3 * gap**2 / 2).sum())

    force, h = pair.assemble(x, state).force, 1e-6
    for direction in rng.standard_normal((5, basis.N)):
        numeric = (energy(x + h * direction) - energy(x - h * direction)) / (2 * h)
        # energies of order one differ by 1e-6: ten digits are left, and h^2 of the third derivative
        assert numeric == pytest.approx(force @ direction, abs=1e-8 * np.abs(force).max())
