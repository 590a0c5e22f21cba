"""Undrained strengths by stress history."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import Basis, ElementQuad1, ElementVector, MeshQuad

import skfem_contact as sc


@pytest.fixture
def rest():
    """Ground of 4 m with water at its surface at rest, and its heights of elements."""
    mesh = MeshQuad.init_tensor(np.linspace(0, 2, 3), np.linspace(0, 4, 9)).with_defaults()
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    clay = sc.SolidForm(basis, sc.MohrCoulomb(E=1e4, nu=0.3, c=20.0, phi=30.0), unit_weight=18.0)
    model = sc.Model({"clay": clay}, sc.box_supports(basis), water_unit_weight=10.0)
    stage = model.k0_state(K0=0.6, water=4.0)["initial"]
    form = stage.forms["clay"]
    middle = mesh.p[1, mesh.t[:, form.elements]].mean(axis=0)
    return stage, 8.0 * (4.0 - middle)


def test_normally_consolidated_clay(rest):
    """[X] S times the buoyant overburden."""
    stage, vertical = rest
    found = stage.shansep("clay", S=0.22)["all"]
    assert np.allclose(found, 0.22 * vertical, rtol=1e-9)


def test_overconsolidation(rest):
    """[X] OCR^m, also as a function of the coordinates; POP of 10."""
    stage, vertical = rest
    found = stage.shansep("clay", S=0.25, m=0.85, OCR=3.0)["all"]
    assert np.allclose(found, 0.25 * vertical * 3.0**0.85, rtol=1e-9)
    by_depth = stage.shansep("clay", S=0.25, m=1.0, OCR=lambda x: 1.0 + 0.0 * x[0])["all"]
    assert np.allclose(by_depth, 0.25 * vertical, rtol=1e-9)
    # with m = 1 the strength is S (sigma_v + POP): exact
    removed = stage.shansep("clay", S=0.25, m=1.0, POP=10.0)["all"]
    assert np.allclose(removed, 0.25 * (vertical + 10.0), rtol=1e-9)
    tresca = sc.Tresca(E=1e4, nu=0.49, c=removed)
    changed = stage.forms["clay"].with_materials({"all": tresca})
    assert np.allclose(changed.materials["all"].c, removed)


def test_wrong_histories(rest):
    """One sentence each."""
    stage, _ = rest
    for given, message in (
        ({"S": 0.0}, "S and m must be positive"),
        ({"S": 0.2, "OCR": 0.5}, "OCR must be at least 1"),
        ({"S": 0.2, "POP": -5.0}, "POP must be at least 0"),
        ({"S": 0.2, "OCR": lambda x: np.nan * x[0]}, "finite"),
    ):
        with pytest.raises(ValueError, match=message):
            stage.shansep("clay", **given)


def test_gravity_along_another_axis_is_refused(rest) -> None:
    """Stresses along the last axis are not vertical where gravity acts along x."""
    stage, _ = rest
    basis = stage.forms["clay"].basis
    clay = sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3), unit_weight=18.0)
    model = sc.Model({"clay": clay}, basis.get_dofs("left").all(), gravity=(-1.0, 0.0))
    turned = model.run([sc.Stage("weight")], progress=False)["weight"]
    with pytest.raises(ValueError, match=r"shansep need gravity against the last axis, not \[-1"):
        turned.shansep("clay", S=0.25)
    upright = sc.Model({"clay": clay}, sc.box_supports(basis)).gravity_state()[-1]
    assert (upright.shansep("clay", S=0.25)["all"] > 0.0).all()
