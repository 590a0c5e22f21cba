#!/usr/bin/env bash
# wellpathpy 0.5.2: a borehole that turns past north goes 10 m south in one reading.
#
# Expected: the path of a borehole does not depend on the direction from which azimuths are counted: turned by 90
#     degrees it is the same path.  The methods agree within the square of the angle between two readings.
# Seen: 200 m, a reading every 20 m, the inclination grows from 20 to 40 degrees, the azimuth from 342 over 356.4 and 0
#     to 18 degrees.  Turned to the east (72 to 108 degrees) four methods end 97.8 to 97.9 m away in the mean
#     direction.  To the north, `tan_method()` ends at 78.5 m and `radius_curvature()` at 88.1 m: between the readings
#     of 356.4 and 0 degrees the path goes 9.7 m backwards, or nowhere.  Minimum curvature is right.  No message.
# Meaning: azimuths are averaged and subtracted as plain numbers: half-way from 356.4 to 0 is 178.2, and the turn is
#     356.4 degrees.  `avg` is the default of `tan_method`.  Inclined boreholes of anchors, freezing pipes and
#     inclinometers that point north are off by up to twice the part between two readings; azimuths that run on beyond
#     360 are refused.  Use `minimum_curvature`, or count azimuths from another direction and turn the path back.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check wellpathpy==0.5.2 numpy==2.4.6 pandas==3.1.1
cat > run.py <<'PY'
import numpy as np
import wellpathpy

measured = np.linspace(0, 200, 11)
inclination = np.linspace(20, 40, 11)
azimuth = np.linspace(-18, 18, 11)


def ends(direction):
    """Way in the mean direction and depth in m at the end of the borehole, by method."""
    survey = wellpathpy.deviation(measured, inclination, (azimuth + direction) % 360)
    paths = {"minimum_curvature": survey.minimum_curvature(), "radius_curvature": survey.radius_curvature()}
    paths |= {f"tan_method {choice}": survey.tan_method(choice) for choice in ("avg", "bal", "high", "low")}
    angle = np.radians(direction)
    return {
        name: (path.northing * np.cos(angle) + path.easting * np.sin(angle), path.depth[-1])
        for name, path in paths.items()
    }


east, north = ends(90.0), ends(0.0)
seen = {"minimum_curvature": 97.85, "radius_curvature": 88.1, "tan_method avg": 78.5, "tan_method bal": 97.83}
for name, (way, depth) in east.items():
    turned, same_depth = north[name]
    fifth = turned[5] - turned[4]
    print(f"{name}: to the east {way[-1]:.2f} m, to the north {turned[-1]:.2f} m, by {fifth:.2f} m between 356.4 and "
          f"0 degrees; depth {depth:.2f} m and {same_depth:.2f} m")
    assert abs(depth - same_depth) < 1e-6
    if name in seen:
        assert abs(way[-1] - 97.85) < 0.1 and abs(turned[-1] - seen[name]) < 0.1
try:
    wellpathpy.deviation(measured, inclination, 360 + azimuth)
    raise AssertionError("azimuths above 360 degrees are accepted")
except ValueError as message:
    print(f"azimuths from 342 to 378 degrees: {message}")
assert abs(north["radius_curvature"][0][5] - north["radius_curvature"][0][4]) < 0.1
assert north["tan_method avg"][0][5] - north["tan_method avg"][0][4] < -9
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
