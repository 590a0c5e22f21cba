"""Water under tight blocks and beside bonded beams."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from skfem import Basis, ElementTriP2, ElementVector, MeshTri

import skfem_contact as sc


@pytest.mark.parametrize(("pressure", "told"), [(20.0, False), (40.0, True)])
def test_water_under_a_tight_block(pressure, told):
    """[X] Water that presses more than a block weighs, 24, lifts it; where tight contact holds the
    total it is told.
    """
    mesh = sc.join_bodies(
        {
            "bed": MeshTri.init_tensor(np.linspace(0, 2, 9), np.linspace(-1, 0, 5)).with_defaults(),
            "cap": MeshTri.init_tensor(np.linspace(0, 2, 7), np.linspace(0, 1, 4)).with_defaults(),
        }
    )
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    water = sc.PoreWater(basis.with_elements("bed"), permeability=1e-3, unit_weight=1.0)
    forms = {
        "bodies": sc.SolidForm(basis, sc.LinearElastic(E=1e5, nu=0.2)),
        "water": water,
        "joint": sc.ContactPair(
            basis, slave="cap:bottom", master="bed:top", law=sc.Coulomb(mu=0.3)
        ),
    }
    sides = basis.get_dofs({"bed:left", "bed:right", "cap:left", "cap:right"}).all("u^1")
    model = sc.Model(forms, [basis.get_dofs("bed:bottom").all(), sides, water.dofs("bed:bottom")])
    own, given = (
        sc.weight(basis, {"cap": 24.0}),
        model.forms["water"].prescribed({"bed:bottom": pressure}),
    )
    stages = [
        sc.Stage("weight", own, duration=1e3),
        sc.Stage("water", own, prescribed=given, duration=1e4),
    ]
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        model.run(stages, progress=False)
    text = "under 'joint' the water presses with up to 40, and contact transfers 24 there in total"
    assert any(text in str(w.message) for w in caught) == told


@pytest.mark.parametrize(("line", "told"), [("inner", True), ("top", False), ("slit", False)])
def test_water_passes_through_a_bonded_beam(line, told):
    """A wall that shares nodes with porous ground on both sides is no boundary of its water, one in
    a slit is.
    """
    mesh = (
        MeshTri.init_tensor(np.linspace(0, 4, 5), np.linspace(-4, 0, 5))
        .with_defaults()
        .with_boundaries({"inner": lambda x: (x[0] == 2) & (x[1] > -2)}, boundaries_only=False)
    )
    mesh = sc.split_along(mesh, "inner") if line == "slit" else mesh
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    wall = sc.Beam(
        basis, "inner|left" if line == "slit" else line, EI=1e3, EA=1e6, bonded=line != "slit"
    )
    water = sc.PoreWater(basis, 1e-3, unit_weight=9.81)
    forms = {
        "clay": sc.SolidForm(basis, sc.LinearElastic(E=8e3, nu=0.3)),
        "wall": wall,
        "water": water,
    }
    if line == "slit":
        forms |= wall.contact(basis, sc.Coulomb(mu=0.3))
    model = sc.Model(forms, [sc.box_supports(basis), water.dofs("right")])
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        model.run(
            [sc.Stage("load", model.traction("left", (5.0, 0.0)), duration=1.0)], progress=False
        )
    assert any("water passes through 'wall'" in str(w.message) for w in caught) == told
