"""PETSc on the processes of mpiexec: agreement, refusals and solvers that take over."""

from __future__ import annotations

import logging
import os
import shutil
import subprocess
import sys
from importlib.util import find_spec
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from scipy.sparse import diags
from skfem import Basis, ElementHex1, ElementVector, MeshHex

import skfem_contact as sc
from skfem_contact.errors import NotConverged
from skfem_contact.solvers import petsc
from skfem_contact.solvers.choice import linear_solver
from skfem_contact.solvers.direct import DirectSolver, SingularSystem
from skfem_contact.solvers.multigrid import InTurn
from skfem_contact.solvers.whole_nodes import WholeNodes

MISSING = find_spec("petsc4py") is None or find_spec("mpi4py") is None
needs_petsc = pytest.mark.skipif(MISSING, reason="petsc4py and mpi4py are not installed")
needs_mpiexec = pytest.mark.skipif(
    MISSING or shutil.which("mpiexec") is None, reason="petsc4py or mpiexec is not installed"
)
#: Prints two loads, each by PETSc and by the default solver.
SCRIPT = Path(__file__).with_name("script_of_petsc.py")


def block(n=3):
    """Basis of an elastic block on its base, its form and supports."""
    side = np.linspace(0.0, 1.0, n + 1)
    mesh = MeshHex.init_tensor(side, side, 2.0 * side).with_defaults()
    basis = Basis(mesh, ElementVector(ElementHex1()), intorder=2)
    form = sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3))
    return basis, form, basis.get_dofs(lambda x: x[2] == 0.0).all()


# -- without PETSc


@pytest.fixture
def without(monkeypatch):
    """No petsc4py, and a process that has not asked for it."""
    monkeypatch.setitem(sys.modules, "mpi4py", None)
    petsc._process.cache_clear()
    yield
    petsc._process.cache_clear()


def test_fallback_without_petsc(without):
    """[X] One warning, and the solver that the model would choose without it."""
    basis, form, fixed = block()
    with pytest.warns(sc.AnalysisWarning, match="one process runs the script") as caught:
        solver = sc.Petsc()
        assert sc.Petsc() == solver
    assert len(caught) == 1
    free = np.setdiff1d(np.arange(basis.N), fixed)
    chosen = linear_solver({"block": form}, solver, basis.doflocs, free)
    assert isinstance(chosen, DirectSolver)
    stages = [sc.Stage("weight", sc.weight(basis, 20.0))]
    x = sc.Model({"block": form}, fixed, solver=solver).run(stages)[-1].x
    np.testing.assert_array_equal(x, sc.Model({"block": form}, fixed).run(stages)[-1].x)


@pytest.mark.parametrize("names", petsc._NUMBERS)
def test_other_processes_end_without_petsc(without, monkeypatch, names):
    """[X] The second of two processes does not repeat the analysis of the first."""
    for name, number in zip(names, ("1", "2"), strict=True):
        monkeypatch.setenv(name, number)
    with pytest.raises(SystemExit) as ended:
        sc.Petsc()
    assert ended.value.code is None


def test_unknown_method():
    with pytest.raises(ValueError, match="method must be one of 'gamg', 'mumps' or None"):
        sc.Petsc("hypre")


# -- parts that need no PETSc


def test_slabs_across_the_longest_side(rng):
    """[X] Three slabs of equally many nodes, in the order of their coordinates on the longest side,
    and the same solution as by the free block.
    """
    basis, form, fixed = block()
    free = np.setdiff1d(np.arange(basis.N), fixed)
    nodes = WholeNodes(basis.doflocs, free, parts=3)
    heights = np.split(basis.doflocs[2, nodes.dofs], 3)
    for lower, upper in pairwise(heights):
        assert lower.max() <= upper.min()
    K, b = form.elastic_stiffness, rng.standard_normal(basis.N)
    A = nodes.gather(K)
    x = nodes.placed(np.linalg.solve(A.toarray(), nodes.taken(b)), basis.N)
    expected = DirectSolver(basis.doflocs, free, "superlu").factor(K)(b)
    np.testing.assert_allclose(x, expected, atol=1e-12 * np.abs(expected).max())


class Failing:
    """Solver that fails, in its preparation or its solution."""

    name = "failing"

    def __init__(self, early):
        self.early = early

    def factor(self, K, symmetric=False):
        if self.early:
            raise NotConverged("no preparation")
        return self

    def __call__(self, b, rtol=1e-10):
        raise NotConverged("no solution")


def test_solvers_in_turn(caplog):
    """[X] Each failure is logged once, the last solver stays, and its own error is raised."""
    basis, form, fixed = block()
    free = np.setdiff1d(np.arange(basis.N), fixed)
    K, b = form.elastic_stiffness, sc.weight(basis, 20.0)
    last = DirectSolver(basis.doflocs, free, "superlu")
    solver = InTurn(lambda: Failing(True), lambda: Failing(False), lambda: last)
    with caplog.at_level(logging.INFO, logger="skfem_contact"):
        x = solver.factor(K)(b)
        np.testing.assert_array_equal(solver.factor(K)(b), x)
    np.testing.assert_array_equal(x, last.factor(K)(b))
    assert [r.getMessage().split(";")[0] for r in caplog.records] == [
        "no preparation",
        "no solution",
    ]
    with pytest.raises(NotConverged, match="no solution"):
        InTurn(lambda: Failing(True), lambda: Failing(False)).factor(K)(b)


# -- with PETSc


@needs_petsc
@pytest.mark.parametrize("method", ["gamg", "mumps"])
@pytest.mark.parametrize("symmetric", [True, False])
def test_same_as_direct(method, symmetric, rng):
    """[N] Random loads by one process; a kept matrix is not prepared again."""
    basis, form, fixed = block(4)
    free = np.setdiff1d(np.arange(basis.N), fixed)
    K, b = form.elastic_stiffness, rng.standard_normal(basis.N)
    solver = petsc.distributed(sc.Petsc(method), basis.doflocs, free, displacements=True)
    solve = solver.factor(K, symmetric)
    expected = DirectSolver(basis.doflocs, free, "superlu").factor(K)(b)
    np.testing.assert_allclose(solve(b), expected, atol=1e-8 * np.abs(expected).max())
    assert not solve(b)[fixed].any()
    prepared = petsc._process()._count
    solver.factor(K.copy(), symmetric)
    assert petsc._process()._count == prepared
    solver.factor(2.0 * K, symmetric)
    assert petsc._process()._count == prepared + 1


@needs_petsc
@pytest.mark.parametrize("symmetric", [True, False])
def test_levels_of_an_earlier_matrix(symmetric, rng):
    """[N] They serve for a similar matrix, and are made anew where the next one differs much."""
    basis, form, fixed = block(6)
    free = np.setdiff1d(np.arange(basis.N), fixed)
    K, b = form.elastic_stiffness, rng.standard_normal(basis.N)
    solver = petsc.distributed(sc.Petsc(), basis.doflocs, free, displacements=True)
    share = np.where(basis.doflocs[0] < 0.5, 1.0, 1e-4)
    kinds = []
    for scale in (np.ones(basis.N), 1.0 + 0.01 * share, np.sqrt(share)):
        A = (diags(scale) @ K @ diags(scale)).tocsr()
        x = solver.factor(A, symmetric)(b)
        kept = petsc._process()._kept
        kinds.append(kept[max(kept)].getPC().getType())
        assert np.linalg.norm((b - A @ x)[free]) < 2e-10 * np.linalg.norm(b[free])
    assert kinds == ["gamg", "python", "gamg"]


@needs_petsc
def test_memory_is_freed():
    """[X] Of ten stiffnesses in turn at most two are kept."""
    basis, form, fixed = block()
    free = np.setdiff1d(np.arange(basis.N), fixed)
    K = form.elastic_stiffness
    solver = petsc.distributed(sc.Petsc(), basis.doflocs, free, displacements=True)
    for k in range(10):
        solver.factor((1.0 + k) * K, True)(sc.weight(basis, 20.0))
    assert len(petsc._process()._kept) <= 2


@needs_petsc
def test_floating_body(caplog):
    """[X] Both methods fail on a body without supports: the direct solver finds its motions."""
    basis, form, _ = block()
    solver = petsc.distributed(sc.Petsc(), basis.doflocs, np.arange(basis.N), displacements=True)
    with caplog.at_level(logging.INFO, "skfem_contact"), pytest.raises(SingularSystem):
        solver.factor(form.elastic_stiffness, True)(np.ones(basis.N))
    assert sum("a direct solver takes over" in r.getMessage() for r in caplog.records) == 2


@needs_mpiexec
@pytest.mark.parametrize("processes", [1, 2, 3])
def test_processes(processes):
    """[N] Sand in space by multigrid, blocks in contact by MUMPS: loads of PARDISO or SuperLU."""
    done = run(processes)
    assert done.returncode == 0, done.stderr
    rows = [line for line in done.stdout.splitlines() if line]
    assert len(rows) == 2  # one process has run the script
    for row in rows:
        load, expected = map(float, row.split())
        assert abs(load / expected - 1.0) < 1e-6


@needs_mpiexec
def test_error_of_the_script_ends_all_processes():
    """[X] The other process does not wait for ever, and the status tells the error."""
    done = run(2, "wrong")
    assert done.returncode != 0
    assert "ValueError" in done.stderr


def run(processes, *arguments):
    """Run the script by mpiexec."""
    allowed = {
        "OMPI_ALLOW_RUN_AS_ROOT": "1",
        "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
        "OMPI_MCA_rmaps_base_oversubscribe": "1",
    }
    command = ["mpiexec", "-n", str(processes), sys.executable, str(SCRIPT), *arguments]
    return subprocess.run(
        command,
        capture_output=True,
        text=True,
        timeout=300,
        env=os.environ | allowed,
        check=False,
    )
