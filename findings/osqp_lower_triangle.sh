#!/usr/bin/env bash
# OSQP 1.1.3, Clarabel 0.11.1, SCS 3.3.1, qdldl 0.1.9: a chain of springs becomes five single springs.
#
# Expected: a symmetric stiffness given by its lower triangle is taken as symmetric, or refused, by
#     solvers that take the full matrix and the upper triangle.
# Seen: five nodes between two fixed ends, springs of 1 and loads of 1, inactive bounds.  From the full
#     matrix and the upper triangle all four find displacements of 2.5, 4, 4.5, 4, 2.5.  From the lower
#     triangle all find 0.5 at every node, with the status "solved": only the entries on and above
#     the diagonal are read, and the coupling is gone.  HiGHS 1.16 wants the lower triangle, and is
#     right with it.
# Meaning: finite element programs and files (Matrix Market, Harwell-Boeing) keep the lower half of
#     symmetric matrices, and a problem of contact moved from HiGHS to another solver has it too.
#     Settlements are then a ninth of the right ones, and contact forces those of loose nodes.
#     Multiply the full matrix by the result, and compare with the load.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    osqp==1.1.3 clarabel==0.11.1 scs==3.3.1 qdldl==0.1.9.post1 highspy==1.16.0 \
    numpy==2.4.6 scipy==1.17.1
cat > run.py <<'PY'
import clarabel
import highspy
import numpy as np
import osqp
import qdldl
import scipy.sparse as sp
import scs

SIZE, BOUND = 5, 1000.0
STIFFNESS = sp.csc_matrix(
    sp.diags([-np.ones(SIZE - 1), 2 * np.ones(SIZE), -np.ones(SIZE - 1)], [-1, 0, 1])
)
LOAD, RIGHT = np.ones(SIZE), np.linalg.solve(STIFFNESS.toarray(), np.ones(SIZE))
ONE = sp.eye(SIZE, format="csc")
# Bounds that no displacement reaches, as rows for Clarabel and SCS.
ROWS, LIMITS = sp.vstack([ONE, -ONE], format="csc"), np.full(2 * SIZE, BOUND)


def by_osqp(matrix):
    solver = osqp.OSQP()
    limit = np.full(SIZE, BOUND)
    solver.setup(matrix, -LOAD, ONE, -limit, limit, verbose=False, eps_abs=1e-9, eps_rel=1e-9)
    result = solver.solve()
    return result.x, result.info.status


def by_clarabel(matrix):
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    cones = [clarabel.NonnegativeConeT(2 * SIZE)]
    result = clarabel.DefaultSolver(matrix, -LOAD, ROWS, LIMITS, cones, settings).solve()
    return result.x, result.status


def by_scs(matrix):
    data = dict(P=matrix, A=ROWS, b=LIMITS, c=-LOAD)
    result = scs.solve(data, dict(l=2 * SIZE), verbose=False, eps_abs=1e-9, eps_rel=1e-9)
    return result["x"], result["info"]["status"]


def by_qdldl(matrix):
    return qdldl.Solver(matrix).solve(LOAD), "no status"


def by_highs(matrix):
    solver, model = highspy.Highs(), highspy.HighsModel()
    solver.silent()
    model.lp_.num_col_ = model.hessian_.dim_ = SIZE
    model.lp_.col_cost_, model.lp_.col_lower_ = -LOAD, np.full(SIZE, -BOUND)
    model.lp_.col_upper_ = np.full(SIZE, BOUND)
    model.lp_.a_matrix_.start_ = np.zeros(SIZE + 1, dtype=int)
    model.hessian_.format_ = highspy.HessianFormat.kTriangular
    model.hessian_.start_, model.hessian_.index_ = matrix.indptr, matrix.indices
    model.hessian_.value_ = matrix.data
    solver.passModel(model)
    solver.run()
    return solver.getSolution().col_value, solver.getModelStatus()


LOWER, UPPER = sp.tril(STIFFNESS, format="csc"), sp.triu(STIFFNESS, format="csc")
for solve in (by_osqp, by_clarabel, by_scs, by_qdldl):
    for name, matrix, seen in (
        ("full", STIFFNESS, RIGHT), ("upper", UPPER, RIGHT), ("lower", LOWER, np.full(SIZE, 0.5))
    ):
        result, status = solve(matrix.copy())
        print(f"{solve.__name__[3:]}, {name}: {np.round(result, 3)}, {status}")
        assert np.allclose(result, seen, atol=1e-4)
result, status = by_highs(LOWER)
print(f"highs, lower: {np.round(result, 3)}, {status}; right {RIGHT}")
assert np.allclose(result, RIGHT, atol=1e-4)
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
