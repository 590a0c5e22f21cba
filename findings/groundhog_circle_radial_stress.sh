#!/usr/bin/env bash
# groundhog 0.15.0: a circular footing pulls the soil apart with more than its own pressure.
#
# Expected: the horizontal stress under the centre of a circle of radius 1 m with 100 kPa is that of
#     the elastic half-space: 26.3, 5.75 and -0.33 kPa at depths of 0.5, 1 and 5 m (Poisson's ratio
#     0.3), which fades with the depth.
# Seen: `stresses_circle` returns -31.8, -86.2 and -127.8 kPa, and at 100 m -130 kPa.  The vertical
#     stress is right.  The formula, which the documentation quotes from a textbook, has 4 (1 + nu)
#     where the integral of Boussinesq's solution has 2 (1 + nu).
# Meaning: the initial stresses for an analysis, the mean stress for a stiffness, or a stress path
#     from this function are tension, at all depths, without a message.  Points, rectangles and
#     strips in the same module are right.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    groundhog==0.15.0 jinja2==3.1.6 pyproj==3.7.2 numpy==2.4.6 scipy==1.17.1
cat > run.py <<'PY'
import numpy as np
from groundhog.shallowfoundations.stressdistribution import stresses_circle, stresses_pointload
from scipy.integrate import quad

RADIUS, LOAD, NU = 1.0, 100.0, 0.3


def ring(r, z):
    """Radial stress at depth z of Boussinesq's point loads on a ring of radius r, per length."""
    distance = np.hypot(r, z)
    radial = 3 * z * r**2 / distance**5 - (1 - 2 * NU) / (distance * (distance + z))
    hoop = (1 - 2 * NU) * (1 / (distance * (distance + z)) - z / distance**3)
    return LOAD * r * (radial + hoop) / 2


for z, seen in ((0.5, -31.80), (1.0, -86.17), (5.0, -127.81), (100.0, -130.0)):
    result = stresses_circle(z, RADIUS, LOAD, NU)
    vertical, horizontal = result["delta sigma z [kPa]"], result["delta sigma r [kPa]"]
    right, _ = quad(ring, 0, RADIUS, args=(z,))
    slope = 1 / np.sqrt(1 + (RADIUS / z) ** 2)
    formula = LOAD / 2 * ((1 + 2 * NU) - 2 * (1 + NU) * slope + slope**3)
    print(f"depth {z} m: vertical {vertical:.2f}, horizontal {horizontal:.2f}, right {right:.2f} kPa")
    assert abs(right - formula) < 1e-6 and abs(horizontal - seen) < 0.02
    assert abs(vertical - LOAD * (1 - slope**3)) < 1e-6
point = stresses_pointload(100.0, 1.0, 1.0, NU)["delta sigma r [kPa]"]
exact = 100 / (2 * np.pi) * (3 / 2**2.5 - (1 - 2 * NU) / (2**0.5 * (2**0.5 + 1)))
print(f"point load: {point:.3f}, right {exact:.3f} kPa")
assert abs(point - exact) < 1e-9
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
