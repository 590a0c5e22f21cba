"""Ground with water: seepage, water at rest, consolidation and undrained compression, with their
closed forms.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from itertools import pairwise

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

from .cases import Case, Check, Setting, apart, of_run

WATER = 10.0
_ELEMENTS = {
    "Q1": (MeshQuad, ElementQuad1),
    "Q2": (MeshQuad, ElementQuad2),
    "P1": (MeshTri, ElementTriP1),
    "P2": (MeshTri, ElementTriP2),
}


def wet(seed: int, rng: np.random.Generator) -> Case:
    """One of the scenes of this module."""
    look = [seepage, at_rest, afloat, consolidation, undrained][int(rng.integers(5))]
    return Case(seed, f"water, {look.__name__}", partial(look, np.random.default_rng(seed)))


def _layers(rng: np.random.Generator, kind: str, parts: int) -> tuple[Basis, ndarray]:
    """Column of layers "0", "1", ... from below, and the heights of their boundaries."""
    levels = np.concatenate(([0.0], np.cumsum(rng.uniform(0.3, 1.5, parts))))
    n = int(rng.integers(1, 4))
    y = np.concatenate(([0.0], *(np.linspace(a, b, n + 1)[1:] for a, b in pairwise(levels))))
    mesh, element = _ELEMENTS[kind]
    mesh = mesh.init_tensor(np.linspace(1.0, 2.0, int(rng.integers(2, 4))), y).with_defaults()
    mesh = mesh.with_subdomains(
        {
            str(i): lambda x, a=a, b=b: (x[1] > a) & (x[1] < b)
            for i, (a, b) in enumerate(pairwise(levels))
        }
    )
    return Basis(mesh, ElementVector(element()), intorder=4), levels


def seepage(rng: np.random.Generator) -> Iterator[Check]:
    """Flow up or down through layers: discharge and pressures of resistances in series."""
    basis, levels = _layers(rng, str(rng.choice(["Q1", "P1", "Q2", "P2"])), int(rng.integers(1, 5)))
    k = 10 ** rng.uniform(-6, -3, len(levels) - 1)
    top, bottom = levels[-1] + rng.uniform(0.1, 3.0, 2)
    if rng.random() < 0.5:
        bottom = top + rng.uniform(0.1, 2.0)  # upwards
    axial = bool(rng.random() < 0.4)
    flow = sc.water.Flow(
        basis,
        {str(i): float(one) for i, one in enumerate(k)},
        unit_weight=WATER,
        coordinates="axisymmetric" if axial else "plane",
    ).steady(sc.water.Conditions(head={"top": top, "bottom": bottom}))
    velocity = (top - bottom) / np.sum(np.diff(levels) / k)
    area = 1.5 if axial else 1.0
    yield Check("discharge", apart(flow.discharge("top"), velocity * area), 1e-7)
    yield Check("balance", abs(flow.inflow.sum()) / (abs(velocity) * area), 1e-7)
    heads = bottom + velocity * np.concatenate(([0.0], np.cumsum(np.diff(levels) / k)))
    y = basis.mesh.p[1]
    exact = np.interp(y, levels, heads)
    yield Check("heads", float(np.abs(flow.head[: len(y)] - exact).max() / abs(top - bottom)), 1e-6)
    pressure = np.maximum(WATER * (exact - y), 0.0)
    if (exact > y).all():
        yield Check(
            "pressure",
            float(np.abs(flow.pressure[: len(y)] - pressure).max() / pressure.max()),
            1e-6,
        )


def at_rest(rng: np.random.Generator) -> Iterator[Check]:
    """Level ground under a water level in or above it: effective stresses of the weights less the
    pressure.
    """
    basis, levels = _layers(rng, str(rng.choice(["Q2", "P2"])), int(rng.integers(1, 4)))
    gamma = rng.uniform(16, 22, len(levels) - 1)
    level = float(rng.choice([rng.choice(levels), levels[-1] + rng.uniform(0.0, 4.0)]))
    elastic = rng.random() < 0.5
    laws = {
        str(i): sc.LinearElastic(1e4 * (i + 1), 0.3)
        if elastic
        else sc.MohrCoulomb(1e4, 0.3, 5.0, 30.0)
        for i in range(len(gamma))
    }
    weights = {str(i): float(g) for i, g in enumerate(gamma)}
    model = sc.Model(
        {"ground": sc.SolidForm(basis, laws, unit_weight=weights)},
        sc.box_supports(basis),
        water_unit_weight=WATER,
    )
    above = WATER * max(level - float(levels[-1]), 0.0)
    if rng.random() < 0.5:
        begun = model.run([sc.Stage("at rest", water=level)], progress=False)
    else:
        begun = model.k0_state(K0=0.5, water=level, surcharge=above)
    y = np.asarray(model.forms["ground"].basis.global_coordinates())[1]  # elements region by region
    total = np.interp(
        y, levels, np.concatenate((np.cumsum((gamma * np.diff(levels))[::-1])[::-1], [0.0]))
    )
    exact = -(total + above - WATER * np.maximum(level - y, 0.0))
    found = begun[-1].states["ground"].stress[1]
    yield Check("effective", float(np.abs(found - exact).max() / np.abs(exact).max()), 1e-6)
    same = model.run([sc.Stage("same")], start=begun, progress=False)[-1]
    yield Check(
        "kept",
        float(np.abs(same.states["ground"].stress[1] - found).max() / np.abs(exact).max()),
        1e-6,
    )


def afloat(rng: np.random.Generator) -> Iterator[Check]:
    """Hills under water, and a block on them: reactions are the weights less those of the water
    displaced.
    """
    x = np.linspace(0, 4, int(rng.integers(5, 12)))
    flat = MeshQuad.init_tensor(x, np.linspace(0, 1, 4)).with_defaults()
    hill = 1.0 + rng.uniform(0, 0.5) * np.sin(rng.uniform(0.5, 3) * flat.p[0])
    mesh = MeshQuad(np.stack((flat.p[0], hill * flat.p[1])), flat.t, _boundaries=flat.boundaries)
    basis = Basis(sc.join_bodies({"hill": mesh}), ElementVector(ElementQuad1()), intorder=4)
    gamma, level = float(rng.uniform(12, 25)), float(hill.max() + rng.uniform(0.1, 5.0))
    form = sc.SolidForm(basis, sc.LinearElastic(1e4, 0.3), unit_weight=gamma)
    held = basis.get_dofs("hill:bottom").all()
    model = sc.Model(
        {"hill": form}, held, water_unit_weight=WATER, newton=sc.Newton(tolerance=1e-10)
    )
    result = model.run(
        [sc.Stage("dry"), sc.Stage("flooded", water=level), sc.Stage("drained", water=False)],
        progress=False,
    )
    yield from of_run(model, result, Setting())
    area = basis.dx.sum()
    dry, flooded, drained = (stage.reactions()[held].reshape(-1, 2).sum(axis=0) for stage in result)
    yield Check("weight", float(np.abs(dry - (0, gamma * area)).max() / (gamma * area)), 1e-9)
    yield Check(
        "buoyancy",
        float(np.abs(flooded - (0, (gamma - WATER) * area)).max() / (gamma * area)),
        1e-8,
    )
    yield Check("drained", float(np.abs(drained - dry).max() / (gamma * area)), 1e-8)


def consolidation(rng: np.random.Generator) -> Iterator[Check]:
    """Column that drains at its top, or both ways: pressures just after the load, Terzaghi's
    settlement, the end.
    """
    kind, height = str(rng.choice(["Q2", "P2", "Q1"])), float(rng.uniform(0.5, 3.0))
    mesh, element = _ELEMENTS[kind]
    mesh = mesh.init_tensor(
        np.array([0.0, 0.1 * height]), np.linspace(0, height, 13)
    ).with_defaults()
    basis = Basis(mesh, ElementVector(element()), intorder=4)
    modulus, k, nu = (
        float(10 ** rng.uniform(3, 5)),
        float(10 ** rng.uniform(-6, -3)),
        float(rng.uniform(0, 0.35)),
    )
    E = modulus * (1 + nu) * (1 - 2 * nu) / (1 - nu)
    water = sc.PoreWater(basis, permeability=k, unit_weight=WATER)
    both = bool(rng.random() < 0.4)
    drains = ["top", "bottom"] if both else ["top"]
    fixed = [sc.box_supports(basis, base="rollers"), *(water.dofs(name) for name in drains)]
    model = sc.Model({"clay": sc.SolidForm(basis, sc.LinearElastic(E, nu)), "water": water}, fixed)
    q, way = 10.0, height / (2 if both else 1)
    c, T = k * modulus / WATER, float(rng.uniform(0.05, 1.0))
    load, ramp = sc.traction(basis, "top", (0.0, -q)), 0.008 if both else 0.002
    stages = [
        sc.Stage("load", load, duration=ramp * way**2 / c),
        sc.Stage("wait", load, duration=T * way**2 / c),
        sc.Stage("end", load, duration=20 * way**2 / c),
    ]
    result = model.run(stages, progress=False)
    top = basis.get_dofs("top").all("u^2")
    settled = [
        -float(result[name].x[top].mean()) * modulus / (q * height)
        for name in ("load", "wait", "end")
    ]
    M = np.pi / 2 * (2 * np.arange(200) + 1)
    exact = 1.0 - np.sum(2 / M**2 * np.exp(-(M**2) * (T + ramp / 2)))
    yield Check("degree", abs(settled[1] - exact), 0.01)  # 13 nodes, time error of a per cent
    yield Check("final", abs(settled[2] - 1.0), 1e-3)
    pore = result["load"].field("pore")[basis.get_dofs("bottom").nodal["u^1"] // 2]
    if not both:
        yield Check("pore", float(np.abs(pore / q - 1.0).max()), 0.01)


def undrained(rng: np.random.Generator) -> Iterator[Check]:
    """Confined compression of undrained soil: the load is shared by water and soil as their moduli
    are.
    """
    kind = str(rng.choice(list(_ELEMENTS)))
    mesh, element = _ELEMENTS[kind]
    mesh = mesh.init_tensor(np.linspace(0, 1, 3), np.linspace(0, 1, 4)).with_defaults()
    basis = Basis(mesh, ElementVector(element()), intorder=4)
    E, nu, ratio = (
        float(10 ** rng.uniform(3, 5)),
        float(rng.uniform(0.1, 0.35)),
        float(10 ** rng.uniform(-1, 2)),
    )
    modulus, axial = E * (1 - nu) / ((1 + nu) * (1 - 2 * nu)), bool(rng.random() < 0.4)
    soil = sc.LinearElastic(E, nu) if rng.random() < 0.5 else sc.MohrCoulomb(E, nu, 50.0, 30.0)
    law = sc.Undrained(soil, bulk_modulus_water=ratio * modulus)
    solid = sc.SolidForm(basis, law, coordinates="axisymmetric" if axial else "plane")
    model = sc.Model({"clay": solid}, sc.box_supports(basis))
    loads = [q * sc.traction(solid, "top", (0.0, -1.0)) for q in rng.uniform(1, 20, 3)]
    result = model.run([sc.Stage(str(i), load) for i, load in enumerate(loads)], progress=False)
    for stage, load in zip(result, loads):
        q = float(-np.asarray(load).sum() / (0.5 if axial else 1.0))
        exact = q * ratio / (1.0 + ratio)
        yield Check("pore", float(np.abs(stage.pore_pressure("clay") - exact).max() / exact), 1e-6)
        yield Check("total", float(np.abs(stage.states["clay"].stress[1] + q).max() / q), 1e-6)
