"""Blocks on inclines stand, slide and stick as Coulomb's law says."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest
from skfem import (
    Basis,
    ElementHex1,
    ElementQuad1,
    ElementVector,
    MeshHex,
    MeshQuad,
)

import skfem_contact as sc
from skfem_contact.collapse import mechanism
from skfem_contact.collapse.mechanism import as_collapse
from tests.fuzz.blocks import Stack

QUIET = {"progress": False}


def test_forms_of_any_name_resist_a_motion():
    """[X] A block that a form named "springs" holds: a failure beside it is no mechanism."""
    basis = Basis(MeshQuad().with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    held = sc.Spring(basis, (0.0, 0.0), (10.0, 10.0)), sc.Spring(basis, (1.0, 0.0), (10.0, 10.0))
    block = sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.0))
    model = sc.Model({"block": block, "springs": held[0], "others": held[1]})
    system = model.checked_system(model.forms, model.fixed)
    states = {name: form.initial_state() for name, form in model.forms.items()}
    error = sc.NotConverged("no equilibrium")
    load = sc.weight(basis, 1.0)
    assert (
        as_collapse(error, system, basis.zeros(), states, load, sc.Newton(tolerance=1e-4)) is error
    )


@pytest.mark.parametrize("failures", [0, 1, 20])
def test_motion_of_a_free_block(failures, monkeypatch):
    """[X] Nothing but springs resists the weight of a block in the air, whether the softest springs
    are reached at once or one by one; where none is reached nothing is known.
    """
    basis = Basis(MeshQuad().with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    block = sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.0))
    floor = sc.rigid.line((-5.0, -0.3), (5.0, -0.3))
    joint = sc.ContactPair(basis, "bottom", floor, sc.Coulomb(0.0), penalty=1e3)
    model = sc.Model({"block": block, "joint": joint})
    system = model.checked_system(model.forms, model.fixed)
    states = {name: form.initial_state() for name, form in model.forms.items()}
    error = sc.NotConverged("no equilibrium")
    steps = itertools.count()
    whole = mechanism.Step

    def step(*arguments, **named):
        if next(steps) < failures:
            raise error
        return whole(*arguments, **named)

    monkeypatch.setattr(mechanism, "Step", step)
    newton = sc.Newton(tolerance=1e-4)
    found = as_collapse(error, system, basis.zeros(), states, -sc.weight(basis, 1.0), newton)
    if failures == 20:
        assert next(steps) == 2  # one with the softest springs, one with the stiffest
        assert found is error
    else:
        assert isinstance(found, sc.NoEquilibrium)
        assert "only springs would resist 100.0% of the load" in str(found)


@pytest.mark.parametrize(
    "degrees, stands", [(9.5, True), (9.99, True), (10.01, False), (10.5, False), (30.1, False)]
)
def test_block_that_slides_is_not_stable(degrees, stands):
    """[X] A block on an incline stands below the friction angle of 10 degrees and slides above."""
    block = MeshQuad.init_tensor(np.linspace(0, 4, 9), np.linspace(0, 1, 9)).with_defaults()
    basis = Basis(sc.join_bodies({"block": block}), ElementVector(ElementQuad1()), intorder=2)
    joint = sc.ContactPair(
        basis,
        "block:bottom",
        sc.rigid.line((-50.0, 0.0), (50.0, 0.0)),
        sc.Coulomb(mu=np.tan(np.radians(10.0))),
    )
    model = sc.Model(
        {"block": sc.SolidForm(basis, sc.LinearElastic(E=1e6, nu=0.2)), "joint": joint}
    )
    angle = np.radians(degrees)
    assert (
        model.is_stable(sc.weight(basis, 1.0, direction=(np.sin(angle), -np.cos(angle)))) is stands
    )


def test_mechanism_of_a_block_that_slides(recwarn):
    """[X] An elastic block on an incline of 20 degrees: mu over tan 20, all of it moves alike, no
    mesh adds to it.
    """
    base = MeshQuad.init_tensor(np.linspace(0, 6, 13), np.linspace(-1, 0, 3)).with_defaults()
    block = MeshQuad.init_tensor(np.linspace(2, 4, 6), np.linspace(0, 1, 4)).with_defaults()
    basis = Basis(
        sc.join_bodies({"base": base, "block": block}), ElementVector(ElementQuad1()), intorder=2
    )
    bodies = sc.SolidForm(
        basis, sc.LinearElastic(E=1e5, nu=0.2), unit_weight={"base": 0.0, "block": 20.0}
    )
    joint = sc.ContactPair(basis, "block:bottom", "base:top", sc.Coulomb(mu=0.6), penalty=1e7)
    angle = np.radians(20.0)
    model = sc.Model(
        {"bodies": bodies, "joint": joint},
        basis.get_dofs("base:bottom").all(),
        gravity=(np.sin(angle), -np.cos(angle)),
    )
    found = model.strength_reduction(**QUIET)
    assert found.factor == pytest.approx(0.6 / np.tan(angle), abs=0.01)
    moved = found.mechanism[np.unique(basis.element_dofs[:, basis.mesh.subdomains["block"]])]
    assert np.allclose(
        np.sort(moved), np.repeat((0.0, 1.0), len(moved) // 2), atol=1e-4
    )  # of the penalty: 1e-7
    assert found.added == 0.0 and not recwarn.list


def test_mesh_adds_nothing_to_a_block_that_slides_in_space(recwarn):
    """[X] F = (c A + W cos b tan phi) / (W sin b): the joint takes the power of the weight, of
    which elastic strains of the block are a small share.
    """
    slope, phi = np.radians((25.0, 35.0))
    c = 2.0
    unit = np.linspace(0, 1, 4)
    base = MeshHex.init_tensor(4 * unit, 3 * unit, [0.0, 1.0]).with_boundaries(
        {"bottom": lambda x: x[2] == 0.0, "top": lambda x: x[2] == 1.0}
    )
    block = MeshHex.init_tensor(1 + 2 * unit, 0.5 + 2 * unit, [1.0, 1.5, 2.0]).with_boundaries(
        {"bottom": lambda x: x[2] == 1.0}
    )
    mesh = sc.join_bodies({"base": base, "block": block})
    turn = [[np.cos(slope), 0, -np.sin(slope)], [0, 1, 0], [np.sin(slope), 0, np.cos(slope)]]
    mesh = replace(mesh, doflocs=np.array(turn) @ mesh.doflocs)
    basis = Basis(mesh, ElementVector(ElementHex1()), intorder=2)
    rock = sc.LinearElastic(E=1e6, nu=0.2)
    law = sc.Coulomb(mu=np.tan(phi), adhesion=c)
    forms = {
        "rock": sc.SolidForm(basis, rock, unit_weight={"base": 0.0, "block": 25.0}),
        "joint": sc.ContactPair(basis, "block:bottom", "base:top", law),
    }
    model = sc.Model(forms, basis.get_dofs("base:bottom").all())
    found = model.strength_reduction(tolerance=0.005, **QUIET)
    weight = 25.0 * 4.0
    exact = (c * 4.0 + weight * np.cos(slope) * np.tan(phi)) / (weight * np.sin(slope))
    assert abs(found.factor - exact) < 0.005
    assert 0.0 <= found.added < 0.005
    assert not [str(one.message) for one in recwarn if "too high" in str(one.message)]


def test_block_that_sticks_is_not_at_its_limit():
    """[X] A block that sticks on a slope does no work until its friction is used up: tan(phi) over
    tan(slope).
    """
    drawn = Stack(1.3122, (0.7586,), (0.6446,), float(np.radians(21.9)), "segments")
    found = drawn.model(2).strength_reduction(**QUIET)
    assert found.factor == pytest.approx(drawn.slides(), abs=0.01)
    assert found.stop.shows_limit
