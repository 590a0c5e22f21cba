"""Steps that are too short for the elements beside a drain."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from skfem import Basis, ElementTriP2, ElementVector, MeshTri

import skfem_contact as sc
from tests.tools.scenes import layer_with_water


@pytest.mark.parametrize("waters", [1, 2])
@pytest.mark.parametrize(
    ("part", "told"), [(5e-5, False), (5e-3, True), (0.55, True), (1.01, False)]
)
def test_elements_beside_an_inner_drain(part, told, waters):
    """[X] 0 <= p <= q in a column; while h² / 3 c_v of the first element beside drained sand lasts,
    p exceeds q.

    Before, in a time that the sand's pressures need as well, it does not, and there is no remark.
    The sand may have a water of its own.
    """
    q, k = 100.0, 1e-6
    mesh = MeshTri.init_tensor(np.array([0.0, 0.2]), np.linspace(-0.8, 2.0, 15)).with_defaults()
    mesh = mesh.with_subdomains({"clay": lambda x: x[1] > 0, "sand": lambda x: x[1] < 0})
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=4)
    forms = {"soil": sc.SolidForm(basis, sc.LinearElastic(E=5e3, nu=0.0))}
    if waters == 1:
        forms["water"] = drain = sc.PoreWater(basis, {"clay": k, "sand": 1e4 * k}, unit_weight=10.0)
    else:
        forms["water"] = sc.PoreWater(basis.with_elements("clay"), k, unit_weight=10.0)
        forms["sand's"] = drain = sc.PoreWater(
            basis.with_elements("sand"), 1e4 * k, unit_weight=10.0
        )
    model = sc.Model(forms, [sc.box_supports(basis, base="rollers"), drain.dofs("bottom")])
    limit = 0.2**2 / 3 / (5e3 * k / 10.0)
    stage = sc.Stage("load", sc.traction(basis, "top", (0.0, -q)), duration=part * limit)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        stage = model.run([stage], progress=False)["load"]
    inside = mesh.p[1] > -1e-9
    assert (stage.forms["water"].pressure(stage.x)[inside].max() > 1.05 * q) == told
    # in the shortest time the sand's own elements at its drained bottom are not resolved
    assert any(f"h² / 3 c_v = {limit:.3g}" in str(w.message) for w in caught) == told


@pytest.mark.parametrize(("part", "told"), [(0.3, True), (1.01, False)])
def test_elements_beside_a_seepage_face(part, told):
    """[X] 0 <= p <= q in a column that drains by a seepage face: before h² / 3 c_v of its elements
    p exceeds q.
    """
    basis, clay, water = layer_with_water()
    forms = {"clay": clay, "water": water, "face": sc.water.SeepageFace(water, "top", 0.0)}
    model = sc.Model(forms, sc.box_supports(basis, base="rollers"))
    limit = 0.25**2 / 3 / (8e3 * 0.7 / 1.3 / 0.4 * 2e-4 / 9.81)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        load = model.traction("top", (0.0, -50.0))
        stage = model.run([sc.Stage("load", load, duration=part * limit)], progress=False)["load"]
    assert (stage.forms["water"].pressure(stage.x).max() > 1.05 * 50.0) == told
    assert any(f"h² / 3 c_v = {limit:.3g}" in str(w.message) for w in caught) == told


@pytest.mark.parametrize(("outside", "told"), [(50.0, False), (49.0, False), (25.0, True)])
def test_short_steps_without_a_jump(outside, told):
    """[X] A reservoir that rises presses on the ground as much as its water does in the pores:
    nothing flows.
    """
    basis, clay, water = layer_with_water()
    model = sc.Model({"clay": clay, "water": water}, [sc.box_supports(basis), water.dofs("top")])
    given = model.forms["water"].prescribed({"top": outside})
    limit = 0.25**2 / 3 / (8e3 * 0.7 / 1.3 / 0.4 * 2e-4 / 9.81)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        load = model.traction("top", (0.0, -50.0))
        stage = model.run(
            [sc.Stage("rise", load, prescribed=given, duration=0.2 * limit)], progress=False
        )["rise"]
    excess = stage.forms["water"].pressure(stage.x).max() / 50.0 - 1.0
    assert (excess > 0.05) == told and (excess > 1e-9) == (outside < 50.0)
    remarks = [str(w.message) for w in caught if "elements beside drains" in str(w.message)]
    assert bool(remarks) == told and all(
        "changes of pressure may be up to 37% too large" in text for text in remarks
    )
