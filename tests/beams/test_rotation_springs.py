"""Springs that resist rotations: joints of segments, connections of members, elastic clamps."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from scipy.optimize import brentq

import skfem_contact as sc

EI, STIFF = 100.0, {"EI": 100.0, "EA": 1e7, "GA": 1e5}
QUIET = {"progress": False}


def way(*corners, n=4):
    """Nodes of a polyline with n elements on each part."""
    parts = [np.linspace(a, b, n + 1)[:-1] for a, b in pairwise(corners)]
    return np.vstack([*parts, [corners[-1]]])


def mast(k, sign=1.0, **more):
    """Model of a mast of length 4 on an elastic foot, whose line goes up or down."""
    line = way((0, 0), (0, 4))[:: int(sign)]
    beam = sc.Beam(None, line, **STIFF, **more)
    foot = sc.RotationSpring(beam, (0, 0), k, to="ground")
    return sc.Model({"mast": beam, "foot": foot}, beam.dofs((0, 0), ["u^1", "u^2"]))


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_elastic_foot(sign):
    """[X] The tip moves by F L^3 / 3 EI + F L^2 / k; the spring has the moment of the beam."""
    model = mast(50.0, sign)
    push = model.forms["mast"].load((3.0, 0.0), (0, 4))
    stage = model.run([sc.Stage("push", push)], **QUIET)["push"]
    moved = stage.x[model.forms["mast"].numbers((0, 4))[0]]
    exact = 3.0 * (64 / 3 / EI + 16 / 50.0 + 4 / 1e5)
    assert moved == pytest.approx(exact, rel=1e-9)
    table = stage.table("foot")
    forces = stage.section_forces("mast")
    at_foot = forces.M[np.argmin(forces.y)]
    assert table["moment"][0] == pytest.approx(at_foot, rel=1e-9)
    assert abs(table["rotation"][0]) == pytest.approx(12.0 / 50.0, rel=1e-9)


@pytest.mark.parametrize("spacing", [1.0, 2.5])
@pytest.mark.parametrize("kinematics", ["small", "finite"])
def test_joint_in_a_beam(spacing, kinematics):
    """[X] A beam on two supports bends by P L^3 / 48 EI + P L^2 / 16 k + P L / 4 GA, in a row too;
    with finite kinematics under a small load.
    """
    L, k, P = 6.0, 80.0, 1e-4
    beam = sc.Beam(
        None, way((0, 0), (3, 0), (6, 0)), EI=EI, EA=1e5, GA=1e4, hinges=(3, 0),
        spacing=spacing, kinematics=kinematics,
    )  # fmt: skip
    joint = sc.RotationSpring(beam, (3, 0), k)
    fixed = [*beam.dofs((0, 0), ["u^1", "u^2"]), *beam.dofs((6, 0), ["u^2"])]
    model = sc.Model({"beam": beam, "joint": joint}, fixed)
    form = model.forms["beam"]
    load = form.load((0.0, -P / spacing), (3, 0))
    stage = model.run([sc.Stage("load", load)], **QUIET)["load"]
    exact = P * (L**3 / 48 / EI + L**2 / 16 / k + L / 4 / 1e4)
    assert -stage.x[form.numbers((3, 0))[1]] == pytest.approx(exact, rel=1e-7)
    forces = stage.section_forces("beam")
    largest = np.abs(forces.M).max() * spacing
    assert abs(stage.table("joint")["moment"][0]) == pytest.approx(largest, rel=1e-7)
    assert largest == pytest.approx(P * L / 4, rel=1e-7)


def test_connection_of_two_beams():
    """[X] A cantilever on a semi-rigid connection to a clamped column: the tip of the arm moves by
    the turns of the column's head and of the connection, and by its own bending.
    """
    h, a, k, F = 3.0, 2.0, 40.0, 1.5
    column = sc.Beam(None, way((0, 0), (0, h)), **STIFF)
    arm = sc.Beam(None, way((0, h), (a, h)), **STIFF, joined_to=column, hinges=(0, h))
    forms = {
        "column": column,
        "arm": arm,
        "connection": sc.RotationSpring(arm, (0, h), k, to=column),
    }
    model = sc.Model(forms, column.dofs((0, 0)))
    tip = model.forms["arm"].load((0.0, -F), (a, h))
    stage = model.run([sc.Stage("load", tip)], **QUIET)["load"]
    moved = -stage.x[model.forms["arm"].numbers((a, h))[1]]
    exact = F * a * (h * a / EI + a / k) + F * a**3 / 3 / EI + F * (a / 1e5 + h / 1e7)
    assert moved == pytest.approx(exact, rel=1e-8)
    assert abs(stage.table("connection")["moment"][0]) == pytest.approx(F * a, rel=1e-9)


def test_buckling_on_an_elastic_foot():
    """[X] A free-standing column on a foot of stiffness k buckles at P = b^2 EI, b L tan(b L) =
    k L / EI.
    """
    k = 60.0
    model = mast(k)
    thrust = model.forms["mast"].load((0.0, -1.0), (0, 4))
    found = model.buckling(1, start=model.run([sc.Stage("thrust", thrust)], **QUIET))
    b = brentq(lambda b: b * np.tan(b) - k * 4 / EI, 0.1, 1.5)
    assert found.factors[0] == pytest.approx((b / 4) ** 2 * EI, rel=1e-3)


def test_rotations_beyond_buckling():
    """[X] A stiff bar on a foot leans by theta / sin(theta) = P L / k."""
    k, theta = 2.0, 1.2
    line = way((0, 0), (0, 4), n=2)
    beam = sc.Beam(None, line, EI=1e7, EA=1e7, GA=1e7, kinematics="finite")
    foot = sc.RotationSpring(beam, (0, 0), k, to="ground")
    model = sc.Model({"mast": beam, "foot": foot}, beam.dofs((0, 0), ["u^1", "u^2"]))
    form = model.forms["mast"]
    P = k * theta / np.sin(theta) / 4
    aside = form.load((0.05, 0.0), (0, 4))
    thrust = form.load((0.0, -P), (0, 4))
    stages = [
        sc.Stage("push", aside),
        sc.Stage("press", aside + thrust, increments=8),
        sc.Stage("let go", thrust, increments=4),
    ]
    stage = model.run(stages, **QUIET)["let go"]
    turned = stage.table("foot")["rotation"][0]
    assert abs(turned) == pytest.approx(theta, rel=1e-5)


def test_yield_moment():
    """[X] Under F L beyond the yield moment a propped mast keeps that moment in its foot, and after
    unloading the rotation that it has flowed.
    """
    k, limit, F, L = 50.0, 2.0, 12.0, 4.0
    line = way((0, 0), (0, 4))
    beam = sc.Beam(None, line, **STIFF)
    foot = sc.RotationSpring(beam, (0, 0), k, to="ground", yield_moment=limit)
    fixed = [*beam.dofs((0, 0), ["u^1", "u^2"]), *beam.dofs((0, 4), ["u^1"])]
    model = sc.Model({"mast": beam, "foot": foot}, fixed)
    load = model.forms["mast"].load((F, 0.0), (0, 2))
    result = model.run([sc.Stage("load", load), sc.Stage("unload")], **QUIET)
    assert abs(result["load"].table("foot")["moment"][0]) == pytest.approx(limit, rel=1e-9)
    # turn of the end of a beam on two supports, of which limit / k is elastic
    per_moment = L / 3 / EI + 1 / (1e5 * L)
    turn = F * L**2 / 16 / EI - limit * per_moment
    assert abs(result["load"].table("foot")["rotation"][0]) == pytest.approx(turn, rel=1e-6)
    flowed = turn - limit / k
    left = result["unload"].table("foot")
    M = flowed / (1 / k + per_moment)  # the flowed turn is shared by spring and beam
    assert abs(left["moment"][0]) == pytest.approx(M, rel=1e-6)


def test_springs_begin_without_moment_and_change(tmp_path):
    """A spring that a stage activates has no moment there; a new stiffness changes no moment."""
    line = way((0, 0), (3, 0), (6, 0))
    beam = sc.Beam(None, line, **STIFF, hinges=(3, 0))
    joint = sc.RotationSpring(beam, (3, 0), 80.0)
    fixed = [*beam.dofs((0, 0)), *beam.dofs((6, 0), ["u^1", "u^2"])]
    model = sc.Model({"beam": beam, "joint": joint}, fixed)
    load = model.forms["beam"].load((0.0, -1.0), (3, 0))
    stages = [
        sc.Stage("load", load, deactivate="joint"),
        sc.Stage("joint", load, activate="joint"),
        sc.Stage("more", 2 * load),
        sc.Stage("softer", 2 * load, change={"joint": sc.RotationSpring(beam, (3, 0), 8.0)}),
    ]
    result = model.run(stages, **QUIET)
    names = ("joint", "more", "softer")
    moments = [result[name].table("joint")["moment"][0] for name in names]
    assert abs(moments[0]) < 1e-9
    assert abs(moments[1]) > 0.1
    assert moments[2] == pytest.approx(moments[1], rel=1e-9)
    result.save(tmp_path / "springs.npz")
    again = sc.results.load_result(tmp_path / "springs.npz", model)
    assert again["more"].table("joint")["moment"][0] == moments[1]


LINE = way((0, 0), (3, 0), (6, 0))


@pytest.mark.parametrize(
    ("message", "spring"),
    [
        ("must meet in a hinge at", lambda: sc.RotationSpring(plain(), (3, 0), 1.0)),
        ("has a hinge", lambda: sc.RotationSpring(plain(hinges=(3, 0)), (3, 0), 1.0, to="ground")),
        ("no node at", lambda: sc.RotationSpring(plain(), (3, 1), 1.0, to="ground")),
        ("stiffness must be positive", lambda: sc.RotationSpring(plain(), (0, 0), -1.0)),
        ("stiffness must be positive", lambda: sc.RotationSpring(plain(), (0, 0), [1.0, 2.0])),
        (
            "yield_moment must be positive",
            lambda: sc.RotationSpring(plain(), (0, 0), 1.0, to="ground", yield_moment=0.0),
        ),
        ("of beams in the plane", lambda: sc.RotationSpring(in_space(), (0, 0, 0), 1.0)),
        ("joined rigidly at", lambda: rigid_corner()),
    ],
)
def test_refusals(message, spring):
    """One sentence says what is wrong, and where."""
    with pytest.raises(ValueError, match=message):
        spring()


def plain(**more):
    """Straight beam of two parts."""
    return sc.Beam(None, LINE, **STIFF, **more)


def in_space():
    """Beam in space."""
    return sc.Beam(None, [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]], EI=EI, EA=1e4)


def rigid_corner():
    """Spring between beams that are joined rigidly."""
    first = plain()
    second = sc.Beam(None, way((6, 0), (6, 3)), **STIFF, joined_to=first)
    return sc.RotationSpring(second, (6, 0), 1.0, to=first)


def test_damped_tangent_of_a_spring_that_yields():
    """[X] At its yield moment a spring has no stiffness, and a thousandth of it in damped tangents;
    below, both are elastic.
    """
    beam = sc.Beam(None, way((0, 0), (0, 4)), **STIFF)
    foot = sc.RotationSpring(beam, (0, 0), 50.0, to="ground", yield_moment=10.0)
    model = sc.Model({"mast": beam, "foot": foot})
    spring = model.forms["foot"]
    start = spring.initial_state()
    for angle, slope, kept in ((0.1, 50.0, 50.0), (0.3, 0.0, 0.05)):
        response = spring.assemble(np.full(model.layout.size, angle), start)
        assert abs(response.stiffness).max() == pytest.approx(slope, abs=1e-12)
        assert abs(response.damped).max() == pytest.approx(kept)
