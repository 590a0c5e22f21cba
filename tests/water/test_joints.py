"""Joints between bodies in consolidation: open to water or tight, and what contact carries
there.
"""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from scipy.spatial import cKDTree
from skfem import Basis, ElementQuad1, ElementTriP2, ElementVector, MeshQuad, MeshTri

import skfem_contact as sc
from tests.oracles.consolidation import terzaghi

E, NU, MOBILITY, LOAD = 1e4, 0.2, 1e-3, 100.0
OEDOMETER = E * (1 - NU) / (1 + NU) / (1 - 2 * NU)
C_V = OEDOMETER * MOBILITY
OPEN = [("high:bottom", "low:top")]
TIMES = np.array([0.01, 0.05, 0.197, 0.5])
#: A contact as stiff as 500 elements: its closing is no settlement.
HARD = 1e7


def cut_layer(law, joints, element="P2", n=(20, 20), strain="full", coordinates="plane"):
    """Basis, forms, supports and load of a layer cut in two at half its height, that drains at its
    top.
    """
    kind, of = {"P2": (MeshTri, ElementTriP2()), "Q1": (MeshQuad, ElementQuad1())}[element]
    low = kind.init_tensor(
        np.linspace(0, 0.1, n[0] // 10 + 1), np.linspace(0, 0.5, n[0] + 1)
    ).with_defaults()
    high = kind.init_tensor(
        np.linspace(0, 0.1, n[1] // 10 + 1), 1 - 0.5 * np.linspace(1, 0, n[1] + 1) ** 1.6
    )
    mesh = sc.join_bodies({"low": low, "high": high.with_defaults()})
    basis = Basis(mesh, ElementVector(of), intorder=4 if element == "P2" else 2)
    clay = sc.SolidForm(basis, sc.LinearElastic(E=E, nu=NU), strain=strain, coordinates=coordinates)
    forms = {
        "clay": clay,
        "water": sc.PoreWater(basis, MOBILITY, unit_weight=1.0, connected=joints),
        "joint": sc.ContactPair(basis, *OPEN[0], law, penalty=HARD),
    }
    sides = {f"{body}:{side}" for body in ("low", "high") for side in ("left", "right")}
    smooth = np.append(basis.get_dofs("low:bottom").all("u^2"), basis.get_dofs(sides).all("u^1"))
    fixed = [smooth, forms["water"].dofs("high:top")]
    return basis, forms, fixed, sc.traction(clay, "high:top", (0.0, -LOAD))


def consolidated(forms, fixed, load, times=TIMES):
    """Stages that end at degrees T, after a load that comes in a short time about T = 0."""
    ends = np.append(0.25 * times[0], times + 0.125 * times[0])
    stages = [
        sc.Stage(f"{k}", load, duration=d / C_V) for k, d in enumerate(np.diff(ends, prepend=0.0))
    ]
    return list(sc.Model(forms, fixed).run(stages, progress=False))[1:]


@pytest.mark.parametrize(
    ("law", "options"),
    [
        (sc.Tied(), {}),
        (sc.Coulomb(mu=0.5), {"n": (10, 20)}),
        (sc.Tied(), {"n": (20, 10), "coordinates": "axisymmetric"}),
        (sc.Coulomb(mu=0.5), {"element": "Q1", "strain": "b_bar"}),
    ],
)
@pytest.mark.one_in(2)
def test_open_joint(law, options):
    """[X] A layer cut by an open joint consolidates as a whole one; no water is lost, contact
    carries the rest.
    """
    basis, forms, fixed, load = cut_layer(law, OPEN, **options)
    with warnings.catch_warnings():
        warnings.filterwarnings("error", message=".*transfers the pressure of the water")
        stages = consolidated(forms, fixed, load)
    water, y = forms["water"], basis.mesh.p[1]
    settled = [
        -stage.x[basis.get_dofs("high:top").all("u^2")].mean() * OEDOMETER / LOAD
        for stage in stages
    ]
    assert np.abs(settled - terzaghi(TIMES)).max() < 0.002
    joint = np.flatnonzero(y == 0.5)
    sides = [np.unique(basis.mesh.facets[:, basis.mesh.boundaries[name]]) for name in OPEN[0]]
    for T, stage in zip(TIMES[1:], stages[1:], strict=True):
        p = stage.forms["water"].pressure(stage.x)
        # triangles of .05 lean to one side: along the joint their pressures differ by as much
        np.testing.assert_allclose(
            p[joint], LOAD * terzaghi(T, np.array([0.5]))[0, 0], atol=0.004 * LOAD
        )
        low, high = (
            stage.forms["water"].pressure(stage.x)[joint[np.isin(joint, part)]].mean()
            for part in sides
        )
        assert abs(low - high) < 1e-3 * LOAD
        area = 0.1**2 / 2 if stage.forms["joint"].axisymmetric else 0.1
        force = stage.contact("joint").force[1]
        assert abs(force) == pytest.approx(area * (LOAD - p[joint].mean()), abs=0.002 * LOAD * area)
    state = stages[-1].states["water"]
    assert water.inflow(state, "high:top") == pytest.approx(water.volume(state), rel=1e-8)


@pytest.mark.parametrize("top", [1.0, 0.75])
def test_slit_that_ends_in_the_ground(top):
    """[N] Water passes a slit with a soft beam in it as if it were not there: steady flow, and
    beside half a load.
    """
    mesh = MeshTri.init_tensor(np.linspace(0, 2, 17), np.linspace(0, 1, 9)).with_defaults()
    line = mesh.facets_satisfying(lambda x: np.isclose(x[0], 1) & (x[1] > 0.5) & (x[1] < top))
    slit, pair, found = (
        sc.split_along(mesh.with_boundaries({"wall": line}), "wall"),
        ("wall|left", "wall|right"),
        [],
    )
    for part, joints in ((mesh, ()), (slit, (pair,))):
        half = part.with_boundaries({"half": lambda x: (x[1] > 1 - 1e-9) & (x[0] < 1)})
        basis = Basis(half, ElementVector(ElementTriP2()), intorder=4)
        flow = sc.water.Flow(basis, MOBILITY, unit_weight=1.0, connected=joints).steady(
            sc.water.Conditions(head={"left": 3.0, "right": 2.0})
        )
        water = sc.PoreWater(basis, MOBILITY, unit_weight=1.0, connected=joints)
        forms = {"clay": sc.SolidForm(basis, sc.LinearElastic(E=E, nu=NU)), "water": water}
        if joints:
            beam = sc.Beam(basis, pair[0], EI=1e-3, EA=1e-3, bonded=False)
            forms |= {"beam": beam, **beam.contact(basis, sc.Tied(), penalty=1e9)}
        model = sc.Model(forms, [sc.box_supports(basis), water.dofs("top")])
        stage = sc.Stage("load", model.traction("half", (0.0, -LOAD)), duration=0.1 / C_V)
        last = model.run([stage], progress=False)["load"]
        at = cKDTree(half.p.T).query(mesh.p.T)[1]
        found.append((flow.head[at], last.forms["water"].pressure(last.x)[at]))
    assert np.ptp(found[0][1]) > 0.5 * LOAD
    np.testing.assert_allclose(found[1][0], found[0][0], rtol=1e-10)
    np.testing.assert_allclose(
        found[1][1], found[0][1], atol=0.002 * LOAD
    )  # conductance across, springs of contact


@pytest.mark.parametrize("mu", [0.5, 0.0])
def test_tight_joint(mu: float):
    """[X] Without joints there are two layers: the upper one drains as if half as high, the lower
    one not at all.

    Friction counts the pressure of the water, which is told where there is friction.
    """
    basis, forms, fixed, load = cut_layer(sc.Coulomb(mu=mu), ())
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        stages = consolidated(forms, fixed, load)
    assert any(
        "'joint' transfers the pressure of the water as well" in str(w.message) for w in caught
    ) == (mu > 0.0)
    settled = [
        -stage.x[basis.get_dofs("high:top").all("u^2")].mean() * OEDOMETER / LOAD
        for stage in stages
    ]
    assert np.abs(settled - 0.5 * terzaghi(4 * TIMES)).max() < 0.002
    low = basis.mesh.p[1, np.arange(basis.mesh.p.shape[1])] < 0.49
    p = stages[-1].forms["water"].pressure(stages[-1].x)
    np.testing.assert_allclose(p[low], LOAD, rtol=2e-3)  # closing of the contact
    assert abs(stages[-1].contact("joint").force[1]) == pytest.approx(0.1 * LOAD, rel=1e-6)


def test_friction_is_of_the_effective_stress():
    """[X] A block in water of pressure p slides at mu (N - p)."""
    base = MeshQuad.init_tensor(np.linspace(-1, 2, 7), np.linspace(-0.5, 0, 2)).with_defaults()
    block = MeshQuad.init_tensor(np.linspace(0, 1, 3), np.linspace(0, 0.5, 2)).with_defaults()
    mesh = sc.join_bodies({"base": base, "block": block})
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    sides = [("block:bottom", "base:top")]
    forms = {
        "ground": sc.SolidForm(basis, sc.LinearElastic(E=1e6, nu=0.0)),
        "water": sc.PoreWater(basis, 1e-3, connected=sides, unit_weight=9.81),
        "joint": sc.ContactPair(basis, *sides[0], sc.Coulomb(mu=0.5)),
    }
    water, top = forms["water"], basis.get_dofs("block:top")
    model = sc.Model(forms, [basis.get_dofs("base:bottom").all(), top.all("u^1"), water.dofs()])
    water = model.forms["water"]
    held = np.zeros(water.size)
    held[water.carries] = 6.0
    moved = held.copy()
    moved[top.all("u^1")] = 0.01
    load = sc.traction(basis, "block:top", (0.0, -10.0))
    stages = [
        sc.Stage("press", load, prescribed=held, duration=1.0),
        sc.Stage("push", load, prescribed=moved, duration=1.0),
    ]
    result = model.run(stages, progress=False)
    normal, shear = (abs(result["push"].contact("joint").force[i]) for i in (1, 0))
    assert normal == pytest.approx(4.0, rel=1e-6) and shear == pytest.approx(
        0.5 * 4.0, rel=1e-4
    )  # friction: residual


def test_tangent():
    """Symmetric, of one pattern for steps of any length; a uniform pressure does nothing to closed
    joints.
    """
    basis, forms, _, _ = cut_layer(sc.Tied(), OPEN, n=(10, 20))
    water = sc.Model(forms).forms["water"]
    x = np.zeros(water.size)
    x[water.carries] = 3.0
    short, long = (water.over(t).assemble(x, water.initial_state()) for t in (1e-6, 1e6))
    for answer in (short, long):
        assert (
            abs(answer.stiffness - answer.stiffness.T).max() <= 1e-12 * abs(answer.stiffness).max()
        )
    np.testing.assert_array_equal(short.stiffness.indices, long.stiffness.indices)
    inside = basis.mesh.p[1] != 1.0
    np.testing.assert_allclose(
        long.force[basis.N :][inside], 0.0, atol=1e-6
    )  # no flow, through joints either
    force, at_joint = short.force[: basis.N].reshape(-1, 2), basis.doflocs[1, ::2] == 0.5
    within = at_joint & (basis.doflocs[0, ::2] > 0.0) & (basis.doflocs[0, ::2] < 0.1)
    np.testing.assert_allclose(
        force[within], 0.0, atol=1e-12
    )  # the ground beside it and the water in it


@pytest.mark.parametrize(
    ("joints", "message"),
    [
        ([("high:bottom", "lwo:top")], "no boundary 'lwo:top'"),
        (["high:bottom"], "connected must be several values, each 2 values"),
        ([("high:top", "low:bottom")], "nowhere next to each other"),
        ([("high:bottom", "low:top"), ("low:top", "high:bottom")], "in a circle"),
    ],
)
def test_bad_joints(joints, message):
    with pytest.raises(ValueError, match=message):
        cut_layer(sc.Tied(), joints)


def test_joint_of_what_is_not_porous():
    basis, *_ = cut_layer(sc.Tied(), OPEN, n=(10, 10))
    part = basis.with_elements("high")
    with pytest.raises(ValueError, match="porous ground on both sides, but not on 'low:top'"):
        sc.PoreWater(part, MOBILITY, connected=OPEN, unit_weight=9.81)


def test_connected_boundary_that_is_porous_in_part_is_refused() -> None:
    """A side of four facets, of which the lower two bound porous ground."""
    lines = np.linspace(0, 1, 3), np.linspace(0, 2, 5)
    left = MeshQuad.init_tensor(*lines).with_defaults()
    left = left.with_subdomains({"sand": lambda x: x[1] < 1, "rock": lambda x: x[1] > 1})
    right = MeshQuad.init_tensor(*lines).translated((1.0, 0.0)).with_defaults()
    mesh = sc.join_bodies({"p": left, "q": right})
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    porous = basis.with_elements(np.append(mesh.subdomains["p:sand"], mesh.subdomains["q"]))
    with pytest.raises(ValueError, match="porous ground on both sides, but not on 'p:right'"):
        sc.PoreWater(porous, 1e-5, unit_weight=10.0, connected=[("p:right", "q:left")])
