"""Contents of files of meshes."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import MeshHex, MeshTet

from skfem_contact.mesh.content import (
    Content,
    _maybe_repeated,
    check_nodes,
    members_by_tag,
    short_keys,
    whole,
    without_doubles,
)


@pytest.mark.parametrize("dtype", [np.int32, np.int64, np.uint64])
@pytest.mark.parametrize("order", ["C", "F"])
def test_repeated_elements_are_left_out(dtype, order):
    """[X] Three of 48,000 tetrahedra again, with their nodes in other orders."""
    mesh = MeshTet.init_tensor(*[np.linspace(0, 1, 21)] * 3)
    cells = np.concatenate((mesh.t.T, mesh.t.T[[7, 40_000, 7], ::-1]))
    content = Content(mesh.p.T, {"tetra": cells.astype(dtype, order=order)})
    content.groups = {"last": {"tetra": np.arange(39_000, 48_003)}, "first": {"tetra": [48_000]}}
    without_doubles(content, "tetra")
    np.testing.assert_array_equal(content.cells["tetra"], mesh.t.T)
    group = {name: parts["tetra"].tolist() for name, parts in content.groups.items()}
    assert group == {"last": [7, *range(39_000, 48_000)], "first": [7]}


@pytest.mark.parametrize("kind", [MeshTet, MeshHex])
def test_different_elements_are_all_kept(kind):
    """[X] Some of 384,000 tetrahedra, and of 110,592 hexahedra, have the short key of another."""
    n = 41 if kind is MeshTet else 49
    mesh = kind.init_tensor(*[np.linspace(0, 1, n)] * 3)
    word = "tetra" if kind is MeshTet else "hexahedron"
    content = Content(mesh.p.T, {word: mesh.t.T})
    keys = np.empty((2, mesh.nelements), dtype=np.uint32)
    short_keys(mesh.t.T, keys)
    assert len(np.unique(keys[0])) < mesh.nelements
    maybe = _maybe_repeated(*keys)
    assert 1 < len(maybe) < 0.01 * mesh.nelements
    without_doubles(content, word)
    np.testing.assert_array_equal(content.cells[word], mesh.t.T)


def test_positions_of_tags():
    """[X] Positions of 70,000 tags in 7,000 runs of ten, and of one run, in ascending order."""
    for tags in (np.random.default_rng(3).integers(-5, 6, 7000).repeat(10), np.full(70_000, 4)):
        found = members_by_tag(tags)
        assert list(found) == np.unique(tags).tolist()
        for tag, members in found.items():
            np.testing.assert_array_equal(members, np.flatnonzero(tags == tag))


@pytest.mark.parametrize("wrong", [-1, 3, 2**40])
def test_nodes_that_do_not_exist(wrong):
    """[X] Nodes that are negative or too large are named as files count them, from one on."""
    cells = np.array([[0, 1, 2], [1, wrong, 0]])
    with pytest.raises(ValueError, match=f"a triangle has the node {wrong + 1} of 3: the number"):
        check_nodes(cells, 3, "triangle")
    check_nodes(cells[:1], 3, "triangle")


def test_numbers_of_a_table_are_whole():
    """[X] Floats count exactly below 2^53; fractions and larger ones are refused."""
    exact = np.array([-3.0, 0.0, 2.0**53 - 1.0])
    numbers = whole(exact, "node")
    assert numbers.dtype == np.int64
    assert numbers.tolist() == [-3, 0, 2**53 - 1]
    assert len(whole(np.zeros(0), "node")) == 0
    with pytest.raises(ValueError, match=r"a node has the number 2\.5, which is not whole"):
        whole(np.array([1.0, 2.5]), "node")
    for large in (2.0**53 + 2.0, -1e300, np.nan):
        with pytest.raises(ValueError, match="a node has a number that is too large"):
            whole(np.array([1.0, large]), "node")


def test_highest_dimension_of_elements_that_exist():
    """[X] Kinds without elements do not count, and points have no dimension."""
    points, triangle = np.zeros((3, 3)), np.array([[0, 1, 2]])
    flat = Content(points, {"tetra": np.zeros((0, 4), int), "triangle": triangle})
    assert flat.dim == 2
    assert Content(points, {}).dim == 0
