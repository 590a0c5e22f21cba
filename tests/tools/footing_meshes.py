"""Meshes of the ground below footings."""

from __future__ import annotations

import numpy as np
from numpy import ndarray
from skfem import MeshQuad


def graded(length: float, n: int, ratio: float = 3.0) -> ndarray:
    """Distances from 0 to a length that grow by exp(ratio)."""
    return length * np.expm1(ratio * np.linspace(0, 1, n + 1)) / np.expm1(ratio)


def ground(n: int, width: float, depth: float) -> MeshQuad:
    """Half of the ground below a footing of half width 1, finest at its edge, with n elements below
    the footing.
    """
    x = np.concatenate((1 - graded(1.0, n, 2.0)[::-1], 1 + graded(width - 1, 2 * n, 4.0)[1:]))
    mesh = MeshQuad.init_tensor(x, -graded(depth, 3 * n // 2)[::-1])
    return mesh.with_boundaries(
        {
            "footing": lambda p: (p[1] > -1e-9) & (p[0] < 1 + 1e-9),
            "beside": lambda p: (p[1] > -1e-9) & (p[0] > 1 - 1e-9),
            "bottom": lambda p: p[1] < -depth + 1e-9,
            "sides": lambda p: (p[0] < 1e-9) | (p[0] > width - 1e-9),
        }
    )
