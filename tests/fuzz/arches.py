"""Arches of dry blocks under a horizontal acceleration: the limit is that of a linear programme of
corner forces.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np
from numpy import ndarray
from scipy.optimize import linprog
from skfem import Basis, ElementQuad1, ElementVector, MeshQuad

import skfem_contact as sc

from .cases import Case, Check, apart

#: Penalty over the modulus and the radius.
_STIFF = 1000.0


def arch(seed: int, rng: np.random.Generator) -> Case:
    """Semicircular arch of five to seven blocks, or a flatter one; a thin one falls."""
    n, thickness, mu = (
        int(rng.integers(5, 8)),
        float(rng.choice([rng.uniform(0.02, 0.06), rng.uniform(0.2, 0.4)])),
        0.9,
    )
    half = float(rng.uniform(0.38, 0.5) * np.pi)
    return Case(
        seed,
        f"arch of {n} blocks, t/R {thickness:.2f}, mu {mu:.2f}, half angle {np.degrees(half):.0f}",
        partial(accelerated, n, thickness, mu, half),
    )


def accelerated(n: int, thickness: float, mu: float, half: float) -> Iterator[Check]:
    """Own weight, then the limit of the acceleration to the right."""
    angle = 0.5 * np.pi + np.linspace(half, -half, n + 1)
    rays = np.stack((np.cos(angle), np.sin(angle)))
    inner, outer = (1 - 0.5 * thickness) * rays, (1 + 0.5 * thickness) * rays
    exact = _limit(inner, outer, mu)
    flat = MeshQuad.init_tensor(np.array([0.0, 1.0]), np.linspace(0, 1, 3)).with_boundaries(
        {"left": lambda x: x[0] < 1e-9, "right": lambda x: x[0] > 1 - 1e-9}
    )
    (u, v), bodies = flat.p, {}
    for k in range(n):
        corners = (
            ((1 - u) * (1 - v), inner, 0),
            (u * (1 - v), inner, 1),
            ((1 - u) * v, outer, 0),
            (u * v, outer, 1),
        )
        p = sum(w * side[:, k + i, None] for w, side, i in corners)
        bodies[f"b{k}"] = MeshQuad(p, flat.t, _boundaries=flat.boundaries)
    basis = Basis(sc.join_bodies(bodies), ElementVector(ElementQuad1()), intorder=2)
    sides = {f"b{k}:left": f"b{k - 1}:right" for k in range(1, n)}
    sides |= {
        "b0:left": sc.rigid.line(2 * rays[:, 0], 0.2 * rays[:, 0]),
        f"b{n - 1}:right": sc.rigid.line(0.2 * rays[:, -1], 2 * rays[:, -1]),
    }
    forms: dict[str, sc.Form] = {
        "blocks": sc.SolidForm(basis, sc.LinearElastic(1e6, 0.2), unit_weight=1.0)
    }
    for slave, master in sides.items():
        forms[slave] = sc.ContactPair(
            basis, slave, master, sc.Coulomb(mu), "nodal", penalty=_STIFF * 1e6
        )
    model = sc.Model(forms)
    if exact is None:
        yield Check("stands", float(model.is_stable()), 0.0)
        return
    found = model.limit_load(
        sc.weight(basis, 1.0, direction=(1.0, 0.0)),
        step=0.1 * exact,
        start=model.run([sc.Stage("weight")], progress=False),
        progress=False,
    )
    slides = (
        abs(_limit(inner, outer, 1.5 * mu) / exact - 1.0) > 1e-6
    )  # the programme's joints open as they slide
    if found.stop.shows_limit and not slides:
        yield Check(
            "acceleration", apart(found.multiplier, exact), 0.02
        )  # hinges of elastic blocks move inwards


def _limit(inner: ndarray, outer: ndarray, mu: float) -> float | None:
    """Largest acceleration over gravity of rigid blocks; None where they fall under their
    weight.
    """
    n = inner.shape[1] - 1
    A, b = np.zeros((3 * n, 4 * (n + 1) + 1)), np.zeros(3 * n)
    for j in range(n + 1):
        along = (outer[:, j] - inner[:, j]) / np.linalg.norm(outer[:, j] - inner[:, j])
        across = np.array([along[1], -along[0]])  # to the right
        for i, point in enumerate((inner[:, j], outer[:, j])):
            for m, direction in enumerate((across, along)):
                wrench = np.array([*direction, point[0] * direction[1] - point[1] * direction[0]])
                column = 4 * j + 2 * i + m
                if j < n:
                    A[3 * j : 3 * j + 3, column] += wrench
                if j > 0:
                    A[3 * j - 3 : 3 * j, column] -= wrench
    for k in range(n):
        corners = np.stack((inner[:, k], inner[:, k + 1], outer[:, k + 1], outer[:, k]))
        after = np.roll(corners, -1, axis=0)
        cross = corners[:, 0] * after[:, 1] - corners[:, 1] * after[:, 0]
        area, centre = (
            0.5 * cross.sum(),
            ((corners + after) * cross[:, None]).sum(axis=0) / (3 * cross.sum()),
        )
        area = abs(area)
        b[3 * k : 3 * k + 3] = area * np.array([0.0, 1.0, centre[0]])
        A[3 * k : 3 * k + 3, -1] = area * np.array([1.0, 0.0, -centre[1]])
    cone = np.zeros((4 * (n + 1), A.shape[1]))
    for p in range(2 * (n + 1)):
        cone[2 * p, 2 * p : 2 * p + 2], cone[2 * p + 1, 2 * p : 2 * p + 2] = (-mu, 1.0), (-mu, -1.0)
    goal = np.zeros(A.shape[1])
    goal[-1] = -1.0
    free = [(0.0, None), (None, None)] * (2 * (n + 1)) + [(0.0, None)]
    best = linprog(goal, A_ub=cone, b_ub=np.zeros(len(cone)), A_eq=A, b_eq=b, bounds=free)
    return -float(best.fun) if best.status == 0 else None
