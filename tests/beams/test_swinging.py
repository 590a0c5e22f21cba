"""Normal forces of linings bonded to ground that hardly changes its volume."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import skfem_contact as sc
from skfem_contact.beams.joints import swinging
from tests.tools.helpers import grid, traction, vector_basis

QUIET = {"progress": False}


def lining(n, nu):
    """Means of N of a quarter of a lining in ground under a squeeze, and N at both ends, (n, 2)."""
    # A grid of radii 1 to 4 and angles.
    plane = grid("P2", np.linspace(0, 1, n + 1), np.linspace(0, 1, n + 1))
    radius = 4.0 ** plane.p[0]
    angle = 0.5 * np.pi * plane.p[1]
    mesh = replace(plane, doflocs=radius * np.array([np.cos(angle), np.sin(angle)]))
    basis = vector_basis(mesh, "P2", intorder=2)
    soil = sc.Undrained(sc.LinearElastic(E=1e3, nu=0.3), nu_undrained=nu)
    # The grid's left side is the lining, its lower and upper sides lie in planes of symmetry.
    beam = sc.Beam(basis, "left", EI=1e2, EA=1e5)
    fixed = [
        basis.get_dofs("bottom").all("u^2"),
        basis.get_dofs("top").all("u^1"),
        *beam.dofs((1.0, 0.0), ["theta"]),
        *beam.dofs((0.0, 1.0), ["theta"]),
    ]
    model = sc.Model({"ground": sc.SolidForm(basis, soil), "lining": beam}, fixed)
    squeeze = sc.Stage("squeeze", traction(basis, "right", (-10.0, 0.0)))
    forces = model.run([squeeze], **QUIET)["squeeze"].section_forces("lining")
    N = forces.N.reshape(n, 2)
    return N.mean(axis=1), N


def test_normal_forces_that_swing_in_undrained_ground(recwarn):
    """[N] On four elements the ends are off by twice what the means are, and the share is told;
    with water that leaves there is nothing to tell.
    """
    lining(4, 0.31)
    assert not recwarn.list
    fine, _ = lining(32, 0.495)
    assert not recwarn.list
    with pytest.warns(sc.AnalysisWarning, match=r"lining: its normal forces swing by \d+%"):
        mean, ends = lining(4, 0.495)
    # Ends of the fine mesh swing themselves: their first and last means are next to the ends.
    fine = fine.reshape(4, 8)
    size = abs(fine).max()
    assert abs(mean - fine.mean(axis=1)).max() < 0.12 * size  # 11 %, the mesh of straight chords
    assert abs(ends - fine[:, [0, -1]]).max() > 0.5 * size  # 53 %


@pytest.mark.parametrize(
    ("N", "share"),
    [
        ([[1, 1], [4, 4]], 0.0),  # a force at the node
        ([[1, 2], [2, 3]], 0.0),  # friction
        ([[1, 2], [4, 5]], 0.0),  # both
        ([[3, 1], [3, 1]], 1.0),  # a swing of 2 about a mean of 2
        ([[3, 1], [4, 2]], 0.8),  # and a force: the slope is 2, means are 2 and 3
    ],
)
def test_swing_beside_forces_and_friction(N, share):
    """[X] Jumps of single forces and slopes of friction are no swing, in any order of elements."""
    cells = np.array([[0, 1, 3], [1, 2, 4]])
    for order in ([0, 1], [1, 0]):
        found = swinging(cells[order], np.array(N, float)[order], np.zeros((2, 2)), 0.0)
        assert [remark.figure for remark in found] == pytest.approx([share] * (share > 0))
    # A third element at the node may have forces of its own.
    joined = np.vstack((cells, [1, 5, 6]))
    assert not list(swinging(joined, np.array([*N, [0, 0]], float), np.zeros((3, 2)), 0.0))
