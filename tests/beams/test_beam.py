"""Beams: closed forms of elastic beams, collapse loads of frames, bonded beams, contact on both
sides.
"""

from __future__ import annotations

import warnings
from itertools import pairwise

import numpy as np
import pytest
from scipy.sparse import coo_matrix
from skfem import MeshQuad, MeshTri, MeshTri2

import skfem_contact as sc
from skfem_contact.beams.element import BeamElements, SpaceElements, shapes
from skfem_contact.beams.thrust import lost_stiffness
from skfem_contact.results import Result
from tests.tools.helpers import grid, vector_basis

QUIET = {"progress": False}


def straight(length, n, start=0.0):
    return np.column_stack((start + np.linspace(0.0, length, n + 1), np.zeros(n + 1)))


def solved(beam, fixed, loads, **others):
    """The stage of a beam under forces at points, its form and its section forces."""
    model = sc.Model({"beam": beam, **others}, fixed)
    form = model.forms["beam"]
    stage = model.run([sc.Stage("load", [form.load(force, at) for force, at in loads])], **QUIET)[
        "load"
    ]
    return stage, form, stage.section_forces("beam")


class Winkler(sc.Form, sc.roles.Couples):
    """Springs k per length across a straight level beam, by three Gauss points."""

    symmetric = True

    def __init__(self, beam, k):
        self.borrowed, self.K = (beam.displacement,), np.zeros((2 * len(beam.points),) * 2)
        for xi, w in zip((-np.sqrt(0.6), 0.0, np.sqrt(0.6)), (5 / 9, 8 / 9, 5 / 9), strict=True):
            for nodes, h in zip(beam.cells, beam._elements.length, strict=True):
                v = 2 * nodes + 1
                self.K[np.ix_(v, v)] += k * w * h / 2 * np.outer(shapes(xi)[0], shapes(xi)[0])

    def numbered(self, numbers):
        self.dofs = numbers[self.borrowed[0]]
        return self

    def assemble(self, x, state):
        return sc.Response(
            self.K @ x[self.dofs], lambda: None, lambda: coo_matrix(self.K).tocsr(), dofs=self.dofs
        )


def test_elements_that_yield_are_counted():
    """[X] A propped cantilever yields at its clamp from 16 Mp / 3 L on, below its limit 6 Mp / L:
    one element of two.
    """
    line = straight(2.0, 2)
    beam = sc.Beam(None, line, EI=1e3, EA=1e5, Mp=10.0)
    fixed = [*beam.dofs(line[0]), *beam.dofs(line[-1], ["u^2"])]
    counted = []
    for force in (26.0, 28.0):
        stage, form, _ = solved(beam, fixed, [((0.0, -force), line[1])])
        outputs = form.outputs(stage.x, stage.states["beam"])
        counted.append(outputs.yielding(form.initial_state()))
    assert counted == [(0, 2), (1, 2)]


@pytest.mark.parametrize("n", [1, 2, 8])
@pytest.mark.parametrize(
    ("shear", "left"), [(1e4, 1e-9), (1e8, 1e-6)]
)  # GA L^2 / EI: so many digits are left
def test_cantilever(n, shear, left):
    """[X] Deflection P L^3 / 3 EI + P L / GA and moment P L, in a slope of 3 in 4, with any number
    of elements.
    """
    way = np.array([0.8, 0.6])
    beam = sc.Beam(None, np.linspace(0, 2, n + 1)[:, None] * way, EI=1.0, EA=1e3, GA=shear / 4)
    across = np.array([-0.6, 0.8])
    stage, form, forces = solved(beam, beam.dofs((0, 0)), [(3.0 * across, 2 * way)])
    tip = stage.x[form.numbers(2 * way)]
    assert tip[:2] @ across == pytest.approx(3 * 8 / 3 + 3 * 2 / (shear / 4), rel=left)
    assert tip[2] == pytest.approx(3 * 4 / 2, rel=left)
    np.testing.assert_allclose(forces.M, -3.0 * (2.0 - forces.position), atol=3 * left)
    np.testing.assert_allclose(forces.V, 3.0, rtol=left)
    np.testing.assert_allclose(forces.N, 0.0, atol=3 * left)


@pytest.mark.parametrize(
    ("per", "deflection", "moment"), [(1, 8e-4, 1.2e-3), (2, 7e-5, 9e-5), (4, 2e-5, 1e-5)]
)
def test_infinite_winkler_beam(per, deflection, moment):
    """[X] Hetenyi 1946: w = P lam / 2 k, M = P / 4 lam under the force, with so many elements per 1
    / lam.

    What is left at four is shear, EI / GA, in the deflection.
    """
    n = 16 * per
    beam = sc.Beam(None, straight(16.0, n, -8.0), EI=1.0, EA=1e3, GA=1e5)
    stage, form, forces = solved(
        beam,
        beam.dofs((-8.0, 0.0), ["u^1"]),
        [((0.0, -1.0), (0.0, 0.0))],
        ground=Winkler(beam, 4.0),
    )
    assert -stage.x[form.numbers((0.0, 0.0))[1]] == pytest.approx(1 / 8, rel=deflection)
    assert forces.M.min() == pytest.approx(-1 / 4, rel=moment)


@pytest.mark.parametrize(
    ("curved", "deflection", "moment"), [(True, 6e-4, 2e-5), (False, 3.2e-2, 1.3e-2)]
)
def test_ring(curved, deflection, moment):
    """[X] Two opposite forces on a ring of 16 elements: (pi/4 - 2/pi) P R^3 / EI together, and M =
    P R / pi there.
    """
    n, angle = 16, 2 * np.pi * np.arange(32) / 32
    points = np.column_stack((np.cos(angle), np.sin(angle)))
    ends = 2 * np.arange(n)
    cells = np.column_stack((ends, (ends + 2) % 32, ends + 1))
    if not curved:
        points, cells = points[::2], np.column_stack((np.arange(n), (np.arange(n) + 1) % n))
    beam = sc.Beam(None, points, EI=1.0, EA=1e6, GA=1e6, cells=cells)
    top, foot = (0.0, 1.0), (0.0, -1.0)
    fixed = [*beam.dofs((1.0, 0.0), ["u^2"]), *beam.dofs(top, ["u^1"]), *beam.dofs(foot, ["u^1"])]
    stage, form, forces = solved(beam, fixed, [((0.0, -1.0), top), ((0.0, 1.0), foot)])
    closer = stage.x[form.numbers(foot)[1]] - stage.x[form.numbers(top)[1]]
    assert closer == pytest.approx(np.pi / 4 - 2 / np.pi, rel=deflection)
    assert np.abs(forces.M).max() == pytest.approx(1 / np.pi, rel=moment)


def test_hinge_and_line_load():
    """[X] Two cantilevers that meet at a hinge share a force; under its weight q the shear ends in
    q L at the wall.
    """
    beam = sc.Beam(None, straight(2.0, 4), EI=1.0, EA=1e3, GA=1e6, hinges=(1.0, 0.0))
    ends = [*beam.dofs((0.0, 0.0)), *beam.dofs((2.0, 0.0))]
    stage, form, _ = solved(beam, ends, [((0.0, 1.0), (1.0, 0.0))])
    assert stage.x[form.numbers((1.0, 0.0))[1]] == pytest.approx(0.5 / 3 + 0.5e-6, rel=1e-7)
    beam = sc.Beam(
        None, straight(2.0, 4), EI=1.0, EA=1e3, GA=1e6, hinges=(1.0, 0.0), unit_weight=3.0
    )
    ends = [*beam.dofs((0.0, 0.0)), *beam.dofs((2.0, 0.0))]
    forces = (
        sc.Model({"beam": beam}, ends)
        .run([sc.Stage("weight")], **QUIET)["weight"]
        .section_forces("beam")
    )
    left = forces.position < 1.0
    np.testing.assert_allclose(forces.V[left], -3.0 * (1 - forces.position[left]), atol=1e-6)
    np.testing.assert_allclose(forces.M[left], 1.5 * (1 - forces.position[left]) ** 2, atol=1e-6)


def at_limit(beam, fixed, loads, start=None):
    model = sc.Model({"beam": beam}, fixed, newton=sc.Newton(tolerance=1e-9))
    load = sum(model.forms["beam"].load(force, at) for force, at in loads)
    first = (
        None
        if start is None
        else model.run([sc.Stage("dead", model.forms["beam"].load(*start))], **QUIET)
    )
    found = model.limit_load(load, start=first, **QUIET)
    assert found.stop.kind in ("plateau", "collapse"), found.stop
    return found


@pytest.mark.parametrize("n", [2, 4, 8])
def test_collapse_of_a_propped_cantilever(n):
    """[X] P = 6 Mp / L with the force in the middle. The tolerance is the difference of hinges at
    one node.
    """
    beam = sc.Beam(None, straight(2.0, n), EI=100.0, EA=1e4, GA=1e6, Mp=3.0)
    fixed = [*beam.dofs((0.0, 0.0)), *beam.dofs((2.0, 0.0), ["u^2"])]
    assert at_limit(beam, fixed, [((0.0, -1.0), (1.0, 0.0))]).multiplier == pytest.approx(
        9.0, rel=1e-6
    )


@pytest.mark.parametrize("n", [2, 4, 8])
def test_collapse_of_a_portal(n):
    """[X] A portal of height h and span 2h fixed at its feet, V = 2 H: combined mechanism, 3 H h =
    6 Mp.
    """
    corners = np.array([[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [2.0, 1.0], [2.0, 0.0]])
    steps = np.linspace(0, 1, n, endpoint=False)[:, None]
    points = np.vstack([a + (b - a) * steps for a, b in pairwise(corners)] + [corners[-1:]])
    beam = sc.Beam(None, points, EI=100.0, EA=1e5, GA=1e6, Mp=3.0)
    fixed = [*beam.dofs((0.0, 0.0)), *beam.dofs((2.0, 0.0))]
    found = at_limit(beam, fixed, [((1.0, 0.0), (0.0, 1.0)), ((0.0, -2.0), (1.0, 1.0))])
    assert found.multiplier == pytest.approx(6.0, rel=1e-6)


@pytest.mark.parametrize("share", [0.2, 0.5])
def test_collapse_under_thrust(share):
    """[X] A cantilever under the thrust N resists M = Mp (1 - N / Np)."""
    beam = sc.Beam(None, straight(2.0, 4), EI=100.0, EA=1e4, GA=1e6, Mp=3.0, Np=50.0)
    found = at_limit(
        beam, beam.dofs((0.0, 0.0)), [((0.0, 1.0), (2.0, 0.0))], ((-50.0 * share, 0.0), (2.0, 0.0))
    )
    assert found.multiplier == pytest.approx(1.5 * (1 - share), rel=1e-6)


def test_collapse_by_the_weaker_side_of_a_corner():
    """[X] A column under thrust below a beam without: the column's end at the corner has the moment
    Mp (1 - N / Np).

    The column is held upright by its foot, and a force beside its top bends the corner.
    """
    beam = sc.Beam(
        None, [[0.0, 0.0], [0.0, 2.0], [1.0, 2.0]], EI=100.0, EA=1e4, GA=1e6, Mp=3.0, Np=30.0
    )
    found = at_limit(beam, beam.dofs((0.0, 0.0)), [((0.0, -1.0), (1.0, 2.0))])
    assert found.multiplier == pytest.approx(
        1 / (1 / 3 + 1 / 30), rel=1e-6
    )  # P * 1 / Mp + P / Np = 1


@pytest.mark.parametrize("Mp", [np.inf, 0.5])
def test_form(Mp):
    """Forces balance, and the tangent agrees with differences; the share that hinges keep is
    1e-6.
    """
    beam = sc.Beam(
        None,
        [[0.0, 0.0], [1.0, 0.2], [2.0, 0.0]],
        EI=1.0,
        EA=10.0,
        GA=10.0,
        Mp=Mp,
        Np=np.inf if Mp == np.inf else 2.0,
    )
    x = np.random.default_rng(0).standard_normal(15)
    state = beam.initial_state()
    assert sc.testing.check_form(beam, x, state, tolerance=1e-5) < (1e-8 if Mp == np.inf else 1e-5)
    N, M = np.array(beam.outputs(x, beam.assemble(x, state).state).lines)[[3, 5]]
    if Mp < np.inf:
        # ends at a node differ by 1e-7
        assert (np.abs(M) / 0.5 + np.abs(N) / 2.0).max() == pytest.approx(1.0, abs=2e-7)


@pytest.mark.parametrize("EI", [1e-5, 1.0, 1e5])
@pytest.mark.parametrize("ratio", [1e-2, 1e2, 1e8])
def test_stiffness_over_ten_decades(EI, ratio):
    """[X] A frame of two members that are 1 and 2 long, fixed at its foot: bent by P, and stretched
    by it.
    """
    EA = ratio * EI
    beam = sc.Beam(
        None, [[0.0, 0.0], [0.0, 0.5], [0.0, 1.0], [2.0, 1.0]], EI=EI, EA=EA, GA=1e3 * EI
    )
    stage, form, forces = solved(beam, beam.dofs((0.0, 0.0)), [((0.0, -3.0), (2.0, 1.0))])
    down = -stage.x[form.numbers((2.0, 1.0))[1]]
    # the foot turns the member of length 2 by M * 1 / EI; it bends and shears itself, and the foot
    # is pressed
    assert down == pytest.approx(
        3 * 2 * 1 * 2 / EI + 3 * 8 / 3 / EI + 3 * 2 / (1e3 * EI) + 3 / EA, rel=1e-6
    )
    np.testing.assert_allclose(forces.N, [-3.0] * 4 + [0.0] * 2, atol=1e-5)
    np.testing.assert_allclose(np.abs(forces.M), [6.0] * 5 + [0.0], atol=1e-5)


def test_spacing():
    """A row of members at a distance of 2 is as stiff and strong as half of one per unit of
    length.
    """
    values = {"EI": 100.0, "EA": 1e4, "GA": 1e6, "Mp": 3.0, "Np": 30.0, "unit_weight": 1.0}
    found = []
    for spacing, share in ((2.0, 1.0), (None, 0.5)):
        beam = sc.Beam(
            None,
            straight(2.0, 2),
            **{k: share * value for k, value in values.items()},
            spacing=spacing,
        )
        model = sc.Model({"beam": beam}, beam.dofs((0.0, 0.0)))
        found.append(model.run([sc.Stage("weight")], **QUIET)["weight"].x)
    np.testing.assert_allclose(*found, rtol=1e-12)


@pytest.mark.parametrize(("per", "error"), [(1, 3.5e-3), (2, 1e-3)])
def test_bonded_to_a_half_plane(per, error):
    """[X] A force on a long beam on a half-plane, a^3 = 2 EI (1 - nu^2) / E = 1: M(0) = 2 P a / (3
    sqrt 3).
    """
    g = np.concatenate((np.arange(0, 6, 1 / per), 6 + 54 * np.linspace(0, 1, 5 * per + 1) ** 2.2))
    mesh = MeshTri.init_tensor(np.concatenate((-g[:0:-1], g)), -g[::-1]).with_boundaries(
        {
            "beam": lambda x: (x[1] > -1e-9) & (abs(x[0]) < 20),
            "far": lambda x: (x[1] < -59.9) | (abs(x[0]) > 59.9),
        }
    )
    basis = vector_basis(mesh, "P2", intorder=2)
    beam = sc.Beam(basis, "beam", EI=0.5 / (1 - 0.3**2), EA=1e-9, GA=1e4)
    model = sc.Model(
        {"soil": sc.SolidForm(basis, sc.LinearElastic(E=1.0, nu=0.3)), "beam": beam},
        basis.get_dofs("far").all(),
    )
    load = model.forms["beam"].load((0.0, -1e-3), at=(0.0, 0.0))
    stage = model.run([sc.Stage("force", load)], **QUIET)["force"]
    assert -stage.section_forces("beam").M.min() == pytest.approx(
        2e-3 / (3 * np.sqrt(3)), rel=error
    )


def test_bonded_inside_a_block():
    """[X] A stretched block with a line inside: N = EA eps along it, from its left end."""
    mesh = (
        MeshTri.init_tensor(np.linspace(0, 2, 5), np.linspace(0, 1, 3))
        .with_defaults()
        .with_boundaries(
            {"line": lambda x: (abs(x[1] - 0.5) < 1e-9) & (x[0] < 1.5)}, boundaries_only=False
        )
    )
    basis = vector_basis(mesh, "P2", intorder=2)
    beam = sc.Beam(basis, "line", EI=1.0, EA=50.0)
    fixed = [basis.get_dofs({"left", "right"}).all("u^1"), basis.get_dofs("bottom").all("u^2")]
    model = sc.Model(
        {"block": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.0)), "beam": beam}, fixed
    )
    pulled = np.zeros(basis.N)
    pulled[basis.get_dofs("right").all("u^1")] = 0.02
    ends = model.forms["beam"]
    balance = [ends.load((0.5, 0.0), (1.5, 0.5))]  # the end of the beam pulls the block
    forces = model.run([sc.Stage("pull", balance, prescribed=pulled)], **QUIET)[
        "pull"
    ].section_forces("beam")
    np.testing.assert_allclose(forces.x, [0.0, 0.5, 0.5, 1.0, 1.0, 1.5], atol=1e-12)
    np.testing.assert_allclose(forces.N, 0.5, rtol=1e-9)
    np.testing.assert_allclose(forces.M, 0.0, atol=1e-9)


def test_closed_line_goes_clockwise_from_its_top():
    angle = np.linspace(0, 2 * np.pi, 8, endpoint=False)
    p = np.hstack([r * np.array([np.cos(angle), np.sin(angle)]) for r in (1.0, 2.0)])
    a = np.arange(8)
    b = (a + 1) % 8
    mesh = MeshTri(p, np.hstack(([a, b, a + 8], [b, b + 8, a + 8]))).with_boundaries(
        {"skin": lambda x: np.hypot(*x) < 1.1}
    )
    beam = sc.Beam(vector_basis(mesh, "P2"), "skin", EI=1.0, EA=1.0)
    np.testing.assert_allclose(
        beam.points[beam.cells[:3, 0]],
        [[s, c] for s, c in zip(np.sin(np.pi / 4 * a[:3]), np.cos(np.pi / 4 * a[:3]), strict=True)],
        atol=1e-12,
    )


@pytest.mark.slow
def test_saved_and_resumed(tmp_path):
    """A portal beyond its elastic limit is saved, loaded, and goes on as if nothing had happened;
    and mirrored.
    """
    ends = []
    for sign in (1.0, -1.0):
        points = np.array([[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [2.0, 1.0], [2.0, 0.0]]) * [
            sign,
            1.0,
        ]
        beam = sc.Beam(None, points, EI=100.0, EA=1e5, GA=1e6, Mp=3.0)
        model = sc.Model({"beam": beam}, [*beam.dofs((0.0, 0.0)), *beam.dofs((2 * sign, 0.0))])
        form = model.forms["beam"]
        stages = [
            sc.Stage(
                str(H),
                [form.load((sign * H, 0.0), (0.0, 1.0)), form.load((0.0, -2 * H), (sign, 1.0))],
            )
            for H in (5.5, 5.9, 3.0)
        ]
        whole = model.run(stages, **QUIET)
        if sign > 0:
            Result(whole.stages[:2]).save(tmp_path / "portal")
            again = model.run(stages[2:], start=sc.load_result(tmp_path / "portal", model), **QUIET)
            np.testing.assert_allclose(
                again["3.0"].x, whole["3.0"].x, rtol=1e-8, atol=1e-12
            )  # Newton's tolerance
            moved = again.reset()
            np.testing.assert_allclose(
                moved[-1].section_forces("beam").M, whole["3.0"].section_forces("beam").M
            )
        ends.append(np.abs(whole["3.0"].section_forces("beam").M))
        assert whole["5.9"].states["beam"].free.any() and "M " in str(whole)
    np.testing.assert_allclose(*ends, rtol=1e-6)


BENT = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]
STIFF = {"EI": 1.0, "EA": 1.0}


@pytest.mark.parametrize(
    ("message", "call"),
    [
        ("EI of a beam must be positive, not 0", lambda: sc.Beam(None, BENT, EI=0.0, EA=1.0)),
        ("EA of a beam must be positive, not -1", lambda: sc.Beam(None, BENT, EI=1.0, EA=-1.0)),
        ("Np of a beam needs Mp", lambda: sc.Beam(None, BENT, **STIFF, Np=1.0)),
        ("spacing of a beam must be positive", lambda: sc.Beam(None, BENT, **STIFF, spacing=-2.0)),
        ("must be a name, or at least two points", lambda: sc.Beam(None, [[0.0, 0.0]], **STIFF)),
        ("has no length", lambda: sc.Beam(None, [[0.0, 0.0], [0.0, 0.0], [1.0, 0.0]], **STIFF)),
        (
            "no node at \\(0.3, 0\\); the nearest one is at \\(0.5, 0\\)",
            lambda: sc.Beam(None, BENT, **STIFF).node((0.3, 0.0)),
        ),
        (
            "no elements meet at the hinge at \\(0, 0\\)",
            lambda: sc.Beam(None, BENT, **STIFF, hinges=(0.0, 0.0)),
        ),
        ("belongs to no element", lambda: sc.Beam(None, BENT, **STIFF, cells=[[0, 1]])),
        ("of its 3 nodes", lambda: sc.Beam(None, BENT, **STIFF, cells=[[0, 1], [-1, 1]])),
        ("of its 3 nodes", lambda: sc.Beam(None, BENT, **STIFF, cells=[[0, 1], [1, 3]])),
        ("of its 3 nodes", lambda: sc.Beam(None, BENT, **STIFF, cells=[[0.0, 1.0]])),
        ("of its 3 nodes", lambda: sc.Beam(None, BENT, **STIFF, cells=[[0], [1]])),
        ("not numbered yet", lambda: sc.Beam(None, BENT, **STIFF).load((1.0, 0.0), (0.0, 0.0))),
        (
            "there is no boundary 'wall'",
            lambda: sc.Beam(vector_basis(MeshTri(), "P2"), "wall", **STIFF),
        ),
        (
            "take a basis of second order",
            lambda: sc.Beam(vector_basis(MeshTri().with_defaults(), "P1"), "top", **STIFF),
        ),
        (
            "no single chain: 1 of its 2 facets lie apart; name its pieces apart",
            lambda: sc.Beam(
                vector_basis(
                    MeshTri().with_boundaries({"two": lambda x: abs(x[0] - 0.5) > 0.4}), "P2"
                ),
                "two",
                **STIFF,
            ),
        ),
    ],
)
def test_bad_input(message, call):
    with pytest.raises(ValueError, match=message):
        call()


def test_mechanisms_and_bounds_are_refused():
    """Hinges or supports that leave a motion are named before anything is computed; bounds name the
    beam.
    """
    beam = sc.Beam(None, straight(3.0, 3), EI=1.0, EA=1e6, hinges=[(1.0, 0.0), (2.0, 0.0)])
    model = sc.Model(
        {"beam": beam}, [*beam.dofs((0.0, 0.0)), *beam.dofs((3.0, 0.0), ["u^1", "u^2"])]
    )
    load = model.forms["beam"].load((0.0, -1.0), (1.0, 0.0))
    with pytest.raises(ValueError, match=r"mechanism: .* the largest at \(2, 0\)"):
        model.run([sc.Stage("load", load)], **QUIET)
    basis = vector_basis(MeshTri().refined(1).with_defaults(), "P2", intorder=2)
    forms = {
        "soil": sc.SolidForm(basis, sc.Tresca(E=1e3, nu=0.3, c=1.0)),
        "wall": sc.Beam(basis, "top", **STIFF),
    }
    with pytest.raises(ValueError, match="no bounds with 'wall', a Beam"):
        sc.Model(forms, basis.get_dofs("bottom").all()).bounds()


def test_section_forces_of_the_wrong_kind():
    basis = vector_basis(MeshTri().refined(1).with_defaults(), "P2", intorder=2)
    forms = {
        "soil": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.3)),
        "wall": sc.Beam(basis, "top", **STIFF),
    }
    model = sc.Model(forms, basis.get_dofs("bottom").all())
    stage = model.run([sc.Stage("rest", sc.weight(basis, 1.0))], **QUIET)["rest"]
    cuts = sc.Cuts.line((0.5, 0.0), (0.5, 1.0), depth=1.0)
    for name, sections, message in (
        ("soil", None, "a solid needs `sections`"),
        ("wall", cuts, "'wall' is a Beam"),
    ):
        with pytest.raises(ValueError, match=message):
            stage.section_forces(name, sections)


def beside_soil(law, sign=1.0, **options):
    """A beam 2 high and .2 thick between two blocks of soil on rollers, upwards or downwards: model
    and beam.
    """
    y = np.linspace(0, 2, 9)
    blocks = {
        "low": grid("Q2", np.linspace(-1.1, -0.1, 5), y),
        "high": grid("Q2", np.linspace(0.1, 1.1, 5), y),
    }
    basis = vector_basis(sc.join_bodies(blocks), "Q2", intorder=4)
    beam = sc.Beam(
        basis, np.column_stack((0 * y, y))[:: int(sign)], EI=1e2, EA=1e6, GA=1e4, thickness=0.2
    )
    forms = {
        "soil": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.0)),
        "beam": beam,
        **beam.contact(basis, law, **options),
    }
    fixed = [
        basis.get_dofs({"low:bottom", "high:bottom"}).all("u^2"),
        basis.get_dofs("high:right").all("u^1"),
        *beam.dofs((0.0, 0.0), ["u^2"]),
    ]
    return sc.Model(forms, fixed), beam


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_contact_on_both_sides(sign, tmp_path):
    """[X] A uniform pressure goes through the beam, which does not bend; a force at its head is
    borne by both sides.

    The same whichever way the beam goes; saved and resumed in the middle.
    """
    model, _ = beside_soil(sc.Coulomb(mu=0.2), sign)
    push = model.traction("low:left", (10.0, 0.0))
    result = model.run([sc.Stage("push", push)], **QUIET)
    for pair in ("low:right", "high:left"):
        np.testing.assert_allclose(result["push"].tractions(pair).pressure, 10.0, rtol=1e-6)
    assert np.abs(result["push"].section_forces("beam").M).max() < 1e-6
    result.save(tmp_path / "wall")
    again = sc.load_result(tmp_path / "wall", model)
    head = model.forms["beam"].load((3.0, 0.0), at=(0.0, 2.0))
    bent, resumed = (
        model.run([sc.Stage("head", [push, head])], start=start, **QUIET)["head"]
        for start in (result, again)
    )
    np.testing.assert_array_equal(bent.x, resumed.x)
    left, right = (bent.contact(pair).force[0] for pair in ("low:right", "high:left"))
    assert left + right == pytest.approx(3.0, rel=1e-6)  # on the soil
    M = bent.section_forces("beam").M
    # the ends are free; friction has an arm of half the thickness, and its moment is taken as
    # uniform in each element
    assert abs(M[[0, -1]]).max() < 5e-2 * abs(M).max()
    bent.to_vtu(tmp_path / "wall.vtu")


def test_contact_is_refused_where_it_cannot_be():
    y = np.linspace(0, 2, 5)
    mesh = sc.join_bodies({"low": grid("Q2", y - 2.1, y), "high": grid("Q2", y + 0.1, y)})
    basis = vector_basis(mesh, "Q2", intorder=4)
    points = np.column_stack((0 * y, y))
    thick = sc.Beam(basis, points, **STIFF, thickness=0.2)
    assert set(thick.contact(basis, sc.Coulomb())) == {"low:right", "high:left"}
    assert set(thick.contact(basis, sc.Coulomb(), "high:left")) == {"high:left"}
    with pytest.raises(
        ValueError, match=r"\['low:left'\] lie on neither side of the beam, 0.1 off its axis"
    ):
        thick.contact(basis, sc.Coulomb(), ["low:left", "high:left"])
    with pytest.raises(ValueError, match="no boundary lies on a side of the beam, 0 off its axis"):
        sc.Beam(basis, points, **STIFF).contact(basis, sc.Coulomb())
    with pytest.raises(ValueError, match="bonded=False"):
        sc.Beam(basis, "low:right", **STIFF).contact(basis, sc.Coulomb())
    with pytest.raises(ValueError, match="on its axis: thickness=0"):
        sc.Beam(basis, points, **STIFF, thickness=0.2, hinges=(0.0, 1.0)).contact(
            basis, sc.Coulomb()
        )
    twice = mesh.with_boundaries({"again": lambda x: abs(x[0] - 0.1) < 1e-9})
    with pytest.raises(ValueError, match="share facets"):
        thick.contact(vector_basis(twice, "Q2", intorder=4), sc.Coulomb())


def test_law_of_an_interface_from_a_soil():
    law = sc.Coulomb.from_soil(sc.MohrCoulomb(E=1e4, nu=0.3, c=6.0, phi=30.0), 0.5)
    assert (law.mu, law.adhesion) == pytest.approx((0.5 * np.tan(np.pi / 6), 3.0))
    clay = sc.Coulomb.from_soil(sc.Tresca(E=1e4, nu=0.3, c=6.0), 1.0)
    assert (clay.mu, clay.adhesion) == (0.0, 6.0)
    for soil, ratio in (
        (sc.Tresca(E=1e4, nu=0.3, c=6.0), 0.0),
        (sc.LinearElastic(E=1e4, nu=0.3), 0.5),
        (sc.Tresca(E=1e4, nu=0.3, c=lambda x: 10.0 - x[1]), 0.5),
    ):
        with pytest.raises(ValueError, match="ratio must lie in"):
            sc.Coulomb.from_soil(soil, ratio)


@pytest.mark.parametrize("bonded", [True, False])
def test_built_in_deformed_ground(bonded):
    """[X] A beam that is built while the ground is pressed bears nothing until the pressure rises,
    then its share.
    """
    mesh, slit = crossed(MeshTri, lambda x: abs(x[0] - 0.5) < 1e-9, 4)
    basis = vector_basis(mesh if bonded else slit, "P2", intorder=2)
    beam = sc.Beam(basis, "wall" if bonded else "wall|left", EI=1.0, EA=50.0, bonded=bonded)
    pairs = {} if bonded else beam.contact(basis, sc.Coulomb(mu=10.0))
    soil = sc.SolidForm(basis, sc.LinearElastic(E=100.0, nu=0.0))
    sides = basis.get_dofs({"left", "right"}).all("u^1")
    top = [*beam.dofs((0.5, 0.0), ["u^2"])] if not bonded else []
    model = sc.Model(
        {"soil": soil, "beam": beam, **pairs}, [sides, basis.get_dofs("bottom").all("u^2"), *top]
    )
    press = model.traction("top", (0.0, -1.0))
    stages = [
        sc.Stage("press", press),
        sc.Stage("build", press, activate=["beam", *pairs]),
        sc.Stage("more", 2.0 * press),
    ]
    result = model.run(stages, **QUIET)
    assert np.abs(result["build"].section_forces("beam").N).max() < 1e-9
    np.testing.assert_allclose(
        result["build"].x[: basis.N], result["press"].x[: basis.N], atol=1e-12
    )
    N = result["more"].section_forces("beam").N
    # its foot is held by the ground's; above the load goes over from the ground, which is pressed
    if bonded:
        assert N.min() < -0.05
    else:  # no pressure between beam and ground, no friction
        assert np.abs(N).max() < 1e-9


# -- bars between beams


def test_strut_between_two_walls():
    """[X] Two cantilevers joined by a row of struts at their heads: S = F k / (2 k + EI 3 / h^3), a
    member s S.
    """
    h, EI, EA, width, spacing, force = 4.0, 1e4, 6e4, 6.0, 2.5, 30.0
    y = np.linspace(0.0, h, 5)
    left, right = (
        sc.Beam(None, np.column_stack((0 * y + x, y)), EI=EI, EA=1e7, GA=1e12) for x in (0.0, width)
    )
    strut = sc.Bar(
        None,
        left.at((0.0, h)),
        right.at((width, h)),
        EA * spacing,
        spacing=spacing,
        compression_only=True,
    )
    fixed = [*left.dofs((0.0, 0.0)), *right.dofs((width, 0.0))]
    model = sc.Model({"left": left, "right": right, "strut": strut}, fixed)
    push = model.forms["left"].load((force, 0.0), at=(0.0, h))
    result = model.run([sc.Stage("push", push), sc.Stage("pull", -push)], **QUIET)
    wall, bar = 3.0 * EI / h**3, EA / width
    through = force * bar / (2.0 * bar + wall)
    np.testing.assert_allclose(result["push"].states["strut"].force, -spacing * through, rtol=1e-6)
    head = result["pull"].x[model.forms["left"].numbers((0.0, h))[0]]
    assert head == pytest.approx(-force / wall, rel=1e-6)  # no tension: the left wall stands alone
    assert result["pull"].states["strut"].force[0] == 0.0
    numbered = model.forms["strut"]
    x = 1e-3 * np.random.default_rng(1).standard_normal(model.layout.size)
    sc.testing.check_form(numbered, x, numbered.initial_state())


def test_bar_to_a_beam_of_no_model():
    """A strut at a wall that the model does not hold is named."""
    wall = sc.Beam(None, [(0.0, 0.0), (0.0, 4.0)], EI=1.0, EA=1.0)
    other = sc.Beam(None, [(0.0, 0.0), (0.0, 4.0)], EI=1.0, EA=1.0)
    strut = sc.Bar(None, other.at((0.0, 4.0)), (3.0, 4.0), EA=1.0, fixed_end=True)
    with pytest.raises(
        ValueError, match="'strut' acts on the field 'displacement of a beam', which no form"
    ):
        sc.Model({"wall": wall, "strut": strut}, wall.dofs((0.0, 0.0)))
    with pytest.raises(ValueError, match="no node at"):
        wall.at((0.0, 1.0))
    with pytest.raises(ValueError, match="resists nothing"):
        sc.Bar(
            None,
            wall.at((0.0, 4.0)),
            (3.0, 4.0),
            1.0,
            True,
            tension_only=True,
            compression_only=True,
        )
    with pytest.raises(ValueError, match="needs its basis"):
        sc.Bar(None, wall.at((0.0, 4.0)), (3.0, 4.0), 1.0)


def crossed(kind, line, n=8):
    """A square with a line of facets inside, its tags, and the same with a slit."""
    mesh = (
        kind.init_tensor(np.linspace(0, 1, n + 1), np.linspace(0, 1, n + 1))
        .with_defaults()
        .with_subdomains({"low": lambda x: x[1] < 0.5})
        .with_boundaries({"wall": line}, boundaries_only=False)
    )
    return mesh, sc.split_along(mesh, "wall")


@pytest.mark.parametrize("kind", [MeshTri, MeshQuad])
@pytest.mark.parametrize(
    ("line", "double", "names"),
    [
        (lambda x: (abs(x[0] - 0.5) < 1e-9) & (x[1] > 0.5), 4, ("left", "right")),
        (lambda x: (abs(x[0] - 0.5) < 1e-9) & (x[1] > 0.2) & (x[1] < 0.8), 3, ("left", "right")),
        (lambda x: abs(x[1] - 0.5) < 1e-9, 9, ("below", "above")),
    ],
)
def test_slit(kind, line, double, names):
    """Nodes between and on the surface are double, ends inside single; both sides face each other,
    tags stay.
    """
    mesh, slit = crossed(kind, line)
    assert slit.nvertices == mesh.nvertices + double
    np.testing.assert_array_equal(slit.p[:, slit.t], mesh.p[:, mesh.t])
    low, high = (slit.boundaries[f"wall|{name}"] for name in names)
    axis = int(names[0] == "below")
    for side, sign in ((low, -1), (high, 1)):
        assert (slit.f2t[1, side] < 0).all() and len(side) == len(mesh.boundaries["wall"])
        inner = slit.p[:, slit.t[:, slit.f2t[0, side]]].mean(axis=1)[axis]
        assert (np.sign(inner - 0.5) == sign).all()
    assert set(slit.boundaries) == {*mesh.boundaries, f"wall|{names[0]}", f"wall|{names[1]}"} - {
        "wall"
    }
    np.testing.assert_array_equal(slit.subdomains["low"], mesh.subdomains["low"])
    assert len(slit.boundaries["top"]) == len(mesh.boundaries["top"])


def test_slit_along_an_arch_of_curved_elements():
    """A line that rises and falls keeps its sides; second-order meshes keep their middle nodes."""
    mesh = MeshTri2.from_mesh(MeshTri.init_tensor(np.linspace(0, 1, 9), np.linspace(0, 1, 9)))
    p = mesh.doflocs.copy()
    p[1] += 0.3 * np.sin(np.pi * p[0]) * p[1] * (1 - p[1])
    mesh = MeshTri2(p, mesh.t).with_boundaries(
        {
            "arch": mesh.facets_satisfying(
                lambda x: (abs(x[1] - 0.5) < 1e-9) & (x[0] > 0.1) & (x[0] < 0.9)
            )
        }
    )
    slit = sc.split_along(mesh, "arch")
    elements = [mesh.dofs.element_dofs, slit.dofs.element_dofs]
    np.testing.assert_array_equal(mesh.doflocs[:, elements[0]], slit.doflocs[:, elements[1]])
    below = slit.boundaries["arch|below"]
    middle = slit.p[:, slit.facets[:, below]].mean(axis=1)
    assert (slit.p[:, slit.t[:, slit.f2t[0, below]]].mean(axis=1)[1] < middle[1]).all()


def ring_of_facets(x):
    return np.maximum(abs(x[0] - 0.5), abs(x[1] - 0.5))


@pytest.mark.parametrize(
    ("line", "message"),
    [
        (lambda x: x[1] > 1 - 1e-9, "8 facets lie on its surface"),
        (lambda x: abs(ring_of_facets(x) - 0.25) < 1e-9, "is closed"),
        (
            lambda x: (abs(x[0] - 0.5) < 1e-9) & (abs(x[1] - 0.5) < 0.1) & (x[1] > 0.5),
            "no node to double",
        ),
        (lambda x: (abs(x[0] - 0.5) < 1e-9) & (abs(x[1] - 0.5) > 0.2), "lie apart"),
        (
            lambda x: (abs(x[0] - 0.5) < 1e-9) | ((abs(x[1] - 0.5) < 1e-9) & (x[0] < 0.5)),
            "branches",
        ),
    ],
)
def test_slits_that_cannot_be(line, message):
    with pytest.raises(ValueError, match=message):
        crossed(MeshQuad, line)


def test_sheet_pile_in_a_slit():
    """[X] A sheet pile without thickness in a slit of a block that is pressed from the side: a
    uniform stress passes.

    Its head is pulled then: both sides bear the force, and the tip, where the ground is whole,
    hardly moves.
    """
    _, slit = crossed(MeshTri, lambda x: (abs(x[0] - 0.5) < 1e-9) & (x[1] > 0.4), 10)
    basis = vector_basis(slit, "P2", intorder=2)
    pile = sc.Beam(basis, "wall|left", EI=10.0, EA=1e4, GA=1e5, bonded=False)
    forms = {
        "soil": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.0)),
        "pile": pile,
        **pile.contact(
            basis, sc.Coulomb.from_soil(sc.MohrCoulomb(E=1e4, nu=0.3, c=0.0, phi=30.0), 2 / 3)
        ),
    }
    assert {"wall|left", "wall|right"} < set(forms)
    fixed = [
        basis.get_dofs("bottom").all("u^2"),
        basis.get_dofs("right").all("u^1"),
        *pile.dofs((0.5, 0.4), ["u^2"]),
    ]
    model = sc.Model(forms, fixed)
    push = model.traction("left", (10.0, 0.0))
    head = model.forms["pile"].load((1.0, 0.0), at=(0.5, 1.0))
    result = model.run([sc.Stage("push", push), sc.Stage("head", [push, head])], **QUIET)
    for side in ("wall|left", "wall|right"):
        found = result["push"].tractions(
            side
        )  # contact yields to its penalty, the ground at the tip does not
        np.testing.assert_allclose(found.pressure[found.y > 0.7], 10.0, rtol=5e-3)
    forces = result["head"].section_forces("pile")
    assert abs(forces.V).max() == pytest.approx(abs(forces.V[0]), rel=1e-9)
    left, right = (result["head"].contact(side).force[0] for side in ("wall|left", "wall|right"))
    assert left + right == pytest.approx(1.0, rel=1e-6)


def pit_beside_a_sheet_pile():
    """Ground of 12 m with a sheet pile of 8 m in a slit, 3 m of it above the bottom of a pit to its
    left.
    """
    mesh = (
        MeshTri.init_tensor(np.linspace(-6, 6, 13), np.linspace(-12, 0, 13))
        .with_defaults()
        .with_boundaries({"wall": lambda x: (abs(x[0]) < 1e-9) & (x[1] > -8)}, False)
    )
    mesh = sc.split_along(mesh, "wall").with_subdomains(
        {
            "pit": lambda x: (x[0] < 0) & (x[1] > -3),
            "left": lambda x: (x[0] < 0) & (x[1] < -3),
            "right": lambda x: x[0] > 0,
        }
    )
    face = mesh.boundaries["wall|left"]
    below = mesh.p[1, mesh.facets[:, face]].mean(axis=0) < -3.0
    mesh = mesh.with_boundaries({"front": face[below], "dug": face[~below]}).with_boundaries(
        {
            "floor": lambda x: (abs(x[1] + 3) < 1e-9) & (x[0] < 1e-9),
            "lake": lambda x: (x[1] > -1e-9) & (x[0] > -1e-9),
        },
        False,
    )
    basis = vector_basis(mesh, "P2")
    wall = sc.Beam(basis, "wall|right", EI=6e4, EA=4e6, bonded=False)
    forms = {
        name: sc.SolidForm(
            basis.with_elements(name), sc.LinearElastic(E=4e4, nu=0.3), unit_weight=20.0
        )
        for name in ("left", "right", "pit")
    }
    forms |= {
        "wall": wall,
        **wall.contact(basis, sc.Coulomb(mu=0.3), ["front", "dug", "wall|right"]),
    }
    model = sc.Model(forms, sc.box_supports(basis), water_unit_weight=10.0)
    return (
        model,
        {name: form for name, form in model.forms.items() if name not in ("pit", "dug")},
        basis,
    )


def pumped(basis):
    """The flow below the sheet pile as the pit is pumped dry."""
    wet = basis.with_elements({"left", "right"})
    return sc.water.Flow(wet, 1e-4, unit_weight=10.0).steady(
        sc.water.Conditions(head={"lake": 0.0, "floor": -3.0})
    )


@pytest.mark.parametrize(
    ("level", "largest"), [(0.0, 1e-12), (-3.0, 1e-12), (-1.25, 5e-3)]
)  # a kink in an element
def test_water_levels_on_both_sides_of_a_beam(level, largest):
    """[X] Force and moment about the surface of triangular pressures, free water in the pit
    included.
    """
    model, dug, _ = pit_beside_a_sheet_pile()
    wall = model.forms["wall"]
    load = model.water_on(dug, {"left": level, "right": 0.0})[
        wall._dofs[: 2 * len(wall.points) : 2]
    ]
    left, right = 5.0 * (8.0 + level) ** 2, 5.0 * 8.0**2
    assert load.sum() == pytest.approx(left - right, rel=largest, abs=1e-10)
    moment = left * (8.0 - (8.0 + level) / 3.0) - right * 8.0 * 2.0 / 3.0
    assert load @ -wall.points[:, 1] == pytest.approx(moment, rel=largest, abs=1e-9)


def test_flow_presses_on_both_sides_of_a_beam():
    """[X] The pressures of both faces of the slit, linear between their nodes; no water in the
    pit.
    """
    model, dug, basis = pit_beside_a_sheet_pile()
    mesh, water, wall, net = basis.mesh, pumped(basis), model.forms["wall"], 0.0
    for name, sign in (("wall|right", -1.0), ("front", 1.0)):
        ends = mesh.facets[:, mesh.boundaries[name]]
        (y0, y1), (p0, p1) = mesh.p[1, ends], 10.0 * (water.head[ends] - mesh.p[1, ends])
        net += sign * (0.5 * (p0 + p1) * abs(y1 - y0)).sum()
    load = model.water_on(dug, water)[wall._dofs[: 2 * len(wall.points) : 2]]
    assert load.sum() == pytest.approx(net, rel=1e-12) and net < -100.0


@pytest.mark.parametrize("water", [{"left": -3.0, "right": 0.0}, "flow"], ids=["levels", "flow"])
def test_water_that_differs_on_both_sides_of_a_slit_is_told(water):
    """The net pressure is that of a beam; in a slit without one it would be lost. Equal levels need
    none.
    """
    model, dug, basis = pit_beside_a_sheet_pile()
    solids = {name: form for name, form in dug.items() if name in ("left", "right")}
    water = pumped(basis) if water == "flow" else water
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        model.water_on(dug, water)
        model.water_on(solids, {"left": -1.0, "right": -1.0})
    with pytest.warns(
        sc.AnalysisWarning,
        match=r"presses with .* on one side of the slit at .* no beam lies there",
    ):
        model.water_on(solids, water)


def test_pressures_at_vertices_on_both_sides_of_a_beam():
    """[X] Those of a flow, as the flow itself; beside water in the pit they do not say what presses
    there.
    """
    model, dug, basis = pit_beside_a_sheet_pile()
    water = pumped(basis)
    wall = model.forms["wall"]._dofs
    given, flow = (
        model.water_on(dug, pressure)[wall] for pressure in (np.nan_to_num(water.pressure), water)
    )
    np.testing.assert_allclose(given, flow, atol=1e-9 * abs(flow).max())
    with pytest.raises(ValueError, match=r"above the ground, at .* give water levels or a seepage"):
        model.water_on(dug, np.maximum(-10.0 * basis.mesh.p[1], 0.0))


@pytest.mark.slow
def test_contact_beside_water_carries_effective_stress():
    """[X] A sheet pile is in balance: the ground's forces on it and those of the water."""
    model, _, basis = pit_beside_a_sheet_pile()
    pump = sc.Stage("pump", water=pumped(basis), deactivate=["pit", "dug"])
    stage = model.run([pump], start=model.k0_state(K0=0.5), **QUIET)["pump"]
    wall = model.forms["wall"]
    contact = sum(stage.contact(name).force[0] for name in ("front", "wall|right"))
    pushed = stage.load[wall._dofs[: 2 * len(wall.points) : 2]].sum()
    assert contact == pytest.approx(pushed, rel=1e-6)  # of the iterations


@pytest.mark.parametrize(
    ("n", "error"), [(16, 6e-3), (32, 1.5e-3)]
)  # the curvature of parabolas: second order
def test_buoyancy_of_a_thick_ring(n, error):
    """[X] Water on both sides of a ring of some thickness: the weight of the water in its place."""
    angle = 2.0 * np.pi * np.arange(2 * n) / (2 * n) + 0.3
    ends = np.arange(0, 2 * n, 2)
    ring = sc.Beam(
        None,
        2.0 * np.column_stack((np.cos(angle), np.sin(angle))),
        1.0,
        1.0,
        cells=np.column_stack((ends, (ends + 2) % (2 * n), ends + 1)),
        thickness=0.3,
    )
    points, normals, lengths, _ = ring._elements.sides(0.15)
    force = -((10.0 - 9.81 * points[:, 1]) * lengths) @ normals
    assert force == pytest.approx([0.0, 9.81 * 2.0 * np.pi * 2.0 * 0.3], rel=error, abs=1e-9)


def test_envelope():
    """[X] Extremes of two stages of a cantilever with their names, also in the table; a body of no
    stage is named.
    """
    beam = sc.Beam(None, straight(2.0, 2), EI=100.0, EA=1e4)
    model = sc.Model({"beam": beam}, beam.dofs((0.0, 0.0)))
    form = model.forms["beam"]
    stages = [
        sc.Stage("down", form.load((4.0, -3.0), (2.0, 0.0))),
        sc.Stage("up", form.load((-1.0, 1.0), (2.0, 0.0))),
    ]
    found = model.run(stages, **QUIET).envelope("beam")
    assert pytest.approx([6.0, 3.0, 3.0, 0.0], abs=1e-9) == found.largest.M
    assert pytest.approx([-2.0, -1.0, -1.0, 0.0], abs=1e-9) == found.smallest.M
    assert pytest.approx(4.0) == found.largest.N and pytest.approx(-1.0) == found.smallest.N
    assert (found.stages["M"][:, 0] == ["up", "down"]).all() and (
        found.stages["N"][1] == "down"
    ).all()
    assert [line.split() for line in str(found).splitlines()][4] == ["M", "-2", "at", "0", "up"]
    with pytest.raises(ValueError, match="no form"):
        model.run(stages, **QUIET).envelope("wall")


def shell(line, cells=None, GA=1e4):
    return sc.Beam(
        None, line, EI=2.5, EA=3e4, GA=GA, cells=cells, coordinates="axisymmetric", nu=0.3
    )


def test_points_beside_vertices_are_refused():
    """A share of 1e-8 of the ground is round-off of coordinates, one of 1e-5 is none."""
    mesh = MeshQuad.init_tensor(np.linspace(0.0, 4.0, 5), np.linspace(0.0, 2.0, 3))
    basis = vector_basis(mesh, "Q2")
    beam = sc.Beam(basis, [(0.0, 1.0), (4.0, 1.0 + 4e-8)], EI=1.0, EA=1.0, bonded=True)
    np.testing.assert_allclose(beam.points[:, 1], 1.0)
    with pytest.raises(ValueError, match="0 vertices of the mesh lie at"):
        sc.Beam(basis, [(0.0, 1.0), (4.0, 1.0 + 4e-5)], EI=1.0, EA=1.0, bonded=True)


def test_bent_edge_of_a_cylinder():
    """[X] A tank of radius a clamped at its foot, filled with water (S. Timoshenko, Plates and
    Shells, art. 118).

    GA is large: the closed form has no shear. The tank is high: exp(-8) of the edge is left at its
    top.
    """
    a, h, n, fluid = 8.0, 7.0, 24, 10.0
    wall = shell(np.column_stack((np.full(n + 1, a), np.linspace(0, h, n + 1))), GA=1e9)
    model = sc.Model({"wall": wall}, wall.dofs((a, 0.0)))
    load = model.forms["wall"].line_load(lambda x: np.stack((fluid * (h - x[1]), 0.0 * x[1])))
    forces = model.run([sc.Stage("filled", load)], **QUIET)["filled"].section_forces("wall")
    membrane, z = 3e4 * (1 - 0.3**2), forces.y
    beta = (membrane / (4 * 2.5 * a**2)) ** 0.25
    wave = np.exp(-beta * z) * (h * np.cos(beta * z) + (h - 1 / beta) * np.sin(beta * z))
    moment = (
        fluid
        / (2 * beta**2)
        * np.exp(-beta * z)
        * ((h - 1 / beta) * np.cos(beta * z) - h * np.sin(beta * z))
    )
    assert pytest.approx(moment, abs=1e-3 * moment[0]) == abs(forces.M[0]) / forces.M[0] * forces.M
    assert pytest.approx(fluid * a * (h - z - wave), abs=2e-3 * fluid * a * h) == forces.N_hoop
    assert pytest.approx(0.3 * forces.M, abs=1e-9) == forces.M_hoop


def test_uniform_moment_of_a_ring_plate():
    """[X] Moments at both rims bend a ring into a sphere: the moment around is that along, u = M
    r^2 / 2 D (1 + nu).
    """
    plate = shell(np.column_stack((np.linspace(1, 3, 4), np.zeros(4))))
    model = sc.Model({"plate": plate}, plate.dofs((3.0, 0.0), ["u^2"]))
    form = model.forms["plate"]
    load = form.load((0.0, 0.0), (3.0, 0.0), moment=6.0) + form.load(
        (0.0, 0.0), (1.0, 0.0), moment=-2.0
    )
    stage = model.run([sc.Stage("bent", load)], **QUIET)["bent"]
    forces = stage.section_forces("plate")
    assert np.stack((forces.M, forces.M_hoop)) == pytest.approx(-2.0, rel=1e-9)
    assert stage.x[form.numbers((1.0, 0.0))[1]] == pytest.approx(
        -2.0 * (9 - 1) / 2 / 2.5 / 1.3, rel=1e-9
    )


@pytest.mark.parametrize(
    ("n", "error"), [(16, 8e-3), (32, 2e-3)]
)  # second order: the curvature of parabolas
def test_sphere_under_pressure(n, error):
    """[X] p R / 2 in both directions, held at its rims as in a whole sphere."""
    angle = np.radians(np.linspace(20, 120, 2 * n + 1))
    way = np.column_stack((np.sin(angle), np.cos(angle)))
    ends = np.arange(0, 2 * n, 2)
    sphere = shell(5.0 * way, np.column_stack((ends, ends + 2, ends + 1)))
    model = sc.Model({"sphere": sphere}, sphere.dofs(5.0 * way[-1], ["u^2"]))
    form, N = model.forms["sphere"], 40.0 * 5.0 / 2
    load = form.line_load(lambda x: 40.0 * x / 5.0)
    for end, sign in ((0, -1.0), (-1, 1.0)):
        s, c = way[end]
        load += form.load(sign * N * 5.0 * s * np.array([c, -s]), 5.0 * way[end])
    forces = model.run([sc.Stage("blown", load)], **QUIET)["blown"].section_forces("sphere")
    assert np.stack((forces.N, forces.N_hoop)) == pytest.approx(N, rel=error)


def test_shells_beside_solids_and_bad_shells():
    """[X] A shell bonded to a thick cylinder; a plane beam there, a pole, and nu elsewhere are
    refused.
    """
    mesh = MeshQuad.init_tensor(np.linspace(1, 2, 3), np.linspace(0, 3, 4)).with_defaults()
    basis = vector_basis(mesh, "Q2")
    ground = sc.SolidForm(basis, sc.LinearElastic(E=1.0, nu=0.3), coordinates="axisymmetric")
    lining = sc.Beam(basis, "left", EI=1.0, EA=1e3, coordinates="axisymmetric")
    model = sc.Model(
        {"ground": ground, "lining": lining}, basis.get_dofs({"bottom", "top"}).all("u^2")
    )
    stage = model.run([sc.Stage("press", model.traction("left", (5.0, 0.0)))], **QUIET)["press"]
    ring, bore = 1e3, 1.0 / 1.3 * (4 - 1) / (0.4 + 4)  # pressures over displacements
    assert stage.section_forces("lining").N_hoop == pytest.approx(
        5.0 * ring / (ring + bore), rel=1e-3
    )
    with pytest.raises(ValueError, match="coordinate systems"):
        sc.Model({"ground": ground, "lining": sc.Beam(basis, "left", EI=1.0, EA=1e3)}, ())
    for wrong in (
        {"coordinates": "axisymmetric", "Mp": 1.0},
        {"nu": 0.2},
        {"coordinates": "axisymmetric", "nu": 0.6},
    ):
        with pytest.raises(ValueError, match="shell of revolution"):
            sc.Beam(None, [[1.0, 0.0], [1.0, 1.0]], 1.0, 1.0, **wrong)
    with pytest.raises(ValueError, match="small hole"):
        shell([[0.0, 0.0], [1.0, 0.0]])


def test_beams_in_files(tmp_path):
    """[X] Elements of beams with displacements of the ground and section forces; nothing at the
    points of solids.
    """
    meshio = pytest.importorskip("meshio")
    mesh = MeshTri.init_tensor(np.linspace(0, 4, 5), np.linspace(0, 2, 3)).with_defaults()
    basis = vector_basis(mesh, "P2")
    forms = {
        "soil": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.3)),
        "slab": sc.Beam(basis, "top", EI=50.0, EA=1e4),
        "rod": sc.Beam(None, [[1.0, 2.5], [3.0, 2.5]], EI=1.0, EA=1e2),
    }
    model = sc.Model(forms, [basis.get_dofs("bottom").all(), *forms["rod"].dofs((1.0, 2.5))])
    form = model.forms["slab"]
    loads = [form.load((0.0, -5.0), (2.0, 2.0)), model.forms["rod"].load((3.0, 0.0), (3.0, 2.5))]
    stage = model.run([sc.Stage("load", loads)], **QUIET)["load"]
    stage.to_vtu(tmp_path / "slab.vtu")
    found = meshio.read(tmp_path / "slab.vtu")
    elements = np.concatenate([block.data for block in found.cells if block.type == "line3"])
    slab, rod = elements[:4], elements[4:]
    assert len(rod) == 1
    forces = stage.section_forces("slab")
    assert found.point_data["M"][slab[:, :2].ravel()] == pytest.approx(forces.M)
    assert found.point_data["N"][rod] == pytest.approx(3.0)
    assert found.point_data["displacement"][rod[0], 0] == pytest.approx([0.0, 0.06, 0.03])
    middle = np.flatnonzero(np.isclose(found.points[slab[:, 1], 0], 2.0))[0]
    assert found.point_data["displacement"][slab[middle, 1], 1] == pytest.approx(
        stage.x[form.numbers((2.0, 2.0))[1]]
    )
    assert np.isnan(found.point_data["M"][found.cells[0].data]).all()
    assert not np.isnan(found.point_data["stress"][found.cells[0].data]).any()


def helix(n, turns, radius, pitch):
    """Nodes and elements of n curved elements round the third axis, and the angles of the nodes."""
    angle, ends = np.linspace(0, 2 * np.pi * turns, 2 * n + 1), np.arange(0, 2 * n, 2)
    points = np.column_stack(
        (radius * np.cos(angle), radius * np.sin(angle), pitch * angle / (2 * np.pi))
    )
    return points, np.column_stack((ends, ends + 2, ends + 1)), angle


SECTION = {"EI": 3.0, "GJ": 2.0, "EA": 1e5, "GA": 1e4}


@pytest.mark.parametrize(("n", "error"), [(2, 3e-3), (4, 2e-4), (8, 1.2e-5)])  # fourth order
def test_quarter_circle_bent_out_of_its_plane(n, error):
    """[X] Castigliano: P R^3 (pi / 4 EI + (3 pi / 4 - 2) / GJ) + pi P R / 2 GA; at the support M =
    T = P R.
    """
    points, cells, _ = helix(n, 0.25, 1.5, 0.0)
    beam = sc.Beam(None, points, cells=cells, **SECTION)
    stage, form, forces = solved(beam, beam.dofs(points[0]), [((0.0, 0.0, 2.0), points[-1])])
    exact = 2.0 * (1.5**3 * (np.pi / 4 / 3.0 + (3 * np.pi / 4 - 2) / 2.0) + 1.5 * np.pi / 2 / 1e4)
    assert stage.x[form.numbers(points[-1])[2]] == pytest.approx(exact, rel=error)
    assert pytest.approx(np.tile([0.0, 0.0, 2.0], (2 * n, 1)), abs=1e-8) == forces.V
    assert np.linalg.norm(forces.M[0]) == pytest.approx(
        3.0, rel=20 * error
    )  # the tangent of a parabola at its end
    assert abs(forces.T[0]) == pytest.approx(3.0, rel=20 * error)


@pytest.mark.parametrize("force", [(0.0, 0.0, 1.0), (0.3, -0.5, 0.8)])
def test_helical_cantilever(force):
    """[X] Work of the force from the section forces by statics (Castigliano), two turns in 32
    curved elements.
    """
    (points, cells, angle), P, rise = helix(32, 2.0, 1.0, 0.5), np.array(force), 0.5 / (2 * np.pi)
    beam = sc.Beam(None, points, cells=cells, **SECTION)
    stage, form, _ = solved(beam, beam.dofs(points[0]), [(P, points[-1])])
    s, w = np.polynomial.legendre.leggauss(40)
    t = 0.5 * angle[-1] * (s + 1.0)
    tangent = np.column_stack((-np.sin(t), np.cos(t), np.full(40, rise))) / np.hypot(1.0, rise)
    M = np.cross(points[-1] - np.column_stack((np.cos(t), np.sin(t), rise * t)), P)
    T, N = (tangent * M).sum(axis=1), tangent @ P
    density = ((M**2).sum(axis=1) - T**2) / 3.0 + T**2 / 2.0 + N**2 / 1e5 + (P @ P - N**2) / 1e4
    exact = 0.5 * angle[-1] * np.hypot(1.0, rise) * w @ density
    assert stage.x[form.numbers(points[-1])[:3]] @ P == pytest.approx(exact, rel=1e-4)


def test_straight_cantilever_in_space(tmp_path):
    """[X] Statics of a skew cantilever, its plane bending, its own weight, a bar to it, saved and
    resumed.
    """
    way = np.array([2.0, 1.0, -1.0]) / np.sqrt(6)
    beam = sc.Beam(None, np.array([[0.0] * 3, way, 2 * way]), unit_weight=3.0, **SECTION)
    bar = sc.Bar(None, beam.at(way), way + np.array([0.0, 0.0, 1.0]), EA=1e-6, fixed_end=True)
    model = sc.Model({"beam": beam, "bar": bar}, beam.dofs((0.0, 0.0, 0.0)))
    form, P, turn = model.forms["beam"], np.array([0.2, -1.0, 0.5]), np.array([0.1, 0.2, 0.3])
    result = model.run([sc.Stage("weight"), sc.Stage("load", form.load(P, 2 * way, turn))], **QUIET)
    result.save(tmp_path / "space.npz")
    forces = sc.load_result(tmp_path / "space.npz", model)["load"].section_forces("beam")
    weight = np.array([0.0, 0.0, -3.0])
    whole = P + 2 * weight
    assert forces.N[0] == pytest.approx(whole @ way, rel=1e-5)  # the bar bears a little
    assert forces.M[0] + forces.T[0] * way == pytest.approx(
        np.cross(2 * way, P) + turn + np.cross(2 * way, weight), rel=1e-5
    )
    side = forces.towards((0.0, 0.0, 1.0))
    up = np.array([0.0, 0.0, 1.0]) - way[2] * way
    assert side.V[0] == pytest.approx(whole @ up / np.linalg.norm(up), rel=1e-5)
    assert float(result["load"].summary["beam"].split()[-1]) == pytest.approx(
        np.linalg.norm(forces.M[0]), rel=1e-3
    )
    x = np.random.default_rng(0).standard_normal(model.layout.size)
    sc.testing.check_form(form, x, form.initial_state())


@pytest.mark.parametrize(
    ("message", "options"),
    [
        ("no spacing, Mp", {"Mp": 1.0}),
        ("points of its line", {"hinges": (0.0, 0.0)}),
        ("no spacing, Mp", {"coordinates": "axisymmetric"}),
        ("GJ of a beam", {"GJ": -1.0}),
    ],
)
def test_bad_beams_in_space(message, options):
    with pytest.raises(ValueError, match=message):
        sc.Beam(None, [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]], EI=1.0, EA=1.0, **options)


def test_beams_in_space_are_refused_in_the_plane():
    beam = sc.Beam(None, [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]], EI=1.0, EA=1.0)
    basis = vector_basis(MeshTri().refined(1).with_defaults(), "P2")
    with pytest.raises(ValueError, match="contact of a beam"):
        beam.contact(basis, sc.Coulomb(mu=0.3))
    with pytest.raises(ValueError, match="the beam has 3 coordinates, the ground 2"):
        sc.Embedded(basis, beam, T_max=1.0)
    with pytest.raises(ValueError, match=r"has the dofs u\^1, u\^2, u\^3, theta\^1"):
        beam.dofs((0.0, 0.0, 0.0), ["theta"])
    with pytest.raises(ValueError, match=r"spins about its axis at \(0, 0, 0\)"):
        model = sc.Model(
            {"beam": beam}, beam.dofs((0.0, 0.0, 0.0), ["u^1", "u^2", "u^3", "theta^2", "theta^3"])
        )
        model.run(
            [
                sc.Stage(
                    "twist",
                    model.forms["beam"].load((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 0.0, 0.0)),
                )
            ]
        )


def warm(line, held, strain, curvature=0.0, **settings):
    """Stages in which a beam held at some nodes is heated and cools down again."""
    beam = sc.Beam(None, line, EI=50.0, EA=1e4, GA=1e3, **settings)
    model = sc.Model({"beam": beam}, [dof for node in held for dof in beam.dofs(node)])
    summer = sc.Stage("summer", change={"beam": beam.heated(strain, curvature)})
    stages = [summer, sc.Stage("autumn", change={"beam": beam})]
    return model.forms["beam"], model.run(stages, progress=False)


@pytest.mark.parametrize("spacing", [None, 2.0])
def test_temperature_of_a_beam_that_is_held(spacing):
    """[X] N = -EA strain and M = -EI curvature between fixed ends, and nothing in autumn."""
    for angle in (0.0, 0.7):
        way = np.array([np.cos(angle), np.sin(angle)])
        line = np.linspace(0.0, 3.0, 4)[:, None] * way
        _, result = warm(line, (line[0], line[-1]), 2e-4, 1e-3, spacing=spacing)
        forces = result["summer"].section_forces("beam")
        np.testing.assert_allclose(forces.N, -2.0 / (spacing or 1.0), rtol=1e-9)
        np.testing.assert_allclose(forces.M, -0.05 / (spacing or 1.0), rtol=1e-9)
        assert (
            abs(forces.V).max() < 1e-9
            and abs(result["autumn"].section_forces("beam").N).max() < 1e-12
        )
    beam = sc.Beam(None, line, EI=50.0, EA=1e4, spacing=spacing)
    model = sc.Model({"beam": beam}, [*beam.dofs(line[0]), *beam.dofs(line[-1])])
    summer = sc.Stage("summer", change={"beam": beam.heated(2e-4)})
    assert abs(model.run([summer], progress=False)[-1].section_forces("beam").M).max() < 1e-9
    line = np.linspace((0.0, 0.0, 0.0), (1.0, 2.0, 2.0), 4)
    if spacing is None:
        _, result = warm(line, (line[0], line[-1]), 2e-4)
        np.testing.assert_allclose(result["summer"].section_forces("beam").N, -2.0, rtol=1e-9)


def test_temperature_of_a_beam_that_is_free():
    """[X] A cantilever sags by curvature L^2 / 2, and an arc grows to a similar one, both without
    force.
    """
    line = np.linspace((0.0, 0.0), (3.0, 0.0), 4)
    form, result = warm(line, line[:1], 2e-4, 1e-3)
    end = result["summer"].x[form.numbers((3.0, 0.0))]
    np.testing.assert_allclose(end, [6e-4, -4.5e-3, -3e-3], rtol=1e-9)  # the upper side is longer
    assert abs(result["summer"].section_forces("beam").M).max() < 1e-9
    angle = np.linspace(0.0, 1.5, 9)
    points = 4.0 * np.column_stack((np.cos(angle), np.sin(angle)))
    cells = np.column_stack((np.arange(0, 8, 2), np.arange(2, 9, 2), np.arange(1, 8, 2)))
    form, result = warm(points, points[:1], 1e-3, cells=cells)
    end = result["summer"].x[form.numbers(points[-1])]
    np.testing.assert_allclose(end, [*1e-3 * (points[-1] - points[0]), 0.0], atol=1e-12)


def test_temperature_is_refused():
    """Shells have no free strain, beams in space no free curvature."""
    with pytest.raises(ValueError, match="a shell of revolution has no free strain"):
        sc.Beam(None, [[1.0, 0.0], [1.0, 1.0]], EI=1.0, EA=1.0, coordinates="axisymmetric").heated(
            1e-3
        )
    with pytest.raises(ValueError, match="in space no free curvature"):
        sc.Beam(None, [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]], EI=1.0, EA=1.0).heated(1e-3, 1e-3)


def test_spacing_of_zero_is_refused():
    """Zero is no spacing, in place of one that is not given."""
    with pytest.raises(ValueError, match="spacing"):
        sc.Beam(None, [(0, 0), (1, 0)], EI=1.0, EA=1.0, spacing=0.0)
    with pytest.raises(ValueError, match="spacing"):
        sc.Reinforcement(None, [(0, 0), (1, 0)], EA=1.0, spacing=0.0)


@pytest.mark.parametrize("dim", [2, 3])
def test_stiffness_that_a_varying_thrust_takes_away(dim, rng):
    """[X] Energy -1/2 of the integral of N w'^2 with N linear and w quadratic, across a straight
    element alone.
    """
    start, t = rng.standard_normal(dim), rng.standard_normal(dim)
    length = float(np.linalg.norm(t))
    points = start + np.array([0.0, 1.0, 0.5])[:, None] * t
    elements = BeamElements.of(points[None]) if dim == 2 else SpaceElements.of(points[None])
    N = np.array([3.0, -8.0])
    K = lost_stiffness(elements, N[None])[0][: 3 * dim, : 3 * dim]
    moves = rng.standard_normal((3, dim))
    along = (moves @ t)[:, None] * t / length**2
    moves -= along

    # w through its values at 0, 1 and 1/2 of the length
    shares = [0.0, 1.0, 0.5]
    functions = np.polynomial.polynomial.polyfit(shares, moves, 2).T
    slopes = [np.polynomial.Polynomial(w).deriv() / length for w in functions]
    force = np.polynomial.Polynomial([N[0], N[1] - N[0]])
    work = sum((force * slope**2).integ()(1.0) for slope in slopes)
    assert moves.ravel() @ K @ moves.ravel() == pytest.approx(-length * work, rel=1e-12)
    assert np.abs(K @ along.ravel()).max() < 1e-12 * np.abs(K).max()


def test_slits_that_cross_are_cut_piece_by_piece() -> None:
    """A slit across another one has two pieces, as the message says; with a name each they are
    cut, and the crossing has a node for each of four corners.
    """
    line = np.linspace(0, 1, 9)
    mesh = MeshTri.init_tensor(line, line)
    level = {"level": lambda x: (x[1] == 0.5) & (abs(x[0] - 0.5) < 0.3)}
    upright = {
        "upright": lambda x: (x[0] == 0.5) & (abs(x[1] - 0.5) < 0.3),
        "lower": lambda x: (x[0] == 0.5) & (x[1] > 0.2) & (x[1] < 0.5),
        "upper": lambda x: (x[0] == 0.5) & (x[1] < 0.8) & (x[1] > 0.5),
    }
    slit = sc.split_along(mesh.with_boundaries(level | upright, False), "level")
    with pytest.raises(ValueError, match="name its pieces apart, also where a slit crosses it"):
        sc.split_along(slit, "upright")
    both = sc.split_along(sc.split_along(slit, "lower"), "upper")
    assert (np.abs(both.p - 0.5).max(axis=0) == 0.0).sum() == 4
