"""Penalties, stiffnesses, friction and units from one extreme to the other."""

from __future__ import annotations

import logging
import warnings
from dataclasses import replace

import numpy as np
import pytest

import skfem_contact as sc
from skfem_contact.contact.laws import Status
from skfem_contact.contact.penalty import choose_penalties
from skfem_contact.errors import Failure
from tests.stability.setups import (
    along_and_up,
    blocks,
    displaced,
    force_on,
    guided,
    held,
    in_contact,
    loaded,
    run,
)
from tests.tools.helpers import unknowns_of

QUADRATURES = ["nodal", 2, "segments"]
RATIOS = [1e-3, 1e-1, 1.0, 1e2, 1e4, 1e6]


def column(quadrature, ratio: float, dim: int = 2, **options):
    """Two columns of one width, guided at their sides and pressed together by 0.01; penalty and
    force.
    """
    basis = blocks(overhang=0.0, dim=dim)
    forms = in_contact(
        basis, sc.Coulomb(), quadrature, nu=0.0, penalty=ratio * 1e3 / 0.2, **options
    )
    fixed = guided(basis, "lower:bottom", "upper:top")
    target = displaced(basis, "upper:top", (0.0, -0.01))
    with warnings.catch_warnings():
        warnings.simplefilter(
            "ignore", sc.AnalysisWarning
        )  # soft penalties are warned of, which is tested elsewhere
        stage = run(forms, [sc.Stage("press", basis.zeros(), target)], fixed)["press"]
    return forms, stage


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("ratio", RATIOS)
def test_columns_and_penalty_in_series(ratio, dim):
    """[X] Cases A1, S1: the force is that of three springs in series, for penalties of 1e-3 to 1e6
    times E/h.
    """
    forms, stage = column("segments", ratio, dim)
    exact = 0.01 / (1 / 1e3 + 1 / 1e3 + 1 / (ratio * 1e3 / 0.2))
    # what is left of digits: the gap, 1e-16 of lengths of order one, over the penetration, 5 over
    # the penalty
    assert force_on(forms, stage)[-1] == pytest.approx(exact, rel=1e-9 + 1e-15 * ratio * 1e3)
    assert len(stage.iterations) == 1 and stage.iterations[0] <= 5


@pytest.mark.parametrize(
    ("dim", "quadrature"), [*((2, rule) for rule in QUADRATURES), (3, "nodal"), (3, 2)]
)
@pytest.mark.one_in(3)
def test_augmented_result_does_not_depend_on_the_penalty(dim, quadrature):
    """[X] From any start the force comes within the method's tolerance of the exact one, 5."""
    for ratio in RATIOS:
        forms, stage = column(quadrature, ratio, dim, enforcement=sc.AugmentedLagrangian())
        # nodes of one column against facets of another carry a uniform pressure to some per cent
        # only
        assert force_on(forms, stage)[-1] == pytest.approx(
            5.0, rel=1e-3 if quadrature == "segments" else 0.02
        )


def test_stick_that_cycles(caplog):
    """[X] Case S1 with friction: where Newton jumps over the stick, it begins softly; the answer is
    exact.
    """
    forces = []
    for ratio in (1e3, 1e4, 1e6):
        basis = blocks()
        forms = in_contact(basis, quadrature="segments", penalty=ratio * 1e3 / 0.2)
        fixed = basis.get_dofs({"lower:bottom", "upper:top"}).all()
        stage = sc.Stage("press", basis.zeros(), displaced(basis, "upper:top", (0.0, -0.01)))
        with caplog.at_level(logging.INFO, logger="skfem_contact"):
            result = run(forms, [stage], fixed, newton=sc.Newton())["press"]
        joint = result.states["joint"]
        assert (joint.penalty_factor == 1.0).all()  # the whole penalty in the end
        assert (np.abs(joint.traction[1]) <= 0.3 * np.abs(joint.traction[0]) * (1 + 1e-8)).all()
        forces.append(force_on(forms, result)[1])
    assert "chatter between stick and slip: a soft stick begins with" in caplog.text
    # the penalty gives way like a layer of 0.2 / ratio beside columns of 2; friction's memory
    # changes less
    np.testing.assert_allclose(forces, forces[-1], rtol=0.1 / 1e3 * 3)


@pytest.mark.parametrize(("dim", "quadrature"), [*((2, rule) for rule in QUADRATURES), (3, 2)])
@pytest.mark.parametrize("ratio", [1e-3, 1e-1, 1.0, 1e2, 1e4, 1e6])
@pytest.mark.one_in(3)
def test_tangential_penalty(ratio, dim, quadrature):
    """[X] Case S2: from 1e-3 to 1e6 times the normal one, the block slides at T = mu N; no
    increment is cut.
    """
    basis = blocks(dim=dim)
    forms = in_contact(basis, quadrature=quadrature)
    normal = choose_penalties(forms)["joint"].penalty[0]
    forms["joint"] = forms["joint"].with_penalty(normal, ratio * normal)
    fixed = basis.get_dofs({"lower:bottom", "upper:top"}).all()
    # a stick of 1e-3 times the penalty gives way by mu p / eps_T, about 0.3: that far it must be
    # dragged
    path = [(0.0, -0.005), (0.02, -0.005), (0.05 if ratio > 1e-2 else 0.4, -0.005)]
    stages = [
        sc.Stage(str(k), basis.zeros(), displaced(basis, "upper:top", at))
        for k, at in enumerate(path)
    ]
    result = run(forms, stages, fixed, newton=sc.Newton(max_iterations=40))
    assert [len(stage.iterations) for stage in result] == [1, 1, 1]
    stage = result[-1]
    x, y = along_and_up(forms, stage)
    joint = stage.states["joint"]
    assert -x / y == pytest.approx(0.3, rel=0.01)  # the surface is bent a little
    assert (joint.status[joint.status != Status.OPEN] == Status.SLIP).all()
    assert (joint.penalty_factor == 1.0).all()  # with the whole penalty


def test_soft_stick_repeats_the_tractions(rng):
    """[X] Case S2: a soft stick whose shifted slips stand for some tractions has those where they
    are in equilibrium.

    At the hard stick's displacements the forces are equal; from there on the stick gives way a
    hundred times as much.
    """
    basis = blocks()
    pair = choose_penalties(in_contact(basis, quadrature=2))["joint"]
    pair = pair.with_penalty(pair.penalty[0], 1e3 * pair.stiffness, pair.stiffness)
    x = 1e-5 * rng.standard_normal(basis.N)
    x[unknowns_of(basis, "upper")] -= [0.0, 1e-2]
    accepted = pair.assemble(0.5 * x, pair.initial_state()).state
    hard = pair.assemble(x, accepted)
    assert {Status.STICK, Status.SLIP} <= set(hard.state.status)
    opposite = replace(hard.state, traction=hard.state.traction * [[1], [-1]])
    easier = pair.begin(accepted, Failure(loose=False, seen=(hard.state, opposite)))
    assert easier.softness == pytest.approx(1e-2)  # 10 times the stiffness of the surfaces
    assert pair.penalties(easier.effective(accepted))[1] == pytest.approx(10 * pair.stiffness)
    elastic = pair.interface.elastic_slip(hard.state)
    easier = easier.with_(slip_shift=elastic / easier.softness - elastic)
    answer = easier.assemble(x, accepted)
    # the elastic slip is kept along the undeformed master: strains of 1e-4 are left
    np.testing.assert_allclose(answer.force, hard.force, atol=1e-4 * np.abs(hard.force).max())
    assert np.array_equal(answer.state.status, hard.state.status)
    # the next, harder stick: repeating tractions are taken over at once with the whole penalty
    last, same = easier.outer(x, accepted, answer.state)
    assert not last.families and same is accepted
    np.testing.assert_array_equal(last.assemble(x, accepted).force, hard.force)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("quadrature", QUADRATURES)
@pytest.mark.parametrize("E", [(1e3, 1e9), (1e9, 1e3)], ids=["hard on soft", "soft on hard"])
def test_stiffness_contrast(E, quadrature, dim):
    """[X] A million times stiffer is rigid: the soft body carries the load, the hard one moves as a
    whole.
    """
    basis = blocks(dim=dim)
    forms = in_contact(basis, quadrature=quadrature, E=E)
    load = loaded(basis, "upper:top", (0.0, -5.0))
    stage = run(forms, [sc.Stage("press", load)], held(basis, "lower:bottom"))["press"]
    np.testing.assert_allclose(along_and_up(forms, stage), [0, 5], atol=1e-8)
    y = stage.x[basis.get_dofs("upper:bottom").all(f"u^{dim}")]
    if E[1] > E[0]:
        assert np.ptp(y) < 1e-4 * np.abs(y).max()
    else:  # nothing but the penalty yields under the soft block
        bottom = stage.x[basis.get_dofs("lower:top").all(f"u^{dim}")]
        assert np.abs(bottom).max() < 1e-7


@pytest.mark.parametrize("quadrature", QUADRATURES)
@pytest.mark.parametrize("mu", [0.0, 1e-12, 0.05, 0.3, 1.0, 2.0])
@pytest.mark.one_in(3)
def test_friction(mu, quadrature):
    """[X] Cases S23: dragged by 0.2, T = mu N where the block slides, and never more."""
    basis = blocks(n_lower=7)
    forms = in_contact(basis, sc.Coulomb(mu), quadrature)
    fixed = basis.get_dofs({"lower:bottom", "upper:top"}).all()
    path = [(0.0, -0.01), (0.1, -0.01), (0.2, -0.01)]
    stages = [
        sc.Stage(str(k), basis.zeros(), displaced(basis, "upper:top", at))
        for k, at in enumerate(path)
    ]
    with warnings.catch_warnings():
        warnings.simplefilter(
            "ignore", sc.AnalysisWarning
        )  # an edge that digs in penetrates by some per cent
        stage = run(forms, stages, fixed, newton=sc.Newton(max_iterations=40))[-1]
    x, y = force_on(forms, stage)
    joint = stage.states["joint"]
    assert (np.abs(joint.traction[1]) <= mu * np.abs(joint.traction[0]) * (1 + 1e-8) + 1e-12).all()
    assert y > 0
    if mu <= 0.3:
        # the force on bent facets has a part along the base, a thousandth of N
        assert -x / y == pytest.approx(mu, abs=0.01)
    else:
        assert 0 < -x / y <= mu * 1.02


def test_limits_of_friction():
    """[X] Case S23: mu = 1e-12 is no friction; mu = 1e6 is a bond, as long as everything is
    pressed.
    """
    results = {}
    for law in (sc.Coulomb(), sc.Coulomb(1e-12), sc.Coulomb(1e6), sc.Tied()):
        basis = blocks(n_lower=7)
        forms = in_contact(basis, law, 2)
        fixed = basis.get_dofs({"lower:bottom", "upper:top"}).all()
        target = displaced(basis, "upper:top", (0.001, -0.02))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", sc.AnalysisWarning)
            results[law] = run(forms, [sc.Stage("press", basis.zeros(), target)], fixed)["press"]
    none, tiny, huge, tied = (stage.x for stage in results.values())
    np.testing.assert_allclose(tiny, none, atol=1e-10)
    np.testing.assert_allclose(huge, tied, atol=1e-10)
    assert np.abs(none - tied).max() > 1e-4


@pytest.mark.parametrize(
    ("dim", "stress", "length"), [(2, 1.0, 1e3), (2, 1e6, 1.0), (2, 1e6, 1e3), (3, 1e6, 1e3)]
)
@pytest.mark.one_in(3)
def test_units_of_a_body_that_contact_alone_holds(dim, stress, length):
    """[X] Case S3: the start-up with springs too has no absolute measure; 1e-8 in other units."""
    results = []
    for s, m in ((1.0, 1.0), (stress, length)):
        basis = blocks(gap=0.3, mapped=lambda mesh, m=m: mesh.scaled(m), dim=dim)
        forms = in_contact(basis, quadrature=2, E=(s * 1e3, s * 1e3))
        load = loaded(basis, "upper:top", (0.3 * s, -5.0 * s))
        stage = run(forms, [sc.Stage("press", load)], basis.get_dofs("lower:bottom").all())["press"]
        results.append(
            (stage.x / m, stage.states["joint"].traction[0] / s, stage.states["joint"].status)
        )
    np.testing.assert_allclose(
        results[1][0], results[0][0], atol=1e-8 * np.abs(results[0][0]).max()
    )
    np.testing.assert_allclose(
        results[1][1], results[0][1], atol=1e-8 * np.abs(results[0][1]).max()
    )
    assert np.array_equal(results[1][2], results[0][2])
