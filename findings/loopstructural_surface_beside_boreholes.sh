#!/usr/bin/env bash
# LoopStructural 1.9.0: the top of a layer passes 1 to 4 m above the borehole that found it.
#
# Expected: the surface of value 0 passes through the five points that have the value 0, to a small part of a metre, as
#     nothing contradicts them, and the more elements, the closer.
# Seen: a site of 1 km x 1 km x 100 m, the top of the clay at 20, 25, 30 and 22 m in the corners and at 40 m in the
#     middle.  `create_and_add_foliation` passes the borehole in the middle 0.97 m too high by default, 1.10 m with 1000
#     elements and 2.45 m with 3000.  With the interpolator "PLI" it is 3.22 and 4.05 m, and up to 2.3 m too low in the
#     corners.  The result does not depend on the unit of length.  No message.
# Meaning: points and smoothness are weighed against each other in one sum of squares, and the smoothness of thousands
#     of elements outweighs five points.  Layers are too flat and volumes of excavation wrong, the more so the fewer
#     the boreholes are.  With `regularisation=0.1` or `cpw=10` the surface is within 0.02 m.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    LoopStructural==1.9.0 loop-interpolation==0.0.2 loop-common==0.0.2 numpy==2.4.6 scipy==1.17.1 pandas==3.1.1
cat > run.py <<'PY'
import numpy as np
import pandas
from LoopStructural import GeologicalModel

BOREHOLES = ((100, 100, -20), (900, 100, -25), (100, 900, -30), (900, 900, -22), (500, 500, -40))  # m


def errors(unit=1.0, **options):
    """Level of the surface above the top of the clay in each borehole in m."""
    rows = [{"X": x * unit, "Y": y * unit, "Z": z * unit, "val": 0.0, "feature_name": "clay"} for x, y, z in BOREHOLES]
    middle = BOREHOLES[-1]
    rows.append(
        {"X": middle[0] * unit, "Y": middle[1] * unit, "Z": middle[2] * unit, "nx": 0.0, "ny": 0.0, "nz": 1.0,
         "feature_name": "clay"}
    )
    model = GeologicalModel([0, 0, -100 * unit], [1000 * unit, 1000 * unit, 0])
    model.data = pandas.DataFrame(rows)
    model.create_and_add_foliation("clay", **options)
    found, levels = [], np.linspace(-99, -1, 9801)
    for x, y, z in BOREHOLES:
        line = np.column_stack((np.full_like(levels, x), np.full_like(levels, y), levels)) * unit
        values = model.evaluate_feature_value("clay", line)
        crossing, = np.nonzero(np.diff(np.sign(values)))
        assert len(crossing) == 1
        found.append(levels[crossing[0]] - z)
    return np.array(found)


for options, seen in (
    ({}, 0.97), ({"nelements": 1000}, 1.10), ({"nelements": 3000}, 2.45), ({"nelements": 1000, "unit": 1e-3}, 1.10),
    ({"nelements": 1000, "interpolatortype": "PLI"}, 3.22), ({"nelements": 3000, "interpolatortype": "PLI"}, 4.05),
    ({"nelements": 1000, "regularisation": 0.1}, 0.0), ({"nelements": 1000, "cpw": 10.0}, 0.0),
):
    found = errors(**options)
    print(f"{options or 'default'}: {' '.join(f'{error:+.2f}' for error in found)} m")
    assert abs(found[-1] - seen) < 0.1
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
