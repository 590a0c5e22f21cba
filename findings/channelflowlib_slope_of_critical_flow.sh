#!/usr/bin/env bash
# channelflowlib 0.9.2: a rectangular channel has another critical slope than the trapezoidal one with upright walls.
#
# Expected: the critical slope is the slope at which uniform flow of Manning is critical; it is the same from
#     `Rectangular` and from `Trapezoidal` with a side slope of zero.
# Seen: 5 m3/s in concrete (n = 0.015).  2 m wide: 0.0032 and 0.0053; 10 m wide: 0.0015 and 0.0036; 60 m wide: 0.0010
#     and 0.0050.  On the second slopes the uniform flow at critical depth has a Froude number of 1.  The first class
#     multiplies by the third root of the hydraulic radius where it has to divide: it is wrong by R^(2/3).
# Meaning: outlets, spillways and ditches are called steep, with fast flow and a jump below them, though the flow is
#     calm, the shallower the flow the more.  Use `Trapezoidal` for rectangular channels as well.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    channelflowlib==0.9.2
cat > run.py <<'PY'
import math

from channelflowlib.openchannellib import Rectangular, Trapezoidal

DISCHARGE, ROUGHNESS, SLOPE, GRAVITY = 5.0, 0.015, 0.001, 9.81  # m3/s, of concrete, -, m/s2


def critical_slope(kind, width):
    """Critical slope by a class of the library."""
    channel = kind(unknown="water_depth", unit="metric")
    channel.set_discharge(DISCHARGE)
    channel.set_channel_slope(SLOPE)
    channel.set_roughness(ROUGHNESS)
    channel.set_channel_base(width)
    if kind is Trapezoidal:
        channel.set_sideslope(0.0)
    channel.analyze()
    return channel.critical_flow["critical_slope"]


for width in (2.0, 10.0, 60.0):
    depth = (DISCHARGE**2 / (GRAVITY * width**2)) ** (1 / 3)
    radius = width * depth / (width + 2 * depth)
    right = (ROUGHNESS * DISCHARGE / (width * depth) / radius ** (2 / 3)) ** 2
    velocity = math.sqrt(right) * radius ** (2 / 3) / ROUGHNESS
    froude = velocity / math.sqrt(GRAVITY * depth)
    first, second = critical_slope(Rectangular, width), critical_slope(Trapezoidal, width)
    print(
        f"{width:.0f} m wide, {depth:.3f} m deep: Rectangular {first:.5f}, Trapezoidal {second:.5f}, "
        f"right {right:.5f} with a Froude number of {froude:.3f}; ratio {first / right:.3f}, {radius ** (2 / 3):.3f}"
    )
    assert math.isclose(second, right, rel_tol=5e-3) and math.isclose(froude, 1.0, rel_tol=1e-6)
    assert math.isclose(first / right, radius ** (2 / 3), rel_tol=5e-3)
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
