#!/usr/bin/env bash
# numpy 2.4.6, scikit-learn 1.9.1, statsmodels 0.15.0: five samples count as twenty-five.
#
# Expected: a line through means of several samples, with the numbers of samples as weights, is the
#     line through all samples, in each library.
# Seen: strengths of 20, 60 and 30 kPa at 0, 1 and 2 m, means of 1, 2 and 5 samples.  The line through all
#     eight falls by 3.75 kPa per m; statsmodels (`WLS`, weights) and scikit-learn (`sample_weight`)
#     agree.  That of `numpy.polyfit` (w) falls by 11.5 kPa per m, as through 1, 4 and 25 samples: weights
#     multiply the residuals before they are squared.  With the roots of the numbers it agrees.
# Meaning: a profile of strength or a trend of heads follows the places with many tests too closely, and
#     an argument for weights has to be 1/sigma in one library and 1/sigma**2 in the others.  Repeat the
#     points once, and compare.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 scikit-learn==1.9.1 statsmodels==0.15.0
cat > run.py <<'PY'
import numpy as np
import statsmodels.api as sm
from sklearn.linear_model import LinearRegression

DEPTH, STRENGTH, SAMPLES = np.array([0.0, 1, 2]), np.array([20.0, 60, 30]), np.array([1, 2, 5])


def repeated(times):
    """Slope of the line through repeated points."""
    return np.polyfit(np.repeat(DEPTH, times), np.repeat(STRENGTH, times), 1)[0]


table = sm.add_constant(DEPTH)
found = {
    "statsmodels": sm.WLS(STRENGTH, table, weights=SAMPLES).fit().params[1],
    "scikit-learn": LinearRegression().fit(DEPTH[:, None], STRENGTH, SAMPLES).coef_[0],
    "numpy": np.polyfit(DEPTH, STRENGTH, 1, w=SAMPLES)[0],
    "numpy with roots": np.polyfit(DEPTH, STRENGTH, 1, w=np.sqrt(SAMPLES))[0],
}
right, squared = repeated(SAMPLES), repeated(SAMPLES**2)
print(f"all samples {right:.4f} kPa per m, with the squares of their numbers {squared:.4f}")
for name, slope in found.items():
    print(f"{name}: {slope:.4f}")
    assert abs(slope - (squared if name == "numpy" else right)) < 1e-9
assert abs(right - squared) > 1
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
