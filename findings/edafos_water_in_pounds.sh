#!/usr/bin/env bash
# edafos 0.0.1.dev0: ground of 20 kN/m3 floats on its water: the effective stress at 10 m is negative.
#
# Expected: `effective_stress` takes depths "in feet (default) or meters" and unit weights "in pcf (default) or
#     kN/m3", and returns "psf (default) or kN/m2", as its docstring says; 20 kN/m3 with water at 2 m has 121.5 kPa at
#     10 m.
# Seen: -299.2 lb/ft2 for 10 m, 2 m, 20 kN/m3. In feet and lb/ft3 the same ground has 2538 lb/ft2 = 121.5 kPa, right.
#     Without water in reach 200 lb/ft2 = 9.6 kPa in place of 200 kPa. No argument chooses the units, and no message.
# Meaning: water weighs 62.4 in any case, and the result is marked as lb/ft2, so that a conversion by its unit is
#     wrong as well. A depth above water table hides it: the number is right in kPa, but its unit is not. Convert to
#     ft and lb/ft3 before, and the result after.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    --no-deps edafos==0.0.1.dev0 pint==0.25.3 flexcache==0.3 flexparser==0.4 platformdirs==4.5.1 \
    typing_extensions==4.15.0 numpy==2.4.6
cat > run.py <<'PY'
import math

from edafos import effective_stress

FOOT, POUND, PRESSURE = 0.3048, 0.157087, 0.0478803  # m; kN/m3 of one lb/ft3; kPa of one lb/ft2
DEPTH, WEIGHT = 10.0, 20.0  # m, kN/m3

for water, seen in ((2.0, -299.2), (20.0, 200.0)):
    right = WEIGHT * DEPTH - 9.80665 * max(0.0, DEPTH - water)
    metric = effective_stress(DEPTH, water, [DEPTH], [WEIGHT])
    feet = effective_stress(DEPTH / FOOT, water / FOOT, [DEPTH / FOOT], [WEIGHT / POUND])
    converted = feet.magnitude * PRESSURE
    found = f"{metric.magnitude:.1f} {metric.units}"
    print(f"water at {water} m: {found}, in feet {converted:.1f} kPa, right {right:.1f} kPa")
    assert str(metric.units) == str(feet.units) == "psf" and math.isclose(metric.magnitude, seen, rel_tol=1e-6)
    assert math.isclose(converted, right, rel_tol=1e-3) and abs(metric.to("kPa").magnitude / right) < 0.12
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
