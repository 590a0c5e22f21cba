#!/usr/bin/env bash
# llgeo 0.0.18: a sounding to 60 m gives a Vs30 of 352 m/s for ground with 249 m/s.
#
# Expected: `get_vs30` is 30 m over the travel time of shear waves in the upper 30 m, "only for layers within the top
#     30 meters", as its docstring says, since it cuts the depths off at 30 m first.
# Seen: 150 m/s to 5 m, 220 to 15 m, 300 to 25 m, 600 below. With the last layer to 30 m: 249 m/s, right. The same
#     ground with the last layer to 60 m: 352 m/s; to 100 m: 422 m/s. No message.
# Meaning: the depths that are cut off are not used, so that the result is the mean over the whole sounding. A site of
#     class D (180 to 360 m/s) becomes C, and of class C becomes B by the depth of the sounding alone; ground with a
#     deep soft layer errs to the other side. Cut the layers off at 30 m before.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    --no-deps llgeo==0.0.18 numpy==2.4.6
cat > run.py <<'PY'
import numpy as np
from llgeo.props_basic.vs import get_vs30

TOPS, VELOCITIES = np.array([0.0, 5.0, 15.0, 25.0]), np.array([150.0, 220.0, 300.0, 600.0])  # m, m/s


def by_travel_time(bottom):
    """Mean velocity of a vertical wave over the upper 30 m, by steps of a millimetre."""
    depth = 0.001 * np.arange(1000 * min(bottom, 30)) + 0.0005
    return 30.0 / np.sum(0.001 / VELOCITIES[np.searchsorted(TOPS, depth) - 1])


for bottom, seen in ((30.0, 249.1), (60.0, 352.0), (100.0, 421.7)):
    found = get_vs30(TOPS, np.append(TOPS[1:], bottom), VELOCITIES)
    right = by_travel_time(bottom)
    print(f"sounding to {bottom} m: {found:.1f} m/s, right {right:.1f} m/s")
    assert abs(found - seen) < 0.1 and abs(right - 249.06) < 0.1
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
