#!/usr/bin/env bash
# striplog 0.9.2: the share of sand in a boring counts only the thinnest sand and the thinnest clay.
#
# Expected: `net_to_gross` is "the ratio of intervals having that attribute as True to the total thickness": for 8 m of
#     sand, 1 m of gravel, 3.5 m of clay and 2.5 m of peat with the attribute on sand and gravel 9 / 15 = 0.6.
# Seen: 0.286, which is gravel over gravel and peat, 1 / 3.5.  With gravel of 8 m and sand of 1 m it is the same.  With
#     sand and clay alone, 9 m and 6 m, it is 0.6.  The total thickness of the log is 15.0 m in both.  No message.
# Meaning: the thicknesses of the components replace each other in place of being added.  Shares of drained layers, of
#     weak layers or of rock to excavate are wrong as soon as one group has two components.  Sum the thicknesses
#     of `unique`.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    striplog==0.9.2 numpy==1.26.4 scipy==1.11.4 pandas==1.5.3
cat > run.py <<'PY'
import warnings

from striplog import Component, Interval, Striplog

warnings.filterwarnings("ignore", category=DeprecationWarning)
DRAINED = {"sand": True, "gravel": True, "clay": False, "peat": False}


def boring(*layers):
    """A log from the surface down of pairs of soil and thickness in m."""
    depth, intervals = 0.0, []
    for soil, thickness in layers:
        component = Component({"lithology": soil, "drained": DRAINED[soil]})
        intervals.append(Interval(depth, depth + thickness, components=[component]))
        depth += thickness
    return Striplog(intervals)


for layers, seen in (
    ((("sand", 8.0), ("clay", 3.5), ("gravel", 1.0), ("peat", 2.5)), 1 / 3.5),
    ((("sand", 1.0), ("clay", 3.5), ("gravel", 8.0), ("peat", 2.5)), 1 / 3.5),
    ((("sand", 5.0), ("clay", 6.0), ("sand", 4.0)), 0.6),
):
    log = boring(*layers)
    right = sum(thickness for soil, thickness in layers if DRAINED[soil]) / log.cum
    summed = sum(thickness for component, thickness in log.unique if component["drained"]) / log.cum
    found = log.net_to_gross("drained")
    print(f"{layers}: {found:.3f}, by the sum of `unique` {summed:.3f}, right {right:.3f}")
    assert abs(found - seen) < 1e-9 and abs(summed - right) < 1e-9 and abs(right - 0.6) < 1e-9
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
