#!/usr/bin/env bash
# pyvista 0.49.1, VTK 9.7.2: between levelling points 5 m apart the settlement is zero.
#
# Expected: `interpolate` of readings on a mesh uses the nearest ones whatever their spacing, so that a
#     uniform settlement of 20 mm is 20 mm everywhere, or missing values are NaN.
# Seen: with readings every 5 m on a grid of 1 m, 1656 of 2116 points have 0 mm and 460 have 20 mm,
#     without a message.  With the coordinates in km all have 20 mm.  Readings beyond the default
#     `radius` of 1 count as none, and the default `null_value` is 0.  With radius=10 all have 20 mm.
# Meaning: the radius is in the unit of the coordinates, and zero is a plausible settlement, pore
#     pressure or thickness: means, differential settlements and volumes are those of an egg box.
#     Give `radius` above the spacing and `null_value=float("nan")`.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    pyvista==0.49.1 vtk==9.7.2 numpy==2.4.6
cat > run.py <<'PY'
import numpy as np
import pyvista as pv

x, y = np.meshgrid(np.arange(0.0, 50, 5), np.arange(0.0, 50, 5))


def settlements(unit, **options):
    """Settlements on a grid of 1 m from readings of 20 mm every 5 m."""
    readings = pv.PolyData(unit * np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)]))
    readings["settlement"] = np.full(x.size, 20.0)
    grid = pv.ImageData(dimensions=(46, 46, 1), spacing=(unit, unit, unit))
    values = grid.interpolate(readings, **options)["settlement"]
    return int((values == 0).sum()), int((abs(values - 20) < 1e-9).sum()), len(values)


default, kilometres, wide = settlements(1.0), settlements(1e-3), settlements(1.0, radius=10)
print("zeros, values of 20 mm, points:", default, "in km", kilometres, "radius=10", wide)
assert default == (1656, 460, 2116)
assert kilometres == wide == (0, 2116, 2116)
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
