"""Quadratic meshes whose sides follow curves."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy import ndarray
from skfem import MeshQuad, MeshQuad2


def curved(
    mesh: MeshQuad, mapping: Callable[[ndarray, ndarray], tuple[ndarray, ndarray]]
) -> MeshQuad2:
    """The mesh with nine-node elements all of whose nodes are moved, (x, y) to new coordinates."""
    quadratic = MeshQuad2.from_mesh(mesh)
    return replace(quadratic, doflocs=np.stack(mapping(*quadratic.doflocs))).with_boundaries(
        mesh.boundaries
    )


def graded(size: float, fine: float, end: float, growth: float = 1.25) -> ndarray:
    """Coordinates from 0 to an end: equal steps of about a size as far as `fine`, and growing ones
    from there.
    """
    n = int(np.ceil(np.log1p((end - fine) * (growth - 1) / (growth * size)) / np.log(growth)))
    steps = np.cumsum(growth ** np.arange(n))
    return np.concatenate(
        (np.linspace(0, fine, round(fine / size) + 1), fine + steps * (end - fine) / steps[-1])
    )
