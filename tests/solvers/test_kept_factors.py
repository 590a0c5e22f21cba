"""Rough solutions by the factor of an earlier matrix: residuals, and matrices with their own."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import diags
from skfem import Basis, ElementHex1, ElementVector, MeshHex
from skfem.models.elasticity import lame_parameters, linear_elasticity

from skfem_contact.solvers import direct
from skfem_contact.solvers.direct import DirectSolver, SingularSystem


@pytest.fixture(params=["superlu", "pardiso"])
def engine(request):
    if request.param == "pardiso":
        pytest.importorskip("pypardiso")
    return request.param


@pytest.fixture(autouse=True)
def small_ones_too(monkeypatch):
    """Systems of these tests are small."""
    monkeypatch.setattr(direct, "SINGLE", 1)


def block(n=4):
    """Stiffness of a block on a base, a load, its coordinates and free dofs."""
    side = np.linspace(0.0, 1.0, n)
    basis = Basis(MeshHex.init_tensor(side, side, side), ElementVector(ElementHex1()), intorder=2)
    K = linear_elasticity(*lame_parameters(1e4, 0.3)).assemble(basis)
    free = basis.complement_dofs(basis.get_dofs(lambda x: x[2] == 0.0).all())
    load = np.random.default_rng(0).standard_normal(basis.N)
    return K, load, basis.doflocs, free


def similar(K, spread):
    """Matrix whose rows are those of K times factors from 1 to 1 + spread."""
    factors = 1.0 + spread * np.random.default_rng(1).random(K.shape[0])
    return (diags(factors) @ K).tocsr()


@pytest.fixture
def factored(monkeypatch, engine):
    """Matrices that the engine factors."""
    found = []
    factor = direct.ENGINES[engine].factor

    def counted(self, A, symmetric, careful=False):
        found.append(A)
        return factor(self, A, symmetric, careful)

    monkeypatch.setattr(direct.ENGINES[engine], "factor", counted)
    return found


def residual(K, x, b, free):
    """Relative residual of the free dofs."""
    return np.linalg.norm((b - K @ x)[free]) / np.linalg.norm(b[free])


@pytest.mark.parametrize("rtol", [3e-2, 1e-3])
def test_rough_solutions_need_no_factor_of_their_own(engine, factored, rtol):
    """[N] The residual is the one asked for, and the matrix is not factored."""
    K, b, locations, free = block()
    solver = DirectSolver(locations, free, engine, single=True)
    solver.factor(K)(b)
    near = similar(K, 0.5)
    x = solver.factor(near)(b, rtol)
    assert len(factored) == 1
    assert residual(near, x, b, free) <= rtol
    fixed = np.setdiff1d(np.arange(len(b)), free)
    assert not x[fixed].any()


def test_accurate_solutions_have_their_own_factor(engine, factored):
    """[N] Solutions without a tolerance of their own have the residual of double precision."""
    K, b, locations, free = block()
    solver = DirectSolver(locations, free, engine, single=True)
    solver.factor(K)(b)
    near = similar(K, 0.5)
    solve = solver.factor(near)
    solve(b, 3e-2)
    x = solve(b)
    assert len(factored) == 2
    assert residual(near, x, b, free) < 1e-12


def test_other_matrices_are_factored_after_few_iterations(engine, factored, monkeypatch):
    """[N] Where more iterations would be needed, the matrix is factored, and so is the next one
    after many iterations.
    """
    K, b, locations, free = block()
    solver = DirectSolver(locations, free, engine, single=True)
    solver.factor(K)(b)
    other = similar(K, 1e4)
    monkeypatch.setattr(direct, "MOST", 3)
    x = solver.factor(other)(b, 1e-3)
    assert len(factored) == 2
    assert residual(other, x, b, free) <= 1e-3
    monkeypatch.setattr(direct, "MANY", 1)
    solver.factor(2.0 * other)(b, 1e-3)  # solved in a single iteration
    assert len(factored) == 2
    solver.factor(3.0 * other)(b, 1e-3)
    assert len(factored) == 3


def test_symmetric_and_other_matrices_have_factors_of_their_own(engine, factored):
    """[N] A factor of a symmetric matrix does not serve for one that is not."""
    K, b, locations, free = block()
    solver = DirectSolver(locations, free, engine, single=True)
    solver.factor(K, symmetric=True)(b)
    near = similar(K, 0.1)
    x = solver.factor(near)(b, 1e-2)
    assert len(factored) == 2
    assert residual(near, x, b, free) <= 1e-2


def test_loose_bodies_are_named_by_the_solution(engine):
    """[X] A block that floats has no solution after one that stood."""
    K, b, locations, _ = block()
    everywhere = np.arange(K.shape[0])
    solver = DirectSolver(locations, everywhere, engine, single=True)
    solver.factor(K + diags(np.full(K.shape[0], 1e3)))(b)
    with pytest.raises(SingularSystem):
        solver.factor(K)(b)
