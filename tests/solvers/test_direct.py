"""Direct solver: agreement with dense algebra, reuse, singular systems."""

import logging

import numpy as np
import pytest
from scipy.sparse import coo_matrix, csr_matrix, diags
from scipy.sparse.linalg import spsolve
from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
from skfem.models.elasticity import linear_elasticity
from skfem.utils import solver_iter_krylov

from skfem_contact.errors import NotConverged
from skfem_contact.solvers import direct, superlu
from skfem_contact.solvers.choice import as_solver
from skfem_contact.solvers.direct import DirectSolver, SingularSystem
from skfem_contact.sparse import FreeBlock, Total

N = 8  # elements along the side of a body


@pytest.fixture(params=["superlu", "pardiso"])
def engine(request):
    if request.param == "pardiso":
        pytest.importorskip("pypardiso")
    return request.param


class TwoBlocks:
    """Two elastic squares, E about 2.5, the upper one on the lower one with nodes in the same
    places.
    """

    def __init__(self):
        side = np.linspace(0.0, 1.0, N + 1)
        lower = MeshQuad.init_tensor(side, side)
        upper = lower.translated((0.0, 1.0))
        nodes = lower.p.shape[1]
        mesh = MeshQuad(np.hstack([lower.p, upper.p]), np.hstack([lower.t, upper.t + nodes]))
        basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
        self.locations, dofs = basis.doflocs, basis.nodal_dofs
        self.elastic = linear_elasticity(1.0, 1.0).assemble(basis).tocsr()
        self.size = basis.N
        self.upper = np.arange(2 * nodes, 4 * nodes)
        self.free = np.setdiff1d(np.arange(basis.N), dofs[:, mesh.p[1] == 0.0])
        self.slave = dofs[:, nodes + np.flatnonzero(lower.p[1] == 0.0)]
        self.master = dofs[:, np.flatnonzero(lower.p[1] == 1.0)]

    def stiffness(self, normal, tangential=0.0, friction=0.0, partners=None):
        """With springs between slave nodes and their partners; `friction` couples them
        unsymmetrically.
        """
        partners = np.arange(N + 1) if partners is None else partners
        slave, master = self.slave, self.master[:, partners]
        rows, cols, values = [], [], []
        for row, col, value in ((1, 1, normal), (0, 0, tangential), (0, 1, friction)):
            rows += [slave[row], slave[row], master[row], master[row]]
            cols += [slave[col], master[col], slave[col], master[col]]
            values += [value, -value, -value, value]
        entries = np.repeat(values, N + 1), (np.concatenate(rows), np.concatenate(cols))
        return (self.elastic + coo_matrix(entries, shape=self.elastic.shape).tocsr()).tocsr()


@pytest.fixture(scope="module")
def blocks():
    return TwoBlocks()


def _dense(K, free, b):
    x = np.zeros_like(b)
    x[free] = np.linalg.solve(K.toarray()[np.ix_(free, free)], b[free])
    return x


def test_equals_dense_solution_while_the_pattern_changes(blocks, engine):
    """[X] numpy's dense solution, for nonsymmetric pairs that change from call to call."""
    rng = np.random.default_rng(1)
    solver = DirectSolver(blocks.locations, blocks.free, engine)
    for penalty in (10.0, 1e3, 1e3, 1e6):
        K = blocks.stiffness(penalty, penalty / 3, 0.3 * penalty, rng.permutation(N + 1))
        b = rng.standard_normal(blocks.size)
        # row-scaled condition numbers up to 1e8: eight of sixteen digits remain
        expected = _dense(K, blocks.free, b)
        np.testing.assert_allclose(
            solver.factor(K)(b), expected, rtol=0, atol=1e-8 * np.abs(expected).max()
        )


def test_symmetric_stiffness(blocks, engine):
    """[X] numpy's dense solution; the hint may change after the first factor."""
    solver = DirectSolver(blocks.locations, blocks.free, engine)
    K, b = blocks.stiffness(1e3, 1e2), np.ones(blocks.size)
    expected = _dense(K, blocks.free, b)
    for symmetric in (True, False, True):
        x = solver.factor(K, symmetric)(b)
        # row-scaled condition number 1e5
        np.testing.assert_allclose(x, expected, rtol=0, atol=1e-10 * np.abs(expected).max())


def test_earlier_factors_stay_valid(blocks, engine):
    """[X] A callable solves with its own matrix, whatever was factored after it."""
    solver, b = DirectSolver(blocks.locations, blocks.free, engine), np.ones(blocks.size)
    first, second = (
        blocks.stiffness(1e2, 1e2),
        blocks.stiffness(1e3, 1e3, partners=np.arange(N + 1)[::-1]),
    )
    solve_first, solve_second = solver.factor(first), solver.factor(second)
    for K, solve in ((first, solve_first), (second, solve_second)):
        assert np.abs((K @ solve(b) - b)[blocks.free]).max() < 1e-9  # round-off of forces of 1e3


@pytest.mark.parametrize("symmetric", [False, True])
def test_floating_body_is_named(blocks, engine, symmetric):
    """[X] Nothing joins the upper block: its unknowns and no others."""
    with pytest.raises(SingularSystem) as error:
        DirectSolver(blocks.locations, blocks.free, engine).factor(blocks.stiffness(0.0), symmetric)
    assert set(error.value.dofs) <= set(blocks.upper)
    # a rotation does not lift the column, nor push the row, of nodes through its centre
    assert len(error.value.dofs) >= len(blocks.upper) - 2 * (N + 1)


def test_floating_body_is_named_by_a_careful_factor(blocks, monkeypatch):
    """[X] Factors that an engine scales as an earlier matrix may give no numbers: they name
    nothing.
    """
    factor = superlu.SuperLU.factor

    def stale(self, A, symmetric, careful=False):
        solve = factor(self, A, symmetric, careful)
        return solve if careful else lambda b: np.nan * solve(b)

    monkeypatch.setattr(superlu.SuperLU, "factor", stale)
    with pytest.raises(SingularSystem) as error:
        DirectSolver(blocks.locations, blocks.free, "superlu").factor(blocks.stiffness(0.0))
    assert set(error.value.dofs) <= set(blocks.upper)


@pytest.mark.parametrize("penalty", [1e0, 1e6])
def test_sliding_body_is_named(blocks, engine, penalty):
    """[X] Contact without friction, of any stiffness: all horizontal unknowns of the upper
    block.
    """
    with pytest.raises(SingularSystem, match="can move without force") as error:
        DirectSolver(blocks.locations, blocks.free, engine).factor(blocks.stiffness(penalty))
    assert error.value.dofs.tolist() == blocks.upper[::2].tolist()


@pytest.mark.parametrize("tangential", [1e-9, 1e6])
def test_weak_hold_beside_stiff_penalty_is_legal(blocks, engine, tangential):
    """[X] Springs of 1e-9 E hold the body sideways; a vertical load moves it as the dense solution
    says.
    """
    K = blocks.stiffness(1e6, tangential)
    b = np.zeros(blocks.size)
    b[blocks.upper[1::2]] = -1.0
    x = DirectSolver(blocks.locations, blocks.free, engine).factor(K)(b)
    expected = _dense(K, blocks.free, b)
    # the vertical motion is well conditioned up to the penalty, 1e6
    np.testing.assert_allclose(
        x[1::2], expected[1::2], rtol=0, atol=1e-7 * np.abs(expected[1::2]).max()
    )


def test_unknown_without_stiffness_is_named(blocks, engine):
    """[X] An empty row."""
    keep = np.ones(blocks.size)
    keep[blocks.upper[7]] = 0.0
    K = (diags(keep) @ blocks.stiffness(1.0, 1.0) @ diags(keep)).tocsr()
    K.eliminate_zeros()
    with pytest.raises(SingularSystem) as error:
        DirectSolver(blocks.locations, blocks.free, engine).factor(K)
    assert error.value.dofs.tolist() == [blocks.upper[7]]


def test_exactly_singular_matrix(engine):
    """[X] Two unknowns joined by a spring, in exact arithmetic; a third one is held."""
    K = csr_matrix(np.array([[1.0, -1.0, 0.0], [-1.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
    with pytest.raises(SingularSystem) as error:
        DirectSolver(np.arange(3.0)[None], np.arange(3), engine).factor(K)
    assert error.value.dofs.tolist() == [0, 1]


def test_pattern_without_a_pivot_in_each_row(engine, capfd):
    """[X] Two unknowns that one spring joins to a third: named, and BLAS has nothing to complain
    about.
    """
    K = np.diag([0.0, 6.0, 6.0, 6.0, 6.0, 0.0, 6.0])
    for i, j in ((0, 6), (5, 6), (2, 3), (2, 4), (2, 6), (3, 6)):
        K[i, j] = K[j, i] = 1.0
    if engine == "superlu":
        with_zeros = csr_matrix((K.ravel(), np.indices(K.shape).reshape(2, -1)), shape=K.shape)
        for matrix in (csr_matrix(K), with_zeros):
            with pytest.raises(RuntimeError, match="by its pattern"):
                superlu.SuperLU().factor(matrix, symmetric=False)
    with pytest.raises(SingularSystem) as error:
        DirectSolver(np.arange(7.0)[None], np.arange(7), engine).factor(csr_matrix(K))
    assert error.value.dofs.tolist() == [0, 5]
    assert not "".join(capfd.readouterr())


def test_unchanged_factor_is_used_again(blocks, monkeypatch):
    """[X] Equal data or other values on fixed rows: no second factor; changed data: one more."""
    calls, splu = [], superlu.splu
    monkeypatch.setattr(superlu, "splu", lambda *a, **k: calls.append(1) or splu(*a, **k))
    solver = DirectSolver(blocks.locations, blocks.free, "superlu")
    K = blocks.stiffness(10.0, 1.0)
    factors = [solver.factor(K), solver.factor(K), solver.factor(K.copy())]
    fixed = np.setdiff1d(np.arange(blocks.size), blocks.free)
    K.data[K.indptr[fixed[0]]] *= 2.0
    factors.append(solver.factor(K))
    assert len(calls) == 1
    assert all(factor is factors[0] for factor in factors)
    K.data[-1] *= 2.0
    solver.factor(K)
    assert len(calls) == 2


def test_order_is_kept_until_the_factors_grow(blocks, monkeypatch):
    """[X] The order is computed for the first matrix of a mesh and again when a pattern has spoilt
    it, not else.
    """
    calls, nested = [], superlu.nested_dissection
    monkeypatch.setattr(superlu, "nested_dissection", lambda *a: calls.append(1) or nested(*a))
    monkeypatch.setattr(superlu, "_orders", {})
    DirectSolver(blocks.locations, blocks.free, "superlu").factor(
        blocks.stiffness(1.0, 1.0)
    )  # of another model
    solver = DirectSolver(blocks.locations, blocks.free, "superlu")
    solver.factor(blocks.stiffness(1.0, 1.0))
    solver.factor(blocks.stiffness(2.0, 1.0, partners=np.roll(np.arange(N + 1), 1)))
    assert len(calls) == 1
    rng = np.random.default_rng(0)
    i, j = rng.integers(0, blocks.size, (2, 400))
    tangle = coo_matrix((np.full(400, 1e-6), (i, j)), shape=2 * (blocks.size,)).tocsr()
    for factor in (1.0, 2.0, 3.0):
        K = blocks.stiffness(factor, 1.0) + tangle
        x = solver.factor(K)(np.ones(blocks.size))
        assert np.abs((K @ x - 1.0)[blocks.free]).max() < 1e-10  # round-off of forces of 1e2
    assert len(calls) == 2


def test_careful_factor_replaces_a_wrong_one(blocks, monkeypatch):
    """[X] A factor whose solutions leave a residual is computed again with full pivoting."""
    factor, careful_calls = superlu.SuperLU.factor, []

    def spoilt(self, A, symmetric, careful=False):
        solve = factor(self, A, symmetric, careful)
        careful_calls.append(careful)
        return solve if careful else lambda b: 3.0 * solve(b)

    monkeypatch.setattr(superlu.SuperLU, "factor", spoilt)
    K, b = blocks.stiffness(1.0, 1.0), np.ones(blocks.size)
    x = DirectSolver(blocks.locations, blocks.free, "superlu").factor(K)(b)
    assert careful_calls == [False, True]
    assert np.abs((K @ x - b)[blocks.free]).max() < 1e-10  # round-off of forces of 1e2


def test_multipliers_without_effect_are_no_motion(engine):
    """[X] 90 multipliers of six combinations, with little compliance, as those of a rigid slave.

    PARDISO finds pivots of round-off in this regular matrix.
    """
    n, m, rank = 200, 90, 6
    random = np.random.default_rng(0)
    root = random.standard_normal((n, n))
    jumps = random.standard_normal((m, rank)) @ random.standard_normal((rank, n)) / np.sqrt(n)
    K = csr_matrix(np.block([[root @ root.T / n + np.eye(n), jumps.T], [jumps, -1e-6 * np.eye(m)]]))
    locations = np.arange(float(n + m))[None]
    x = DirectSolver(locations, np.arange(n + m), engine).factor(K)(np.ones(n + m))
    np.testing.assert_allclose(K @ x, 1.0, atol=1e-7)  # refused from 1e-5 on


@pytest.mark.parametrize("spoil", [3.0, np.nan])
def test_residual_that_stays_is_an_error(blocks, monkeypatch, spoil):
    """[X] No factor is good enough, or there is none but NaN: refused rather than returned."""
    factor = superlu.SuperLU.factor

    def spoilt(self, A, symmetric, careful=False):
        solve = factor(self, A, symmetric, careful)
        return lambda b: spoil * solve(b)

    monkeypatch.setattr(superlu.SuperLU, "factor", spoilt)
    solver = DirectSolver(blocks.locations, blocks.free, "superlu")
    with pytest.raises(SingularSystem):
        solver.factor(blocks.stiffness(1.0, 1.0))(np.ones(blocks.size))


def test_no_load_and_no_free_unknown(blocks, engine):
    """[X] Zero in both cases."""
    K, zero = blocks.stiffness(1.0, 1.0), np.zeros(blocks.size)
    assert not DirectSolver(blocks.locations, blocks.free, engine).factor(K)(zero).any()
    none = np.zeros(0, dtype=int)
    assert not DirectSolver(blocks.locations, none, engine).factor(K)(np.ones(blocks.size)).any()


def test_bad_input_is_refused(blocks):
    K, b = blocks.stiffness(1.0, 1.0), np.ones(blocks.size)
    solver = DirectSolver(blocks.locations, blocks.free)
    b[blocks.free[0]] = np.nan
    with pytest.raises(ValueError, match="right-hand side"):
        solver.factor(K)(b)
    K.data[-1] = np.inf
    with pytest.raises(ValueError, match="not finite"):
        solver.factor(K)
    with pytest.raises(ValueError, match="dofs have coordinates"):
        solver.factor(K[:4, :4])


def test_gather_follows_a_new_pattern(blocks):
    """[X] Slicing by scipy."""
    order = np.random.default_rng(0).permutation(blocks.free)
    block = FreeBlock(order)
    for shift in range(3):
        K = blocks.stiffness(1.0, partners=np.roll(np.arange(N + 1), shift))
        for _ in range(2):
            assert (block.gather(K) != K[order][:, order]).nnz == 0


def test_gather_notices_a_pattern_changed_in_place():
    """[X] Slicing by scipy, after an entry has gone and another has moved in the same matrix."""
    order = np.array([2, 0, 1])
    block, K = (
        FreeBlock(order),
        csr_matrix(np.array([[1.0, 2.0, 3.0], [0.0, 4.0, 0.0], [5.0, 0.0, 6.0]])),
    )
    block.gather(K)
    K.data[1] = 0.0
    K.eliminate_zeros()
    assert (block.gather(K) != K[order][:, order]).nnz == 0
    K.indices[-2:] = [1, 2]  # the same number of entries in other columns
    assert (block.gather(K) != K[order][:, order]).nnz == 0


def test_gather_does_not_look_at_a_pattern_that_cannot_change(monkeypatch):
    """The sum of the forms' tangents keeps its read-only pattern: known by identity, gathered as
    any other.
    """
    order, total = np.array([2, 0, 1]), Total()
    block, other = FreeBlock(order), FreeBlock(order)
    A, B = csr_matrix(np.arange(9.0).reshape(3, 3)), csr_matrix(np.eye(3))
    block.gather(total.of([A, B]))
    last = total.of([A, 2 * B])
    expected = other.gather(last.copy())
    monkeypatch.setattr(np, "array_equal", None)
    assert (block.gather(last) != expected).nnz == 0


def test_gather_sums_duplicates():
    """[X] Duplicate entries mean their sum."""
    K = csr_matrix(
        (np.array([1.0, 2.0, 4.0]), np.array([0, 0, 1]), np.array([0, 2, 3])), shape=(2, 2)
    )
    assert FreeBlock(np.array([1, 0])).gather(K).toarray().tolist() == [[4, 0], [0, 3]]


@pytest.mark.parametrize(
    "function", [spsolve, solver_iter_krylov(rtol=1e-12)], ids=["spsolve", "cg"]
)
def test_functions_of_scikit_fem_are_solvers(blocks, function):
    """[X] They give the dense solution on the free unknowns."""
    K, b = blocks.stiffness(10.0, 10.0), np.ones(blocks.size)
    x = as_solver(function, blocks.locations, blocks.free).factor(K)(b)
    expected = _dense(K, blocks.free, b)
    # cg stops at a residual of 1e-12; condition number 1e4
    np.testing.assert_allclose(x, expected, rtol=0, atol=1e-8 * np.abs(expected).max())


def test_function_that_fails_is_refused(blocks):
    solver = as_solver(lambda A, b: np.full_like(b, np.nan), blocks.locations, blocks.free)
    with pytest.raises(NotConverged, match="not finite"):
        solver.factor(blocks.stiffness(1.0, 1.0))(np.ones(blocks.size))


def test_function_whose_values_are_no_solution_is_refused(blocks):
    solver = as_solver(lambda A, b: np.full_like(b, 1e30), blocks.locations, blocks.free)
    with pytest.raises(NotConverged, match="are no solution: their residual is"):
        solver.factor(blocks.stiffness(1.0, 1.0))(np.ones(blocks.size))


@pytest.mark.parametrize("solver", ["mumps", 1])
def test_what_is_no_solver_is_refused(blocks, solver):
    with pytest.raises(ValueError, match="pardiso, superlu"):
        as_solver(solver, blocks.locations, blocks.free)


def test_choice_is_logged_and_scipy_is_enough(blocks, monkeypatch, caplog):
    """Without pypardiso SuperLU is taken, and the log says so once."""

    def missing():
        raise ImportError("no pypardiso")

    monkeypatch.setattr(direct, "Pardiso", missing)
    with caplog.at_level(logging.INFO, logger="skfem_contact"):
        solver = DirectSolver(blocks.locations, blocks.free)
        solver.factor(blocks.stiffness(1.0, 1.0))
    messages = [record.getMessage() for record in caplog.records]
    assert messages == ["linear solver: SuperLU with nested dissection"]
    assert "SuperLU" in repr(solver)
