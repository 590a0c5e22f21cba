#!/usr/bin/env bash
# geostatspy 0.0.79: the normal score of the weakest sample is extrapolated, and fields have half as much weak soil.
#
# Expected: `nscore` gives each of n values the quantile (k - 0.5) / n of the normal distribution, and `backtr` goes
#     back along the same table, linearly between two values, to the value itself.
# Seen: twenty strengths, one of 15 kPa, the others from 60 to 100 kPa.  The score of the weakest is -7.30 in place of
#     -1.96, the quantile of 2.5 %, though the returned table has -1.96; its back transform is 10.0 kPa, the lower
#     limit.  Scores between the two weakest come back as 57 to 60 kPa in place of 15 to 60 kPa.  Of 20 000 normal
#     scores 2.5 % are below 45 kPa, right are 5.3 %; the fractile of 5 % is 58.4 in place of 42 kPa.
# Meaning: the search in the table starts at the second value, so that the lowest interval gets the slope of the next.
#     The seam of soft clay that a study of reliability is about hardly occurs in the fields.  Take
#     numpy.interp with the returned table in both directions.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    geostatspy==0.0.79 numpy==2.4.6 scipy==1.17.1 pandas==2.3.3 statsmodels==0.15.0 numba==0.68.1 tqdm==4.70.1
cat > run.py <<'PY'
import numpy as np
import pandas as pd
from geostatspy import geostats
from scipy.stats import norm

LIMITS = (10.0, 1, 1.0, 1, 1.0)  # kPa, and linear tails
strength = np.r_[15.0, np.linspace(60.0, 100.0, 19)]  # kPa
number = len(strength)
scores, values, table = geostats.nscore(pd.DataFrame({"strength": strength}), "strength")


def back(normal):
    """Back transform of normal scores with the table of the library."""
    low, *tails = LIMITS
    return geostats.backtr(pd.DataFrame({"score": normal}), "score", values, table, low, 120.0, *tails)


right = norm.ppf((np.arange(number) + 0.5) / number)
print(f"scores of the two weakest: {scores[:2].round(3)}, right {right[:2].round(3)}, table {table[:2].round(3)}; "
      f"back {back(scores)[:2].round(2)} kPa, right {strength[:2]}")
assert np.allclose(table, right, atol=1e-5) and np.allclose(scores[1:], right[1:], atol=1e-5)
assert abs(scores[0] + 7.295) < 0.01 and abs(back(scores)[0] - 10) < 1e-3

between = np.linspace(table[0], table[1], 5)[1:-1]
found, linear = back(between), np.interp(between, table, values)
print(f"between them: {found.round(1)} kPa, right {linear.round(1)} kPa")
assert np.allclose(found, (57, 58, 59), atol=0.01) and np.allclose(linear, (26.25, 37.5, 48.75), atol=0.01)

normal = norm.ppf((np.arange(20000) + 0.5) / 20000)
inside = np.clip(normal, table[0], None)
for name, field, share, fractile in (
    ("library", back(normal), 0.025, 58.5),
    ("linear", np.where(normal < table[0], back(normal), np.interp(normal, table, values)), 0.053, 42.3),
):
    print(f"{name}: {np.mean(field < 45):.1%} below 45 kPa, fractile of 5 % {np.percentile(field, 5):.1f} kPa")
    assert abs(np.mean(field < 45) - share) < 0.002 and abs(np.percentile(field, 5) - fractile) < 1
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
