#!/usr/bin/env bash
# geotech-staff-engineer 5.33.0: varved clay deep below a footing gets half of the stress of Westergaard.
#
# Expected: `westergaard_rectangular` is the integral of the point load of Westergaard (1938) over a rectangle,
#     Q eta / (2 pi z^2) / (eta^2 + (r / z)^2)^1.5 with eta^2 = (1 - 2 nu) / (2 - 2 nu).  The usual choice is nu = 0,
#     eta^2 = 0.5, which gives the smallest pressure of all nu below the centre.
# Seen: below the centre of 3 m x 3 m under 200 kPa it is 66.7 kPa at 1.5 m, 25.6 at 3 m and 7.5 at 6 m; the integral
#     and the closed form give 92.9, 43.3 and 14.2 kPa.  The formula is the one with eta^2 = 1, which no Poisson's
#     ratio has, and it tends to one half of the right stress at depth.
# Meaning: settlements by `method="westergaard"` are a third to a half too small, deep layers most, and the docstring
#     names Westergaard without more.  Multiply by the ratio below, or integrate the point load.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    --no-deps geotech-staff-engineer==5.33.0 numpy==2.4.6
cat > run.py <<'PY'
import math

import numpy as np
from settlement.stress_distribution import stress_at_depth

PRESSURE, SIDE = 200.0, 3.0  # kPa, m


def integral(depth, square):
    """Stress below the centre of a square footing by the point load; `square` is eta^2."""
    points, weights = np.polynomial.legendre.leggauss(200)
    x = SIDE / 2 * points
    area = np.outer(weights, weights) * (SIDE / 2) ** 2
    r2 = x[:, None] ** 2 + x**2
    kernel = math.sqrt(square) / (2 * math.pi * depth**2) / (square + r2 / depth**2) ** 1.5
    return PRESSURE * (kernel * area).sum()


def closed(depth):
    """The closed form for nu = 0, four corners of a quarter."""
    m = SIDE / 2 / depth
    return 4 * PRESSURE / (2 * math.pi) * math.atan(m * m / math.sqrt(0.5 * (m * m + m * m) + 0.25))


for depth in (0.3, 1.5, 3.0, 6.0, 12.0, 60.0):
    found = stress_at_depth(PRESSURE, SIDE, SIDE, depth, method="westergaard")
    right, odd = integral(depth, 0.5), integral(depth, 1.0)
    print(f"{depth} m: {found:.2f} kPa, right {right:.2f} kPa, ratio {found / right:.3f}; with eta^2 = 1 {odd:.2f}")
    assert math.isclose(right, closed(depth), rel_tol=1e-3) and math.isclose(found, odd, rel_tol=1e-3)
    # A larger Poisson's ratio has a smaller eta^2.  No value gives as little as the library.
    least = min(integral(depth, (1 - 2 * nu) / (2 - 2 * nu)) for nu in np.linspace(0.0, 0.45, 10))
    assert found < 0.95 * least
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
