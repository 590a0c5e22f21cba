#!/usr/bin/env bash
# wellpathpy 0.5.2: by the radius of curvature, a straight borehole of 100 m has the depth 0.
#
# Expected: the docstring warns that `radius_curvature` is unreliable for a straight borehole, and the source replaces a
#     change of angle of zero by 0.000001, so the result is the limit of the formula for small angles, with some digits
#     lost: L cos(inclination) in depth and L sin(inclination) away.
# Seen: 100 m straight down: depth 0.00 m.  100 m at 30 degrees, due east: depth 0.00 m, away 0.00 m, right are 86.60
#     and 50.00 m.  With an inclination of 30.001 degrees at the second reading: 86.60 m, and still 0.00 m away; with
#     an azimuth of 90.001 degrees as well: 50.00 m, all right.  A hole that is vertical for 60 m and then turns to 20
#     degrees in 40 m has a depth of 39.19 m, minimum curvature gives 99.19 m.  No message.
# Meaning: the difference in the numerator stays zero, and zero over 0.000001 is zero: every part between two equal
#     readings is left out.  Strata from a borehole whose first readings are all 0 degrees lie too high by
#     the length of this part.  Use `minimum_curvature`.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check wellpathpy==0.5.2 numpy==2.4.6 pandas==3.1.1
cat > run.py <<'PY'
import numpy as np
import wellpathpy


def end(path):
    """Depth and horizontal distance of the end in m."""
    return path.depth[-1], np.hypot(path.northing[-1], path.easting[-1])


for name, measured, inclination, azimuth, seen in (
    ("vertical", (0, 100), (0, 0), (0, 0), (0.0, 0.0)),
    ("30 degrees", (0, 100), (30, 30), (90, 90), (0.0, 0.0)),
    ("30.001 degrees at the end", (0, 100), (30, 30.001), (90, 90), (86.60, 0.0)),
    ("azimuth 90.001 degrees as well", (0, 100), (30, 30.001), (90, 90.001), (86.60, 50.0)),
    ("60 m vertical, then to 20 degrees", (0, 30, 60, 100), (0, 0, 0, 20), (0, 0, 0, 0.001), (39.19, 6.91)),
):
    survey = wellpathpy.deviation(measured, inclination, azimuth)
    found, right = end(survey.radius_curvature()), end(survey.minimum_curvature())
    print(f"{name}: depth {found[0]:.2f} m, away {found[1]:.2f} m; "
          f"minimum curvature {right[0]:.2f} m, {right[1]:.2f} m")
    assert np.allclose(found, seen, atol=0.01)
    if len(measured) == 2:
        angle = np.radians(inclination[0])
        assert np.allclose(right, (100 * np.cos(angle), 100 * np.sin(angle)), atol=0.01)
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
