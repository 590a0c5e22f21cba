#!/usr/bin/env bash
# shapely 2.2.0: a pipe that is split at a point of its own is not split.
#
# Expected: `split(line, point)` with a point that `interpolate` has found on the same line returns two
#     pieces, or refuses the point as not on the line.
# Seen: of 100 lines from (0, 0) to (30, -1) ... (30, -6), split at 10 m, 6 have two pieces; 94 are
#     returned in one piece of the whole length, without a message.  The distance of the point is below
#     1e-15 m.  `contains` and `intersects` say no for the same 94.  With the point inserted into the
#     line as a vertex before (`snap` does it) all 100 are split.
# Meaning: these operations have no tolerance, and almost no point of an inclined line is on it in
#     double precision.  Reaches between manholes, layers between boreholes, and walls between anchors
#     keep the properties of the first piece over all of their length.  Count the pieces.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    shapely==2.2.0 numpy==2.4.6
cat > run.py <<'PY'
import warnings

from shapely import LineString
from shapely.ops import snap, split

warnings.simplefilter("error")
lines = [LineString([(0, 0), (30, -1 - 0.05 * k)]) for k in range(100)]
points = [line.interpolate(10.0) for line in lines]
pieces = [len(split(line, point).geoms) for line, point in zip(lines, points)]
apart = max(line.distance(point) for line, point in zip(lines, points))
contained = sum(line.contains(point) for line, point in zip(lines, points))
met = sum(line.intersects(point) for line, point in zip(lines, points))
snapped = [len(split(snap(line, point, 1e-9), point).geoms) for line, point in zip(lines, points)]
print(f"split {pieces.count(2)} of 100, whole {pieces.count(1)}, contained {contained}, met {met}, "
      f"largest distance {apart:.1e} m, split with a vertex {snapped.count(2)}")
assert pieces.count(1) > 80 and pieces.count(2) == contained == met < 20
assert apart < 1e-14 and snapped.count(2) == 100
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
