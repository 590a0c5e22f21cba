#!/usr/bin/env bash
# geostructpy 0.3.1: the longer the toe of a retaining wall, the more backfill stands on it.
#
# Expected: a base of 3 m under a stem of 0.4 m carries backfill on its heel (`b_heel`): 2.6 m of soil without a
#     toe, 1.6 m with a toe of 1 m.  Resistance to sliding falls with the heel.
# Seen: 5 m high, 18 kN/m3, base of 0.5 m, by `stability.calculate`.  Without a toe 210.6 kN/m of soil at 1.70 m
#     from the edge, right.  With a toe of 1 m again 210.6 kN/m, now at 2.20 m, in place of 129.6 kN/m, and the
#     stem stands at 0.2 m in place of 1.2 m.  Safety against sliding: 1.93 for both, right
#     1.39 with the toe, below the limit of 1.5; against overturning: 4.21, right 3.13.  All four checks are
#     passed.  No message.
# Meaning: the width of the soil is b_base - t_stem, its lever b_base - b_heel / 2: one is right only without a
#     toe, the other always.  The less heel, the safer the wall.  Compare the weights in the table of the report
#     with the drawing.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check geostructpy==0.3.1
cat > run.py <<'PY'
import re
import sys
from importlib.util import find_spec

# the module alone, since the package as a whole needs Python 3.12
sys.path.insert(0, find_spec("geostructpy").submodule_search_locations[0])
import stability

ABOVE, BELOW, STEM, PLATE, BASE = 4.0, 1.0, 0.4, 0.5, 3.0
SOIL, CONCRETE, FRICTION = 18.0, 24.0, 0.5
height = ABOVE + BELOW
pressure = SOIL * height**2 / 6  # Ka = 1 / 3 for 30 degrees


def right(heel):
    """Weight and lever of the backfill, factors of sliding and overturning."""
    toe = BASE - STEM - heel
    parts = [
        (CONCRETE * STEM * (height - PLATE), toe + STEM / 2),
        (CONCRETE * PLATE * BASE, BASE / 2),
        (SOIL * heel * (height - PLATE), BASE - heel / 2),
    ]
    weight = sum(part[0] for part in parts)
    moment = sum(part[0] * part[1] for part in parts)
    return *parts[2], FRICTION * weight / pressure, moment / (pressure * height / 3)


for heel, sliding, overturning in ((2.6, 1.93, 3.37), (1.6, 1.93, 4.21)):
    wall = stability.calculate(ABOVE, BELOW, STEM, PLATE, BASE, heel, SOIL, 30, FRICTION, 300.0, CONCRETE, 0.0)
    rows = re.findall(r"<td>(P\d)[^<]*</td><td>([\d.]+)</td><td>([\d.]+)</td>", wall["report"])
    parts = {name: (float(weight), float(lever)) for name, weight, lever in rows}
    factors = [float(check["fs"]) for check in wall["summary"][:2]]
    true = right(heel)
    print(
        f"heel {heel} m: backfill {parts['P3'][0]} kN/m at {parts['P3'][1]} m, right {true[0]:.1f} at {true[1]:.2f}; "
        f"stem at {parts['P1'][1]} m; sliding {factors[0]}, right {true[2]:.2f}; "
        f"overturning {factors[1]}, right {true[3]:.2f}"
    )
    assert parts["P3"] == (210.6, true[1]) and parts["P1"][1] == 0.2 and wall["allPass"]
    assert factors == [sliding, overturning]
    if heel == 2.6:
        assert abs(true[0] - 210.6) < 1e-9 and abs(true[2] - sliding) < 0.01 and abs(true[3] - overturning) < 0.01
    else:
        assert true[2] < 1.4 and true[0] < 130
PY
venv/bin/python run.py
