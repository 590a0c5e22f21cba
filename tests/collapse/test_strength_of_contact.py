"""Strength reduction of contact: a block on an inclined plane, whose factor of safety is known."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from skfem import (
    Basis,
    ElementQuad1,
    ElementTriP2,
    ElementVector,
    MeshQuad,
)

import skfem_contact as sc
from skfem_contact.contact.interface import ContactState
from skfem_contact.contact.laws import Status
from skfem_contact.results import Result

SLOPE = 0.4
WEIGHT = 20.0
ADHESION = 10.0 * np.sin(np.arctan(SLOPE))  # carries half of the driving force, 20 sin(beta)


def on_an_incline(law: sc.Coulomb) -> tuple[dict, Result, np.ndarray]:
    """An elastic unit block at rest on a plane that is inclined by the slope; gravity is, in
    fact.
    """
    block = MeshQuad().refined(1).with_defaults()
    plane = block.scaled((3.0, 1.0)).translated((-1.0, -1.0))
    basis = Basis(
        sc.join_bodies({"plane": plane, "block": block}), ElementVector(ElementQuad1()), intorder=2
    )
    angle = np.arctan(SLOPE)
    load = sc.weight(basis, {"block": WEIGHT}, direction=(np.sin(angle), -np.cos(angle)))
    forms = {
        "bodies": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.2)),
        "joint": sc.ContactPair(basis, "block:bottom", "plane:top", law, quadrature="nodal"),
    }
    fixed = basis.get_dofs("plane:bottom").all()
    return forms, sc.Model(forms, fixed).run([sc.Stage("weight", load)]), fixed


@pytest.mark.parametrize(
    ("law", "factor"),
    [(sc.Coulomb(mu=0.6), 1.5), (sc.Coulomb(mu=0.3, adhesion=ADHESION), 0.3 / SLOPE + 0.5)],
    ids=["friction", "friction and adhesion"],
)
def test_block_slides_when_friction_and_adhesion_are_used_up(
    law: sc.Coulomb, factor: float
) -> None:
    """[X] F = mu / tan(beta) + a A / (W sin(beta)): both parts of the contact's strength are
    divided by the factor.
    """
    forms, rest, fixed = on_an_incline(law)
    result = sc.Model(forms, fixed).strength_reduction(start=rest, reduce={"joint"}, tolerance=0.01)
    # the curve is followed to within the tolerance; the forces balance to 3e-4 of the largest, the
    # weight, which is 1 / 0.37 times what drives the block
    assert factor - 0.01 < result.factor < factor + 0.002


def test_mechanism_is_the_block_that_slides_down() -> None:
    """The block moves as a whole and downhill, the plane stays."""
    forms, rest, fixed = on_an_incline(sc.Coulomb(mu=0.6))
    result = sc.Model(forms, fixed).strength_reduction(start=rest, reduce={"joint"})
    basis = forms["bodies"].basis
    ux = result.mechanism[basis.nodal_dofs[0]]
    block = np.unique(basis.mesh.t[:, basis.mesh.subdomains["block"]])
    # a rigid motion of 1 beside what bodies and penalty yield elastically
    np.testing.assert_allclose(ux[block], 1.0, atol=0.05)
    assert np.abs(np.delete(ux, block)).max() < 0.05


def test_contact_that_is_excluded_keeps_its_strength() -> None:
    """With elastic bodies there is then nothing to reduce."""
    forms, rest, fixed = on_an_incline(sc.Coulomb(mu=0.6))
    with pytest.raises(ValueError, match="nothing to reduce"):
        sc.Model(forms, fixed).strength_reduction(start=rest, exclude="joint")


def test_collapse_goes_on_from_what_the_stages_have_left() -> None:
    """[X] A column that can spread carries 2 c; the layer that was taken off it, and its nodes, do
    not count.
    """
    mesh = MeshQuad().refined(2).with_defaults()
    mesh = mesh.with_subdomains({"low": lambda x: x[1] < 0.5, "high": lambda x: x[1] > 0.5})
    mesh = mesh.with_boundaries(
        {"middle": lambda x: np.abs(x[1] - 0.5) < 1e-9}, boundaries_only=False
    )
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    clay = sc.MohrCoulomb(E=1e3, nu=0.3, c=10.0, phi=0.0)
    forms = {
        name: sc.SolidForm(basis.with_elements(name), clay, "b_bar") for name in ("low", "high")
    }
    fixed = np.append(basis.get_dofs("bottom").all("u^2"), basis.get_dofs("left").all("u^1"))
    tributary = np.array([0.125, 0.25, 0.25, 0.25, 0.125])
    loads = []
    for y in (1.0, 0.5):
        nodes = np.flatnonzero(mesh.p[1] == y)
        loads.append(basis.zeros())
        loads[-1][basis.nodal_dofs[1, nodes[np.argsort(mesh.p[0, nodes])]]] = -10.0 * tributary
    stages = [sc.Stage("pressed", loads[0]), sc.Stage("dug", loads[1], deactivate="high")]
    result = sc.Model(forms, fixed).run(stages, progress=False)
    found = sc.Model(forms, fixed).strength_reduction(start=result, progress=False)
    assert found.factor == pytest.approx(2.0, abs=0.01)  # the tolerance of the search
    assert found.reduced == ("low.all",)
    limit = sc.Model(forms, fixed).limit_load(loads[1], start=result, progress=False)
    assert limit.multiplier == pytest.approx(1.0, abs=0.005)  # besides the load that is there
    with pytest.raises(ValueError, match="no form, though the start holds it, 'low'"):
        sc.Model({"high": forms["high"]}, fixed).limit_load(loads[1], start=result)


@pytest.mark.parametrize("enforcement", [None, sc.AugmentedLagrangian()])
def test_end_with_contact_is_a_start(enforcement: sc.AugmentedLagrangian | None) -> None:
    """Where contact follows the bodies again it carries what it did in its first geometry, and gaps
    are those there.
    """
    ground = MeshQuad.init_tensor(np.linspace(0, 4, 9), np.linspace(0, 2, 5)).with_defaults()
    block = MeshQuad.init_tensor(np.linspace(1, 2, 4), np.linspace(2, 3, 3)).with_defaults()
    mesh = sc.join_bodies({"ground": ground, "block": block})
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    forms = {
        "ground": sc.SolidForm(
            basis.with_elements("ground"), sc.Tresca(E=1e3, nu=0.3, c=10.0), strain="b_bar"
        ),
        "block": sc.SolidForm(basis.with_elements("block"), sc.LinearElastic(E=1e5, nu=0.2)),
        "joint": sc.ContactPair(
            basis, "block:bottom", "ground:top", sc.Coulomb(mu=0.3), 2, enforcement=enforcement
        ),
    }
    fixed = basis.get_dofs("ground:bottom").all()
    push = sc.traction(basis, "block:top", (0.0, -1.0))
    first = sc.Model(forms, fixed).run([sc.Stage("rest", 5.0 * push)], progress=False)
    end = sc.Model(forms, fixed).limit_load(push, start=first, progress=False).end
    pair, state = end.forms["joint"], end.states["joint"]
    assert abs(end.x).max() > 0.1  # of a block of 1
    again = pair.assemble(end.x, state).state
    on = state.status != Status.OPEN
    np.testing.assert_allclose(
        again.traction[:, on], state.traction[:, on], atol=1e-9 * abs(state.traction).max()
    )
    np.testing.assert_allclose(state.gap[on], again.gap[on], atol=1e-12)
    back = sc.Model(forms, fixed).run([sc.Stage("back", 5.0 * push)], start=end, progress=False)[
        "back"
    ]
    top = basis.get_dofs("block:top").all("u^2")
    assert (
        0.5 * end.x[top].mean() > back.x[top].mean() > end.x[top].mean()
    )  # sunk, and up by what is elastic


def test_joints_are_reduced_like_all_other_strength():
    """[X] A block on an incline of 1 : 4 with mu = 0.4 slides at 1.6."""
    base = MeshQuad.init_tensor(np.linspace(0, 4, 13), np.linspace(-1, 0, 4)).with_defaults()
    block = MeshQuad.init_tensor(np.linspace(1.5, 2.5, 5), np.linspace(0, 0.5, 3)).with_defaults()
    basis = Basis(
        sc.join_bodies({"base": base, "block": block}), ElementVector(ElementQuad1()), intorder=2
    )
    soil = sc.MohrCoulomb(E=1e5, nu=0.3, c=20.0, phi=30.0, psi=30.0)
    forms = {
        "base": sc.SolidForm(basis.with_elements("base"), soil, "b_bar"),
        "block": sc.SolidForm(basis.with_elements("block"), sc.LinearElastic(E=1e6, nu=0.2)),
        "joint": sc.ContactPair(
            basis, "block:bottom", "base:top", sc.Coulomb(mu=0.4), quadrature=2
        ),
    }
    angle = np.arctan(0.25)
    down = sc.weight(basis, {"base": 0.0, "block": 20.0}, direction=(np.sin(angle), -np.cos(angle)))
    found = sc.Model(forms, basis.get_dofs("base:bottom").all()).strength_reduction(
        down, progress=False
    )
    assert found.reduced == ("base.all", "joint")
    assert found.factor == pytest.approx(1.6, abs=0.01)  # tol


@cache
def wall(stiffness, law):
    """Factor of a vertical cut of clay, 4 m, beside a slender wall that stands in the ground."""
    x = np.concatenate((np.linspace(-8, 0, 7), [0.4], 0.4 + np.linspace(0, 6, 6)[1:]))
    flat = MeshQuad.init_tensor(x, np.linspace(-6, 4, 11))
    middle = flat.p[:, flat.t].mean(axis=1)
    mesh = flat.restrict(np.flatnonzero((middle[0] < 0.4) | (middle[1] < 0))).to_meshtri(style="x")

    def in_wall(p):
        return (p[0] > 0) & (p[0] < 0.4) & (p[1] > -3)

    faces = {
        "left": lambda p: np.isclose(p[0], 0.0) & (p[1] > -3),
        "tip": lambda p: np.isclose(p[1], -3) & (p[0] > 0) & (p[0] < 0.4),
        "right": lambda p: np.isclose(p[0], 0.4) & (p[1] > -3) & (p[1] < 0),
    }
    mesh = mesh.with_boundaries(
        faces
        | {
            "bottom": lambda p: p[1] < -6 + 1e-9,
            "sides": lambda p: (p[0] < -8 + 1e-9) | (p[0] > 6.4 - 1e-9),
        },
        boundaries_only=False,
    )
    mesh = mesh.with_subdomains({"wall": in_wall, "clay": lambda p: ~in_wall(p)})
    mesh = sc.join_bodies(mesh, bodies={"ground": "clay", "wall": "wall"})
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    forms = {
        "ground": sc.SolidForm(
            basis.with_elements("ground"), sc.Tresca(E=stiffness * 1e4, nu=0.3, c=25.0)
        ),
        "wall": sc.SolidForm(
            basis.with_elements("wall"), sc.LinearElastic(E=stiffness * 2e7, nu=0.2)
        ),
    }
    for face in faces:
        penalty = stiffness * 1e5, stiffness * 1e4
        forms[face] = sc.ContactPair(
            basis, f"ground:{face}", f"wall:{face}", law, "nodal", penalty=penalty
        )
    fixed = np.append(basis.get_dofs("bottom").all(), basis.get_dofs("sides").all("u^1"))
    return sc.Model(forms, fixed).strength_reduction(
        sc.weight(basis, {"clay": 19.0, "wall": 25.0}), tolerance=0.01, progress=False
    )


FRICTION = sc.Coulomb(mu=0.3)


@pytest.mark.slow
def test_factor_with_contact_does_not_depend_on_stiffness():
    """[X] Collapse loads are rigid-plastic: one factor over 2,500-fold moduli and penalties, to
    within `tol`.
    """
    factors = [wall(stiffness, FRICTION).factor for stiffness in (0.02, 1.0, 50.0)]
    assert max(factors) - min(factors) <= 0.01


@pytest.mark.slow
def test_weaker_joint_does_not_raise_the_factor():
    """[X] Friction after bond, no friction after friction; all curves end within a quarter of
    0.01.
    """
    bonded, rough, smooth = (wall(1.0, law).factor for law in (sc.Tied(), FRICTION, sc.Coulomb()))
    assert smooth <= rough + 0.0025 <= bonded + 0.005


def test_end_of_a_search_has_the_pairs_own_states():
    """What is found is shown as after any stage: contact pairs, their states and their
    tractions.
    """
    found = wall(1.0, FRICTION)
    assert type(found.states["left"]) is ContactState
    assert found.end.forms["left"].law.mu == pytest.approx(0.3 / found.factor)
    tractions = found.end.tractions("left")
    limit = found.end.forms["left"].law.mu * tractions.pressure
    assert (
        np.abs(tractions.shear) <= limit + 1e-9 * tractions.pressure.max()
    ).all() and tractions.pressure.max() > 0
