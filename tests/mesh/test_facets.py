"""Facets of large meshes, numbered as scikit-fem numbers them."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import MeshQuad1, MeshTet1, MeshTet2, MeshTri1, MeshTri2

from skfem_contact.mesh.facets import number_facets


@pytest.mark.parametrize("kind", [MeshTri1, MeshTri2, MeshTet1, MeshTet2])
def test_facets_are_the_ones_of_scikit_fem(kind):
    """[N] The same arrays, of nodes in random order."""
    straight = MeshTri1 if issubclass(kind, MeshTri1) else MeshTet1
    line = np.linspace(0, 1, 5)
    mesh = straight.init_tensor(*[line] * straight().dim())
    order = np.random.default_rng(3).permutation(mesh.nvertices)
    p = np.empty_like(mesh.p)
    p[:, order] = mesh.p
    mesh = straight(p, order[mesh.t])
    mesh = mesh if kind is straight else kind.from_mesh(mesh)
    wanted = (mesh.facets.copy(), mesh.t2f.copy(), mesh.f2t.copy())
    other = type(mesh)(mesh.doflocs, mesh.t)
    number_facets(other)
    for own, theirs in zip((other._facets, other._t2f, other._f2t), wanted):
        np.testing.assert_array_equal(own, theirs)
        assert own.dtype == theirs.dtype


def test_other_meshes_are_left_to_scikit_fem():
    """[X] Quadrilaterals have sides with other corners than triangles."""
    mesh = MeshQuad1().refined(1)
    mesh = MeshQuad1(mesh.p, mesh.t)
    number_facets(mesh)
    assert not hasattr(mesh, "_facets")


def test_elements_on_top_of_each_other():
    """[N] Three elements at one side: the first and the last of them are its neighbours."""
    tet = MeshTet1()
    tet = MeshTet1(tet.p, np.hstack((tet.t, tet.t[:, :2], tet.t[:, :1])), validate=False)
    other = MeshTet1(tet.p, tet.t, validate=False)
    number_facets(other)
    np.testing.assert_array_equal(other._f2t, tet.f2t)
    np.testing.assert_array_equal(other._t2f, tet.t2f)
