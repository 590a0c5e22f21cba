"""Stacks of blocks that nothing but contact holds: on slopes, under a horizontal push, and
arches.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy import ndarray
from skfem import Basis, ElementQuad1, ElementVector, MeshQuad

import skfem_contact as sc

from .cases import Case, Check, Setting, apart, of_run

GAMMA = 20.0
#: Penalty over the modulus and the width: its share of the displacements is below that of which the
#: model warns.
_STIFF = 200.0


@dataclass(frozen=True)
class Stack:
    """Blocks of one width upon each other on a base that slopes by an angle; friction in every
    joint.
    """

    width: float
    heights: tuple[float, ...]
    friction: tuple[float, ...]
    angle: float
    quadrature: str

    def __str__(self) -> str:
        heights, friction = (
            np.round(values, 2).tolist() for values in (self.heights, self.friction)
        )
        return (
            f"stack of {heights} on {self.width:.2f}, mu {friction}, slope "
            f"{np.degrees(self.angle):.1f}, {self.quadrature}"
        )

    @property
    def above(self) -> ndarray:
        """Weight, height, and height of the centre above every joint, from the lowest one."""
        h = np.cumsum(self.heights[::-1])[::-1]
        return np.array([GAMMA * self.width * h, h, 0.5 * h])

    def slides(self) -> float:
        """Factor of the friction at which a joint slides under the weight."""
        return min(self.friction) / np.tan(self.angle)

    def arms(self, n: int) -> ndarray:
        """Distance from the middle of every joint to where it turns: its end, or the last point of
        quadrature.

        The points of "segments" lie .01 of a facet of the block above inside.
        """
        inside = 0.01 / (n + np.arange(len(self.heights)))
        return self.width * (0.5 - inside * (self.quadrature == "segments"))

    def topples(self, n: int) -> float:
        """Tangent of the slope, over that at which blocks topple about a joint."""
        return float(np.max(np.tan(self.angle) * self.above[2] / self.arms(n)))

    def bears(self, n: int) -> float:
        """Push on the left side of the highest block, down the slope: the least of sliding and
        toppling.
        """
        weight, height, centre = self.above
        shear, normal = weight * np.sin(self.angle), weight * np.cos(self.angle)
        lever = height - 0.5 * self.heights[-1]
        slide, topple = (
            self.friction * normal - shear,
            (self.arms(n) * normal - shear * centre) / lever,
        )
        return float(min(slide.min(), topple.min()))

    def model(self, n: int, newton: sc.Newton | None = None) -> sc.Model:
        """Model of n elements along a block; the base is held as a whole."""
        bodies, y = {"base": _grid(2 * n, -0.5 * self.width, 1.5 * self.width, -0.3, 0.0)}, 0.0
        for k, h in enumerate(self.heights):
            bodies[f"b{k}"] = _grid(n + k, 0.0, self.width, y, y + h)
            y += h
        basis = Basis(sc.join_bodies(bodies), ElementVector(ElementQuad1()), intorder=2)
        forms = {
            "bodies": sc.SolidForm(
                basis,
                sc.LinearElastic(1e6, 0.2),
                unit_weight={k: GAMMA * (k != "base") for k in bodies},
            )
        }
        for k, mu in enumerate(self.friction):
            below = f"b{k - 1}:top" if k else "base:top"
            forms[f"j{k}"] = sc.ContactPair(
                basis,
                f"b{k}:bottom",
                below,
                sc.Coulomb(mu),
                self.quadrature,
                penalty=_STIFF * 1e6 / self.width,
            )
        down = (np.sin(self.angle), -np.cos(self.angle))
        return sc.Model(
            forms, basis.get_dofs("base:bottom").all(), gravity=np.array(down), newton=newton
        )


def _grid(n: int, left: float, right: float, low: float, high: float) -> MeshQuad:
    return MeshQuad.init_tensor(
        np.linspace(left, right, n + 1), np.linspace(low, high, 3)
    ).with_defaults()


def stack(seed: int, rng: np.random.Generator) -> Case:
    """Stack on a slope, asked whether it stands, for its factor of safety, or for the push that it
    bears.
    """
    n = int(rng.integers(1, 4))
    heights, friction = rng.uniform(0.4, 1.0, n), rng.uniform(0.3, 0.8, n)
    width = float(rng.uniform(0.6, 1.4))
    limit = np.arctan(min(friction.min(), width / heights.sum()))
    question = [stands, factor, push][int(rng.integers(3))]
    beside = rng.choice([rng.uniform(0.5, 0.97), rng.uniform(1.03, 1.3)])
    share = beside if question is stands else rng.uniform(0.3, 0.7)
    drawn = Stack(
        width,
        tuple(heights.tolist()),
        tuple(friction.tolist()),
        float(limit * share),
        str(rng.choice(["nodal", "segments"])),
    )
    return Case(
        seed, f"{question.__name__}: {drawn}", partial(question, drawn, int(rng.integers(2, 5)))
    )


def stands(drawn: Stack, n: int) -> Iterator[Check]:
    """Slope below, or above, that of sliding and toppling."""
    model = drawn.model(n)
    expected = drawn.slides() > 1.0 and drawn.topples(n) < 1.0
    yield Check("stands", float(model.is_stable() != expected), 0.0)
    if expected:
        result = drawn.model(n, sc.Newton(tolerance=1e-10)).run(
            [sc.Stage("weight")], progress=False
        )
        yield from of_run(model, result, Setting(quadrature=drawn.quadrature))
        # weight over the base, of joints from the lowest one
        for k, (weight, *_) in enumerate(drawn.above.T):
            force = result["weight"].contact(f"j{k}").force
            yield Check("resultant", apart(np.linalg.norm(force), weight), 1e-6)


def factor(drawn: Stack, n: int) -> Iterator[Check]:
    """Factor of friction: toppling does not depend on it."""
    found = drawn.model(n).strength_reduction(progress=False)
    if found.stop.shows_limit:
        yield Check(
            "factor", apart(found.factor, drawn.slides()), 0.015
        )  # tolerance of the search, and a half


def push(drawn: Stack, n: int) -> Iterator[Check]:
    """Push at which a joint slides, or the blocks above it topple."""
    model = drawn.model(n)
    top = len(drawn.heights) - 1
    load = model.traction(f"b{top}:left", (1.0 / drawn.heights[-1], 0.0))
    found = model.limit_load(load, step=0.2 * drawn.bears(n), progress=False)
    if found.stop.shows_limit:
        yield Check("push", apart(found.multiplier, drawn.bears(n)), 0.02)
