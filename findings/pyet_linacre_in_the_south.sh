#!/usr/bin/env bash
# pyet 1.5.0: evaporation by Linacre is a quarter smaller in the south than in the north.
#
# Expected: 500 Tm / (100 - A), with A "the latitude in degrees" (Linacre 1977), is larger at high latitudes of
#     either side; the formula knows no season, so that the same weather at 35 degrees north and south has the same
#     evaporation.
# Seen: 20 degrees with a dew point of 10 degrees at 100 m: 5.14 mm a day at 35 degrees north and 3.77 at 35 degrees
#     south; at 45 degrees 5.62 and 3.68.  South of the equator it falls with latitude.
#     No message.
# Meaning: A goes in with its sign.  For dams and tailings in Australia, Chile or South Africa the demand is a quarter
#     to a third too small.  Give this one method the absolute value of the latitude.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    pyet==1.5.0 numpy==2.4.6 scipy==1.17.1 pandas==2.3.3
cat > run.py <<'PY'
import math

import pandas as pd
import pyet

TEMPERATURE, DEW_POINT, ELEVATION = 20.0, 10.0, 100.0  # degrees, m
DAYS = pd.to_datetime(["2024-03-20"])  # day and night are equal


def evaporation(latitude):
    """Millimetres per day at a latitude in degrees."""
    (found,) = pyet.linacre(
        pd.Series([TEMPERATURE], DAYS),
        ELEVATION,
        math.radians(latitude),
        tdew=pd.Series([DEW_POINT], DAYS),
    )
    return found


def by_hand(latitude):
    """Equation of Linacre (1977) with the distance from the equator in degrees."""
    at_sea_level = TEMPERATURE + 0.006 * ELEVATION
    return (500 * at_sea_level / (100 - abs(latitude)) + 15 * (TEMPERATURE - DEW_POINT)) / (80 - TEMPERATURE)


for latitude, seen in ((35.0, 3.772), (45.0, 3.684)):
    north, south, right = evaporation(latitude), evaporation(-latitude), by_hand(latitude)
    print(f"{latitude} degrees: {north:.3f} mm a day in the north, {south:.3f} in the south, by hand {right:.3f}")
    assert abs(north / right - 1) < 1e-6 and abs(south - seen) < 0.01
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
