#!/usr/bin/env bash
# shapely 2.2.0: a borehole 95 m above a tunnel meets it, halfway.
#
# Expected: lines with heights either use them (no intersection of two lines that pass each other at
#     5 m and 100 m, an anchor of 3 m by 4 m is 5 m long) or are refused.
# Seen: the lines intersect, and the point has the height 52.5 m, the mean of both, which is on
#     neither.  The anchor is 3 m long, and the distance of two points 10 m above each other is 0.
#     `interpolate` returns the right height at half of the length in plan.  No message; all are
#     valid.
# Meaning: heights travel through all operations, and look as if they counted.  Collisions of piles
#     with tunnels, lengths of inclined boreholes and anchors, and depths read at a crossing are
#     plausible and wrong.  Measure in numpy, and cut sections in their own plane.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    shapely==2.2.0 numpy==2.4.6
cat > run.py <<'PY'
import warnings

from shapely import LineString, Point

warnings.simplefilter("error")
tunnel = LineString([(0, 0, 0), (10, 0, 10)])
borehole = LineString([(5, -1, 100), (5, 1, 100)])
anchor = LineString([(0, 0, 0), (3, 0, -4)])
top, toe = Point(0, 0, 0), Point(0, 0, -10)
meeting = tunnel.intersection(borehole)
print("intersects", tunnel.intersects(borehole), "at", meeting, "distance", tunnel.distance(borehole))
print("anchor", anchor.length, "halfway", anchor.interpolate(1.5), "top to toe", top.distance(toe))
assert tunnel.intersects(borehole) and (meeting.x, meeting.y, meeting.z) == (5, 0, 52.5)
assert tunnel.distance(borehole) == 0 and anchor.length == 3 and top.distance(toe) == 0
assert all(shape.is_valid for shape in (tunnel, borehole, anchor, top, toe))
assert anchor.has_z and anchor.interpolate(1.5).z == -2
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
