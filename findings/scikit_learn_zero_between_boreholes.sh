#!/usr/bin/env bash
# scikit-learn 1.9.1: between boreholes with 10 MPa the soil has a strength of zero.
#
# Expected: a Gaussian process through cone resistances of about 10 MPa returns to their mean
#     between distant boreholes, as ordinary kriging does, with the scatter of the readings.
# Seen: with RBF(10), fixed or fitted, the prediction 50 m from two groups of boreholes is 0.00 to
#     0.01 MPa, with a standard deviation of 1.00.  The default kernel, whose length of 1 is not
#     fitted, gives 0.00 MPa halfway between readings that are 10 m apart.  With `normalize_y=True`
#     it is 10.17 MPa, the mean of the readings, plus or minus 0.63.
# Meaning: the mean of the process is zero and its variance one, whatever the data are.  A stiffness
#     or a strength interpolated by default has holes between the boreholes, with a narrow band of
#     confidence around zero.  Set `normalize_y`, or subtract a trend first.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    scikit-learn==1.9.1 numpy==2.4.6 scipy==1.17.1
cat > run.py <<'PY'
import warnings

import numpy as np
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF

warnings.simplefilter("error")
place = np.array([0, 10, 20, 30, 130, 140, 150, 160.0])[:, None]
strength = np.array([9.2, 10.5, 11.1, 9.8, 10.2, 11.0, 9.5, 10.1])


def predict(x, **options):
    """Prediction and standard deviation at one location, in MPa."""
    process = GaussianProcessRegressor(**options).fit(place, strength)
    mean, deviation = process.predict([[x]], return_std=True)
    return mean[0], deviation[0]


cases = (
    ("default, between 10 and 20 m", 15.0, {}, 0.0),
    ("RBF(10) fixed, at 80 m", 80.0, {"kernel": RBF(10), "optimizer": None}, 0.0),
    ("RBF(10) fitted, at 80 m", 80.0, {"kernel": RBF(10)}, 0.0),
    ("RBF(10) fixed, normalize_y, at 80 m", 80.0,
     {"kernel": RBF(10), "optimizer": None, "normalize_y": True}, strength.mean()),
)
for name, x, options, right in cases:
    mean, deviation = predict(x, **options)
    print(f"{name}: {mean:.2f} +- {deviation:.2f} MPa (readings {strength.mean():.2f})")
    assert abs(mean - right) < 0.05
    assert "fixed, at" not in name or abs(deviation - 1) < 0.01
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
