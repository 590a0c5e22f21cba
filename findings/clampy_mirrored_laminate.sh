#!/usr/bin/env bash
# clampy 1.2: a laminate that is mirrored to be symmetric twists when it is pulled.
#
# Expected: `SymmetricLaminate` of plies at 30 and 0 degrees with `symmetric=True`, "Mirror plies for symmetric
#     laminates", gives 30, 0, 0, 30 degrees; the coupling matrix B of a symmetric laminate is zero.
# Seen: the angles are 30, 0, 0, -30 degrees.  B16 is 129 kN in place of 0: pulled by 100 N/mm the plate of 4 mm gets
#     a twist of 0.00026 per mm, right is none.  Ex is 80.2 GPa, of the symmetric laminate 81.6 GPa, and `nuLxy` is
#     -0.42, right is +0.48.
# Meaning: the mirrored half gets the negative angles, which makes an antisymmetric laminate with other stiffness and
#     warping after cooling.  With 0, 90 or pairs of +a and -a alone, the usual examples, part of it is hidden.  In
#     addition Poisson's ratio has the wrong sign.  Leave `symmetric` off and give all plies.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    numpy==1.26.4 matplotlib==3.7.5 pandas==2.2.3 tikzplotlib==0.10.1 webcolors==1.13
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    --no-deps clampy==1.2
cat > run.py <<'PY'
import matplotlib

matplotlib.use("Agg")
import numpy as np
from CLamPy import laminate


def solved(angles, mirrored):
    plate = laminate()  # defaults: 141, 8.5, 3.75 GPa, 0.25, pulled by 100 N/mm
    plate.nPly, plate.theta, plate.thkPly, plate.symmetric = len(angles), list(angles), [1.0] * len(angles), mirrored
    plate.SymmetricLaminate()
    print("angles", list(plate.theta))
    plate.deg2rad()
    plate.calcPlyPositions()
    plate.calcPoisson21()
    plate.calcABD()
    plate.calcInverseABD()
    plate.calcLaminateParameters()
    plate.calcStrain()
    return plate


mirrored, symmetric = solved([30, 0], True), solved([30, 0, 0, 30], False)
for name, plate in (("mirrored", mirrored), ("30, 0, 0, 30", symmetric)):
    twist = plate.strainVec[5, 0]
    print(f"{name}: B16 {plate.B[0, 2] / 1e3:.1f} kN, twist {twist:.5f} per mm, Ex {plate.ELx / 1e3:.1f} GPa, "
          f"Poisson's ratio {plate.nuLxy:.3f}")
assert np.isclose(mirrored.theta[3], -mirrored.theta[0]) and np.allclose(symmetric.B, 0, atol=1e-6)

# B16 by hand from the turned stiffness of the two outer plies, which are opposite in sign at +1.5 and -1.5 mm
first, second, shear, ratio = 141e3, 8.5e3, 3.75e3, 0.25
whole = 1 / (1 - ratio**2 * second / first)
cosine, sine = np.cos(np.radians(30)), np.sin(np.radians(30))
turned = ((first * whole - ratio * second * whole - 2 * shear) * cosine**3 * sine
          + (ratio * second * whole - second * whole + 2 * shear) * cosine * sine**3)
assert np.isclose(mirrored.B[0, 2], 2 * 1.5 * turned)
assert abs(mirrored.strainVec[5, 0] + 0.00026) < 1e-5 and abs(symmetric.strainVec[5, 0]) < 1e-12
assert abs(mirrored.ELx / symmetric.ELx - 0.982) < 2e-3 and symmetric.nuLxy < -0.4
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
