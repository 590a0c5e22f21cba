#!/usr/bin/env bash
# modified_cam_clay 1.0.1: clay in an undrained test is 2.4 times as stiff as its own shear modulus at first.
#
# Expected: `undrained` gives the axial strain of normally consolidated clay as plastic strain plus dq / (3 G), with G
#     = 3 (1 - 2 nu) (1 + e) p / (2 (1 + nu) kappa) as the code has it; the first secant is 3 G, about 20 MPa here.
# Seen: M 1, kappa 0.026, lambda 0.174, e 0.889, 206.7 kPa, nu 0.3. At q of 20 kPa the strain is 0.041 %, right is
#     0.098 %; at 60 kPa 0.31 and 0.34 %; at 105 kPa, of 115 at failure, 1.82 and 1.26 %. The strength is right.
# Meaning: each step of 1 kPa of effective stress takes an elastic shear strain for dq of 3 kPa, the drained path,
#     where q grows by 15 kPa in the first step and falls back later. The clay is too stiff at small strain and too
#     soft near failure. Integrate the difference of the returned q over 3 G instead.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    --no-deps modified_cam_clay==1.0.1 numpy==2.4.6 matplotlib==3.10.8 contourpy==1.3.3 cycler==0.12.1 \
    fonttools==4.61.0 kiwisolver==1.4.9 packaging==25.0 pillow==12.0.0 pyparsing==3.2.5 python-dateutil==2.9.0.post0 \
    six==1.17.0
cat > run.py <<'PY'
import numpy as np
from modified_cam_clay.undrained import undrained

SLOPE, KAPPA, LAMBDA, VOIDS, PRESSURE, POISSON = 1.0, 0.026, 0.174, 0.889, 206.7, 0.3


def shear_modulus(pressure):
    """Shear modulus in kPa by kappa and Poisson's ratio."""
    return 3 * (1 - 2 * POISSON) * (1 + VOIDS) * pressure / (2 * (1 + POISSON) * KAPPA)


def by_integration(steps=400000):
    """Deviatoric stress in kPa, plastic and elastic axial strain of modified Cam clay without drainage."""
    plastic = 1 - KAPPA / LAMBDA
    pressure = np.linspace(PRESSURE, PRESSURE * 2**-plastic, steps + 1)[:-1]
    yield_pressure = PRESSURE * (PRESSURE / pressure) ** (KAPPA / (LAMBDA - KAPPA))
    deviator = SLOPE * pressure * np.sqrt(np.maximum(yield_pressure / pressure - 1, 0.0))
    middle = (pressure[1:] + pressure[:-1]) / 2
    ratio = (deviator[1:] / pressure[1:] + deviator[:-1] / pressure[:-1]) / 2
    volume = -KAPPA / (1 + VOIDS) * np.diff(pressure) / middle
    flow = volume * 2 * ratio / (SLOPE**2 - ratio**2)
    elastic = np.diff(deviator) / (3 * shear_modulus(middle))
    return deviator, np.append(0, np.cumsum(flow)), np.append(0, np.cumsum(elastic))


strain, deviator, _ = undrained(PRESSURE, SLOPE, KAPPA, LAMBDA, VOIDS, POISSON)
exact, flow, elastic = by_integration()
assert abs(max(deviator) / max(exact) - 1) < 0.01
# At small stress nearly all strain is elastic: q / (3 G) is a second way.
assert abs(20 / (3 * shear_modulus(PRESSURE)) / np.interp(20, exact, flow + elastic) - 1) < 0.05
for stress, ratio in ((20.0, 0.420), (60.0, 0.886), (105.0, 1.445)):
    found, right = np.interp(stress, deviator, strain), np.interp(stress, exact, flow + elastic)
    print(f"q of {stress} kPa: strain {100 * found:.3f} %, right {100 * right:.3f} %")
    assert abs(found / right - ratio) < 0.005
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
