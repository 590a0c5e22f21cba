"""Contact pairs that do not belong to the model."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from skfem import MeshTri

import skfem_contact as sc
from tests.tools.helpers import vector_basis
from tests.tools.scenes import halves

ELASTIC = sc.LinearElastic(E=1e4, nu=0.3)


def test_pair_of_another_mesh_is_named():
    basis, other = halves(), vector_basis(halves().mesh, "Q2")
    joint = sc.ContactPair(other, "l:right", "r:left", sc.Tied())
    with pytest.raises(ValueError, match=r"different bases.*<ContactPair l:right on r:left"):
        sc.Model(
            {"both": sc.SolidForm(basis, ELASTIC), "joint": joint}, basis.get_dofs("l:bottom").all()
        )


def test_slit_with_inner_tips_touches_without_the_facets_at_them():
    """Sides that meet at the tips are refused, unlike welded bodies: without the facets there the
    slit of a pressed block is closed, as the message says.
    """
    line = np.linspace(0, 1, 17)
    level = {"slit": lambda x: (x[1] == 0.5) & (abs(x[0] - 0.5) < 0.3)}
    mesh = MeshTri.init_tensor(line, line).with_boundaries(level, False).with_defaults()
    mesh = sc.split_along(mesh, "slit")
    above = mesh.boundaries["slit|above"]
    middle = mesh.p[0, mesh.facets[:, above]].mean(axis=0)
    mesh = replace(mesh, _boundaries={**mesh.boundaries, "inner": above[abs(middle - 0.5) < 0.25]})
    basis = vector_basis(mesh, "P2")
    advice = r"share 2 nodes, as at \(0.1875, 0.5\).*the facets there out.*tips of a slit"
    with pytest.raises(ValueError, match=advice):
        sc.ContactPair(basis, "slit|above", "slit|below", sc.Coulomb())

    forms = {
        "block": sc.SolidForm(basis, ELASTIC),
        "slit": sc.ContactPair(basis, "inner", "slit|below", sc.Coulomb()),
    }
    fixed = [basis.get_dofs("bottom").all("u^2"), basis.get_dofs("left").all("u^1")]
    model = sc.Model(forms, fixed)
    load = model.traction("top", (0.0, -1.0))
    found = model.run([sc.Stage("pressed", load)], progress=False)["pressed"].tractions("slit")
    # the facets at the tips are open: their pressure, a fifth, acts on both sides of them
    assert found.pressure.min() > 0.5
    assert found.pressure @ found.weight == pytest.approx(0.625, rel=0.15)


def test_surfaces_with_common_facets_are_one_that_folds():
    sides = {"skin": lambda x: x[0] < 2, "top": lambda x: x[1] == 1.0}
    mesh = MeshTri().refined(2).with_boundaries(sides)
    with pytest.raises(ValueError, match=r"share 9 nodes.*give the whole boundary .* as both"):
        sc.ContactPair(vector_basis(mesh, "P2"), "top", "skin", sc.Coulomb())


@pytest.mark.parametrize("enforcement", [None, sc.AugmentedLagrangian(), sc.DualMultipliers()])
@pytest.mark.parametrize("turned", [False, True])
def test_two_pairs_of_the_same_facets_are_refused(enforcement, turned):
    """They had twice the adhesion: a block was pushed with 29.2 instead of 21.9."""
    basis = halves()
    sides = ("l:right", "r:left")
    method = {"enforcement": enforcement}
    forms = {
        "both": sc.SolidForm(basis, ELASTIC),
        "one": sc.ContactPair(basis, *sides, sc.Coulomb(0.3, adhesion=5.0), **method),
        "two": sc.ContactPair(basis, *sides[:: -1 if turned else 1], sc.Coulomb(), **method),
    }
    model = sc.Model(forms, basis.get_dofs("l:bottom").all())
    message = "'one' and 'two' are contact of the same facets: stiffness, adhesion"
    with pytest.raises(ValueError, match=message):
        model.run([sc.Stage("rest")], progress=False)
    # one after the other they may act
    model.run([sc.Stage("rest", deactivate="two")], progress=False)


def test_two_pairs_of_the_same_facets_are_refused_in_motion():
    basis = halves()
    forms = {
        "both": sc.SolidForm(basis, ELASTIC, unit_weight=20.0),
        "one": sc.ContactPair(basis, "l:right", "r:left", sc.Coulomb(0.3, adhesion=5.0)),
        "two": sc.ContactPair(basis, "l:right", "r:left", sc.Coulomb()),
    }
    model = sc.Model(forms, basis.get_dofs("l:bottom").all(), gravity_acceleration=9.81)
    stage = sc.Stage("shaken", duration=1.0, dynamic=sc.Dynamic(0.1))
    with pytest.raises(ValueError, match=r"stage 'shaken': .*contact of the same facets"):
        model.run([stage], progress=False)


def test_two_passes_with_half_of_the_work_each_are_accepted():
    basis = halves()
    forms = {
        "both": sc.SolidForm(basis, ELASTIC),
        "one": sc.ContactPair(basis, "l:right", "r:left", sc.Tied(), share=0.5),
        "two": sc.ContactPair(basis, "r:left", "l:right", sc.Tied(), share=0.5),
    }
    model = sc.Model(forms, basis.get_dofs("l:bottom").all())
    load = model.traction("r:right", (1.0, 0.0))
    pulled = model.run([sc.Stage("pull", load)], progress=False)["pull"]
    total = pulled.contact("one").force - pulled.contact("two").force
    np.testing.assert_allclose(abs(total), [1.0, 0.0], atol=1e-6)
