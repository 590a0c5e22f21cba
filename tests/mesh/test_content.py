"""Contents of files of meshes."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import MeshHex, MeshTet

from skfem_contact.mesh.content import Content, _maybe_repeated, without_doubles


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
    """[X] Some of 162,000 tetrahedra, and of 110,592 hexahedra, have the short key of another."""
    n = 31 if kind is MeshTet else 49
    mesh = kind.init_tensor(*[np.linspace(0, 1, n)] * 3)
    word = "tetra" if kind is MeshTet else "hexahedron"
    content = Content(mesh.p.T, {word: mesh.t.T})
    assert len(_maybe_repeated(mesh.t.T)) > 100
    without_doubles(content, word)
    np.testing.assert_array_equal(content.cells[word], mesh.t.T)
