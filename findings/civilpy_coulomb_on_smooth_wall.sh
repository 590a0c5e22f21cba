#!/usr/bin/env bash
# civilpy 0.6.1: the thrust on a smooth wall by Coulomb is 1.73 times the one by Rankine, and friction makes it larger.
#
# Expected: `coulomb_active_pressure` with a vertical, smooth back and a level surface is the same as
#     `rankine_active_pressure`; friction of the wall lowers the coefficient, 0.333 to 0.297 for 30 and 20 degrees.
# Seen: 18 kN/m3, 5 m, 30 degrees. 129.9 kN/m, Rankine 75.0 kN/m. Friction of 10 degrees: coefficient 0.605, right is
#     0.308; 20 degrees: 0.707, right is 0.297. `lateral_earth.coulomb_ka` of the same library, and trial wedges, have
#     the right ones. `coulomb_active_pressure_with_surcharge` has the same factor.
# Meaning: the term with the root is not squared, and the friction of the wall is subtracted from the angle in it, so
#     that the smooth wall has cos(phi) / (1 + sin(phi)), the root of the coefficient. Walls come out too heavy, and a
#     comparison of methods misleads. Take `coulomb_ka` of `civilpy.geotech.lateral_earth`.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    --no-deps civilpy==0.6.1 numpy==2.4.6 scipy==1.17.1 contourpy==1.3.3 cycler==0.12.1 defusedxml==0.7.1 \
    flexcache==0.3 flexparser==0.4 fonttools==4.68.0 kiwisolver==1.5.1 matplotlib==3.10.8 mpmath==1.4.1 \
    packaging==26.4 pandas==3.0.0 pillow==13.0.0 Pint==0.25.3 platformdirs==4.14.9 pyparsing==3.3.3 \
    python-dateutil==4.0.0 sympy==1.14.0 typing_extensions==4.16.0
cat > run.py <<'PY'
import matplotlib

matplotlib.use("Agg")
import numpy as np
from civilpy.geotech import coulomb_active_pressure, coulomb_active_pressure_with_surcharge, rankine_active_pressure
from civilpy.geotech.lateral_earth import coulomb_ka

WEIGHT, HEIGHT, FRICTION = 18.0, 5.0, 30.0  # kN/m3, m, degrees
UNIT = WEIGHT * HEIGHT**2 / 2  # kN/m


def by_wedges(wall):
    """Coefficient by trial wedges behind a vertical back with a level surface."""
    plane, phi, delta = np.radians(np.linspace(FRICTION + 0.01, 89.99, 100001)), np.radians(FRICTION), np.radians(wall)
    # Triangle of forces of the wedge: weight, reaction of the plane and thrust on the wall.
    thrust = np.sin(plane - phi) / np.cos(plane - phi - delta) / np.tan(plane)
    return thrust.max()


for wall, seen in ((0.0, 0.5774), (10.0, 0.6049), (20.0, 0.7065)):
    found = coulomb_active_pressure(WEIGHT, HEIGHT, FRICTION, wall, 0.0, 0.0) / UNIT
    other, right = coulomb_ka(FRICTION, wall), by_wedges(wall)
    print(f"friction of {wall} degrees: {found:.3f}, lateral_earth {other:.3f}, by wedges {right:.3f}")
    assert abs(found - seen) < 1e-3 and abs(other - right) < 1e-3
assert abs(rankine_active_pressure(WEIGHT, HEIGHT, FRICTION) / UNIT - by_wedges(0.0)) < 1e-6
load = coulomb_active_pressure_with_surcharge(WEIGHT, HEIGHT, FRICTION, 0.0, 0.0, 0.0, 10.0) / (UNIT + 10.0 * HEIGHT)
assert abs(load - 0.5774) < 1e-3
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
