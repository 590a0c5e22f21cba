"""Rings of rubber between plates, beside energies that are written down anew."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import Basis, ElementQuad1, ElementVector, LinearForm, MeshQuad

import skfem_contact as sc

E, NU, PENALTY = 1.0, 0.45, 500.0
RADIUS, PRESSED = 0.3, 0.1


def half_disc(centre: float) -> MeshQuad:
    """Upper half of a disc: a square whose sides are drawn onto the circle."""
    grid = MeshQuad.init_tensor(np.linspace(-1.0, 1.0, 13), np.linspace(0.0, 1.0, 7))
    x, y = grid.p
    disc = np.stack((x * np.sqrt(1.0 - y**2 / 2.0), y * np.sqrt(1.0 - x**2 / 2.0)))
    points = np.array([[centre], [0.0]]) + RADIUS * disc
    sides = {
        "skin": lambda x: np.hypot(x[0] - centre, x[1]) > 0.97 * RADIUS,
        "middle": lambda x: x[1] < 1e-9,
    }
    return MeshQuad(points, grid.t).with_boundaries(sides)


def force_of_energy(basis: Basis, x: np.ndarray, axial: bool) -> np.ndarray:
    """Gradient of W = mu/2 (tr F F^T - 3 - 2 ln J) + lambda/2 (ln J)^2, (N,), by P = dW/dF."""
    mu = E / (2.0 * (1.0 + NU))
    lam = E * NU / ((1.0 + NU) * (1.0 - 2.0 * NU))
    u = basis.interpolate(x)
    radius = np.asarray(basis.global_coordinates())[0]
    F = np.zeros((*radius.shape, 3, 3)) + np.eye(3)
    F[..., :2, :2] += np.moveaxis(np.asarray(u.grad), (0, 1), (-2, -1))
    if axial:
        F[..., 2, 2] += np.asarray(u)[0] / radius
    inverse = np.linalg.inv(F).swapaxes(-1, -2)
    P = mu * (F - inverse) + lam * np.log(np.linalg.det(F))[..., None, None] * inverse

    @LinearForm
    def work(v, w):
        rate = sum(P[..., i, j] * v.grad[i][j] for i in range(2) for j in range(2))
        if axial:
            rate = (rate + P[..., 2, 2] * v[0] / w.x[0]) * w.x[0]
        return rate

    return work.assemble(basis)


@pytest.mark.parametrize("axial", [False, True], ids=["plane", "axisymmetric"])
def test_pressed_ring_is_at_the_minimum_of_its_energy(axial: bool) -> None:
    """[N] A ring of rubber is pressed by a third of its radius: inner nodes are in balance by the
    energy alone, which has the force of the plate as its slope.
    """
    centre = 1.0 if axial else 0.0
    basis = Basis(half_disc(centre), ElementVector(ElementQuad1()), intorder=4)
    coordinates = "axisymmetric" if axial else None
    rubber = sc.NeoHooke(E=E, nu=NU)
    body = sc.SolidForm(basis, rubber, "full", kinematics="finite", coordinates=coordinates)
    plate = sc.rigid.polyline([(5.0, RADIUS), (-5.0, RADIUS)])
    contact = sc.ContactPair(basis, "skin", plate, sc.Coulomb(), 3, penalty=PENALTY)
    middle = basis.get_dofs("middle").all("u^2")
    fixed = middle
    if not axial:
        fixed = np.append(middle, basis.get_dofs(lambda x: np.abs(x[0]) < 1e-9).all("u^1"))
    model = sc.Model({"ring": body, "plate": contact}, fixed)
    u = basis.zeros()
    u[middle] = PRESSED
    stage = model.run([sc.Stage("press", prescribed=u, increments=8)], progress=False)["press"]

    force = force_of_energy(basis, stage.x, axial)
    pressed = stage.reactions()[middle].sum()
    skin = basis.get_dofs("skin").all()
    inner = np.setdiff1d(np.arange(basis.N), np.concatenate((skin, fixed)))
    # the tolerance of Newton's method
    assert np.abs(force[inner]).max() < 1e-7 * pressed
    assert force[middle].sum() == pytest.approx(pressed, rel=1e-7)
    assert pressed > 0.1
