"""Elements that hold points: straight and curved ones, of all kinds and sizes."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import MeshHex1, MeshQuad, MeshQuad2, MeshTet1, MeshTet2, MeshTri1, MeshTri2

from skfem_contact.mesh.locate import _shapes, locate, outside

PLANE = [MeshTri1, MeshTri2, MeshQuad, MeshQuad2]
SPACE = [MeshTet1, MeshTet2, MeshHex1]


def bent(mesh):
    """The mesh with all nodes moved by a smooth map: sides of second order are curved."""
    moved = mesh.doflocs.copy()
    moved[0] += 0.08 * np.sin(3.0 * mesh.doflocs[1])
    moved[1] += 0.05 * mesh.doflocs[0] ** 2
    return type(mesh)(moved, mesh.t)


def searched(mesh, points, groups=None):
    """All elements of a mesh, searched for points (dim, n)."""
    elements = np.arange(mesh.nelements)
    if groups is None:
        groups = np.zeros(mesh.nelements, int)
    return locate(mesh, elements, points.T, groups)


@pytest.mark.parametrize("kind", PLANE + SPACE)
def test_reference_coordinates_give_the_points(kind):
    """[X] The map of every element takes the reference coordinates back to its points.

    Points are drawn in known elements: on curved ones these lie beyond the chords. Newton's method
    ends at 1e-12 of the reference element.
    """
    mesh = bent(kind().refined(2))
    rng = np.random.default_rng(3)
    dim = mesh.dim()
    local = rng.dirichlet(np.ones(dim + 1), size=400)[:, :dim].T
    element = rng.integers(mesh.nelements, size=400)
    nodes = mesh.doflocs[:, mesh.dofs.element_dofs[:, element]]
    points = np.einsum("dkn,kn->dn", nodes, _shapes(mesh.elem(), local)[0])
    found = searched(mesh, points)
    assert np.array_equal(found.elements, element)
    assert np.allclose(found.local, local, rtol=0.0, atol=1e-9)


def test_elements_of_very_different_sizes():
    """[X] Points in long thin elements, whose centres are far away, are found."""
    lines = np.concatenate(([0.0, 1e-3, 2e-3, 0.01, 0.1], np.linspace(1.0, 10.0, 3)))
    mesh = MeshTri1.init_tensor(lines, np.linspace(0.0, 100.0, 3))
    points = np.random.default_rng(0).uniform((0.0, 0.0), (10.0, 100.0), (300, 2)).T
    found = searched(mesh, points)
    corners = mesh.p[:, mesh.t[:, found.elements]]
    inside = (points >= corners.min(axis=1) - 1e-9) & (points <= corners.max(axis=1) + 1e-9)
    assert (found.elements >= 0).all() and inside.all()


@pytest.mark.parametrize("rows", [1, 8])
def test_points_between_groups_belong_to_the_first(rows):
    """[X] On the line between two groups, of one element each or of many, the smaller number is
    taken, whatever the order.
    """
    mesh = MeshQuad.init_tensor(np.linspace(0, 1, 2 * rows + 1), np.linspace(0, 1, rows + 1))
    left = mesh.p[0, mesh.t].mean(axis=0) < 0.5
    points = np.array([np.full(20, 0.5), np.linspace(0.0, 1.0, 20)])
    for groups in (left.astype(int), 1 - left.astype(int)):
        found = searched(mesh, points, groups)
        assert (groups[found.elements] == 0).all()


@pytest.mark.parametrize("kind", [MeshTri1, MeshQuad])
def test_distance_of_points_outside(kind):
    """[X] A point beyond the corner and one beside a side, by Pythagoras."""
    mesh = kind().refined(2)
    points = np.array([[1.3, 0.6], [1.4, -0.25]])
    found = searched(mesh, points)
    assert (found.elements == -1).all()
    elements = np.arange(mesh.nelements)
    assert ", 0.5 from the nearest one, at (1, 1)" in outside(mesh, elements, points[:, :1].T)
    assert ", 0.25 from the nearest one, at (0.6, 0)" in outside(mesh, elements, points[:, 1:].T)
