#!/usr/bin/env bash
# xarray 2026.9.0: the difference of two profiles has no value at three of eleven depths.
#
# Expected: settlements or pressures at the same eleven depths can be subtracted; if the depths
#     differ by round-off, there is an error, or NaN at the odd ones.
# Seen: depths of 0.0, 0.1, ..., 1.0 m from a text file and the same ones from `arange` differ by
#     1e-16 m at 0.3, 0.6 and 0.7 m.  The difference has eight depths, without a message, and a loss
#     of 10 kPa in each of eleven layers adds up to 80 kPa in place of 110 kPa.
# Meaning: arithmetic keeps the coordinates that both have, bit by bit.  Resultants, work and means
#     lose layers where results of two programs are compared.  Set
#     `xr.set_options(arithmetic_join="exact")`, which makes it an error, or round the coordinates.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    xarray==2026.9.0 numpy==2.4.6
cat > run.py <<'PY'
import warnings

import numpy as np
import xarray as xr

warnings.simplefilter("error")
text = "0.0 0.1 0.2 0.3 0.4 0.5 0.6 0.7 0.8 0.9 1.0"
read = np.array([float(word) for word in text.split()])
made = np.arange(0, 1.05, 0.1)
before = xr.DataArray(np.full(11, 30.0), coords={"depth": read}, dims="depth")
after = xr.DataArray(np.full(11, 20.0), coords={"depth": made}, dims="depth")
loss = before - after
missing = sorted(set(read) - set(loss.depth.values))
print(f"largest difference of depth {abs(read - made).max():.1e} m")
print(f"{loss.size} of 11 depths, sum {float(loss.sum())} in place of 110; missing {missing}")
assert abs(read - made).max() < 1e-15 and loss.size == 8 and float(loss.sum()) == 80
assert np.allclose(missing, [0.3, 0.6, 0.7])
with xr.set_options(arithmetic_join="exact"):
    try:
        before - after
        raise SystemExit("no error")
    except ValueError as error:
        print("exact:", str(error)[:60])
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
