#!/usr/bin/env bash
# scipy 1.17.1: the curve through deflections of a wall depends on whether they are in m or mm.
#
# Expected: `UnivariateSpline(depth, deflection)` is the same curve for readings in m and in mm, and
#     passes through smooth readings or close to them.
# Seen: for 41 readings of a wall that bulges by 20 mm, the curve in m is one cubic over 20 m, off
#     by 9.2 mm, and the largest moment is 0.07 of the right one.  In mm the error is 2.1 mm and the
#     moment 0.67.  The default bounds the sum of squared residuals by the number of readings, in
#     the square of the unit: misfits of 1 m are accepted.  `s=0` gives the same curve in both
#     units.
# Meaning: a back-analysis of moments from an inclinometer changes with the unit of the file, with
#     no message.  Give `s` as the number of readings times the square of their scatter.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1
cat > run.py <<'PY'
import numpy as np
from scipy.interpolate import UnivariateSpline

depth = np.linspace(0, 20, 41)
deflection = 0.02 * np.exp(-(((depth - 10) / 3) ** 2))
curvature = -0.02 * 2 / 3**2
seen = []
for smoothing in (None, 0):
    for unit, factor in (("m", 1), ("mm", 1000)):
        spline = UnivariateSpline(depth, factor * deflection, s=smoothing)
        pieces = len(spline.get_knots()) - 1
        error = abs(spline(depth) / factor - deflection).max()
        ratio = float(spline.derivative(2)(10.0)) / factor / curvature
        print(f"s={smoothing} {unit}: {pieces} pieces, error {1000 * error:.2f} mm, moment {ratio:.3f}")
        seen.append((pieces, 1000 * error, ratio))
metres, millimetres, exact, exact_too = seen
assert metres[0] == 1 and metres[1] > 8 and abs(metres[2] - 0.073) < 0.02
assert millimetres[0] == 5 and millimetres[1] < 3 and abs(millimetres[2] - 0.67) < 0.05
assert np.allclose(exact, exact_too, atol=1e-6) and abs(exact[2] - 1.014) < 0.01
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
