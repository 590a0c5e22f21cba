"""Bodies that contact alone holds, gaps to close, contact that opens completely and closes
again.
"""

from __future__ import annotations

import logging
import warnings

import numpy as np
import pytest

import skfem_contact as sc
from skfem_contact.contact.laws import Status
from skfem_contact.contact.penalty import choose_penalties
from tests.stability.setups import (
    along_and_up,
    blocks,
    displaced,
    force_on,
    held,
    in_contact,
    loaded,
    run,
    vector,
)
from tests.tools.helpers import body_along, grid, traction, unknowns_of, vector_basis

H = 0.2  # size of the upper block's elements


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("gap", [1e-6, 0.5, 10.0])
@pytest.mark.parametrize("quadrature", ["nodal", 2, "segments"])
@pytest.mark.one_in(3)
def test_block_held_by_contact_alone(gap, quadrature, dim, caplog):
    """[X] Case S10: a gap of up to ten elements closes; the block then stands as one that touched
    from the start.
    """
    results = []
    for initial in (gap * H, 0.0):
        basis = blocks(gap=initial, dim=dim)
        forms = in_contact(basis, quadrature=quadrature)
        load = loaded(basis, "upper:top", (0.0, -5.0))
        caplog.clear()
        with caplog.at_level(logging.INFO, logger="skfem_contact"):
            stage = run(forms, [sc.Stage("press", load)], held(basis, "lower:bottom"))["press"]
        assert ("stabilisation by soft springs" in caplog.text) == (initial > 0)
        np.testing.assert_allclose(force_on(forms, stage), vector(basis, [0, 5]), atol=1e-9)
        results.append((basis, stage))
    (_, far), (basis, near) = results
    dofs = unknowns_of(basis, "upper")
    # nodes of the slave lie at joints of the master; to which side of one a node falls depends on
    # the way there
    np.testing.assert_allclose(far.x[dofs] + vector(basis, [0, gap * H]), near.x[dofs], atol=2e-5)
    if quadrature != "segments":  # whose cuts may differ
        np.testing.assert_allclose(
            far.states["joint"].traction[0], near.states["joint"].traction[0], rtol=5e-3
        )


@pytest.mark.parametrize("mu", [0.0, 0.3])
@pytest.mark.parametrize("gap", [0.05, 2.0])
def test_no_trace_of_the_springs(gap, mu):
    """[X] Cases A1, S10: a column without supports falls on a stop: R = F and u = F/eps + g, to
    1e-9.
    """
    modulus, F, eps = 1000.0, 100.0, 1e5
    basis = vector_basis(grid("Q1", np.linspace(0, 1, 4), np.linspace(0, 1, 5)), "Q1", intorder=2)
    forms = {
        "column": sc.SolidForm(basis, sc.LinearElastic(E=modulus, nu=0.0)),
        "stop": sc.ContactPair(
            basis,
            "bottom",
            sc.rigid.line((-1, -gap), (2, -gap)),
            sc.Coulomb(mu),
            "nodal",
            penalty=eps,
        ),
    }
    guided = basis.get_dofs({"left", "right"}).all("u^1")
    result = run(forms, [sc.Stage("load", traction(basis, "top", (0.0, -F)))], guided)["load"]
    np.testing.assert_allclose(-result.states["stop"].traction[0], F, rtol=1e-9)
    np.testing.assert_allclose(
        -result.x[basis.get_dofs("bottom").all("u^2")], gap + F / eps, rtol=1e-9
    )
    np.testing.assert_allclose(
        -result.x[basis.get_dofs("top").all("u^2")], gap + F / eps + F / modulus, rtol=1e-9
    )


def test_ring_falls_into_a_groove():
    """[X] Statics: two faces at 45 degrees carry W / sqrt 2 each; nothing else holds the ring."""
    n = 40
    angle = -2 * np.pi / n * (np.arange(n) + 0.5)
    ring = body_along(np.stack((np.cos(angle), np.sin(angle)), axis=1), "Q1", 0.2, closed=True)
    basis = vector_basis(ring, "Q1", intorder=2)
    groove = sc.rigid.polyline([(-4.0, 4.0), (0.0, 0.0), (4.0, 4.0)], name="groove").nodes
    groove = groove - [0.0, np.sqrt(2) + 0.05]
    forms = {
        "ring": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.2)),
        "skin": sc.ContactPair(basis, "face", sc.rigid.polyline(groove), sc.Coulomb(0.1), 2),
    }
    weight = sc.weight(basis, 1.0)
    result = run(forms, [sc.Stage("weight", weight)], np.zeros(0, int))["weight"]
    joint = result.tractions("skin")
    for side in (-1, 1):
        at = np.sign(joint.x) == side
        normal, along = (
            (joint.weight * joint.pressure)[at].sum(),
            (joint.weight * joint.shear)[at].sum(),
        )
        # the force on either side leans against the normal by friction, at most 0.1 of it
        assert abs(along) <= 0.1 * normal * (1 + 1e-9)
        assert normal / np.sqrt(2) == pytest.approx(-weight.sum() / 2, rel=0.11)
    total = (
        -choose_penalties(forms)["skin"]
        .assemble(result.x, result.states["skin"])
        .force.reshape(-1, 2)
        .sum(0)
    )
    np.testing.assert_allclose(total, [0.0, -weight.sum()], atol=1e-8 * abs(weight.sum()))


@pytest.mark.parametrize(
    ("gap", "law", "pull"),
    [
        (0.0, sc.Coulomb(), (0.0, -5.0)),
        (0.0, sc.Coulomb(0.3), (0.0, 5.0)),
        (0.3, sc.Coulomb(0.3), (0.0, 5.0)),
        (0.0, sc.Coulomb(0.3), (2.0, -5.0)),
        (0.3, sc.Coulomb(0.3), (2.0, -5.0)),
    ],
    ids=[
        "nothing holds it sideways",
        "pulled off",
        "pulled away",
        "pushed off",
        "pushed beyond friction",
    ],
)
@pytest.mark.filterwarnings("ignore:.*no slave point found")
@pytest.mark.one_in(3)
def test_what_contact_cannot_hold(gap, law, pull):
    """[X] No equilibrium is a clear error, not a result that springs have made up."""
    cannot_hold(gap, law, pull, 2)


@pytest.mark.parametrize(
    "pull", [(0.0, -5.0), (0.0, 5.0)], ids=["nothing holds it sideways", "pulled off"]
)
def test_what_contact_cannot_hold_in_space(pull):
    """[X] The same in space."""
    cannot_hold(0.0, sc.Coulomb(), pull, 3)


def cannot_hold(gap, law, pull, dim):
    """An analysis that fails, and says so."""
    basis = blocks(gap=gap, dim=dim)
    forms = in_contact(basis, law)
    load = loaded(basis, "upper:top", pull)
    with pytest.raises(sc.NotConverged, match=r"singular|collapse|no equilibrium") as error:
        # no more iterations than any that succeeds needs: the increment is cut ten times
        run(
            forms,
            [sc.Stage("press", load)],
            basis.get_dofs("lower:bottom").all(),
            newton=sc.Newton(max_iterations=8),
        )
    assert error.value.result["press"].fraction < 1.0


@pytest.mark.parametrize("quadrature", ["nodal", 2, "segments"])
@pytest.mark.parametrize("elements", [0.3, 10.0])
def test_gap_closed_by_displacement(quadrature, elements):
    """[X] Stress-free descent is equilibrium as soon as its forces are round-off; then the block is
    pressed.
    """
    forces = []
    for gap in (elements * H, 0.0):
        basis = blocks(gap=gap)
        forms = in_contact(basis, quadrature=quadrature)
        fixed = basis.get_dofs({"lower:bottom", "upper:top"}).all()
        stages = [
            sc.Stage("almost", basis.zeros(), displaced(basis, "upper:top", (0.0, -0.999 * gap))),
            sc.Stage("press", basis.zeros(), displaced(basis, "upper:top", (0.0, -gap - 0.01))),
        ]
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", sc.AnalysisWarning)  # almost is not quite
            result = run(forms, stages, fixed)
        if gap > 0:
            assert np.abs(result["almost"].states["blocks"].stress).max() < 1e-9
            # a second one removes forces that round-off of the linear solver leaves, more than
            # those of the assembly
            assert result["almost"].iterations in ((1,), (2,))
        forces.append(force_on(forms, result["press"])[1])
    assert forces[0] == pytest.approx(forces[1], rel=1e-3)  # sides of joints, as above


def test_bodies_do_not_fly_through_each_other():
    """[X] A displacement of two elements beyond the surface is cut until contact is felt; never
    open below it.
    """
    basis = blocks(gap=0.3)
    forms = in_contact(basis)
    fixed = basis.get_dofs({"lower:bottom", "upper:top"}).all()
    side = traction(
        basis, "lower:left", (1e-3, 0.0)
    )  # a force that the empty increment would be in balance with
    target = displaced(basis, "upper:top", (0.0, -0.9))
    with pytest.warns(sc.AnalysisWarning, match="penetrates by"):
        result = run(forms, [sc.Stage("press", side, target)], fixed)["press"]
    assert len(result.iterations) > 1
    assert (result.states["joint"].status != Status.OPEN).all()
    # two columns of unequal width and the penalty in series yield by 0.6; E = 1000
    assert 150 < force_on(forms, result)[1] < 600


@pytest.mark.parametrize(("dim", "n"), [(2, 6), (3, 16)])
def test_slave_that_is_deep_in_the_master_is_warned_of(dim, n):
    """[X] An overlap of three elements at the start is no contact, and no secret."""
    basis = blocks(gap=-0.6, n_lower={2: 4, 3: 4}[dim], dim=dim)
    forms = in_contact(basis)
    fixed = basis.get_dofs({"lower:bottom", "upper:top"}).all()
    with pytest.warns(
        sc.AnalysisWarning, match=rf"{n} of {n} points of 'upper:bottom' lie deeper .* up to 0.6"
    ):
        result = run(forms, [sc.Stage("rest", loaded(basis, "upper:left", (1.0, 0.0)))], fixed)[
            "rest"
        ]
    assert (result.states["joint"].status == Status.OPEN).all()


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("gap", [0.02, 7.0])
def test_contact_that_is_empty_is_warned_of(gap, dim):
    """[X] Case S16: a pair that nothing touches says how far it is, and where."""
    basis = blocks(gap=gap, dim=dim)
    forms = in_contact(basis)
    fixed = basis.get_dofs({"lower:bottom", "upper:top"}).all()
    message = (
        rf"no slave point found a master within reach: gap is {gap:g} between 'upper:bottom' .*, "
        r"smallest at \(\d"
    )
    with pytest.warns(sc.AnalysisWarning, match=message):
        run(forms, [sc.Stage("pull", loaded(basis, "upper:left", (1e-3, 0.0)))], fixed)


def test_contact_with_nothing_opposite_is_warned_of():
    """[X] A slave beside its master, which a projection cannot reach."""
    basis = blocks(mapped=lambda mesh: mesh if mesh.p[0].min() < 0 else mesh.translated((9.0, 0.0)))
    forms = in_contact(basis)
    fixed = basis.get_dofs({"lower:bottom", "upper:top"}).all()
    with pytest.warns(
        sc.AnalysisWarning,
        match="found a master within reach: nothing of 'lower:top' lies opposite",
    ):
        run(forms, [sc.Stage("pull", traction(basis, "upper:left", (1.0, 0.0)))], fixed)


def test_a_body_that_falls_beside_its_support_is_explained():
    """[X] Case S16: where an analysis fails, what contact did not find is part of the warning."""
    basis = blocks(mapped=lambda mesh: mesh if mesh.p[0].min() < 0 else mesh.translated((9.0, 0.0)))
    fixed = np.append(basis.get_dofs("lower:bottom").all(), basis.get_dofs("upper:top").all("u^1"))
    message = (
        "stage 'fall', joint: no slave point found a master within reach: "
        "nothing of 'lower:top' lies opposite"
    )
    with (
        pytest.warns(sc.AnalysisWarning, match=message),
        pytest.raises(sc.NotConverged, match="singular"),
    ):
        run(in_contact(basis), [sc.Stage("fall", traction(basis, "upper:top", (0.0, -1.0)))], fixed)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("quadrature", ["nodal", 2, "segments"])
def test_opens_completely_and_closes_again(quadrature, dim):
    """[X] Case S15: lifted off and set down at another place: no force between, and no memory of
    friction.
    """
    basis = blocks(n_lower={2: 7, 3: 3}[dim], dim=dim)
    forms = in_contact(basis, quadrature=quadrature)
    fixed = basis.get_dofs({"lower:bottom", "upper:top"}).all()
    path = [(0.0, -0.01), (0.1, -0.01), (0.1, 0.02), (0.02, 0.02), (0.02, -0.01)]
    stages = [
        sc.Stage(str(k), basis.zeros(), displaced(basis, "upper:top", at))
        for k, at in enumerate(path)
    ]
    with pytest.warns(sc.AnalysisWarning, match="no slave point found a master"):
        result = run(forms, stages, fixed)
    forces = np.array([along_and_up(forms, stage) for stage in result])
    assert forces[1, 0] == pytest.approx(
        -0.3 * forces[1, 1], rel=1e-2
    )  # slides; the surface is bent a little
    for k in (2, 3):
        assert not forces[k].any() and np.abs(result[k].states["blocks"].stress).max() < 1e-9
    # set down without sliding: as at the beginning, but for the place
    assert abs(forces[4, 0]) < 0.01 * forces[4, 1]
    assert forces[4, 1] == pytest.approx(forces[0, 1], rel=2e-2)
    assert (result[4].states["joint"].status == Status.STICK).mean() >= 0.4


def test_pressure_that_comes_and_goes():
    """[X] Case S15: under loads from zero to full each maximum is like the first, and friction
    within its cone.
    """
    basis = blocks()
    forms = in_contact(basis, quadrature=2)
    top = traction(basis, "upper:top", (0.0, -5.0))
    fixed = np.union1d(basis.get_dofs("lower:bottom").all(), basis.get_dofs("upper:top").all("u^1"))
    loads = {"full": top, "none": 0.0 * top}
    stages = [sc.Stage(f"{name} {k}", load) for k in range(3) for name, load in loads.items()]
    result = run(forms, stages, fixed)
    first = result["full 0"].states["joint"]
    for stage in result:
        joint = stage.states["joint"]
        assert (
            np.abs(joint.traction[1]) <= 0.3 * np.abs(joint.traction[0]) * (1 + 1e-9) + 1e-9
        ).all()
        if stage.name.startswith("full"):
            # friction shakes down in a cycle
            np.testing.assert_allclose(joint.traction[0], first.traction[0], rtol=5e-3)
        else:
            assert np.abs(force_on(forms, stage)).max() < 1e-8
