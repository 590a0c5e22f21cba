"""Round elastic blocks under rigid bodies: quarters and whole ones, finest under the middle of
their top.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import half_space
import numpy as np
from numpy import ndarray
from skfem import Basis, ElementHex1, ElementVector, FacetBasis, LinearForm, MeshHex, MeshQuad

import skfem_contact as sc

YOUNG, POISSON = 1000.0, 0.3
#: E* on a rigid body, and the shear modulus.
MODULUS, SHEAR_MODULUS = half_space.modulus(YOUNG, POISSON), YOUNG / 2 / (1 + POISSON)
WIDTH = 10.0


def growing(size: float, growth: float, end: float) -> ndarray:
    """Distances from 0 to about an end, whose steps grow from a size on."""
    away = np.append(0.0, np.cumsum(size * growth ** np.arange(60)))
    return away[: np.searchsorted(away, end) + 1]


def quarter_disc(m: int, inner: ndarray, outer: ndarray) -> MeshQuad:
    """A square of m x m elements and rings around it.

    Parameters
    ----------
    m
        Elements along a side of the square; the rings have 2 m in a quarter.
    inner
        Shares of the way from the square, 0, to the first circle, 1.
    outer
        Radii of the circles, of which the first one's is the first.
    """
    side = 0.6 * outer[0]
    core = MeshQuad.init_tensor(*[np.linspace(0, side, m + 1)] * 2)
    rings = MeshQuad.init_tensor(
        np.linspace(0, 2, 2 * m + 1), np.append(inner, 1 + np.arange(1, len(outer)))
    )
    t, level = rings.p
    edge = side * np.stack((np.minimum(1, 2 - t), np.minimum(1, t)))
    radius = np.interp(level, 1 + np.arange(len(outer)), outer)
    share, circle = (
        np.minimum(level, 1.0),
        radius * np.stack((np.cos(np.pi / 4 * t), np.sin(np.pi / 4 * t))),
    )
    return _joined(core, replace(rings, doflocs=(1 - share) * edge + share * circle))


def whole(quarter: MeshQuad) -> MeshQuad:
    """A disc from a quarter of it."""
    half = _joined(quarter, quarter.mirrored((1, 0)))
    return _joined(half, half.mirrored((0, 1)))


def _joined(*parts: MeshQuad) -> MeshQuad:
    """Meshes as one: coincident points become one."""
    p = np.hstack([part.p for part in parts])
    starts = np.cumsum([0] + [part.p.shape[1] for part in parts])
    _, first, number = np.unique(p.round(9), axis=1, return_index=True, return_inverse=True)
    t = np.hstack([part.t + start for part, start in zip(parts, starts[:-1], strict=True)])
    return MeshQuad(p[:, first], number.ravel()[t])


def drawn(section: MeshQuad, depth: ndarray) -> MeshHex:
    """A section drawn downwards."""
    n, (a, b, c, d) = section.p.shape[1], section.t
    p = np.hstack([np.vstack((section.p, np.full(n, -z))) for z in depth])
    order = np.stack((a + n, a, d + n, b + n, d, b, c + n, c))
    return MeshHex(p, np.hstack([order + k * n for k in range(len(depth) - 1)]))


@dataclass(frozen=True)
class Block:
    """An elastic block that is pressed onto a rigid body: its edges move as those of a half-space
    do.

    Attributes
    ----------
    basis
        Displacements; the boundary "contact" is what the rigid body may touch.
    """

    basis: Basis

    @classmethod
    def of(cls, mesh: MeshHex, near: Callable[[ndarray], ndarray]) -> Block:
        """A whole block, or the quarter x, y > 0 of one, with its top at z = 0; `near` tells of
        what may touch.
        """
        low, rim = mesh.p[2].min(), 0.98 * np.hypot(*mesh.p[:2]).max()
        x, y = mesh.p[:2].max(axis=1)
        named = {
            "contact": lambda p: np.isclose(p[2], 0.0) & near(p),
            "surface": lambda p: np.isclose(p[2], 0.0),
            "bottom": lambda p: np.isclose(p[2], low),
            "side": lambda p: (
                (np.hypot(*p[:2]) > rim) | np.isclose(np.abs(p[0]), x) | np.isclose(np.abs(p[1]), y)
            ),
        }
        if np.isclose(mesh.p[:2].min(), 0.0):
            named |= {
                "left": lambda p: np.isclose(p[0], 0.0),
                "front": lambda p: np.isclose(p[1], 0.0),
            }
        return cls(Basis(mesh.with_boundaries(named), ElementVector(ElementHex1()), intorder=2))

    def raised(self, height: Callable[[ndarray], ndarray]) -> Block:
        """The top moved up by a height, a function of coordinates, which fades towards the
        bottom.
        """
        mesh = self.basis.mesh
        fades = height(mesh.p) * (1 - mesh.p[2] / mesh.p[2].min())
        mesh = replace(mesh, doflocs=mesh.p + np.stack((0 * fades, 0 * fades, fades)))
        return Block(Basis(mesh, self.basis.elem, intorder=2))

    @cached_property
    def solid(self) -> sc.SolidForm:
        """The elastic body."""
        return sc.SolidForm(self.basis, sc.LinearElastic(E=YOUNG, nu=POISSON), "full")

    @property
    def share(self) -> float:
        """Of the whole block: one, or a quarter."""
        return 0.25 if "left" in self.basis.mesh.boundaries else 1.0

    @property
    def edges(self) -> ndarray:
        """Layout of the side and the bottom."""
        return self.basis.get_dofs({"side", "bottom"}).all()

    @property
    def fixed(self) -> ndarray:
        """Those, and the ones across the planes of symmetry."""
        if self.share == 1.0:
            return self.edges
        planes = [
            self.basis.get_dofs(name).all(f"u^{axis}") for name, axis in (("left", 1), ("front", 2))
        ]
        return np.unique(np.concatenate((self.edges, *planes)))

    def moved(self, depth: float, force: float, twist: float = 0.0) -> ndarray:
        """Displacements of the edges under a force: the rigid body stands still, the half-space
        rises and turns.
        """
        coordinates = self.basis.doflocs[:, self.edges[::3]]
        field = half_space.far_field(coordinates, force, YOUNG, POISSON)
        field += np.stack(
            (-twist * coordinates[1], twist * coordinates[0], np.full(coordinates.shape[1], depth))
        )
        x = self.basis.zeros()
        x[self.edges] = field.T.ravel()
        return x

    def contact(self, master: sc.Surface, mu: float = 0.0, **options) -> sc.ContactPair:
        """Contact with a rigid body."""
        return sc.ContactPair(self.basis, "contact", master, sc.Coulomb(mu=mu), **options)

    def touched(self, x: ndarray) -> Touched:
        """Nodes where the rigid body may touch."""
        dofs = np.unique(self.basis.get_dofs("contact").all()).reshape(-1, 3)
        surface = FacetBasis(self.basis.mesh, self.basis.elem, facets="contact", intorder=4)
        area = LinearForm(lambda v, w: v[2] * np.abs(w.n[2])).assemble(surface)[dofs[:, 2]]
        force = (self.solid.elastic_stiffness @ x)[dofs] / self.share
        return Touched(self.basis.doflocs[:2, dofs[:, 0]], force, area / self.share)


@dataclass(frozen=True)
class Touched:
    """Nodes of a surface: coordinates (2, n), forces on the whole block (n, 3) and areas that
    belong to the nodes.
    """

    coordinates: ndarray
    force: ndarray
    area: ndarray

    @property
    def r(self) -> ndarray:
        """Distances from the axis."""
        return np.hypot(*self.coordinates)

    @property
    def normal(self) -> ndarray:
        """Forces downwards."""
        return -self.force[:, 2]

    @property
    def torque(self) -> float:
        """Of the forces, about the axis, that the rigid body exerts."""
        x, y = self.coordinates
        return float(x @ self.force[:, 1] - y @ self.force[:, 0])

    @property
    def around(self) -> ndarray:
        """Tractions around the axis."""
        x, y = self.coordinates
        return (x * self.force[:, 1] - y * self.force[:, 0]) / (
            np.maximum(self.r, 1e-12) * self.area
        )

    @property
    def pressure(self) -> ndarray:
        """Forces downwards over areas."""
        return self.normal / self.area

    def circle(self, r: float) -> ndarray:
        """Which nodes lie on the circle of nodes that is nearest to r."""
        return np.isclose(self.r, self.r[np.argmin(np.abs(self.r - r))])
