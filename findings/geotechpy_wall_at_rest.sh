#!/usr/bin/env bash
# geotechpy 0.0.4: cohesion adds to the pressure at rest, at the bottom of each layer and not at its top.
#
# Expected: the pressure at rest is K0 times the effective vertical stress; cohesion has no part in it.
# Seen: a basement wall of 6 m in soil of 19 kN/m3 and 25 degrees.  Without cohesion the force is 198.3 kN/m, right is
#     197.5 (K0 is rounded to 0.58).  With 20 kPa it is 289.8 kN/m, and the pressure at the base is 96.6 in place of
#     66.1 kPa.  In two layers alike the pressure in the middle is 63.5 kPa above the border and 33.1 kPa below it.
# Meaning: `calculate_bottom_lateral_pressure` adds 2 c times the root of the coefficient for all but the active case,
#     `calculate_top_lateral_pressure` has an exception for the case at rest.  The force jumps by c sqrt(K0) h, half as
#     much again in stiff clay.  Set the cohesion to zero before `calculate_at_rest_all`, and keep the profile for the
#     active and passive cases apart.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    geotechpy==0.0.4 numpy==2.4.6 pandas==2.3.3 matplotlib==3.10.8
cat > run.py <<'PY'
import math

import pandas as pd
from geotechpy.lateral_earth_pressure import LateralEarthPressure
from geotechpy.soil_profile import SoilProfile

HEIGHT, WEIGHT, ANGLE = 6.0, 19.0, 25.0  # m, kN/m3, degrees


def at_rest(cohesion, count):
    """Pressures and forces at rest of a wall in one soil, given as several layers."""
    thickness = HEIGHT / count
    frame = pd.DataFrame([
        {
            "layer_id": str(i), "top_elevation": HEIGHT - i * thickness,
            "bottom_elevation": HEIGHT - (i + 1) * thickness, "moist_unit_weight": WEIGHT,
            "saturated_unit_weight": WEIGHT, "drained_friction_angle": ANGLE, "drained_cohesion": cohesion,
        }
        for i in range(count)
    ])
    frame = SoilProfile(frame, 0.0, -20.0, "metric").calculate_all()
    return LateralEarthPressure(frame, 0.0, 0.0, 0.0, "metric").calculate_at_rest_all(1.0)


rest = 1 - math.sin(math.radians(ANGLE))
right = rest * WEIGHT * HEIGHT**2 / 2
print(f"right: {right:.1f} kN/m, {rest * WEIGHT * HEIGHT:.1f} kPa at the base")
for cohesion in (0.0, 10.0, 20.0):
    for count in (1, 2, 6):
        frame = at_rest(cohesion, count)
        force, rounded = frame["at_rest_force"].sum(), frame["at_rest_coefficient"][0]
        base = frame["bottom_at_rest_pressure"].iloc[-1]
        print(f"cohesion {cohesion} kPa, layers {count}: {force:.1f} kN/m, {base:.1f} kPa at the base")
        added = cohesion * math.sqrt(rounded)
        assert abs(rounded - rest) < 5e-3 and abs(force / right - 1 - added * HEIGHT / right) < 1e-2
        assert abs(base - rounded * WEIGHT * HEIGHT - 2 * added) < 0.2
        if count > 1:
            above, below = frame["bottom_at_rest_pressure"][0], frame["top_at_rest_pressure"][1]
            print(f"    at the first border: {above:.1f} kPa above, {below:.1f} kPa below")
            assert abs(above - below - 2 * added) < 0.2
PY
OMP_NUM_THREADS=1 MPLBACKEND=Agg venv/bin/python run.py
