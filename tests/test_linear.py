"""Direct solver: agreement with dense algebra, reuse, singular systems."""

import numpy as np
import pytest
from scipy.sparse import coo_matrix, csr_matrix

from skfem_contact.analysis import linear
from skfem_contact.analysis.linear import DirectSolver, FreeBlock, SingularSystem, as_solver

SIDE = 12


def _places():
    """Nodes of a square grid, two unknowns each."""
    x, y = np.meshgrid(np.arange(SIDE, dtype=float), np.arange(SIDE, dtype=float))
    return np.repeat(np.array([x.ravel(), y.ravel()]), 2, axis=1)


def _springs(pairs, stiffness, n):
    """Matrix of springs between unknowns; it gives no force to a common translation."""
    i, j = pairs
    rows, cols = np.concatenate([i, j, i, j]), np.concatenate([i, j, j, i])
    return coo_matrix((np.kron([1, 1, -1, -1], stiffness), (rows, cols)), shape=(n, n))


def _contact_like(seed, held=True):
    """Two grids of springs joined by nonsymmetric stiff pairs at the middle line; `seed` moves the pairs."""
    n = 2 * SIDE**2
    unknown = np.arange(n).reshape(SIDE, SIDE, 2)
    rows, half = [], SIDE // 2
    for body in (unknown[:half], unknown[half:]):
        rows += [(body[1:], body[:-1]), (body[:, 1:], body[:, :-1])]
    i, j = (np.concatenate([r[k].ravel() for r in rows]) for k in (0, 1))
    K = _springs((i, j), np.ones(len(i)), n)
    if held:
        rng = np.random.default_rng(seed)
        slave, master = unknown[half, :, 1], rng.permutation(unknown[half - 1, :, 1])
        penalty = _springs((slave, master), np.full(SIDE, 1e3), n).tocoo()
        friction = coo_matrix((0.3 * penalty.data, (penalty.row - 1, penalty.col)), shape=(n, n))
        stick = _springs((slave - 1, master - 1), np.full(SIDE, 1e3), n)
        K = K + penalty + friction + stick
    return K.tocsr(), np.setdiff1d(np.arange(n), unknown[0])


def test_equals_dense_solution_while_the_pattern_changes():
    """[X] numpy's dense solution, for pairs that change from call to call."""
    places, rng = _places(), np.random.default_rng(1)
    _, free = _contact_like(0)
    solver = DirectSolver(places, free)
    for seed in range(4):
        K, _ = _contact_like(seed)
        b = rng.standard_normal(K.shape[0])
        x = solver.factor(K)(b)
        expected = np.zeros_like(b)
        expected[free] = np.linalg.solve(K.toarray()[np.ix_(free, free)], b[free])
        # condition number about 1e7: nine digits are lost at most
        np.testing.assert_allclose(x, expected, rtol=0, atol=1e-8 * np.abs(expected).max())


def test_floating_body_is_named():
    """[X] The upper body has no connection: exactly its unknowns move freely."""
    K, free = _contact_like(0, held=False)
    with pytest.raises(SingularSystem) as error:
        DirectSolver(_places(), free).factor(K)
    # only horizontal springs stop a horizontal motion, so x and y are free on their own
    assert set(error.value.unknowns) <= set(range(SIDE**2, 2 * SIDE**2))
    assert len(error.value.unknowns) >= SIDE**2 // 2


def test_unknown_without_stiffness_is_named():
    """[X] An empty row."""
    K, free = _contact_like(0)
    K = K.tolil()
    K[7, :] = 0
    K[:, 7] = 0
    with pytest.raises(SingularSystem) as error:
        DirectSolver(_places(), np.union1d(free, [7])).factor(K.tocsr())
    assert error.value.unknowns.tolist() == [7]


def test_unchanged_factor_is_used_again(monkeypatch):
    """[X] Equal data or another value on a fixed row: no second factor; changed data: one more."""
    K, free = _contact_like(0)
    calls = []
    monkeypatch.setattr(linear, "splu", lambda *a, _splu=linear.splu, **k: calls.append(1) or _splu(*a, **k))
    solver = DirectSolver(_places(), free)
    solver.factor(K)
    solver.factor(K)
    solver.factor(K.copy())
    assert len(calls) == 1
    K.data[0] *= 2  # an entry of the first row, which is fixed
    solver.factor(K)
    assert len(calls) == 1
    K.data[-1] *= 2
    solver.factor(K)
    assert len(calls) == 2


def test_gather_follows_a_new_pattern():
    """[X] Slicing by scipy."""
    order = np.random.default_rng(0).permutation(2 * SIDE**2)[:100]
    block = FreeBlock(order)
    for seed in range(3):
        K, _ = _contact_like(seed)
        assert (block.gather(K) != K[order][:, order]).nnz == 0


def test_gather_sums_duplicates():
    """[X] Duplicate entries mean their sum."""
    K = csr_matrix((np.array([1.0, 2.0, 4.0]), np.array([0, 0, 1]), np.array([0, 2, 3])), shape=(2, 2))
    assert FreeBlock(np.array([1, 0])).gather(K).toarray().tolist() == [[4, 0], [0, 3]]


def test_as_solver_refuses_what_is_no_solver():
    with pytest.raises(ValueError, match="None or a function"):
        as_solver("mumps", _places(), np.arange(3))
