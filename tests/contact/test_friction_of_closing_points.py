"""Friction of points that close and slide in one increment."""

from __future__ import annotations

import warnings
from types import SimpleNamespace

import numpy as np
import pytest
from skfem import (
    Basis,
    ElementQuad1,
    ElementVector,
    MeshQuad,
)

import skfem_contact as sc
from skfem_contact.contact.diagnosis import _on_closing
from skfem_contact.contact.laws import Status
from tests.tools.helpers import grid, vector_basis


@pytest.mark.parametrize("quadrature", ["nodal", 2, "segments"])
def test_friction_of_points_that_have_just_closed(quadrature) -> None:
    """[X] mu N = 12 on the sliding block's points; those of the base close ahead of it, which is
    told.
    """
    bodies = {
        "base": grid("Q1", np.linspace(0, 4, 17), [-0.5, -0.25, 0.0]),
        "block": grid("Q1", np.linspace(1, 2, 6), [0.0, 0.25, 0.5]),
    }
    basis = vector_basis(sc.join_bodies(bodies), "Q1", intorder=2)
    top = basis.get_dofs("block:top").all("u^1")
    fixed, load, moved = (
        np.append(basis.get_dofs("base:bottom").all(), top),
        basis.zeros(),
        basis.zeros(),
    )
    load[basis.get_dofs("block:top").all("u^2")] = -40.0 / 6
    moved[top] = 0.8
    pulls = []
    for sides in (("block:bottom", "base:top"), ("base:top", "block:bottom")):
        solid = sc.SolidForm(basis, sc.LinearElastic(E=1e5, nu=0.2))
        forms = {
            "solid": solid,
            "joint": sc.ContactPair(basis, *sides, sc.Coulomb(0.3), quadrature),
        }
        held = sc.Model(forms, fixed).run([sc.Stage("press", load)], progress=False)
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            slid = sc.Model(forms, fixed).run(
                [sc.Stage("pull", load, moved, 2)], start=held, progress=False
            )["pull"]
        told = any("have only just closed" in str(warning.message) for warning in caught)
        pulls.append((abs(slid.contact("joint").force[0]), told))
    assert pulls[0][0] == pytest.approx(12.0, rel=1e-3) and not pulls[0][1]
    assert pulls[1][0] < 11.0 and pulls[1][1]


QUIET = {"progress": False}


def pressed_parabola(increments, n=20, far=40.0, radius=20.0):
    """Width that sticks over the width of contact of a rigid parabola that is pressed into a block,
    from a gap.
    """

    def graded(fine):
        count = int(np.ceil(np.log1p((far - fine) * 0.3 / (1.3 / n)) / np.log(1.3)))
        steps = np.cumsum(1.3 ** np.arange(count))
        return np.r_[
            np.linspace(0, fine, round(fine * n) + 1), fine + steps * (far - fine) / steps[-1]
        ]

    block = MeshQuad.init_tensor(graded(1.3), -graded(0.3)[::-1]).with_boundaries(
        {
            "near": lambda x: np.isclose(x[1], 0) & (x[0] < 1.7),
            "low": lambda x: np.isclose(x[1], -far),
            "left": lambda x: np.isclose(x[0], 0),
        }
    )
    basis = Basis(sc.join_bodies({"b": block}), ElementVector(ElementQuad1()), intorder=2)
    x = np.linspace(2.5, -2.5, 401)
    law = sc.Coulomb(mu=0.3)
    forms = {
        "b": sc.SolidForm(basis, sc.LinearElastic(E=1000.0, nu=0.0)),
        "c": sc.ContactPair(basis, "b:near", sc.rigid.polyline(np.c_[x, x**2 / (2 * radius)]), law),
    }
    lifted = basis.zeros()
    lifted[basis.get_dofs("b:low").all("u^2")] = 0.5 * (2 * np.log(2 * far) - 1) / (2 * radius)
    fixed = np.append(basis.get_dofs("b:low").all(), basis.get_dofs("b:left").all("u^1"))
    run = sc.Model(forms, fixed).run(
        [sc.Stage("down", prescribed=lifted, increments=increments)], **QUIET
    )
    found = run["down"].tractions("c")
    slides = (found.status == Status.SLIP) & (found.pressure > 0)
    return found.x[slides].min() / found.x[found.pressure > 0].max()


@pytest.mark.slow
def test_friction_of_points_that_close_and_slide_in_one_increment(recwarn):
    """[N] Nothing slides before it touches; one increment counts such motion, 20 count little: .24
    as with 60.
    """
    told = []
    sticks = []
    for increments in (1, 20):
        recwarn.clear()
        sticks.append(pressed_parabola(increments))
        told.append(
            any(
                "take more increments, with which this share falls" in str(w.message)
                for w in recwarn
            )
        )
    assert sticks[0] < 0.6 * sticks[1]
    assert sticks[1] == pytest.approx(0.24, abs=0.02)  # a point in 60 of the half-width
    assert told == [True, False]


@pytest.mark.parametrize("across", [0.0, 0.002, 1.0])
def test_friction_of_bodies_that_touch_from_the_start(across, recwarn):
    """Bodies that touch in the mesh, and those that slide far, are not told to take more
    increments.
    """
    base = MeshQuad.init_tensor(np.linspace(0, 4, 17), np.linspace(0, 1, 5)).with_defaults()
    block = MeshQuad.init_tensor(np.linspace(1, 2, 9), np.linspace(1, 2, 9)).with_defaults()
    basis = Basis(
        sc.join_bodies({"base": base, "block": block}), ElementVector(ElementQuad1()), intorder=2
    )
    joint = sc.ContactPair(basis, "block:bottom", "base:top", sc.Coulomb(mu=0.3))
    model = sc.Model(
        {"bodies": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3)), "joint": joint},
        basis.get_dofs({"base:bottom", "block:top"}).all(),
    )
    moved = basis.zeros()
    moved[basis.get_dofs("block:top").all("u^2")] = -0.005
    moved[basis.get_dofs("block:top").all("u^1")] = across
    run = model.run([sc.Stage("pressed", prescribed=moved)], **QUIET)
    assert np.abs(run["pressed"].tractions("joint").shear).max() > 0.0
    assert not any("more increments" in str(warning.message) for warning in recwarn)


@pytest.mark.parametrize(("slips", "told"), [(1.0, True), (10.0, False)])
def test_points_that_slide_far_may_have_closed_on_the_way(slips: float, told: bool) -> None:
    """Slips of ten times the elastic displacement of the bodies leave no part that sticks, wherever
    the bodies are.
    """
    points = SimpleNamespace(weight=np.ones(3), positions=lambda nodes: nodes)
    nodes = np.array([[30.0, -40.0], [31.0, -40.0], [32.0, -40.0]])
    pair = SimpleNamespace(
        stiffness=2.0,
        slave=SimpleNamespace(name="foot", nodes=nodes, spacing=1.0),
        points=lambda state: points,
    )
    slip = np.full((1, 3), slips)  # elastic displacement: 1 * 2 / (2 * 1)
    state = SimpleNamespace(
        traction=np.array([[-3.0, -3.0, -3.0], [1.0, 1.0, 1.0]]),
        slip=slip,
        closing_slip=slip[0],
        status=np.full(3, Status.SLIP),
    )
    remarks = list(_on_closing(pair, state))
    assert [remark.kind for remark in remarks] == ["closing"] * told
