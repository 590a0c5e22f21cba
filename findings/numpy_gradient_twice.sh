#!/usr/bin/env bash
# numpy 2.4.6: the bending moment at the foot of a wall is half the right one, on any mesh.
#
# Expected: `gradient` of `gradient` of a deflection is less accurate at the ends, with an error
#     that goes to zero with the spacing.
# Seen: for a clamped wall of 10 m under a uniform load the moment at the foot is 0.452 of the right
#     one with 21 points, 0.495 with 201 and 0.4995 with 2001, and its neighbour tends to 0.75.  The
#     one-sided difference at the end, taken twice, gives half of the second derivative at any
#     spacing.  With `edge_order=2` the ratios are 0.926, 0.993 and 0.999.
# Meaning: moments from readings of an inclinometer, and curvatures of a settlement trough at a
#     wall, are half of the true ones just where they are largest, and a finer mesh seems to confirm
#     them.  Use `edge_order=2`, or a fit whose second derivative is known.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6
cat > run.py <<'PY'
import numpy as np

LENGTH, LOAD, STIFFNESS = 10.0, 20e3, 1e8
right = LOAD * LENGTH**2 / 2


def moment(points, edge_order):
    """Moments of a wall that is clamped at z = 0, from its exact deflection."""
    z = np.linspace(0, LENGTH, points)
    deflection = LOAD / (24 * STIFFNESS) * (z**4 - 4 * LENGTH * z**3 + 6 * LENGTH**2 * z**2)
    slope = np.gradient(deflection, z, edge_order=edge_order)
    return STIFFNESS * np.gradient(slope, z, edge_order=edge_order)


for points in (21, 201, 2001):
    ratios = moment(points, 1)[:2] / right
    better = moment(points, 2)[0] / right
    print(f"{points} points: foot {ratios[0]:.4f}, next {ratios[1]:.4f}, edge_order=2 {better:.4f}")
    assert abs(ratios[0] - 0.5) < 2 / points and abs(ratios[1] - 0.75) < 3 / points
    assert abs(better - 1) < 2 / points
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
