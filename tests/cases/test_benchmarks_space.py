"""The benchmarks of contact in space at small sizes, and the closed forms that they are set
against.
"""

from __future__ import annotations

import half_space
import numpy as np
import peers_space
import pytest
from round_blocks import MODULUS, SHEAR_MODULUS, Block, drawn, growing, quarter_disc, whole
from space_problems import (
    FLAT_RADIUS,
    MASTER,
    POISSON,
    SLAVE,
    YOUNG,
    Nodes,
    paraboloid,
    sheared_paraboloid,
)
from space_problems import MODULUS as BOTH

import skfem_contact as sc

MU = 0.4

# -- closed forms


def test_hertz_ellipse_of_a_ball_is_round():
    """[X] Nearly equal curvatures: the formulas of the ball."""
    a, peak = half_space.hertz(40.0, 20.0, BOTH)
    found = half_space.hertz_ellipse(40.0, 0.025 * (1 - 1e-6), 0.025 * (1 + 1e-6), BOTH)
    assert found == pytest.approx((a, a, peak, a**2 / 20.0), rel=1e-5)


def test_numbers_of_the_ellipse():
    """[X] Cylinders of radius 20 that cross at 45 degrees, both elastic: digits of an independent
    evaluation.
    """
    turn = np.radians(22.5)
    found = half_space.hertz_ellipse(40.0, np.sin(turn) ** 2 / 20, np.cos(turn) ** 2 / 20, BOTH)
    assert found == pytest.approx((1.98382, 0.621805, 15.4827, 0.0453182), rel=3e-6)


def test_loss_is_the_area_of_the_loop():
    """[X] Mindlin's way back is the way there, doubled; its chords enclose the energy."""
    friction, largest, compliance = 1.6, 1.44, 4 * (2 - POISSON) * (1 + POISSON) / YOUNG

    def at(shear: float) -> float:
        return half_space.Mindlin(friction, shear, 1.0, compliance).shift

    fallen = largest * (
        1 - np.cos(np.linspace(0, np.pi, 2001))
    )  # from the largest force to its opposite
    back = np.array([at(largest) - 2 * at(part / 2) for part in fallen])
    shear = largest - fallen
    half = np.trapezoid(shear, back)
    # the other branch is this one turned about the origin
    assert abs(2 * half) == pytest.approx(
        half_space.Mindlin(friction, largest, 1.0, compliance).loss, rel=1e-5
    )


def test_torque_of_full_slip():
    """[X] Lubkin: 3 pi / 16 where nothing sticks, 16/3 G a^3 twist where everything does."""
    assert half_space.lubkin_torque(1e-4, 1.0, 1.0) == pytest.approx(3 * np.pi / 16, rel=1e-6)
    bonded = 16 / 3 * half_space.lubkin_twist(0.999, 1.0, 1.0, 1.0)
    assert half_space.lubkin_torque(0.999, 1.0, 1.0) == pytest.approx(bonded, rel=0.01)


def test_far_field_is_in_equilibrium():
    """[X] Boussinesq: no body force inside (differences), and P (1 - nu^2) / (pi E r) on the
    surface.
    """
    place, h = np.array([0.7, -0.4, -0.9]), 1e-3
    shifts = h * np.array([(i, j, k) for i in (-1, 0, 1) for j in (-1, 0, 1) for k in (-1, 0, 1)])
    u = half_space.far_field((place + shifts).T, 1.0, YOUNG, POISSON).reshape(3, 3, 3, 3)
    second = np.empty((3, 3, 3))  # of the component c, along the axes a and b
    for a in range(3):
        for b in range(3):
            second[:, a, b] = (
                np.gradient(np.gradient(u, h, axis=a + 1), h, axis=b + 1)[:, 1, 1, 1]
                if a != b
                else np.diff(u, 2, axis=a + 1).take(0, axis=a + 1)[:, 1, 1] / h**2
            )
    grad_div = np.einsum("cca->a", second)
    laplacian = np.einsum("caa->c", second)
    # of (1 - 2 nu) laplacian u + grad div u = 0; error of the differences h^2
    assert np.abs((1 - 2 * POISSON) * laplacian + grad_div).max() < 1e-4 * np.abs(second).max()
    surface = half_space.far_field(np.array([[2.0], [0.0], [0.0]]), 1.0, YOUNG, POISSON)
    assert surface[2, 0] == pytest.approx(-(1 - POISSON**2) / (2 * np.pi * YOUNG), rel=1e-12)


# -- partial slip


@pytest.mark.slow
def test_partial_slip():
    """[X] Radius of the zone that sticks and force to and fro, with four elements in the radius."""
    problem = sheared_paraboloid(4)
    a, _ = half_space.hertz(4.0, FLAT_RADIUS, BOTH)
    compliance = 4 * (2 - POISSON) * (1 + POISSON) / YOUNG
    shift = half_space.Mindlin(MU * 4.0, 0.75 * MU * 4.0, a, compliance).shift
    pair = sc.ContactPair(
        problem.basis, SLAVE, MASTER, sc.Coulomb(mu=MU), 2, penalty=(20 * YOUNG, 10 * YOUNG)
    )
    stages = [
        sc.Stage(name, problem.basis.zeros(), problem.pressed + x * problem.shifted, increments)
        for name, x, increments in (("press", 0.0, 2), ("there", shift, 2), ("back", -shift, 4))
    ]
    with pytest.warns(sc.AnalysisWarning, match="penalty compliance"):
        result = sc.Model({"bodies": problem.solid, "joint": pair}, problem.fixed).run(
            stages, progress=False
        )
    joint, force = (
        result["there"].tractions("joint"),
        2 * Nodes.of(problem, result["there"].x).force.sum(axis=0),
    )
    a, _ = half_space.hertz(force[2], FLAT_RADIUS, BOTH)
    mindlin = half_space.Mindlin(MU * force[2], -force[0], a, compliance)
    left = joint.weight * (MU * joint.raw_pressure - np.linalg.norm(joint.raw_shear, axis=1))
    stuck = np.sqrt(2.5 * left @ (joint.x**2 + joint.y**2) / left.sum())
    assert mindlin.shear / mindlin.friction == pytest.approx(
        0.75, abs=0.03
    )  # blocks of ten times the contact
    assert stuck == pytest.approx(mindlin.stick_radius, rel=0.05)  # a fifth of an element
    back = 2 * Nodes.of(problem, result["back"].x).force[:, 0].sum()
    assert back == pytest.approx(-force[0], rel=0.01)  # the way back doubles the way there


# -- rigid indenters


def pressed(block, master, depth, force):
    """Nodes under a rigid body, with their forces."""
    pair = block.contact(master, quadrature="nodal", enforcement=sc.AugmentedLagrangian())
    stage = sc.Stage("press", block.basis.zeros(), block.moved(depth, force), increments=2)
    forms = {"block": block.solid, "joint": pair}
    return block.touched(sc.Model(forms, block.fixed).run([stage], progress=False)[-1].x)


def test_flat_punch():
    """[X] Force, and the pressure at half the radius; the rim is too strong by what its elements
    are.
    """
    away = growing(0.02, 1.7, 9.0)
    inside = away[away < 0.36] / 0.4
    section = quarter_disc(3, np.append(0.0, 1 - inside[:0:-1]), 1 + away)
    block = Block.of(drawn(section, away), near=lambda p: np.hypot(*p[:2]) < 1.0)
    force, _, _ = half_space.flat_punch(np.ones(1), 0.01, 1.0, MODULUS)
    found = pressed(block, sc.rigid.plane((0, 0, 0), (0, 0, -1), 4.0), 0.01, force)
    assert found.normal.sum() == pytest.approx(force, rel=0.07)  # measured 5.9 %
    near = found.circle(0.45)
    _, exact, _ = half_space.flat_punch(found.r[near], 0.01, 1.0, MODULUS)
    assert found.pressure[near].mean() == pytest.approx(exact.mean(), rel=0.02)  # measured 0.9 %


def round_block(n: int, turned: bool = False) -> Block:
    """A block whose contact has n elements in the radius 1."""
    fine = np.arange(round(0.3 * n) + 1) / n
    away = growing(2 / n, 2.0, 8.5)[1:]
    share = np.arange(round(0.4 * n)) / round(0.4 * n)
    section = quarter_disc(n // 2, share, 1 + np.append(fine, fine[-1] + away))
    return Block.of(
        drawn(whole(section) if turned else section, np.append(2 * fine, 2 * fine[-1] + away)),
        near=lambda p: np.hypot(*p[:2]) < 1.35,
    )


def test_cone():
    """[X] Force and radius of the contact."""
    force, depth, _ = half_space.cone(np.ones(1), 1.0, 0.02, MODULUS)
    found = pressed(
        round_block(6), sc.rigid.cone((0, 0, 0), (0, 0, 1), 0.02, radius=2.0), depth, force
    )
    assert found.normal.sum() == pytest.approx(force, rel=0.05)  # measured 3.6 %
    assert np.sqrt(3 * found.normal @ found.r**2 / found.normal.sum()) == pytest.approx(
        1.0, rel=0.03
    )


@pytest.mark.slow
def test_torsion_with_slip():
    """[X] Lubkin's torque where half of the radius sticks; friction comes after the pressing."""
    block, radius, mu = round_block(6, turned=True), 100.0, 0.3
    force = 4 / 3 * MODULUS / radius
    twist = half_space.lubkin_twist(0.5, mu * force, 1.0, SHEAR_MODULUS)
    pair = block.contact(sc.rigid.sphere((0, 0, radius), radius), quadrature=2, penalty=20e3)
    stages = [
        sc.Stage("press", block.basis.zeros(), block.moved(1 / radius, force)),
        sc.Stage(
            "turn",
            block.basis.zeros(),
            block.moved(1 / radius, force, twist),
            2,
            change={"ball": pair.with_law(sc.Coulomb(mu=mu))},
        ),
    ]
    with pytest.warns(sc.AnalysisWarning, match="penalty compliance"):
        result = sc.Model({"block": block.solid, "ball": pair}, block.fixed).run(
            stages, progress=False
        )
    found = block.touched(result["turn"].x)
    assert abs(block.touched(result["press"].x).torque) < 1e-6 * mu * force
    assert -found.torque == pytest.approx(half_space.lubkin_torque(0.5, mu * force, 1.0), rel=0.04)


# -- peers


def test_faces_of_the_bricks_lie_on_the_boundary():
    """[X] Each face of CalculiX's deck is a facet of the boundary."""
    problem = paraboloid(2)
    mesh = problem.basis.mesh
    for boundary in (SLAVE, MASTER):
        facets = {
            tuple(sorted(nodes)) for nodes in mesh.facets[:, mesh.boundaries[boundary]].T.tolist()
        }
        faces = [line.split(",S") for line in peers_space._faces(problem, boundary)]
        nodes = [
            peers_space._bricks(problem)[int(e) - 1, list(peers_space.FACES[int(s) - 1])]
            for e, s in faces
        ]
        assert {tuple(sorted(own.tolist())) for own in nodes} == facets
