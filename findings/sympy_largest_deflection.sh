#!/usr/bin/env bash
# sympy 1.14.0: the largest deflection of a beam is a sixth of the one at its end, or none.
#
# Expected: `Beam.max_deflection` returns the largest deflection of the beam, wherever it is.
# Seen: for a cantilever with a force at its end it returns None, while `deflection()` has the right
#     0.356 m there.  For a beam of 6 m with an overhang of 4 m and a force at its end it returns
#     0.154 m at 3.46 m, between the supports, in place of 0.889 m at the end.  `max_bmoment` of the
#     same beams is right.
# Meaning: only points with zero slope are searched.  The heads of sheet piles, laterally loaded
#     piles and gantries move most at a free end, which is left out, and where there is another
#     point of zero slope the answer has no sign of it.  Evaluate `deflection()` at the ends too.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    sympy==1.14.0
cat > run.py <<'PY'
from sympy import symbols
from sympy.physics.continuum_mechanics.beam import Beam

first, second = symbols("first second")

cantilever = Beam(4, 200, 3)
cantilever.bc_deflection, cantilever.bc_slope = [(0, 0)], [(0, 0)]
for unknown, order in ((first, -1), (second, -2)):
    cantilever.apply_load(unknown, 0, order)
cantilever.apply_load(10, 4, -1)
cantilever.solve_for_reaction_loads(first, second)
tip = float(cantilever.deflection().subs(cantilever.variable, 4))
right = 10 * 4**3 / (3 * 200 * 3)
print(f"cantilever: tip {tip:.4f}, right {right:.4f}, largest {cantilever.max_deflection()}, "
      f"moment {cantilever.max_bmoment()}")
assert abs(tip - right) < 1e-12
assert cantilever.max_deflection() is None and cantilever.max_bmoment() == (0, 40)

overhang = Beam(10, 200, 3)
overhang.bc_deflection = [(0, 0), (6, 0)]
overhang.apply_load(first, 0, -1)
overhang.apply_load(second, 6, -1)
overhang.apply_load(10, 10, -1)
overhang.solve_for_reaction_loads(first, second)
tip = float(overhang.deflection().subs(overhang.variable, 10))
right = 10 * 4**2 * (6 + 4) / (3 * 200 * 3)
place, largest = (float(value) for value in overhang.max_deflection())
print(f"overhang: tip {tip:.4f}, right {right:.4f}, largest {largest:.4f} at {place:.3f}, "
      f"moment {overhang.max_bmoment()}")
assert abs(tip - right) < 1e-12 and overhang.max_bmoment() == (6, 40)
assert abs(largest - 0.15396) < 1e-4 and abs(place - 12**0.5) < 1e-9
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
