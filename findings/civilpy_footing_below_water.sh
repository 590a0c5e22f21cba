#!/usr/bin/env bash
# civilpy 0.6.1: water at the surface does not change the bearing capacity of sand, which it halves.
#
# Expected: `ultimate_bearing_capacity` with `water_table=0.0` takes the buoyant unit weight in both terms, also where
#     `gamma_sat` is left out, which is optional: the given unit weight is then the only one, and the capacity of sand
#     is 0.48 of the dry one.
# Seen: footing of 6 ft in 3 ft, 120 lb/ft3, 32 degrees. No water: 21.96 ksf. Water at the surface: 21.96 ksf; at 3
#     ft: 21.96 ksf. With `gamma_sat=120.0`: 10.54 ksf, 0.48 of the first. No message.
# Meaning: without `gamma_sat` the saturated unit weight is the given one plus that of water, so that the buoyant one
#     is the given one, and the argument of the water table has no effect at all. Footings below water pass with twice
#     their load. Give `gamma_sat` with each `water_table`.
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
import math

from civilpy.geotech.shallow_foundation import ultimate_bearing_capacity

SIDE, DEPTH, WEIGHT, FRICTION, WATER = 6.0, 3.0, 120.0, 32.0, 62.4  # ft, ft, lb/ft3, degrees, lb/ft3


def by_library(**water):
    """Ultimate bearing capacity of a square footing in ksf."""
    return ultimate_bearing_capacity(SIDE, SIDE, DEPTH, WEIGHT, FRICTION, **water).q_ult_ksf


def by_hand(weight):
    """The same by Vesic with one unit weight, with the shape and depth factors of a square footing."""
    tangent, sine = math.tan(math.radians(FRICTION)), math.sin(math.radians(FRICTION))
    surcharge = math.exp(math.pi * tangent) * math.tan(math.radians(45 + FRICTION / 2)) ** 2
    own = 2 * (surcharge + 1) * tangent
    shape, depth = 1 + tangent, 1 + 2 * tangent * (1 - sine) ** 2 * DEPTH / SIDE
    return (weight * DEPTH * surcharge * shape * depth + 0.5 * weight * SIDE * own * 0.6) / 1000


dry, wet = by_hand(WEIGHT), by_hand(WEIGHT - WATER)
for name, water, right in (
    ("no water", {}, dry),
    ("water at the surface", {"water_table": 0.0}, wet),
    ("with saturated weight", {"water_table": 0.0, "gamma_sat": WEIGHT}, wet),
):
    found = by_library(**water)
    print(f"{name}: {found:.2f} ksf, by hand {right:.2f} ksf")
    assert abs(found / (dry if name.startswith("water") else right) - 1) < 1e-6
assert by_library(water_table=DEPTH) == by_library() and wet / dry < 0.5
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
