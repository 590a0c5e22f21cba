#!/usr/bin/env bash
# geotekppu 0.1.0: a joint that dips to 355 degrees is rated as askew to a slope that faces 5 degrees.
#
# Expected: `F1` of slope mass rating depends on the angle between the dip directions of joint and slope (Romana
#     1985): 10 degrees apart gives 0.85, the same wherever north is.
# Seen: planar failure with joint 185 and slope 175: 0.85; with 355 and 5, or 5 and 355: 0.15.  Toppling with joint
#     190 and slope 10: 1.0; with joint 10 and slope 190, the same plane and slope turned by 180 degrees: 0.15.
# Meaning: the difference is taken as a number up to 360, not as an angle.  The mass rating is the rock rating + F1 F2
#     F3 + F4: for joints of 40 degrees in a face of 45 degrees, F2 0.85 and F3 -50, the reduction is 6 in place of 36
#     points, and a face to the north that is expected to slide looks fair.  For toppling half of all faces are
#     concerned.  Take the angle between both directions, 0 to 180 degrees, and its rating from the table.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    geotekppu==0.1.0
cat > run.py <<'PY'
from geotekppu.smr.smr__romana_ts2015 import F1


def rated(angle):
    """Rating by the angle in degrees between the directions, Romana (1985)."""
    return next(value for limit, value in ((5, 1.0), (10, 0.85), (20, 0.7), (30, 0.4), (180, 0.15)) if angle <= limit)


def between(first, second):
    return abs((first - second + 180) % 360 - 180)


wrong = {}
for kind, turned in (("P", 0), ("T", 180)):
    for joint in range(0, 360, 5):
        for slope in range(0, 360, 5):
            right = rated(between(joint, slope + turned))
            if F1(kind, joint, slope) != right:
                wrong[kind, joint, slope] = F1(kind, joint, slope), right
CASES = (("P", 185, 175, 0.85, 0.85), ("P", 355, 5, 0.15, 0.85), ("P", 5, 355, 0.15, 0.85),
         ("T", 190, 10, 1.0, 1.0), ("T", 10, 190, 0.15, 1.0))
for kind, joint, slope, value, right in CASES:
    print(f"{kind}, joint to {joint}, slope to {slope}: F1 {F1(kind, joint, slope)}, right {right}")
    assert F1(kind, joint, slope) == value
counts = {kind: sum(key[0] == kind for key in wrong) for kind in "PT"}
print("pairs of 5184 at 5 degrees with a wrong rating:", counts)
assert counts["P"] > 30 and counts["T"] > 300 and all(found < right for found, right in wrong.values())
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
