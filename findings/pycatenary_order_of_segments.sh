#!/usr/bin/env bash
# pycatenary 1.0.0: a cable of chain and rope pulls its anchor alike, whether the chain is at the top or at the bottom.
#
# Expected: a line of two segments, "given in a list going from the anchor to the fairlead", has the force of a heavy
#     and a light catenary that meet, and its vertical forces add up to the weight.
# Seen: 100 m of chain (1 kN/m) and 100 m of rope (0.1 kN/m) between points 150 m and 100 m apart, no floor.  The
#     horizontal force is 43.8 kN with the chain at the anchor, 43.8 kN with the chain at the fairlead; right are 55.9
#     and 32.4 kN.  The vertical force at the anchor is 17.7 kN in both, in size; right are 33.8 and 1.1 kN.  The sum of
#     the vertical forces is right, and so is a line of two equal segments.  No message.
# Meaning: the shape is one catenary with the mean weight; a list of weights only enters the stretch.  Anchors, hanging
#     cables and mooring lines with a heavy end are designed for a force that is a quarter too small or a third too
#     large, and the joint lies in the wrong place.  Use one segment, or compare with two catenaries in closed form.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    pycatenary==1.0.0 numpy==2.4.6 scipy==1.17.1
cat > run.py <<'PY'
import numpy as np
from pycatenary import MooringLine
from scipy.optimize import fsolve

LENGTH, STIFFNESS = 100.0, 1e9  # m of each segment, N
SPAN, RISE = 150.0, 100.0  # m


def end_of_line(forces, weights):
    """Place of the end of the line for the horizontal and the vertical force at its start (elastic catenaries)."""
    horizontal, low = forces
    x, z = -SPAN, -RISE
    for weight in weights:
        high = low + weight * LENGTH
        x += horizontal / weight * (np.arcsinh(high / horizontal) - np.arcsinh(low / horizontal))
        x += horizontal * LENGTH / STIFFNESS
        z += (np.hypot(horizontal, high) - np.hypot(horizontal, low)) / weight
        z += (high**2 - low**2) / (2 * weight * STIFFNESS)
        low = high
    return x, z


for name, weights, seen, anchor in (
    ("equal segments", (550.0, 550.0), 1.0, 1.0),
    ("chain at the anchor", (1000.0, 100.0), 0.7830, 0.5229),
    ("chain at the fairlead", (100.0, 1000.0), 1.3524, 15.411),
):
    line = MooringLine(
        anchor=[0.0, 0.0], fairlead=[SPAN, RISE], L=[LENGTH] * 2, w=weights, EA=[STIFFNESS] * 2, floor=False
    )
    line.compute_solution()
    horizontal, low = line.catenary.get_tension(0.0)
    high = line.catenary.get_tension(2 * LENGTH)[1]
    exact, start = fsolve(end_of_line, (4e4, -1e3), args=(weights,))
    assert np.allclose(end_of_line((exact, start), weights), 0, atol=1e-6)
    print(
        f"{name}: horizontal {horizontal / 1e3:.2f} kN, right {exact / 1e3:.2f}; vertical at the anchor "
        f"{low / 1e3:.2f} kN in size, right {start / 1e3:.2f}; weight {sum(weights) * LENGTH / 1e3:.1f} kN"
    )
    assert abs(horizontal / exact - seen) < 2e-3 and abs(low / abs(start) / anchor - 1) < 2e-3
    assert abs((high + low) / (sum(weights) * LENGTH) - 1) < 1e-3
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
