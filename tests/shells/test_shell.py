"""Plates and shells: patch tests, closed forms, stages, shells bonded to solids, refusals."""

from __future__ import annotations

import warnings

import meshio
import numpy as np
import pytest
from skfem import (
    Basis,
    ElementHex1,
    ElementHex2,
    ElementTetP1,
    ElementTetP2,
    ElementVector,
    MeshHex,
    MeshQuad,
    MeshTet,
    MeshTri,
)

import skfem_contact as sc
from skfem_contact.shells.element import normals
from skfem_contact.shells.orientation import turned

QUIET = {"progress": False}
E, NU, T = 12e3, 0.3, 0.1
D = E * T**3 / 12 / (1 - NU**2)
MOVES = ["u^1", "u^2", "u^3"]


def cells_of(kind, n=3, size=1.0, skew=0.0):
    """Nodes, (n, 3), and cells of a square of facets with k nodes, whose inner nodes are moved."""
    line = np.linspace(0.0, size, n + 1)
    mesh = (MeshTri if kind in (3, 6) else MeshQuad).init_tensor(line, line)
    p = mesh.p.T.copy()
    inner = ((p > 1e-9) & (p < size - 1e-9)).all(axis=1)
    p[inner] += skew / n * np.column_stack((np.sin(7 * p[inner, 1]), np.cos(5 * p[inner, 0])))
    cells = mesh.t.T
    # corners anticlockwise
    a, b = p[cells[:, 1]] - p[cells[:, 0]], p[cells[:, 2]] - p[cells[:, 0]]
    around = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0] > 0
    cells = np.where(around[:, None], cells, cells[:, ::-1])
    points = [tuple(x) for x in p]
    k = cells.shape[1]
    if kind > k:
        numbers = {}
        rows = []
        for cell in cells:
            row = list(cell)
            for i in range(k):
                edge = tuple(sorted((cell[i], cell[(i + 1) % k])))
                if edge not in numbers:
                    numbers[edge] = len(points)
                    points.append(tuple(0.5 * (p[edge[0]] + p[edge[1]])))
                row.append(numbers[edge])
            if kind == 9:
                row.append(len(points))
                points.append(tuple(p[cell].mean(axis=0)))
            rows.append(row)
        cells = np.array(rows)
    xy = np.array(points)
    return np.column_stack((xy, 0.0 * xy[:, 0])), cells


def plate(kind=4, n=3, size=1.0, skew=0.0, turned=None, **more):
    """Square plate with nodes of its own, turned by a rotation matrix."""
    points, cells = cells_of(kind, n, size, skew)
    if turned is not None:
        points = points @ turned.T
    return sc.Shell(None, points, cells=cells, E=E, nu=NU, thickness=T, **more)


def rotation(a=0.4, b=1.1, c=-0.7):
    """Rotation about three axes."""

    def about(k, angle):
        i, j = [m for m in range(3) if m != k]
        R = np.eye(3)
        R[i, i] = R[j, j] = np.cos(angle)
        R[i, j], R[j, i] = -np.sin(angle), np.sin(angle)
        return R

    return about(0, a) @ about(1, b) @ about(2, c)


@pytest.mark.parametrize("kind", [3, 4, 6, 8, 9])
def test_constant_strains_and_curvatures(kind):
    """[X] Any mesh, at any place in space, has constant stretching and constant bending exactly."""
    R = rotation()
    form = sc.Model({"plate": plate(kind, skew=0.2, turned=R, axis=R[:, 0])}).forms["plate"]
    X, Y = (form.points @ R)[:, :2].T
    k1, k2, k12 = 2e-3, -1e-3, 5e-4
    e1, e2, g = 1e-4, 2e-4, -3e-4
    # w = -(k1 x^2 + k2 y^2) / 2 - k12 x y: slopes beta = -grad w, rotations (-beta_2, beta_1)
    w = -0.5 * (k1 * X**2 + k2 * Y**2) - k12 * X * Y
    beta = np.stack((k1 * X + k12 * Y, k2 * Y + k12 * X))
    u = np.stack((e1 * X + 0.5 * g * Y, 0.5 * g * X + e2 * Y, w))
    theta = np.stack((-beta[1], beta[0], 0.0 * X))
    x = np.append((R @ u).T.ravel(), (R @ theta).T.ravel())
    response = form.assemble(x, form.initial_state())
    found = form.outputs(x, response.state).members
    m_1, m_2, m_12 = D * (k1 + NU * k2), D * (k2 + NU * k1), D * (1 - NU) * k12
    n = E * T / (1 - NU**2) * np.array([e1 + NU * e2, e2 + NU * e1, 0.5 * (1 - NU) * g])
    for name, value in zip(("m_1", "m_2", "m_12"), (m_1, m_2, m_12), strict=True):
        np.testing.assert_allclose(found[name], value, rtol=1e-9)
    for name, value in zip(("n_1", "n_2", "n_12"), n, strict=True):
        np.testing.assert_allclose(found[name], value, rtol=1e-9)
    # nodes inside are in balance
    inside = ((form.points @ R)[:, :2] > 1e-9).all(axis=1)
    inside &= ((form.points @ R)[:, :2] < 1 - 1e-9).all(axis=1)
    forces = response.force.reshape(2, -1, 3)
    assert np.abs(forces[:, inside]).max() < 1e-12 * np.abs(forces).max()


@pytest.mark.parametrize("kind", [3, 4, 6, 8, 9])
def test_only_rigid_motions_are_free(kind):
    """[X] Six motions without force, and no more; the stiffness is symmetric."""
    form = plate(kind, n=2, skew=0.2, turned=rotation())
    K = sc.Model({"plate": form}).forms["plate"]
    K = K.assemble(np.zeros(6 * len(form.points)), K.initial_state()).stiffness.toarray()
    np.testing.assert_allclose(K, K.T, atol=1e-12 * np.abs(K).max())
    values = np.linalg.eigvalsh(K)
    assert (np.abs(values) < 1e-9 * values[-1]).sum() == 6


@pytest.mark.parametrize("kind", [3, 4, 6])
@pytest.mark.parametrize(("clamped", "deflection"), [(False, 4.06235e-3), (True, 1.26532e-3)])
def test_square_plates(kind, clamped, deflection):
    """[N] Deflections of Timoshenko and Woinowsky-Krieger, of second order, and the moment of the
    simply supported plate.
    """
    errors = []
    for n in (8, 16):
        form = plate(kind, n)
        names = None if clamped else MOVES
        rim = [p for p in form.points if min(*p[:2], *(1 - p[:2])) < 1e-9]
        fixed = [dof for p in rim for dof in form.dofs(p, names)]
        model = sc.Model({"plate": form}, fixed)
        load = model.forms["plate"].area_load((0.0, 0.0, -1.0))
        stage = model.run([sc.Stage("load", load)], **QUIET)["load"]
        moved = stage.x[model.forms["plate"].numbers((0.5, 0.5, 0.0))[2]]
        errors.append(abs(-moved * D / deflection - 1))
    assert errors[1] < 0.012
    assert errors[0] / errors[1] > 3.0
    if not clamped:
        table = stage.table("plate")
        middle = np.hypot(table["x"] - 0.5, table["y"] - 0.5) < 0.06
        # tension at the lower side, away from the normal
        assert -table["m_1"][middle].mean() == pytest.approx(0.0479, rel=0.02)
        assert table["n_1"] == pytest.approx(0.0, abs=1e-9)


def test_tank_with_a_clamped_wall():
    """[N] A cylinder under pressure, row by row: hoop forces and moments of a beam on
    an elastic foundation, with p R t / (2 sqrt(3 (1 - nu^2))) at its foot.
    """
    R, H, t, p, nu = 2.0, 1.2, 0.04, 10.0, 0.2
    z = H * np.linspace(0.0, 1.0, 25) ** 1.6
    mesh = MeshQuad.init_tensor(np.linspace(0.0, np.pi / 2, 33), z)
    angle, height = mesh.p
    points = np.column_stack((R * np.cos(angle), R * np.sin(angle), height))
    cells = mesh.t.T[:, ::-1]  # normals outwards
    wall = sc.Shell(None, points, cells=cells, E=3e7, nu=nu, thickness=t, axis=(0, 0, 1))
    fixed = []
    for point, a, h in zip(points, angle, height, strict=True):
        if h == 0.0:
            fixed += wall.dofs(point)
        if abs(a) < 1e-9:
            fixed += wall.dofs(point, ["u^2", "theta^1", "theta^3"])
        elif abs(a - np.pi / 2) < 1e-9:
            fixed += wall.dofs(point, ["u^1", "theta^2", "theta^3"])
    model = sc.Model({"wall": wall}, fixed)
    load = model.forms["wall"].pressure_load(lambda x: np.full(x.shape[1], -p))
    stage = model.run([sc.Stage("full", load)], **QUIET)["full"]
    # means of the rows
    table = stage.table("wall")
    row = np.searchsorted(z, table["z"]) - 1
    found = {
        name: np.bincount(row, table[name] * wall.areas) / np.bincount(row, wall.areas)
        for name in ("z", "n_2", "m_1")
    }
    # w = p R^2 / E t (1 - exp(-b z) (cos b z + sin b z))
    bz = (3 * (1 - nu**2) / (R * t) ** 2) ** 0.25 * found["z"]
    hoop = p * R * (1 - np.exp(-bz) * (np.cos(bz) + np.sin(bz)))
    np.testing.assert_allclose(found["n_2"], hoop, atol=0.01 * p * R)
    exact = p * R * t / (2 * np.sqrt(3 * (1 - nu**2)))
    moment = exact * np.exp(-bz) * (np.cos(bz) - np.sin(bz))
    # the inner side is stretched at the foot, and the normal points outwards
    np.testing.assert_allclose(found["m_1"], -moment, atol=0.01 * exact)


def test_frequency_of_a_plate():
    """[N] The lowest frequency of a simply supported plate is pi sqrt(D / m)."""
    form = plate(4, 16, unit_weight=25.0)
    rim = [p for p in form.points if min(*p[:2], *(1 - p[:2])) < 1e-9]
    fixed = [dof for p in rim for dof in form.dofs(p, MOVES)]
    model = sc.Model({"plate": form}, fixed, gravity_acceleration=10.0)
    exact = np.pi * np.sqrt(D / (25.0 * T / 10.0))
    assert model.frequencies(1)[0] == pytest.approx(exact, rel=0.01)


def solid(element, axis=2):
    """Basis of a block with named facets on top and inside."""
    line = np.linspace(0, 1, 4)
    mesh = MeshTet if element in (ElementTetP1, ElementTetP2) else MeshHex
    mesh = mesh.init_tensor(line, line, line).with_defaults()
    mesh = mesh.with_boundaries(
        {"slab": lambda x: abs(x[axis] - 1 / 3) < 1e-9}, boundaries_only=False
    )
    return Basis(
        mesh.with_boundaries({"raft": lambda x: x[2] > 1 - 1e-9, "base": lambda x: x[2] < 1e-9}),
        ElementVector(element()),
    )


@pytest.mark.parametrize("element", [ElementTetP1, ElementTetP2, ElementHex1, ElementHex2])
@pytest.mark.parametrize("name", ["raft", "slab"])
def test_shells_on_facets_of_a_mesh(element, name):
    """A shell in soil without stiffness sags under its weight, and its supports hold that."""
    basis = solid(element)
    shell = sc.Shell(basis, name, E=E, nu=NU, thickness=T, unit_weight=20.0)
    height = 1.0 if name == "raft" else 1 / 3
    assert shell.areas.sum() == pytest.approx(1.0, rel=1e-12)
    soil = sc.SolidForm(basis, sc.LinearElastic(E=1e-6, nu=0.3))
    rim = [p for p in shell.points if min(*p[:2], *(1 - p[:2])) < 1e-9]
    fixed = [dof for p in rim for dof in shell.dofs(p, MOVES)]
    model = sc.Model({"soil": soil, "shell": shell}, [basis.get_dofs("base").all(), *fixed])
    stage = model.run([sc.Stage("weight")], **QUIET)["weight"]
    at = shell.points[np.hypot(*(shell.points[:, :2] - 0.5).T).argmin()]
    assert at[2] == pytest.approx(height)
    moved = stage.x[model.forms["shell"].numbers(at)[2]]
    assert moved < 0
    table = stage.table("shell")
    # sagging: tension on the lower side, negative where the normal points upwards
    inner = (np.abs(table["x"] - 0.5) < 0.2) & (np.abs(table["y"] - 0.5) < 0.2)
    assert table["m_1"][inner].max() < 0
    assert stage.reactions()[2 : basis.N : 3].sum() == pytest.approx(20.0 * T, rel=1e-6)


def test_normals_of_vertical_walls():
    """Facets inside turn their normals along y or x: the moment of the earth has one sign."""
    for axis, force in ((0, (1.0, 0, 0)), (1, (0, 1.0, 0))):
        basis = solid(ElementHex1, axis)
        wall = sc.Shell(basis, "slab", E=E, thickness=T, axis=(0, 0, 1))
        soil = sc.SolidForm(basis, sc.LinearElastic(E=1e-6, nu=0.0))
        foot = [p for p in wall.points if p[2] < 1e-9]
        fixed = [dof for p in foot for dof in wall.dofs(p)]
        model = sc.Model({"soil": soil, "wall": wall}, [basis.get_dofs("base").all(), *fixed])
        load = model.forms["wall"].area_load(force)
        stage = model.run([sc.Stage("push", load)], **QUIET)["push"]
        table = stage.table("wall")
        low = table["z"] < 0.2
        # pushed along the normal, the back is stretched: m_1 = -q h^2 / 2 at the foot
        assert table["m_1"][low].max() < 0
        assert table["m_1"][low].mean() == pytest.approx(-0.5 * (1 - 1 / 9) ** 2, rel=0.03)


def test_stages_of_a_shell(tmp_path):
    """A shell begins without force where a stage adds it; another stiffness changes no force."""
    basis = solid(ElementHex1)
    soil = sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.3), unit_weight=10.0)
    shell = sc.Shell(basis, "raft", E=E, nu=NU, thickness=T)
    model = sc.Model({"soil": soil, "raft": shell}, basis.get_dofs("base").all())
    push = model.traction("raft", lambda x: (0 * x[0], 0 * x[0], -5.0 * (x[0] < 0.5)))
    stages = [
        sc.Stage("soil", deactivate="raft"),
        sc.Stage("raft", activate="raft"),
        sc.Stage("push", push),
        sc.Stage(
            "softer", push, change={"raft": sc.Shell(basis, "raft", E=1e3, nu=0.1, thickness=T)}
        ),
    ]
    result = model.run(stages, **QUIET)
    tables = [result[name].table("raft") for name in ("raft", "push", "softer")]
    assert np.abs(tables[0]["m_1"]).max() < 1e-9
    assert np.abs(tables[1]["m_1"]).max() > 1e-3
    np.testing.assert_allclose(tables[2]["m_1"], tables[1]["m_1"], rtol=1e-8)
    np.testing.assert_allclose(tables[2]["n_1"], tables[1]["n_1"], rtol=1e-8)
    result.save(tmp_path / "raft.npz")
    again = sc.load_result(tmp_path / "raft.npz", model)
    np.testing.assert_array_equal(again["push"].table("raft")["m_1"], tables[1]["m_1"])


def test_shells_in_files(tmp_path):
    """Other programs find triangles that cover the shell once, with its values at their corners."""
    basis = solid(ElementHex1)
    soil = sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.3), unit_weight=10.0)
    shell = sc.Shell(basis, "raft", E=E, nu=NU, thickness=T, unit_weight=25.0)
    model = sc.Model({"soil": soil, "raft": shell}, basis.get_dofs("base").all())
    stage = model.run([sc.Stage("weight")], **QUIET)["weight"]
    stage.to_vtu(tmp_path / "raft.vtu")
    found = meshio.read(tmp_path / "raft.vtu")
    [cells] = [block.data for block in found.cells if block.type == "triangle"]
    corners = found.points[cells]
    areas = (
        np.linalg.norm(
            np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
        )
        / 2
    )
    assert areas.sum() == pytest.approx(1.0, rel=1e-12)
    table = stage.table("raft")
    values = found.point_data["m_1"][cells]
    assert values.min() < table["m_1"].min() and table["m_1"].max() < values.max()
    mean = np.average(values.mean(axis=1), weights=areas)
    assert mean == pytest.approx(np.average(table["m_1"], weights=shell.areas), rel=0.05)
    moved = found.point_data["displacement"][cells[:, 0], 2]
    assert (moved < 0).all()


@pytest.mark.parametrize("mesh", [MeshTri, MeshQuad])
def test_moments_at_corners(mesh):
    """[X] Moments at a clamped edge, .0513 q a^2 (Timoshenko), without those of a panel that stands
    on it; their error falls by half or more on a mesh of half the size.
    """
    errors = []
    for n in (8, 16):
        line = np.linspace(0.0, 1.0, n + 1)
        flat = mesh.init_tensor(line, line)
        flat = flat.oriented() if mesh is MeshTri else flat
        cells = flat.t.T if mesh is MeshTri else flat.t.T[:, ::-1]
        floor = np.column_stack((*flat.p, 0.0 * flat.p[0]))
        panel = floor[:, [2, 1, 0]]
        points, number = np.unique(np.vstack((floor, panel)), axis=0, return_inverse=True)
        form = sc.Shell(
            None,
            points,
            cells=number[np.vstack((cells, len(floor) + cells))],
            E=E,
            nu=NU,
            thickness=T,
            axis=(0, 1, 0),
        )
        fixed = [d for p in floor if min(*p[:2], *(1 - p[:2])) == 0.0 for d in form.dofs(p)]
        fixed += [d for p in panel for d in form.dofs(p)]
        model = sc.Model({"floor": form}, fixed)
        load = model.forms["floor"].area_load(lambda x: (0 * x[0], 0 * x[0], -1.0 * (x[2] == 0)))
        outputs = model.run([sc.Stage("load", load)], **QUIET)["load"].outputs("floor")
        points, values = outputs.triangles
        edge = np.linalg.norm(points - (0.0, 0.5, 0.0), axis=1).argmin()
        errors.append(abs(values["m_2"][edge] / 0.0513 - 1))
    assert errors[0] < 0.04 and errors[1] < max(0.5 * errors[0], 0.006), errors


def test_normals_of_neighbours_agree():
    """Triangles of a mesh that is not oriented are refused; a ring inside has its normals outside,
    a wave upwards, and both halves of a fold may differ.
    """
    points, cells = cells_of(3, 2)
    cells[1] = cells[1, ::-1]
    with pytest.raises(ValueError, match=r"point to opposite sides.*oriented"):
        sc.Shell(None, points, cells=cells, E=E, thickness=T)
    angle = np.linspace(0.0, 2.0 * np.pi, 25)[:-1]
    ring = np.array([(np.cos(a), np.sin(a), z) for z in (0.0, 1.0) for a in angle])
    k = np.arange(24)
    sides = np.column_stack((k, (k + 1) % 24, 24 + (k + 1) % 24, 24 + k))
    mixed = sides.copy()
    mixed[5:9] = mixed[5:9, ::-1]
    for given in (sides, mixed, sides[:, ::-1]):
        turn = turned(ring, given)
        cells = np.where(turn[:, None], given[:, ::-1], given)
        outside = normals(ring[cells[:, :3]])
        assert (np.einsum("ij,ij->i", outside, ring[cells[:, 0]] * (1, 1, 0)) > 0).all()
    folded = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (1, 0, 1), (1, 1, 1)], float)
    parts = np.array([(0, 1, 2, 3), (1, 4, 5, 2)])
    for given in (parts, np.array([parts[0], parts[1, ::-1]])):
        assert (
            sc.Shell(None, folded, cells=given, E=E, thickness=T, axis=(0, 1, 0)).areas.sum() == 2
        )


def test_column_on_a_plate():
    """[X] A column that is joined to a plate hands its moment over: the plate's supports hold the
    load, and the column bends as a cantilever on the plate's turn.
    """
    form = plate(4, 8)
    rim = [p for p in form.points if min(*p[:2], *(1 - p[:2])) < 1e-9]
    fixed = [dof for p in rim for dof in form.dofs(p)]
    line = np.linspace((0.5, 0.5, 0.0), (0.5, 0.5, 0.8), 5)
    column = sc.Beam(None, line, EI=0.5, EA=1e4, joined_to=form)
    model = sc.Model({"plate": form, "column": column}, fixed)
    top = model.forms["column"]
    push = top.load((0.01, 0.0, 0.0), (0.5, 0.5, 0.8))
    stage = model.run([sc.Stage("push", push)], **QUIET)["push"]
    turn = stage.x[model.forms["plate"].numbers((0.5, 0.5, 0.0))[4]]
    moved = stage.x[top.numbers((0.5, 0.5, 0.8))[0]]
    GA = 1e4 / 3
    bent = 0.01 * (0.8**3 / 3 / 0.5 + 0.8 / GA)
    assert turn > 0
    assert moved - stage.x[top.numbers((0.5, 0.5, 0.0))[0]] == pytest.approx(
        bent + 0.8 * turn, rel=1e-6
    )


POINTS, CELLS = cells_of(4, 1)


@pytest.mark.parametrize(
    ("message", "make"),
    [
        (
            "needs the basis of a mesh in space",
            lambda: sc.Shell(None, "raft", E=1.0, thickness=1.0),
        ),
        ("thickness of a shell", lambda: own(thickness=0.0)),
        ("E of a shell", lambda: own(E=-1.0)),
        ("nu between", lambda: own(nu=0.7)),
        ("numbers of its 4 nodes", lambda: own(cells=[[0, 1, 2, 9]])),
        ("numbers of 3, 4, 6, 8 or 9", lambda: own(cells=[[0, 1]])),
        ("with `cells`", lambda: sc.Shell(None, [0.0, 1.0], E=1.0, thickness=1.0)),
        ("every node of a shell", lambda: own(cells=[[0, 1, 2]])),
        ("is normal to the shell at", lambda: own(axis=(0.0, 0.0, 1.0))),
        (
            "give none",
            lambda: sc.Shell(solid(ElementHex1), "raft", E=1.0, thickness=1.0, cells=CELLS),
        ),
    ],
)
def test_refusals(message, make):
    """One sentence says what is wrong."""
    with pytest.raises(ValueError, match=message):
        make()


def own(**more):
    """Shell with nodes of its own."""
    return sc.Shell(None, POINTS, **{"E": E, "thickness": T, "cells": CELLS, **more})


def strip(from_, to, thickness=0.3, **more):
    """Shell of 8 by 2 squares between two points of the plane y = 0, 1 wide."""
    mesh = MeshQuad.init_tensor(np.linspace(0.0, 1.0, 9), np.linspace(0.0, 1.0, 3))
    points = np.outer(1 - mesh.p[0], from_) + np.outer(mesh.p[0], to)
    points[:, 1] = mesh.p[1]
    return sc.Shell(None, points, cells=mesh.t.T, E=3e7, thickness=thickness, **more)


def angle(bonded):
    """A slab that is clamped at x = 0, and a wall of 3 m at its other end, x = 4."""
    if not bonded:
        slab = strip((0.0, 0.0, 0.0), (4.0, 0.0, 0.0), thickness=0.4)
        return {"slab": slab, "wall": strip((4.0, 0.0, 0.0), (4.0, 0.0, 3.0), joined_to=slab)}
    lines = (np.linspace(0.0, size, n) for size, n in ((4.0, 9), (1.0, 3), (3.0, 9)))
    mesh = MeshHex.init_tensor(*lines).with_boundaries(
        {"slab": lambda x: x[2] < 1e-9, "wall": lambda x: x[0] > 4.0 - 1e-9}
    )
    basis = Basis(mesh, ElementVector(ElementHex1()), intorder=2)
    slab = sc.Shell(basis, "slab", E=3e7, thickness=0.4)
    wall = sc.Shell(basis, "wall", E=3e7, thickness=0.3, joined_to=slab)
    soil = sc.SolidForm(basis, sc.LinearElastic(E=0.1, nu=0.0), unit_weight=0.0)
    return {"soil": soil, "slab": slab, "wall": wall}


@pytest.mark.parametrize("bonded", [False, True])
def test_a_wall_on_a_slab(bonded, tmp_path):
    """[X] The moment of a wall goes round the corner into the slab to which it is joined, as in
    two beams: ``F h**3 / 3 EI + F h**2 L / EI``.
    """
    forms = angle(bonded)
    slab = forms["slab"]
    held = [dof for p in slab.points if p[0] < 1e-9 for dof in slab.dofs(p)]
    model = sc.Model(forms, held)
    wall = model.forms["wall"]
    shares = {0.0: 0.25, 0.5: 0.5, 1.0: 0.25}
    push = [wall.load((10.0 * part, 0.0, 0.0), at=(4.0, y, 3.0)) for y, part in shares.items()]
    result = model.run([sc.Stage("push", push)], **QUIET)
    stage = result["push"]
    exact = 10.0 * 12 / 3e7 * (3.0**3 / 3 / 0.3**3 + 3.0**2 * 4.0 / 0.4**3)
    assert stage.x[wall.numbers((4.0, 0.5, 3.0))[0]] == pytest.approx(exact, rel=2e-3)
    moments = np.abs(stage.table("slab")["m_1"])
    assert np.average(moments, weights=slab.areas) == pytest.approx(30.0, rel=2e-3)

    # The file of the run has the same moments
    result.save(tmp_path / "angle.npz")
    again = sc.load_result(tmp_path / "angle.npz", model)["push"]
    assert np.array_equal(again.table("wall")["m_2"], stage.table("wall")["m_2"])


def test_hinges_between_bonded_shells_are_told():
    """[X] The corner of two shells on facets of one mesh is a hinge of three nodes unless one is
    joined to the other, one is away, or supports hold its rotations.
    """
    forms = angle(True)
    slab = forms["slab"]
    wall = sc.Shell(forms["soil"].basis, "wall", E=3e7, thickness=0.3, unit_weight=25.0)
    foot = [dof for p in slab.points if p[0] < 1e-9 for dof in slab.dofs(p)]
    corner = [p for p in slab.points if p[0] > 4.0 - 1e-9]
    assert len(corner) == 3

    def told(forms, held, *stages):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            sc.Model(forms, held).run(stages, **QUIET)
        return [str(warning.message) for warning in caught]

    open_ = {**forms, "wall": wall}
    texts = told(open_, foot, sc.Stage("rest"))
    assert len(texts) == 1 and "'slab' and 'wall' are hinged at 3 nodes" in texts[0]
    assert not told(forms, foot, sc.Stage("rest"))
    assert not told(open_, foot, sc.Stage("rest", deactivate="wall"))
    turns = ["theta^1", "theta^2", "theta^3"]
    both = [dof for form in (slab, wall) for p in corner for dof in form.dofs(p, turns)]
    assert not told(open_, foot + both, sc.Stage("rest"))
    one = [dof for p in corner for dof in slab.dofs(p, turns)]
    assert "hinged at 3 nodes" in told(open_, foot + one, sc.Stage("rest"))[0]
    with pytest.warns(sc.AnalysisWarning, match="hinged at 3 nodes"):
        sc.Model(open_, foot, gravity_acceleration=9.81).modes(1)


def test_shells_join_what_they_touch():
    """[X] Shells without a common node, and forms without rotations, are refused."""
    slab = strip((0.0, 0.0, 0.0), (4.0, 0.0, 0.0))
    with pytest.raises(ValueError, match="the shell has no node in common with a shell"):
        strip((5.0, 0.0, 0.0), (5.0, 0.0, 3.0), joined_to=slab)
    with pytest.raises(ValueError, match="a shell may be joined_to beams and shells"):
        strip((4.0, 0.0, 0.0), (4.0, 0.0, 3.0), joined_to=angle(True)["soil"])


def test_shells_in_tables_of_results():
    """[X] A cantilever plate under its own weight: the row of its stage has its moment at the foot,
    q L**2 / 2 at the centre of the last triangles, and its displacement q L**4 / 8 EI.
    """
    form = strip((0.0, 0.0, 0.0), (4.0, 0.0, 0.0), thickness=0.4, unit_weight=25.0)
    foot = np.flatnonzero(form.points[:, 0] == 0.0)
    model = sc.Model({"slab": form}, [dof for k in foot for dof in form.dofs(form.points[k])])
    result = model.run([sc.Stage("weight")], **QUIET)
    table = result.table()
    rows = result["weight"].table("slab")
    assert abs(table["slab m_1"][0]) == pytest.approx(np.abs(rows["m_1"]).max(), rel=1e-9)
    assert abs(table["slab m_1"][0]) == pytest.approx(10.0 * (4.0 - 0.25) ** 2 / 2, rel=0.08)
    EI = 3e7 * 0.4**3 / 12
    assert table["displacement"][0] == pytest.approx(10.0 * 4.0**4 / 8 / EI, rel=0.02)
    assert table["displacement at"][0].startswith("(4,")


def test_a_square_shaft_under_pressure():
    """[X] Facets inside of a mesh that form a square shaft have their normals outside, round its
    corners: a pressure within it loads a frame, M = p L**2 / 24 in the middle of its sides,
    -p L**2 / 12 in the corners, and N = p L / 2, without a force on the whole.
    """
    line = np.linspace(-3.0, 3.0, 25)
    mesh = MeshHex.init_tensor(line, line, [-1.0, -0.5, 0.0]).with_boundaries(
        {"shaft": lambda x: np.abs(np.abs(x[:2]).max(axis=0) - 2.0) < 1e-9},
        boundaries_only=False,
    )
    basis = Basis(mesh, ElementVector(ElementHex1()), intorder=2)
    shaft = sc.Shell(basis, "shaft", E=3e7, thickness=0.15, axis=(0, 0, 1))
    held = basis.get_dofs(lambda x: x[2] < -1.0 + 1e-9).all("u^3")
    turns = [dof for p in ((2, 0, -1), (-2, 0, -1)) for dof in shaft.dofs(p, ["u^2"])] + shaft.dofs(
        (0, 2, -1), ["u^1"]
    )
    soil = sc.SolidForm(basis, sc.LinearElastic(E=0.1, nu=0.0))
    model = sc.Model({"soil": soil, "shaft": shaft}, [held, *turns])
    load = model.forms["shaft"].pressure_load(-10.0)
    assert [abs(load[k : basis.N : 3].sum()) < 1e-9 for k in range(3)] == [True] * 3
    table = model.run([sc.Stage("full", load)], **QUIET)["full"].table("shaft")
    one = table["x"] > 1.99
    for low, high in ((0.0, 0.3), (0.7, 1.3), (1.7, 2.0)):
        here = one & (np.abs(table["y"]) > low) & (np.abs(table["y"]) < high)
        exact = 10.0 * (4.0**2 / 24 - table["y"][here] ** 2 / 2).mean()
        # 2 % of the moment in the corners, with 16 elements on a side
        assert table["m_2"][here].mean() == pytest.approx(exact, abs=0.02 * 10.0 * 4.0**2 / 12)
        assert table["n_2"][here].mean() == pytest.approx(20.0, rel=0.02)


def test_files_of_structures_alone(tmp_path):
    """[X] Files for ParaView of models without solids have the triangles of shells and their
    displacements; a column on a shell is a line with gaps for the moments of shells.
    """
    slab = strip((0.0, 0.0, 0.0), (4.0, 0.0, 0.0), unit_weight=25.0)
    column = sc.Beam(
        None, [(2.0, 0.5, 0.0), (2.0, 0.5, 3.0)], EI=1e3, EA=1e5, unit_weight=1.0, joined_to=slab
    )
    held = [dof for p in slab.points if p[0] == 0.0 for dof in slab.dofs(p)]
    model = sc.Model({"slab": slab, "column": column}, held)
    result = model.run([sc.Stage("weight")], **QUIET)
    stage = result["weight"]
    stage.to_vtu(tmp_path / "slab.vtu")
    result.to_pvd(tmp_path / "slab.pvd")
    for name in ("slab.vtu", "slab_0.vtu"):
        mesh = meshio.read(tmp_path / name)
        kinds = {block.type: block.data for block in mesh.cells}
        assert set(kinds) == {"triangle", "line3"}
        moved = mesh.point_data["displacement"]
        assert np.isclose(np.nanmin(moved[:, 2]), stage.x.min(), rtol=1e-6)
        assert np.isnan(mesh.point_data["m_1"][kinds["line3"]]).all()
        assert np.isfinite(mesh.point_data["m_1"][kinds["triangle"]]).all()
