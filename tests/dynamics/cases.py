"""Bodies in motion whose exact solutions are known."""

from __future__ import annotations

import numpy as np
from numpy import ndarray
from skfem import Basis, ElementQuad1, ElementTriP2, ElementVector, MeshQuad

import skfem_contact as sc

#: Runs without a bar.
QUIET = {"progress": False}


def oscillator(E: float = 1e4, unit_weight: float = 20.0) -> tuple[sc.Model, Basis, ndarray]:
    """Return a square of mass 1 at its top, with stiffness E and frequency sqrt(E), and its top."""
    basis = Basis(MeshQuad().with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    solid = sc.SolidForm(basis, sc.LinearElastic(E=E, nu=0.0), unit_weight=unit_weight)
    fixed = [basis.get_dofs("bottom").all(), basis.get_dofs().all("u^1")]
    model = sc.Model({"solid": solid}, fixed, gravity_acceleration=10.0)
    return model, basis, basis.get_dofs("top").all("u^2")


def pushed(basis: Basis, force: float) -> ndarray:
    """Return the load of an upward force on the top."""
    return np.asarray(sc.traction(basis, "top", (0.0, force)))


def bar(
    n: int, quadratic: bool = False, length: float = 1.0
) -> tuple[sc.SolidForm, Basis, ndarray]:
    """Return a bar along x with E = 100 and density 1, waves of velocity 10, held sideways."""
    h = length / n
    mesh = MeshQuad.init_tensor(np.linspace(0.0, length, n + 1), [0.0, h]).with_defaults()
    element = ElementQuad1()
    if quadratic:
        mesh = mesh.to_meshtri().with_defaults()
        element = ElementTriP2()
    basis = Basis(mesh, ElementVector(element), intorder=4 if quadratic else 2)
    solid = sc.SolidForm(basis, sc.LinearElastic(E=100.0, nu=0.0), unit_weight=10.0)
    return solid, basis, np.arange(1, basis.N, 2)
