#!/usr/bin/env bash
# openquake-engine 3.26.2: the water in a saturated slope lifts the soil, but has no weight.
#
# Expected: `infinite_slope_fs` takes the dry density and the saturated share of a layer, and weighs the soil with the
#     water in its pores.
# Seen: 2.5 m of soil (35 degrees, 4 kPa, porosity 0.43, 1510 kg/m3 dry) on a slope of 20 degrees.  Dry: 2.240, as by
#     hand.  Half saturated: 1.603, by hand 1.643.  Saturated: 0.966, by hand 1.178.  It is the factor of soil
#     that keeps its dry weight.
# Meaning: the pore pressure is taken from the weight of dry soil, so that slopes that stand count as failed before
#     the earthquake, and get the smallest critical acceleration and metres of displacement.  Pass the
#     density of the soil with its water in place of the dry one, for each state of the ground water.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    --no-deps openquake-engine==3.26.2 numpy==2.4.6
cat > run.py <<'PY'
import numpy as np
from openquake.sep.landslide.static_safety_factor import infinite_slope_fs

SLOPE, FRICTION, COHESION, THICKNESS = np.tan(np.radians(20)), 35.0, 4e3, 2.5  # m/m, deg, Pa, m
SOLIDS, POROSITY, WATER, GRAVITY = 2650.0, 0.43, 1000.0, 9.81  # kg/m3, -, kg/m3, m/s2


def by_hand(saturation, water):
    """Factor of safety; the water in the soil weighs nothing with `water` = 0."""
    dry = (1 - POROSITY) * SOLIDS
    weight = GRAVITY * THICKNESS * (dry + water * saturation * POROSITY * WATER)
    pore = GRAVITY * THICKNESS * saturation * WATER
    angle = np.arctan(SLOPE)
    strength = COHESION + (weight - pore) * np.cos(angle) * np.tan(np.radians(FRICTION))
    return strength / (weight * np.sin(angle))


for saturation, factor in ((0.0, 2.262), (0.5, 1.652), (1.0, 1.179)):
    seen = infinite_slope_fs(
        SLOPE, COHESION, FRICTION, saturation, THICKNESS, (1 - POROSITY) * SOLIDS
    )
    right, weightless = by_hand(saturation, 1), by_hand(saturation, 0)
    print(f"saturated share {saturation}: factor of safety {seen:.3f}, by hand {right:.3f}")
    assert abs(seen - weightless) < 1e-9
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
