#!/usr/bin/env bash
# geotech 0.1.0a1: the pore pressure below a water table is the level of the table, at any depth.
#
# Expected: `WaterTable(level, gradient).sample(elevation)` is a sample of the pore pressure at the elevation, as its
#     base class says: the weight of water, 9.81 kN/m3, an attribute of that class, times the depth below the water.
# Seen: water at 105 m, no gradient. 105.0 at 105 m, at 100 m and at 80 m; right are 0, 49 and 245 kPa. With all
#     levels less 100 m: 5.0 at 5, 0 and -20 m. With a gradient of 0.2 m/m: 105.2 at 80 m. No message.
# Meaning: level and gradient are added, and neither the elevation nor the weight of water is used. A stress less this
#     pressure depends on the datum of the levels, and no layer has a gradient. Sample the level alone, and compute
#     the pressure from it.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    geotech==0.1.0a1 numpy==2.4.6
cat > run.py <<'PY'
from geotech.soil import Constant, WaterTable

DEPTHS = (0.0, 5.0, 25.0)  # m below the water table


def pressures(level, gradient):
    """Pore pressures by the library at the depths below a water table."""
    table = WaterTable(Constant(level), Constant(gradient))
    return [table.sample(level - depth) for depth in DEPTHS], table.water_unit_weight


for level in (105.0, 5.0):
    found, weight = pressures(level, 0.0)
    right = [weight * depth for depth in DEPTHS]
    print(f"water at {level} m: {found}, right {[round(pressure, 1) for pressure in right]} kPa")
    assert found == [level] * 3 and weight == 9.81
found, _ = pressures(105.0, 0.2)
print(f"with a gradient of 0.2: {found}")
assert found == [105.2] * 3
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
