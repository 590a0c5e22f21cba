"""Rollers of a box."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from skfem import Basis, ElementHex1, ElementVector, MeshHex

import skfem_contact as sc
from tests.tools.helpers import grid, vector_basis


@pytest.mark.parametrize("element", ["P1", "P2", "Q1", "Q2"])
def test_rollers_are_those_of_the_boundaries(element):
    basis = vector_basis(grid(element, [0, 1, 3], [-2, 0, 1]), element)
    sides = basis.get_dofs({"left", "right"}).all("u^1")
    np.testing.assert_array_equal(
        sc.box_supports(basis), np.union1d(basis.get_dofs("bottom").all(), sides)
    )
    np.testing.assert_array_equal(
        sc.box_supports(basis, base="rollers"),
        np.union1d(basis.get_dofs("bottom").all("u^2"), sides),
    )
    with pytest.raises(ValueError, match="base must be one of 'fixed', 'rollers'"):
        sc.box_supports(basis, base="free")


def test_rollers_of_a_part_and_in_space():
    plate = grid("Q1", [0, 1, 2], [0, 1])
    basis = vector_basis(sc.join_bodies({"a": plate, "b": plate.translated((0.0, 1.0))}), "Q1")
    upper = sc.box_supports(basis, part="b")
    assert (basis.doflocs[1, upper] >= 1.0).all() and len(upper) == 3 * 2 + 2
    cube = Basis(MeshHex().refined(1), ElementVector(ElementHex1()))
    held = sc.box_supports(cube)  # 9 nodes of the base, 6 + 6 others on each pair of sides
    assert len(held) == 9 * 3 + 2 * 12


@pytest.mark.parametrize("held", ["left", "bottom"])
def test_bodies_in_axial_symmetry_are_held_along_the_axis(held):
    """[X] The one rigid motion is along the axis: any fixed dof in this direction holds a body, and
    fixed radii hold none.
    """
    basis = vector_basis(grid("Q1", [1, 2], [0, 1]), "Q1")
    ring = sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.3), coordinates="axisymmetric")
    fixed = basis.get_dofs(held)
    sc.Model({"ring": ring}, fixed.all("u^2")[:1]).run([sc.Stage("rest")], progress=False)
    loose = sc.Model({"ring": ring}, fixed.all("u^1"))
    with pytest.raises(ValueError, match="2 of the dofs are fixed, which leaves 1 of 1 rigid"):
        loose.run([sc.Stage("rest")], progress=False)


@pytest.mark.parametrize("element", ["Q1", "P2"])
def test_nodes_on_the_axis_that_are_not_held_are_told(element: str) -> None:
    """[X] All nodes on r = 0 but the corner that the base holds; none where they are held, and none
    in a ring that does not reach the axis.
    """
    basis = vector_basis(grid(element, [0, 1, 2], [0, 1, 3]), element)
    disc = sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.3), coordinates="axisymmetric")
    base = basis.get_dofs("bottom").all()
    axis = basis.get_dofs("left").all("u^1")
    free = sc.Model({"disc": disc}, base).run([sc.Stage("rest")], progress=False)
    held = sc.Model({"disc": disc}, np.union1d(base, axis)).run([sc.Stage("rest")], progress=False)
    count = len(np.setdiff1d(axis, base))
    assert count == (4 if element == "P2" else 2)
    (remark,) = free["rest"].remarks
    assert f"disc: {count} nodes on the axis of symmetry are free to move off it" in remark
    assert not held["rest"].remarks

    basis = vector_basis(grid(element, [1, 2], [0, 1]), element)
    ring = sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.3), coordinates="axisymmetric")
    supports = basis.get_dofs("bottom").all("u^2")
    rest = sc.Model({"ring": ring}, supports).run([sc.Stage("rest")], progress=False)
    assert not rest["rest"].remarks


def test_searches_tell_nodes_on_the_axis_that_are_not_held() -> None:
    """[X] A strength reduction, too, tells the two nodes on r = 0 that the base does not hold."""
    basis = vector_basis(grid("Q2", [0, 1, 2], [0, 1]), "Q2")
    clay = sc.Tresca(E=1e4, nu=0.3, c=30.0)
    ground = sc.SolidForm(basis, clay, coordinates="axisymmetric", unit_weight=20.0)
    model = sc.Model({"ground": ground}, basis.get_dofs({"bottom", "right"}).all())
    with pytest.warns(sc.AnalysisWarning, match=r"ground: 2 nodes on the axis"):
        model.strength_reduction(progress=False, max_value=1.1)


@pytest.mark.parametrize("kinematics", ["small", "finite"])
@pytest.mark.parametrize("motion", ["turned", "linear", "stretched"])
def test_boundaries_that_turn_are_told(kinematics, motion, recwarn):
    """[X] A bar whose surface turns about its axis by 5 degrees has no stress by the exact rotation
    at finite kinematics, nor by the linear one at small ones, and E (cos 5 - 1) by the exact one.
    """
    line = np.linspace(-1.0, 1.0, 3)
    mesh = MeshHex.init_tensor(line, line, np.linspace(0.0, 4.0, 5)).with_defaults()
    basis = Basis(mesh, ElementVector(ElementHex1()), intorder=2)
    solid = sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.0), kinematics=kinematics)
    model = sc.Model({"bar": solid}, basis.get_dofs().all())
    angle = np.radians(5.0)
    H = {
        "turned": np.array(
            [[np.cos(angle) - 1.0, -np.sin(angle)], [np.sin(angle), np.cos(angle) - 1.0]]
        ),
        "linear": angle * np.array([[0.0, -1.0], [1.0, 0.0]]),
        "stretched": angle * np.eye(2),
    }[motion]
    u = np.zeros((3, basis.N // 3))
    u[:2] = H @ basis.doflocs[:2, ::3]
    stage = sc.Stage("turn", prescribed=u.T.ravel(), increments=2)
    stress = model.run([stage], progress=False)["turn"].field("sxx")
    told = [w for w in recwarn if "nodes by 5.0 degrees" in str(w.message)]
    assert len(told) == (motion == "turned" and kinematics == "small")
    if motion != "stretched" and (motion == "turned") == (kinematics == "finite"):
        assert abs(stress).max() < 1e-9
    if told:
        whole = replace(stage, fixed=np.arange(basis.N))  # nothing deforms beside
        recwarn.clear()
        model.run([whole], progress=False)
        assert not [w for w in recwarn if "nodes by 5.0 degrees" in str(w.message)]
        assert np.allclose(stress, 1e3 * (np.cos(angle) - 1.0))
