#!/usr/bin/env bash
# geofound 1.1.4: a footing on a slope of 30 degrees carries 97 % of what it carries on level ground.
#
# Expected: Hansen's formula (1970), which the function cites, has the factor (1 - 0.5 tan(slope))**5
#     for ground that falls away from a footing: 0.63, 0.37 and 0.18 at 10, 20 and 30 degrees.
# Seen: the capacity of a strip on sand of 35 degrees (`capacity_brinch_hansen_1970`, slope in radians)
#     is 99.99, 99.7 and 96.8 % of the one on level ground: the power is taken of the tangent alone, as
#     1 - 0.5 tan(slope)**5.  Vesic's formula of the same package has 68, 40 and 18 %.  No message.
# Meaning: a footing at the crest of a cut or an embankment is designed with five times its capacity,
#     and the small loss looks like a slope that hardly matters.  Compute the factor by hand, or compare
#     with Vesic's.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    geofound==1.1.4 sfsimodels==0.9.46 numpy==2.4.6
cat > run.py <<'PY'
import geofound
import numpy as np

# A strip of 2 m by 20 m at a depth of 1 m in sand without cohesion; N and m.
sand = geofound.create_soil(phi=35, cohesion=0, unit_dry_weight=18e3)
strip = geofound.create_foundation(length=20.0, width=2.0, depth=1.0)
level = geofound.capacity_brinch_hansen_1970(sand, strip)
vesic_level = geofound.capacity_vesic_1975(sand, strip)
for degrees, seen in ((10, 0.9999), (20, 0.9968), (30, 0.9679)):
    slope = np.radians(degrees)
    hansen = geofound.capacity_brinch_hansen_1970(sand, strip, slope=slope) / level
    vesic = geofound.capacity_vesic_1975(sand, strip, slope=slope) / vesic_level
    right = (1 - 0.5 * np.tan(slope)) ** 5
    print(f"{degrees} degrees: {hansen:.4f} of the level capacity, right {right:.3f}, Vesic {vesic:.3f}")
    assert abs(hansen - seen) < 1e-4
    assert abs(hansen - (1 - 0.5 * np.tan(slope) ** 5)) < 1e-9
    assert abs(vesic - (1 - np.tan(slope)) ** 2) < 1e-9
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
