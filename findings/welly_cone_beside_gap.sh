#!/usr/bin/env bash
# welly 0.5.2: a running mean of cone resistance falls to half beside a gap of the record.
#
# Expected: `Curve.apply` "runs any kind of function over a window", the mean by default; samples without a value
#     are left out, or spread to the whole window as in numpy.  A constant record stays constant.
# Seen: 4 MPa everywhere, one sample per 0.1 m, a gap of 1 m where a rod was added.  With a window of 11 samples
#     the mean falls from 4.00 to 2.18 MPa towards the gap on both sides, over half a window; the gap itself
#     stays empty.  The minimum is 0 MPa there and the standard deviation 2.0 MPa, where right is 4 and 0.  No
#     message.
# Meaning: samples without a value become zeros before the function is called.  A soft layer appears beside each
#     gap and each end of a casing, scatter and its scale with it.  Interpolate the gap first, or use the running
#     mean of pandas, which leaves it out.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    welly==0.5.2 numpy==1.26.4 scipy==1.11.4 pandas==1.5.3
cat > run.py <<'PY'
import numpy as np
import pandas as pd
from welly import Curve

WINDOW, RESISTANCE = 11, 4.0  # samples, MPa
depth = 0.1 * np.arange(100)  # m
record = np.full(depth.size, RESISTANCE)
record[40:50] = np.nan
inside = ~np.isnan(record)
curve = Curve(record, index=depth, mnemonic="QC", index_name="DEPT")


def running(function=None):
    """A function of the library over the window."""
    return curve.apply(window_length=WINDOW, func1d=function).as_numpy()


mean, minimum, scatter = running(), running(np.min), running(np.std)
other = pd.Series(record, depth).rolling(WINDOW, center=True, min_periods=1).mean().to_numpy()
print("mean towards the gap:", mean[33:40].round(2), "and after it:", mean[50:57].round(2), "MPa")
print(f"smallest value {np.nanmin(minimum)} MPa, largest standard deviation {np.nanmax(scatter):.2f} MPa")
assert np.allclose(other[inside], RESISTANCE)
assert np.array_equal(np.isnan(mean), ~inside)
assert np.isclose(mean[39], RESISTANCE * 6 / 11) and np.isclose(mean[50], RESISTANCE * 6 / 11)
assert np.allclose(mean[:35], RESISTANCE) and np.allclose(mean[55:], RESISTANCE)
assert np.nanmin(minimum) == 0 and np.isclose(np.nanmax(scatter), RESISTANCE * np.sqrt(30) / 11)

filled = Curve(np.interp(depth, depth[inside], record[inside]), index=depth, mnemonic="QC", index_name="DEPT")
assert np.allclose(filled.apply(window_length=WINDOW).as_numpy(), RESISTANCE)
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
