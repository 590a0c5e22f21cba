#!/usr/bin/env bash
# casadi 3.8.2: behind the last point of a retention curve, the soil contains less than no water.
#
# Expected: `interpolant` refuses a suction outside its table, returns NaN, or keeps the last value.
# Seen: a table of the water content at suctions of 0, 10, 20 and 30 kPa (0.40, 0.30, 0.15, 0.05).
#     "linear" continues with the last slope: -0.05 at 40 kPa, -0.65 at 100 kPa, and 0.50 at -10 kPa
#     for a porosity of 0.40.  "bspline" through the same table has 0 outside, and so 0.000 at
#     -0.001 kPa, next to 0.400 at 0: a saturated soil is dry.  No message from either.
# Meaning: two plugins of one function have two rules beyond the table, and neither keeps the last
#     value.  A solver visits such points on its way, and a water table that rises over a point makes
#     its suction negative.  Extend every table by flat pieces to where the solver can go.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    casadi==3.8.2 numpy==2.4.6
cat > run.py <<'PY'
import casadi as ca
import numpy as np

SUCTIONS, WATER = [0.0, 10.0, 20.0, 30.0], [0.40, 0.30, 0.15, 0.05]
ASKED = [-10.0, -0.001, 0.0, 15.0, 30.0, 30.001, 40.0, 100.0]
SEEN = {
    "linear": [0.50, 0.40, 0.40, 0.225, 0.05, 0.05, -0.05, -0.65],
    "bspline": [0.0, 0.0, 0.40, 0.225, 0.05, 0.0, 0.0, 0.0],
}
print("suction", ASKED)
for kind, seen in SEEN.items():
    curve = ca.interpolant("curve", kind, [SUCTIONS], WATER)
    found = [float(curve(suction)) for suction in ASKED]
    print(kind, np.round(found, 4))
    assert np.allclose(found, seen, atol=1e-3)
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
