#!/usr/bin/env bash
# scipy 1.17.1, numpy 2.4.6: a gauge that is a hundred times worse gives a result of the same accuracy.
#
# Expected: the standard deviation that `curve_fit` derives for the rate of a settlement grows with the
#     one of the readings, which is given as `sigma`: 7.07 mm per day for three readings, a day apart,
#     of 10 mm.
# Seen: 0.06 mm per day, for a sigma of 0.1 mm, 10 mm or 1 m, as three readings happen to lie close to
#     a line.  `numpy.polyfit` with weights 1/sigma and cov=True has the same.  With absolute_sigma=True
#     and cov="unscaled" both have 7.07 mm per day for 10 mm.  No message.
# Meaning: only the ratios of the accuracies are used, and their size is estimated from the fit.
#     Back-analyses from few readings look a hundred times as certain as they are, and a second
#     reading that lies off the line makes them worse.  Say absolute_sigma=True.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    scipy==1.17.1 numpy==2.4.6
cat > run.py <<'PY'
import numpy as np
from scipy.optimize import curve_fit

DAYS = np.array([0.0, 1.0, 2.0])
READINGS = np.array([0.0, 5.1, 10.0])  # mm


def line(days, start, rate):
    """Settlement in mm."""
    return start + rate * days


for sigma in (0.1, 10.0, 1000.0):
    accuracy = np.full(3, sigma)
    _, scaled = curve_fit(line, DAYS, READINGS, sigma=accuracy)
    _, honest = curve_fit(line, DAYS, READINGS, sigma=accuracy, absolute_sigma=True)
    _, poly = np.polyfit(DAYS, READINGS, 1, w=1 / accuracy, cov=True)
    _, unscaled = np.polyfit(DAYS, READINGS, 1, w=1 / accuracy, cov="unscaled")
    found = np.sqrt([scaled[1, 1], poly[0, 0], honest[1, 1], unscaled[0, 0]])
    right = sigma / np.sqrt(((DAYS - DAYS.mean()) ** 2).sum())
    print(f"readings within {sigma} mm: {found.round(4)} mm per day, right {right:.3f}")
    # The scatter of the readings around the line, with one degree of freedom.
    slope, start = np.polyfit(DAYS, READINGS, 1)
    scatter = np.sqrt(((READINGS - start - slope * DAYS) ** 2).sum())
    assert np.allclose(found[:2], scatter / np.sqrt(2), rtol=1e-4)
    assert np.allclose(found[2:], right, rtol=1e-4)
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
