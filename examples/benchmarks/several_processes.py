"""Elastic block in space on the processes of mpiexec: time, work and memory of each of them.

``mpiexec -n 2 python several_processes.py 46`` solves for a block under its weight, with 46
elements along its sides, which are assembled in parts; with a further ``amg`` pyamg solves. Each
process prints a line of JSON: processor time without imports in s, operations of PETSc in 1e9, peak
memory in MB; the first one wall and processor times of assembly, preparation and solution as well.
A process that waits for a message of another one takes processor time: on a busy machine compare
operations.
"""

from __future__ import annotations

import atexit
import json
import sys
from time import perf_counter, process_time

import numpy as np
from own_process import peak
from petsc4py import PETSc
from skfem import Basis, ElementHex1, ElementVector, MeshHex

import skfem_contact as sc
from skfem_contact.solvers.choice import as_solver
from skfem_contact.solvers.petsc import distributed

#: Elements that are assembled at a time: the solid of all of them takes twice the memory of K.
PART = 10_000


def report(begin: float, row: dict[str, object]) -> None:
    """Print the figures of the process."""
    cpu = process_time() - begin
    row |= {"process": PETSc.COMM_WORLD.rank, "cpu_s": round(cpu, 2)}
    row |= {"gflop": round(PETSc.Log.getFlops() / 1e9, 2), "peak_mb": round(peak())}
    print(json.dumps(row), flush=True)


def main() -> None:
    """Solve, and compare the settlement with the closed form of a column."""
    row: dict[str, object] = {}
    PETSc.Log.begin()
    atexit.register(report, process_time(), row)
    petsc = sc.Petsc()  # the other processes stay here
    times = []

    def clock(name: str) -> None:
        now = perf_counter(), process_time()
        if times:
            row[name] = [round(b - a, 2) for a, b in zip(times[-1], now)]
        times.append(now)

    # assemble in parts
    clock("start")
    side = np.linspace(0.0, 1.0, int(sys.argv[1]) + 1)
    mesh = MeshHex.init_tensor(side, side, side).with_defaults()
    steel = sc.LinearElastic(E=1e4, nu=0.3)
    K = force = 0.0
    for part in np.array_split(np.arange(mesh.nelements), mesh.nelements // PART + 1):
        basis = Basis(mesh, ElementVector(ElementHex1()), intorder=2, elements=part)
        form = sc.SolidForm(basis, steel)
        K = K + form.elastic_stiffness
        force = force + sc.weight(basis, 20.0)
        del form
    fixed = sc.box_supports(Basis(mesh, ElementVector(ElementHex1()), elements=part[:1]))
    free = np.setdiff1d(np.arange(basis.N), fixed)
    clock("assembly")

    # deal out, prepare and solve
    locations = np.repeat(mesh.p, 3, axis=1)
    if "amg" in sys.argv:
        solver = as_solver("amg", locations, free)
    else:
        solver = distributed(petsc, locations, free, displacements=True)
    solve = solver.factor(K, symmetric=True)
    clock("preparation")
    x = solve(force)
    clock("solution")

    # top of a column under its weight: half of weight times height over the oedometer modulus
    settlement = 20.0 / 2.0 / (1e4 * (1 - 0.3) / (1 + 0.3) / (1 - 2 * 0.3))
    error = abs(x.min() / -settlement - 1.0)
    assert error < 1e-6, error
    row |= {"dofs": int(basis.N), "processes": PETSc.COMM_WORLD.size, "error": float(error)}


main()
