#!/usr/bin/env bash
# geodepy 0.7.0: a sight in the second face of the instrument has its height with the wrong sign.
#
# Expected: `va_conv` takes zenith angles "from instrument to target" between 0 and 180 and between 180 and 360 degrees.
#     The second range is the other face: the same target at 80 degrees reads 360 - 80 = 280 degrees, and both give the
#     same height.
# Seen: 100 m at 80 degrees: 17.36 m up.  At 280 degrees: 17.36 m down, with the same horizontal distance.  With an
#     instrument of 1.6 m and a target of 2.0 m: 16.96 m and -17.76 m.  The mean over both faces, which removes the
#     index error, is the difference of instrument and target, -0.40 m.  No message.
# Meaning: for the second face the angle is 270 degrees less the reading, where the reading less 270 degrees is due.
#     Heights of prisms of a monitored slope or wall, and settlements from them, are mirrored for every second set
#     of readings.  Take 360 less the reading before the call.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    geodepy==0.7.0 numpy==2.4.6 scipy==1.17.1
cat > run.py <<'PY'
import math

from geodepy.survey import va_conv

LENGTH = 100.0  # m


def right(zenith, instrument=0.0, target=0.0):
    """Height of the target's ground point above the instrument's; cosine is even, and so is this in both faces."""
    return LENGTH * math.cos(math.radians(zenith)) + instrument - target


for first, heights in ((80.0, ()), (80.0, (1.6, 2.0)), (92.5, (1.6, 2.0))):
    second = 360 - first
    up, mirrored, turned = (va_conv(angle, LENGTH, *heights)[3] for angle in (first, second, 360 - second))
    expected = right(first, *heights)
    difference = heights[0] - heights[1] if heights else 0.0
    print(f"heights {heights}: face one {up:.3f} m, face two {mirrored:.3f} m, right {expected:.3f} m; "
          f"mean {(up + mirrored) / 2:.3f} m")
    assert abs(expected - right(second, *heights)) < 1e-9
    assert abs(up - expected) < 1e-9 and abs(turned - expected) < 1e-9
    assert abs((up + mirrored) / 2 - difference) < 1e-9
    assert abs(va_conv(second, LENGTH)[2] - va_conv(first, LENGTH)[2]) < 1e-9
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
