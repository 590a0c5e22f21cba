"""The contact benchmarks of the examples at their smallest sizes, and what
makes them work.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import one_program
import peers
import pytest
from contact_problems import ELEMENTS, LOWER, MU, NU, UPPER, Contact, E, hertz, patch, patch_errors

import skfem_contact as sc
from skfem_contact.contact.interface import ContactState
from skfem_contact.contact.penalty import choose_penalties
from skfem_contact.results import Result
from tests.tools.helpers import body_along, facing, unknowns_of

AUGMENTED = sc.AugmentedLagrangian()


def pressed(n: int, quadrature: str | int, **options) -> tuple[Contact, Result]:
    """The Hertz contact in four steps."""
    problem = hertz(n)
    result = problem.run(
        problem.pair(0.0, quadrature, **options), [problem.stage("press", increments=4)]
    )
    return Contact.of(problem, result[-1].x), result


def nodal_gaps(pair: sc.ContactPair, state: ContactState) -> np.ndarray:
    """Mean gaps at the slave's nodes, weighted by the shape functions."""
    points = pair.points(state)
    share, n = points.values * points.weight[:, None], len(pair.slave.nodes)
    gaps = (share * (state.gap - state.clearance)[:, None]).ravel()
    return np.bincount(points.nodes.ravel(), gaps, n) / np.bincount(
        points.nodes.ravel(), share.ravel(), n
    )


# -- patch test


@pytest.mark.parametrize("slave", [UPPER, LOWER])
@pytest.mark.parametrize("stuck", [False, True])
@pytest.mark.parametrize("element", ELEMENTS)
def test_segments_pass_the_patch_test_on_a_level_interface(
    element: str, stuck: bool, slave: str
) -> None:
    """[X] A9: uniform stress; what is left is round-off."""
    problem = patch(3, element, stuck=stuck)
    result = problem.run(
        problem.pair(1.0 if stuck else 0.0, "segments", slave), [problem.stage("press")]
    )
    assert max(patch_errors(problem, result[-1].x)) < 1e-12


@pytest.mark.parametrize("slave", [UPPER, LOWER])
@pytest.mark.parametrize("stuck", [False, True])
@pytest.mark.parametrize("element", ["Q1", "P2"])
def test_segments_pass_the_patch_test_on_a_slope(element: str, stuck: bool, slave: str) -> None:
    """[X] A9, inclined: a penetration would shift the faces past each other, the augmented method
    leaves none.
    """
    problem = patch(3, element, slope=0.3, stuck=stuck)
    pair = problem.pair(
        1.0 if stuck else 0.0, "segments", slave, enforcement=sc.AugmentedLagrangian(1e-10)
    )
    result = problem.run(
        pair, [problem.stage("press", normal=10.0)], newton=sc.Newton(tolerance=1e-10)
    )
    assert (
        max(patch_errors(problem, result[-1].x)) < 1e-9
    )  # a few times the augmented method's tolerance


@pytest.mark.parametrize("element", ["Q1", "P1"])
def test_node_to_segment_fails_it(element: str) -> None:
    """[N] The documented failure of the one-pass method."""
    problem = patch(5, element)
    result = problem.run(problem.pair(0.0, "nodal"), [problem.stage("press")])
    assert 0.04 < patch_errors(problem, result[-1].x)[0] < 0.13


@pytest.mark.parametrize("slave", [UPPER, LOWER])
@pytest.mark.parametrize("element", ELEMENTS)
def test_gauss_points_nearly_pass_it(element: str, slave: str) -> None:
    """[N] The error of four Gauss points between the kinks of the master's shape functions."""
    problem = patch(5, element)
    result = problem.run(problem.pair(0.0, 4, slave), [problem.stage("press")])
    assert max(patch_errors(problem, result[-1].x)) < 0.01


def test_a_uniform_stress_has_no_errors() -> None:
    """[X] The measures themselves, on the exact displacements."""
    problem = patch(3, "Q2")
    x, y = problem.basis.doflocs[:, ::2]
    exact = np.stack((NU * (1 + NU) * x, -(1 - NU**2) * y), axis=1).ravel() / E
    assert max(patch_errors(problem, exact)) < 1e-12  # round-off
    assert (
        np.abs(
            problem.solid.assemble(exact, problem.solid.initial_state()).state.stress[1] + 1
        ).max()
        < 1e-12
    )


# -- Hertz


def test_the_exact_pressure_has_no_error() -> None:
    """[X] The measure of the Hertz contact, on Hertz' pressure for a force of 8.9."""
    x = np.linspace(-2, 2, 4001)
    width = np.full(len(x), x[1] - x[0])
    exact = Contact(x, width, np.ones(len(x)) * 8.9 / 4.001, 0 * x)
    contact = Contact(x, width, exact.exact_pressure(x), 0 * x)
    assert contact.half_width == pytest.approx(1.0153, abs=1e-3)
    assert contact.pressure_error < 1e-3  # of the trapezoidal rule at the edge
    assert abs(contact.peak_error) < 1e-3


@pytest.mark.parametrize(
    ("quadrature", "options", "error", "iterations"),
    [
        ("nodal", {}, 0.045, 20),
        (4, {}, 0.03, 30),
        ("segments", {}, 0.03, 30),
        ("segments", {"enforcement": AUGMENTED}, 0.015, 60),
    ],
)
def test_hertz(quadrature: str | int, options: dict, error: float, iterations: int) -> None:
    """[X] B1: errors as documented in the example, with five elements in the half-width."""
    contact, result = pressed(5, quadrature, **options)
    assert contact.pressure_error < error
    assert abs(contact.peak_error) < 0.02
    assert sum(result[-1].iterations) <= iterations


def test_versions_of_other_programs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """[X] CalculiX says its version, packages of Python have one."""
    program = tmp_path / "ccx"
    program.write_text("#!/bin/sh\necho; echo This is Version 2.20\n")
    program.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path), prepend=":")
    monkeypatch.setitem(one_program.PACKAGES, "NumPy", "numpy")
    assert (one_program.version_of("CalculiX"), one_program.version_of("NumPy")) == (
        "2.20",
        np.__version__,
    )


def test_problem_is_the_peers() -> None:
    """[N] Layout and slave nodes of the meshes on which other programs were measured."""
    problem = hertz(20)
    assert problem.basis.N == 19678
    assert len(problem.face.nodes) == 127


# -- augmented Lagrangian


@pytest.mark.slow
@pytest.mark.parametrize("quadrature", ["nodal", 4, "segments"])
def test_the_start_penalty_does_not_matter(quadrature: str | int) -> None:
    """[N] Penalties of 0.01 and 10,000 E/h: the same answer, with nearly the same effort."""
    runs = [
        pressed(4, quadrature, penalty=factor * E * 4, enforcement=AUGMENTED)
        for factor in (1e-2, 1.0, 1e4)
    ]
    forces = [contact.normal_force for contact, _ in runs]
    peaks = [contact.pressure.max() for contact, _ in runs]
    assert (
        np.ptp(forces) < 1e-6 * forces[0]
    )  # multipliers from different starts, to the tolerance of Newton
    assert np.ptp(peaks) < 1e-6 * peaks[0]
    counts = [sum(result[-1].iterations) for _, result in runs]
    assert max(counts) <= 1.5 * min(counts)


def test_nothing_penetrates() -> None:
    """[X] The mean gap at every node that presses, times the stiffness, is below the tolerance."""
    problem = hertz(5)
    pair = problem.pair(0.0, 4, enforcement=AUGMENTED)
    result = problem.run(pair, [problem.stage("press", increments=4)])
    state = result[-1].states["contact"]
    stiffness = choose_penalties({"bodies": problem.solid, "contact": pair})["contact"].stiffness
    presses = state.multiplier[0] < 0.1 * state.multiplier[0].min()
    # the multipliers are one correction behind the tractions
    assert (
        np.abs(nodal_gaps(pair, state)[presses]).max() * stiffness
        < 3e-4 * np.abs(state.traction[0]).max()
    )


def test_ties_are_closed_in_tension() -> None:
    """[X] The augmented method takes over tension where the law bears it."""
    line = np.stack((np.linspace(0, 2, 5), np.zeros(5)), axis=1)
    roof = np.stack((np.linspace(2, 0, 4), np.zeros(4)), axis=1)
    basis = facing(body_along(roof, "Q1"), body_along(line, "Q1"), "Q1")
    top, floor = (unknowns_of(basis, body) for body in ("slave", "master"))
    top = top[basis.doflocs[1, top[:, 1]] > 0.9]
    floor = floor[basis.doflocs[1, floor[:, 1]] < -0.9]
    x = basis.zeros()
    x[top[:, 1]] = 0.01
    bodies = sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.3))
    tie = sc.ContactPair(basis, "slave:face", "master:face", sc.Tied(), 4, enforcement=AUGMENTED)
    fixed = np.concatenate((top.ravel(), floor.ravel()))
    result = sc.Model({"bodies": bodies, "tie": tie}, fixed).run(
        [sc.Stage("pull", basis.zeros(), x)], progress=False
    )
    state = result[-1].states["tie"]
    assert state.traction[0].min() > 0.0
    stiffness = choose_penalties({"bodies": bodies, "tie": tie})["tie"].stiffness
    assert np.abs(nodal_gaps(tie, state)).max() * stiffness < 3e-4 * state.traction[0].max()


@dataclass(frozen=True)
class _Factors:
    """State of the factors of the penalties alone."""

    penalty_factor: np.ndarray | None = None


def test_a_start_out_of_proportion_is_brought_in() -> None:
    """[X] Between a tenth and ten times the stiffness, each direction for itself."""

    def factors(*penalty: float) -> np.ndarray:
        pair = SimpleNamespace(penalty=penalty, stiffness=1.0)
        return AUGMENTED.start(pair, _Factors()).penalty_factor

    assert factors(1e-3, 1e6) * (1e-3, 1e6) == pytest.approx([0.1, 10.0])
    assert factors(5.0, 0.5) == pytest.approx([1.0, 1.0])


# -- Cattaneo and Mindlin


@pytest.fixture(scope="module")
def reversed_shift() -> tuple[sc.ContactPair, list[Contact], Result]:
    """Pressed, shifted and shifted back past zero."""
    problem = hertz(10)
    pair = problem.pair(MU, 4)
    stages = [
        problem.stage("press", increments=4),
        problem.stage("shift", tangential=1.0, increments=10),
    ]
    stages += [
        problem.stage(f"back to {to}", tangential=to, increments=4) for to in (0.6, 0.2, -0.2)
    ]
    result = problem.run(pair, stages)
    return pair, [Contact.of(problem, step.x) for step in result], result


@pytest.mark.slow
def test_cattaneo_mindlin(reversed_shift) -> None:
    """[X] C1: the shear force within half a percent, traction and stick zone as the elements
    resolve them.
    """
    _, contacts, result = reversed_shift
    contact = contacts[1]
    assert contact.shear_force / (MU * contact.normal_force) == pytest.approx(0.581, rel=0.005)
    assert contact.shear_error(MU) < 0.03
    assert abs(contact.stick_error(MU)) < 0.08  # an element of 0.1 over a width of 1.3
    assert sum(result["shift"].iterations) <= 60


def test_reversal(reversed_shift) -> None:
    """[X] C2: slip comes back from the edge, the middle keeps what it was sheared to."""
    _, contacts, _ = reversed_shift
    for contact in contacts[2:]:
        exact = contact.exact_reversed_shear(contact.x, MU, contacts[1].shear_force)
        distance = np.sqrt((contact.shear - exact) ** 2 @ contact.width)
        assert distance < 0.05 * MU * np.sqrt(contact.pressure**2 @ contact.width)
    assert (
        contacts[-1].shear.min() < 0 < contacts[-1].shear.max()
    )  # in balance, not in absence of tractions


def test_friction_is_never_exceeded(reversed_shift) -> None:
    """[X] At any point, on any part of the way."""
    for step in reversed_shift[2]:
        state = step.states["contact"]
        assert (
            np.abs(state.traction[1])
            <= -MU * state.traction[0] + 1e-9 * np.abs(state.traction[0]).max()
        ).all()


# -- CalculiX


def test_faces_of_the_bricks_lie_on_the_boundary() -> None:
    """[X] Each face of the deck, a side of a quadrilateral, is a facet of the boundary."""
    mesh = hertz(2).basis.mesh
    quads = peers._counterclockwise(mesh.p, mesh.t)
    for boundary in (LOWER, UPPER):
        facets = {
            tuple(sorted(pair)) for pair in mesh.facets[:, mesh.boundaries[boundary]].T.tolist()
        }
        faces = [line.split(",S") for line in peers._faces(mesh, quads, boundary)]
        sides = [quads[[int(s) - 3, (int(s) - 2) % 4], int(e) - 1] for e, s in faces]
        assert {tuple(sorted(side.tolist())) for side in sides} == facets


@pytest.mark.skipif(not peers.available(), reason="no ccx on the path")
def test_calculix_agrees() -> None:
    """[N] The peer's runner: both press with the same force."""
    problem = hertz(2)
    stages = [problem.stage("press", increments=4)]
    run = peers.calculix(problem, stages, mu=0.0)
    own = Contact.of(problem, problem.run(problem.pair(0.0, "segments"), stages)[-1].x)
    assert run.x is not None
    assert Contact.of(problem, run.x).normal_force == pytest.approx(
        own.normal_force, rel=0.03
    )  # other penalty
