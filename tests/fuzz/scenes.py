"""What a scene is, and how one is drawn."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

Kind = Literal["plane", "axisymmetric", "space"]
#: Loads and displacements of a path are of this order, relative to the modulus and the height of a
#: body: strains that small-strain kinematics bears, and that no collapse needs.
STRAIN = 8e-3


@dataclass(frozen=True)
class Scene:
    """A block upon a wider base, or upon a rigid floor: all that tells one scene from another.

    Attributes
    ----------
    seed
        Of the scene: with it alone the scene is drawn again.
    kind, element
        Plane, axisymmetric or in space; Q1, Q2, P1 or P2.
    lower, upper
        Numbers of elements along the base and the block.
    wave, slope, fit
        Height, number and phase of the waves of the interface, its slope, and the gap (negative:
        overlap) as meshed.
    rigid, swapped
        Whether the base is rigid; whether the base is the slave.
    law
        Friction, adhesion and tension; None: tied.
    quadrature, augmented, initial, smoothing, both_ways, penalty
        Of the contact pair; the penalty is relative to the modulus over the height of a body, None:
        by default.
    stiffer
        Modulus of the block over that of the base.
    soil
        Material of the base.
    b_bar
        Whether volume strains are averaged (Q1).
    displaced
        Whether the top of the block is led along the path, or loaded by it.
    path
        Displacements of the top over its height, or tractions over the modulus, each over
        :data:`STRAIN`.
    increments
        Of each of these stages.
    built
        What is built or dug at the end: a cap on the block, a pit beside the base, or nothing.
    """

    seed: int
    kind: Kind
    element: str
    lower: int
    upper: int
    wave: tuple[float, float, float]
    slope: float
    fit: float
    rigid: bool
    swapped: bool
    law: tuple[float, float, float] | None
    quadrature: str | int
    augmented: bool
    initial: str
    smoothing: float | None
    both_ways: bool
    penalty: float | None
    stiffer: float
    soil: str
    b_bar: bool
    displaced: bool
    path: tuple[tuple[float, ...], ...]
    increments: tuple[int, ...]
    built: str

    @property
    def dim(self) -> int:
        """Number of coordinates."""
        return 3 if self.kind == "space" else 2

    @property
    def elastic(self) -> bool:
        """Whether no point of a body can yield."""
        return self.soil == "elastic"

    @property
    def frictionless(self) -> bool:
        """Whether contact transmits pressure alone."""
        return self.law is not None and not self.law[0] and not self.law[1]

    @property
    def bonded(self) -> bool:
        """Whether contact transmits tension."""
        return self.law is None or self.law[2] > 0.0

    def __str__(self) -> str:
        law = "tied" if self.law is None else "Coulomb({:.2f}, {:.2g}, {:.2g})".format(*self.law)
        words = [
            self.kind,
            self.element,
            f"{self.lower} on {self.upper}",
            law,
            f"{self.quadrature}",
            self.soil,
        ]
        words += [
            f"wave {self.wave[0]:.3f}",
            f"slope {self.slope:.2f}",
            f"fit {self.fit:.3f} {self.initial}",
        ]
        words += [
            name
            for name in ("rigid", "swapped", "augmented", "both_ways", "b_bar", "displaced")
            if getattr(self, name)
        ]
        return ", ".join((*words, self.built) if self.built else words)


def seeds(seed: int, number: int, start: int = 0) -> range:
    """Seeds of so many scenes, from one of them on."""
    first = 1_000_000 * seed + start
    return range(first, first + number)


def draw(seed: int) -> Scene:
    """The scene of a seed."""
    rng = np.random.default_rng(seed)
    kind: Kind = rng.choice(["plane", "axisymmetric", "space"], p=[0.7, 0.15, 0.15]).item()
    element = rng.choice(["Q1", "P1"] if kind == "space" else ["Q1", "Q2", "P1", "P2"]).item()
    plane = kind == "plane"
    rigid = bool(plane and rng.random() < 0.15)
    law = None if not rigid and rng.random() < 0.1 else _law(rng)
    kinked = rng.random() < 0.5
    wave = (
        (rng.uniform(0.01, 0.05), rng.uniform(2, 6), rng.uniform(0, 6))
        if kinked
        else (0.0, 1.0, 0.0)
    )
    augmented = bool(law is not None and rng.random() < 0.25)
    quadrature = rng.choice(["nodal", "segments", "1", "2", "4"]).item()
    # nothing but friction, or a tie, holds a block that is loaded
    if augmented and quadrature == "1" and element in ("Q2", "P2"):
        quadrature = "2"  # so it is here
    displaced = bool(
        rng.random() < 0.6 or (kind != "axisymmetric" and law is not None and law[0] < 0.1)
    )
    path = _path(rng, 3 if kind == "space" else 2, displaced, law, kind)
    return Scene(
        seed=seed,
        kind=kind,
        element=element,
        lower=int(rng.integers(2, 4 if kind == "space" else 7)),
        upper=int(rng.integers(2, 4 if kind == "space" else 6)),
        wave=wave,
        slope=float(rng.choice([0.0, 0.0, rng.uniform(-0.1, 0.1)])),
        fit=float(rng.choice([0.0, 0.0, rng.uniform(-0.01, 0.0), rng.uniform(0.0, 0.005)])),
        rigid=rigid,
        swapped=bool(plane and not rigid and rng.random() < 0.2),
        law=law,
        quadrature=int(quadrature) if quadrature.isdigit() else quadrature,
        augmented=augmented,
        initial=rng.choice(["as meshed", "adjusted", "ramped"], p=[0.4, 0.4, 0.2]).item(),
        smoothing=float(rng.uniform(0.05, 0.5))
        if plane and element in ("Q1", "P1") and rng.random() < 0.2
        else None,
        both_ways=bool(plane and not rigid and rng.random() < 0.1),
        penalty=float(10 ** rng.uniform(1.0, 2.5)) if rng.random() < 0.2 else None,
        stiffer=float(10 ** rng.uniform(-1, 3)),
        soil=rng.choice(
            ["elastic", "MohrCoulomb", "Tresca", "DruckerPrager"], p=[0.6, 0.2, 0.1, 0.1]
        ).item(),
        b_bar=bool(element == "Q1" and kind != "axisymmetric" and rng.random() < 0.5),
        displaced=displaced,
        path=path,
        increments=tuple(int(n) for n in rng.integers(1, 3, len(path))),
        built=rng.choice(["", "cap", "pit"], p=[0.6, 0.2, 0.2]).item()
        if plane and not rigid
        else "",
    )


def _law(rng: np.random.Generator) -> tuple[float, float, float]:
    """Friction, adhesion and tension; the last two over the modulus and :data:`STRAIN`."""
    mu = float(rng.choice([0.0, rng.uniform(0.1, 1.0)], p=[0.25, 0.75]))
    bond = rng.random() < 0.15
    return (
        mu,
        float(bond * rng.uniform(0.0, 0.3)),
        float(bond * rng.choice([0.0, rng.uniform(0.0, 0.2)])),
    )


def _path(
    rng: np.random.Generator,
    dim: int,
    displaced: bool,
    law: tuple[float, float, float] | None,
    kind: Kind,
) -> tuple[tuple[float, ...], ...]:
    """Pressed, then sheared, mostly back again; loads push by less than friction holds."""
    down, side = rng.uniform(0.3, 1.5), np.zeros(dim - 1)
    if kind != "axisymmetric":
        side = rng.uniform(-1.0, 1.0, dim - 1)
    bears = 1.0 if displaced or law is None else 0.6 * law[0]
    ends = [
        (0.0, 1.0),
        (1.0, rng.uniform(0.6, 1.2)),
        (rng.uniform(-1.0, 0.5), rng.uniform(0.3, 1.2)),
    ]
    steps = ends[: int(rng.choice([2, 3], p=[0.7, 0.3]))]
    return tuple(
        (*(bears * share * depth * down * side).tolist(), float(-depth * down))
        for share, depth in steps
    )
