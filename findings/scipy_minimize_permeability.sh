#!/usr/bin/env bash
# scipy 1.17.1: a back-analysis of the permeability returns its first guess, with success.
#
# Expected: `minimize` finds a permeability of 1e-9 m/s from a noise-free falling-head test, or says
#     that it failed.
# Seen: started at 5e-10 m/s with bounds (L-BFGS-B), it returns 5e-10 m/s with success after one
#     iteration, with heads that are off by up to 2.5 m of 10 m, and without a warning.  BFGS
#     without bounds returns the same with success False.  With the logarithm as unknown the result
#     is right.
# Meaning: derivatives are differences over an absolute step of about 1e-8, ten times the unknown
#     itself.  Permeabilities, compliances in 1/Pa and coefficients of consolidation in m2/s are
#     "confirmed" wherever the search starts.  Use logarithms or scaled unknowns.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1
cat > run.py <<'PY'
import warnings

import numpy as np
from scipy.optimize import minimize

time = np.linspace(60, 6000, 30)
RIGHT = 1e-9


def heads(permeability):
    """Heads of a falling-head test: 10 m, a rate of permeability over 3e-6 m."""
    return 10 * np.exp(-permeability * time / 3e-6)


def misfit(unknown):
    """Sum of squared differences from the readings in m2."""
    return ((heads(unknown[0]) - heads(RIGHT)) ** 2).sum()


warnings.simplefilter("error")
plain = minimize(misfit, [5e-10], bounds=[(1e-12, 1e-6)])
error = abs(heads(plain.x[0]) - heads(RIGHT)).max()
print(f"bounds: success {plain.success}, k = {plain.x[0]:.3e} m/s, largest error {error:.2f} m")
assert plain.success and abs(plain.x[0] / 5e-10 - 1) < 1e-6 and error > 2
with np.errstate(all="ignore"):
    bfgs = minimize(misfit, [5e-10])
print(f"BFGS: success {bfgs.success}, k = {bfgs.x[0]:.3e} m/s")
assert not bfgs.success and abs(bfgs.x[0] / 5e-10 - 1) < 1e-6
scaled = minimize(lambda x: misfit(10**x), [np.log10(5e-10)], bounds=[(-12, -6)])
print(f"logarithm: success {scaled.success}, k = {10 ** scaled.x[0]:.3e} m/s")
assert scaled.success and abs(10 ** scaled.x[0] / RIGHT - 1) < 1e-3
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
