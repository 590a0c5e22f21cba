"""The contact problems of this chapter: meshes, supports, exact solutions and error measures.

All of them are in plane strain with one elastic material, and are driven by displacements of the
top.  Pressures are taken from nodal forces: the force on a node of the upper body's lower face over
the width that belongs to it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy import ndarray
from skfem import (
    Basis,
    ElementQuad1,
    ElementQuad2,
    ElementTriP1,
    ElementTriP2,
    ElementVector,
    MeshQuad,
    MeshTri,
)

import skfem_contact as sc

E, NU, MU = 1000.0, 0.3, 0.4

ELEMENTS = {  # mesh, element, order of the quadrature in the bodies
    "Q1": (MeshQuad, ElementQuad1, 2),
    "P1": (MeshTri, ElementTriP1, 2),
    "Q2": (MeshQuad, ElementQuad2, 4),
    "P2": (MeshTri, ElementTriP2, 2),
}
LOWER, UPPER = "lower:top", "upper:bottom"


@dataclass(frozen=True)
class Problem:
    """Two bodies with their supports.

    Attributes
    ----------
    basis
        Displacements of both bodies.
    fixed
        Dofs that are held or moved.
    pressed, shifted
        Displacements at the end of the normal and of the tangential loading, (N,).
    """

    basis: Basis
    fixed: ndarray
    pressed: ndarray
    shifted: ndarray

    @cached_property
    def solid(self) -> sc.SolidForm:
        """Both bodies."""
        return sc.SolidForm(self.basis, sc.LinearElastic(E=E, nu=NU))

    @cached_property
    def face(self) -> sc.Surface:
        """Lower face of the upper body, on which tractions are measured."""
        return sc.Surface.from_boundary(self.basis, UPPER)

    def pair(
        self, mu: float, quadrature: str | int, slave: str = UPPER, **options
    ) -> sc.ContactPair:
        """Contact between the bodies; further options as for
        :class:`~skfem_contact.ContactPair`.
        """
        master = LOWER if slave == UPPER else UPPER
        return sc.ContactPair(self.basis, slave, master, sc.Coulomb(mu=mu), quadrature, **options)

    def run(self, pair: sc.ContactPair, stages: list[sc.Stage], **settings) -> sc.results.Result:
        """Run stages; settings are those of :class:`~skfem_contact.Model`."""
        model = sc.Model({"bodies": self.solid, "contact": pair}, self.fixed, **settings)
        return model.run(stages, progress=False)

    def stage(
        self, name: str, normal: float = 1.0, tangential: float = 0.0, increments: int = 1
    ) -> sc.Stage:
        """A stage that ends at these shares of the normal and the tangential loading."""
        x = normal * self.pressed + tangential * self.shifted
        return sc.Stage(name, self.basis.zeros(), x, increments)

    def nodal_tractions(self, x: ndarray) -> tuple[ndarray, ndarray, ndarray]:
        """Places of the face's nodes along x, widths that belong to them and forces per width, (n,
        2).
        """
        nodes, segments = self.face.nodes[:, 0], self.face.facets
        # integrals of the shape functions of a segment
        shares = [1 / 2, 1 / 2] if segments.shape[1] == 2 else [1 / 6, 1 / 6, 2 / 3]
        widths = np.abs(nodes[segments[:, 1]] - nodes[segments[:, 0]])[:, None] * shares
        width = np.bincount(segments.ravel(), widths.ravel())
        force = (self.solid.elastic_stiffness @ x[: self.basis.N])[
            self.face.dofs
        ]  # multipliers follow
        order = np.argsort(nodes)
        return nodes[order], width[order], (force / width[:, None])[order]


def _two_bodies(lower, upper, element: str) -> Basis:
    mesh = sc.join_bodies({"lower": lower, "upper": upper})
    _, kind, order = ELEMENTS[element]
    return Basis(mesh, ElementVector(kind()), intorder=order)


# -- patch test


def patch(n: int, element: str = "Q1", slope: float = 0.0, stuck: bool = False) -> Problem:
    """Two blocks of unit width under the pressure 1, meshed with n and with 1.4 n elements across.

    Parameters
    ----------
    n
        Elements across the lower block.
    element
        Name of an element, of :data:`ELEMENTS`.
    slope
        Slope of the interface; at zero both blocks are square.
    stuck
        Friction holds the blocks together.  Then, and if the interface is level, the right sides
        are free; across a frictionless slope only an equal pressure from all sides is in
        equilibrium.
    """

    def block(m: int, below: bool):
        t = np.linspace(0, 1, m + 1)
        mesh = ELEMENTS[element][0].init_tensor(t, t).with_defaults()
        x, y = mesh.p
        interface = 1 + slope * (x - 0.5)
        return replace(
            mesh, doflocs=np.stack((x, interface * y if below else interface + (2 - interface) * y))
        )

    basis = _two_bodies(block(n, True), block(max(n + 1, round(1.4 * n)), False), element)
    left = [("lower:left", "u^1", 0.0), ("upper:left", "u^1", 0.0)]
    bottom = [("lower:bottom", "u^2", 0.0)]
    if stuck or slope == 0.0:
        held = left + bottom + [("upper:top", "u^2", -2 * (1 - NU**2) / E)]
    else:
        shrinkage = (1 + NU) * (1 - 2 * NU) / E
        right = [("lower:right", "u^1", -shrinkage), ("upper:right", "u^1", -shrinkage)]
        held = left + right + bottom + [("upper:top", "u^2", -2 * shrinkage)]
    x, fixed = basis.zeros(), []
    for boundary, component, value in held:
        dofs = basis.get_dofs(boundary).all(component)
        x[dofs] = value
        fixed.append(dofs)
    fixed = np.unique(np.concatenate(fixed))
    if stuck:  # friction holds the interface: rollers there would hold it twice
        height = basis.doflocs[1, fixed]
        fixed = fixed[(height == 0.0) | (height == 2.0)]
    return Problem(basis, fixed, x, basis.zeros())


def patch_errors(problem: Problem, x: ndarray) -> tuple[float, float]:
    """Largest deviations of the pressure at the nodes and of the vertical stress from their means,
    relative.
    """
    _, width, traction = problem.nodal_tractions(x)
    pressure = traction[:, 1]  # the rollers at the sides carry no vertical force
    stress = problem.solid.assemble(x, problem.solid.initial_state()).state.stress[1]
    mean = np.average(pressure, weights=width)
    return float(np.abs(pressure / mean - 1).max()), float(np.abs(stress / stress.mean() - 1).max())


# -- Hertz and Cattaneo-Mindlin

RADIUS, WIDTH, HEIGHT = 50.0, 20.0, 20.0
APPROACH, SHIFT = 0.038, 0.0135  # the half-width of the contact becomes 1, the stick zone's 0.65


def graded(h: float, fine: float, end: float, growth: float = 1.2) -> ndarray:
    """Coordinates from 0 to `end`: the spacing is h up to `fine`, and grows from there."""
    n = int(np.ceil(np.log1p((end - fine) * (growth - 1) / (growth * h)) / np.log(growth)))
    steps = np.cumsum(growth ** np.arange(n))
    return np.concatenate(
        (np.linspace(0, fine, round(fine / h) + 1), fine + steps * (end - fine) / steps[-1])
    )


def hertz(n: int) -> Problem:
    """A parabola on a block, with n elements of it and 0.8 n of the block in the half-width of the
    contact.
    """

    def block(h: float):
        half = graded(h, 2.0, WIDTH)
        return np.concatenate((-half[:0:-1], half)), graded(h, 1.0, HEIGHT)

    x, y = block(1.25 / n)
    lower = MeshQuad.init_tensor(x, -y[::-1]).with_defaults()
    x, y = block(1 / n)
    upper = MeshQuad.init_tensor(x, y).with_defaults()
    profile = upper.p[0] ** 2 / (2 * RADIUS)
    upper = replace(
        upper, doflocs=np.stack((upper.p[0], profile + (1 - profile / HEIGHT) * upper.p[1]))
    )
    basis = _two_bodies(lower, upper, "Q1")
    top, pressed, shifted = basis.get_dofs("upper:top"), basis.zeros(), basis.zeros()
    pressed[top.all("u^2")] = -APPROACH
    shifted[top.all("u^1")] = SHIFT
    fixed = np.concatenate((basis.get_dofs("lower:bottom").all(), top.all()))
    return Problem(basis, fixed, pressed, shifted)


@dataclass(frozen=True)
class Contact:
    """Tractions along the contact of the parabola, beside the exact ones for the same forces.

    Attributes
    ----------
    x, width
        Places of the nodes and widths that belong to them.
    pressure, shear
        Tractions there.
    """

    x: ndarray
    width: ndarray
    pressure: ndarray
    shear: ndarray

    @classmethod
    def of(cls, problem: Problem, x: ndarray) -> Contact:
        """Tractions at some displacements."""
        position, width, traction = problem.nodal_tractions(x)
        return cls(position, width, traction[:, 1], -traction[:, 0])

    @property
    def normal_force(self) -> float:
        """Force with which the bodies are pressed together."""
        return float(self.pressure @ self.width)

    @property
    def shear_force(self) -> float:
        """Force by which the upper body is shifted."""
        return float(self.shear @ self.width)

    @property
    def half_width(self) -> float:
        """Hertz: half the width of the contact."""
        return float(np.sqrt(4 * self.normal_force * RADIUS / np.pi * 2 * (1 - NU**2) / E))

    @property
    def peak(self) -> float:
        """Hertz: the largest pressure."""
        return 2 * self.normal_force / (np.pi * self.half_width)

    def exact_pressure(self, x: ndarray) -> ndarray:
        """Hertz: the pressure."""
        return self.peak * ellipse(x, self.half_width)

    def error(self, computed: ndarray, exact: ndarray) -> float:
        """Relative error in the L2 norm."""
        return float(np.sqrt((computed - exact) ** 2 @ self.width / (exact**2 @ self.width)))

    @property
    def pressure_error(self) -> float:
        """Error of the pressure in the L2 norm."""
        return self.error(self.pressure, self.exact_pressure(self.x))

    @property
    def peak_error(self) -> float:
        """Error of the largest pressure."""
        return float(self.pressure.max() / self.peak - 1)

    def stick_width(self, mu: float) -> float:
        """Cattaneo and Mindlin: half the width of the zone that sticks."""
        return float(self.half_width * np.sqrt(1 - self.shear_force / (mu * self.normal_force)))

    def exact_shear(self, x: ndarray, mu: float) -> ndarray:
        """Cattaneo and Mindlin: friction less what the stick zone takes back."""
        a, c = self.half_width, self.stick_width(mu)
        return mu * self.peak * (ellipse(x, a) - c / a * ellipse(x, c))

    def shear_error(self, mu: float) -> float:
        """Error of the shear traction in the L2 norm."""
        return self.error(self.shear, self.exact_shear(self.x, mu))

    def exact_reversed_shear(self, x: ndarray, mu: float, largest: float) -> ndarray:
        """The same after the shear force has fallen from its largest value: slip comes back from
        the edge.
        """
        a, friction = self.half_width, mu * self.normal_force
        stuck = a * np.sqrt(1 - largest / friction)  # has never slipped
        turned = a * np.sqrt(
            1 - (largest - self.shear_force) / (2 * friction)
        )  # has not slipped back
        sticks = 2 * turned / a * ellipse(x, turned) - stuck / a * ellipse(x, stuck)
        return mu * self.peak * (sticks - ellipse(x, a))

    def stick_error(self, mu: float) -> float:
        """Error of the width of the stick zone: the nodes around the deepest one below 95 % of the
        friction.
        """
        sticks = (self.shear < 0.95 * mu * self.pressure) & (self.pressure > 0.02 * self.peak)
        deepest = np.argmax(mu * self.pressure - self.shear)
        slips = np.flatnonzero(~sticks)
        first, last = slips[slips < deepest].max() + 1, slips[slips > deepest].min() - 1
        computed = self.x[last] - self.x[first] + self.width[deepest]
        return float(computed / (2 * self.stick_width(mu)) - 1)


def ellipse(x: ndarray, a: float) -> ndarray:
    """sqrt(1 - x^2/a^2) within a, and zero outside."""
    return np.sqrt(np.maximum(0.0, 1 - (x / a) ** 2))
