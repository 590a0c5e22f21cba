"""Long ways, fast reversals, overlaps, large and tiny steps; facets that a point cannot settle
between.
"""

from __future__ import annotations

import warnings
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

import skfem_contact as sc
from skfem_contact.contact.laws import Status
from skfem_contact.contact.penalty import choose_penalties
from skfem_contact.contact.search import project
from skfem_contact.layout import Layout
from skfem_contact.nonlinear.increment import check
from skfem_contact.nonlinear.step import Equilibrium, Step
from skfem_contact.nonlinear.system import System
from tests.stability.setups import (
    along_and_up,
    blocks,
    displaced,
    force_on,
    guided,
    in_contact,
    run,
)
from tests.tools.helpers import (
    arcs,
    body_along,
    facing,
    grid,
    moved_rigidly,
    traction,
    unknowns_of,
    vector_basis,
)

QUADRATURES = ["nodal", 2, "segments"]


def along(basis, path):
    """Stages that lead the upper block's top along positions."""
    return [
        sc.Stage(f"{k}", basis.zeros(), displaced(basis, "upper:top", at))
        for k, at in enumerate(path)
    ]


def quiet(forms, stages, fixed, **options):
    """An analysis whose edges may dig in by some per cent of a segment, and lose touch."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", sc.AnalysisWarning)
        return run(forms, stages, fixed, **options)


def waved(mesh, height, number):
    """The mesh on a wave."""
    return replace(
        mesh,
        doflocs=mesh.doflocs + np.stack((0 * mesh.doflocs[0], height * np.sin(number * mesh.p[0]))),
    )


def dissipation(forms, result):
    """Work of the friction on the way of the stick points, of every point in every step, (n_steps -
    1, n).
    """
    states = [stage.states["joint"] for stage in result]
    way = np.diff([arcs(forms["joint"], state.stick) for state in states], axis=0)
    way = np.where(np.isnan(way), 0.0, way)
    return way * np.array([state.traction[1] for state in states[1:]])


@pytest.mark.parametrize(
    ("dim", "quadrature"), [*((2, rule) for rule in QUADRATURES), (3, "nodal"), (3, 2)]
)
@pytest.mark.one_in(3)
def test_off_the_edge_and_back(dim, quadrature):
    """[X] Cases S13, D6: slid off the end of the base and back: nothing holds it there, and it is
    held again.
    """
    basis = blocks(n_lower={2: 6, 3: 3}[dim], overhang=0.25, dim=dim)
    forms = in_contact(basis, sc.Coulomb(0.2), quadrature)
    fixed = basis.get_dofs({"lower:bottom", "upper:top"}).all()
    way = np.concatenate((np.linspace(0, 1.5, 11), np.linspace(1.5, 0, 11)[1:]))
    result = quiet(forms, along(basis, [(u, -0.003) for u in way]), fixed)
    forces = np.array([along_and_up(forms, stage) for stage in result])
    beyond = way > 1.25 + 0.05
    assert not forces[beyond].any()
    assert (forces[~beyond, 1] >= 0).all()
    # back at the start it is pressed as before, and has been drawn the other way
    assert forces[-1, 1] == pytest.approx(forces[0, 1], rel=0.03)
    assert forces[-1, 0] == pytest.approx(0.2 * forces[-1, 1], rel=0.05)
    # less is carried the less is supported
    leaving = forces[:11, 1]
    assert (np.diff(leaving[way[:11] > 0.3]) <= 1e-9).all()


@pytest.mark.parametrize(
    ("dim", "quadrature"), [*((2, rule) for rule in QUADRATURES), (3, "nodal"), (3, 2)]
)
@pytest.mark.one_in(3)
def test_fast_reversal(dim, quadrature):
    """[X] To and fro over more than an element in each step: mu N against each way, and no energy
    gained.
    """
    basis = blocks(n_lower={2: 7, 3: 3}[dim], dim=dim)
    forms = in_contact(basis, sc.Coulomb(0.3), quadrature)
    fixed = basis.get_dofs({"lower:bottom", "upper:top"}).all()
    result = quiet(
        forms, along(basis, [(0.0, -0.005), *[((-1) ** k * 0.25, -0.005) for k in range(6)]]), fixed
    )
    for k, stage in enumerate(list(result)[1:]):
        x, y = along_and_up(forms, stage)
        assert x * (-1) ** k < 0  # against the motion
        assert abs(x) == pytest.approx(0.3 * y, rel=0.02)
    if quadrature != "segments" and dim == 2:  # whose points are others in every step
        assert dissipation(forms, result).min() >= -1e-12


@pytest.mark.slow
def test_random_walk():
    """[X] Case S14: 1,000 random steps of one contact: never outside the cone, never a gain of
    energy.
    """
    rng = np.random.default_rng(5)
    floor = np.stack((np.linspace(-3, 3, 13), np.zeros(13)), axis=1)
    roof = np.array([[0.4, 0.0], [-0.4, 0.0]])
    basis = facing(body_along(roof), body_along(floor))
    pair = sc.ContactPair(
        basis, "slave:face", "master:face", sc.Coulomb(0.4), 2, penalty=(1e4, 3e3)
    )
    dofs, state, place = unknowns_of(basis, "slave"), pair.initial_state(), 0.0
    stored = []
    for _ in range(1000):
        place = np.clip(place + 0.05 * rng.standard_normal(), -2, 2)
        x = basis.zeros()
        x[dofs] = [place, -1e-3 * rng.uniform(-0.2, 2.0)]
        new = pair.assemble(x, state).state
        closed = new.status != Status.OPEN
        assert (np.abs(new.traction[1]) <= 0.4 * np.abs(new.traction[0]) * (1 + 1e-12)).all()
        gained = -new.traction[1] * (arcs(pair, new.stick) - arcs(pair, state.stick))
        assert gained[closed].max(initial=0.0) <= 1e-14
        stored.append(0.5 * (new.traction[1] ** 2).max() / 3e3)
        state = new
    assert max(stored) <= 0.5 * (0.4 * 1e4 * 2e-3) ** 2 / 3e3 * (
        1 + 1e-9
    )  # the elastic slip is bounded by the cone


def test_stress_free_carousel():
    """[X] Case S19: everything turned by 90 degrees in 90 steps: forces as before, and slip remains
    zero.
    """
    rng = np.random.default_rng(7)
    floor = np.stack((np.linspace(-1, 1, 6), np.zeros(6)), axis=1)
    basis = facing(body_along(floor[1:-1][::-1] + np.array([0.03, -1e-3])), body_along(floor))
    pair = sc.ContactPair(basis, "slave:face", "master:face", sc.Coulomb(0.3), 2, penalty=1e4)
    x0 = 1e-4 * rng.standard_normal(basis.N)
    first = pair.assemble(x0, pair.initial_state())
    state = first.state
    for degrees in range(1, 91):
        out = pair.assemble(moved_rigidly(basis, degrees, (0.02 * degrees, 0.0), x0), state)
        state = out.state
    np.testing.assert_allclose(state.traction[0], first.state.traction[0], atol=1e-9)
    np.testing.assert_allclose(state.traction[1], first.state.traction[1], atol=1e-9)
    turned = np.stack((-first.force[1::2], first.force[0::2]), axis=1).ravel()
    np.testing.assert_allclose(out.force, turned, atol=1e-9)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("share", [1e-3, 0.1, 0.5, 0.6])
@pytest.mark.parametrize("quadrature", QUADRATURES)
@pytest.mark.one_in(3)
def test_overlap(share, quadrature, dim):
    """[X] Case S11: two guided columns that overlap by up to 60 % of an element; sudden and ramped
    are the same.
    """
    forces = []
    for initial in ("as meshed", "ramped"):
        basis = blocks(overhang=0.0, gap=-share * 0.2, dim=dim)
        forms = in_contact(basis, sc.Coulomb(), quadrature, nu=0.0, penalty=1e5, initial=initial)
        fixed = guided(basis, "lower:bottom", "upper:top")
        stage = quiet(forms, [sc.Stage("fit", basis.zeros())], fixed)["fit"]
        forces.append(force_on(forms, stage)[-1])
    # an interference in series with two columns of modulus 1e3 and height 1, and the penalty
    exact = share * 0.2 / (2 / 1e3 + 1 / 1e5)
    rel = 1e-6 if quadrature == "segments" else 0.02  # the pressure of the others is not uniform
    assert forces[0] == pytest.approx(exact, rel=rel)
    assert forces[1] == pytest.approx(forces[0], rel=1e-8)


@pytest.mark.slow
@pytest.mark.parametrize("law", [sc.Coulomb(), sc.Coulomb(0.3)], ids=repr)
def test_one_step_or_many(law):
    """[X] Case S9: without friction the result of one step is that of 500 to 1e-6; with friction to
    1 %.
    """
    results = []
    for increments in (1, 500):
        basis = blocks(4, 3)
        forms = in_contact(basis, law, 2)
        fixed = basis.get_dofs({"lower:bottom", "upper:top"}).all()
        stage = sc.Stage(
            "press", basis.zeros(), displaced(basis, "upper:top", (0.0, -0.01)), increments
        )
        results.append(quiet(forms, [stage], fixed, newton=sc.Newton(tolerance=1e-9))["press"])
    one, many = results
    assert len(many.iterations) == 500 and sum(many.iterations) <= 510  # extrapolated
    rel = 1e-6 if law.mu == 0 else 1e-2
    np.testing.assert_allclose(one.x, many.x, atol=rel * np.abs(many.x).max())
    np.testing.assert_allclose(
        one.states["joint"].traction[0], many.states["joint"].traction[0], rtol=max(rel, 1e-6)
    )


@pytest.mark.parametrize("quadrature", QUADRATURES)
def test_deep_overlap_on_the_way(quadrature):
    """[X] A parabola pressed by two and a half elements in one step: Newton's iterations do not
    chatter.

    On their way the bodies overlap by as much; such tractions, several times the modulus, would
    turn the facets in the exact tangent.  With it alone three to five increments were needed.
    """
    n = 80
    arch = grid("Q1", np.linspace(-1, 1, n + 1), np.linspace(0, 1, 11))
    arch = arch.morphed(lambda p: p[0], lambda p: p[1] + (1.0 - p[1]) * 0.125 * p[0] ** 2)
    block = grid("Q1", np.linspace(-1, 1, n * 4 // 5 + 1), np.linspace(-1, 0, 11))
    basis = vector_basis(sc.join_bodies({"lower": block, "upper": arch}), "Q1", intorder=2)
    forms = in_contact(basis, sc.Coulomb(), quadrature)
    fixed = basis.get_dofs({"lower:bottom", "upper:top"}).all()
    stage = sc.Stage("press", basis.zeros(), displaced(basis, "upper:top", (0.0, -0.06)))
    result = quiet(forms, [stage], fixed, newton=sc.Newton())["press"]
    assert len(result.iterations) == 1 and result.iterations[0] <= 20  # measured 12 to 16


@pytest.mark.slow
@pytest.mark.parametrize("quadrature", QUADRATURES)
def test_mirrored_start_up(quadrature):
    """[X] Case S17: stabilisation prefers no side: the mirrored block lands as the mirror image."""
    results = []
    for sign in (1, -1):
        # no node of the slave at a joint of the master, where left and right are a matter of
        # definition
        basis = blocks(
            gap=0.3, n_lower=5, overhang=0.33, mapped=lambda m, s=sign: _mirrored(m) if s < 0 else m
        )
        forms = in_contact(basis, quadrature=quadrature)
        load = traction(basis, "upper:top", (0.4 * sign, -5.0))
        stage = run(forms, [sc.Stage("press", load)], basis.get_dofs("lower:bottom").all())["press"]
        places = basis.doflocs[:, ::2] * [[sign], [1]]
        order = np.lexsort(places.round(9))
        results.append(
            (stage.x.reshape(-1, 2)[order] * [sign, 1], force_on(forms, stage) * [sign, 1])
        )
    np.testing.assert_allclose(results[1][0], results[0][0], atol=1e-9)
    np.testing.assert_allclose(results[1][1], results[0][1], atol=1e-9)


def _mirrored(mesh):
    t = mesh.t[[1, 0, 3, 2]]
    return type(mesh)(mesh.p * [[-1], [1]], t).with_defaults()


def kinked():
    """A roof of 140 degrees, a groove of 140 degrees, and a point on each side of their middle."""
    angle = np.tan(np.radians(20))
    roof = sc.rigid.polyline([(-1.0, -angle), (0.0, 0.0), (1.0, -angle)])
    groove = sc.rigid.polyline([(-1.0, angle), (0.0, 0.0), (1.0, angle)])
    return roof, groove


@pytest.mark.parametrize("shape", [0, 1], ids=["roof", "groove"])
def test_locked_point_keeps_its_facet(shape):
    """[X] Locked, a point within a quarter of a facet from the joint stays on the one it had; else
    on the nearest.
    """
    surface = kinked()[shape]
    points = np.array([[0.05, -0.03], [-0.05, -0.03], [0.6, -0.3], [-0.6, -0.3]])
    depth = np.full(4, np.inf)
    free = project(surface, surface.nodes, points, depth, np.array([0, 1, 0, 1]), np.zeros(4, bool))
    held = project(surface, surface.nodes, points, depth, np.array([0, 1, 0, 1]), np.ones(4, bool))
    if shape == 0:
        assert free.facet.tolist() == [1, 0, 1, 0]
        assert held.facet[:2].tolist() == [0, 1]  # the other one is nearer
    assert np.array_equal(held.facet[2:], free.facet[2:])  # too far away to be held
    assert not held.vertex[:2].any()
    gone = project(surface, surface.nodes, points, depth, np.full(4, -1), np.ones(4, bool))
    assert not gone.found.any()  # a point that had no counterpart gets none


class Harder(sc.ContactPair):
    """A pair that stands for a regularised one."""

    reason = "the penalty was another one"


def test_equilibria_of_regularised_forms_alone_are_refused():
    """[X] An equilibrium of a regularised pair that is none of the pair as given is no answer; the
    reason is named.
    """
    groove = kinked()[1]
    line = np.array([[0.03, 0.02], [-0.03, 0.02]])
    basis = facing(body_along(line), body_along(line - [0.0, 3.0]))
    body = sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.3))
    harder, given = (
        {
            "body": body,
            "joint": kind(basis, "slave:face", groove, sc.Coulomb(0.3), "nodal", penalty),
        }
        for kind, penalty in ((Harder, 2e4), (sc.ContactPair, 1e4))
    )
    x = basis.zeros()
    x[unknowns_of(basis, "slave")] = (0.0, -0.05)
    accepted = {name: form.initial_state() for name, form in given.items()}
    answers = {name: form.assemble(x, accepted[name]) for name, form in harder.items()}
    found = Equilibrium(x, {name: answer.state for name, answer in answers.items()}, (1.0, 0.0))
    load = sum(answer.force for answer in answers.values())
    system = System(given, Layout.of(basis.doflocs, ()), np.zeros(0, int), None)
    step = Step(system, np.zeros_like(x), accepted, load, np.zeros(0))
    check(system, step, found, sc.Newton())  # nothing is easier than given
    with pytest.raises(
        sc.NotConverged, match=r"does not last, .*joint: the penalty was another one"
    ):
        check(system, replace(step, system=system.with_forms(harder)), found, sc.Newton())


@pytest.mark.slow
def test_point_that_changes_its_facet():
    """[X] A wave of quadratic facets slid over another: increments in which points change between
    facets.
    """
    meshes = {
        "lower": grid("P2", np.linspace(0, 1, 10), np.linspace(-1, 0, 4)),
        "upper": grid("P2", np.linspace(0, 1, 3), np.linspace(0, 1, 4)),
    }
    basis = vector_basis(
        sc.join_bodies({name: waved(mesh, 0.08, 6) for name, mesh in meshes.items()}), "P2"
    )
    forms = in_contact(basis, sc.Coulomb(0.2), 2, E=(1e3, 1e4))
    fixed = basis.get_dofs({"lower:bottom", "upper:top"}).all()
    path = [(0.0, -0.005), (0.2, -0.01), (-0.2, -0.01)]
    # with more iterations the active set ends its changes by itself
    result = quiet(forms, along(basis, path), fixed, newton=sc.Newton(max_iterations=5))
    assert result[-1].fraction == 1.0 and result[-1].residual <= 1e-8
    forms, free = choose_penalties(forms), np.setdiff1d(np.arange(basis.N), fixed)
    for stage in result:
        joint = stage.states["joint"]
        forces = [form.assemble(stage.x, stage.states[name]).force for name, form in forms.items()]
        assert np.linalg.norm(np.sum(forces, axis=0)[free]) <= 1e-7 * np.linalg.norm(forces[0])
        assert (np.abs(joint.traction[1]) <= 0.2 * np.abs(joint.traction[0]) * (1 + 1e-8)).all()
        np.testing.assert_allclose(
            force_on(forms, stage), -force_on(forms, stage, "lower"), atol=1e-9
        )


def test_dissipation_over_facets():
    """[X] Case S14 with bodies: a block drawn over a wave dissipates at every point and in every
    step.
    """
    basis = blocks(n_lower=9, mapped=lambda mesh: waved(mesh, 0.02, 4))
    forms = in_contact(basis, sc.Coulomb(0.3), 2)
    fixed = basis.get_dofs({"lower:bottom", "upper:top"}).all()
    way = 0.2 * np.sin(np.linspace(0, 2 * np.pi, 17))
    result = quiet(forms, along(basis, [(u, -0.01) for u in way]), fixed, newton=sc.Newton())
    assert dissipation(forms, result).min() >= -1e-12
    for before, after in pairwise(result):
        assert after.residual <= 1e-8 and before.fraction == 1.0
