"""The exact ring in ground: the evaluator satisfies its equations, and the example's closed form
equals it.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.oracles.rings import RingInGround

EXAMPLE = Path(__file__).parents[2] / "examples" / "6_tunnels_and_pipes" / "plot_ring_in_ground.py"
CASE = {"a": 0.72, "b": 0.9, "E_ring": 2.8e7, "nu_ring": 0.2, "E_ground": 3e4, "nu_ground": 0.3}
FAR = {"vertical": 100.0, "horizontal": 50.0}


@pytest.fixture(params=[False, True], ids=["bonded", "slip"])
def ring(request):
    return RingInGround(**CASE, **FAR, slip=request.param)


@pytest.mark.parametrize("in_ring", [True, False])
def test_fields_satisfy_hooke_and_equilibrium(ring, in_ring):
    """[X] By differences in polar coordinates, in the ring and in the ground."""
    E, nu = (2.8e7, 0.2) if in_ring else (3e4, 0.3)
    r = np.array([0.75, 0.8, 0.88]) if in_ring else np.array([0.95, 1.5, 4.0])
    t, h = np.array([0.2, 0.9, 2.1]), 1e-5

    def field(dr, dt):
        return ring.field(r + dr, t + dt, in_ring)

    here = field(0, 0)
    by_r, by_t = (field(h, 0) - field(-h, 0)) / (2 * h), (field(0, h) - field(0, -h)) / (2 * h)
    srr, stt, srt, ur, ut = here
    tolerance = 1e-6 * 100  # differences of second order with steps of 1e-5
    np.testing.assert_allclose(by_r[0] + by_t[2] / r + (srr - stt) / r, 0, atol=tolerance)
    np.testing.assert_allclose(by_r[2] + by_t[1] / r + 2 * srt / r, 0, atol=tolerance)

    lam, mu = E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu))
    err, ett, ert = by_r[3], (by_t[4] + ur) / r, 0.5 * (by_t[3] / r + by_r[4] - ut / r)
    np.testing.assert_allclose(lam * (err + ett) + 2 * mu * err, srr, atol=tolerance)
    np.testing.assert_allclose(lam * (err + ett) + 2 * mu * ett, stt, atol=tolerance)
    np.testing.assert_allclose(2 * mu * ert, srt, atol=tolerance)


def test_boundary_and_interface_conditions(ring):
    """[X] Free inside, far field outside, equal tractions; equal displacements, or no shear and
    equal u_r.
    """
    t = np.linspace(0, 2 * np.pi, 17)
    np.testing.assert_allclose(ring.field(0.72, t, True)[[0, 2]], 0, atol=1e-9)
    inside, outside = ring.field(0.9, t, True), ring.field(0.9, t, False)
    np.testing.assert_allclose(inside[[0, 2]], outside[[0, 2]], atol=1e-9)
    np.testing.assert_allclose(inside[3], outside[3], atol=1e-15)
    if ring.slip:
        np.testing.assert_allclose(inside[2], 0, atol=1e-9)
    else:
        np.testing.assert_allclose(inside[4], outside[4], atol=1e-15)
    srr, stt, srt, _, _ = ring.field(1e5, t, False)
    np.testing.assert_allclose(srr, -75 + 25 * np.cos(2 * t), atol=1e-6)
    np.testing.assert_allclose(stt, -75 - 25 * np.cos(2 * t), atol=1e-6)
    np.testing.assert_allclose(srt, -25 * np.sin(2 * t), atol=1e-6)


def test_section_forces_balance_the_interface(ring):
    """[X] Equilibrium of the wall: moments about the circle's centre, tangential and radial
    forces.
    """
    t, h = np.array([0.3, 0.8, 1.4]), 1e-4
    N, M = np.array([ring.section_forces(t + d) for d in (-h, 0, h)]).swapaxes(0, 1)
    p, s = np.array([ring.interface(t + d) for d in (-h, 0, h)]).swapaxes(0, 1)
    tolerance = 1e-4  # differences of second order with steps of 1e-4; round-off over their square

    def slope(f):
        return (f[2] - f[0]) / (2 * h)

    np.testing.assert_allclose(slope(M + 0.81 * N), -(0.9**2) * s[1], atol=tolerance)
    # tangential: V = -N' - b s; radial: V' = N + b p
    np.testing.assert_allclose(
        -(N[2] - 2 * N[1] + N[0]) / h**2 - 0.9 * slope(s), N[1] + 0.9 * p[1], atol=tolerance
    )
    assert np.abs(slope(N)).max() > 10


def test_published_figures_of_the_paper_s_ring():
    """[X] Pressure, shear, thrust and moment at springline, haunch and crown, digits of another
    evaluation.
    """
    angles = np.radians([0, 45, 90])
    bonded, slip = (RingInGround(**CASE, **FAR, slip=s) for s in (False, True))
    np.testing.assert_allclose(bonded.interface(angles)[0], [72.036, 104.644, 137.251], rtol=1e-5)
    np.testing.assert_allclose(bonded.interface(angles)[1][1], -41.676, rtol=1e-5)
    np.testing.assert_allclose(
        bonded.section_forces(angles)[0], [-128.967, -94.179, -59.391], rtol=1e-5
    )
    np.testing.assert_allclose(
        bonded.section_forces(angles)[1], [11.579, 0.2797, -11.020], rtol=2e-4
    )
    np.testing.assert_allclose(slip.interface(angles)[0], [44.620, 104.644, 164.667], rtol=1e-5)
    np.testing.assert_allclose(slip.section_forces(angles)[1], [14.866, 0.2797, -14.306], rtol=2e-4)


def test_closed_form_of_the_example_equals_the_evaluator(ring, monkeypatch):
    """[N] Two programs for the same fields; the example's first cells are run, up to its meshes."""
    cells = EXAMPLE.read_text(encoding="utf-8").split("# %%\n# Meshes")[0]
    names: dict = {}
    monkeypatch.syspath_prepend(EXAMPLE.parent)  # as for a script that is run
    exec(compile(cells, str(EXAMPLE), "exec"), names)
    t = np.linspace(0.1, 3.0, 7)
    results = names["exact_results"](ring.slip)
    pressure, shear = ring.interface(t)
    N, M = ring.section_forces(t)
    for name, expected in (("pressure", pressure), ("thrust", N), ("moment", M)):
        constant, wave = results[name]
        np.testing.assert_allclose(constant + wave * np.cos(2 * t), expected, rtol=1e-9)
    np.testing.assert_allclose(results["friction"][1] * np.sin(2 * t), shear, atol=1e-9)

    x, y = 3.6 * np.cos(t), 3.6 * np.sin(t)
    _, _, _, ur, ut = ring.field(3.6, t, False)
    ux, uy = names["exact_displacement"](ring.slip, x, y)
    np.testing.assert_allclose(ux, ur * np.cos(t) - ut * np.sin(t), rtol=1e-9)
    np.testing.assert_allclose(uy, ur * np.sin(t) + ut * np.cos(t), rtol=1e-9)
