#!/usr/bin/env bash
# clivus 0.4.1: the factor of safety of a circle in clay is 0.2 with 80 slices and 0.4 with 160; it is 1.05.
#
# Expected: `razdolsky` on the slices of `Slope.cut` gives a stability ratio of 1 at the factor of safety, which hardly
#     depends on the number of slices.  For a circle in undrained clay the factor is that of moments, strength times
#     length of the arc over the driving weight, whatever the forces between the slices.
# Seen: a slope of 10 m at 1 to 2 in clay of 30 kPa and 18 kN/m3, circle of 25 m.  By moments 1.048.  The ratio is 1 at
#     0.200 with 80 slices and at 0.400 with 160; at the right factor it is 0.34 and 0.42.  With weights per area of the
#     slice in place of its weight it is 1 at 1.049 and 1.048.  No message.
# Meaning: the sums multiply the weight of a slice by its width and height once more, and `Slope.cut` gives the weight
#     in kN/m.  The narrower the slices, the safer the slope; the search finds surfaces that are none.  Divide the
#     weights by width and mean height before the call, and compare one circle with a hand calculation.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    clivus==0.4.1 numpy==2.4.6 scipy==1.17.1 numba==0.68.1 shapely==2.1.2
cat > slope.yaml <<'YAML'
surface: [[0, 10], [10, 10], [30, 0], [60, 0]]
layers:
  - id: clay
    name: Clay
    above: surface
    material: {gamma: 18.0, c: 30.0, phi: 0.0}
    geometry: {type: depth, value: -50.0, anchor_x: begin}
base:
  material: {gamma: 18.0, c: 30.0, phi: 0.0}
pore_pressure: {type: water_table, value: -60.0}
YAML
cat > run.py <<'PY'
from dataclasses import replace

import numpy as np
from clivus import lem, model
from scipy.optimize import brentq

STRENGTH, CENTRE, RADIUS = 30.0, (20.0, 20.0), 25.0  # kPa, m
slope = model.load("slope.yaml")


def arc(x):
    """Elevation of the circle."""
    return CENTRE[1] - np.sqrt(RADIUS**2 - (x - CENTRE[0]) ** 2)


def factor(slices):
    """The factor at which the stability ratio is 1."""
    return brentq(lambda trial: lem.razdolsky(slices, trial, 40)[0] - 1, 0.1, 1.2, xtol=1e-9)


ends = [brentq(lambda x: slope.surface(x) - arc(x), *bounds) for bounds in ((-4.9, 9.9), (30.0, 44.9))]
angle = [np.arctan2(arc(x) - CENTRE[1], x - CENTRE[0]) for x in ends]
for number, seen in ((80, 0.200), (160, 0.400)):
    x = np.linspace(*ends, number + 1)
    z = arc(x)
    slices = slope.cut(np.column_stack([x, z]))
    height = (slices.h[1:] + slices.h[:-1]) / 2
    moment = slices.w @ (CENTRE[0] - (x[1:] + x[:-1]) / 2)
    right = STRENGTH * RADIUS * abs(angle[1] - angle[0]) * RADIUS / abs(moment)
    per_area = replace(slices, w=slices.w / (slices.b * height))
    found, fixed, ratio = factor(slices), factor(per_area), lem.razdolsky(slices, right, 40)[0]
    print(f"{number} slices: factor {found:.3f}, with weights per area {fixed:.3f}, by moments {right:.3f}; "
          f"stability ratio at the last {ratio:.2f}")
    assert abs(found / seen - 1) < 0.01 and abs(fixed / right - 1) < 0.005 and ratio < 0.5
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
