#!/usr/bin/env bash
# geoeq 0.1.3: a cantilever sheet pile wall of 5 m gets an embedment of 2.3 m, and turns over.
#
# Expected: the embedment of a cantilever wall after Blum balances the moments of the active and the
#     passive pressure about its toe: 4.6 m for 5 m of sand with 30 degrees, before any addition.
# Seen: `sheet_pile(gamma=18, H=5, phi=30)` has "D_theory" 1.77 m and "D_design" 2.30 m.  At 1.77 m the
#     passive moment is 16 % of the active one, at 2.30 m 28 %.  The formula is H sqrt(Ka / (Kp - Ka)),
#     and the unit weight, cohesion and water have no effect.  With 20 and 40 degrees it is 19 and
#     13 % at D_theory.
# Meaning: the name "Blum" stands on a number that no equilibrium gives; the wall is half as long as it
#     should be.  Check an embedment by the moments about the toe.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    geoeq==0.1.3
cat > run.py <<'PY'
from math import radians, tan

from geoeq.design import sheet_pile

HEIGHT, WEIGHT = 5.0, 18.0


def ratio(depth, active, passive):
    """Moment of the passive over the one of the active pressure about the toe."""
    return passive * depth**3 / (active * (HEIGHT + depth) ** 3)


for angle in (20, 30, 40):
    active, passive = (tan(radians(45 + sign * angle / 2)) ** 2 for sign in (-1, 1))
    result = sheet_pile(gamma=WEIGHT, H=HEIGHT, phi=angle)
    root = (passive / active) ** (1 / 3)
    right = HEIGHT / (root - 1)
    theory, design = result["D_theory"], result["D_design"]
    print(f"{angle} degrees: {theory:.2f} m, in design {design:.2f} m; equilibrium {right:.2f} m; "
          f"passive over active moment {ratio(theory, active, passive):.2f} and "
          f"{ratio(design, active, passive):.2f}")
    assert abs(ratio(right, active, passive) - 1) < 1e-9
    assert ratio(theory, active, passive) < 0.25 and design < 0.75 * right
assert abs(sheet_pile(gamma=18, H=5, phi=30)["D_theory"] - 1.768) < 0.001
same = sheet_pile(gamma=18, H=5, phi=30, c=20, gamma_sub=8, water_table=0)
assert same["D_theory"] == sheet_pile(gamma=18, H=5, phi=30)["D_theory"]
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
