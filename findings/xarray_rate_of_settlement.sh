#!/usr/bin/env bash
# xarray 2026.9.0: a settlement of 2e-3 mm a second is one of 2e-6, 2e-9 or 2e-12, by the resolution of its dates.
#
# Expected: `differentiate` and `integrate` along a time axis have one unit, whatever the resolution in which the same
#     instants are stored, s, ms, us or ns; if `datetime_unit` is not given it is the second or the nanosecond.
# Seen: readings that settle by 172.8 mm a day, 2e-3 mm a second.  `differentiate("time")` gives 2e-3, 2e-6, 2e-9 and
#     2e-12, and `integrate` of a flow of 1 l/s over ten days 8.64e5 l, and 10^3, 10^6 and 10^9 times as much.
#     `polyfit` gives the slope by the nanosecond for all four.  With `datetime_unit="D"` all derivatives are 172.8 mm
#     a day.
# Meaning: the default unit is the resolution of the axis, which depends on how the file was read: texts in pandas 3
#     become microseconds, dates of numpy days to seconds, netCDF files often nanoseconds.  Rates of settlement and
#     discharged volumes change by 10^3 from one reader to the next.  Give `datetime_unit` always; for `polyfit` make
#     the axis a number of days first.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    xarray==2026.9.0 pandas==3.1.1 numpy==2.4.6
cat > run.py <<'PY'
import numpy as np
import xarray

DAYS, DAY = 10, 86400.0  # s
RATE, FLOW = 2e-3, 1.0  # mm/s, l/s
PER_SECOND = {"s": 1.0, "ms": 1e3, "us": 1e6, "ns": 1e9}

days = np.datetime64("2026-03-01") + np.arange(DAYS + 1)
for unit, number in PER_SECOND.items():
    time = {"time": days.astype(f"datetime64[{unit}]")}
    settlement = xarray.DataArray(RATE * DAY * np.arange(DAYS + 1), time, ["time"])
    flow = xarray.DataArray(np.full(DAYS + 1, FLOW), time, ["time"])
    assert settlement.time.dtype == f"datetime64[{unit}]"
    rate = settlement.differentiate("time").values
    daily = settlement.differentiate("time", datetime_unit="D").values
    volume = float(flow.integrate("time"))
    slope = float(settlement.polyfit("time", 1).polyfit_coefficients[0])
    print(f"dates in {unit}: rate {rate[0]:.3g}, with the unit D {daily[0]:.4g}, slope of polyfit {slope:.3g}, "
          f"volume {volume:.4g}; right are {RATE} mm/s and {FLOW * DAYS * DAY:.4g} l")
    assert np.allclose(rate, RATE / number, rtol=1e-9, atol=0)
    assert np.allclose(daily, RATE * DAY, rtol=1e-9)
    assert np.isclose(volume, FLOW * DAYS * DAY * number, rtol=1e-9)
    assert np.isclose(slope, RATE / PER_SECOND["ns"], rtol=1e-6, atol=0)
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
