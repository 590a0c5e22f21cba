"""Steps that are too short for the elements beside a drain."""

from __future__ import annotations

import re
import warnings

import numpy as np
import pytest
from scipy.linalg import solve_banded
from skfem import Basis, ElementTriP2, ElementVector, MeshTri

import skfem_contact as sc
from tests.tools.scenes import layer_with_water, remarked


@pytest.mark.parametrize("waters", [1, 2])
@pytest.mark.parametrize(
    ("part", "told", "size"),
    [
        (5e-5, False, 0.2),
        (5e-3, True, 10.0),
        (5e-3, True, 0.2),
        (0.55, True, 0.2),
        (1.01, False, 0.2),
    ],
)
def test_elements_beside_an_inner_drain(part, told, size, waters):
    """[X] 0 <= p <= q in a column; while h² / 3 c_v of the first element beside drained sand lasts,
    p exceeds q.

    Before, in a time that the sand's pressures need as well, it does not, and there is no remark.
    The sand may have a water of its own.
    """
    q, k = 100.0, 1e-6
    mesh = MeshTri.init_tensor(np.array([0.0, 1.0]), np.linspace(-4.0, 10.0, 15)).scaled(size)
    mesh = mesh.with_defaults()
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
    limit = size**2 / 3 / (5e3 * k / 10.0)
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


def settled(layers, duration, load, cells=600, steps=400):
    """Return the settlement of layers (height, permeability, compressibility), drained at the top,
    under a load that grows evenly: finite volumes in 1D, steps of first order.
    """
    height = sum(layer[0] for layer in layers) / cells
    middles = (np.arange(cells) + 0.5) * height
    number = np.searchsorted(np.cumsum([layer[0] for layer in layers]), middles)
    _, k, compressible = np.transpose(layers)[:, number]
    # Flow between the middles of cells, and out of the last one; the unit weight of water is 10.
    flow = np.append(2.0 / (1.0 / k[1:] + 1.0 / k[:-1]), 2.0 * k[-1]) / (10.0 * height)
    step = duration / steps
    stored = compressible * height / step
    bands = np.zeros((3, cells))
    bands[1] = stored + flow + np.append(0.0, flow[:-1])
    bands[0, 1:] = bands[2, :-1] = -flow[:-1]
    p = np.zeros(cells)
    for _ in range(steps):
        p = solve_banded((1, 1), bands, stored * (p + load / steps))
    return (compressible * height * (load - p)).sum()


@pytest.mark.parametrize(
    ("ratio", "layer", "part", "told"),
    [
        (4.0, 0.05, 0.3, True),
        (10.0, 0.02, 0.05, True),
        (30.0, 0.05, 0.15, True),
        (99.0, 0.02, 0.6, True),
        (99.0, 0.02, 1.5, False),
        (1.0, 0.1, 0.6, False),
    ],
)
def test_elements_beside_a_thin_drained_layer(ratio, layer, part, told):
    """[X] Two layers by finite volumes: elements that are thicker than the drained layer beside
    them settle too much, by up to what the remark tells.
    """
    k, compressible, size = 1e-4, 1e-4, 0.2
    duration = part * size**2 / 3 / (k / compressible / 10.0)
    layers = [(1.0, k, compressible), (layer, ratio * k, compressible)]
    mesh = MeshTri.init_tensor(np.array([0.0, 0.1]), np.append(np.linspace(0, 1, 6), 1 + layer))
    mesh = mesh.with_defaults().with_subdomains(
        {"clay": lambda x: x[1] < 1, "silt": lambda x: x[1] > 1}
    )
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    soil = sc.SolidForm(basis, sc.LinearElastic(E=1.0 / compressible, nu=0.0))
    water = sc.PoreWater(basis, {"clay": k, "silt": ratio * k}, unit_weight=10.0)
    fixed = [sc.box_supports(basis, base="rollers"), water.dofs("top")]
    load = sc.traction(basis, "top", (0.0, -100.0))
    forms = {"soil": soil, "water": water}
    stage, text = remarked(forms, sc.Stage("load", load, duration=duration), fixed)
    settlement = -stage.x[basis.get_dofs("top").all("u^2")].mean()
    error = settlement / settled(layers, duration, 100.0) - 1.0
    estimates = re.findall(r"settlement since its start may be up to (\d+)% too large", text)
    assert len(estimates) == told and (error > 0.15) == told
    assert all(0.9 * error < float(value) / 100 < 1.5 * error for value in estimates)
