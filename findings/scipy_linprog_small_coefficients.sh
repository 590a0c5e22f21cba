#!/usr/bin/env bash
# scipy 1.17.1 (HiGHS): a limit is left out if its coefficients are below 1e-9, with success.
#
# Expected: an optimum does not depend on the unit of a constraint, since the solver scales its rows;
#     otherwise it fails or warns.
# Seen: settlements of two footings that grow by 1 and 2 per load are limited to 3.  With
#     coefficients and limits times 1, 1e-6, 1e-8 or 2e-9 the loads are 1 and 1.  Times 1e-9 they
#     are 1.5 and 1.5, as the smaller coefficient of each row is gone, and times 1e-10 they are 100
#     and 100, the bound of the unknowns.  The status is 0, success.
# Meaning: entries of at most 1e-9 are set to zero when the model is read.  Flexibilities in m/N of
#     stiff ground and permeabilities in m/s are smaller: wells or loads that a program of
#     optimisation finds then ignore the settlements or heads, in part or altogether.  Scale the
#     rows to about one, and insert the result into the limits.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1
cat > run.py <<'PY'
import numpy as np
from scipy.optimize import linprog

FLEXIBILITY = np.array([[1.0, 2.0], [2.0, 1.0]])


def loads(unit):
    """The largest sum of two loads whose settlements are limited, in a unit of the settlements."""
    result = linprog([-1, -1], A_ub=unit * FLEXIBILITY, b_ub=unit * np.full(2, 3.0),
                     bounds=[(0, 100)] * 2)
    return result.x, result.status, (FLEXIBILITY @ result.x).max() / 3


for unit, right in ((1, 1), (1e-6, 1), (1e-8, 1), (2e-9, 1), (1e-9, 1.5), (1e-10, 100), (1e-12, 100)):
    x, status, use = loads(unit)
    print(f"unit {unit:.0e}: status {status}, loads {x}, settlement {use:.2f} of the limit")
    assert status == 0 and np.allclose(x, right)
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
