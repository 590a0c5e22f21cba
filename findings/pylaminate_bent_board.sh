#!/usr/bin/env bash
# pylaminate 0.0.5: the plies of a bent laminate get the strains of the other side.
#
# Expected: `apply_load` gives the stress of each ply from the strains that `abd` and the load give, at the height of
#     the ply as `ABD` has it: the stresses of the plies add up to the force and the moment of the load.
# Seen: a plate of 10 mm at 30 GPa on 90 mm at 3 GPa, bent by 10 kN: 36.8 MPa of compression in the stiff ply, right
#     is 13.2 MPa of tension; the stresses add up to -450 N/mm in place of 0, and the moment of the mean stresses to
#     -16.2 in place of 6.6 kN.
# Meaning: the stiffness counts the plies from the top, z = +t/2, the stresses from the bottom, z = -t/2.  For a
#     symmetric laminate only the sign is wrong, and with it the choice of tensile or compressive strength; for timber
#     with a glued strip or a floor of two boards the values too.  `progressive_failure` and `monoaxial_strength` use
#     these stresses.  Multiply `Q` with the strains at the heights that `ABD` has.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    pylaminate==0.0.5 numpy==2.4.6
cat > run.py <<'PY'
import numpy as np
from pylaminate import AnglePly, Laminate, OrthoMaterial

LOAD = 1e4  # N, moment per width
MODULI, HEIGHTS = (30e3, 3e3), (10.0, 90.0)  # MPa, mm, from the first ply to the last
boards = [OrthoMaterial(f"{modulus}", E1=modulus, E2=modulus, nu12=0.0, G12=modulus / 2, rho=1e-9)
          for modulus in MODULI]
plate = Laminate("board", [AnglePly(board, 0, height) for board, height in zip(boards, HEIGHTS)])
plate.apply_load(np.array([[0.0, 0.0, 0.0, LOAD, 0.0, 0.0]]).T)
found = np.array([ply.stress[0, 0] for ply in plate.plies])

# A composite beam of unit width without Poisson's ratio; z points from the last ply to the first as B of `ABD` says.
heights, moduli = np.array(HEIGHTS), np.array(MODULI)
middle = np.array([heights.sum() / 2 - heights[0] / 2, heights.sum() / 2 - heights[0] - heights[1] / 2])
assert np.isclose(plate.ABD[0, 3], (moduli * heights * middle).sum())
neutral = (moduli * heights * middle).sum() / (moduli * heights).sum()
bending = (moduli * (heights**3 / 12 + heights * (middle - neutral) ** 2)).sum()
right = moduli * LOAD / bending * (middle - neutral)
assert np.isclose(1 / plate.abd[3, 3], bending)

for name, stress in (("found", found), ("right", right)):
    force, moment = (stress * heights).sum(), (stress * heights * middle).sum()
    print(f"{name}: {stress[0]:.2f} and {stress[1]:.2f} MPa, sum {force:.1f} N/mm and {moment / 1e3:.2f} kN")
assert np.allclose(right, [13.16, -1.462], rtol=1e-3) and abs((right * heights).sum()) < 1e-6
assert np.allclose(found, [-36.8, -0.906], rtol=2e-3) and (found * heights).sum() < -400
# the strains of the returned stresses belong to the mirrored heights
assert np.allclose(found / moduli, LOAD / bending * (-middle - neutral))
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
