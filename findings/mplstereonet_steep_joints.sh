#!/usr/bin/env bash
# mplstereonet 0.6.3: six vertical joints have a horizontal plane as their mean.
#
# Expected: the mean of planes is a mean of axes, as a pole and its opposite are the same plane: three
#     joints that dip with 84 to 88 degrees to the east, and three to the west, have a vertical mean.
# Seen: `find_mean_vector(..., measurement="poles")` returns a pole with a plunge of 90 degrees, a
#     horizontal plane, and a resultant length of 0.07.  `find_fisher_stats` has the same mean, a
#     concentration of 0.9, and a confidence cone of NaN.  `fit_pole` of the same
#     joints has a dip of 90 degrees.  With dips of 64 to 68 degrees to the east all agree.
# Meaning: poles are taken as vectors that point down, and those of steep joints point to both sides.
#     The joint set that decides on toppling, wedges and inflow gets any mean and no concentration,
#     while flat sets are right.  Turn the poles into one half space around the set first, or use
#     `fit_pole`, and look at the resultant length.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    mplstereonet==0.6.3 numpy==2.4.6 matplotlib==3.11.2
cat > run.py <<'PY'
import mplstereonet
import numpy as np

DIPS = np.array([84.0, 86.0, 88.0])


def statistics(strikes, dips):
    """Dip of the mean plane three times: mean vector, Fisher statistics, axis of the poles."""
    (plunge, _), length = mplstereonet.find_mean_vector(strikes, dips, measurement="poles")
    (fisher, _), values = mplstereonet.find_fisher_stats(strikes, dips, measurement="poles")
    _, axis = mplstereonet.fit_pole(strikes, dips)
    # Independent: the largest eigenvector of the sum of products of the normals.
    strike, dip = np.radians(strikes), np.radians(dips)
    normals = np.stack([np.cos(strike) * np.sin(dip), -np.sin(strike) * np.sin(dip), np.cos(dip)])
    right = np.degrees(np.arccos(abs(np.linalg.eigh(normals @ normals.T)[1][2, -1])))
    print(f"dip of the mean plane: {90 - plunge:.1f} by find_mean_vector, {90 - fisher:.1f} by "
          f"find_fisher_stats, {axis:.1f} by fit_pole, right {right:.1f}")
    print(f"   resultant length {length:.2f}, Fisher statistics {[round(float(v), 2) for v in values]}")
    assert abs(fisher - plunge) < 1e-6
    return 90 - plunge, axis, right, length


strikes = np.repeat([0.0, 180.0], 3)
mean, axis, right, length = statistics(strikes, np.tile(DIPS, 2))
assert abs(mean) < 0.1 and abs(right - 90) < 0.1 and abs(axis - 90) < 0.1 and abs(length - 0.07) < 0.01
mean, axis, right, length = statistics(np.zeros(3), DIPS - 20)
assert abs(mean - right) < 0.1 and abs(axis - right) < 0.1 and length > 0.99
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
