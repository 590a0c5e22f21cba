#!/usr/bin/env bash
# geostatspy 0.0.79: the variogram of a grid is moved by one cell, and that of one row is empty.
#
# Expected: `gam`, "GSLIB's GAM program", gives for each lag its distance and the semivariogram there: for values that
#     rise by 1 per m it is h^2 / 2, and the first lag is one cell.
# Seen: cells of 2 m: distances 0, 2, 4, 6 m with 2, 8, 18, 32 in place of 0, 2, 8, 18.  `gam_1D` the same.  For a
#     field with an exponential covariance of 12 m the range by least squares is 6.7 m from the lags as given and 11.9 m
#     from lags moved by a cell.  A profile of one row as an array of two dimensions has zeros and no pairs; the first
#     row of a map never counts as the end of a pair.  No message.
# Meaning: scale of fluctuation and range are too short by more than a cell, here by half.  Fields with them
#     vary too fast and means over a footing are too sure.  Add one cell to the lags; of a single row use `gam_1D`.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    geostatspy==0.0.79 numpy==2.4.6 scipy==1.17.1 pandas==2.3.3 statsmodels==0.15.0 numba==0.68.1 tqdm==4.70.1
cat > run.py <<'PY'
import numpy as np
from geostatspy import geostats
from scipy.optimize import curve_fit

CELL, LAGS, LIMITS = 2.0, 4, (-1e9, 1e9)  # m


def by_hand(row):
    """Semivariogram of a row with the distances of its lags."""
    steps = range(1, LAGS + 1)
    return np.array([(k * CELL, np.mean((row[k:] - row[:-k]) ** 2) / 2) for k in steps]).T


rising = CELL * np.arange(40.0)  # values that rise by 1 per m
grid = np.tile(rising, (10, 1))
distance, right = by_hand(rising)
for name, (lags, found, pairs) in (
    ("grid", geostats.gam(grid, *LIMITS, CELL, CELL, 1, 0, LAGS, 0)),
    ("one row by gam_1D", geostats.gam_1D(rising, *LIMITS, CELL, 1, LAGS, 0)),
):
    print(f"{name}: lags {lags}, semivariogram {found}; right is {right} at {distance}")
    assert np.allclose(found, right) and np.allclose(found, distance**2 / 2)
    assert np.allclose(lags, distance - CELL)

_, empty, pairs = geostats.gam(grid[:1], *LIMITS, CELL, CELL, 1, 0, LAGS, 0)
print("one row by gam:", empty, "pairs:", pairs)
assert not pairs.any() and not empty.any()
_, _, pairs = geostats.gam(grid, *LIMITS, CELL, CELL, 1, 0, LAGS, 0)
assert pairs[0] == (len(grid) - 1) * (len(rising) - 1)  # a row of ten is missing

# Rows of an autoregressive process: covariance exp(-3 h / range), the definition of the library.
RANGE, LENGTH, ROWS = 12.0, 400, 400
rho = np.exp(-3 * CELL / RANGE)
random = np.random.default_rng(5).normal(size=(ROWS, LENGTH))
field = random.copy()
for column in range(1, LENGTH):
    field[:, column] = rho * field[:, column - 1] + np.sqrt(1 - rho**2) * random[:, column]
lags, found, _ = geostats.gam(field, *LIMITS, CELL, CELL, 1, 0, 12, 0)


def model(h, sill, reach):
    """Exponential semivariogram."""
    return sill * (1 - np.exp(-3 * h / reach))


for name, h, seen in (("as given", lags, 6.73), ("moved by a cell", lags + CELL, RANGE)):
    (_, reach), _ = curve_fit(model, h, found, p0=(1.0, 10.0))
    print(f"range by least squares, lags {name}: {reach:.2f} m, right {RANGE} m")
    assert abs(reach - seen) < 0.3
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
