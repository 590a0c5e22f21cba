#!/usr/bin/env bash
# geopandas 1.2.0: 10 m of drain along the border of two soils are 20 m, in both soils.
#
# Expected: `overlay` of lines with the areas of a map divides them, so that lengths keep their sum, and
#     a line on a common border belongs to one area, or is reported.
# Seen: a drain of 10 m on the border of clay and sand has a length of 10 m in each, 20 m in sum; one a
#     millimetre beside it has 10 m.  A borehole on the border is in both by `sjoin`, which makes three
#     rows of two boreholes, and in neither by predicate="within".  The discharge of the drain,
#     an attribute of 5 l/s, stands in both rows.  No message.
# Meaning: boundaries of soils are often drawn along drains, walls and section lines.  Quantities and
#     discharges count twice there, and means of boreholes weigh those on a border more.  Compare
#     lengths and numbers before and after, and drop repeated rows by their index.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    geopandas==1.2.0 shapely==2.2.0 pandas==3.1.1 numpy==2.4.6
cat > run.py <<'PY'
import warnings

import geopandas
from shapely import LineString, Point, box

warnings.simplefilter("error")
soils = geopandas.GeoDataFrame({"soil": ["clay", "sand"]}, geometry=[box(0, 0, 4, 10), box(4, 0, 10, 10)])


def drain(x):
    """Lengths and discharges of a drain of 10 m at x in the soils."""
    line = geopandas.GeoDataFrame({"discharge": [5.0]}, geometry=[LineString([(x, 0), (x, 10)])])
    parts = geopandas.overlay(line, soils, how="intersection")
    return parts.soil.tolist(), parts.length.tolist(), parts.discharge.tolist()


on_border, beside = drain(4.0), drain(4.001)
print("on the border", on_border, "beside it", beside)
boreholes = geopandas.GeoDataFrame({"strength": [90.0, 30.0]}, geometry=[Point(4, 5), Point(1, 1)])
joined = geopandas.sjoin(boreholes, soils)
within = geopandas.sjoin(boreholes, soils, predicate="within")
print(f"{len(boreholes)} boreholes are {len(joined)} rows, {len(within)} by within; mean strength "
      f"{boreholes.strength.mean():.0f}, {joined.strength.mean():.0f} and {within.strength.mean():.0f} kPa")
assert on_border == (["clay", "sand"], [10.0, 10.0], [5.0, 5.0])
assert beside == (["sand"], [10.0], [5.0])
assert (len(joined), len(within)) == (3, 1)
assert (joined.strength.mean(), within.strength.mean()) == (70.0, 30.0)
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
