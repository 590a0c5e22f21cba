"""Problems in space of the contact benchmarks: skewed blocks."""
from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy import ndarray
from skfem import (
    Basis,
    ElementHex1,
    ElementHex2,
    ElementHexS2,
    ElementTetP1,
    ElementTetP2,
    ElementVector,
    MeshHex,
    MeshTet,
)

import skfem_contact as sc

YOUNG, POISSON = 1000.0, 0.3
#: Mesh, element, degree of the integration and elements across the lower block.
ELEMENTS = {
    "P1": (MeshTet, ElementTetP1, 2, 4), "P2": (MeshTet, ElementTetP2, 2, 3), "Q1": (MeshHex, ElementHex1, 2, 4),
    "S2": (MeshHex, ElementHexS2, 4, 2), "Q2": (MeshHex, ElementHex2, 4, 2),
}  # fmt: skip


@dataclass(frozen=True)
class Problem:
    """Two blocks, "upper:bottom" on "lower:top", the unknowns that are held and what they are displaced by."""

    basis: Basis
    fixed: ndarray
    pressed: ndarray

    @property
    def solid(self) -> sc.SolidForm:
        """Both blocks."""
        return sc.SolidForm(self.basis, sc.LinearElastic(E=YOUNG, nu=POISSON), sc.three_dimensional)


def _block(element: str, x: ndarray, y: ndarray, z: ndarray, motion):
    """A block with boundaries bottom and top, its nodes moved."""
    mesh = ELEMENTS[element][0].init_tensor(x, y, z)
    low, high = z.min(), z.max()
    mesh = mesh.with_boundaries({"bottom": lambda p: np.isclose(p[2], low), "top": lambda p: np.isclose(p[2], high)})
    return replace(mesh, doflocs=mesh.doflocs + motion(mesh.doflocs))


def patch(element: str, skew: float = 0.12) -> Problem:
    """Unit cubes of n and 1.4 n elements across, the upper one's skewed, pressed by 0.1 % of their heights."""
    n = ELEMENTS[element][3]
    below, above = (np.linspace(0, 1, k + 1) for k in (n, max(n + 1, round(1.4 * n))))
    lower = _block(element, below, below, below - 1, lambda p: 0 * p)
    upper = _block(element, above, above, above, lambda p: skew * np.sin(np.pi * p[0]) * np.sin(np.pi * p[1])
                   * np.array([[1.0], [-0.7], [0.0]]))  # fmt: skip
    basis = Basis(sc.join_bodies({"lower": lower, "upper": upper}), ElementVector(ELEMENTS[element][1]()),
                  intorder=ELEMENTS[element][2])
    axis, at = np.arange(basis.N) % 3, basis.doflocs
    top = (axis == 2) & np.isclose(at[2], 1.0)
    held = top | ((axis == 2) & np.isclose(at[2], -1.0))
    held |= np.any([(axis == c) & np.isclose(at[c], 0.0) for c in (0, 1)], axis=0)
    return Problem(basis, np.flatnonzero(held), np.where(top, -2.0 / YOUNG, 0.0))
