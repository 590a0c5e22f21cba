"""Bars and springs between nodes of an elastic block and the ground: ropes, struts that flow,
jacks.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import partial
from itertools import combinations

import numpy as np
from numpy import ndarray
from scipy.optimize import linprog
from skfem import Basis, ElementQuad1, ElementTriP1, ElementVector, MeshQuad, MeshTri
from skfem.models.elasticity import lame_parameters, linear_elasticity

import skfem_contact as sc

from .cases import Case, Check, apart

E, NU = 1e4, 0.3
#: Least lever of three bars: the square of it, times their stiffness over the block's, is 1e-9, and
#: round-off below.
_LEVER = 1e-2


@dataclass
class Held:
    """Force of a bar from its elongations, kept beside the analysis."""

    stiffness: float
    least: float
    most: float
    rope: bool
    jack: float | None = None
    free: float = 0.0
    force: float = field(default=0.0)

    def follow(self, elongation: float) -> float:
        """Force at an elongation; what flows keeps its length, a slack rope does not."""
        elastic = self.stiffness * (elongation - self.free)
        self.force = (
            float(np.clip(elastic, self.least, self.most)) if self.jack is None else self.jack
        )
        if not (self.rope and elastic < 0.0 and self.jack is None):
            self.free = elongation - self.force / self.stiffness
        return self.force


def bars(seed: int, rng: np.random.Generator) -> Case:
    """Block on bars under a random history of loads, or rigid block whose bars flow."""
    look = [history, collapse][int(rng.random() < 0.4)]
    return Case(seed, f"bars, {look.__name__}", partial(look, np.random.default_rng(seed)))


def _block(rng: np.random.Generator, triangles: bool) -> Basis:
    x, y = (
        np.linspace(0, rng.uniform(1, 3), int(rng.integers(2, 6))),
        np.linspace(0, 1, int(rng.integers(2, 5))),
    )
    mesh = (MeshTri if triangles else MeshQuad).init_tensor(x, y).with_defaults()
    return Basis(mesh, ElementVector(ElementTriP1() if triangles else ElementQuad1()), intorder=2)


def history(rng: np.random.Generator) -> Iterator[Check]:
    """Bars of all kinds on a block that is held below, or by springs alone; every stage in one
    increment.
    """
    basis = _block(rng, bool(rng.random() < 0.4))
    n, held = basis.mesh.p.shape[1], basis.get_dofs("bottom").all()
    forms: dict[str, sc.Form] = {"block": sc.SolidForm(basis, sc.LinearElastic(E, NU))}
    K = linear_elasticity(*lame_parameters(E, NU)).assemble(basis).tolil()
    size, axes, ours = 0.004 * E, {}, {}
    if rng.random() < 0.5:  # springs below instead of a support
        k, base = rng.uniform(0.1, 1.0, 2) * E, basis.get_dofs("bottom").all().reshape(-1, 2)
        forms["springs"] = sc.Spring(
            basis, basis.mesh.p[:, basis.get_dofs("bottom").nodal["u^1"] // 2].T, k
        )
        for dof, stiffness in zip(np.sort(base.ravel()), np.tile(k, len(base))):
            K[dof, dof] += stiffness
        held = np.zeros(0, int)
    for i in range(int(rng.integers(1, 5))):
        a, b = rng.choice(n, 2, replace=False)
        ground, rope, most = (
            rng.random() < 0.5,
            bool(rng.random() < 0.4),
            float(rng.choice([np.inf, 0.3 * size])),
        )
        start = basis.mesh.p[:, a]
        end = (
            start + rng.uniform(0.5, 2.0, 2) * rng.choice([-1, 1], 2)
            if ground
            else basis.mesh.p[:, b]
        )
        EA, length = float(10 ** rng.uniform(-1, 1)) * E, float(np.linalg.norm(end - start))
        forms[f"bar{i}"] = sc.Bar(basis, start, end, EA, bool(ground), most, rope)
        axis, along = np.zeros(basis.N), (end - start) / length
        axis[basis.nodal_dofs[:, a]] = -along
        if not ground:
            axis[basis.nodal_dofs[:, b]] = along
        axes[f"bar{i}"], ours[f"bar{i}"] = (
            axis,
            Held(EA / length, 0.0 if rope else -most, most, rope),
        )
    loads = [
        size * rng.uniform(-1, 1) * sc.traction(basis, "top", rng.uniform(-1, 1, 2))
        for _ in range(4)
    ]
    jacked = str(rng.choice([*ours, ""]))
    jack = min(0.1 * size, ours[jacked].most) if jacked else 0.0
    model = sc.Model(forms, held, newton=sc.Newton(tolerance=1e-11, max_iterations=40))
    stages = [sc.Stage(str(i), load) for i, load in enumerate(loads)]
    if jacked:
        stages[1] = sc.Stage("1", loads[1], change={jacked: forms[jacked].prestressed(jack)})
        stages[2] = sc.Stage("2", loads[2], change={jacked: forms[jacked]})
    result = model.run(stages, progress=False)
    free = np.setdiff1d(np.arange(basis.N), held)
    for i, (stage, load) in enumerate(zip(result, loads)):
        if len(stage.iterations) != 1:
            return  # other increments, another path
        left = np.asarray(load - K @ stage.x)
        for name, bar in ours.items():
            bar.jack = jack if name == jacked and i == 1 else None
            force = bar.follow(float(axes[name] @ stage.x))
            yield Check("bar", abs(stage.states[name].force[0] - force) / size, 1e-9)
            left = left - force * axes[name]
        yield Check("balance", float(np.abs(left[free]).max() / np.abs(load).max()), 1e-8)
    if all(bar.most == np.inf and not bar.rope for bar in ours.values()) and not jacked:
        whole = K.toarray() + sum(
            bar.stiffness * np.outer(axes[name], axes[name]) for name, bar in ours.items()
        )
        x = np.linalg.solve(whole[np.ix_(free, free)], loads[-1][free])
        yield Check("linear", float(np.abs(result[-1].x[free] - x).max() / np.abs(x).max()), 1e-8)


def collapse(rng: np.random.Generator) -> Iterator[Check]:
    """Nearly rigid block on bars that flow: the limit load is that of a linear programme of their
    forces.
    """
    basis = _block(rng, False)
    x, number = basis.mesh.p, int(rng.integers(3, 6))
    forms: dict[str, sc.Form] = {"block": sc.SolidForm(basis, sc.LinearElastic(1e4 * E, 0.2))}
    columns, strengths = [], []
    for i, node in enumerate(rng.choice(x.shape[1], number, replace=x.shape[1] < number)):
        along = (
            rng.normal(size=2) if i > 2 else np.array([(0.0, -1.0), (0.6, -1.0), (-1.0, -0.3)][i])
        )
        along, strength = along / np.linalg.norm(along), float(rng.uniform(5.0, 20.0))
        forms[f"bar{i}"] = sc.Bar(basis, x[:, node], x[:, node] + along, 1e3, True, strength)
        columns.append(_resultant(x[:, node], along))
        strengths.append(strength)
    push, at = rng.normal(size=2), int(rng.integers(x.shape[1]))
    load = basis.zeros()
    load[basis.nodal_dofs[:, at]] = push
    A = np.column_stack((*columns, _resultant(x[:, at], push)))
    least = [
        np.linalg.svd(A[:, list(three)], compute_uv=False)[-1]
        for three in combinations(range(number), 3)
    ]
    if (
        any(1e-9 < lever < _LEVER for lever in least)
        or np.linalg.matrix_rank(A[:, :-1], tol=_LEVER) < 3
    ):
        return  # a mechanism from the beginning, or as soon as the other bars flow
    best = linprog(
        [0.0] * number + [-1.0],
        A_eq=A,
        b_eq=np.zeros(3),
        bounds=[(-s, s) for s in strengths] + [(0.0, None)],
    )
    found = sc.Model(forms).limit_load(load, step=0.1 * -best.fun, progress=False)
    if not found.stop.shows_limit:
        return
    yield Check("limit load", apart(found.multiplier, -best.fun), 0.01)
    yield Check(
        "bracket",
        float(not found.bracket[0] <= 1.0005 * -best.fun <= 1.001 * found.bracket[1]),
        0.0,
    )


def _resultant(point: ndarray, force: ndarray) -> ndarray:
    return np.array([*force, point[0] * force[1] - point[1] * force[0]])
