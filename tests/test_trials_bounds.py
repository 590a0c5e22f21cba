"""Trials of bounds from outside: bad input, open joints, loads that nothing bears, soil without
tension.
"""

from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np
import pytest
from skfem import Basis, ElementTriP2, ElementVector, MeshTri

import skfem_contact as sc
from skfem_contact.limit_analysis import certify, search
from tests.fuzz import joints
from tests.fuzz.blocks import Stack
from tests.tools.helpers import analysis

SOIL = sc.MohrCoulomb(E=1e5, nu=0.3, c=10.0, phi=20.0, psi=20.0)


def blocks(gap: float, lower, upper, law: sc.Coulomb | None) -> tuple[dict, np.ndarray]:
    """A block of 4 m above a base that is held, with a joint or without."""
    base = MeshTri.init_tensor(np.linspace(0, 8, 9), np.linspace(-1, 0, 2)).with_defaults()
    block = MeshTri.init_tensor(np.linspace(2, 6, 6), np.linspace(gap, 1 + gap, 2)).with_defaults()
    basis = Basis(
        sc.join_bodies({"base": base, "block": block}), ElementVector(ElementTriP2()), intorder=2
    )
    forms = {
        "base": sc.SolidForm(basis.with_elements("base"), lower),
        "block": sc.SolidForm(basis.with_elements("block"), upper),
    }
    if law is not None:
        forms["joint"] = sc.ContactPair(basis, "block:bottom", "base:top", law, "nodal")
    return forms, basis.get_dofs("base:bottom").all()


def column(material) -> tuple[dict, np.ndarray]:
    """A square that can spread between its base and a smooth left side."""
    basis = Basis(MeshTri().refined(2).with_defaults(), ElementVector(ElementTriP2()), intorder=2)
    fixed = np.append(basis.get_dofs("bottom").all("u^2"), basis.get_dofs("left").all("u^1"))
    return {"ground": sc.SolidForm(basis, material)}, fixed


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"seismic": np.nan}, "seismic"),
        ({"water": lambda x: np.nan * x[0]}, "water must be finite"),
        ({"submerged": "right"}, "give `water`"),
    ],
)
def test_bad_input_is_named(given: dict, message: str) -> None:
    """Values that are not finite, and boundaries under water without water: one error that names
    the argument.
    """
    with pytest.raises(ValueError, match=message):
        analysis("bounds", *column(SOIL), weight=20.0, elements=100, progress=False, **given)


def test_rigid_body_in_the_air() -> None:
    """A rigid body that nothing holds is refused before the iteration."""
    forms, fixed = blocks(1.0, SOIL, sc.LinearElastic(1e6, 0.2), None)
    with pytest.raises(ValueError, match="can move freely"):
        sc.Model(forms, fixed).bounds(weight=20.0, gap=0.2, elements=100, progress=False)


def test_loads_that_nothing_bears_are_no_proof_of_safety() -> None:
    """[X] A column pulled beyond its apex c cot(phi) collapses at every factor."""
    soil = sc.MohrCoulomb(E=1e5, nu=0.3, c=1.0, phi=30.0, psi=30.0)
    with pytest.raises(ValueError, match="at any strength the loads exceed"):
        analysis(
            "bounds", *column(soil), tractions={"top": (0.0, 10.0)}, elements=200, progress=False
        )


@pytest.mark.parametrize("gap", [0.0, 1e-4, 1e-3, 4e-3])
def test_a_joint_is_closed_or_refused(gap: float) -> None:
    """[X] A block slides at .5 * 100 + 2.5 * 4 = 60; sides that do not coincide after matching are
    refused.
    """
    strong = sc.MohrCoulomb(1e5, 0.3, c=1000.0, phi=20.0, psi=20.0)
    forms, fixed = blocks(gap, strong, strong, sc.Coulomb(mu=0.5, adhesion=2.5))
    given = {
        "weight": {"block": 25.0},
        "tractions": {"block:left": (1.0, 0.0)},
        "live": "block:left",
        "gap": 0.05,
        "elements": 120,
        "progress": False,
    }
    if gap > 5e-4:
        with pytest.raises(ValueError, match="of a facet apart"):
            sc.Model(forms, fixed).bounds(**given)
        return
    found = sc.Model(forms, fixed).bounds(**given)
    assert found.lower <= 60 * (1 + 1e-12) and found.upper >= 60 * (1 - 1e-12)
    assert any("associated flow" in remark for remark in found.remarks)


@pytest.mark.parametrize("c", [1000.0, 150.0, 15.0])
def test_a_rigid_block_on_soil(c: float) -> None:
    """[X] A rigid block on soil of any usual strength slides at (.4 * 151.2 + 2 * 4.2) / 1.5 =
    45.92.

    Weight and load are up to 3 times the cohesion of the soil. The ground's boundary goes on beside
    the block, whose edges are singular: without fans there the first stresses of weak soil are a
    third too low.
    """
    ground = MeshTri.init_tensor(np.linspace(0, 9, 8), np.linspace(-3, 0, 4)).with_defaults()
    block = MeshTri.init_tensor(np.linspace(2.1, 6.3, 6), np.linspace(0, 1.5, 3)).with_defaults()
    basis = Basis(
        sc.join_bodies({"ground": ground, "block": block}),
        ElementVector(ElementTriP2()),
        intorder=2,
    )
    soil = sc.MohrCoulomb(1e5, 0.3, c=c, phi=20.0, psi=20.0)
    forms = {
        "ground": sc.SolidForm(basis.with_elements("ground"), soil),
        "block": sc.SolidForm(basis.with_elements("block"), sc.LinearElastic(1e7, 0.2)),
        "joint": sc.ContactPair(basis, "block:bottom", "ground:top", sc.Coulomb(0.4, adhesion=2.0)),
    }
    sides = basis.get_dofs({"ground:left", "ground:right"}).all("u^1")
    model, exact = (
        sc.Model(forms, [basis.get_dofs("ground:bottom").all(), sides]),
        (0.4 * 151.2 + 2.0 * 4.2) / 1.5,
    )
    found = model.bounds(
        weight={"ground": 18.0, "block": 24.0},
        tractions={"block:left": (1.0, 0.0)},
        live="block:left",
        gap=0.03,
        elements=100,
        progress=False,
    )
    assert (
        found.lower <= exact * (1 + 1e-12)
        and found.upper >= exact * (1 - 1e-12)
        and found.gap < 0.03
    )
    assert sum(one.iterations for one in found.history[:2]) < 40


def test_the_certificate_refuses_half_a_percent(monkeypatch: pytest.MonkeyPatch) -> None:
    """[X] Above the largest multiplier of a mesh no stress in equilibrium is admissible: it proves
    nothing.
    """
    given = []
    monkeypatch.setattr(
        search, "prove_lower", lambda *args: given.append(args) or certify.prove_lower(*args)
    )
    forms, fixed = blocks(0.0, SOIL, SOIL, sc.Coulomb(mu=0.5, adhesion=2.5))
    loads = {
        "weight": {"block": 25.0},
        "tractions": {"block:left": (1.0, 0.0)},
        "live": "block:left",
    }
    sc.Model(forms, fixed).bounds(**loads, gap=0.9, elements=100, progress=False)
    program, found, live = given[0]
    assert certify.prove_lower(program, found, live).value == pytest.approx(found.theta, rel=1e-12)
    assert (
        certify.prove_lower(program, replace(found, theta=1.005 * found.theta), live).value
        == -np.inf
    )


def test_a_multiple_of_stresses_is_no_more_than_admissible() -> None:
    """[X] Cohesive soil that can spread carries 2 c; without fixed loads the stresses may be
    multiplied as a whole.
    """
    found = analysis(
        "bounds",
        *column(sc.Tresca(1e3, 0.3, c=10.0)),
        tractions={"top": (0.0, -1.0)},
        live="top",
        elements=200,
        progress=False,
    )
    assert 19.99 < found.lower <= 20.0 * (1 + 1e-12)


def test_a_foot_beside_a_support() -> None:
    """Velocities without jumps cannot leave a support: where contact ends at one, it is named."""
    ground = MeshTri.init_tensor(np.linspace(0, 6, 13), np.linspace(-1, 0, 5)).with_defaults()
    wall = MeshTri.init_tensor(np.linspace(-0.3, 0, 2), np.linspace(-1, 0, 5)).with_defaults()
    basis = Basis(
        sc.join_bodies({"ground": ground, "wall": wall}), ElementVector(ElementTriP2()), intorder=2
    )
    soil = sc.MohrCoulomb(1e5, 0.3, c=1.0, phi=30.0, psi=30.0)
    forms = {
        "ground": sc.SolidForm(basis.with_elements("ground"), soil),
        "wall": sc.SolidForm(basis.with_elements("wall"), sc.LinearElastic(1e7, 0.2)),
        "joint": sc.ContactPair(basis, "wall:right", "ground:left", sc.Coulomb(mu=0.0)),
    }
    sides = basis.get_dofs("ground:right").all("u^1")
    fixed = [basis.get_dofs("ground:bottom").all(), basis.get_dofs("wall:bottom").all("u^2"), sides]
    with pytest.warns(
        sc.AnalysisWarning, match=r"no upper bound .*: contact ends at a support at \(0, -1\)"
    ):
        sc.Model(forms, fixed).bounds(
            weight={"ground": 20.0},
            tractions={"wall:left": (1.0, 0.0)},
            live="wall:left",
            gap=0.5,
            elements=150,
            progress=False,
        )


@pytest.mark.parametrize("c", [1.0, 0.1, 0.0])
def test_passive_earth_pressure(c: float) -> None:
    """[X] Rankine's passive earth pressure on a smooth wall, K_p gamma h / 2 + 2 c sqrt(K_p); sand
    has no lower one.
    """
    expected = 3.0 * 20.0 / 2.0 + 2.0 * c * np.sqrt(3.0)
    ground = MeshTri.init_tensor(np.linspace(0, 6, 13), np.linspace(-1, 0, 5)).with_defaults()
    wall = MeshTri.init_tensor(np.linspace(-0.3, 0, 2), np.linspace(-1, 0, 5)).with_defaults()
    basis = Basis(
        sc.join_bodies({"ground": ground, "wall": wall}), ElementVector(ElementTriP2()), intorder=2
    )
    soil = sc.MohrCoulomb(1e5, 0.3, c=c, phi=30.0, psi=30.0)
    forms = {
        "ground": sc.SolidForm(basis.with_elements("ground"), soil),
        "wall": sc.SolidForm(basis.with_elements("wall"), sc.LinearElastic(1e7, 0.2)),
        "joint": sc.ContactPair(basis, "wall:right", "ground:left", sc.Coulomb(mu=0.0)),
    }
    fixed = [
        basis.get_dofs({"ground:bottom", "wall:bottom"}).all("u^2"),
        basis.get_dofs("ground:right").all("u^1"),
    ]
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        found = sc.Model(forms, fixed).bounds(
            weight={"ground": 20.0},
            tractions={"wall:left": (1.0, 0.0)},
            live="wall:left",
            gap=0.05,
            elements=300,
            progress=False,
        )
    assert expected * (1 - 1e-12) <= found.upper < 1.001 * expected
    if c:
        assert 0.999 * expected < found.lower <= expected * (1 + 1e-12)
    else:
        assert found.lower == -np.inf and "give it a small cohesion" in str(told[-1].message)


def test_soil_without_tension() -> None:
    """The missing lower bound is explained by the missing tension."""
    mesh = MeshTri.init_tensor(np.linspace(-2, 0, 3), np.linspace(0, 2, 3)).with_boundaries(
        {"base": lambda x: x[1] < 1e-9, "sides": lambda x: x[0] < -2 + 1e-9}
    )
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    fixed = np.append(basis.get_dofs("base").all(), basis.get_dofs("sides").all("u^1"))
    soil = sc.SolidForm(basis, sc.MohrCoulomb(1e5, 0.3, c=32.0, phi=10.0, psi=10.0, tension=0.0))
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        found = sc.Model({"soil": soil}, fixed).bounds(
            weight=20.0, gap=0.1, elements=60, progress=False
        )
    assert found.lower > 1.0 or any("a small tension" in str(one.message) for one in told)


def test_joints_that_open_as_they_slip() -> None:
    """A plug jams between rough walls if joints open by mu times their slip, and falls at .300 in
    contact: a remark.
    """
    up = np.append([-0.5, -0.25], np.linspace(0, 1, 5))
    sides = {
        "left": lambda x: (x[0] < 1e-9) & (x[1] > 0),
        "right": lambda x: (x[0] > 1 - 1e-9) & (x[1] > 0),
        "bottom": lambda x: x[1] < -0.5 + 1e-9,
        "top": lambda x: x[1] > 1 - 1e-9,
    }
    block = MeshTri.init_tensor(np.linspace(0, 1, 5), up).with_boundaries(sides)
    block = block.with_subdomains({"pad": lambda x: x[1] < 0, "plug": lambda x: x[1] > 0})
    wall = MeshTri.init_tensor(np.linspace(-0.5, 0, 2), np.linspace(0, 1.5, 7)).with_defaults()
    mesh = sc.join_bodies({"block": block, "west": wall, "east": wall.translated((1.5, 0.0))})
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    clay = {"block:plug": sc.Tresca(1e4, 0.3, c=10.0), "block:pad": sc.Tresca(1e3, 0.3, c=0.05)}
    forms = {"block": sc.SolidForm(basis.with_elements("block"), clay)}
    for name, side, face in (("west", "left", "right"), ("east", "right", "left")):
        forms[name] = sc.SolidForm(basis.with_elements(name), sc.LinearElastic(1e6, 0.0))
        forms[side] = sc.ContactPair(
            basis,
            f"block:{side}",
            f"{name}:{face}",
            sc.Coulomb(mu=0.6),
            "nodal",
            penalty=(1e6, 1e6),
        )
    model = sc.Model(
        forms, [basis.get_dofs(name).all() for name in ("west:left", "east:right", "block:bottom")]
    )
    found = model.bounds(
        tractions={"block:top": (0.0, -1.0)},
        live="block:top",
        gap=0.1,
        elements=150,
        progress=False,
    )
    limit = model.limit_load(model.traction("block:top", (0.0, -1.0)), step=0.2, progress=False)
    assert limit.multiplier == pytest.approx(0.300, abs=0.002) and found.lower > 10.0
    # without friction the pad alone carries: its lower bound on this mesh is a third of its limit
    assert found.estimate and 0.1 < found.safe < limit.multiplier and "safe 0.1" in str(found)
    assert any(
        "joints left, right open by mu times their slip" in remark for remark in found.remarks
    )


def test_bounds_take_the_earthquake_of_the_model() -> None:
    """[X] A model's horizontal acceleration is that of its bounds; gravity in another direction is
    refused.
    """
    mesh = MeshTri.init_tensor(np.linspace(0, 2, 5), np.linspace(0, 2, 5)).with_defaults()
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    soil = sc.SolidForm(
        basis, sc.MohrCoulomb(E=1e4, nu=0.3, c=10.0, phi=20.0, psi=20.0), unit_weight=20.0
    )
    bottom = basis.get_dofs("bottom").all()
    shaken = sc.Model({"soil": soil}, bottom, seismic=0.3).bounds(elements=100, gap=0.5)
    asked = sc.Model({"soil": soil}, bottom).bounds(elements=100, gap=0.5, seismic=0.3)
    assert (shaken.lower, shaken.upper) == (asked.lower, asked.upper)
    with pytest.raises(ValueError, match="rotate the mesh"):
        sc.Model({"soil": soil}, bottom, gravity=(0.6, -0.8)).bounds()


def test_joints_without_adhesion_have_no_safe_bound():
    """[X] Two blocks on a slope slide at mu / tan(9.7 degrees) = 2.28: bounds, though smooth joints
    resist nothing.
    """
    drawn = Stack(0.98, (0.97, 0.51), (0.39, 0.47), np.radians(9.7), "nodal")
    found = {check.oracle: check for check in joints.bounds(drawn, False, "given", False)}
    assert found["ordered"].error == 0.0
    assert (
        found["lower"].error < 1e-9 and found["upper"].error < 1e-9 and found["safe"].error == -1.0
    )


def test_a_wall_that_is_much_stronger_than_clay() -> None:
    """[B] A wall of concrete as Tresca, 500 times as strong: nearly the bounds of a rigid one, and
    what would help.
    """
    mesh = MeshTri.init_tensor(np.r_[0:10:6j, 10.5:20:6j], np.linspace(-10, 0, 11))
    x, y = mesh.p[:, mesh.t].mean(axis=1)
    mesh = mesh.restrict(np.flatnonzero((x < 10.5) | (y < -3)))
    wall = lambda x: (abs(x[0] - 10.25) < 0.25) & (x[1] > -6)  # noqa: E731
    mesh = mesh.with_subdomains({"wall": wall, "clay": lambda x: ~wall(x)})
    basis, found = Basis(mesh, ElementVector(ElementTriP2()), intorder=2), []
    for concrete in (sc.LinearElastic(E=3e7, nu=0.2), sc.Tresca(E=3e7, nu=0.2, c=1e4)):
        materials = {"wall": concrete, "clay": sc.Tresca(E=1e4, nu=0.3, c=20.0)}
        model = sc.Model(
            {"all": sc.SolidForm(basis, materials, unit_weight=20.0)}, sc.box_supports(basis)
        )
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            found.append(model.bounds(gap=0.1, elements=600, progress=False))
    rigid, strong = found
    assert (
        strong.upper == pytest.approx(rigid.upper, rel=0.02) and strong.lower > 0.75 * rigid.lower
    )
    assert "much stronger than the rest would be rigid, and bounds closer: wall" in str(
        caught[-1].message
    )


def test_a_bank_that_needs_six_times_its_strength() -> None:
    """[X] A bank of 4 m on a smooth base, c = .5, phi = 30 degrees: at most .1812, the factor of a
    wedge.
    """
    basis = Basis(
        MeshTri.init_tensor(np.linspace(0, 8, 17), np.linspace(0, 4, 9)).with_defaults(),
        ElementVector(ElementTriP2()),
        intorder=2,
    )
    soil = sc.SolidForm(
        basis, sc.MohrCoulomb(E=2e4, nu=0.3, c=0.5, phi=30.0, psi=30.0), unit_weight=18.0
    )
    model = sc.Model(
        {"soil": soil}, [basis.get_dofs("bottom").all("u^2"), basis.get_dofs("right").all("u^1")]
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", sc.AnalysisWarning)  # the gap
        found = model.bounds(elements=300, progress=False)
    assert 0.13 < found.lower < found.upper < 0.1812
