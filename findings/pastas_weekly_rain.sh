#!/usr/bin/env bash
# pastas 2.0.0: weekly sums of rain make it rain seven times as much.
#
# Expected: a series of weekly sums in mm is spread over the days of the week when the model
#     needs daily values, or a message says that a rate per day is expected.
# Seen: three years with 2379 mm.  With daily values the stress of the model has 2379 mm, with weekly sums
#     16,582 mm and with monthly sums 73,649 mm: each day has the sum of its period ("bfill").  The
#     same for evaporation.  In a recharge model with weekly rain and daily evaporation the
#     recharge is 14,391 mm in place of 189 mm.  No message.
# Meaning: with one stress the gain of the response hides the factor.  Where two stresses with different
#     steps meet, or the gain is read as a property of the ground, the model is wrong.  Divide
#     sums by the days of their period first.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    pastas==2.0.0 numpy==2.4.6 pandas==3.1.1 tqdm==4.70.1
cat > run.py <<'PY'
import warnings

import numpy as np
import pandas as pd
import pastas

warnings.simplefilter("ignore", FutureWarning)
YEARS = slice("2016", "2018")
days = pd.date_range("2015-01-01", "2019-12-31")
rain = pd.Series(np.random.default_rng(0).gamma(0.3, 8, len(days)), days)
evaporation = pd.Series(2 + 1.5 * np.sin(2 * np.pi * (days.day_of_year - 80) / 365), days)


def total(series, kind):
    """Sum in mm over three years of a stress in the form that the model uses."""
    stress = pastas.timeseries.TimeSeries(series, settings=kind)
    stress.update_series(freq="D", tmin=pd.Timestamp("2016-01-01"), tmax=pd.Timestamp("2018-12-31"))
    return stress.series[YEARS].sum()


for name, series, kind in (("rain", rain, "prec"), ("evaporation", evaporation, "evap")):
    sums = [series, series.resample("W").sum(), series.resample("MS").sum()]
    found = [total(values, kind) for values in sums]
    right = series[YEARS].sum()
    print(f"{name}: daily {found[0]:.0f} mm, weekly {found[1]:.0f} mm, monthly {found[2]:.0f} mm; "
          f"right {right:.0f} mm")
    assert abs(found[0] / right - 1) < 1e-9
    assert abs(found[1] / right - 7) < 0.05 and abs(found[2] / right - 31) < 1

for name, series, seen in (("daily", rain, 189), ("weekly", rain.resample("W").sum(), 14391)):
    model = pastas.RechargeModel(series, evaporation, name="recharge", rfunc=pastas.Exponential())
    model.update_stress(freq="D", tmin=pd.Timestamp("2016-01-01"), tmax=pd.Timestamp("2018-12-31"))
    recharge = (model.prec.series - model.evap.series)[YEARS].sum()
    print(f"recharge from {name} rain and daily evaporation {recharge:.0f} mm")
    assert abs(recharge - seen) < 2
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
