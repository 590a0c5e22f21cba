"""Products by parts of the rows: the digits of one thread, without copies, also after a fork."""

from __future__ import annotations

import multiprocessing

import numpy as np
import pytest
from scipy.sparse import csr_matrix, random_array

from skfem_contact.solvers import in_threads
from skfem_contact.solvers.in_threads import InThreads


@pytest.fixture
def threads(monkeypatch):
    """Let any matrix have as many threads as it has rows of blocks, at most three."""
    monkeypatch.setattr(in_threads, "_MANY", 1)
    monkeypatch.setattr(in_threads, "allowed", lambda: 3)


def uneven(n: int = 60) -> csr_matrix:
    """Return a matrix with many entries in the first rows, and none in the last third."""
    A = random_array((n, n), density=0.4, rng=np.random.default_rng(4)).tolil()
    A[2 * n // 3 :] = 0.0
    return csr_matrix(A)


@pytest.mark.parametrize("block", [0, 1, 3])
def test_digits_do_not_depend_on_threads(block, threads, rng):
    A = uneven()
    if block:
        A = A.tobsr((block, block))
    several = InThreads(A)
    for x in (rng.standard_normal(60), rng.standard_normal((60, 4))):
        np.testing.assert_array_equal(several @ x, A @ x)
    for part in several._parts:
        assert np.shares_memory(part.data, A.data)
        assert np.shares_memory(part.indices, A.indices)
    assert len(several._parts) == 3
    assert min(part.nnz for part in several._parts) > 0.2 * A.nnz


def test_small_matrices_have_one_thread(monkeypatch):
    monkeypatch.setattr(in_threads, "allowed", lambda: 64)
    monkeypatch.setattr(in_threads, "_pool", None)
    A = uneven()
    np.testing.assert_array_equal(InThreads(A) @ np.ones(60), A @ np.ones(60))


def _product(A: InThreads) -> float:
    return float((A @ np.ones(60)).sum())


@pytest.mark.skipif("fork" not in multiprocessing.get_all_start_methods(), reason="no fork")
@pytest.mark.filterwarnings("ignore:.*multi-threaded, use of fork.*:DeprecationWarning")
def test_forked_processes_have_threads_of_their_own(threads):
    A = InThreads(uneven())
    expected = _product(A)
    with multiprocessing.get_context("fork").Pool(1) as pool:
        assert pool.apply_async(_product, (A,)).get(timeout=60.0) == expected
