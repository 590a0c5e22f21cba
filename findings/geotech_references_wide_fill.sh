#!/usr/bin/env bash
# geotech-references 1.4.1: a fill of 100 kPa without end adds 50 kPa, and beside it the ground is pulled.
#
# Expected: with the documented arguments `boussinesq_semi_infinite_load` (angle beta "from the vertical")
#     has half of the load under the edge and all of it far inside; `boussinesq_slope_load`, a ramp of
#     4 m, fades with the depth or ends at half of the load, if the fill goes on.
# Seen: at a depth of 2 m 0 kPa under the edge, 50.0 kPa at 200 m inside, and -41 kPa at 2 m outside.
#     With the angle from the horizontal the three are right: 50, 100 and 9.1 kPa.  Under the toe of the
#     slope the stress grows with the depth for ever: 32, 318 and 3183 kPa at 4, 40 and 400 m, where the
#     ramp alone has 15.9, 3.2 and 0.3 kPa, and with the fill behind it 25, 47 and 50 kPa.
# Meaning: settlements of embankments come out at half, or heave beside them, and the second function
#     is the formula of a slope that rises for ever.  Integrate line loads, and check that a wide load
#     arrives whole.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    geotech-references==1.4.1 numpy==2.4.6 scipy==1.16.3
cat > run.py <<'PY'
import numpy as np
from geotech_references.dm7_1 import chapter4
from scipy.integrate import quad

LOAD, RAMP = 100.0, 4.0


def line(s, x, z):
    """Vertical stress of a line load of unit size at s."""
    return 2 * z**3 / (np.pi * ((x - s) ** 2 + z**2) ** 2)


def fill(x, z, start=0.0):
    """Vertical stress of a uniform load from a start to infinity, by integration."""
    near, _ = quad(line, start, max(x, start) + z, args=(x, z), points=[x] if x > start else None)
    far, _ = quad(line, max(x, start) + z, np.inf, args=(x, z))
    return LOAD * (near + far)


# A load from x = 0 to infinity.
z = 2.0
for x, seen in ((-2.0, -40.92), (0.0, 0.0), (2.0, 40.92), (200.0, 50.0)):
    documented = chapter4.boussinesq_semi_infinite_load(LOAD, x, z, np.hypot(x, z), np.arctan2(x, z))
    other = chapter4.boussinesq_semi_infinite_load(LOAD, x, z, np.hypot(x, z), np.arctan2(z, -x))
    right = fill(x, z)
    print(f"x = {x} m: {documented:.2f} kPa, angle from the horizontal {other:.2f}, right {right:.2f}")
    assert abs(documented - seen) < 0.01 and abs(other - right) < 1e-3

# Under the toe of a load that rises over four metres.
for z, seen in ((4.0, 31.83), (40.0, 318.3), (400.0, 3183.1)):
    found = chapter4.boussinesq_slope_load(LOAD, 0.0, z, RAMP, np.arctan2(RAMP, z))
    ramp, _ = quad(lambda s: LOAD * s / RAMP * line(s, 0.0, z), 0, RAMP)
    whole = ramp + fill(0.0, z, RAMP)
    print(f"depth {z} m: {found:.1f} kPa; ramp {ramp:.2f} kPa, with the fill behind it {whole:.2f} kPa")
    assert abs(found / seen - 1) < 1e-4 and ramp < 16 and whole < 50
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
