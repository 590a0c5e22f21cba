#!/usr/bin/env bash
# openpile 1.0.3: the shaft of a pile in sand needs 25.4 mm for the friction that it should have at 2.54 mm.
#
# Expected: the t-z curve of sand after API RP 2A (2000), which the function cites, reaches the limit friction at a
#     displacement of 0.1 inch, 2.54 mm, in a straight line.
# Seen: `tz_curves.api_sand` reaches it at 0.0254 m.  A stiff pile of 20 m in sand with an angle of friction of
#     25 degrees at the wall settles 2.36 mm under 500 kN.  With `z_multiplier=0.1`, which makes the curve the one of
#     the guideline, it settles 0.27 mm.  The curve of clay has the displacements of the guideline.
# Meaning: settlements of piles in sand under working loads are up to ten times too large, loads go to the tip
#     too early, and axial stiffnesses for the dynamics of a structure are too small.  Give `z_multiplier=0.1`.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    openpile==1.0.3 numba==0.68.1 numpy==1.26.4 scipy==1.17.1 pandas==2.3.3 pydantic==2.14.4 \
    matplotlib==3.11.2
cat > run.py <<'PY'
import contextlib
import io

from openpile.construct import Layer, Model, Pile, SoilProfile
from openpile.soilmodels import API_sand, API_sand_axial
from openpile.utils import tz_curves

GUIDELINE = 2.54e-3


def at_limit(curve):
    """Smallest displacement in m at which the friction has its largest value."""
    displacements, frictions = curve
    return min(z for z, t in zip(displacements, frictions) if t > 0.999 * max(frictions))


def settlement(multiplier):
    """Settlement in mm of the head of a stiff pile of 20 m in sand under 500 kN."""
    pile = Pile.create_tubular(
        name="pile", top_elevation=0, bottom_elevation=-20, diameter=1.0, wt=0.02
    )
    pile.material.E = 210e12
    sand = Layer(
        name="sand", top=0, bottom=-30, weight=20,
        lateral_model=API_sand(phi=33, kind="static"),
        axial_model=API_sand_axial(delta=25, z_multiplier=multiplier),
    )
    soil = SoilProfile(name="soil", top_elevation=0, water_line=0, layers=[sand])
    model = Model(name="model", pile=pile, soil=soil, coarseness=0.5)
    model.set_pointload(elevation=0, Pz=-500)
    with contextlib.redirect_stdout(io.StringIO()):
        return -1000 * model.solve().settlement["Settlement [m]"].iloc[0]


sand, clay = at_limit(tz_curves.api_sand(100, 25)), at_limit(tz_curves.api_clay(100, 50, 1.0))
print(f"limit friction: sand at {1000 * sand:.2f} mm, API {1000 * GUIDELINE:.2f} mm; "
      f"clay at {1000 * clay:.2f} mm for a diameter of 1 m, API 10 mm")
assert abs(sand / GUIDELINE - 10) < 1e-4 and abs(clay - 0.01) < 1e-6
default, corrected = settlement(1.0), settlement(0.1)
print(f"settlement: {default:.3f} mm, with a tenth of the displacements {corrected:.3f} mm")
assert abs(default - 2.364) < 0.01 and abs(corrected - 0.266) < 0.005
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
