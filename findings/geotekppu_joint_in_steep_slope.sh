#!/usr/bin/env bash
# geotekppu 0.1.0: the slope mass rating of joints that come out of a steep slope is the best, not the worst.
#
# Expected: `F3` of slope mass rating for planar failure goes by the dip of the joint less the dip of the slope
#     (Romana 1985): joints 10 degrees or more flatter than the slope come out of it and get -60, joints 10 degrees or
#     more steeper get 0.
# Seen: slope 70, joint 40 degrees: 0; slope 70, joint 65: -6; slope 40, joint 45: -50; slope 40, joint 70: -60.
#     Right are -60, -50, -6 and 0.
# Meaning: `slope - ddips` is compared with the limits for the joint less the slope.  A face of 70 degrees with joints
#     of 40 degrees, rating 60, dip directions alike, has an SMR of 60, class III or II, right is 9, class V,
#     completely unstable.  Call it with the two dips exchanged.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    geotekppu==0.1.0
cat > run.py <<'PY'
from geotekppu.smr.smr__romana_ts2015 import F1, F2, F3, SMR2015


def rated(joint, slope):
    """Rating of the joint's dip less the slope's, Romana (1985), planar failure."""
    apart = joint - slope
    return 0 if apart > 10 else -6 if apart > 0 else -25 if apart == 0 else -50 if apart >= -10 else -60


for slope, joint, value in ((70, 40, 0), (70, 65, -6), (50, 50, -25), (40, 45, -50), (40, 70, -60)):
    found = F3("P", slope, joint)
    print(f"slope {slope}, joint {joint}: F3 {found}, right {rated(joint, slope)}, exchanged {F3('P', joint, slope)}")
    assert found == value == rated(slope, joint) and F3("P", joint, slope) == rated(joint, slope)
first, second = F1("P", 100, 100), F2("P", 40)
found = SMR2015(60, first, second, F3("P", 70, 40), 0)
right = SMR2015(60, first, second, rated(40, 70), 0)
print(f"SMR of a face of 70 degrees with joints of 40: {found:.0f}, right {right:.0f}")
assert found == 60 and abs(right - 9) < 1e-9
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
