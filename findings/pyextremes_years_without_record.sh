#!/usr/bin/env bash
# pyextremes 2.6.1: years in which the gauge was away count as years without a storm.
#
# Expected: peaks over a threshold have a rate of events per year of record.  Twenty years of daily levels have the same
#     100-year level whether they are in one piece or in two with fifty years between them.
# Seen: Gumbel levels (0, 1 m a day) of twenty years, threshold 5 m: in one piece 8.88 m, with the second half fifty
#     years later 8.01 m.  The second is exactly the 29-year level of the first: 100 times 20 over 70.  The
#     rate is 2.7 events a year in the one and 0.8 in the other, by the last less the first date.  Block maxima of the
#     same record stop with an error because of the empty blocks.  No message here.
# Meaning: design levels of floods, waves, ice and groundwater from a record with a gap are too low, here by
#     0.9 m.  Close the gap by a shift of the later dates, or ask for the return period times the span over
#     the years of record.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    pyextremes==2.6.1 numpy==2.4.6 scipy==1.17.1 pandas==2.3.3
cat > run.py <<'PY'
import numpy as np
import pandas as pd
from pyextremes import EVA

THRESHOLD, PERIOD, YEAR = 5.0, 100.0, pd.Timedelta("365.2425D")  # m, years
dates = pd.date_range("1950-01-01", "1969-12-31", freq="D")
levels = np.random.default_rng(7).gumbel(0.0, 1.0, dates.size)  # m
half = dates.size // 2
later = dates[:half].append(dates[half:] + 50 * YEAR)


def analysis(index):
    """Peaks over the threshold of the same levels on other dates."""
    model = EVA(pd.Series(levels, index=index))
    model.get_extremes("POT", threshold=THRESHOLD, r="1D")
    model.fit_model(model="MLE", distribution="expon")
    return model


def level(model, period):
    """Level of a return period in m."""
    return float(model.get_return_value(period, alpha=None)[0])


together, apart = analysis(dates), analysis(later)
assert np.array_equal(together.extremes.to_numpy(), apart.extremes.to_numpy())

years = dates.size / 365.2425
excess = together.extremes.to_numpy() - THRESHOLD
right = THRESHOLD + excess.mean() * np.log(PERIOD * excess.size / years)  # exponential tail, rate per year of record
span = [(index[-1] - index[0]) / YEAR for index in (dates, later)]
found = level(together, PERIOD), level(apart, PERIOD)
print(f"{excess.size} events in {years:.0f} years; spans {span[0]:.1f} and {span[1]:.1f} years")
print(f"100-year level: one piece {found[0]:.2f} m, two pieces {found[1]:.2f} m, by hand {right:.2f} m")
shorter = PERIOD * span[0] / span[1]  # years
print(f"level of {shorter:.1f} years in one piece: {level(together, shorter):.2f} m")
assert abs(found[0] - right) < 0.01
assert abs(found[1] - (right - excess.mean() * np.log(span[1] / span[0]))) < 0.01 and found[0] - found[1] > 0.8
assert abs(level(together, shorter) - found[1]) < 0.01
assert abs(level(apart, PERIOD * span[1] / span[0]) - right) < 0.01

try:
    EVA(pd.Series(levels, index=later)).get_extremes("BM", block_size="365.2425D")
except ValueError as refusal:
    print("block maxima:", refusal)
else:
    raise AssertionError("block maxima were taken over empty years")
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
