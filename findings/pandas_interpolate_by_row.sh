#!/usr/bin/env bash
# pandas 3.1.1: the strength between two samples depends on how many other depths are listed.
#
# Expected: `interpolate()` of a series over depths is linear in the depth, as the index is numbers,
#     and leaves a depth below the last sample empty.
# Seen: strengths of 20, 22 and 24 kPa at 0, 1 and 2 m, and 44 kPa at 12 m.  At 3 and 4 m, without a
#     sample, it returns 30.7 and 37.3 kPa; linear in the depth are 26 and 28 kPa.  At 15 m, below
#     the last sample, it returns 44 kPa.  The same for dates.  `interpolate("index")` has 26 and 28
#     kPa, and 44 kPa at 15 m too.
# Meaning: the default counts rows and does not look at the index.  Soundings, piezometers and
#     settlements with irregular spacing, and tables of two instruments that were joined, get values
#     that belong elsewhere: here a third too much strength.  Give "index" or "time", and
#     `limit_area="inside"`.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    pandas==3.1.1 numpy==2.4.6
cat > run.py <<'PY'
import numpy as np
import pandas as pd

DEPTHS = np.array([0.0, 1.0, 2.0, 3.0, 4.0, 12.0, 15.0])
STRENGTH = np.array([20.0, 22.0, 24.0, np.nan, np.nan, 44.0, np.nan])
profile = pd.Series(STRENGTH, index=DEPTHS)
known = np.isfinite(STRENGTH)
right = np.interp(DEPTHS, DEPTHS[known], STRENGTH[known], right=np.nan)
rows, depth = profile.interpolate(), profile.interpolate("index")
inside = profile.interpolate("index", limit_area="inside")
print(pd.DataFrame({"right": right, "default": rows, "index": depth, "inside": inside}).round(1))
assert np.allclose(rows[[3.0, 4.0, 15.0]], [24 + 20 / 3, 24 + 40 / 3, 44])
assert np.allclose(depth.iloc[:-1], right[:-1]) and depth.iloc[-1] == 44
assert np.allclose(inside, right, equal_nan=True)

days = pd.to_datetime("2026-01-01") + pd.to_timedelta(DEPTHS, unit="D")
assert np.allclose(pd.Series(STRENGTH, index=days).interpolate(), rows)
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
