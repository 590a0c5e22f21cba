#!/usr/bin/env bash
# scipy 1.17.1: the ground moves three times too far after a high-pass filter of a record.
#
# Expected: `sosfiltfilt` with a corner of 0.1 Hz removes the drift of a record of 20 s: integrated
#     twice it ends at rest, and its peak displacement is that of a filter with zeros on both sides.
# Seen: with the default padding the displacement ends at its peak of 0.39 m, and the velocity at
#     0.02 m/s.  With 60 s of zeros on both sides the peak is 0.11 m and the end is at rest.  A
#     longer padding of the function itself (padlen=2400, odd) is worse: 1.2 m.
# Meaning: the default extends the record by some tenths of a second, turned around, where a filter
#     of 0.1 Hz acts over tens of seconds.  Displacements of walls and slopes by double integration,
#     and prescribed motions of a base, are those of the padding.  Pad with zeros yourself before
#     filtering, and keep the pads.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1
cat > run.py <<'PY'
import numpy as np
from scipy.integrate import cumulative_trapezoid
from scipy.signal import butter, sosfiltfilt

STEP = 0.005
time = np.arange(0, 20, STEP)
envelope = np.clip(time / 2, 0, 1) * np.exp(-np.clip(time - 8, 0, None) / 2)
record = 2 * envelope * np.random.default_rng(3).standard_normal(time.size)
high = butter(4, 0.1, "highpass", fs=1 / STEP, output="sos")
padded = np.pad(record, int(60 / STEP))
seen = []
for name, acceleration in (
    ("default", sosfiltfilt(high, record)),
    ("padlen=2400", sosfiltfilt(high, record, padlen=2400)),
    ("zeros", sosfiltfilt(high, padded, padlen=0)),
):
    velocity = cumulative_trapezoid(acceleration, dx=STEP, initial=0)
    displacement = cumulative_trapezoid(velocity, dx=STEP, initial=0)
    peak = abs(displacement).max()
    print(f"{name}: peak displacement {peak:.3f} m, at the end {displacement[-1]:.3f} m, "
          f"velocity at the end {velocity[-1]:.3f} m/s")
    seen.append((peak, displacement[-1]))
default, longer, right = seen
assert abs(default[0] - 0.386) < 0.02 and abs(default[1] - default[0]) < 1e-6
assert abs(longer[0] - 1.200) < 0.05
assert abs(right[0] - 0.112) < 0.01 and abs(right[1]) < 1e-4
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
