"""Checks of walls and footings beside hand calculations."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import Basis, ElementQuad1, ElementVector, MeshQuad

import skfem_contact as sc
from skfem_contact.design import EC7, check

B, H, WEIGHT = 2.0, 3.0, 24.0


def wall(as_master=False, mu=0.5, adhesion=0.0, **options):
    """A wall of 2 by 3 on elastic ground: the model; the wall may be the master."""
    ground = MeshQuad.init_tensor(np.linspace(-2, 4, 13), np.linspace(-2, 0, 5)).with_defaults()
    body = MeshQuad.init_tensor(np.linspace(0, B, 9), np.linspace(0, H, 7)).with_defaults()
    mesh = sc.join_bodies({"ground": ground, "wall": body})
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    soils = {"ground": sc.LinearElastic(E=1e5, nu=0.3), "wall": sc.LinearElastic(E=1e7, nu=0.2)}
    solid = sc.SolidForm(basis, soils, unit_weight={"ground": 0.0, "wall": WEIGHT})
    sides = ("wall:bottom", "ground:top")
    law = sc.Coulomb(mu, adhesion=adhesion)
    pair = sc.ContactPair(
        basis, *(sides[::-1] if as_master else sides), law, enforcement=sc.AugmentedLagrangian()
    )
    fixed = sc.box_supports(basis, part="ground")
    return sc.Model({"solid": solid, "base": pair}, fixed, **options)


BASE = [(0.0, 0.0), (B, 0.0)]


@pytest.mark.parametrize("as_master", [False, True])
def test_a_thrust_on_the_back(as_master):
    """[X] Sliding, overturning and eccentricity of a triangular thrust of 10 z, by hand.

    The tolerance is that of equilibrium, 1e-4 of the forces, and of the tilt of the wall.
    """
    model = wall(as_master)
    load = model.traction("wall:right", lambda x: (-10.0 * (H - x[1]), 0.0 * x[1]))
    stage = model.run([sc.Stage("thrust", load)])["thrust"]
    found = check(stage, "wall", BASE)
    W = WEIGHT * B * H
    thrust = 10.0 * H**2 / 2
    overturning = thrust * H / 3
    assert np.isclose(found.vertical, W, rtol=1e-3)
    assert np.isclose(found.horizontal, thrust, rtol=1e-3)
    assert np.isclose(found.sliding, 0.5 * W / thrust, rtol=2e-3)
    assert np.isclose(found.overturning, W * B / 2 / overturning, rtol=2e-3)
    assert np.isclose(found.eccentricity, overturning / W, rtol=5e-3)
    assert np.isclose(found.effective_width, B - 2 * overturning / W, rtol=2e-3)
    assert np.isnan(found.bearing) and np.isnan(found.uplift)
    assert found.passes


def test_water_below_a_wall_overturns():
    """[X] The uplift of water overturns, and the whole weight stabilises, on every mesh."""
    model = wall(water_unit_weight=10.0)
    load = model.traction("wall:right", (-10.0, 0.0))
    stage = model.run([sc.Stage("thrust", load, water=1.5)])["thrust"]
    found = check(stage, "wall", BASE)
    overturning = 10.0 * H**2 / 2 + 10.0 * 1.5 * B * B / 2
    assert np.isclose(found.overturning_moment, overturning, rtol=2e-3)
    assert np.isclose(found.stabilising, WEIGHT * B * H * B / 2, rtol=2e-3)


def test_the_other_direction():
    """[X] A thrust to the right, with the toe on the right."""
    model = wall()
    load = model.traction("wall:left", (10.0, 0.0))
    stage = model.run([sc.Stage("thrust", load)])["thrust"]
    found = check(stage, "wall", BASE[::-1])
    assert np.isclose(found.horizontal, 30.0, rtol=1e-3)
    assert np.isclose(found.overturning, 144.0 / 45.0, rtol=2e-3)


@pytest.mark.parametrize("degrees", [-12.0, 7.0])
def test_inclined_base(degrees):
    """[X] A block on an incline of beta with a horizontal thrust T downhill, at half its height:
    W cos(beta) - T sin(beta) across the base, W sin(beta) + T cos(beta) along it.
    """
    beta = np.radians(degrees)
    turn = np.array([[np.cos(beta), -np.sin(beta)], [np.sin(beta), np.cos(beta)]])
    grid = MeshQuad.init_tensor(np.linspace(0, B, 9), np.linspace(0, 1, 5)).with_defaults()
    grid = MeshQuad(turn @ grid.p, grid.t).with_boundaries(grid.boundaries)
    basis = Basis(sc.join_bodies({"block": grid}), ElementVector(ElementQuad1()), intorder=2)
    block = sc.SolidForm(basis, sc.LinearElastic(E=1e7, nu=0.0), unit_weight=WEIGHT)
    plane = sc.rigid.line(turn @ [-1.0, 0.0], turn @ [3.0, 0.0])
    skin = sc.ContactPair(basis, "block:bottom", plane, sc.Coulomb(mu=0.5), penalty=1e9)
    model = sc.Model({"block": block, "skin": skin})
    # The toe is the lower end, and the thrust acts on the other side
    W, T = WEIGHT * B, 5.0
    toe, heel = turn @ [0.0, 0.0], turn @ [B, 0.0]
    push = model.traction("block:right", (-T, 0.0))
    if degrees < 0.0:
        toe, heel = heel, toe
        push = model.traction("block:left", (T, 0.0))
    stage = model.run([sc.Stage("thrust", push)])["thrust"]
    found = check(stage, "block", [tuple(toe), tuple(heel)])
    sine, cosine = np.sin(abs(beta)), np.cos(beta)
    vertical, horizontal = W * cosine - T * sine, W * sine + T * cosine
    moment = 0.5 * W * sine + T * (0.5 * B * sine + 0.5 * cosine)
    assert np.isclose(found.vertical, vertical, rtol=1e-4)
    assert np.isclose(found.horizontal, horizontal, rtol=1e-4)
    assert np.isclose(found.sliding, 0.5 * vertical / horizontal, rtol=1e-4)
    assert np.isclose(found.eccentricity, moment / vertical, rtol=1e-3)


def test_factors_and_adhesion():
    """[X] DA2*: effects times 1.35, sliding over 1.1; adhesion counts over the closed length."""
    model = wall(adhesion=2.0)
    load = model.traction("wall:right", (-5.0, 0.0))
    stage = model.run([sc.Stage("thrust", load)])["thrust"]
    found = check(stage, "wall", BASE, factors=EC7["DA2*"])
    resistance = 0.5 * 144.0 + 2.0 * B
    assert np.isclose(found.sliding, resistance / 1.1 / (1.35 * 15.0), rtol=2e-3)
    given = check(stage, "wall", BASE, factors=EC7["DA1-2"], friction=0.6)
    assert np.isclose(given.sliding, 0.6 / 1.25 * 144.0 / 15.0, rtol=2e-3)


def test_bearing():
    """[X] The resistance of the formula with the effective width and the inclined load."""
    model = wall()
    load = model.traction("wall:right", (-5.0, 0.0))
    stage = model.run([sc.Stage("thrust", load)])["thrust"]
    clay = sc.Tresca(E=1e4, nu=0.3, c=50.0)
    found = check(stage, "wall", BASE, factors=EC7["DA1-2"], ground=clay, surcharge=9.0)
    width = B - 2 * 22.5 / 144.0
    cu = 50.0 / 1.4
    i = 0.5 * (1 + np.sqrt(1 - 15.0 / (width * cu)))
    by_hand = ((np.pi + 2) * cu * i + 9.0) * width / 144.0
    assert np.isclose(found.bearing, by_hand, rtol=3e-3)
    assert found.table["check"].tolist() == ["sliding", "overturning", "bearing"]
    assert found.table() == found.table  # as a method of other results
    assert "yes" in str(found) and "<table>" in found._repr_html_()


def test_uplift():
    """[X] Pressure from below: 0.9 of the weight over the upward force."""
    model = wall()
    upward = model.traction("wall:top", (0.0, 30.0))
    stage = model.run([sc.Stage("uplift", upward)])["uplift"]
    found = check(stage, "wall", BASE, factors=EC7["UPL"])
    assert np.isclose(found.uplift, 0.9 * 144.0 / 60.0, rtol=1e-3)


def test_another_force_is_told():
    """A rope that holds the wall is no contact and no load."""
    model = wall()
    solid = model.forms["solid"]
    rope = sc.Bar(solid.basis, (B, H), (B + 3.0, H), EA=1e4, fixed_end=True)
    base = model.forms["base"]
    held = sc.Model({"solid": solid, "base": base, "rope": rope}, model.fixed)
    load = held.traction("wall:right", (-10.0, 0.0))
    stage = held.run([sc.Stage("thrust", load)])["thrust"]
    with pytest.warns(sc.AnalysisWarning, match="hold it as well"):
        check(stage, "wall", BASE)


def test_wrong_calls():
    """One sentence each."""
    model = wall()
    stage = model.run([sc.Stage("weight")])["weight"]
    with pytest.raises(ValueError, match="no solid, region or subdomain in stage 'weight' 'pile'"):
        check(stage, "pile", BASE)
    with pytest.raises(ValueError, match="no contact point of the body lies on the base"):
        check(stage, "wall", [(0.0, 1.0), (B, 1.0)])
    with pytest.raises(ValueError, match="must have the shape"):
        check(stage, "wall", [(0.0,), (B, 0.0)])
    with pytest.raises(ValueError, match="bearing needs ground"):
        check(stage, "wall", BASE, ground=sc.LinearElastic(E=1.0, nu=0.0))
    grid = MeshQuad().refined(1).with_defaults()
    mesh = grid.with_subdomains({"low": lambda x: x[1] < 0.5, "high": lambda x: x[1] > 0.5})
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    soils = dict.fromkeys(("low", "high"), sc.LinearElastic(E=1e3, nu=0.0))
    forms = {"solid": sc.SolidForm(basis, soils, unit_weight=1.0)}
    welded = sc.Model(forms, basis.get_dofs("bottom").all()).run([sc.Stage("weight")])["weight"]
    with pytest.raises(ValueError, match="'high' is welded"):
        check(welded, "high", [(0.0, 0.5), (1.0, 0.5)])


def test_wall_by_the_subdomain_of_a_solid_of_its_own():
    """[X] Named by its subdomain, a wall beside ground that is another solid has its own weight."""
    forms = wall().forms
    basis = forms["solid"].basis
    soil = sc.SolidForm(basis.with_elements("ground"), sc.LinearElastic(E=1e5, nu=0.3))
    concrete = sc.SolidForm(
        basis.with_elements("wall"), sc.LinearElastic(E=1e7, nu=0.2), unit_weight=WEIGHT
    )
    solids = {"soil": soil, "concrete": concrete, "base": forms["base"]}
    model = sc.Model(solids, sc.box_supports(basis, part="ground"))
    load = model.traction("wall:right", (-5.0, 0.0))
    found = check(model.run([sc.Stage("thrust", load)])["thrust"], "wall", BASE)
    assert np.isclose(found.vertical, WEIGHT * B * H, rtol=1e-3)
    assert np.isclose(found.overturning, WEIGHT * B**2 * H / 2 / (5.0 * H**2 / 2), rtol=2e-3)
