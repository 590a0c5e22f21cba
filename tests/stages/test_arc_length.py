"""Stages that follow their path beyond limit points: closed forms, independent paths, refusals."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy import ndarray
from scipy.interpolate import CubicSpline
from skfem import Basis, ElementQuad1, ElementQuad2, ElementVector, MeshQuad

import skfem_contact as sc

QUIET: dict[str, Any] = {"progress": False}


def truss(EA: float = 1e3, a: float = 1.0, h: float = 0.5) -> tuple[sc.Model, int]:
    """Von Mises' truss, whose apex is a node of a block that moves up and down; its dof."""
    mesh = MeshQuad.init_tensor([-0.1, 0.0, 0.1], [0.4, h]).with_defaults()
    basis = Basis(mesh, ElementVector(ElementQuad2()), intorder=4)
    bars = sc.Bar(
        basis,
        [(0.0, h), (0.0, h)],
        [(-a, 0.0), (a, 0.0)],
        EA=EA,
        fixed_end=True,
        kinematics="finite",
    )
    body = sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.0), kinematics="finite")
    model = sc.Model({"bars": bars, "body": body}, basis.get_dofs().all("u^1"))
    apex = basis.nodal_dofs[1, np.argmin(np.hypot(*(mesh.p - [[0.0], [h]])))]
    return model, int(apex)


def force_of_truss(v: ndarray, EA: float = 1e3, a: float = 1.0, h: float = 0.5) -> ndarray:
    """Closed form: P = 2 EA (l0 - l) / l0 (h - v) / l."""
    l0 = np.hypot(a, h)
    length = np.hypot(a, h - v)
    return np.asarray(2 * EA * (l0 - length) / l0 * (h - v) / length)


def followed(model: sc.Model, load: ndarray, increments: int) -> Any:
    """Stage along its path, with all of its increments."""
    stage = sc.Stage("snap", load, increments=increments, arc_length=True, keep="all")
    return model.run([stage], **QUIET)["snap"]


@pytest.mark.parametrize("increments", [8, 20])
def test_truss_snaps_through(increments: int) -> None:
    """[X] Von Mises' truss: all points are on the curve, through both limit points, to the load."""
    model, apex = truss()
    v = np.linspace(0.0, 1.3, 4001)
    limit = force_of_truss(v[v < 0.5]).max()
    load = np.zeros(model.layout.size)
    load[apex] = -1.5 * limit
    stage = followed(model, load, increments)
    depths = np.array([-one.x[apex] for one in stage.increments])
    shares = np.array([one.fraction for one in stage.increments])
    # the tolerance of Newton's method
    assert np.abs(1.5 * limit * shares - force_of_truss(depths)).max() < 1e-6 * limit
    # the path goes over the limit, falls below zero, and comes back
    assert shares[depths < 0.5].max() == pytest.approx(1 / 1.5, rel=0.02)
    assert shares.min() == pytest.approx(-1 / 1.5, rel=0.02)
    assert (np.diff(depths) > 0.0).all()
    assert np.abs(np.diff(shares)).max() <= 1.5 / increments
    assert stage.fraction == 1.0
    assert stage.x[apex] < -1.0
    np.testing.assert_allclose(stage.load, load)
    # the next stage continues from there
    on = model.run([sc.Stage("on", 1.1 * load)], start=stage, **QUIET)["on"]
    assert force_of_truss(-on.x[apex]) == pytest.approx(1.65 * limit, rel=1e-6)


def truss_over_ground(depth: float, method: Any) -> tuple[sc.Model, int]:
    """Von Mises' truss, whose block lands on rigid ground after a way; the dof of its apex."""
    a, h = 1.0, 0.5
    mesh = MeshQuad.init_tensor([-0.1, 0.0, 0.1], [0.4, h]).with_defaults()
    basis = Basis(mesh, ElementVector(ElementQuad2()), intorder=4)
    bars = sc.Bar(
        basis,
        [(0.0, h), (0.0, h)],
        [(-a, 0.0), (a, 0.0)],
        EA=1e3,
        fixed_end=True,
        kinematics="finite",
    )
    body = sc.SolidForm(basis, sc.LinearElastic(E=1e6, nu=0.0), kinematics="finite")
    ground = sc.rigid.polyline([(-2.0, 0.4 - depth), (2.0, 0.4 - depth)])
    law = sc.Coulomb(mu=0.0)
    pair = sc.ContactPair(basis, "bottom", ground, law, penalty=1e4, enforcement=method)
    forms = {"bars": bars, "body": body, "ground": pair}
    apex = basis.nodal_dofs[1, np.argmin(np.hypot(*(mesh.p - [[0.0], [h]])))]
    return sc.Model(forms, basis.get_dofs().all("u^1")), int(apex)


@pytest.mark.parametrize(
    "method",
    [
        None,
        pytest.param(sc.AugmentedLagrangian(), marks=pytest.mark.slow),
        sc.DualMultipliers(),
    ],
)
def test_truss_lands_and_leaves(method: Any) -> None:
    """[X] It snaps through, lands on ground, is pressed, drawn off, and snaps back.

    At a kink, where hard ground stops the block, the load alone grows. Where the block leaves hard
    ground its way turns, and the load falls at once: increments along the old way find no more.
    """
    depth = 0.7
    model, apex = truss_over_ground(depth, method)
    v = np.linspace(0.0, 0.5, 2001)
    limit = force_of_truss(v).max()
    down, up = np.zeros(model.layout.size), np.zeros(model.layout.size)
    down[apex], up[apex] = -1.5 * limit, 1.2 * limit
    options: dict[str, Any] = {"increments": 8, "arc_length": True, "keep": "all"}
    stages = [sc.Stage("land", down, **options), sc.Stage("leave", up, **options)]
    result = model.run(stages, **QUIET)
    for stage, way in zip(result, ((0.0, -1.5), (-1.5, 1.2)), strict=True):
        depths = np.array([-one.x[apex] for one in stage.increments])
        pressed = np.array([one.contact("ground").force[1] for one in stage.increments])
        shares = np.array([one.fraction for one in stage.increments])
        load = -limit * (way[0] + shares * (way[1] - way[0]))
        # the tolerance of Newton's method
        assert np.abs(load - force_of_truss(depths) - pressed).max() < 1e-6 * limit
        assert (pressed[depths < depth - 1e-6] == 0.0).all()
        # the block yields by its own stiffness, and by the penalty's
        assert depths.max() < depth + (0.1 if method is None else 1e-3)
        assert pressed.max() > 0.5 * limit
        assert stage.fraction == 1.0
    # it has passed its peak in the other direction as well
    assert -result["leave"].x[apex] < -0.05
    assert max(load) > 0.9 * limit


def test_path_in_a_file(tmp_path: Path) -> None:
    """[X] All increments are read though the load falls; a path that was stopped goes on onward."""
    model, apex = truss()
    load = np.zeros(model.layout.size)
    load[apex] = -40.0
    stage = sc.Stage("snap", load, increments=6, arc_length=True, keep="all")
    append = sc.results.Append(tmp_path / "path.records")
    whole = model.run([stage], on_increment=append, **QUIET)["snap"]
    read = sc.load_result(append.file, model)["snap"]
    assert [one.fraction for one in read.increments] == [one.fraction for one in whole.increments]
    # once more from the start, stopped where the load falls
    half = sc.results.Append(tmp_path / "half.records")

    def stop(increment: Any) -> None:
        half(increment)
        if increment.x[apex] < -0.3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        model.run([stage], on_increment=stop, **QUIET)
    start = sc.load_result(half.file, model)
    last = start["snap"].increments
    assert last[-1].fraction < last[-2].fraction
    on = sc.Stage("on", load, increments=6, arc_length=True, keep="all")
    with pytest.warns(sc.AnalysisWarning, match="from which the run continues"):
        end = model.run([on], start=start, **QUIET)["on"]
    assert end.increments[0].x[apex] < last[-1].x[apex]
    assert end.x[apex] == pytest.approx(whole.x[apex], rel=1e-7)


def test_no_change_has_no_path() -> None:
    """[X] Neither loads nor supports change: the stage is refused."""
    model, _ = truss()
    with pytest.raises(ValueError, match="changes neither loads nor supports and has no path"):
        model.run([sc.Stage("none", arc_length=True)], **QUIET)


#: Half of a shallow arch, clamped at its foot and guided at its crown: radius, angle of opening,
#: thickness, Young's modulus, and load on the half.
RADIUS, ANGLE, THICKNESS, E, LOAD = 100.0, 0.4, 2.0, 1000.0, 3.0


def arch_of_beams(n: int = 16) -> Any:
    """Path of the arch of n beams: deflections of its crown and shares of the load."""
    t = np.linspace(-ANGLE, 0.0, n + 1)
    points = RADIUS * np.stack((np.sin(t), np.cos(t)), axis=1)
    stiffness: dict[str, Any] = {
        "EI": E * THICKNESS**3 / 12,
        "EA": E * THICKNESS,
        "GA": E * THICKNESS / 2.4,
    }
    beam = sc.Beam(None, points, **stiffness, kinematics="finite")
    foot, crown = tuple(points[0]), tuple(points[-1])
    across, _, turn = beam.dofs(crown)
    model = sc.Model({"arch": beam}, [*beam.dofs(foot), across, turn])
    load = np.zeros(model.layout.size)
    form: Any = model.forms["arch"]
    dof = form.numbers(crown)[1]
    load[dof] = -LOAD
    stage = followed(model, load, 20)
    return [-one.x[dof] for one in stage.increments], [one.fraction for one in stage.increments]


def arch_of_solids(n: int = 16) -> Any:
    """Path of the same arch of n elements of second order, whose crown moves as one."""
    grid = MeshQuad.init_tensor(np.linspace(-ANGLE, 0.0, n + 1), [-0.5, 0.5]).with_defaults()
    t, s = grid.p
    r = RADIUS + THICKNESS * s
    mesh = MeshQuad(np.stack((r * np.sin(t), r * np.cos(t))), grid.t, _boundaries=grid.boundaries)
    basis = Basis(mesh, ElementVector(ElementQuad2()), intorder=4)
    # E and nu of a beam in plane stress, without Poisson's ratio
    body = sc.SolidForm(basis, sc.LinearElastic(E=E, nu=0.0), kinematics="finite")
    fixed = [*basis.get_dofs("left").all(), *basis.get_dofs("right").all("u^1")]
    model = sc.Model({"arch": body}, np.array(fixed))
    load = model.traction("right", (0.0, -LOAD / THICKNESS))
    middle = sc.dofs_at(basis, (0.0, RADIUS)).ravel()[1]
    stage = followed(model, load, 20)
    return [-one.x[middle] for one in stage.increments], [one.fraction for one in stage.increments]


def test_arch_of_beams_and_of_solids() -> None:
    """[N] Both pass the limit, a trough, and come to the load on the same path."""
    beams, solids = arch_of_beams(), arch_of_solids()
    depth = np.linspace(0.0, 13.0, 200)
    along = []
    for deflections, shares in (beams, solids):
        spline = CubicSpline([0.0, *deflections], [0.0, *shares])
        along.append(LOAD * spline(depth))
    limit = along[0][depth < 5.0].max()
    trough = along[0][depth > 5.0].min()
    assert 1.0 < limit < 1.2 and 0.5 < trough < 0.6
    # sides of elements of second order are chords and shear by their own amount
    assert np.abs(along[1] - along[0]).max() < 0.02 * limit
    assert beams[1][-1] == solids[1][-1] == 1.0


def test_path_of_a_stable_body_is_that_of_its_loads() -> None:
    """[N] It ends at the equilibrium of ordinary increments; supports may be moved."""
    mesh = MeshQuad().refined(2).with_defaults()
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    body = sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.3), kinematics="finite")
    top = basis.get_dofs("top").all("u^2")
    model = sc.Model({"body": body}, np.union1d(basis.get_dofs("bottom").all(), top))
    moved = basis.zeros()
    moved[top] = -0.2
    load = model.traction("right", (50.0, 0.0))
    plain = sc.Stage("push", load, moved, increments=4)
    path = sc.Stage("push", load, moved, increments=4, arc_length=True)
    one, other = (model.run([stage], **QUIET)["push"] for stage in (plain, path))
    np.testing.assert_allclose(other.x, one.x, atol=1e-7)


def test_a_path_that_never_comes_to_its_load_is_a_failure_with_a_result() -> None:
    """[X] A strip of Tresca's steel that is torn by twice its strength: its path has the peak."""
    c = 1.0
    basis = Basis(MeshQuad().with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    strip = sc.SolidForm(basis, sc.Tresca(E=1e4, nu=0.3, c=c), kinematics="finite")
    left, bottom = basis.get_dofs("left").all("u^1"), basis.get_dofs("bottom").all("u^2")
    model = sc.Model({"strip": strip}, np.union1d(left, bottom))
    load = model.traction("right", (4.0 * c, 0.0))
    stage = sc.Stage("tear", load, increments=8, arc_length=True, keep="all")
    with pytest.raises(sc.NotConverged, match="of its load") as caught:
        model.run([stage], **QUIET)
    path = caught.value.result["tear"].increments
    assert len(path) > 5
    # stresses of 2 c; the section has shrunk by the elastic strain at most
    assert max(one.fraction for one in path) == pytest.approx(0.5, rel=2e-3)
    assert path[-1].fraction < 0.4


def test_pore_water_is_refused() -> None:
    """[X] It flows in time, and a path has none."""
    basis = Basis(MeshQuad().with_defaults(), ElementVector(ElementQuad2()), intorder=4)
    forms = {
        "soil": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.3)),
        "water": sc.PoreWater(basis, 1e-3, unit_weight=10.0),
    }
    model = sc.Model(forms, basis.get_dofs("bottom").all())
    with pytest.raises(ValueError, match="needs time"):
        model.run([sc.Stage("press", arc_length=True)], **QUIET)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"duration": 1.0}, "has no duration"),
        ({"load": lambda share: np.zeros(30)}, "give `load` as a vector"),
        ({"prescribed": lambda share: np.zeros(30)}, "give `prescribed` as a vector"),
        ({"dynamic": sc.Dynamic(step=0.1), "duration": 1.0}, "not both"),
    ],
)
def test_refused(options: dict[str, Any], words: str) -> None:
    """[X] Times and functions of the share make no sense where the load follows from the path."""
    model, _ = truss()
    with pytest.raises(ValueError, match=words):
        model.run([sc.Stage("snap", **options, arc_length=True)], **QUIET)
