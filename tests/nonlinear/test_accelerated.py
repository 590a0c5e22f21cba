"""Accelerated iterations: exactness for linear equations, soil in space that does not dilate."""

from __future__ import annotations

import logging

import numpy as np
import pytest
from skfem import Basis, ElementHex1, ElementVector, MeshHex

import skfem_contact as sc
from skfem_contact.nonlinear import step as step_module
from skfem_contact.nonlinear.accelerated import Accelerated, Anderson
from skfem_contact.nonlinear.newton import Evaluation
from skfem_contact.solvers.direct import SingularSystem


class LinearProblem:
    """Equations K z = b whose Newton step fails and whose preconditioner is the diagonal."""

    def __init__(self, K: np.ndarray, b: np.ndarray) -> None:
        self.K = K
        self.b = b

    def evaluate(self, z):
        residual = self.b - self.K @ z
        return Evaluation(z, {}, residual, float(np.linalg.norm(residual)))

    def direction(self, now, damped):
        raise SingularSystem("no step", np.array([0]))

    def preconditioner(self, now):
        return lambda b, rtol: b / np.diag(self.K)


def linear_problem(n: int) -> LinearProblem:
    generator = np.random.default_rng(3)
    K = np.diag(np.linspace(1.0, 3.0, n)) + 0.3 * generator.standard_normal((n, n))
    return LinearProblem(K, generator.standard_normal(n))


def test_as_many_differences_as_equations_solve_linear_ones() -> None:
    """[X] With n independent differences the combined step ends in the solution of n equations."""
    n = 6
    problem = linear_problem(n)
    anderson = Anderson()
    last = problem.evaluate(np.zeros(n))
    for k in range(n):
        new = problem.evaluate(np.eye(n)[k] + last.z)
        anderson.record(last, new)
        last = new
    step, reduced = anderson.combine(last.residual)
    exact = np.linalg.solve(problem.K, problem.b)
    # the share of 1e-12 that the normal equations leave out, times their condition
    np.testing.assert_allclose(last.z + step, exact, atol=1e-7)
    np.testing.assert_allclose(reduced, 0.0, atol=1e-7)


def test_iterations_reach_the_solution_without_a_tangent() -> None:
    """[X] Linear equations are solved in a few iterations more than they are, and all are noted."""
    problem = linear_problem(8)
    noted: list[float] = []
    solver = Accelerated(problem, problem.preconditioner, 1e-8, lambda new: noted.append(new.norm))
    last = solver.solve(problem.evaluate(np.zeros(8)))
    assert last.norm <= 1e-8
    assert len(noted) <= 16
    assert min(noted) == last.norm


def test_iterations_without_progress_return_the_best_evaluation() -> None:
    """[X] A preconditioner without effect leaves the residual; the first evaluation is returned."""
    problem = linear_problem(5)
    problem.preconditioner = lambda now: lambda b, rtol: np.zeros_like(b)
    noted: list[float] = []
    first = problem.evaluate(np.zeros(5))
    last = Accelerated(
        problem, problem.preconditioner, 1e-8, lambda new: noted.append(new.norm)
    ).solve(first)
    assert last is first
    assert 0 < len(noted) <= 200


def test_singular_preconditioner_ends_the_iterations() -> None:
    """A preconditioner that is singular is no error: the evaluation so far is returned."""
    problem = linear_problem(5)
    problem.preconditioner = lambda now: problem.direction(now, False)
    first = problem.evaluate(np.zeros(5))
    assert (
        Accelerated(problem, problem.preconditioner, 1e-8, lambda new: None).solve(first) is first
    )


def footing(n: int = 10) -> tuple[sc.results.StageResult, np.ndarray]:
    """Push a quarter of a footing into sand that does not dilate; return its dofs as well."""
    side = np.linspace(0.0, 1.0, n + 1)
    mesh = MeshHex.init_tensor(side, side, side).with_boundaries(
        {"footing": lambda x: (x[2] == 1.0) & (x[0] < 0.3) & (x[1] < 0.3)}
    )
    basis = Basis(mesh, ElementVector(ElementHex1()), intorder=2)
    sand = sc.MohrCoulomb(E=2e4, nu=0.3, c=1.0, phi=40.0, psi=0.0)
    ground = sc.SolidForm(basis, sand, strain="b_bar", unit_weight=20.0)
    foot = basis.get_dofs("footing").all("u^3")
    fixed = np.union1d(sc.box_supports(basis), foot)
    down = basis.zeros()
    down[foot] = -0.002
    model = sc.Model({"ground": ground}, fixed, solver="superlu")
    stage = sc.Stage("pushed", prescribed=down)
    result = model.run([stage], start=model.k0_state(K0=0.5), progress=False)
    return result["pushed"], foot


def test_soil_without_dilation_takes_one_increment(caplog: pytest.LogCaptureFixture) -> None:
    """[N] Newton's method alone takes three increments and 42 iterations. Their load is 8.3023: the
    loads of one and of three increments differ by .13 %.
    """
    with caplog.at_level(logging.DEBUG, "skfem_contact"):
        pushed, foot = footing()
    assert len(pushed.iterations) == 1
    assert any("accelerated iteration" in record.message for record in caplog.records)
    assert pushed.residual <= 1e-8
    load = -(pushed.reactions() + pushed.load)[foot].sum()
    assert load == pytest.approx(8.3023, rel=5e-3)


@pytest.mark.slow
def test_stalled_iterations_leave_the_increment_to_newton(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where accelerated iterations fail at once, the increment is cut as without them."""
    calls = []

    def fails(self, now):
        calls.append(now.norm)
        raise SingularSystem("no stiffness", np.array([0]))

    monkeypatch.setattr(step_module._Balance, "preconditioner", fails)
    pushed, _ = footing()
    assert calls
    assert len(pushed.iterations) > 1
