"""Order of convergence under a smooth pressure between two bodies, which no edge of contact
spoils.
"""

from __future__ import annotations

import numpy as np
import pytest

import skfem_contact as sc
from tests.tools.helpers import ELEMENTS, grid, vector_basis

E, NU, WAVE = 1000.0, 0.3, np.pi
UPPER, LOWER = "upper:bottom", "lower:top"
#: Airy's stress function is ``(A cosh ky + B y sinh ky) cos kx - p x^2 / 2``: the pressure is p +
#: k^2 A cos kx along y = 0, which stays straight and without shear.  Everything is so small that
#: geometry stays linear.
SMALL = 1e-4
A, B, MEAN = 0.6 / WAVE**2 * SMALL, 0.4 / WAVE * SMALL, SMALL


def exact_pressure(x: np.ndarray) -> np.ndarray:
    """Normal traction along y = 0."""
    return MEAN + WAVE**2 * A * np.cos(WAVE * x)


def exact_displacement(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Displacements in plane strain, (2, ...)."""
    k, c, s = WAVE, np.cosh(WAVE * y), np.sinh(WAVE * y)
    f = [
        A * c + B * y * s,
        A * k * s + B * (s + k * y * c),
        A * k**2 * c + B * (2 * k * c + k**2 * y * s),
        A * k**3 * s + B * (3 * k**2 * s + k**3 * y * c),
    ]
    compliance = (1 + NU) / E
    along = compliance * ((1 - NU) * f[2] + NU * k**2 * f[0]) / k  # of the strain cos kx
    by_y = compliance * ((1 - NU) * f[3] + NU * k**2 * f[1]) / k
    ux = along * np.sin(k * x) + compliance * NU * MEAN * x
    uy = -(2 * compliance * k * f[1] - by_y) * np.cos(k * x) / k - compliance * (1 - NU) * MEAN * y
    return np.stack((ux, uy))


def errors(element: str, n: int, slave: str, quadrature="segments") -> np.ndarray:
    """Errors of pressure and displacements in the L2 norm, relative; n elements below and 1.5 n
    above.
    """
    t = [np.linspace(0, 1, m + 1) for m in (n, 3 * n // 2)]
    mesh = sc.join_bodies(
        {"lower": grid(element, t[0], t[0] - 1), "upper": grid(element, t[1], t[1])}
    )
    basis = vector_basis(mesh, element, intorder=6)
    master = LOWER if slave == UPPER else UPPER
    forms = {
        "bodies": sc.SolidForm(basis, sc.LinearElastic(E=E, nu=NU)),
        "contact": sc.ContactPair(
            basis, slave, master, sc.Coulomb(), quadrature, enforcement=sc.AugmentedLagrangian(1e-5)
        ),
    }
    sides = basis.get_dofs({"lower:left", "lower:right", "upper:left", "upper:right"}).all("u^1")
    fixed = np.union1d(sides, basis.get_dofs({"lower:bottom", "upper:top"}).all())
    field = exact_displacement(*basis.doflocs[:, ::2]).T.ravel()
    stage = sc.Stage("press", basis.zeros(), field)
    result = sc.Model(forms, fixed, newton=sc.Newton(1e-10)).run([stage], progress=False)["press"]
    joint = result.tractions("contact")
    exact = exact_pressure(joint.x)
    pressure = np.sqrt(joint.weight @ (joint.pressure - exact) ** 2 / (joint.weight @ exact**2))
    field = exact_displacement(*basis.global_coordinates())
    difference = np.asarray(basis.interpolate(result.x)) - field
    return np.array(
        [pressure, np.sqrt((difference**2 * basis.dx).sum() / (field**2 * basis.dx).sum())]
    )


#: Least orders of pressure and displacements, and the largest error of the pressure for n = 16.
#: Measured, with either body as the slave: Q1 1.9, 2.0 and 1.0 %; P1 2.4, 1.9 and 1.5 %; Q2 2.0,
#: 3.0 and 0.055 %; QuadS2 1.8, 3.0 and 0.053 %; P2 3.0, 3.1 and 0.05 %.
ORDERS = {
    "Q1": (1.8, 1.8, 0.015),
    "P1": (1.8, 1.7, 0.02),
    "Q2": (1.8, 2.8, 8e-4),
    "QuadS2": (1.6, 2.8, 8e-4),
    "P2": (2.8, 2.8, 8e-4),
}


@pytest.mark.parametrize("slave", [UPPER, LOWER])
@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.one_in(2)
def test_order_with_segments(element, slave):
    """[X] Closed form: the pressure at all points, 4 to 16 elements across one body and 6 to 24
    across the other.
    """
    coarse, fine = errors(element, 4, slave), errors(element, 16, slave)
    orders = np.log2(coarse / fine) / 2
    assert (orders > ORDERS[element][:2]).all()
    assert fine[0] < ORDERS[element][2]


@pytest.mark.parametrize("slave", [UPPER, LOWER])
def test_gauss_points_on_pieces_that_end_at_the_masters_nodes(slave):
    """[X] Segments are divided in proportion to the meshes, 2 to 3 here: Gauss points are then as
    good as the cuts.
    """
    coarse, fine = errors("Q2", 8, slave, 4), errors("Q2", 16, slave, 4)
    assert (np.log2(coarse / fine) > ORDERS["Q2"][:2]).all()
    assert fine[0] < ORDERS["Q2"][2]
