#!/usr/bin/env bash
# scipy 1.17.1: after the tide is filtered out, a groundwater level of 10.0 m is 9.4 m, or 10^12 m.
#
# Expected: a low-pass filter by Butterworth leaves the mean; `butter` and `filtfilt` return a constant level as it
#     is.
# Seen: a constant level of 10 m, a limit of half a cycle a day.  With a reading a minute orders 3 and 4 give 10.000
#     m, order 5 9.35 m, order 6 some 10^12 m.  With a reading every ten minutes order 6 gives 10.001 m and order 8
#     10.29 m.  With `output="sos"` and `sosfiltfilt` all are 10.000 m.  No message.
# Meaning: where the limit is far below the rate of readings, the coefficients of the filter are round-off, and its
#     gain is not one; a finer record makes it worse.  With order 6 one sees it.  With 5 the level is plausible, and a
#     drawdown or an uplift is wrong by 0.6 m.  Use second-order sections, and filter a constant first.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    scipy==1.17.1 numpy==2.4.6
cat > run.py <<'PY'
import numpy as np
from scipy.signal import butter, filtfilt, sosfiltfilt

LEVEL, LIMIT, DAYS = 10.0, 0.5, 14  # m, cycles a day


def filtered(order, rate):
    """Level in m in the middle of the record, by coefficients and by sections."""
    record = np.full(DAYS * rate, LEVEL)
    by_coefficients = filtfilt(*butter(order, LIMIT, fs=rate), record)
    by_sections = sosfiltfilt(butter(order, LIMIT, fs=rate, output="sos"), record)
    return by_coefficients[record.size // 2], by_sections[record.size // 2]


error = {}
for rate in (144, 1440):
    for order in (3, 4, 5, 6, 8):
        with np.errstate(all="ignore"):
            found, right = filtered(order, rate)
        error[rate, order] = abs(found - LEVEL)
        print(f"{rate} readings a day, order {order}: {found:.6g} m, by sections {right:.6f} m, right {LEVEL} m")
        assert abs(right - LEVEL) < 1e-5
assert max(error[1440, 3], error[1440, 4], error[144, 6]) < 0.01
assert 0.1 < error[1440, 5] < 10 and not error[1440, 6] < 100 and 0.05 < error[144, 8] < 5
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
