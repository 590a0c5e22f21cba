"""Natural frequencies and modes: layer, cantilever, free bodies, contact."""

from __future__ import annotations

import re

import numpy as np
import pytest
from scipy.sparse import csr_matrix
from skfem import (
    Basis,
    ElementQuad1,
    ElementQuad2,
    ElementTriP2,
    ElementVector,
    MeshQuad,
    MeshTri,
)

import skfem_contact as sc
from tests.dynamics.cases import QUIET, oscillator


def layer(element=ElementQuad1, n=40):
    """Return the model of a layer of height 20 in shear, with waves of velocity 200."""
    mesh = MeshQuad.init_tensor([0.0, 1.0], np.linspace(0.0, 20.0, n + 1)).with_defaults()
    basis = Basis(mesh, ElementVector(element()), intorder=4)
    soil = sc.LinearElastic(E=2.0 * 8e4 * 1.3, nu=0.3)
    solid = sc.SolidForm(basis, soil, "full", unit_weight=20.0)
    fixed = [basis.get_dofs("bottom").all(), np.arange(1, basis.N, 2)]
    return sc.Model({"soil": solid}, fixed, gravity_acceleration=10.0), basis


@pytest.mark.parametrize("mass", ["lumped", "consistent"])
def test_frequencies_of_a_layer(mass):
    """[X] (2 k - 1) c / 4 H; quadratic elements err by less than 0.1 %."""
    exact = 2.5 * np.array([1.0, 3.0, 5.0])
    model, _ = layer()
    np.testing.assert_allclose(model.frequencies(3, mass=mass), exact, rtol=2e-3)
    model, _ = layer(ElementQuad2, 10)
    np.testing.assert_allclose(model.frequencies(3, mass=mass), exact, rtol=5e-4)


def test_participation_of_a_layer():
    """[X] The share of mode k is 8 / (pi (2 k - 1))^2, and all shares add up to 1."""
    model, basis = layer()
    modes = model.modes(10)
    number = 2.0 * np.arange(1, 11) - 1.0
    share = 8.0 / (np.pi * number) ** 2
    # the mass of the lowest nodes, 1/80, is fixed
    np.testing.assert_allclose(modes.effective[:3, 0] * (1.0 - 1.0 / 80.0), share[:3], rtol=0.01)
    assert 0.95 < modes.effective[:, 0].sum() < 1.0
    np.testing.assert_allclose(np.abs(modes.shapes).max(axis=0), 1.0)
    # sin(pi y / 2 H), largest at the top: the factor is 4 / pi
    assert modes.participation[0, 0] == pytest.approx(4.0 / np.pi, rel=1e-3)
    y = basis.doflocs[1, ::2]
    np.testing.assert_allclose(modes.shapes[::2, 0], np.sin(np.pi * y / 40.0), atol=1e-6)
    assert len(modes.table()) == 10
    assert modes.stage(0).name == "mode 1, 2.5 Hz"


@pytest.mark.slow
def test_film_of_a_mode(tmp_path):
    """[X] A period begins and ends with the shape, and is upside down in its middle."""
    pytest.importorskip("imageio")
    plot = pytest.importorskip("skfem_contact.plot")
    model, _ = layer(n=4)
    modes = model.modes(1)
    swing = modes.swing(0, 4)
    shape = modes.shapes[:, 0]
    for stage, phase in zip(swing, (1.0, 0.0, -1.0, 0.0, 1.0), strict=True):
        np.testing.assert_allclose(stage.x, phase * shape, atol=1e-15)
    file = plot.animate(swing, "ux", tmp_path / "mode.gif", deformed="auto", frames=2)
    if file is not None:
        assert file.stat().st_size > 1000
    with pytest.raises(ValueError, match="at least 2 parts, not 1"):
        modes.swing(0, 1)


def cantilever(fixed=True):
    """Return a beam of quadratic triangles, L / h = 20, E = 1e6 and density 1."""
    mesh = MeshTri.init_tensor(np.linspace(0, 20, 41), np.linspace(0, 1, 3)).with_defaults()
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=4)
    solid = sc.SolidForm(basis, sc.LinearElastic(E=1e6, nu=0.0), unit_weight=10.0)
    held = basis.get_dofs("left").all() if fixed else np.zeros(0, int)
    return sc.Model({"beam": solid}, held, gravity_acceleration=10.0)


def test_bending_of_a_cantilever():
    """[X] Euler and Bernoulli, less shear and rotation: 0.2 % and 1.4 % (Timoshenko)."""
    euler = np.array([3.5160, 22.034]) / (2 * np.pi) * np.sqrt(1e6 / 12.0 / 20.0**4)
    found = cantilever().frequencies(2)
    np.testing.assert_allclose(found / euler, [0.9982, 0.9875], atol=2e-3)


def test_free_body_has_rigid_modes():
    """[X] Three frequencies of a free plane body are zero; then 22.373 of a free beam."""
    model = cantilever(fixed=False)
    found = model.frequencies(5)
    euler = np.array([22.373, 61.673]) / (2 * np.pi) * np.sqrt(1e6 / 12.0 / 20.0**4)
    # round-off of the squares, 1e-13 of the largest one
    assert found[:3].max() < 1e-3 * euler[0]
    np.testing.assert_allclose(found[3:] / euler, [0.993, 0.98], atol=0.008)


def test_few_masses():
    """[X] One mass on a spring: w = sqrt(k / m); more modes than masses are refused."""
    model, _, _ = oscillator()
    assert model.frequencies(1)[0] == pytest.approx(100.0 / (2.0 * np.pi))
    with pytest.raises(ValueError, match="2 masses that are free to move, not 3 modes"):
        model.frequencies(3)
    with pytest.raises(ValueError, match="at least 1 and whole"):
        model.frequencies(0)
    with pytest.raises(ValueError, match="there are 1 modes, numbers 0 to 0"):
        model.modes(1).stage(1)


def test_modes_about_a_state_with_contact():
    """[X] A block on a frictionless rigid plane: the closed contact holds it like a support."""
    mesh = MeshQuad.init_tensor([0.0, 1.0], np.linspace(0.0, 4.0, 17)).with_defaults()
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    solid = sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.0), unit_weight=20.0)
    plane = sc.rigid.line((-5.0, 0.0), (5.0, 0.0))
    pair = sc.ContactPair(basis, "bottom", plane, sc.Coulomb(), enforcement=sc.DualMultipliers())
    along = basis.get_dofs().all("u^1")
    given = {"gravity_acceleration": 10.0}
    model = sc.Model({"solid": solid, "pair": pair}, along, **given)
    start = model.run([sc.Stage("weight")], **QUIET)
    held = sc.Model({"solid": solid}, [along, basis.get_dofs("bottom").all()], **given)
    found = model.frequencies(3, start=start)
    # the masses of the lowest nodes do not move either
    np.testing.assert_allclose(found, held.frequencies(3), rtol=1e-6)


def two_blocks(n, law, **given):
    """One block on another one, the upper one with n elements along each side."""
    lower, upper = (
        MeshQuad.init_tensor(np.linspace(0, 1, k + 1), np.linspace(0, 1, k + 1)).with_defaults()
        for k in (4, n)
    )
    mesh = sc.join_bodies({"lower": lower, "upper": upper.translated((0.0, 1.0))})
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    solid = sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.2), unit_weight=10.0)
    pair = sc.ContactPair(basis, "upper:bottom", "lower:top", law, **given)
    fixed = basis.get_dofs("lower:bottom").all()
    return sc.Model({"solid": solid, "pair": pair}, fixed, gravity_acceleration=10.0)


STICKING = pytest.mark.parametrize("law", [sc.Tied(), sc.Coulomb(0.5)])
ENFORCED = pytest.mark.parametrize(
    "given", [{"penalty": 1e8}, {"enforcement": sc.DualMultipliers()}]
)


@STICKING
@ENFORCED
def test_two_blocks_vibrate_like_one(law, given):
    """[X] Blocks in contact, of meshes that fit, have the frequencies of one body."""
    line = np.linspace(0.0, 1.0, 5)
    whole = MeshQuad.init_tensor(line, np.linspace(0.0, 2.0, 9)).with_defaults()
    basis = Basis(whole, ElementVector(ElementQuad1()), intorder=2)
    body = sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.2), unit_weight=10.0)
    fixed = basis.get_dofs("bottom").all()
    one = sc.Model({"body": body}, fixed, gravity_acceleration=10.0)
    # the penalty is a layer of E / 1e8 = 1e-4 in a height of 2
    found = two_blocks(4, law, **given).frequencies(4)
    np.testing.assert_allclose(found, one.frequencies(4), rtol=1e-4)


@STICKING
@ENFORCED
def test_modes_about_the_weight_of_blocks(law, given):
    """[X] The skew tangent of a pressed joint that sticks changes no frequency by its pressure."""
    model = two_blocks(3, law, **given)
    start = model.run([sc.Stage("weight")], **QUIET)
    # the pressure is .1 % of E
    found = model.frequencies(4, start=start)
    np.testing.assert_allclose(found, model.frequencies(4), rtol=2e-3)


@pytest.mark.parametrize("law", [sc.Tied(), sc.Coulomb(0.5)])
@pytest.mark.parametrize("weight", [False, True])
@pytest.mark.parametrize("given", [{}, {"enforcement": sc.AugmentedLagrangian()}])
def test_frequencies_that_penalties_lower_are_told(law, weight, given):
    """[X] The share by which penalties lower the frequencies of two blocks that vibrate as one."""
    exact = two_blocks(4, law, enforcement=sc.DualMultipliers()).frequencies(3)
    model = two_blocks(4, law, **given)
    start = model.run([sc.Stage("weight")], **QUIET) if weight else None
    with pytest.warns(sc.AnalysisWarning, match="pair: penalties of contact yield") as caught:
        found = model.frequencies(3, start=start)
    told = re.search(r"lowers frequencies by up to ([\d.]+)%", str(caught[-1].message))
    # Digits that are written; the next order is the square of 2.5 %
    assert float(told[1]) == pytest.approx(100.0 * (1.0 - found / exact).max(), abs=0.11)


def test_skew_stiffness_is_refused():
    """Forces that turn the column on and on have no modes of vibration."""
    model, basis = layer()
    i, j = basis.get_dofs("top").all()[:2]
    skew = csr_matrix(([1e5, -1e5], ([i, j], [j, i])), shape=(basis.N, basis.N))
    forms = {**model.forms, "turning": sc.MatrixForm(skew)}
    turned = sc.Model(forms, basis.get_dofs("bottom").all(), gravity_acceleration=9.81)
    with pytest.raises(ValueError, match="the tangent is not symmetric"):
        turned.frequencies(1)


def test_modes_need_masses():
    """[X] One sentence each: no acceleration of gravity, no unit weight."""
    model, basis = layer()
    solid = sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.0))
    with pytest.raises(ValueError, match=r"give Model.gravity_acceleration=9.81"):
        sc.Model(model.forms, model.fixed).frequencies(1)
    with pytest.raises(ValueError, match="'soil' has no unit_weight"):
        sc.Model({"soil": solid}, model.fixed, gravity_acceleration=10.0).frequencies(1)


def test_mast_of_beams():
    """[X] A mast of beam elements: Euler and Bernoulli, and the base shakes its mass as well."""
    nodes = np.column_stack((np.zeros(21), np.linspace(0.0, 10.0, 21)))
    mast = sc.Beam(None, nodes, EI=2e4, EA=1e7, GA=1e8, unit_weight=8.0)
    foot = mast.dofs((0.0, 0.0))
    model = sc.Model({"mast": mast}, foot, gravity_acceleration=10.0)
    modes = model.modes(2)
    exact = np.array([3.5160, 22.034]) / (2.0 * np.pi) * np.sqrt(2e4 / 0.8 / 10.0**4)
    # masses at 41 nodes
    np.testing.assert_allclose(modes.frequencies, exact, rtol=2e-3)
    # the share of the first mode of a cantilever is .613
    assert modes.effective[0, 0] == pytest.approx(0.613, rel=0.01)

    # a constant acceleration of the base pushes the tip to twice w L^4 / 8 EI, w = .8 a
    record = sc.Record(0.01, np.full(500, 0.5))
    half = 0.5 / modes.frequencies[0]
    stage = sc.Stage("push", duration=half, dynamic=sc.Dynamic(half / 100), base=record)
    with pytest.warns(sc.AnalysisWarning, match="its record ends with"):
        found = model.run([sc.Stage("weight"), stage], **QUIET)["push"]
    with pytest.raises(ValueError, match="nodes by coordinates are those of solids"):
        found.history((0.0, 10.0))
    tip = found.x[: 2 * len(nodes) * 2 : 2].min()
    assert tip == pytest.approx(-2.0 * 0.8 * 0.5 * 10.0**4 / (8.0 * 2e4), rel=0.03)


def test_nodes_on_the_axis_that_are_not_held_are_told(recwarn):
    """[X] Modes of the undeformed body tell them, a start has been told by its run."""
    mesh = MeshQuad.init_tensor([0.0, 1.0, 2.0], [0.0, 1.0, 3.0]).with_defaults()
    basis = Basis(mesh, ElementVector(ElementQuad2()), intorder=4)
    soil = sc.LinearElastic(E=1e4, nu=0.3)
    disc = sc.SolidForm(basis, soil, coordinates="axisymmetric", unit_weight=20.0)
    base = basis.get_dofs("bottom").all()
    axis = basis.get_dofs("left").all("u^1")
    free = sc.Model({"disc": disc}, base, gravity_acceleration=9.81)
    held = sc.Model({"disc": disc}, [base, axis], gravity_acceleration=9.81)
    held.modes(1)
    assert not recwarn.list
    with pytest.warns(sc.AnalysisWarning, match="disc: 4 nodes on the axis of symmetry are free"):
        free.modes(1)
    with pytest.warns(sc.AnalysisWarning, match="disc: 4 nodes on the axis"):
        start = free.run([sc.Stage("weight")], **QUIET)
    recwarn.clear()
    free.modes(1, start=start)
    assert not recwarn.list


def test_no_modes_of_water():
    """[X] Water that flows has no modes: it is refused by name."""
    basis = Basis(MeshQuad().with_defaults(), ElementVector(ElementQuad1()))
    forms = {
        "soil": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.0), unit_weight=20.0),
        "water": sc.PoreWater(basis, 1e-3, unit_weight=10.0),
    }
    model = sc.Model(forms, basis.get_dofs("bottom").all(), gravity_acceleration=9.81)
    with pytest.raises(ValueError, match=r"water does not flow: deactivate \['water'\]"):
        model.modes(1)
