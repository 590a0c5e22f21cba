#!/usr/bin/env bash
# pandas 3.1.1: a month in which the rain gauge was broken is the driest of the year.
#
# Expected: the monthly sum of days that are all NaN is NaN, as their mean is.
# Seen: rain of 3 mm on every day, no readings from 1 February to 15 March.  The sums of the months
#     are 93, 0 and 48 mm.  The means are 3, NaN and 3 mm.  `cumsum` goes on after the gap as if no
#     rain had fallen.  With `min_count=28` the sums are 93, NaN and NaN.
# Meaning: NaN counts as zero in sums, also of a whole month.  Recharge, the rise of ground water
#     and antecedent rain of a landslide are computed from a drought that was a broken cable.
#     Settlement increments, blow counts and volumes of grout behave alike.  Give `min_count`, or sum
#     means times days.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    pandas==3.1.1 numpy==2.4.6
cat > run.py <<'PY'
import numpy as np
import pandas as pd

rain = pd.Series(3.0, index=pd.date_range("2026-01-01", "2026-03-31"))
rain["2026-02-01":"2026-03-15"] = np.nan
months = rain.resample("MS")
table = pd.DataFrame(
    {"sum": months.sum(), "mean": months.mean(), "sum of 28 or more": months.sum(min_count=28)}
)
print(table)
print(f"sum of February {rain['2026-02'].sum()} mm, cumulative at the end {rain.cumsum().iloc[-1]} mm")
assert table["sum"].tolist() == [93, 0, 48]
assert table["mean"].isna().tolist() == [False, True, False]
assert table["sum of 28 or more"].isna().tolist() == [False, True, True]
assert rain.cumsum().iloc[-1] == 141
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
