"""Retention curves at single suctions."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import Basis, ElementQuad1, MeshQuad

import skfem_contact as sc
from skfem_contact.water.moisture import Moisture

#: Exact up to the round-off of a few operations.
EXACT = {"rtol": 1e-12, "atol": 1e-12}


def test_retention():
    """[X] Ramp in the middle, at a quarter and at its end; van Genuchten with m = 1/2 and alpha s =
    1: S = 1/sqrt 2.
    """
    ramp = sc.water.Ramp(width=0.5, least=0.1)
    k, slope = ramp.relative(np.array([0.0, 0.25, 0.6]), np.full(3, 2.0))
    np.testing.assert_allclose(
        k, [0.55, 0.1 + 0.9 * 0.15625, 0.1], **EXACT
    )  # s**2 (3 - 2 s) at s = 1/2, 1/4, 0
    np.testing.assert_allclose(slope, [-1.35, -0.9 * 6 * 0.1875, 0.0], **EXACT)
    k, _ = sc.water.VanGenuchten(alpha=2.0, n=2.0, least=1e-9).relative(np.array([0.5]), np.ones(1))
    np.testing.assert_allclose(k, [2**-0.25 * (1 - np.sqrt(0.5)) ** 2], rtol=1e-8)


@pytest.mark.parametrize("n", [1.3, 2.0, 4.0])
def test_suction_after_a_change_of_saturation(n: float):
    """[X] The saturation changes by its slope, at nearly wet points along a line: no change leaves
    the suction, and a change of a dry point is that of the saturation.
    """
    law = sc.water.VanGenuchten(alpha=2.0, n=n, content=(0.1, 0.4))
    suction, size = np.array([1e-4, 1e-2, 0.3, 1.0]), np.ones(4)
    flat = np.full(4, 0.05)
    np.testing.assert_allclose(law.moved(suction, 0.0 * suction, size, flat), suction, rtol=1e-9)
    filled, slope = law.saturation(suction, size)
    moved = law.moved(suction, np.full(4, 0.01), size, flat)
    dry = slope < -0.05
    np.testing.assert_allclose(
        law.saturation(moved, size)[0][dry], (filled + 0.01 * slope)[dry], rtol=1e-9
    )


@pytest.mark.parametrize(
    "law",
    [
        sc.water.Ramp(width=1.5, least=0.01, content=(0.1, 0.4)),
        sc.water.VanGenuchten(alpha=2.0, n=1.4, least=1e-6, content=(0.1, 0.4)),
        sc.water.VanGenuchten(alpha=2.0, n=3.0, least=1e-6, content=(0.1, 0.4)),
        sc.water.BrooksCorey(entry=0.2, index=0.7, least=1e-6, content=(0.1, 0.4)),
    ],
    ids=str,
)
def test_slopes_are_those_of_the_curves(law):
    """[X] Slopes of relative permeability and saturation by the suction, against central
    differences.
    """
    suction, size, h = np.array([-0.2, 0.05, 0.21, 0.5, 0.9]), np.full(5, 0.8), 1e-5
    for curve in (law.relative, law.saturation):
        change = curve(suction + h, size)[0] - curve(suction - h, size)[0]
        # the third derivative is below 1e3
        np.testing.assert_allclose(curve(suction, size)[1], 0.5 * change / h, rtol=1e-6, atol=1e-7)


@pytest.mark.parametrize(
    "law",
    [
        sc.water.Ramp(width=1.5, content=(0.1, 0.4)),
        sc.water.BrooksCorey(entry=0.2, index=0.7, content=(0.1, 0.4)),
    ],
    ids=str,
)
def test_suction_after_a_change_along_other_curves(law):
    """[X] Where the saturation falls faster than the flat line, it changes by its slope; where it
    is level, the suction changes itself.
    """
    suction, size, flat = np.array([-2.0, 0.3, 0.5, 0.6]), np.ones(4), np.full(4, 0.05)
    np.testing.assert_allclose(law.moved(suction, np.zeros(4), size, flat), suction, rtol=1e-12)
    filled, slope = law.saturation(suction, size)
    for change in (-0.05, 0.05):
        moved = law.moved(suction, np.full(4, change), size, flat)
        wanted = filled + change * slope
        np.testing.assert_allclose(law.saturation(moved, size)[0][1:], wanted[1:], rtol=1e-12)
        assert moved[0] == pytest.approx(suction[0] + change, rel=1e-12)


def test_water_of_two_soils_by_the_excess_pressure() -> None:
    """[X] With S of the suction -(start + u) / gamma at the corners: content theta_r + (theta_s -
    theta_r) S, its share of theta_s, Bishop's pressure S (start + u), and slopes by differences.
    """
    mesh = MeshQuad.init_tensor([0.0, 1.0, 2.0], [0.0, 0.5, 1.0])
    basis = Basis(mesh, ElementQuad1(), intorder=2)
    left = np.flatnonzero(mesh.p[0, mesh.t].mean(axis=0) < 1.0)
    right = np.setdiff1d(np.arange(basis.nelems), left)
    laws = [
        (left, sc.water.VanGenuchten(alpha=2.0, n=2.0, content=(0.1, 0.4))),
        (right, sc.water.BrooksCorey(entry=0.2, index=0.7, content=(0.05, 0.3))),
    ]
    gamma = 10.0
    start = 4.0 - gamma * basis.doflocs[1]
    mobility = np.tile(np.eye(2), (basis.nelems, 1, 1))
    ground = Moisture(basis, mobility, laws, start, gamma, False)
    u = 3.0 * np.cos(np.arange(basis.N)) - 2.0
    found = ground.filling(u)
    total = (start + u)[basis.element_dofs.T]
    for part, law in laws:
        least, most = law.content
        S, _ = law.saturation(-total[part] / gamma, np.full_like(total[part], 0.5))
        content = least + (most - least) * S
        assert content.min() < 0.7 * content.max()
        np.testing.assert_allclose(found.content[part], content, **EXACT)
        np.testing.assert_allclose(found.share[part], content / most, **EXACT)
        np.testing.assert_allclose(found.bishop[part], S * total[part], **EXACT)
    # curved in the steps by 1e-9
    h = 1e-4
    ahead, behind = ground.filling(u + h), ground.filling(u - h)
    for name in ("bishop", "content", "share"):
        slope = (getattr(ahead, name) - getattr(behind, name)) / (2.0 * h)
        np.testing.assert_allclose(getattr(found, f"{name}_slope"), slope, atol=1e-7)
