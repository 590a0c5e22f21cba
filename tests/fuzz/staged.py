"""Ground that is filled, dug, changed and pushed in stages: columns with closed forms, pits by
superposition.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np
from scipy.sparse.linalg import spsolve
from skfem import (
    Basis,
    ElementQuad1,
    ElementQuad2,
    ElementTriP1,
    ElementTriP2,
    ElementVector,
    MeshQuad,
    MeshTri,
    condense,
)
from skfem.models.elasticity import lame_parameters, linear_elasticity

import skfem_contact as sc

from .cases import Case, Check, Setting, of_run
from .oracles import Finding

_ELEMENTS = {
    "Q1": (MeshQuad, ElementQuad1),
    "Q2": (MeshQuad, ElementQuad2),
    "P1": (MeshTri, ElementTriP1),
    "P2": (MeshTri, ElementTriP2),
}


def staged(seed: int, rng: np.random.Generator) -> Case:
    """Column of layers, pit in elastic ground, or block that is placed on ground that has
    settled.
    """
    look = [column, pit, placed][int(rng.integers(3))]
    return Case(seed, f"stages, {look.__name__}", partial(look, np.random.default_rng(seed)))


def column(rng: np.random.Generator) -> Iterator[Check | Finding]:
    """Layers are placed, taken away from above and exchanged for softer ones; nu = 0, nothing moves
    sideways.
    """
    mesh, element = _ELEMENTS[kind := str(rng.choice(list(_ELEMENTS)))]
    steps, there = _steps(rng, int(rng.integers(2, 7)))
    layers, n, d = max(there), int(rng.integers(1, 3)), float(rng.uniform(0.5, 2.0))
    mesh = mesh.init_tensor(
        np.linspace(0, 1, 3), np.linspace(0, layers * d, layers * n + 1)
    ).with_defaults()
    names = [f"l{i}" for i in range(layers)]
    mesh = mesh.with_subdomains(
        {name: lambda x, i=i: (x[1] > i * d) & (x[1] < (i + 1) * d) for i, name in enumerate(names)}
    )
    basis = Basis(mesh, ElementVector(element()), intorder=4)
    E, gamma = 10 ** rng.uniform(3, 5, layers), rng.uniform(10, 25, layers)
    forms = {
        name: sc.SolidForm(
            basis.with_elements(name),
            sc.LinearElastic(float(E[i]), 0.0),
            unit_weight=float(gamma[i]),
        )
        for i, name in enumerate(names)
    }
    model = sc.Model(
        forms, sc.box_supports(basis, base="rollers"), newton=sc.Newton(tolerance=1e-11)
    )
    u, stress, expected, stages, before = np.zeros(layers + 1), np.zeros(layers), [], [], 0
    for k, (step, now) in enumerate(zip(steps, there)):
        given: dict = {"increments": int(rng.integers(1, 3))}
        if now > before:
            given["activate"] = names[before]
            u[now], stress[before] = (
                u[before],
                0.0,
            )  # the new nodes are where the old surface has brought them
        elif now < before:
            given["deactivate"] = names[now]
        elif step == "change":
            one = int(rng.integers(now))
            E[one] *= rng.uniform(0.3, 3.0)
            new = forms[names[one]].with_materials({"all": sc.LinearElastic(float(E[one]), 0.0)})
            given["change"] = {names[one]: new}
        above = np.array([gamma[i + 1 : now].sum() + 0.5 * gamma[i] for i in range(now)]) * d
        u[1 : now + 1] += np.cumsum((-above - stress[:now]) / E[:now] * d)
        stress[:now], before = -above, now
        stages.append(sc.Stage(str(k), **given))
        expected.append((now, u.copy(), stress.copy()))
    result = model.run(stages, progress=False)
    size = max(np.abs(u).max() for _, u, _ in expected)
    for stage, (now, u, stress) in zip(result, expected):
        found = np.array([stage.states[name].stress[1].mean() for name in names[:now]])
        yield Check(
            "overburden", float(np.abs(found - stress[:now]).max() / np.abs(stress).max()), 1e-8
        )
        nodes = [basis.nodal_dofs[1, np.isclose(mesh.p[1], i * d)] for i in range(now + 1)]
        found = np.array([stage.x[dofs].mean() for dofs in nodes])
        # the residual, 1e-11, times the ratio of the layers' moduli, and seven stages
        yield Check("settled", float(np.abs(found - u[: now + 1]).max() / size), 2e-7)
    yield from of_run(model, result, Setting(element=kind))


def _steps(rng: np.random.Generator, number: int) -> tuple[list[str], list[int]]:
    """What is done in every stage, and how many layers there are then."""
    steps, there = ["place"], [1]
    for step in rng.choice(["place", "take", "change"], number, p=[0.4, 0.3, 0.3]).tolist():
        steps.append("change" if step == "take" and there[-1] == 1 else step)
        there.append(there[-1] + {"place": 1, "take": -1}.get(steps[-1], 0))
    return steps, there


def pit(rng: np.random.Generator) -> Iterator[Check]:
    """Elastic ground from its stresses at rest, dug in one stage or in two halves: one linear
    system of scikit-fem.
    """
    mesh, element = _ELEMENTS[str(rng.choice(list(_ELEMENTS)))]
    mesh = mesh.init_tensor(np.linspace(0, 4, 9), np.linspace(-2, 0, 5)).with_defaults()
    width, depth = float(rng.choice([0.5, 1.0, 2.0])), float(rng.choice([0.5, 1.0]))
    dug = (mesh.p[0, mesh.t].mean(axis=0) < width) & (mesh.p[1, mesh.t].mean(axis=0) > -depth)
    mesh = mesh.with_subdomains({"pit": np.flatnonzero(dug), "rest": np.flatnonzero(~dug)})
    basis = Basis(mesh, ElementVector(element()), intorder=4)
    E, nu, gamma, K0 = (
        1e4,
        float(rng.uniform(0.1, 0.4)),
        float(rng.uniform(15, 22)),
        float(rng.uniform(0.3, 1.2)),
    )
    forms = {
        name: sc.SolidForm(basis.with_elements(name), sc.LinearElastic(E, nu), unit_weight=gamma)
        for name in ("pit", "rest")
    }
    model = sc.Model(forms, sc.box_supports(basis), newton=sc.Newton(tolerance=1e-11))
    start, share = model.k0_state(K0=K0), float(rng.uniform(0.2, 0.8))
    whole = model.run(
        [sc.Stage("dug", deactivate="pit", increments=int(rng.integers(1, 4)))],
        start=start,
        progress=False,
    )["dug"]
    halves = model.run(
        [sc.Stage("half", deactivate="pit", release=share), sc.Stage("rest")],
        start=start,
        progress=False,
    )
    rest = basis.with_elements("rest")
    K = linear_elasticity(*lame_parameters(E, nu)).assemble(rest)
    force = forms["rest"].assemble(start[-1].x, start[-1].states["rest"]).force
    left = np.asarray(sc.weight(rest, gamma)) - force
    fixed = np.union1d(model.fixed, np.setdiff1d(np.arange(basis.N), rest.element_dofs.ravel()))
    A, b = condense(K, left, D=fixed, expand=False)
    exact, free = np.zeros(basis.N), np.setdiff1d(np.arange(basis.N), fixed)
    exact[free] = spsolve(A.tocsc(), b)
    size = np.abs(exact).max()
    yield Check("dug", float(np.abs(whole.x - exact)[free].max() / size), 1e-7)
    yield Check("half", float(np.abs(halves["half"].x - share * exact)[free].max() / size), 1e-7)
    yield Check("rest", float(np.abs(halves["rest"].x - exact)[free].max() / size), 1e-7)


def placed(rng: np.random.Generator) -> Iterator[Check]:
    """A block is placed on ground that has settled, loaded and taken away: joints carry its weight
    and no tension.
    """
    n = int(rng.integers(4, 7))
    base = MeshQuad.init_tensor(np.linspace(0, 4, n + 1), np.linspace(-2, 0, 4)).with_defaults()
    block = MeshQuad.init_tensor(
        np.linspace(1, 3, int(rng.integers(3, 7))), np.linspace(0, 1, 3)
    ).with_defaults()
    basis = Basis(
        sc.join_bodies({"base": base, "block": block}), ElementVector(ElementQuad1()), intorder=2
    )
    strength, gamma = float(rng.choice([1e6, 20.0])), float(rng.uniform(10, 25))
    soil = sc.MohrCoulomb(float(10 ** rng.uniform(3, 5)), 0.3, c=strength, phi=30.0)
    forms = {
        "base": sc.SolidForm(basis.with_elements("base"), soil, unit_weight=20.0),
        "block": sc.SolidForm(
            basis.with_elements("block"), sc.LinearElastic(1e6, 0.2), unit_weight=gamma
        ),
        "joint": sc.ContactPair(basis, "block:bottom", "base:top", sc.Coulomb(0.5), penalty=5e7),
    }
    model = sc.Model(
        forms,
        [
            basis.get_dofs("base:bottom").all(),
            basis.get_dofs({"base:left", "base:right"}).all("u^1"),
        ],
        newton=sc.Newton(tolerance=1e-10),
    )
    push = float(rng.uniform(0.0, 0.4)) * gamma * 2.0
    side = model.traction("block:left", (push, 0.0))
    stages = [
        sc.Stage("ground", deactivate=("block", "joint")),
        sc.Stage("placed", activate=("block", "joint")),
        sc.Stage("pushed", side, increments=2),
        sc.Stage("back"),
        sc.Stage("gone", deactivate=("block", "joint")),
    ]
    result = model.run(stages, progress=False)
    yield from of_run(model, result, Setting())
    for name, sideways in (("placed", 0.0), ("pushed", push), ("back", 0.0)):
        force = np.asarray(result[name].contact("joint").force)
        yield Check(
            "carried", float(np.abs(force - (-sideways, 2.0 * gamma)).max() / (2.0 * gamma)), 1e-7
        )
    if strength > 1e3:
        change = result["gone"].states["base"].stress[1] - result["ground"].states["base"].stress[1]
        yield Check("gone", float(np.abs(change).max() / 40.0), 1e-6)
    since = result["placed"].field("uy", since=result["ground"])
    yield Check("counted", float(not np.nanmax(np.abs(since)) < 10.0 * 2 * gamma / soil.E), 0.0)
