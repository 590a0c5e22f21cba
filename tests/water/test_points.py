"""Values at any coordinates of porous ground."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import Mesh, MeshHex, MeshQuad, MeshTet, MeshTri

from skfem_contact.water.points import simplices


@pytest.mark.parametrize(
    "mesh", [MeshTri(), MeshQuad(), MeshTet(), MeshHex()], ids=lambda m: type(m).__name__
)
def test_parts_of_elements_fill_them_once(mesh: Mesh, rng: np.random.Generator) -> None:
    """[X] Random points of a unit square or cube lie in one triangle or tetrahedron each."""
    corners = mesh.p[:, simplices(mesh, np.arange(mesh.nelements))]  # (dim, dim + 1, n)
    x = rng.random((mesh.dim(), 1000))
    edges = np.moveaxis(corners[:, 1:] - corners[:, :1], 2, 0)
    apart = x[None] - corners[:, 0].T[:, :, None]
    inner = np.linalg.solve(edges, apart)  # (n, dim, 1000)
    inside = (inner > 0.0).all(axis=1) & (inner.sum(axis=1) < 1.0)
    assert (inside.sum(axis=0) == 1).all()
    volumes = np.abs(np.linalg.det(edges)) / (2.0 if mesh.dim() == 2 else 6.0)
    assert volumes.sum() == pytest.approx(1.0, rel=1e-12)
