#!/usr/bin/env bash
# quantities 0.16.4: 500 mm become 500 m.
#
# Expected: functions of numpy on lengths in m and in mm convert one to the other, or raise, as with
#     pint and unyt, and the result has a unit.
# Seen: `full_like` of depths in m with 500 mm is 500 m.  `concatenate` of (1, 2) m and (500, 700) mm is
#     1, 2, 500, 700 "dimensionless".  `searchsorted`, `interp` and `where` compare and mix the plain
#     numbers.  No message.  pint has 0.5 m in all of them; unyt has 500 mm for `full_like`, and raises
#     for the others.
# Meaning: a part of numpy's functions is covered and the other part sees bare numbers, so that a list of
#     layers or a look-up by depth is wrong by 1000 where readings in mm meet a drawing in m.  Rescale
#     every array before it goes into numpy, or use another package.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    quantities==0.16.4 pint==0.25.3 unyt==3.2.0 numpy==2.4.6
cat > run.py <<'PY'
import numpy as np
import pint
import quantities
import unyt

PACKAGES = {
    "quantities": quantities.Quantity, "pint": pint.UnitRegistry().Quantity, "unyt": unyt.unyt_array,
}
WORK = {
    "full_like": lambda m, mm: np.full_like(m, mm[0]),
    "concatenate": lambda m, mm: np.concatenate([m, mm]),
    "where": lambda m, mm: np.where([True, False], m, mm),
    "searchsorted": lambda m, mm: np.searchsorted(m, mm),
    "interp": lambda m, mm: np.interp(mm, m, [10.0, 20.0]),
}
found = {}
for package, quantity in PACKAGES.items():
    for name, function in WORK.items():
        m, mm = quantity([1.0, 2.0], "m"), quantity([500.0, 1500.0], "mm")
        try:
            result = function(m, mm)
            found[package, name] = np.asarray(getattr(result, "magnitude", result)).tolist()
            unit = getattr(result, "units", "no unit")
        except Exception as error:
            found[package, name], unit = type(error).__name__, ""
        print(package, name, found[package, name], unit)

RESULTS = {
    "full_like": [500, 500], "concatenate": [1, 2, 500, 1500], "where": [1, 1500], "searchsorted": [2, 2],
    "interp": [20, 20],
}
RIGHT = {
    "concatenate": [1, 2, 0.5, 1.5], "where": [1, 1.5], "searchsorted": [0, 1], "interp": [10, 15],
}
assert all(found["quantities", name] == result for name, result in RESULTS.items())
assert all(found["pint", name] == result for name, result in RIGHT.items())
assert all(found["unyt", name] == "UnitInconsistencyError" for name in RIGHT)
assert np.full_like(quantities.Quantity([1.0], "m"), quantities.Quantity(500.0, "mm")).units == quantities.m
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
