"""Parts of the multigrid solver: Krylov methods, the smoother, coarse matrices that are renewed."""

from __future__ import annotations

from importlib.util import find_spec

import numpy as np
import pytest
from scipy.sparse import block_diag, csr_matrix, diags, eye
from skfem import Basis, ElementHex1, ElementVector, MeshHex
from skfem.models.elasticity import lame_parameters, linear_elasticity

from skfem_contact.solvers import krylov, levels
from skfem_contact.solvers.whole_nodes import WholeNodes

needs_pyamg = pytest.mark.skipif(find_spec("pyamg") is None, reason="pyamg is not installed")


def unsymmetric(n: int = 60) -> csr_matrix:
    """Convection and diffusion on a line."""
    return diags([-1.6, 2.1, -0.5], [-1, 0, 1], shape=(n, n)).tocsr()


@pytest.mark.parametrize("restart", [100, 20])
def test_fgmres(restart, monkeypatch, rng) -> None:
    """[N] The solution to the residual that was asked for, with restarts as well; the exact one
    after n iterations.
    """
    monkeypatch.setattr(krylov, "RESTART", restart)
    A, b = unsymmetric(), rng.standard_normal(60)
    jacobi = 1.0 / A.diagonal()
    for tolerance in (1e-2, 1e-10):
        x, count = krylov.Fgmres()(A, b, lambda r: jacobi * r, tolerance, 2000)
        assert np.linalg.norm(b - A @ x) <= 1.01 * tolerance * np.linalg.norm(b)
        assert count <= (60 if restart == 100 else 2000)


def test_fgmres_ends_where_nothing_is_left(rng) -> None:
    """[X] One iteration with the exact inverse, one for each different eigenvalue; none without a
    right-hand side.
    """
    b = rng.standard_normal(30)
    assert krylov.Fgmres()(eye(30, format="csr"), b, np.copy, 1e-12, 9)[1] == 1
    A = diags(np.repeat([1.0, 2.0, -5.0], 10)).tocsr()
    x, count = krylov.Fgmres()(A, b, np.copy, 1e-12, 9)
    assert count == 3
    np.testing.assert_allclose(A @ x, b, rtol=1e-12)
    assert krylov.Fgmres()(A, np.zeros(30), np.copy, 1e-12, 9)[1] == 0
    x, count = krylov.Fgmres()(csr_matrix((30, 30)), b, np.copy, 1e-12, 9)  # nothing resists
    assert not x.any()


def test_directions_that_were_slow_are_kept(rng) -> None:
    """[X] A second matrix with the same soft directions takes as many iterations as one without
    them, not twice.
    """
    n, soft = 400, 15
    turn = np.linalg.qr(rng.standard_normal((n, n)))[0]
    values = np.concatenate((np.geomspace(1e-4, 1e-2, soft), np.linspace(1.0, 4.0, n - soft)))
    stiff, kept, iterations = turn * values @ turn.T, krylov.Fgmres(), []
    for unsymmetric in (0.0, 1e-5):
        A, b = (
            csr_matrix(stiff + unsymmetric * rng.standard_normal((n, n)) / np.sqrt(n)),
            rng.standard_normal(n),
        )
        for method in (kept, krylov.Fgmres()):
            x, count = method(A, b, np.copy, 1e-6, 200)
            assert np.linalg.norm(b - A @ x) <= 1.01e-6 * np.linalg.norm(b)
            iterations.append(count)
    hard = csr_matrix(turn[:, soft:] * values[soft:] @ turn[:, soft:].T)
    without = krylov.Fgmres()(hard, hard @ rng.standard_normal(n), np.copy, 1e-6, 200)[1]
    print(iterations, without)
    assert iterations[0] == iterations[1]
    assert iterations[2] <= without + 1 < 0.6 * iterations[3]
    x, count = kept(
        csr_matrix((n, n)), b, np.copy, 1e-8, 9
    )  # nothing resists, the directions least of all
    assert not x.any()
    assert kept(eye(3, format="csr"), np.ones(3), np.copy, 1e-8, 9)[1] == 1


@needs_pyamg
def test_smoother() -> None:
    """[X] Errors of eigenvectors are reduced by Chebyshev's polynomial, from zero and from where
    they are.
    """
    blocks = [
        np.diag([1.0, 0.5, 0.1]),
        np.array([[2.0, 1.0, 0.0], [1.0, 2.0, 0.0], [0.0, 0.0, 3.0]]),
    ]
    scaling = block_diag([blocks[k % 2] for k in range(8)]).tocsr()
    spectrum = np.linspace(0.02, 2.0, 24)
    turn = np.linalg.qr(np.random.default_rng(1).standard_normal((24, 24)))[0]
    root = np.linalg.cholesky(scaling.toarray())
    # its blocks are not those of the scaling: these are given
    A = csr_matrix(root @ (turn * spectrum) @ turn.T @ root.T)
    smoother = levels.Smoother.__new__(levels.Smoother)
    smoother.A = A
    smoother._set(A, np.array([np.linalg.inv(blocks[k % 2]) for k in range(8)]), None)
    highest = smoother._highest(None)
    assert 2.0 <= highest <= 2.2 + 1e-12
    # the smallest eigenvalue that is reduced is a twentieth of the largest one
    assert smoother._middle == pytest.approx(1.05 * highest / 2, rel=1e-14)
    assert smoother._half == pytest.approx(0.95 * highest / 2, rel=1e-14)
    theta = (smoother._middle - spectrum) / smoother._half
    reduced = np.polynomial.Chebyshev([0, 0, 0, 1])(theta) / np.polynomial.Chebyshev([0, 0, 0, 1])(
        smoother._middle / smoother._half
    )
    vectors = np.linalg.solve(root.T, turn)
    for k in range(24):
        x = smoother.from_zero(A @ vectors[:, k])
        np.testing.assert_allclose(vectors[:, k] - x, reduced[k] * vectors[:, k], atol=1e-12)
        y = smoother.onwards(x.copy(), A @ vectors[:, k])
        np.testing.assert_allclose(vectors[:, k] - y, reduced[k] ** 2 * vectors[:, k], atol=1e-12)


def slender() -> tuple[csr_matrix, np.ndarray, np.ndarray]:
    """Stiffness of a cantilever 30 times as long as high, free dofs and coordinates."""
    sides = (np.linspace(0.0, 30.0, 91), np.linspace(0.0, 1.0, 4), np.linspace(0.0, 1.0, 4))
    basis = Basis(MeshHex.init_tensor(*sides), ElementVector(ElementHex1()), intorder=2)
    K = linear_elasticity(*lame_parameters(1e4, 0.3)).assemble(basis)
    return K, basis.complement_dofs(basis.get_dofs(lambda x: x[0] == 0.0)), basis.doflocs


@needs_pyamg
@pytest.mark.parametrize("units", [1.0, 1e-60, 1e60])
def test_smoother_in_single_precision(units, rng) -> None:
    """[N] Corrections of double precision, in units whose numbers single precision does not have,
    too; none without a residual.
    """
    K, free, locations = slender()
    A = units * WholeNodes(locations, free).gather(K)
    blocks = A.tobsr((3, 3))
    double = levels.Smoother(blocks)
    single = levels.SingleSmoother(A, blocks)
    b = rng.standard_normal(A.shape[0])
    for length in (1.0, 1e-50):
        # three steps of a polynomial round some ten times, to 1e-7 each
        expected = double.from_zero(length * b)
        size = np.abs(expected).max()
        np.testing.assert_allclose(single.from_zero(length * b), expected, atol=1e-5 * size)
    assert not single.from_zero(np.zeros_like(b)).any()
    # 0.01 of the displacements are left: single precision sees the residual of double precision
    x = b / units
    expected = double.onwards(0.99 * x, A @ x) - 0.99 * x
    found = single.onwards(0.99 * x, A @ x) - 0.99 * x
    np.testing.assert_allclose(found, expected, atol=1e-5 * np.abs(expected).max())


@needs_pyamg
def test_single_precision_takes_no_more_iterations() -> None:
    """[N] A slender cantilever of condition 1e8, solved by FGMRES to the same small residual in as
    many iterations.
    """
    K, free, locations = slender()
    nodes = WholeNodes(locations, free)
    A = nodes.gather(K)
    blocks = nodes.blocks(A)
    made = levels.Levels(A, blocks, nodes.rigid_modes(blocks)[0])
    weight = np.tile([0.0, 0.0, -1.0], K.shape[0] // 3)
    b = nodes.taken(weight)
    counts = []
    for single in (False, True):
        cycle = made.cycle(A, blocks, single)
        x, count = krylov.Fgmres()(blocks, b, cycle, 1e-8, 100)
        assert np.linalg.norm(b - A @ x) <= 1.01e-8 * np.linalg.norm(b)
        counts.append(count)
    assert counts[1] <= counts[0] + 1  # round-off may decide one iteration
