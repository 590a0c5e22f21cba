#!/usr/bin/env bash
# chaospy 4.3.21: the most probable value of a PERT distribution is not the one that was given.
#
# Expected: `PERT(lower, mode, upper)` has its greatest density at the mode, and the mean
#     (lower + 4 mode + upper) / 6, as its documentation says.
# Seen: for 10, 12 and 20 the greatest density is at 13.0, the value that the mean should have, and the
#     mean is 13.67.  For 10, 18 and 20 they are 17.0 and 16.33.  The shape comes from the mean where
#     it has to come from the mode, so that a skew distribution is drawn to its middle.
# Meaning: the estimate "least, most probable, greatest" is the usual one for strengths, moduli and
#     costs without tests.  With a low modulus as the most probable one the settlement is too
#     small.  Use `Beta` with 1 + 4 (mode - lower) / (upper - lower) and 1 + 4 (upper - mode) /
#     (upper - lower).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    chaospy==4.3.21 numpy==2.4.6
cat > run.py <<'PY'
import chaospy
import numpy as np


def shape(distribution, lower, upper):
    """Mean and place of the greatest density."""
    x = np.linspace(lower, upper, 20001)
    return float(chaospy.E(distribution)), float(x[distribution.pdf(x).argmax()])


for lower, mode, upper, mean_seen, mode_seen in ((10, 12, 20, 13.667, 13.0), (10, 18, 20, 16.333, 17.0)):
    mean, peak = shape(chaospy.PERT(lower, mode, upper), lower, upper)
    right = (lower + 4 * mode + upper) / 6
    width = upper - lower
    beta = chaospy.Beta(1 + 4 * (mode - lower) / width, 1 + 4 * (upper - mode) / width, lower, upper)
    known = shape(beta, lower, upper)
    print(f"PERT({lower}, {mode}, {upper}): mode {peak:.2f}, mean {mean:.2f}; right {mode:.2f} and "
          f"{right:.2f}; beta distribution {known[1]:.2f} and {known[0]:.2f}")
    assert abs(peak - mode_seen) < 0.01 and abs(mean - mean_seen) < 0.001
    assert abs(known[1] - mode) < 0.01 and abs(known[0] - right) < 1e-6
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
