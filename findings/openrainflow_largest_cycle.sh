#!/usr/bin/env bash
# openrainflow 1.0.0: the largest cycle of a record is lost.
#
# Expected: "implementation based on ASTM E1049-85".  The example of that standard, -2 1 -3 5 -1 3 -4 4 -2, has ranges
#     3 (half), 4 (one and a half), 6 (half), 8 (one) and 9 (half); the largest range of any record is its highest peak
#     less its lowest valley.
# Seen: the example has 3, 4 and 8 as full cycles and 6 and 8 as halves: 9 is missing.  A slow wave of 60 MPa with
#     ripples of 25 MPa reaches from -85 to 85 MPa; its largest range is 113.5 in place of 170 MPa and its damage, with
#     slope 3, is 0.30 of that of rainflow 3.2.0, which agrees with the standard.  Waves that grow to -90 and 100 MPa
#     have 0.80 of the damage and a largest range of 170 MPa.  No message.
# Meaning: a full cycle takes the wrong two points off the stack, and with them the highest peak.  The life of piles of
#     wind turbines, of anchors and of bridges is too long by a factor of up to three.  Compare the largest range with
#     peak less valley, or count with another library.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    openrainflow==1.0.0 rainflow==3.2.0 numpy==2.4.6 numba==0.68.1 matplotlib==3.11.2
cat > run.py <<'PY'
import numpy as np
import rainflow
from openrainflow import rainflow_count

STANDARD = (-2.0, 1.0, -3.0, 5.0, -1.0, 3.0, -4.0, 4.0, -2.0)
BY_HAND = {3: 0.5, 4: 1.5, 6: 0.5, 8: 1.0, 9: 0.5}  # the table of the standard


def counted(record):
    """Ranges and counts of both libraries."""
    cycles = rainflow_count(np.asarray(record))
    other = np.array(rainflow.count_cycles(record))
    return (cycles["range"], cycles["count"]), (other[:, 0], other[:, 1])


def damage(ranges, counts):
    """Sum of the cubes of the ranges, which the damage of slope 3 is proportional to."""
    return float(ranges**3 @ counts)


seen, reference = counted(STANDARD)
print("example of the standard:", sorted(zip(seen[0].tolist(), seen[1].tolist())))
assert dict(zip(reference[0].astype(int).tolist(), reference[1].tolist())) == BY_HAND
assert sorted(zip(seen[0].tolist(), seen[1].tolist())) == [(3, 1), (4, 1), (6, 0.5), (8, 0.5), (8, 1)]

time = np.arange(0, 200, 0.05)  # s
waves = 60 * np.sin(0.5 * time) + 25 * np.sin(3.3 * time)  # MPa
growing = np.array([(-1) ** wave * 10.0 * wave for wave in range(11)])
for name, record, ratio, largest in (
    ("waves with ripples", waves, 0.297, 113.5),
    ("growing waves", growing, 0.8, 170.0),
):
    seen, reference = counted(record)
    span = np.ptp(record)
    found = damage(*seen) / damage(*reference)
    print(f"{name}: largest range {seen[0].max():.1f} MPa, of the other library {reference[0].max():.1f}, "
          f"peak less valley {span:.1f}; damage {found:.3f} of the other")
    assert abs(reference[0].max() - span) < 1e-9
    assert abs(found - ratio) < 0.005 and abs(seen[0].max() - largest) < 0.1
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
