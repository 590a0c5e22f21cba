"""Problems in space of the contact benchmarks: skewed blocks, and a paraboloid on a block."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property

import half_space
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
    MeshHex2,
    MeshTet,
)

import skfem_contact as sc

YOUNG, POISSON = 1000.0, 0.3
RADIUS, WIDTH = 20.0, 10.0
#: E* of the two bodies.
MODULUS = half_space.modulus(YOUNG, POISSON, bodies=2)
#: Surfaces near the middle, which may touch.
SLAVE, MASTER = "upper:contact", "lower:contact"
#: Mesh, element, degree of the integration and elements across the lower block.
ELEMENTS = {
    "P1": (MeshTet, ElementTetP1, 2, 4),
    "P2": (MeshTet, ElementTetP2, 2, 3),
    "Q1": (MeshHex, ElementHex1, 2, 4),
    "S2": (MeshHex, ElementHexS2, 4, 2),
    "Q2": (MeshHex, ElementHex2, 4, 2),
}


@dataclass(frozen=True)
class Problem:
    """Two blocks, "upper:bottom" on "lower:top", the unknowns that are held and what they are
    displaced by.

    Attributes
    ----------
    basis, fixed
        Displacements of both blocks, and those of them that are held.
    pressed
        What the held ones are displaced by.
    symmetries
        Planes of symmetry: two of a quarter.
    """

    basis: Basis
    fixed: ndarray
    pressed: ndarray
    symmetries: int = 2

    @cached_property
    def solid(self) -> sc.SolidForm:
        """Both blocks."""
        return sc.SolidForm(self.basis, sc.LinearElastic(E=YOUNG, nu=POISSON), "full")


def _block(
    element: str,
    x: ndarray,
    y: ndarray,
    z: ndarray,
    motion,
    near: float = np.inf,
    curved: bool = False,
):
    """A block with boundaries bottom, top and, near the axis, contact at z = 0; its nodes moved.

    The facets of quadratic elements follow the motion where they are to be `curved`.
    """
    mesh = ELEMENTS[element][0].init_tensor(x, y, z)
    low, high = z.min(), z.max()
    mesh = mesh.with_boundaries(
        {
            "bottom": lambda p: np.isclose(p[2], low),
            "top": lambda p: np.isclose(p[2], high),
            "contact": lambda p: np.isclose(p[2], 0.0) & (np.abs(p[:2]).max(axis=0) < near),
        }
    )
    if curved and element == "Q2":
        mesh = MeshHex2.from_mesh(mesh).with_boundaries(mesh.boundaries)
    return replace(mesh, doflocs=mesh.doflocs + motion(mesh.doflocs))


def patch(element: str, skew: float = 0.12) -> Problem:
    """Unit cubes of n and 1.4 n elements across, the upper one's skewed, pressed by 0.1 % of their
    heights.
    """
    n = ELEMENTS[element][3]
    below, above = (np.linspace(0, 1, k + 1) for k in (n, max(n + 1, round(1.4 * n))))
    lower = _block(element, below, below, below - 1, lambda p: 0 * p)
    upper = _block(
        element,
        above,
        above,
        above,
        lambda p: (
            skew * np.sin(np.pi * p[0]) * np.sin(np.pi * p[1]) * np.array([[1.0], [-0.7], [0.0]])
        ),
    )
    basis = Basis(
        sc.join_bodies({"lower": lower, "upper": upper}),
        ElementVector(ELEMENTS[element][1]()),
        intorder=ELEMENTS[element][2],
    )
    axis, at = np.arange(basis.N) % 3, basis.doflocs
    top = (axis == 2) & np.isclose(at[2], 1.0)
    held = top | ((axis == 2) & np.isclose(at[2], -1.0))
    held |= np.any([(axis == c) & np.isclose(at[c], 0.0) for c in (0, 1)], axis=0)
    return Problem(basis, np.flatnonzero(held), np.where(top, -2.0 / YOUNG, 0.0))


def graded(size: float, fine: float, end: float, growth: float = 1.5) -> ndarray:
    """Coordinates from 0 to an end: steps of a size as far as `fine`, and growing ones from
    there.
    """
    steps, step = [], size
    while sum(steps) < end - fine:
        step *= growth
        steps.append(step)
    scaled = np.cumsum(steps) * (end - fine) / sum(steps)
    return np.concatenate((np.linspace(0, fine, round(fine / size) + 1), fine + scaled))


def _on_a_block(
    element: str, radius: float, near: float, lower: tuple[ndarray, ...], upper: tuple[ndarray, ...]
) -> Basis:
    """A paraboloid z = r^2 / 2R on a block, each by its coordinates along the axes."""

    def raised(p: ndarray) -> ndarray:
        bottom = (p[0] ** 2 + p[1] ** 2) / (2 * radius)
        return np.stack((0 * p[0], 0 * p[1], bottom * (1 - p[2] / WIDTH)))

    blocks = {
        "lower": _block(element, *lower, lambda p: 0 * p, near, curved=True),
        "upper": _block(element, *upper, raised, near, curved=True),
    }
    return Basis(
        sc.join_bodies(blocks), ElementVector(ELEMENTS[element][1]()), intorder=ELEMENTS[element][2]
    )


def paraboloid(n: int, depth: float = 0.05, element: str = "Q1") -> Problem:
    """A quarter of a paraboloid z = r^2 / 2R that is pressed onto a block: n elements in a unit of
    length.
    """
    below, above = graded(1.25 / n, 1.5, WIDTH), graded(1.0 / n, 1.5, WIDTH)
    basis = _on_a_block(
        element,
        RADIUS,
        1.5,
        (below, below, -graded(1.25 / n, 0.75, WIDTH)[::-1]),
        (above, above, graded(1.0 / n, 0.75, WIDTH)),
    )
    axis, at = np.arange(basis.N) % 3, basis.doflocs
    held = np.isclose(np.abs(at[2]), WIDTH)
    held |= np.any([(axis == c) & np.isclose(at[c], 0.0) for c in (0, 1)], axis=0)
    return Problem(
        basis, np.flatnonzero(held), np.where((axis == 2) & np.isclose(at[2], WIDTH), -depth, 0.0)
    )


@dataclass(frozen=True)
class Sheared(Problem):
    """Blocks that are pressed together, and then displaced sideways.

    Attributes
    ----------
    shifted
        Displacements by one, (N,).
    """

    shifted: ndarray = field(default_factory=lambda: np.zeros(0))


#: The flat paraboloid that is sheared: it slides by less than a hundredth of the contact, as
#: Mindlin's theory wants.
FLAT_RADIUS = 10 * RADIUS


def sheared_paraboloid(n: int, depth: float = 0.005) -> Sheared:
    """Half of a flat paraboloid on a block, y > 0, n elements in a unit of length."""

    def lines(size: float) -> tuple[ndarray, ndarray, ndarray]:
        y, z = (graded(size, fine, WIDTH, growth=2.0) for fine in (1.25, 0.75))
        return np.concatenate((-y[:0:-1], y)), y, z

    (x, y, z), upper = lines(1.25 / n), lines(1.0 / n)
    basis = _on_a_block("Q1", FLAT_RADIUS, 1.25, (x, y, -z[::-1]), upper)
    axis, at = np.arange(basis.N) % 3, basis.doflocs
    held, top = np.isclose(np.abs(at[2]), WIDTH), np.isclose(at[2], WIDTH)
    held |= (axis == 1) & np.isclose(at[1], 0.0)
    return Sheared(
        basis,
        np.flatnonzero(held),
        np.where(top & (axis == 2), -depth, 0.0),
        1,
        np.where(top & (axis == 0), 1.0, 0.0),
    )


@dataclass(frozen=True)
class Nodes:
    """Nodes of the paraboloid's face.

    Attributes
    ----------
    basis, dofs
        Of the blocks, and the unknowns of the nodes, (n, 3).
    force
        Nodal forces on the face, (n, 3).
    """

    basis: Basis
    dofs: ndarray
    force: ndarray

    @classmethod
    def of(cls, problem: Problem, x: ndarray) -> Nodes:
        """At displacements, which multipliers may follow."""
        dofs = np.unique(problem.basis.get_dofs("upper:bottom").all()).reshape(-1, 3)
        return cls(
            problem.basis, dofs, (problem.solid.elastic_stiffness @ x[: problem.basis.N])[dofs]
        )

    @property
    def r(self) -> ndarray:
        """Distances from the axis, (n,)."""
        return np.hypot(*self.basis.doflocs[:2, self.dofs[:, 0]])

    @cached_property
    def area(self) -> ndarray:
        """What belongs to the nodes: integrals of their shape functions, projected onto the plane z
        = 0.
        """
        return self.exact(np.ones_like)

    def exact(self, traction: Callable[[ndarray], ndarray]) -> ndarray:
        """Forces of a traction, a function of r: what each node has to carry of it."""
        surface = FacetBasis(self.basis.mesh, self.basis.elem, facets="upper:bottom", intorder=16)
        form = LinearForm(lambda v, w: v[2] * np.abs(w.n[2]) * traction(np.hypot(*w.x[:2])))
        return form.assemble(surface)[self.dofs[:, 2]]

    def norm(self, force: ndarray) -> float:
        """Of the tractions that nodal forces stand for, over the face."""
        return float(np.sqrt((force**2 / self.area).sum()))


@dataclass(frozen=True)
class Hertz:
    """Nodal forces under a paraboloid beside Hertz's solution for the same force (K. L. Johnson,
    eq. 4.22).

    Attributes
    ----------
    force
        On the whole paraboloid.
    half_width
        Relative error of the half-width, by the second moment of the pressures, which is 2 a^2 / 5.
    error
        Of nodal forces over nodal areas against Hertz's pressure at the nodes: its norm over that
        of the pressure.
    exact
        The same of exact nodal forces: what the mesh alone makes of the pressure's end.
    forces
        Error of the nodal forces against those of Hertz's pressure: its norm over theirs.
    """

    force: float
    half_width: float
    error: float
    exact: float
    forces: float


def hertz(problem: Problem, x: ndarray) -> Hertz:
    """What displacements of a paraboloid on a block give."""
    nodes = Nodes.of(problem, x)
    force, r, area = nodes.force[:, 2], nodes.r, nodes.area
    P = 4 * force.sum()
    a, peak = half_space.hertz(P, RADIUS, MODULUS)

    def error(forces: ndarray, exact: ndarray) -> float:
        return nodes.norm(forces - exact) / nodes.norm(exact)

    at_nodes, exact = (
        area * peak * half_space.dome(r, a),
        nodes.exact(lambda r: peak * half_space.dome(r, a)),
    )
    by_moment = np.sqrt(2.5 * force @ r**2 / force.sum())
    return Hertz(
        float(P),
        float(by_moment / a - 1),
        error(force, at_nodes),
        error(exact, at_nodes),
        error(force, exact),
    )
