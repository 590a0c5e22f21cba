"""Pressure that follows a boundary."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy import ndarray
from scipy.integrate import quad
from skfem import (
    Basis,
    ElementHex1,
    ElementQuad1,
    ElementQuad2,
    ElementTetP2,
    ElementTriP2,
    ElementVector,
    MeshHex,
    MeshQuad,
    MeshTet,
    MeshTri,
)

import skfem_contact as sc

CASES: dict[str, tuple[Any, Any, int, str]] = {
    "P2": (MeshTri().refined(1), ElementTriP2(), 4, "plane"),
    "Q1 axial": (MeshQuad().refined(1).translated((0.5, 0.0)), ElementQuad1(), 2, "axisymmetric"),
    "Hex1": (MeshHex().refined(1), ElementHex1(), 2, "space"),
    "P2 in space": (MeshTet(), ElementTetP2(), 4, "space"),
}


def pressed(name: str) -> tuple[sc.Model, Basis]:
    """Model of a body with a pressure at its left side."""
    mesh, element, order, coordinates = CASES[name]
    basis = Basis(mesh.with_defaults(), ElementVector(element), intorder=order)
    law = sc.LinearElastic(E=100.0, nu=0.3)
    body = sc.SolidForm(basis, law, coordinates=coordinates, kinematics="finite")
    forms = {"body": body, "air": sc.Pressure(body, "left")}
    return sc.Model(forms, basis.get_dofs("right").all()), basis


@pytest.mark.parametrize("name", CASES)
def test_tangent(name: str) -> None:
    """[N] The tangent is the derivative of the force, by displacements and by the pressure."""
    air, n = pressed(name)[0].forms["air"], pressed(name)[0].layout.size
    rng = np.random.default_rng(1)
    x = 0.2 * rng.normal(size=n)
    x[-1] = 3.0
    direction = 1e-6 * rng.normal(size=n)
    K = air.assemble(x, None).padded(n).stiffness
    change = [air.assemble(x + sign * direction, None).padded(n).force for sign in (1.0, -1.0)]
    difference = change[0] - change[1]
    # the force is of third order at most: only round-off of the differences
    assert np.abs(2.0 * K @ direction - difference).max() < 1e-8 * np.abs(difference).max()


@pytest.mark.parametrize("name", CASES)
def test_resultant_of_a_turned_and_stretched_body(name: str) -> None:
    """[X] The resultant is the pressure on the deformed area, against its normal."""
    model, basis = pressed(name)
    n, dim = model.layout.size, basis.mesh.dim()
    rng = np.random.default_rng(2)
    F = np.eye(dim) + 0.4 * rng.normal(size=(dim, dim))
    if name == "Q1 axial":
        F = np.diag([1.3, 0.8])
    x = np.zeros(n)
    for i in range(dim):
        x[i : basis.N : dim] = (F[i] @ basis.doflocs - basis.doflocs[i])[i::dim]
    x[-1] = 3.0
    force = -model.forms["air"].assemble(x, None).padded(n).force[:-1]
    # pressure at x = 0 (radius .5 in axial symmetry) of unit area: -p cof(F) N, N = -e_x
    expected = 3.0 * np.linalg.det(F) * np.linalg.inv(F).T[:, 0]
    if name == "Q1 axial":
        expected = np.array([3.0 * 0.8 * 0.5 * 1.3, 0.0])
    found = np.array([force[i : basis.N : dim].sum() for i in range(dim)])
    # round-off
    assert np.abs(found - expected).max() < 1e-13


def tube(shape: str) -> tuple[sc.SolidForm, ndarray, str, float]:
    """Tube of radii 1 and 2 of rubber; its fixed dofs, the inner boundary, and its length."""
    rubber = sc.NeoHooke(E=3.0, nu=0.4999)
    r = np.linspace(1.0, 2.0, 9)
    if shape == "axisymmetric":
        mesh = MeshQuad.init_tensor(r, np.array([0.0, 0.1])).with_defaults()
        basis = Basis(mesh, ElementVector(ElementQuad2()), intorder=4)
        ends = [basis.get_dofs(end).all("u^2") for end in ("bottom", "top")]
        body = sc.SolidForm(basis, rubber, coordinates="axisymmetric", kinematics="finite")
        return body, np.unique(np.concatenate(ends)), "left", 0.1
    grid = MeshQuad.init_tensor(r, np.linspace(0.0, np.pi / 2.0, 13)).with_defaults()
    points = np.array([grid.p[0] * np.cos(grid.p[1]), grid.p[0] * np.sin(grid.p[1])])
    mesh = MeshQuad(points, grid.t, _boundaries=grid.boundaries)
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    sides = basis.get_dofs("bottom").all("u^2"), basis.get_dofs("top").all("u^1")
    body = sc.SolidForm(basis, rubber, "f_bar", kinematics="finite")
    return body, np.concatenate(sides), "left", 1.0


@pytest.mark.parametrize(("shape", "tolerance"), [("axisymmetric", 1e-3), ("plane", 4e-3)])
def test_a_tube_of_rubber_is_blown_up(shape: str, tolerance: float) -> None:
    """[X] Pressure of an incompressible neo-Hookean tube whose inner radius doubles.

    ``p = int mu (l^2 - 1 / l^2) / r dr`` with the stretch ``l = r / R`` of circles. The tolerance
    has the compressibility (nu .4999) and, in the plane, the chords of 12 sides, .2 % of a radius.
    """
    body, fixed, inner, _ = tube(shape)
    a, b = 2.0, np.sqrt(4.0 + 3.0)

    def share(r: float) -> float:
        square = r**2 / (r**2 - 3.0)
        return (square - 1.0 / square) / r

    exact = quad(share, a, b)[0]
    model = sc.Model({"tube": body, "air": sc.Pressure(body, inner)}, fixed)
    load = model.forms["air"].load(exact)
    result = model.run([sc.Stage("blow", load, increments=6)])
    last = result["blow"]
    dofs = body.basis.get_dofs(inner).all()
    moved = body.basis.doflocs[dofs % 2, dofs] + last.x[dofs]
    if shape == "axisymmetric":
        radius = moved[0::2].mean()
    else:
        radius = np.hypot(moved[0::2], moved[1::2]).mean()
    assert radius == pytest.approx(a, rel=tolerance)
    assert "p = " in last.outputs("air").summary


def test_refused() -> None:
    """[X] Small kinematics, other boundaries, loads without a number and of no number."""
    model, basis = pressed("P2")
    small = sc.SolidForm(basis, sc.LinearElastic(E=100.0, nu=0.3))
    with pytest.raises(ValueError, match="small rotations and strains"):
        sc.Model({"body": small, "air": sc.Pressure(small, "left")}, [0, 1, 3])
    with pytest.raises(ValueError, match="boundary"):
        sc.Pressure(basis, "inside")
    with pytest.raises(ValueError, match="no number yet"):
        sc.Pressure(basis, "left").load(1.0)
    with pytest.raises(ValueError, match="finite number"):
        model.forms["air"].load(np.nan)
