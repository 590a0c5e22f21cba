"""Arrays that the user changes later: nothing that was built or computed from them changes."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import csr_matrix

import skfem_contact as sc
from tests.tools.helpers import grid, vector_basis

QUIET = {"progress": False}
BASIS = vector_basis(grid("Q1", np.linspace(0, 4, 5), np.linspace(0, 2, 3)), "Q1", intorder=2)


def solid():
    """Return elastic ground with weight."""
    return sc.SolidForm(BASIS, sc.LinearElastic(1e4, 0.3), unit_weight=20.0)


def test_corners_of_a_rigid_line():
    """[X] The gap to a line stays as it was when the corners move afterwards."""
    points = np.array([[4.0, 2.0], [2.0, 2.1], [0.0, 2.0]])
    line = sc.rigid.polyline(points)
    pair = sc.ContactPair(BASIS, "top", line, sc.Coulomb(0.3), penalty=1e4)
    gap = pair.assemble(BASIS.zeros(), pair.initial_state()).state.gap.copy()
    points += 5.0
    again = pair.assemble(BASIS.zeros(), pair.initial_state()).state.gap
    np.testing.assert_array_equal(again, gap)


def test_entries_of_a_sparse_matrix():
    """[X] A form of a matrix has the same response when the matrix is emptied afterwards."""
    K = csr_matrix(1e3 * np.eye(BASIS.N))
    model = sc.Model({"ground": solid(), "springs": sc.MatrixForm(K)}, sc.box_supports(BASIS))
    before = model.run([sc.Stage("weight")], **QUIET)["weight"].x
    K.data[:] = 0.0
    after = model.run([sc.Stage("weight")], **QUIET)["weight"].x
    np.testing.assert_array_equal(after, before)


@pytest.mark.parametrize("by_region", [False, True])
@pytest.mark.parametrize("state", ["stage", "k0"])
def test_water_of_a_finished_stage(by_region, state):
    """[X] Pore pressures 10 (1 - y) of a result stay when the given array is set to zero."""
    mesh = BASIS.mesh.with_subdomains({"all": np.arange(BASIS.mesh.nelements)})
    basis = vector_basis(mesh, "Q1", intorder=2)
    ground = sc.SolidForm(basis, sc.LinearElastic(1e4, 0.3), unit_weight=20.0)
    model = sc.Model({"ground": ground}, sc.box_supports(basis))
    heads = 10.0 * (2.0 - mesh.p[1])
    water = {"all": heads} if by_region and state == "stage" else heads
    if state == "stage":
        found = model.run([sc.Stage("wet", water=water)], **QUIET)["wet"]
    else:
        found = model.k0_state(K0=0.5, water=water)["initial"]
    heads[:] = 0.0
    assert found.field("pore", water=True).max() == pytest.approx(20.0)


def test_displacements_of_a_loop_of_the_user():
    """[X] A result of displacements keeps these when the loop goes on in the same arrays."""
    ground = solid()
    x = np.linspace(0.0, 1e-3, BASIS.N)
    load = np.ones(BASIS.N)
    stage = sc.results.of({"ground": ground}, x, {"ground": ground.initial_state()}, load=load)
    x[:] = 0.0
    load[:] = 0.0
    assert (stage.x.max(), stage.load.max()) == (1e-3, 1.0)
