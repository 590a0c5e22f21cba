#!/usr/bin/env bash
# xslope 1.0.5: sand under peat presses on a pile as if the peat were as heavy as the sand.
#
# Expected: the pressure on a pile by Ito and Matsui is c A1 + A2 times the vertical stress at the depth, as their
#     derivation starts from it; in layers the stress is the sum over the layers above.
# Seen: piles of 0.6 m at 1.8 m.  In 8 m of sand, as one layer or as two alike, the force is 2303 kN, as by integration
#     of the stress.  With 4 m of peat (11 kN/m3, 5 kPa) on 4 m of sand (20 kN/m3, 32 degrees) it is 1807 kN, right is
#     1289 kN with the same A1 and A2.  Peat on clay: 461 in place of 404 kN; fill on clay: 1807 in place of 1855 kN.
# Meaning: `compute_ito_matsui_force` takes gamma z with the unit weight of the layer and the depth below the surface,
#     so that the stress jumps at each layer.  The force of dowels below light soil, and with it the factor of safety of
#     the slope, is too large.  Give layers below light soil a depth of their own: z less the missing weight over gamma.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    xslope==1.0.5 numpy==2.4.6 scipy==1.17.1 shapely==2.1.2
cat > run.py <<'PY'
import numpy as np
from xslope.ito_matsui import (
    compute_ito_matsui_force,
    compute_ito_matsui_force_and_moment_arm,
    ito_matsui_coefficients,
)

DIAMETER, SPACING = 0.6, 1.8  # m
PEAT = {"c": 5.0, "phi": 0.0, "gamma": 11.0}  # kPa, degrees, kN/m3
SAND = {"c": 0.0, "phi": 32.0, "gamma": 20.0}
CLAY = {"c": 25.0, "phi": 0.0, "gamma": 17.0}
FILL = {"c": 0.0, "phi": 38.0, "gamma": 22.0}


def layers(*soils):
    """Segments of xslope for soils with a thickness, from the top."""
    depths = np.cumsum([0.0] + [thickness for _, thickness in soils])
    return [
        {"z_top": top, "z_bot": bottom, **soil} for (soil, _), top, bottom in zip(soils, depths[:-1], depths[1:])
    ]


def by_overburden(segments):
    """Force on a pile in kN by the vertical stress and the coefficients of xslope, and its arm."""
    force = moment = stress = 0.0
    for segment in segments:
        cohesive, frictional = ito_matsui_coefficients(SPACING - DIAMETER, DIAMETER, segment["phi"])
        depth = np.linspace(segment["z_top"], segment["z_bot"], 20001)
        vertical = stress + segment["gamma"] * (depth - segment["z_top"])
        pressure = segment["c"] * cohesive + frictional * vertical
        force += np.trapezoid(pressure, depth)
        moment += np.trapezoid(pressure * (segments[-1]["z_bot"] - depth), depth)
        stress = vertical[-1]
    return force, moment / force


for name, soils, seen in (
    ("sand alone", ((SAND, 8.0),), 1.0),
    ("sand in two layers", ((SAND, 4.0), (SAND, 4.0)), 1.0),
    ("peat on sand", ((PEAT, 4.0), (SAND, 4.0)), 1.402),
    ("peat on clay", ((PEAT, 4.0), (CLAY, 4.0)), 1.143),
    ("fill on clay", ((FILL, 4.0), (CLAY, 4.0)), 0.974),
):
    segments = layers(*soils)
    _, force = compute_ito_matsui_force(DIAMETER, SPACING, segments)
    _, _, arm = compute_ito_matsui_force_and_moment_arm(DIAMETER, SPACING, segments)
    right, right_arm = by_overburden(segments)
    print(f"{name}: {force:.1f} kN, right {right:.1f} kN, ratio {force / right:.3f}; "
          f"arm {arm:.2f} m, right {right_arm:.2f} m")
    assert abs(force / right - seen) < 2e-3 and (seen != 1 or abs(arm / right_arm - 1) < 1e-3)

# A depth of its own for the sand: the weight that is missing in the peat over the unit weight of the sand.
peat, sand = layers((PEAT, 4.0), (SAND, 4.0))
right, _ = by_overburden([peat, sand])
shift = (SAND["gamma"] - PEAT["gamma"]) * 4.0 / SAND["gamma"]
shifted = {**sand, "z_top": sand["z_top"] - shift, "z_bot": sand["z_bot"] - shift}
_, force = compute_ito_matsui_force(DIAMETER, SPACING, [peat, shifted])
print(f"peat on sand, depth of the sand less {shift:.1f} m: {force:.1f} kN, right {right:.1f} kN")
assert abs(force / right - 1) < 1e-3
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
