"""Strengths per present area of bodies of finite kinematics."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from skfem import Basis, ElementHex1, ElementQuad1, ElementQuad2, ElementVector, MeshHex, MeshQuad

import skfem_contact as sc

CASES: dict[str, tuple[Any, Any, int, str]] = {
    "Q1": (MeshQuad().refined(1), ElementQuad1(), 2, "plane"),
    "Q2": (MeshQuad(), ElementQuad2(), 4, "plane"),
    "axial": (MeshQuad().refined(1).translated((0.5, 0.0)), ElementQuad1(), 2, "axisymmetric"),
    "Hex1": (MeshHex(), ElementHex1(), 2, "space"),
}


def on_floor(name: str, law: Any, enforcement: Any = None) -> tuple[sc.Model, Basis]:
    """Body on a rigid floor."""
    mesh, element, order, coordinates = CASES[name]
    dim = mesh.dim()
    sides = {"low": lambda x: x[dim - 1] < 1e-9, "high": lambda x: x[dim - 1] > 1.0 - 1e-9}
    basis = Basis(mesh.with_boundaries(sides), ElementVector(element), intorder=order)
    body = sc.SolidForm(
        basis, sc.LinearElastic(E=100.0, nu=0.0), coordinates=coordinates, kinematics="finite"
    )
    if dim == 2:
        floor = sc.rigid.line((-9.0, 0.0), (9.0, 0.0))
    else:
        floor = sc.rigid.plane((0.5, 0.5, 0.0), (0.0, 0.0, 1.0), 9.0)
    pair = sc.ContactPair(basis, "low", floor, law, quadrature=3, enforcement=enforcement)
    sideways = np.setdiff1d(np.arange(basis.N), np.arange(dim - 1, basis.N, dim))
    fixed = np.union1d(sideways, basis.get_dofs("high").all())
    return sc.Model({"body": body, "pair": pair}, fixed), basis


def placed(basis: Basis, stretch: float, down: float, noise: float = 0.0) -> np.ndarray:
    """Displacements of a body that is stretched along the floor and pressed into it."""
    dim = basis.mesh.dim()
    x = noise * np.random.default_rng(0).normal(size=basis.N)
    for i in range(dim - 1):
        x[i::dim] += (stretch - 1.0) * basis.doflocs[i, i::dim]
    x[dim - 1 :: dim] -= down
    return x


@pytest.mark.parametrize("name", CASES)
def test_tangent(name: str) -> None:
    """[N] The tangent of adhesion in slip is the derivative of the force, the area's included."""
    model, basis = on_floor(name, sc.Coulomb(mu=0.2, adhesion=2.0))
    pair = model.forms["pair"]
    start = pair.initial_state()
    state = pair.assemble(placed(basis, 1.0, 0.01), start).state
    x = placed(basis, 1.3, 0.01, noise=1e-3)
    direction = 1e-7 * np.random.default_rng(1).normal(size=basis.N)
    K = pair.assemble(x, state).stiffness
    n = K.shape[0]
    change = pair.assemble(x + direction, state).force - pair.assemble(x - direction, state).force
    error = 2.0 * K @ direction[:n] - change
    # differences of step 1e-7 keep 1e-8
    assert np.abs(error).max() < 1e-6 * np.abs(change).max()
    # without the stretch the tangent misses a part of the force
    small = pair.with_(finite=False).assemble(x, state).stiffness
    assert np.abs(2.0 * small @ direction[:n] - change).max() > 1e-4 * np.abs(change).max()


@pytest.mark.parametrize(("name", "growth"), [("Q1", 1.5), ("axial", 1.5**2), ("Hex1", 1.5**2)])
def test_stretch_of_an_area(name: str, growth: float) -> None:
    """[X] A uniform stretch of 1.5: lengths, and areas with the circles of axial symmetry."""
    model, basis = on_floor(name, sc.Coulomb())
    pair = model.forms["pair"]
    nodes, _ = pair.interface.positions(placed(basis, 1.5, 0.0))
    values = pair.stretch(nodes, pair.points(pair.initial_state())).values
    assert values == pytest.approx(growth, rel=1e-13)


@pytest.mark.parametrize("enforcement", [None, sc.AugmentedLagrangian()])
def test_adhesion_acts_on_the_present_area(enforcement: Any) -> None:
    """[X] A sheet is stretched to twice its length on a floor that it slides over.

    The shear is the adhesion times twice the undeformed length; the tractions are the adhesion.
    """
    model, basis = on_floor("Q1", sc.Coulomb(mu=0.0, adhesion=0.01), enforcement)
    stages = []
    for k, share in enumerate(np.linspace(0.0, 1.0, 6)):
        x = placed(basis, 1.0 + share, 0.001)
        stages.append(sc.Stage(f"{k}", prescribed=x))
    last = model.run(stages)["5"]
    found = last.tractions("pair")
    slides = found.status == 2
    assert slides.mean() > 0.6
    assert np.abs(found.raw_shear[slides]) == pytest.approx(0.01, rel=1e-9)
    # the lower side is about twice as long, and its points count present lengths
    assert found.weight.sum() == pytest.approx(2.0, rel=0.05)
    friction = last.contact("pair").friction
    assert friction == pytest.approx((np.abs(found.raw_shear) * found.weight).sum(), rel=1e-9)


def test_dual_multipliers_refuse_adhesion() -> None:
    """[X] Its nodes have no present area."""
    with pytest.raises(ValueError, match="not DualMultipliers"):
        on_floor("Q1", sc.Coulomb(adhesion=1.0), sc.DualMultipliers())
    on_floor("Q1", sc.Coulomb(mu=0.3), sc.DualMultipliers())


def sliding() -> tuple[sc.Model, Basis, np.ndarray]:
    """Soft bed, and a round block at its top that is pressed into it; the dofs of its top."""
    bed = MeshQuad.init_tensor(np.linspace(0.0, 4.0, 13), np.linspace(0.0, 1.0, 4)).with_defaults()
    grid = MeshQuad.init_tensor(np.linspace(-0.5, 0.5, 5), np.linspace(0.0, 1.0, 3)).with_defaults()
    x, y = grid.p
    arch = 0.5 * x**2
    points = np.stack((1.0 + x, 1.0 + arch + 0.5 * y * (1.0 - arch)))
    block = MeshQuad(points, grid.t, _boundaries=grid.boundaries)
    mesh = sc.join_bodies({"bed": bed, "block": block})
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    laws = {"bed": sc.LinearElastic(E=100.0, nu=0.3), "block": sc.LinearElastic(E=1e3, nu=0.3)}
    body = sc.SolidForm(basis, laws, kinematics="finite")
    law = sc.Coulomb(mu=0.3)
    pair = sc.ContactPair(basis, "bed:top", "block:bottom", law, quadrature=5)
    top = basis.get_dofs("block:top").all()
    model = sc.Model(
        {"body": body, "pair": pair}, np.union1d(top, basis.get_dofs("bed:bottom").all())
    )
    return model, basis, top


def test_points_choose_facets_between_increments() -> None:
    """[N] A block that slides over a bed takes few iterations, and its forces balance.

    Without held points kinks of the block's facets throw the iterations back and forth.
    """
    model, basis, top = sliding()
    stages = []
    for k in range(16):
        x = basis.zeros()
        x[top[top % 2 == 1]] = -0.2 * min(k, 4) / 4
        x[top[top % 2 == 0]] = 0.1 * max(k - 4, 0)
        stages.append(sc.Stage(f"{k}", prescribed=x))
    result = model.run(stages)
    iterations = [sum(stage.iterations) for stage in result]
    assert max(iterations) < 15
    assert np.mean(iterations) < 7.0
    last = result[-1]
    pair, state = last.forms["pair"], last.states["pair"]
    # no point that the last increment has left beyond a facet is far from it
    beyond = pair.master.shape.beyond(np.nan_to_num(state.position.T))
    assert beyond[state.facet >= 0].max() <= 0.5
    # points beyond a facet, and no others, choose anew in the next increment
    choosing = pair.choosing_facets(state).choosing
    assert choosing is not None
    assert (beyond[choosing] > 1e-9).any(axis=1).all()
    began = pair.choosing_facets(state)
    assert began.choosing_facets(state) is began
    # and the pair follows them, also to none
    position = state.position.copy()
    position[:, np.flatnonzero(choosing)[0]] = 0.0
    fewer = began.choosing_facets(replace(state, position=position))
    assert fewer.choosing.sum() == choosing.sum() - 1
    within = replace(state, position=np.zeros_like(position))
    assert began.choosing_facets(within).choosing is None
    reactions = last.reactions()
    # the tolerance of Newton's method
    assert abs(reactions[0::2].sum()) < 1e-6 * np.abs(reactions).max()


def test_segments_hold_no_points() -> None:
    """[X] Their points are cut anew; small bodies hold none either."""
    model, basis, _ = sliding()
    pair = model.forms["pair"]
    state = pair.initial_state()
    assert pair.held(state) is not None
    assert pair.with_(finite=False).held(state) is None
    cut = sc.ContactPair(basis, "bed:top", "block:bottom", sc.Coulomb(), penalty=1.0)
    cut = cut.completed({"body": model.forms["body"]})
    assert cut.finite
    assert cut.held(cut.initial_state()) is None
