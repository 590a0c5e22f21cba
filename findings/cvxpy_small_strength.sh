#!/usr/bin/env bash
# cvxpy 1.9.3 with Clarabel 0.11.1, OSQP 1.1.3 and SCS 3.3.1: twice the collapse load, "optimal".
#
# Expected: a limit load is proportional to the strength, in any unit, for solvers that scale their
#     problem; a solution that is not one has the status "optimal_inaccurate".
# Seen: three bars that hold a load, with a strength of 1 in the unit of the input: all three find
#     the limit load to 1e-5.  With 1e-6 Clarabel is right to 0.05 %, SCS finds 2.12 times the
#     limit load and OSQP -0.01 of it.  With 1e-8 Clarabel is 3.5 % above, with 1e-9 29 % above.
#     All have the status "optimal".  With a strength of 1e8 all three are right.
# Meaning: the tolerances of the solvers have an absolute part, in the unit of the input.  1 kPa in
#     GPa is 1e-6: weak layers beside rock and joints with little cohesion then carry more than
#     they can, on the unsafe side.  Scale strengths to about one, and insert the stresses into the
#     yield criterion.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    cvxpy==1.9.3 clarabel==0.11.1 osqp==1.1.3 scs==3.3.1 numpy==2.4.6 scipy==1.17.1
cat > run.py <<'PY'
import cvxpy as cp

COS = 0.5**0.5
RIGHT = 1 + 2 * COS
SOLVERS = ("CLARABEL", "OSQP", "SCS")


def limit_load(strength, solver):
    """Limit load over the right one, and the status, for one upright and two inclined bars."""
    force, load = cp.Variable(3), cp.Variable()
    equilibrium = [COS * force[0] + force[1] + COS * force[2] == load, force[0] == force[2]]
    problem = cp.Problem(cp.Maximize(load), [*equilibrium, cp.abs(force) <= strength])
    problem.solve(solver=solver)
    return float(load.value) / (RIGHT * strength), problem.status


found = {}
for strength in (1e8, 1.0, 1e-6, 1e-8, 1e-9):
    for solver in SOLVERS:
        found[strength, solver], status = limit_load(strength, solver)
        assert status == "optimal"
    print(f"strength {strength:.0e}:",
          ", ".join(f"{solver} {found[strength, solver]:.4f}" for solver in SOLVERS))
assert all(abs(found[s, solver] - 1) < 1e-4 for s in (1e8, 1.0) for solver in SOLVERS)
assert abs(found[1e-6, "CLARABEL"] - 1) < 2e-3
assert found[1e-6, "SCS"] > 1.8 and found[1e-6, "OSQP"] < 0.5
assert found[1e-8, "CLARABEL"] > 1.02 and found[1e-9, "CLARABEL"] > 1.2
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
