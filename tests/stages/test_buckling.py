"""Thrusts near buckling are told at the end of a stage."""

from __future__ import annotations

import re
import warnings

import numpy as np
import pytest
from skfem import MeshQuad

import skfem_contact as sc
from tests.tools.helpers import grid, vector_basis

EI, L = 200.0, 4.0
EULER = np.pi**2 * EI / L**2


def share(model: sc.Model, *loads: np.ndarray) -> float:
    """Share of the buckling load that a stage is warned of, 0 without a warning."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        result = model.run([sc.Stage("load", list(loads))], progress=False)
    told = [text for text in result[-1].remarks if "buckles" in text]
    assert len(told) == len([w for w in caught if "buckles" in str(w.message)])
    if not told:
        return 0.0
    if "times the load" in told[0]:
        return float(told[0].split("thrust is ")[1].split(" ")[0])
    found = float(told[0].split("thrust is ")[1].split("%")[0]) / 100.0
    more = float(told[0].split("add about ")[1].split("%")[0]) / 100.0
    assert more == pytest.approx(found / (1.0 - found), rel=0.06, abs=0.006)  # of rounded shares
    return found


def column(angle: float = 0.0, space: bool = False) -> tuple[sc.Beam, np.ndarray, np.ndarray]:
    """Column of six elements at an angle to the vertical, stiff in shear, and its ends."""
    points = np.linspace(0.0, L, 7)[:, None] * np.array([np.sin(angle), np.cos(angle)])
    if space:
        points = np.insert(points, 1, 0.0, axis=1)
    return sc.Beam(None, points, EI=EI, EA=1e6, GA=1e6), points[0], points[-1]


@pytest.mark.parametrize("part", [0.05, 0.3, 0.7, 2.0])
@pytest.mark.parametrize(
    ("held", "factor"), [([], 0.25), (["u^1"], 2.0457), (["u^1", "theta"], 4.0)]
)
def test_columns_that_are_fixed_at_the_foot(held, factor, part):
    """[X] A cantilever, propped and built in, under shares of Euler's loads."""
    beam, foot, head = column()
    fixed = [*beam.dofs(foot), *(beam.dofs(head, held) if held else [])]
    model = sc.Model({"column": beam}, fixed)
    load = model.forms["column"].load((0.0, -part * factor * EULER), at=head)
    found = share(model, load)
    assert found == (0.0 if part < 0.1 else pytest.approx(part, abs=0.012))  # rounded, shear


@pytest.mark.parametrize("space", [False, True])
def test_inclined_cantilever(space):
    """[X] The thrust of an inclined force along the column counts, its transverse part does not."""
    angle = 0.7
    beam, foot, head = column(angle, space)
    model = sc.Model({"column": beam}, beam.dofs(foot))
    force = -0.1 * EULER * head / L
    across = 0.01 * np.array([force[-1], *[0.0] * space, -force[0]])
    load = model.forms["column"].load(force + across, at=head)
    assert share(model, load) == pytest.approx(0.4, abs=0.006)


def test_thrust_that_varies_and_tension():
    """[X] A heavy cantilever buckles at q L = 7.837 EI / L^2; one that hangs does not."""
    beam, foot, _ = column()
    model = sc.Model({"column": beam}, beam.dofs(foot))
    weight = model.forms["column"].line_load((0.0, -0.5 * 7.837 * EI / L**3))
    assert share(model, weight) == pytest.approx(0.5, abs=0.006)
    assert share(model, -weight) == 0.0


def test_portal_that_sways():
    """[X] Two columns on hinges below a stiff beam: each buckles as a cantilever of its height."""
    posts = [sc.Beam(None, [(x, 0.0), (x, L / 2), (x, L)], EI=EI, EA=1e6, GA=1e6) for x in (0, 3)]
    top = sc.Beam(None, [(0, L), (1.5, L), (3, L)], EI=1e6, EA=1e8, joined_to=posts)
    fixed = [dof for x, post in zip((0, 3), posts) for dof in post.dofs((x, 0), ["u^1", "u^2"])]
    model = sc.Model({"left": posts[0], "right": posts[1], "top": top}, fixed)
    loads = [model.forms["top"].load((0.0, -0.5 * 0.25 * EULER), at=(x, L)) for x in (0, 3)]
    assert share(model, *loads) == pytest.approx(0.5, abs=0.008)  # two elements a column


def test_pile_that_the_ground_holds():
    """[N] A slender pile in stiff ground under ten times its load as a cantilever is no remark."""
    mesh = grid("P2", np.linspace(0, 4, 9), np.linspace(0, 4, 9)).with_boundaries(
        {"pile": lambda x: abs(x[0] - 2.0) < 1e-6}, boundaries_only=False
    )
    basis = vector_basis(mesh, "P2", intorder=2)
    pile = sc.Beam(basis, "pile", EI=EI, EA=1e6)
    forms = {"ground": sc.SolidForm(basis, sc.LinearElastic(1e4, 0.3)), "pile": pile}
    model = sc.Model(forms, sc.box_supports(basis))
    load = model.forms["pile"].load((0.0, -2.5 * EULER), at=(2.0, 4.0))
    assert share(model, load) == 0.0


def test_loads_that_penalties_lower_are_told(recwarn):
    """[N] The share by which two soft joints lower the load, beside joints a hundred times as
    hard.
    """

    def factor(penalty):
        y = np.linspace(0, 4, 13)
        blocks = {
            "low": grid("Q2", np.linspace(-1.1, -0.1, 4), y),
            "high": grid("Q2", np.linspace(0.1, 1.1, 4), y),
        }
        basis = vector_basis(sc.join_bodies(blocks), "Q2", intorder=4)
        axis = np.column_stack((0.0 * y, y))
        wall = sc.Beam(None, axis, EI=EI, EA=1e6, GA=1e6, thickness=0.2)
        soil = sc.SolidForm(basis, sc.LinearElastic(E=300.0, nu=0.0))
        forms = {"soil": soil, "wall": wall, **wall.contact(basis, sc.Tied(), penalty=penalty)}
        held = basis.get_dofs({"low:left", "high:right"}).all()
        model = sc.Model(forms, [held, *wall.dofs((0.0, 0.0), ["u^2"])])
        load = model.forms["wall"].load((0.0, -100.0), (0.0, 4.0))
        start = model.run([sc.Stage("push", load)], progress=False)
        recwarn.clear()
        return model.buckling(1, start=start).factors[0]

    hard = factor(1e6)
    assert not recwarn.list
    lower = 1.0 - factor(1e4) / hard
    (warning,) = recwarn
    told = re.search(r"lowers buckling loads by up to ([\d.]+)%", str(warning.message))
    # Digits that are written; the next order is the square of 3 %
    assert float(told[1]) == pytest.approx(100.0 * lower, abs=0.14)


@pytest.mark.parametrize(("sides", "k"), [("x", 4.0), ("xy", 2.0)])
def test_square_plate_under_thrust(sides, k):
    """[X] A plate on simple supports buckles at k pi^2 D / b^2 per length of its loaded sides."""
    n = 8
    mesh = MeshQuad.init_tensor(np.linspace(0.0, 1.0, n + 1), np.linspace(0.0, 1.0, n + 1))
    points = np.column_stack((*mesh.p, 0 * mesh.p[0]))
    E, nu, t = 12e3, 0.3, 0.01
    plate = sc.Shell(None, points, cells=mesh.t.T, E=E, nu=nu, thickness=t)
    rim = points[(points[:, :2] % 1.0 == 0.0).any(axis=1)]
    fixed = [dof for point in rim for dof in plate.dofs(point, ["u^3"])]
    fixed += [*plate.dofs((0, 0, 0), ["u^1", "u^2"]), *plate.dofs((0, 1, 0), ["u^1"])]
    model = sc.Model({"plate": plate}, fixed)
    least = k * np.pi**2 * E * t**3 / 12 / (1 - nu**2)

    # forces of half of the load on both ends of each side, that of corners halved
    load = np.zeros(model.layout.size)
    for axis in ("xyz".index(side) for side in sides):
        for end in points[points[:, axis] % 1.0 == 0.0]:
            share_of_side = 0.5 if end[1 - axis] % 1.0 == 0.0 else 1.0
            force = np.zeros(3)
            force[axis] = (0.5 - end[axis]) * least * share_of_side / n
            load += model.forms["plate"].load(force, at=end)
    result = model.run([sc.Stage("half", load)], progress=False)
    found = model.buckling(1, start=result).factors[0]
    assert found == pytest.approx(2.0, rel=0.005)  # elements of an eighth: .33 % in both cases
    assert share(model, load) == pytest.approx(0.5, abs=0.006)
    assert share(model, -load) == 0.0


def test_ring_of_a_shell():
    """[X] A quarter of a ring under radial forces that keep their direction: q = 4 EI / R^3."""
    E, t, R, n = 1e7, 0.02, 1.0, 16
    mesh = MeshQuad.init_tensor(np.linspace(0.0, 0.2, 2), np.linspace(0.0, np.pi / 2, n + 1))
    y, z = R * np.sin(mesh.p[1]), R * np.cos(mesh.p[1])
    points = np.column_stack((mesh.p[0], y, z))
    ring = sc.Shell(None, points, cells=mesh.t.T, E=E, thickness=t)
    fixed = []
    for point in points:
        held = ["u^1"]
        if point[1] < 1e-9:
            held += ["u^2", "theta^1", "theta^3"]
        elif point[2] < 1e-9:
            held += ["u^3", "theta^1", "theta^2"]
        fixed += [*ring.dofs(point, held)]
    model = sc.Model({"ring": ring}, fixed)
    inwards = model.forms["ring"].area_load(lambda x: -np.stack((0 * x[0], x[1], x[2])) / R)
    found = model.buckling(1, start=model.run([sc.Stage("q", inwards)], progress=False))
    # chords of sixteen elements in a quarter: .4 %
    assert found.factors[0] == pytest.approx(4.0 * E * t**3 / 12 / R**3, rel=0.006)
