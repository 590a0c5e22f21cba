#!/usr/bin/env bash
# pyGEEMs 0.2.1: a slope that withstands the earthquake slides by 12 m, or by 3e22 cm.
#
# Expected: `calc_disp_wla06` (Watson-Lamprey and Abrahamson, 2006) has no displacement, or NaN, where the peak
#     acceleration is below the yield coefficient, as a comment in it says, and the same value for a number and for an
#     array of one.
# Seen: yield coefficient 0.1, magnitude 7, spectral acceleration at 1 s 0.8 of the peak acceleration.  For peak
#     accelerations of 0.05, 0.06 and 0.07 g the displacements are 1165 cm, 1.6e9 cm and 3e22 cm as numbers, NaN as
#     arrays.  For 0.11, 0.15 and 0.2 g, where the slope moves, they are NaN as numbers, and 0.006, 0.25 and
#     1.06 cm as arrays.  From 0.3 g on both agree.  No message.
# Meaning: for a number the logarithm of the displacement is compared with the yield coefficient, in place of the
#     peak acceleration; the formula has poles below the yield coefficient.  A loop over stations makes safe slopes fail
#     and drops small displacements; means and hazard curves of either are wrong.  Pass arrays.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    pyGEEMs==0.2.1 numpy==1.26.4 scipy==1.13.1 numba==0.60.0
cat > run.py <<'PY'
import numpy as np
from pygeems.slope_disp import calc_disp_wla06

YIELD, MAGNITUDE = 0.1, 7.0
for peak, number_seen, array_seen in (
    (0.05, 1165.06, np.nan),
    (0.06, 1.56905e9, np.nan),
    (0.07, 3.11410e22, np.nan),
    (0.11, np.nan, 0.0064632),
    (0.15, np.nan, 0.254227),
    (0.20, np.nan, 1.05990),
    (0.30, 4.08999, 4.08999),
    (0.40, 8.91526, 8.91526),
):
    spectral = 0.8 * peak
    number = float(calc_disp_wla06(YIELD, peak, spectral, MAGNITUDE))
    array = float(calc_disp_wla06(YIELD, np.array([peak]), np.array([spectral]), MAGNITUDE)[0])
    print(f"peak {peak} g, yield {YIELD} g: {number:.4g} cm as a number, {array:.4g} cm as an array")
    assert np.allclose((number, array), (number_seen, array_seen), rtol=1e-4, equal_nan=True)
    assert np.isnan(array) == (peak < YIELD)
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
