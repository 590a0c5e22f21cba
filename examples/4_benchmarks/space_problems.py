"""Problems in space of the contact benchmarks: skewed blocks, and a paraboloid on a block."""
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
    FacetBasis,
    LinearForm,
    MeshHex,
    MeshTet,
)

import skfem_contact as sc

YOUNG, POISSON = 1000.0, 0.3
RADIUS, WIDTH = 20.0, 10.0
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


def graded(size: float, fine: float, end: float, growth: float = 1.5) -> ndarray:
    """Coordinates from 0 to an end: steps of a size as far as `fine`, and growing ones from there."""
    steps, step = [], size
    while sum(steps) < end - fine:
        step *= growth
        steps.append(step)
    scaled = np.cumsum(steps) * (end - fine) / sum(steps)
    return np.concatenate((np.linspace(0, fine, round(fine / size) + 1), fine + scaled))


def paraboloid(n: int, depth: float = 0.05, element: str = "Q1") -> Problem:
    """A quarter of a paraboloid z = r^2 / 2R that is pressed onto a block: n elements in a unit of length."""
    def raised(p: ndarray) -> ndarray:
        bottom = (p[0] ** 2 + p[1] ** 2) / (2 * RADIUS)
        return np.stack((0 * p[0], 0 * p[1], bottom * (1 - p[2] / WIDTH)))

    below, above = graded(1.25 / n, 1.5, WIDTH), graded(1.0 / n, 1.5, WIDTH)
    lower = _block(element, below, below, -graded(1.25 / n, 0.75, WIDTH)[::-1], lambda p: 0 * p)
    upper = _block(element, above, above, graded(1.0 / n, 0.75, WIDTH), raised)
    basis = Basis(sc.join_bodies({"lower": lower, "upper": upper}), ElementVector(ELEMENTS[element][1]()),
                  intorder=ELEMENTS[element][2])
    axis, at = np.arange(basis.N) % 3, basis.doflocs
    held = np.isclose(np.abs(at[2]), WIDTH)
    held |= np.any([(axis == c) & np.isclose(at[c], 0.0) for c in (0, 1)], axis=0)
    return Problem(basis, np.flatnonzero(held), np.where((axis == 2) & np.isclose(at[2], WIDTH), -depth, 0.0))


@dataclass(frozen=True)
class Hertz:
    """Nodal forces under a paraboloid beside Hertz's solution for the same force (K. L. Johnson, eq. 4.22).

    Attributes
    ----------
    force
        On the whole paraboloid.
    half_width
        Relative error of the half-width, by the second moment of the pressures, which is 2 a^2 / 5.
    error
        Of nodal forces over nodal areas against Hertz's pressure at the nodes: its norm over that of the pressure.
    exact
        The same of exact nodal forces: what the mesh alone makes of the pressure's end.
    """

    force: float
    half_width: float
    error: float
    exact: float


def hertz(problem: Problem, x: ndarray) -> Hertz:
    """What displacements of a paraboloid on a block give."""
    basis = problem.basis
    dofs = np.unique(basis.get_dofs("upper:bottom").all()).reshape(-1, 3)
    surface = FacetBasis(basis.mesh, basis.elem, facets="upper:bottom", intorder=16)
    area = LinearForm(lambda v, w: v[2] * np.abs(w.n[2])).assemble(surface)[dofs[:, 2]]
    force = (problem.solid.elastic_stiffness @ x)[dofs[:, 2]]
    r, p, P = np.hypot(*basis.doflocs[:2, dofs[:, 0]]), force / area, 4 * force.sum()
    a = (3 * P * RADIUS * (1 - POISSON**2) / (2 * YOUNG)) ** (1 / 3)

    def pressure(r: ndarray) -> ndarray:
        return 1.5 * P / (np.pi * a**2) * np.sqrt(np.maximum(0, 1 - (r / a) ** 2))

    def error(p: ndarray) -> float:
        return float(np.sqrt(area @ (p - pressure(r)) ** 2 / (area @ pressure(r) ** 2)))

    loads = LinearForm(lambda v, w: v[2] * np.abs(w.n[2]) * pressure(np.hypot(*w.x[:2]))).assemble(surface)
    by_moment = np.sqrt(2.5 * force @ r**2 / force.sum())
    return Hertz(float(P), float(by_moment / a - 1), error(p), error(loads[dofs[:, 2]] / area))
