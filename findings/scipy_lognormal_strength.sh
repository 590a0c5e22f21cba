#!/usr/bin/env bash
# scipy 1.17.1: the characteristic strength is the smallest sample, and the mean is infinite.
#
# Expected: `lognorm.fit` of eight strengths is the log-normal distribution of their logarithms, or
#     one with a 5 % fractile within a few per cent of it.
# Seen: for twelve samples of eight, drawn with a median of 50 kPa and a scatter of 0.25 in the
#     logarithm, the fitted shape is 11.4 to 12.2 in place of 0.14 to 0.33, and the 5 % fractile is
#     the smallest strength of the sample to 1e-8.  It is 0.78 to 1.10 times that of the fit with
#     floc=0, and the fitted mean is 1e27 kPa and more.
# Meaning: the third parameter, a shift, is free by default, and the likelihood grows without limit as
#     the shift approaches the smallest value.  Random fields and Monte Carlo runs with these
#     parameters have strengths of zero spread and a few of any size; a characteristic value is
#     just one test.  Give `floc=0`, or fit the logarithms by `norm.fit`.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1
cat > run.py <<'PY'
import numpy as np
from scipy.stats import lognorm

ratios, shapes, means = [], [], []
for seed in range(12):
    strengths = 50 * np.exp(0.25 * np.random.default_rng(seed).standard_normal(8))
    free, shifted = lognorm.fit(strengths), lognorm.fit(strengths, floc=0)
    assert abs(shifted[0] - np.log(strengths).std()) < 1e-6
    low, right = lognorm.ppf(0.05, *free), lognorm.ppf(0.05, *shifted)
    assert abs(low - strengths.min()) < 1e-6
    ratios.append(low / right)
    shapes.append(free[0])
    means.append(lognorm.mean(*free))
    print(f"shape {free[0]:.2f}, with floc=0 {shifted[0]:.2f}; 5 % fractile {low:.2f} and {right:.2f} "
          f"kPa, smallest {strengths.min():.2f} kPa; mean {means[-1]:.1e}")
print(f"shapes {min(shapes):.1f} to {max(shapes):.1f}, ratios {min(ratios):.2f} to {max(ratios):.2f}")
assert min(shapes) > 5 and min(means) > 1e12
assert min(ratios) < 0.85 and max(ratios) > 1.05
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
