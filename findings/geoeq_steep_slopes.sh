#!/usr/bin/env bash
# geoeq 0.1.3: the steeper the slope, the safer.
#
# Expected: `taylor_stability` follows Taylor's chart to some per cent: the stability number rises from
#     0.181 for a deep circle in clay to 0.191 at 60 degrees and 0.261 for a vertical cut, and the
#     factor of safety falls.
# Seen: for clay (50 kPa, 20 kN/m3, 10 m) the factor is 1.51 at 25 degrees, 1.72 at 60 and 1.97 at 90.
#     A vertical cut has 0.96, as a circle proves that passes its toe.  With friction it is the other way:
#     a slope of 2:1 with 10 kPa and 20 degrees has 0.44, where the chart and Bishop's method have 1.38.
#     The friction counts in the number alone, and the number falls with the angle.
# Meaning: the numbers are a linear fit that has the wrong sign for the angle.  A cut that stands by this
#     function may fall, and a safe embankment seems to slide.  Use a method of slices.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    geoeq==0.1.3 numpy==2.4.6
cat > run.py <<'PY'
import numpy as np
from geoeq.design import taylor_stability


def circles(angle, cohesion, friction, weight=20.0, height=10.0):
    """Least factor after Bishop of circles from the toe (0, 0) to the ground behind the crest."""
    slope, tangent, best = np.radians(angle), np.tan(np.radians(friction)), np.inf
    crest = height / np.tan(slope)
    for end in crest + height * np.linspace(0.05, 1.5, 20):
        chord, tilt = np.hypot(end, height), np.arctan2(height, end)
        for radius in chord / 2 * np.geomspace(1.001, 20, 40):
            offset = np.sqrt(radius**2 - chord**2 / 4)
            centre = np.array([end, height]) / 2 + offset * np.array([-np.sin(tilt), np.cos(tilt)])
            if centre[1] < height:
                continue
            x = (np.arange(200) + 0.5) * end / 200
            base = centre[1] - np.sqrt(radius**2 - (x - centre[0]) ** 2)
            ground = np.clip(x * np.tan(slope), 0, height)
            mass = weight * np.maximum(ground - base, 0) * end / 200
            sine = (x - centre[0]) / radius
            driving, factor = (mass * sine).sum(), 1.0
            for _ in range(20 if driving > 0 else 0):
                arm = np.sqrt(1 - sine**2) + sine * tangent / factor
                factor = ((cohesion * end / 200 + mass * tangent) / arm).sum() / driving
            if driving > 0:
                best = min(best, factor)
    return best


# The deep circle that governs a flat slope in clay touches the firm base: Taylor's 0.181.
CASES = (
    (25, 50, 0, 1.506, 1.38), (60, 50, 0, 1.724, 1.31), (90, 50, 0, 1.969, 0.96),
    (26.565, 10, 20, 0.443, 1.38),
)
for angle, cohesion, friction, seen, chart in CASES:
    factor = taylor_stability(friction, cohesion, 20, 10, angle)["FS"]
    found = circles(angle, cohesion, friction)
    print(f"{angle} degrees, {cohesion} kPa, {friction} degrees: {factor:.2f}, chart {chart}, "
          f"best toe circle {found:.2f}")
    assert abs(factor - seen) < 0.002
    if angle != 25:
        assert abs(found - chart) < 0.02
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
