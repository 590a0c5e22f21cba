"""Blocks that are pushed, tilted and dragged off a table: cases C6 and D6."""

from __future__ import annotations

import numpy as np
import pytest

import skfem_contact as sc
from skfem_contact.contact.laws import Status
from skfem_contact.contact.penalty import choose_penalties
from skfem_contact.nonlinear.system import System
from skfem_contact.results import StageResult
from skfem_contact.results.tractions import tractions
from tests.tools.helpers import dofs_at, grid, vector_basis

QUADRATURES = ["nodal", 4, "segments"]
#: Where there is no equilibrium, it is not searched for long: increments are cut ten times before
#: the analysis stops.
QUICK = sc.Newton(max_iterations=12)
PHI = np.tan(np.radians(26.6))


def support(forms: dict, stage: StageResult) -> tuple[np.ndarray, np.ndarray]:
    """Nodal contact forces on the block and the places of their nodes, where it was meshed, (n,
    2).
    """
    pair = choose_penalties(forms)["floor"]
    force = -pair.assemble(stage.x, stage.states["floor"]).force
    return force[pair.slave.dofs], pair.slave.nodes


# -- C6: a block on a plane


def pushed(quadrature, law: sc.Coulomb, height: float | None) -> tuple[dict, list[StageResult]]:
    """The block of the case, 4 x 1 and 100 heavy, pushed at its left side: at one height, or the
    whole side.
    """
    basis = vector_basis(grid("Q1", np.linspace(0, 4, 17), np.linspace(0, 1, 5)), "Q1")
    plane = sc.rigid.line((-5.0, 0.0), (10.0, 0.0))
    forms = {
        "block": sc.SolidForm(basis, sc.LinearElastic(E=1e6, nu=0.2)),
        "floor": sc.ContactPair(basis, "bottom", plane, law, quadrature),
    }
    weight = sc.weight(basis, 25.0)
    left = basis.get_dofs("left").all("u^1")
    if height is not None:
        left = left[np.abs(basis.doflocs[1, left] - height) < 1e-9]
    stages = [sc.Stage("weight", weight)]
    for push in (1e-3, 2e-3, 1e-2):
        x = basis.zeros()
        x[left] = push
        stages.append(sc.Stage(f"push {push}", weight, x))
    return forms, list(sc.Model(forms, left).run(stages, progress=False))


@pytest.mark.parametrize("quadrature", QUADRATURES)
def test_push(quadrature) -> None:
    """[X], [P] C6: 4 * 2.5 + 100 tan 26.6 = 60.076, however far it is pushed (PLAXIS: 60.4)."""
    forms, stages = pushed(quadrature, sc.Coulomb(PHI, adhesion=2.5), None)
    for stage in stages[1:]:
        force = support(forms, stage)[0].sum(axis=0)
        # penetrations, 1e-5 of the block's size, do not change the forces: what is left is the
        # iterations' residual
        np.testing.assert_allclose(force, [-60.0762698, 100.0], rtol=1e-6)
        assert (stage.states["floor"].status == Status.SLIP).all()


@pytest.mark.parametrize("height", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("quadrature", QUADRATURES)
def test_push_off_the_base(quadrature, height: float) -> None:
    """[X] C6: pressure moves towards the toe, the left may lift off; without adhesion the total
    stays.
    """
    forms, stages = pushed(quadrature, sc.Coulomb(PHI), height)
    force, place = support(forms, stages[-1])
    np.testing.assert_allclose(force.sum(axis=0), [-100 * PHI, 100.0], rtol=1e-6)
    # moments: the push has the lever `height`
    assert force[:, 1] @ place[:, 0] == pytest.approx(200 + 100 * PHI * height, rel=1e-6)
    if height > 0:
        assert (stages[-1].states["floor"].status == Status.OPEN).any()


@pytest.mark.parametrize("height", [0.0, 0.25, 0.5, 0.75, 1.0])
@pytest.mark.parametrize("quadrature", QUADRATURES)
@pytest.mark.filterwarnings("ignore:.*opened with their bond")
@pytest.mark.one_in(3)
def test_adhesion_where_it_touches(quadrature, height: float) -> None:
    """[X] C6: what has lifted off adheres no more, nor what would lift off and close in turn."""
    forms, stages = pushed(quadrature, sc.Coulomb(PHI, adhesion=2.5), height)
    state = stages[-1].states["floor"]
    joint = tractions(forms["floor"], state)
    bonded = (joint.status != Status.OPEN) & (state.internal[0] == 0)
    force, place = support(forms, stages[-1])
    horizontal = 100 * PHI + 2.5 * joint.weight[bonded].sum()
    np.testing.assert_allclose(force.sum(axis=0), [-horizontal, 100.0], rtol=1e-6)
    assert force[:, 1] @ place[:, 0] == pytest.approx(200 + horizontal * height, rel=1e-6)
    assert ((joint.status != Status.OPEN) & ~bonded).sum() <= 1
    assert height == 0 or joint.weight[bonded].sum() < 4


def test_broken_bond_is_warned_of(monkeypatch) -> None:
    """C6: without equilibrium with the adhesion of a point or without the point, it loses its bond,
    and is named.

    That is seen from the active sets, which return: 15 systems are solved; 98 were when all
    searches had to fail first.
    """
    solved, factor = [], System.factor
    monkeypatch.setattr(System, "factor", lambda self, K: solved.append(1) or factor(self, K))
    with pytest.warns(
        sc.AnalysisWarning,
        match=r"1 points of 'bottom', the first at \(.*\), opened with their bond and closed",
    ):
        _, stages = pushed("nodal", sc.Coulomb(PHI, adhesion=2.5), 1.0)
    state = stages[-1].states["floor"]
    broken = (state.internal[0] > 0) & (state.status != Status.OPEN)
    assert broken.nonzero()[0].tolist() == [12] and len(solved) <= 20
    assert state.status[12] == Status.SLIP
    assert state.traction[1][12] == pytest.approx(
        -PHI * state.traction[0][12], rel=1e-9
    )  # no adhesion


@pytest.mark.parametrize("quadrature", ["nodal", "segments"])
@pytest.mark.parametrize("angle", [10.0, 26.5, 26.6])
@pytest.mark.one_in(2)
def test_incline(angle: float, quadrature) -> None:
    """[X] C6: it rests up to tan(angle) = mu, N = W cos and T = W sin; beyond, the error names its
    load.
    """
    mu, weight = 0.5, 20.0  # atan(0.5) = 26.565 degrees
    basis = vector_basis(grid("Q1", np.linspace(0, 2, 9), np.linspace(0, 1, 5)), "Q1")
    plane = sc.rigid.line((-5.0, 0.0), (10.0, 0.0))
    forms = {
        "block": sc.SolidForm(basis, sc.LinearElastic(E=1e5, nu=0.2)),
        "floor": sc.ContactPair(basis, "bottom", plane, sc.Coulomb(mu), quadrature),
    }
    across = np.cos(np.radians(angle)) * sc.weight(basis, weight / 2)
    along = np.zeros_like(across)
    along[basis.nodal_dofs[0]] = np.tan(np.radians(angle)) * across[basis.nodal_dofs[1]]
    stages = [sc.Stage("press", across), sc.Stage("tilt", across + along)]
    if np.tan(np.radians(angle)) < mu:
        result = sc.Model(forms, np.zeros(0, int)).run(stages, progress=False)
        force = support(forms, result[-1])[0].sum(axis=0)
        exact = weight * np.array([np.sin(np.radians(angle)), np.cos(np.radians(angle))])
        np.testing.assert_allclose(force, exact, rtol=1e-6)
        return
    with pytest.raises(
        sc.NotConverged, match=r"stage 'tilt' stopped at .*% of its load.* can move without force"
    ) as e:
        sc.Model(forms, np.zeros(0, int), newton=QUICK).run(stages, progress=False)
    # increments are cut down to 1/1024 of a stage
    assert e.value.result[-1].fraction == pytest.approx(mu / np.tan(np.radians(angle)), abs=2e-3)


# -- D6: off the edge of a table

BLOCK = "block"


def table(kind: str, quadrature) -> tuple[dict, np.ndarray, int]:
    """A unit block, 5 heavy, at the edge x = 0 of a table: forms, fixed unknowns and the one that
    drags.
    """
    meshes = {BLOCK: grid("Q1", np.linspace(-1, 0, 9), np.linspace(0, 0.5, 5))}
    materials = {BLOCK: sc.LinearElastic(E=1e5, nu=0.2)}
    if kind == "elastic":
        meshes["table"] = grid("Q1", np.linspace(-3, 0, 16), np.linspace(-1, 0, 6))
        materials["table"] = sc.LinearElastic(E=1e7, nu=0.2)
    basis = vector_basis(sc.join_bodies(meshes), "Q1")
    master, held = "table:top", np.zeros(0, int)
    if kind == "elastic":
        held = basis.get_dofs("table:bottom").all()
    else:
        edge = [(-4.0, 0.0), (0.0, 0.0)] + ([(0.0, -2.0)] if kind == "corner" else [])
        master = sc.rigid.polyline(edge)
    drag = dofs_at(basis, BLOCK, (-1.0, 0.0))[0]
    forms = {
        "bodies": sc.SolidForm(basis, materials),
        "floor": sc.ContactPair(basis, "block:bottom", master, sc.Coulomb(0.2), quadrature),
    }
    return forms, np.union1d(held, drag), int(drag)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "quadrature"),
    [("line", "nodal"), ("line", 4), ("corner", "nodal"), ("elastic", "nodal")],
)
def test_off_the_edge(kind: str, quadrature) -> None:
    """[X] D6: the table carries W below the centroid until that passes the edge; then nothing holds
    the block.

    Friction and drag act at the same height, so that the support's resultant lies below the
    centroid.  A table that is a single line of length 4 ends where one of many facets does: no node
    beyond the edge is carried.
    """
    forms, fixed, drag = table(kind, quadrature)
    basis = forms["bodies"].basis
    weight = sc.weight(basis, {BLOCK: 10.0})
    stages = [sc.Stage("rest", weight)]
    for way in (0.2, 0.4, 0.6):
        x = basis.zeros()
        x[drag] = way
        stages.append(sc.Stage(f"{way:.1f}", weight, x))
    with pytest.raises(sc.NotConverged, match=r"stage '0\.6' stopped at .*% of its load") as error:
        sc.Model(forms, fixed, newton=QUICK).run(stages, progress=False)
    result = error.value.result
    for stage in result:
        force, place = support(forms, stage)
        assert force[:, 1].sum() == pytest.approx(5.0, rel=1e-6)
        assert force[:, 1] @ (place[:, 0] + 0.5) == pytest.approx(0.0, abs=1e-6)
        joint = stage.tractions("floor")
        # an open end goes on for 5 % of a segment of the block
        assert (joint.x[joint.pressure > 0] + stage.x[drag] < 0.05 / 8 + 1e-4).all()
        # friction slides once the stick's elastic slip is used up; an elastic table's surface is
        # bent a little
        assert stage.name == "rest" or force[:, 0].sum() == pytest.approx(-1.0, rel=1e-3)
    # the last point of a rule lies up to half a segment before the edge, or in the 5 % beyond it
    assert result[-1].x[drag] == pytest.approx(0.5, abs=0.5 / 8)
