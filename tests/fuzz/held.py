"""Dual multipliers where supports hold the ends of a joint along it, in one body or in both."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy import ndarray
from skfem import Basis, ElementVector, Mesh

import skfem_contact as sc
from skfem_contact.results import Result

from .cases import Case, Check, apart
from .halves import KINDS

E, NU = 1e4, 0.3


@dataclass(frozen=True)
class Walls:
    """Two blocks between smooth walls, upon each other, whose joint ends at the walls."""

    element: str
    kind: str
    held: tuple[bool, bool]
    mu: float
    elements: tuple[int, int]
    width: float
    pressure: float

    def __str__(self) -> str:
        held = " and ".join(name for name, is_held in zip(("low", "up"), self.held) if is_held)
        return (
            f"{self.elements[0]} on {self.elements[1]} between walls that hold {held}, "
            f"{self.kind}, {self.element}, mu {self.mu:.2f}, width {self.width:.2f}"
        )

    @property
    def dim(self) -> int:
        return 3 if self.element == "Hex8" else 2

    def grid(self, n: int, low: float) -> Mesh:
        """Mesh of one block of height 1."""
        across = np.linspace(0.0, self.width, n + 1)
        lines = [across, *[np.linspace(0.0, 1.0, 2)] * (self.dim - 2), [low, low + 0.5, low + 1.0]]
        mesh = KINDS[self.element][0].init_tensor(*map(np.asarray, lines))
        sides = {"left": (0, 0.0), "right": (0, self.width), "bottom": (-1, low)}
        sides["top"] = (-1, low + 1.0)
        if self.dim == 3:
            sides |= {"front": (1, 0.0), "back": (1, 1.0)}
        return mesh.with_boundaries(
            {
                name: lambda x, i=i, at=at: np.abs(x[i] - at) < 1e-9
                for name, (i, at) in sides.items()
            }
        )

    def result(self) -> Result:
        """Press the blocks by a uniform traction, and take back more than half of it."""
        mesh = sc.join_bodies(
            {"low": self.grid(self.elements[1], 0.0), "up": self.grid(self.elements[0], 1.0)}
        )
        order = 4 if self.element in ("Q2", "P2") else 2
        basis = Basis(mesh, ElementVector(KINDS[self.element][1]()), intorder=order)
        coordinates = self.kind if self.dim == 2 else "space"
        soil = sc.LinearElastic(E, self.nu)
        forms = {
            "solid": sc.SolidForm(basis, soil, coordinates=coordinates),
            "joint": sc.ContactPair(
                basis,
                "up:bottom",
                "low:top",
                sc.Coulomb(self.mu),
                enforcement=sc.DualMultipliers(),
            ),
        }
        fixed = [basis.get_dofs("low:bottom").all(f"u^{self.dim}")]
        walls = {"left": 1, "right": 1, **({"front": 2, "back": 2} if self.dim == 3 else {})}
        for body, is_held in zip(("low", "up"), self.held):
            for side, component in walls.items():
                # Without a wall one side is held: nothing strains across, where nu is zero
                if is_held or side in ("left", "front"):
                    fixed.append(basis.get_dofs(f"{body}:{side}").all(f"u^{component}"))
        model = sc.Model(forms, np.unique(np.concatenate(fixed)))
        down = (*[0.0] * (self.dim - 1), -self.pressure)
        load = model.traction("up:top", down)
        return model.run([sc.Stage("press", load), sc.Stage("less", 0.4 * load)], progress=False)

    @property
    def nu(self) -> float:
        return NU if all(self.held) else 0.0


def held(seed: int, rng: np.random.Generator) -> Case:
    """Draw blocks between walls, or a fit that is pushed out."""
    element = str(rng.choice(["Q1", "Q2", "P1", "P2", "Hex8"]))
    n, below = (int(rng.integers(1, 6)) for _ in range(2))
    mu = float(rng.uniform(0.05, 0.6))
    kind = str(rng.choice(["plane", "axisymmetric"]))
    if rng.random() < 0.5:
        ends = [(True, True), (True, False), (False, True)][int(rng.integers(3))]
        walls = Walls(
            element=element,
            kind="space" if element == "Hex8" else kind,
            held=ends,
            mu=mu,
            elements=(n, below),
            width=float(rng.uniform(0.5, 3.0)),
            pressure=float(10 ** rng.uniform(-1.0, 2.0)),
        )
        return Case(seed, str(walls), partial(uniform, walls))
    fit = Fit(
        element="Q1" if element == "Hex8" else element,
        kind=kind,
        mu=mu,
        elements=(n + 2, below + 2),
        overlap=float(10 ** rng.uniform(-4.0, -3.0)),
        slips=float(rng.uniform(1.0, 4.0)),
        both=bool(rng.random() < 0.5),
    )
    return Case(seed, str(fit), partial(pushed, fit))


def uniform(walls: Walls) -> Iterator[Check]:
    """The pressure is that of the load, and there is no shear."""
    result = walls.result()
    area = 0.5 * walls.width**2 if walls.kind == "axisymmetric" else walls.width
    for stage, share in zip(result, (1.0, 0.4), strict=True):
        pressure = share * walls.pressure
        joint, report = stage.tractions("joint"), stage.contact("joint")
        # Rotations of the joint leave errors of the order of P / E; a thousandth is far above them
        yield Check("held pressure", np.abs(joint.pressure / pressure - 1.0).max(), 1e-3)
        yield Check("held shear", np.abs(joint.shear).max() / pressure, 1e-3)
        yield Check("held force", apart(abs(report.force[-1]), pressure * area), 1e-6)


@dataclass(frozen=True)
class Fit:
    """A block between another one and a wall, with an overlap; it is pushed along the joint."""

    element: str
    kind: str
    mu: float
    elements: tuple[int, int]
    overlap: float
    slips: float
    both: bool

    def __str__(self) -> str:
        return (
            f"fit with an overlap of {self.overlap:.1e} pushed by {self.slips:.1f} times as much, "
            f"{self.elements[0]} beside {self.elements[1]}, {self.kind}, {self.element}, mu "
            f"{self.mu:.2f}, ends of {'both' if self.both else 'one'} held"
        )

    def grid(self, left: float, right: float, n: int) -> Mesh:
        x, y = np.linspace(left, right, 3), np.linspace(0.0, 2.0, n + 1)
        mesh = KINDS[self.element][0].init_tensor(x, y)
        return mesh.with_defaults()

    def forces(self, enforcement) -> tuple[float, float, ndarray]:
        """Return the push, the normal force, and displacements."""
        first = 0.0 if self.kind == "axisymmetric" else 1.0
        bodies = {
            "inner": self.grid(first, 2.0 + self.overlap, self.elements[0]),
            "outer": self.grid(2.0, 3.0, self.elements[1]),
        }
        order = 4 if self.element in ("Q2", "P2") else 2
        element = ElementVector(KINDS[self.element][1]())
        basis = Basis(sc.join_bodies(bodies), element, intorder=order)
        forms = {
            "solid": sc.SolidForm(basis, sc.LinearElastic(E, NU), coordinates=self.kind),
            "joint": sc.ContactPair(
                basis, "inner:right", "outer:left", sc.Coulomb(self.mu), enforcement=enforcement
            ),
        }
        pushed = basis.get_dofs("inner:bottom").all("u^2")
        fixed = [pushed, basis.get_dofs("outer:bottom").all("u^2")]
        fixed += [basis.get_dofs(side).all("u^1") for side in ("inner:left", "outer:right")]
        if self.both:
            fixed.append(basis.get_dofs("outer:top").all("u^2"))
        model = sc.Model(forms, np.unique(np.concatenate(fixed)))
        start = model.run([sc.Stage("fit")], progress=False)
        x = start["fit"].x.copy()
        x[pushed] -= self.slips * self.overlap
        push = sc.Stage("push", prescribed=x, increments=4)
        stage = model.run([push], start=start, progress=False)["push"]
        normal = abs(stage.contact("joint").force[0])
        return -stage.reactions()[pushed].sum(), normal, stage.x[: basis.N]


def pushed(fit: Fit) -> Iterator[Check]:
    """The push and the normal force are those of the augmented method."""
    push, normal, x = fit.forces(sc.DualMultipliers())
    other, beside, y = fit.forces(sc.AugmentedLagrangian())
    yield Check("held push", abs(push - other) / (fit.mu * beside), 0.05)
    yield Check("held normal", apart(normal, beside), 0.05)
    yield Check("held fit", np.abs(x - y).max() / np.abs(y).max(), 0.05)
    yield Check("slides", max(abs(push) / (fit.mu * normal) - 1.0, 0.0), 1e-3)
