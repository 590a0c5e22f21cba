#!/usr/bin/env bash
# xarray-spatial 0.5.3: a hillside of 27 degrees has 68 degrees after its terrain model is coarsened.
#
# Expected: `slope` uses the coordinates of the grid; a plane has the same slope on a coarser grid of means.
# Seen: a plane that rises by 1 in 2, on a grid of 10 m with its coordinates and the attribute `res` of (10, 10),
#     which the description of `curvature` asks for.  26.57 degrees, right.  After `coarsen(x=5, y=5).mean()`, and
#     after `[::5, ::5]`, xarray keeps the attribute and has coordinates every 50 m: 68.20 degrees.  Without the
#     attribute: 26.57 degrees.  A dome with a radius of 200 m has 25 times its curvature.  No message.
# Meaning: the attribute wins over the coordinates, without a comparison of the two.  An infinite slope with 35
#     degrees of friction has a factor of safety of 0.28 in place of 1.40; maps of hazard of large regions, made
#     from coarser models, are red.  Drop `res` after each change of the grid.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    xarray-spatial==0.5.3 xarray==2026.9.0 numpy==2.4.6
cat > run.py <<'PY'
import numpy as np
import xarray
from xrspatial import curvature, slope

CELL, RISE, FRICTION, RADIUS = 10.0, 0.5, 35.0, 200.0  # m, -, degrees, m

x = np.arange(CELL / 2, 1000, CELL)


def terrain(level):
    """Model of 1 km x 1 km with coordinates, from north to south, and with the size of its cells."""
    across, up = np.meshgrid(x, x[::-1])
    return xarray.DataArray(
        level(across, up), dims=["y", "x"], coords={"y": x[::-1], "x": x}, attrs={"res": (CELL, CELL)}
    )


def middle(grid):
    """Value of a cell in the middle."""
    return float(grid[grid.shape[0] // 2, grid.shape[1] // 2])


hillside = terrain(lambda across, up: RISE * across)
coarse = {"means of 5 x 5": hillside.coarsen(x=5, y=5).mean(), "every fifth cell": hillside[::5, ::5]}
right = np.degrees(np.arctan(RISE))
assert "`res` attribute" in curvature.__doc__
print(f"10 m: {middle(slope(hillside)):.2f} degrees, right {right:.2f}")
assert abs(middle(slope(hillside)) - right) < 0.01
for name, grid in coarse.items():
    assert np.allclose(np.diff(grid.x), 5 * CELL)
    found, dropped = middle(slope(grid)), middle(slope(grid.drop_attrs()))
    safety = [np.tan(np.radians(FRICTION)) / np.tan(np.radians(angle)) for angle in (found, right)]
    print(f"{name}: {found:.2f} degrees, without `res` {dropped:.2f}; factor of safety {safety[0]:.2f}, "
          f"right {safety[1]:.2f}")
    assert abs(np.tan(np.radians(found)) - 5 * RISE) < 0.01 and abs(dropped - right) < 0.01

# curvature in hundredths, as the description says: 2 / radius for a dome, in both directions together
dome = terrain(lambda across, up: -((across - 500) ** 2 + (up - 500) ** 2) / (2 * RADIUS))
fine, rough = (middle(curvature(grid)) for grid in (dome, dome[::5, ::5]))
print(f"dome: curvature {fine:.3f}, on the coarser grid {rough:.3f}, right {200 / RADIUS:.3f}")
assert abs(fine - 200 / RADIUS) < 0.01 and abs(rough - 25 * fine) < 0.1
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
