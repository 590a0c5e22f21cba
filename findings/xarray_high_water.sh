#!/usr/bin/env bash
# xarray 2026.9.0: a water level of 400 m is saved as -255.36 m.
#
# Expected: levels that are changed after reading are saved as they are, or a level that the file
#     cannot hold is an error.
# Seen: a file holds levels of about 310 m as whole numbers of 16 bits with a scale of 0.01 m, as
#     published climate and groundwater files do.  It is read, one level is set to 400 m, and the
#     table is saved: 400 m is -255.36 m in the new file.  Two tables put together by `concat` take
#     the storage of the first: 700 m of the second is 44.64 m.  In memory all values are right,
#     and there is no message.
# Meaning: the way of storage travels with a variable, out of sight, through selection, `concat` and
#     changes in place, and arithmetic drops it, so that `table + 90` is saved well.  Values beyond
#     327.67 m wrap around, smaller changes are rounded to 1 cm.  Call `drop_encoding()` before saving.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    xarray==2026.9.0 netCDF4==1.7.5.1.post1 numpy==2.4.6 pandas==3.1.1
cat > run.py <<'PY'
import warnings

import numpy as np
import xarray as xr

warnings.simplefilter("error")


def table(levels, first=0):
    """Levels over days."""
    return xr.Dataset({"level": ("day", levels)}, coords={"day": first + np.arange(len(levels))})


def saved(dataset):
    """Levels that are read from the file of a table."""
    dataset.to_netcdf("saved.nc")
    with xr.open_dataset("saved.nc") as again:
        return np.round(again["level"].values, 3)


def published():
    """Table as it is read from the published file."""
    return xr.load_dataset("published.nc")


storage = {"dtype": "int16", "scale_factor": 0.01, "_FillValue": -32768}
table([310.12, 311.5, 312.0]).to_netcdf("published.nc", encoding={"level": storage})
flood = published()
flood["level"].loc[{"day": 2}] = 400.0
joined = xr.concat([published(), table([10.0, 700.0], 3)], "day")
raised = published() + 90
for name, dataset in {"set": flood, "joined": joined, "raised": raised}.items():
    print(name, dataset["level"].values, "in memory", saved(dataset), "saved",
          saved(dataset.drop_encoding()), "without encoding")
assert np.allclose(saved(flood), [310.12, 311.5, -255.36])
assert np.allclose(saved(joined), [310.12, 311.5, 312.0, 10.0, 44.64])
assert np.allclose(saved(raised), [400.12, 401.5, 402.0])
assert np.allclose(saved(flood.drop_encoding()), [310.12, 311.5, 400.0])
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
