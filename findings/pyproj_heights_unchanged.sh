#!/usr/bin/env bash
# pyproj 3.7.2 (PROJ 9.5.1): a height of the satellite is returned as a height above the sea.
#
# Expected: without the grid of the geoid, a transformation from ellipsoidal heights to heights
#     above mean sea level is refused, at least with `only_best=True` and `errcheck=True`.
# Seen: at 52 degrees north, 5 degrees east a height of 43 m is returned as 43.0 m for EGM96, for
#     the Dutch NAP and for the German DHHN2016, where the geoid is more than 40 m above the
#     ellipsoid.  No error and no warning in any of the settings.  Only the words "ballpark vertical
#     transformation" in the description tell it, and `TransformerGroup`, which warns of the missing
#     grid.
# Meaning: the wheels have no grids and the network is off by default.  Boreholes and piezometers
#     surveyed by GNSS then lie 43 m above a model in national heights.  Check
#     `TransformerGroup(...).best_available`, or one benchmark of known height.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    pyproj==3.7.2
cat > run.py <<'PY'
import warnings

import pyproj
from pyproj.transformer import TransformerGroup

pyproj.network.set_network_enabled(False)
for source, target in (
    ("EPSG:4979", "EPSG:4326+5773"), ("EPSG:4979", "EPSG:7415"), ("EPSG:4937", "EPSG:4258+7837")
):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for only_best in (None, True):
            change = pyproj.Transformer.from_crs(
                source, target, always_xy=True, only_best=only_best
            )
            height = change.transform(5.0, 52.0, 43.0, errcheck=True)[2]
            assert height == 43.0
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        group = TransformerGroup(source, target, always_xy=True)
    print(f"{source} to {target}: {height} m, best available {group.best_available}")
    print("   ", str(caught[0].message)[:90])
    assert not group.best_available and "missing Grid" in str(caught[0].message)
PY
PROJ_NETWORK=OFF venv/bin/python run.py
