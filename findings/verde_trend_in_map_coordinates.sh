#!/usr/bin/env bash
# verde 1.9.0: a plane through levels on a plane misses them by metres in map coordinates.
#
# Expected: `Trend(degree=1)` reproduces levels that lie on a plane, wherever the origin is, to a small
#     part of a millimetre, as numpy's least squares do.
# Seen: 200 levels on a plane within 1 km.  At a local origin the largest error is 1e-13 m.  At
#     easting 500,000 m and northing 5,800,000 m it is 11.4 m.  Degrees 2 and 3, for levels on a
#     paraboloid, have an error of 5.8 m.  No message.  numpy's `lstsq` on the same coordinates has the
#     plane to 1e-10 m.
# Meaning: trends of the ground, of the base of an aquifer and of heads, and the residuals that are
#     gridded afterwards, are wrong in a project in map coordinates.  Subtract an origin first.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    verde==1.9.0 numpy==2.4.6
cat > run.py <<'PY'
import warnings

import numpy as np
import verde

warnings.simplefilter("ignore", FutureWarning)
generator = np.random.default_rng(1)
x, y = generator.uniform(0, 1000, (2, 200))
PLANE = 100 + 0.01 * x + 0.02 * y
BOWL = PLANE - 2e-5 * (x - 500) ** 2 + 3e-5 * y**2


def error(levels, degree, east, north):
    """Largest difference in m between levels and their trend, with the origin moved."""
    points = (x + east, y + north)
    return abs(verde.Trend(degree).fit(points, levels).predict(points) - levels).max()


CASES = (("plane", PLANE, 1, 11.4), ("paraboloid", BOWL, 2, 5.8), ("paraboloid", BOWL, 3, 5.8))
for name, levels, degree, seen in CASES:
    local, mapped = error(levels, degree, 0, 0), error(levels, degree, 5e5, 5.8e6)
    print(f"{name}, degree {degree}: {local:.0e} m at a local origin, {mapped:.1f} m in map coordinates")
    assert local < 1e-9 and abs(mapped - seen) < 0.2

powers = np.column_stack([np.ones(200), x + 5e5, y + 5.8e6])
error = abs(powers @ np.linalg.lstsq(powers, PLANE)[0] - PLANE).max()
print(f"least squares of numpy in map coordinates {error:.0e} m")
assert error < 1e-6
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
