"""The share of the penalty in the displacements, and its remark."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, replace

import numpy as np
import pytest
from skfem import Basis, ElementTriP2, ElementVector, MeshTri

import skfem_contact as sc
from skfem_contact.contact.compliance import _compliance
from skfem_contact.contact.laws import LawUpdate, Status
from skfem_contact.contact.penalty import choose_penalties
from tests.tools.helpers import grid, traction, vector_basis
from tests.tools.scenes import remarked


@pytest.mark.parametrize(("given", "warned"), [(1.0, True), (0.2, True), (1e3, False)])
def test_penalty_in_a_wrong_unit(given: float, warned: bool) -> None:
    """[X] A modulus in the place of a stress per length: blocks in metres shorten by half as much
    again: a warning.

    Two blocks, each 1 high and free to spread, shorten by 2 p (1 - nu^2) / E.
    """
    E, nu, pressure = 30e6, 0.3, 1e3
    bodies = {
        "low": grid("Q1", np.linspace(0, 1, 17), np.linspace(-1, 0, 17)),
        "up": grid("Q1", np.linspace(0, 1, 21), np.linspace(0, 1, 21)),
    }
    basis = vector_basis(sc.join_bodies(bodies), "Q1", intorder=2)
    forms = {
        "blocks": sc.SolidForm(basis, sc.LinearElastic(E=E, nu=nu)),
        "joint": sc.ContactPair(basis, "up:bottom", "low:top", sc.Coulomb(), penalty=given * E),
    }
    guided = basis.get_dofs({"low:left", "up:left"}).all("u^1")
    fixed = np.union1d(basis.get_dofs("low:bottom").all("u^2"), guided)
    stage = sc.Stage("press", traction(basis, "up:top", (0.0, -pressure)))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        x = sc.Model(forms, fixed).run([stage], progress=False)["press"].x
    assert any("softer than the surfaces" in str(warning.message) for warning in caught) == warned
    short = -x[basis.get_dofs("up:top").all("u^2")].mean()
    # the blocks, and the penalty in series
    assert short == pytest.approx(2 * pressure * (1 - nu**2) / E + pressure / (given * E), rel=1e-6)


@pytest.mark.parametrize(("n", "share"), [(3, 0.044), (7, 0.018), (20, None)])
def test_share_of_the_default_penalty(n: int, share: float | None) -> None:
    """[X] Two blocks shorten by 2 p (1 - nu^2) / E, and by what the penalty gives way, which is
    warned of above 1 %.
    """
    E, nu, pressure = 30e6, 0.3, 1e3
    bodies = {
        "low": grid("Q1", np.linspace(0, 1, n + 1), np.linspace(-1, 0, n + 1)),
        "up": grid("Q1", np.linspace(0, 1, n + 2), np.linspace(0, 1, n + 2)),
    }
    basis = vector_basis(sc.join_bodies(bodies), "Q1", intorder=2)
    forms = choose_penalties(
        {
            "blocks": sc.SolidForm(basis, sc.LinearElastic(E=E, nu=nu)),
            "joint": sc.ContactPair(basis, "up:bottom", "low:top", sc.Coulomb()),
        }
    )
    guided = basis.get_dofs({"low:left", "up:left"}).all("u^1")
    fixed = np.union1d(basis.get_dofs("low:bottom").all("u^2"), guided)
    stage, remarks = remarked(
        forms, sc.Stage("press", traction(basis, "up:top", (0.0, -pressure))), fixed
    )
    short, way = (
        -stage.x[basis.get_dofs("up:top").all("u^2")].mean(),
        pressure / forms["joint"].penalty[0],
    )
    assert short == pytest.approx(2 * pressure * (1 - nu**2) / E + way, rel=1e-6)
    assert ("of the largest displacement" in remarks) == (share is not None)
    if share is not None:
        assert way / short == pytest.approx(share, abs=0.003)
        assert f"penalty compliance is {way / short:.1%} of" in remarks
        # a point that touches without a penetration does not count for all
        joint, state = stage.forms["joint"], stage.states["joint"]
        clearance = state.clearance.copy()
        clearance[0] = state.gap[0]
        fewer = replace(state, clearance=clearance, slip=0.0 * state.slip)
        some = _compliance(joint, stage.x, fewer)
        whole = _compliance(joint, stage.x, state)
        assert whole[0] == pytest.approx(way / short, abs=0.003)
        assert some[0] > 0.5 * whole[0]


@pytest.mark.parametrize("n", [3, 20])
def test_share_of_the_tangential_penalty(n: int) -> None:
    """[X] Two stuck blocks in pure shear move by 2 t / G, and by what the penalty gives way, warned
    of above 1 %.
    """
    E, nu, shear, mu, depth = 30e6, 0.3, 1e3, 100.0, 1e-7
    bodies = {
        name: grid("Q1", np.linspace(0, 1, m + 1), np.linspace(y, y + 1, m + 1))
        for name, m, y in (("low", n, -1), ("up", n + 1, 0))
    }
    basis = vector_basis(sc.join_bodies(bodies), "Q1", intorder=2)
    forms = choose_penalties(
        {
            "blocks": sc.SolidForm(basis, sc.LinearElastic(E=E, nu=nu)),
            "joint": sc.ContactPair(
                basis, "up:bottom", "low:top", sc.Coulomb(mu=mu), initial="adjusted"
            ),
        }
    )
    pressed = basis.zeros()
    pressed[basis.get_dofs(elements="up").all("u^2")] = -depth
    fixed = np.union1d(basis.get_dofs("low:bottom").all(), np.unique(basis.dofs.element_dofs[1::2]))
    stage, remarks = remarked(
        forms, sc.Stage("shear", traction(basis, "up:top", (shear, 0.0)), pressed), fixed
    )
    moved, way = (
        stage.x[basis.get_dofs("up:top").all("u^1")].mean(),
        shear / forms["joint"].penalty[1],
    )
    assert moved == pytest.approx(4 * shear * (1 + nu) / E + way, rel=1e-6)
    assert ("of the largest displacement" in remarks) == (n == 3)
    if n == 3:
        assert f"tangential penalty compliance is {way / moved:.1%} of" in remarks


@pytest.mark.parametrize(("factor", "told"), [(1.0 + 1e-5, False), (2.0, True)])
def test_share_of_the_penalty_in_ground_at_rest(factor: float, told: bool) -> None:
    """[X] Where nothing moves the penalty has a share of nothing: no remark, as there is of the
    load's double.
    """
    levels = np.linspace(0, 1, 4)
    bodies = {name: grid("Q1", levels, levels + y) for name, y in (("low", -1), ("up", 0))}
    basis = vector_basis(sc.join_bodies(bodies), "Q1", intorder=2)
    joint = sc.ContactPair(basis, "up:bottom", "low:top", sc.Coulomb())
    forms = {"ground": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3)), "joint": joint}
    guided = basis.get_dofs({"low:left", "up:left", "low:right", "up:right"}).all("u^1")
    model, load = (
        sc.Model(forms, [basis.get_dofs("low:bottom").all(), guided]),
        sc.weight(basis, 20.0),
    )
    start = model.k0_state(load, unit_weights=20.0, K0=0.5)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        model.run([sc.Stage("more", factor * load)], start=start, progress=False)
    assert ("penalty compliance" in "; ".join(str(warning.message) for warning in caught)) == told


@pytest.mark.parametrize("unit", [1.0, 1e-6])
@pytest.mark.parametrize(
    ("by", "share"), [(sc.AugmentedLagrangian, "1.2%"), (sc.DualMultipliers, "9.9%")]
)
def test_gaps_between_nodes_beside_multipliers(by, share: str, unit: float) -> None:
    """[N] Multipliers are no displacements: gaps between nodes are the same share of these in MPa
    and in Pa.
    """
    lower, upper = (
        grid("Q1", np.linspace(0, 2, n), y) for n, y in ((6, [-1.0, 0.0]), (7, [0.0, 1.0]))
    )
    bent = replace(
        upper, doflocs=upper.p + np.stack((0 * upper.p[0], 0.05 * (upper.p[0] - 1) ** 2))
    )
    basis = vector_basis(sc.join_bodies({"low": lower, "up": bent}), "Q1", intorder=2)
    forms = {
        "solid": sc.SolidForm(basis, sc.LinearElastic(E=1e9 * unit, nu=0.3)),
        "joint": sc.ContactPair(basis, "up:bottom", "low:top", sc.Coulomb(0.3), enforcement=by()),
    }
    top, pressed = basis.get_dofs("up:top"), basis.zeros()
    pressed[top.all("u^2")] = -0.02
    fixed = np.union1d(basis.get_dofs("low:bottom").all(), top.all())
    _, remarks = remarked(forms, sc.Stage("press", None, pressed, increments=2), fixed)
    assert f"gapes or penetrates by {share} of the largest displacement" in remarks


@dataclass(frozen=True)
class Soft(sc.InterfaceLaw):
    """Joint of one stiffness, which is its own and no penalty."""

    k: float

    def update(self, jump, internal, penalty):
        """Return the pressure of a closed joint."""
        tangent = np.zeros((len(jump), *jump.shape))
        tangent[0, 0] = self.k * (jump[0] <= 0.0)
        traction = tangent[0, 0] * jump
        traction[1:] = 0.0
        status = np.where(jump[0] <= 0.0, int(Status.SLIP), int(Status.OPEN))
        return LawUpdate(traction, internal, tangent, 0.0 * jump[1:], status)


@pytest.mark.parametrize("unit", [1.0, 1e-6])
def test_closure_of_a_soft_joint_is_no_share_of_a_penalty(unit: float) -> None:
    """[X] A third of the displacement, p / E + p / k with k = 2 E / h, is that of an own law: no
    remark on a penalty, in Pa and in MPa.
    """
    E, pressure = 1e9 * unit, 1e4 * unit
    basis = vector_basis(grid("Q1", np.linspace(0, 1, 3), np.linspace(0, 1, 3)), "Q1", intorder=2)
    forms = {
        "block": sc.SolidForm(basis, sc.LinearElastic(E=E, nu=0.0)),
        "joint": sc.ContactPair(
            basis, "bottom", sc.rigid.line((-1.0, 0.0), (2.0, 0.0)), Soft(2.0 * E)
        ),
    }
    stage, remarks = remarked(
        forms,
        sc.Stage("press", traction(basis, "top", (0.0, -pressure))),
        basis.get_dofs("left").all("u^1"),
    )
    short = -stage.x[basis.get_dofs("top").all("u^2")]
    assert short == pytest.approx(1.5 * pressure / E, rel=1e-6)
    assert "penalty compliance" not in remarks


@pytest.mark.parametrize("pressure", [0.0, 10.0])
def test_share_of_the_penalty_beside_water(pressure: float) -> None:
    """[X] Pressures in the ground are no displacements: a wall that is pushed moves mostly by its
    penalty, as told.
    """
    mesh = MeshTri.init_tensor(np.linspace(0, 1, 5), np.linspace(0, 1, 5)).with_defaults()
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    water = sc.PoreWater(basis, 1.0, unit_weight=10.0)
    wall = sc.Beam(basis, "right", EI=1e6, EA=1e8, bonded=False)
    forms = {
        "ground": sc.SolidForm(basis, sc.LinearElastic(E=1e5, nu=0.0)),
        "water": water,
        "wall": wall,
        **wall.contact(basis, sc.Coulomb(), penalty=2e6),
    }
    model = sc.Model(
        forms,
        [
            basis.get_dofs("left").all("u^1"),
            basis.get_dofs("bottom").all("u^2"),
            *wall.dofs((1.0, 0.0), ["u^2"]),
            water.dofs("left", "right", "top", "bottom"),
        ],
    )
    held = model.forms["water"].prescribed(
        {"left": pressure, "right": pressure, "top": pressure, "bottom": pressure}
    )
    push = [model.forms["wall"].load((-50.0, 0.0), at=(1.0, y)) for y in (0.0, 1.0)]
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        model.run([sc.Stage("push", push, prescribed=held, duration=1e3)], progress=False)
    assert "penalty compliance is " in "; ".join(str(warning.message) for warning in caught)
