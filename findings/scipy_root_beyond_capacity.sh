#!/usr/bin/env bash
# scipy 1.17.1: a load of 120 % of the capacity is in equilibrium, with success.
#
# Expected: `root` says success if the function is zero to its tolerance, with each of its methods.
# Seen: a foundation with the resistance tanh(u) under the load 1.2.  `method="lm"` returns success at
#     u = 13.3 with a residual of -0.2.  Two springs in series with an inclined load: success, with
#     residuals of 0.10 and -0.51.  "hybr", "df-sane" and "broyden1" do not.  Success of "lm" means
#     that the sum of squares does not fall any more.
# Meaning: a limit analysis by raising the load until `success` is false finds no limit, and the
#     displacement looks like a result.  Wall, slope and pile equations behave alike.  Compare `fun` with
#     the load.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    scipy==1.17.1 numpy==2.4.6
cat > run.py <<'PY'
import warnings

import numpy as np
from scipy.optimize import root

warnings.simplefilter("ignore")


def foundation(load):
    """Out-of-balance force of a foundation with a capacity of 1."""
    return lambda u: np.tanh(u) - load


for method in ("lm", "hybr", "df-sane", "broyden1"):
    for load in (0.8, 1.2):
        result = root(foundation(load), [0.1], method=method)
        residual = float(np.ravel(result.fun)[0])
        print(f"{method}, load {load}: success {result.success}, u = {result.x[0]:.3g}, "
              f"residual {residual:.3f}")
        assert result.success == (load < 1 or method == "lm")
        assert abs(residual - min(1 - load, 0)) < 1e-4


def frame(u):
    """Forces on two springs with capacities 1 and 1.2 minus the load (1, 1.5)."""
    return [u[0] + 0.5 * u[1] - 1, np.tanh(u[1]) + 0.2 * np.tanh(u[0]) - 1.5]


result = root(frame, [0, 0], method="lm")
print(f"two springs: success {result.success}, residuals {np.round(result.fun, 2)}")
assert result.success and np.allclose(result.fun, [0.10, -0.51], atol=0.01)
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
