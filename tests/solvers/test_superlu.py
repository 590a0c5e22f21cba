"""Nested dissection: permutations and fill."""

import numpy as np
import pytest
from scipy.sparse import block_diag, csr_matrix
from scipy.sparse.linalg import splu
from scipy.spatial import Delaunay
from skfem import (
    Basis,
    ElementHex1,
    ElementQuad1,
    ElementTriP1,
    ElementTriP2,
    ElementVector,
    MeshHex,
    MeshQuad,
    MeshTri,
)
from skfem.models.elasticity import linear_elasticity

from skfem_contact.solvers.superlu import nested_dissection


def _graded_mesh(n):
    """Delaunay mesh of the unit circle whose elements shrink a hundredfold towards the centre."""
    rng = np.random.default_rng(0)
    radius, angle = np.exp(rng.uniform(np.log(0.01), 0.0, n)), rng.uniform(0.0, 2.0 * np.pi, n)
    points = np.array([radius * np.cos(angle), radius * np.sin(angle)])
    return MeshTri(points, Delaunay(points.T).simplices.T)


def _system(mesh, element):
    """Places and an elastic stiffness that is not singular."""
    basis = Basis(mesh, ElementVector(element), intorder=2)
    K = linear_elasticity(1.0, 1.0).assemble(basis).tocsr()
    K.setdiag(K.diagonal() * 1.01)
    return basis.doflocs, K.tocsr()


def _fills(locations, K):
    """Entries of the factors in our order and in scipy's own."""
    order = nested_dissection(K, locations)
    assert np.array_equal(np.sort(order), np.arange(K.shape[0]))
    options = {"SymmetricMode": True}
    ours = splu(
        K[order][:, order].tocsc(), permc_spec="NATURAL", diag_pivot_thresh=0.01, options=options
    )
    return ours.nnz, splu(K.tocsc()).nnz


# The orders reach 0.61, 0.62, 0.60, 0.49 and 0.75; the bounds leave room for another scipy.
@pytest.mark.parametrize(
    ("mesh", "element", "bound"),
    [
        (MeshQuad.init_tensor(*2 * [np.linspace(0, 1, 51)]), ElementQuad1(), 0.7),
        (MeshTri.init_tensor(*2 * [np.linspace(0, 1, 26)]), ElementTriP2(), 0.7),
        (_graded_mesh(2500), ElementTriP1(), 0.7),
        (_graded_mesh(1000), ElementTriP2(), 0.6),
        (MeshHex.init_tensor(*3 * [np.linspace(0, 1, 9)]), ElementHex1(), 0.85),
    ],
    ids=["quads", "P2", "graded P1", "graded P2", "hexahedra"],
)
def test_fill_is_less_than_that_of_colamd(mesh, element, bound):
    """[X] Number of entries of the factors, from SuperLU itself."""
    ours, colamd = _fills(*_system(mesh, element))
    assert ours < bound * colamd


def test_bodies_that_touch_but_are_not_coupled():
    """[X] Two grids with nodes in the same places: no more fill than twice that of one."""
    locations, K = _system(MeshQuad.init_tensor(*2 * [np.linspace(0, 1, 21)]), ElementQuad1())
    one, _ = _fills(locations, K)
    beside = locations + np.array([[1.0], [0.0]])
    two, _ = _fills(np.hstack([locations, beside]), block_diag([K, K]).tocsr())
    assert two < 2.1 * one  # the cuts of two bodies side by side fall otherwise than those of one


def test_unknowns_at_one_place_stay_together():
    """[X] Two coincident grids: the four unknowns of each place follow each other."""
    locations, K = _system(MeshQuad.init_tensor(*2 * [np.linspace(0, 1, 11)]), ElementQuad1())
    n = K.shape[0]
    order = nested_dissection(block_diag([K, K]).tocsr(), np.hstack([locations, locations]))
    place = order.reshape(-1, 4) % n // 2
    assert np.all(place == place[:, :1])


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_degenerate_input(dim):
    """[X] No coupling at all, full coupling, all unknowns at one place, one unknown:
    permutations.
    """
    scattered = np.random.default_rng(0).random((dim, 60))
    full = csr_matrix(np.ones((60, 60)))
    for graph, locations in [
        (csr_matrix((60, 60)), scattered),
        (full, scattered),
        (full, np.zeros((dim, 60))),
        (full[:1, :1], np.ones((dim, 1))),
    ]:
        order = nested_dissection(graph, locations)
        assert np.array_equal(np.sort(order), np.arange(graph.shape[0]))
