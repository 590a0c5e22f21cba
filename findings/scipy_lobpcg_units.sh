#!/usr/bin/env bash
# scipy 1.17.1: LOBPCG returns its start vectors as modes if the stiffness is in a large unit.
#
# Expected: relative accuracy: a matrix in N/m and the same one in MN/m or GN/m have the same modes,
#     and eigenvalues that differ by the factor.
# Seen: for a chain of 200 springs of 1 (unit of force per m) the lowest three eigenvalues are right
#     to 1e-7.  With springs of 1e-3 they are 1.41, 1.10 and 1.07 times the right ones, and with
#     1e-9 they are 7500, 2200 and 1000 times too large, which are the values of the random start.
#     No warning in either case.
# Meaning: the tolerance is compared with the residual as it is (1.5e-8 times the number of rows),
#     and stiff rock in GPa or a mass matrix scaled by the density changes the digits that are
#     right.  Scale the matrix to a diagonal of about one, or give `tol` in the unit of the matrix.
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
from scipy.sparse import diags
from scipy.sparse.linalg import lobpcg

warnings.simplefilter("error")
N = 200
chain = diags([-np.ones(N - 1), 2 * np.ones(N), -np.ones(N - 1)], [-1, 0, 1]).tocsr()
right = 4 * np.sin(np.arange(1, 4) * np.pi / (2 * (N + 1))) ** 2
start = np.random.default_rng(0).standard_normal((N, 3))
for spring, low, high in ((1.0, 1 - 1e-6, 1 + 1e-6), (1e-3, 1.03, 2), (1e-9, 500, 1e5)):
    values, _ = lobpcg(spring * chain, start.copy(), largest=False, maxiter=500)
    ratios = np.sort(values) / (spring * right)
    print(f"springs of {spring:g}: eigenvalues over the right ones {ratios.round(6)}")
    assert (ratios > low).all() and (ratios < high).all()
ritz = np.linalg.eigvalsh(np.linalg.qr(start)[0].T @ chain @ np.linalg.qr(start)[0])
print("Ritz values of the start over the right ones", (ritz / right).round(6))
assert np.allclose(ritz / right, ratios, rtol=1e-6)
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
