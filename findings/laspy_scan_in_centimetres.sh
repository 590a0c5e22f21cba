#!/usr/bin/env bash
# laspy 2.7.0: a surface that settled by 4 mm between two scans has not moved.
#
# Expected: heights that are given in double precision are stored to a fraction of a millimetre, as
#     the format holds any resolution, or a message says how they are rounded.
# Seen: `laspy.create()` has a scale of 0.01 in all directions.  Heights of 12.001 m before and 11.997
#     m after an excavation are both 12.00 m in memory and in the file, and the settlement is 0.  11.994
#     m is 11.99: 10 mm in place of 7 mm.  No message.  With `header.scales` of 0.0001 and an offset
#     near the site the settlement is 4 mm.
# Meaning: coordinates are whole numbers times the scale of the header, and the default is a
#     centimetre: maps of settlement from two scans show steps of 10 mm and nothing between, although
#     the scanner measured them.  Set scales and offsets before the coordinates.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    laspy==2.7.0 numpy==2.4.6
cat > run.py <<'PY'
import warnings

import laspy
import numpy as np

warnings.simplefilter("error")
x, y = np.array([352345.678, 352350.123]), np.array([5812345.678, 5812350.123])


def heights(before, fine=False):
    """Heights that are read from a file, after a height has been written to it."""
    scan = laspy.create(point_format=3, file_version="1.2")
    if fine:
        scan.header.scales, scan.header.offsets = [1e-4] * 3, [352000.0, 5812000.0, 0.0]
    scan.x, scan.y, scan.z = x, y, np.full(2, before)
    scan.write("scan.las")
    return np.array(laspy.read("scan.las").z)


for fine in (False, True):
    before, four, seven = [heights(level, fine) for level in (12.001, 11.997, 11.994)]
    print(f"fine {fine}: settlement {1e3 * (before - four)} mm of 4, {1e3 * (before - seven)} mm of 7")
    right = (4.0, 7.0) if fine else (0.0, 10.0)
    assert np.allclose(1e3 * (before - four), right[0], atol=1e-6)
    assert np.allclose(1e3 * (before - seven), right[1], atol=1e-6)
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
