#!/usr/bin/env bash
# richdem2 2.4.3: at the edge of a survey a slope of 30 degrees has 16 degrees, beside a gap 23.
#
# Expected: `TerrainAttribute` has no value for a cell with missing neighbours, or computes it from those
#     that are there, so that a plane has one slope everywhere.
# Seen: a plane of 30 degrees, cells of 1 m, one cell without data.  Inside it is 30.0 degrees.  Of the
#     eight cells around the gap two have 23.4 degrees and four 27.0, and in these the aspect turns by 8
#     degrees.  The lowest and the highest row of the survey have 16.1 degrees, its other two sides 23.4.
#     A missing neighbour has the height of the cell itself.  The gap has no value.  No message.
# Meaning: surveys are full of gaps (buildings and plants that were filtered out, water, shadow) and cut
#     into tiles.  tan(16.1) is half of tan(30), so that an infinite slope in sand has twice its factor of
#     safety along each of them, and a screening by a limit angle leaves out the rim of a cut.  Drop all
#     cells that touch a gap or a border.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    richdem2==2.4.3 numpy==2.4.6
cat > run.py <<'PY'
import numpy as np
import richdem

SIDE, GAP = 21, 10
rise = np.tile(np.arange(SIDE) * np.tan(np.radians(30.0)), (SIDE, 1))
for turned in (False, True):
    heights = np.array(rise.T if turned else rise)
    heights[GAP, GAP] = -9999.0
    survey = richdem.rdarray(heights, no_data=-9999.0)
    survey.geotransform = (0.0, 1.0, 0.0, 0.0, 0.0, -1.0)
    slope, aspect = (
        np.array(richdem.TerrainAttribute(survey, attrib=name)) for name in ("slope_degrees", "aspect")
    )
    if turned:
        slope, aspect = slope.T, aspect.T
    around = slope[GAP - 1 : GAP + 2, GAP - 1 : GAP + 2]
    turn = np.abs((aspect[GAP - 1 : GAP + 2, GAP - 1 : GAP + 2] - aspect[5, 5] + 180) % 360 - 180)
    print(f"\nplane that rises to the {'south' if turned else 'east'}: inside {slope[5, 5]:.1f} degrees")
    print(f"    around the gap {around.round(1).tolist()}, turned by {turn[0].round(1).tolist()}")
    print(
        f"    border at the foot and the head {slope[5, [0, -1]].round(1)}, at the sides {slope[[0, -1], 5].round(1)}"
    )
    assert np.allclose(slope[2:8, 2:8], 30.0, atol=1e-3)
    assert np.allclose(around[1, [0, 2]], 23.41, atol=0.01) and np.allclose(
        around[[0, 2], 1], 30.0, atol=1e-3
    )
    assert np.allclose(around[[0, 0, 2, 2], [0, 2, 0, 2]], 27.0, atol=0.1) and around[1, 1] == -9999
    assert np.allclose(turn[[0, 0, 2, 2], [0, 2, 0, 2]], 8.1, atol=0.1)
    assert np.allclose(slope[5, [0, -1]], 16.10, atol=0.01) and np.allclose(
        slope[[0, -1], 5], 23.41, atol=0.01
    )
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
