"""PARDISO: reuse of the analysis, memory."""

import os
import subprocess
import sys

import numpy as np
import pytest
from scipy.sparse import block_diag, csr_matrix, diags, kronsum

pardiso = pytest.importorskip("skfem_contact.solvers.pardiso")
pytest.importorskip("pypardiso")


@pytest.fixture
def phases(monkeypatch):
    """The phases that PARDISO runs through."""
    seen, call = [], pardiso._Call.__call__

    def spy(self, phase, *arguments):
        seen.append(phase)
        call(self, phase, *arguments)

    monkeypatch.setattr(pardiso._Call, "__call__", spy)
    return seen


def _chain(n, seed=None):
    """Nonsymmetric tridiagonal matrix; with a seed, some couplings are left out."""
    K = diags([-1.0, 2.5, -1.2], [-1, 0, 1], shape=(n, n)).tocoo()
    keep = np.ones(K.nnz, dtype=bool)
    if seed is not None:
        keep = (K.row == K.col) | (np.random.default_rng(seed).random(K.nnz) < 0.9)
    A = csr_matrix((K.data[keep], (K.row[keep], K.col[keep])), shape=(n, n))
    A.sort_indices()
    return A


def test_analysis_serves_for_patterns_within(phases):
    """[X] Entries that vanish and come back cost no new analysis; the solutions are those of
    numpy.
    """
    engine, b = pardiso.Pardiso(), np.ones(50)
    for A in (_chain(50), _chain(50, 1), _chain(50, 2), 2.0 * _chain(50)):
        # condition number below 1e2
        np.testing.assert_allclose(
            engine.factor(A, False)(b), np.linalg.solve(A.toarray(), b), rtol=1e-12
        )
    assert phases.count(pardiso.ANALYSE) == 1
    assert phases.count(pardiso.FACTOR) == 4


def test_new_entries_join_the_analysed_pattern(phases):
    """[X] After both patterns have been seen, neither costs an analysis any more."""
    engine, b = pardiso.Pardiso(), np.ones(50)
    few, others = _chain(50, 1), _chain(50, 2)
    for A in (few, others, few, others):
        np.testing.assert_allclose(
            engine.factor(A, False)(b), np.linalg.solve(A.toarray(), b), rtol=1e-12
        )
    assert phases.count(pardiso.ANALYSE) == 2


def test_symmetric_matrix_without_diagonal_entries():
    """[X] A Lagrange multiplier's row: PARDISO's LDL' wants its zero stored."""
    A = csr_matrix(np.array([[2.0, -1.0, 1.0], [-1.0, 2.0, 0.0], [1.0, 0.0, 0.0]]))
    A.eliminate_zeros()
    b = np.array([1.0, 2.0, 3.0])
    x = pardiso.Pardiso().factor(A, True)(b)
    np.testing.assert_allclose(
        x, np.linalg.solve(A.toarray(), b), rtol=1e-13
    )  # condition number below 10


def test_memory_is_released(phases):
    """[X] One release for each analysis, when it is replaced and when the engine goes."""
    engine = pardiso.Pardiso()
    engine.factor(_chain(50, 1), False)
    engine.factor(_chain(50, 1), True)
    assert phases.count(pardiso.RELEASE) == 1
    del engine
    assert phases.count(pardiso.RELEASE) == phases.count(pardiso.ANALYSE) == 2


def test_errors_are_raised():
    """PARDISO reports by a number; a library that does nothing else stands in for it."""

    def call(number):
        class Library:
            @staticmethod
            def pardiso(*arguments):
                arguments[-1][0] = number

            @staticmethod
            def limit(threads):
                return threads

        pardiso._Call(Library, pardiso.UNSYMMETRIC, 1, False)(
            pardiso.FACTOR, np.zeros(1), np.ones(2), np.ones(1)
        )

    with pytest.raises(MemoryError, match="memory"):
        call(pardiso.OUT_OF_MEMORY)
    with pytest.raises(RuntimeError, match="error -4"):
        call(-4)


@pytest.mark.slow
def test_library_is_found_without_a_search_of_all_directories():
    """The installed package says where its library lies; a path of the user's own is kept."""
    script = (
        "import glob, os; glob.glob = None; from skfem_contact.solvers.pardiso import Pardiso; "
        "Pardiso(); print(os.environ['PYPARDISO_MKL_RT'])"
    )
    given = dict(os.environ)
    given.pop("PYPARDISO_MKL_RT", None)
    path = subprocess.run(
        [sys.executable, "-c", script], env=given, capture_output=True, text=True, check=True
    ).stdout
    assert "mkl_rt" in path
    given["PYPARDISO_MKL_RT"] = os.path.join(path.strip(), "of", "another")
    assert (
        subprocess.run([sys.executable, "-c", script], env=given, capture_output=True).returncode
        != 0
    )


def _grid(n):
    """Symmetric, positive definite matrix of a square of n by n points."""
    line = diags([-1.0, 2.1, -1.0], [-1, 0, 1], shape=(n, n))
    return csr_matrix(kronsum(line, line, format="csr"))


def test_condensed_matrix_is_that_of_dense_algebra():
    """[X] Schur complement and solutions beside numpy; the last block is unsymmetric, and has a
    diagonal entry of zero that is not stored.
    """
    A = _grid(12)
    n, m = A.shape[0], 15
    last = np.random.default_rng(1).random((m, m))
    last[-1, -1] = -A[-1, -1]
    A = csr_matrix(A + block_diag([csr_matrix((n - m, n - m)), csr_matrix(last)]))
    A.eliminate_zeros()
    condensed = pardiso.Pardiso().condensed(A, m, 1.0)
    full = A.toarray()
    inner, outer = slice(0, n - m), slice(n - m, n)
    schur = full[outer, outer] - full[outer, inner] @ np.linalg.solve(
        full[inner, inner], full[inner, outer]
    )
    np.testing.assert_allclose(condensed.schur, schur, atol=1e-13)
    b = np.random.default_rng(2).random(n)
    for inside in (True, False):
        b[inner] *= inside
        x = condensed.solve(b, inside, lambda load: np.linalg.solve(schur, load))
        np.testing.assert_allclose(x, np.linalg.solve(full, b), atol=1e-12)


def test_matrices_that_are_not_condensed():
    """Indefinite, unsymmetric, with a large last block, or without an entry of the diagonal."""
    A = _grid(12)
    engine = pardiso.Pardiso()
    assert engine.condensed(A, 15, 1.0) is not None
    shift = diags([np.append(np.full(100, -9.0), np.zeros(44))], [0])
    assert engine.condensed(csr_matrix(A + shift), 15, 1.0) is None
    coupled = A.tolil()
    coupled[3, 140] = 0.5
    assert engine.condensed(csr_matrix(coupled), 15, 1.0) is None
    assert engine.condensed(A, 15, 1e-9) is None
    without = A.tolil()
    without[3, 3] = 0.0  # without an entry, among the dofs that are eliminated
    assert engine.condensed(without.tocsr(), 15, 1.0) is None
