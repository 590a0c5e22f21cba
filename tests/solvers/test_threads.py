"""Threads: how many a large factor has."""

from __future__ import annotations

import os
import threading
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
import threadpoolctl
from scipy.sparse import csr_matrix

import skfem_contact as sc
from skfem_contact.solvers.threads import allowed, single_threaded
from tests.tools.helpers import grid, vector_basis

CORES = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()


def test_limit_of_the_environment(monkeypatch):
    for given, threads in (
        ("1", 1),
        ("1,1", 1),
        (str(CORES + 3), CORES),
        ("0", CORES),
        ("many", CORES),
        ("", CORES),
    ):
        monkeypatch.setenv("OMP_NUM_THREADS", given)
        assert allowed() == threads, given
    monkeypatch.delenv("OMP_NUM_THREADS")
    assert allowed() == CORES


def test_side_by_side(monkeypatch):
    # analyses side by side share the cores: one thread each
    monkeypatch.delenv("OMP_NUM_THREADS", raising=False)
    alone, inside, ended = [], threading.Event(), threading.Event()

    def other():
        with single_threaded:
            inside.set()
            ended.wait(10.0)

    thread = threading.Thread(target=other)
    thread.start()
    assert inside.wait(10.0)
    with single_threaded:
        alone.append(allowed())
    ended.set()
    thread.join()
    assert alone == [1]


def test_one_number_for_all_phases(monkeypatch):
    """An analysis keeps its number of threads, and the library has its own again after each
    call.
    """
    pytest.importorskip("pypardiso")
    import numpy as np
    from scipy.sparse import diags_array

    from skfem_contact.solvers import pardiso

    given, limit = [], pardiso._Library().limit
    monkeypatch.setattr(pardiso, "MANY", 100)
    before = limit(0)
    limit(before)
    monkeypatch.setenv("OMP_NUM_THREADS", "2")
    A = csr_matrix(
        diags_array([-np.ones(99), np.full(100, 4.0), -2 * np.ones(99)], offsets=[-1, 0, 1])
    )
    solver, call = pardiso.Pardiso(), pardiso._Call.__call__

    def spy(self, *arguments):
        given.append(self._threads)
        call(self, *arguments)

    monkeypatch.setattr(pardiso._Call, "__call__", spy)
    for first in ("2", "1"):  # the second factor has the analysis of the first
        monkeypatch.setenv("OMP_NUM_THREADS", first)
        x = solver.factor(A * float(first), symmetric=False)(np.ones(100))
        assert np.abs(A @ x * float(first) - 1.0).max() < 1e-12  # round-off
    assert len(given) >= 3 and set(given) == {min(2, CORES)}
    assert limit(0) == before


def ground():
    basis = vector_basis(grid("Q1", np.linspace(0, 4, 9), np.linspace(0, 2, 5)), "Q1", intorder=2)
    forms = {"ground": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3))}
    return basis, forms, sc.weight(basis, 20.0), basis.get_dofs("bottom").all()


def test_threads_are_given_back():
    """Runs side by side leave the number of threads as it was."""

    def threads():
        return [
            pool["num_threads"]
            for pool in threadpoolctl.threadpool_info()
            if pool["user_api"] == "blas"
        ]

    def job(n):
        _, forms, load, fixed = ground()
        return sc.Model(forms, fixed).run([sc.Stage("weight", load)], progress=False)

    job(0)
    with threadpoolctl.threadpool_limits(2, user_api="blas"):
        before = threads()
        with ThreadPoolExecutor(3) as pool:
            list(pool.map(job, range(9)))
        assert threads() == before
