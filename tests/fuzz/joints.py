"""Certified bounds of stacks with joints: they hold the exact limit of rigid blocks, and the search
lies between.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np
from skfem import Basis, ElementTriP2, ElementVector, MeshTri

import skfem_contact as sc

from .blocks import GAMMA, Stack
from .cases import Case, Check


def joints(seed: int, rng: np.random.Generator) -> Case:
    """One or two blocks on ground that is strong, level or sloping; multiplied push or reduced
    strength.
    """
    n = int(rng.integers(1, 3))
    heights, friction, width = (
        rng.uniform(0.4, 1.0, n),
        rng.uniform(0.3, 0.8, n),
        float(rng.uniform(0.8, 1.6)),
    )
    limit = np.arctan(min(friction.min(), width / heights.sum()))
    pushed = bool(rng.random() < 0.6)
    angle = float(limit * rng.uniform(0.0 if pushed else 0.4, 0.9))
    drawn = Stack(width, tuple(heights.tolist()), tuple(friction.tolist()), angle, "nodal")
    flow = str(rng.choice(["given", "associated"]))
    return Case(
        seed,
        f"bounds of a {'push' if pushed else 'factor'}, {flow}: {drawn}",
        partial(bounds, drawn, pushed, flow, bool(rng.random() < 0.5)),
    )


def bounds(drawn: Stack, pushed: bool, flow: str, rigid: bool) -> Iterator[Check]:
    """Bounds in the frame of the slope: the weight has a share along it."""
    bodies, y = {"base": _grid(4, -0.5 * drawn.width, 1.5 * drawn.width, -0.3, 0.0)}, 0.0
    for k, h in enumerate(drawn.heights):
        bodies[f"b{k}"] = _grid(2, 0.0, drawn.width, y, y + h)
        y += h
    basis = Basis(sc.join_bodies(bodies), ElementVector(ElementTriP2()), intorder=2)
    strong = sc.MohrCoulomb(1e5, 0.3, c=1e3 * GAMMA, phi=20.0, psi=20.0)
    forms = {
        name: sc.SolidForm(
            basis.with_elements(name),
            sc.LinearElastic(1e6, 0.2) if rigid and name != "base" else strong,
        )
        for name in bodies
    }
    for k, mu in enumerate(drawn.friction):
        forms[f"j{k}"] = sc.ContactPair(
            basis, f"b{k}:bottom", f"b{k - 1}:top" if k else "base:top", sc.Coulomb(mu), "nodal"
        )
    model = sc.Model(forms, basis.get_dofs("base:bottom").all())
    top = len(drawn.heights) - 1
    weight = {f"b{k}": GAMMA * np.cos(drawn.angle) for k in range(top + 1)}
    given: dict = {
        "weight": weight,
        "seismic": float(np.tan(drawn.angle)),
        "flow": flow,
        "gap": 0.05,
        "elements": 1000,
        "progress": False,
    }
    if pushed:
        given |= {
            "tractions": {f"b{top}:left": (1.0 / drawn.heights[-1], 0.0)},
            "live": f"b{top}:left",
        }
        exact = drawn.bears(2)
    else:
        given["reduce"] = [f"j{k}" for k in range(top + 1)]
        exact = drawn.slides()
    found = model.bounds(**given)
    yield Check("ordered", float(not found.lower <= found.upper), 0.0)
    yield Check("upper", exact / found.upper - 1.0, 1e-9)
    yield Check("lower", found.lower / exact - 1.0, 1e-9)
    if found.safe is not None:
        yield Check("safe", found.safe / exact - 1.0, 1e-9)
    if not found.estimate:
        # the widest of 150: two blocks of strong soil that topple, on 870 triangles
        yield Check("gap", found.gap, 0.2)


def _grid(n: int, left: float, right: float, low: float, high: float) -> MeshTri:
    return MeshTri.init_tensor(
        np.linspace(left, right, n + 1), np.linspace(low, high, 2)
    ).with_defaults()
