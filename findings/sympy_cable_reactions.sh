#!/usr/bin/env bash
# sympy 1.14.0: a cable under a vertical line load pulls its two supports with different horizontal forces.
#
# Expected: the horizontal force of a cable under a vertical load is one number, with opposite signs at the two
#     supports, and the vertical reactions carry the whole load.
# Seen: for the cable of 100 m of the documentation (supports at heights 40 and 20 m, 850 N/m, lowest point at
#     58.58 m) `tension_at` has the right tensions at both ends, 61717 and 50688 N.  `reaction_loads` has
#     +36465 and +44400 N horizontally, and -49793 and +42868 N vertically, together -6925 N under a load of
#     85000 N.  The right support should have 36465 and 35207 N, whose tension is 50688 N: its direction is
#     combined with the tension of the left end.
# Seen: for one load of 10 kN in the middle of 10 m, on supports 5 m above and 1 m below the load, the tension of
#     the left half is 11.8 kN in place of 17.7 kN, and the horizontal force 8.3 kN in place of 12.5 kN.  The right
#     half has the right 12.7 kN.  With both supports above the load all numbers are right.
# Meaning: anchors of a cable or of a ground anchor's free length get 22 % too much or a third too little.  The sum
#     of the reactions shows it.  Take the reactions from the tension and the slope at each end.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    sympy==1.14.0
cat > run.py <<'PY'
from math import hypot

from sympy.physics.continuum_mechanics.cable import Cable

LOAD, SPAN = 850.0, 100.0

cable = Cable(("A", 0, 40), ("B", SPAN, 20))
cable.apply_load(0, ("weight", LOAD))
cable.solve(58.58)
left_x, left_y, right_x, right_y = (float(value) for value in cable.reaction_loads.values())
left, right = (float(cable.tension_at(x)) for x in (0, SPAN))
carried = LOAD * (SPAN - 58.58)
print(f"line load: left {left_x:.0f}, {left_y:.0f} N, right {right_x:.0f}, {right_y:.0f} N; "
      f"tensions {left:.0f} and {right:.0f} N; right support should have {left_x:.0f}, {carried:.0f} N")
assert abs(hypot(left_x, left_y) - left) < 1 and abs(hypot(left_x, carried) - right) < 1
assert abs(left_x - 36465) < 1 and abs(right_x - 44400) < 1
assert abs(left_y + 49793) < 1 and abs(right_y - 42868) < 1

for support, seen in ((8, 1), (4, 2 / 3)):
    cable = Cable(("A", 0, 10), ("B", 10, support))
    cable.apply_load(-1, ("P", 5, 5, 10, 270))
    cable.solve()
    # Equilibrium of the loaded point: slopes of the two halves times the horizontal force.
    horizontal = 10 / ((10 - 5) / 5 + (support - 5) / 5)
    rights = [horizontal * hypot(5, height - 5) / 5 for height in (10, support)]
    found = {str(name): float(value) for name, value in cable.tension.items()}
    force = float(list(cable.reaction_loads.values())[2])
    print(f"right support at {support} m: tensions {found['A_P']:.2f} and {found['P_B']:.2f} kN, right "
          f"{rights[0]:.2f} and {rights[1]:.2f} kN; horizontal {force:.2f} kN, right {horizontal:.2f} kN")
    assert abs(found["P_B"] - rights[1]) < 1e-9
    assert abs(found["A_P"] - seen * rights[0]) < 1e-9 and abs(force - seen * horizontal) < 1e-9
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
