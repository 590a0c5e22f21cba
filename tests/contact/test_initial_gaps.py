"""Gaps and overlaps of bodies at the start of a stage."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from skfem import (
    Basis,
    ElementTriP2,
    ElementVector,
    MeshQuad,
)

import skfem_contact as sc
from skfem_contact.contact.base import initial_clearance
from tests.fuzz.frames import as_drawn
from tests.fuzz.kinds import drawn
from tests.fuzz.model import build
from tests.tools.helpers import grid, vector_basis

QUIET = {"progress": False}


@pytest.mark.parametrize("initial", ["as meshed", "adjusted"])
def test_body_placed_on_settled_ground_does_not_overlap(initial, recwarn):
    """[X] A block of weight 40 on ground that has settled by .0155: its pressure, and no overlap of
    matching meshes.
    """
    mesh = (
        MeshQuad.init_tensor(np.linspace(0, 4, 17), np.linspace(0, 4, 17))
        .to_meshtri()
        .with_defaults()
    )
    mesh = mesh.with_subdomains({"base": lambda x: x[1] < 2, "block": lambda x: x[1] > 2})
    basis = Basis(
        sc.join_bodies(mesh, bodies={"ground": "base", "top": "block"}),
        ElementVector(ElementTriP2()),
        intorder=2,
    )
    base = sc.SolidForm(basis.with_elements("base"), sc.LinearElastic(1e4, 0.3), unit_weight=20.0)
    block = sc.SolidForm(basis.with_elements("block"), sc.LinearElastic(1e5, 0.3), unit_weight=20.0)
    joint = sc.ContactPair(
        basis, "ground|top", "top|ground", sc.Coulomb(0.5), quadrature=3, initial=initial
    )
    model = sc.Model(
        {"base": base, "block": block, "joint": joint},
        np.append(basis.get_dofs("bottom").all(), basis.get_dofs({"left", "right"}).all("u^1")),
    )
    push = sc.traction(basis, "ground|top", lambda x: (0 * x[0], -100.0 * (x[0] < 2)))
    start = sc.Model({"base": base}, model.fixed).gravity_state()
    stages = [sc.Stage("before", push), sc.Stage("placed", push, activate=["block", "joint"])]
    placed = model.run(stages, start=start, **QUIET)["placed"]
    np.testing.assert_allclose(
        placed.tractions("joint").pressure, 40.0, rtol=0.02
    )  # the mesh has 16 elements a side
    assert not [warning for warning in recwarn if "overlap" in str(warning.message)]


def test_adjusted_surfaces_touch_up_to_half_a_facet_apart() -> None:
    """Gaps of the mesh above half of the slave's facets are kept, and all gaps as meshed."""
    gap = np.array([-0.52, -0.49, 0.0, 0.49, 0.52])
    size = np.ones(5)
    apart = initial_clearance(gap, gap, size, "adjusted", bonded=False)
    np.testing.assert_array_equal(apart, [0.0, -0.49, 0.0, 0.49, 0.0])
    np.testing.assert_array_equal(initial_clearance(gap, gap, size, "as meshed", False), 0.0)


@pytest.mark.parametrize(
    ("gap", "told"),
    [
        (-0.2, "lies inside"),
        (-0.05, "lies inside"),
        (-0.01, None),
        (0.05, "starts 0.05 away"),
        (0.01, None),
    ],
)
def test_block_that_does_not_touch_in_the_mesh(gap, told, recwarn):
    """A block with facets of .33 m that lies inside the ground or above it, by a quarter or a tenth
    of them.
    """
    base = grid("Q1", np.linspace(-2, 3, 11), np.linspace(-2, 0, 5))
    block = grid("Q1", np.linspace(0, 1, 4), np.linspace(gap, 1 + gap, 4))
    basis = vector_basis(sc.join_bodies({"base": base, "block": block}), "Q1", intorder=2)
    forms = {
        "bodies": sc.SolidForm(basis, sc.LinearElastic(E=1e5, nu=0.3), unit_weight=20.0),
        "joint": sc.ContactPair(basis, "block:bottom", "base:top", sc.Coulomb(mu=0.3)),
    }
    sc.Model(forms, basis.get_dofs("base:bottom").all()).run([sc.Stage("weight")], **QUIET)
    text = " ".join(str(warning.message) for warning in recwarn)
    assert told in text if told else not text


def test_gaps_between_nodes_that_multipliers_leave(recwarn):
    """[X] A block of 2 x 2 facets on 2 x 2 others: a start with a harder penalty moves it by 4 %,
    which both tell.
    """
    results = []
    for increments in (1, 3):
        model = build(drawn(11000469), as_drawn(3))
        recwarn.clear()
        results.append(model.run([replace(model.stages[0], increments=increments)])[-1].x)
        told = [warning for warning in recwarn if "gapes or penetrates" in str(warning.message)]
        assert told
    assert np.abs(results[0] - results[1]).max() > 0.03 * np.abs(results[1]).max()
