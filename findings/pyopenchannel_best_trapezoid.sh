#!/usr/bin/env bash
# pyopenchannel 0.6.0: the best trapezoid with sides of 1:2 has a fifth of the best hydraulic radius.
#
# Expected: `HydraulicRadius.optimal_trapezoidal` is the hydraulic radius of the trapezoid with the least wetted
#     perimeter for its area, half the depth; with sides of 60 degrees it is half a hexagon, 0.866 m for a bottom of 2
#     m.
# Seen: 0.404 m for the half hexagon, 0.410 in place of 1.207 m for sides of 1:1 and 0.398 in place of 2.118 m for
#     1:2. `OptimalSections.trapezoidal` of the same library, and a search over the depth at the same area, have the
#     second ones. `optimal_rectangular` is right.
# Meaning: the depth is taken as b / (2 sqrt(3)) for any slope of the sides, a third of that of half a hexagon, where
#     b / (2 (sqrt(1 + z^2) - z)) is the condition. A ditch with this radius in the equation of Manning carries 0.3 to
#     0.6 of its flow per area. Take `OptimalSections.trapezoidal`, or half the depth by the condition.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    pyopenchannel==0.6.0 numpy==2.4.6 scipy==1.17.1
cat > run.py <<'PY'
import math

import pyopenchannel as channels

BOTTOM = 2.0  # m


def by_search(slope):
    """Hydraulic radius in m of the trapezoid of the given bottom that has the least perimeter for its area."""

    def perimeter(depth, area):
        return area / depth - slope * depth + 2 * depth * math.sqrt(1 + slope**2)

    def bottom_of_best(area):
        low, high = 1e-3, math.sqrt(area / slope)
        for _ in range(200):  # golden section
            first, second = high - 0.618034 * (high - low), low + 0.618034 * (high - low)
            low, high = (low, second) if perimeter(first, area) < perimeter(second, area) else (first, high)
        return area / low - slope * low, area / perimeter(low, area)

    bottom, radius = bottom_of_best(1.0)
    return radius * BOTTOM / bottom  # all best sections of one slope are similar


for slope, seen in ((1 / math.sqrt(3), 0.4041), (1.0, 0.4096), (2.0, 0.3975)):
    found = channels.HydraulicRadius.optimal_trapezoidal(BOTTOM, slope)
    design = channels.OptimalSections.trapezoidal(6.0, 0.001, 0.025, slope)
    scaled = design.hydraulic_radius * BOTTOM / design.channel.bottom_width
    right = by_search(slope)
    print(f"1:{slope:.3f}: {found:.3f} m, by the design of sections {scaled:.3f} m, by search {right:.3f} m")
    assert abs(scaled / right - 1) < 1e-3 and abs(found - seen) < 1e-3 and found < 0.5 * right
assert channels.HydraulicRadius.optimal_rectangular(BOTTOM) == BOTTOM / 4
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
