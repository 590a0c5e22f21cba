#!/usr/bin/env bash
# fipy 4.0.3: a cut-off wall of one cell lets 455 times the water through.
#
# Expected: a permeability per cell is averaged over a face as resistances in series are, so that the
#     flow through a wall is that of Darcy's law for layers.
# Seen: sand of 19 m and a wall of 1 m that is 1e-4 times as permeable, 20 cells of 1 m, heads of 10
#     and 0 m.  The discharge is 0.91 of that without the wall; right is 0.002.  With a wall of 3 m
#     and of 5 m it is 1.50 and 1.25 times the right one.  `DiffusionTerm` takes the arithmetic
#     mean of a `CellVariable` at faces, half of the sand's on both sides of the wall.  With
#     `harmonicFaceValue` all are right to 1e-4.
# Meaning: half a cell of every barrier is lost on each of its sides.  Cut-off walls, liners and thin
#     clay leak as if they were thinner by a cell, and one of a single cell is not there.  Pass
#     `k.harmonicFaceValue`, and compare one flow with layers in series.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    fipy==4.0.3 numpy==2.4.6 scipy==1.17.1
cat > run.py <<'PY'
from fipy import CellVariable, DiffusionTerm, Grid1D

SAND, WALL, LENGTH = 1.0, 1e-4, 20


def discharge(thickness, harmonic):
    """Flow through sand and a wall in its middle, from the head drop in the first half cell."""
    mesh = Grid1D(nx=LENGTH, dx=1.0)
    permeability = CellVariable(mesh=mesh, value=SAND)
    permeability.setValue(WALL, where=abs(mesh.cellCenters[0] - 10.5) < thickness / 2)
    head = CellVariable(mesh=mesh, value=0.0)
    head.constrain(10.0, mesh.facesLeft)
    head.constrain(0.0, mesh.facesRight)
    DiffusionTerm(coeff=permeability.harmonicFaceValue if harmonic else permeability).solve(head)
    return SAND * (10 - float(head.value[0])) / 0.5


for thickness, factor in ((1, 455), (3, 1.5), (5, 1.25)):
    right = 10 / ((LENGTH - thickness) / SAND + thickness / WALL)
    default, harmonic = discharge(thickness, False), discharge(thickness, True)
    print(f"wall of {thickness} m: right {right:.3e}, default {default:.3e} "
          f"({default / right:.2f} times), harmonic {harmonic:.3e}")
    assert abs(harmonic / right - 1) < 1e-4
    assert abs(default / right / factor - 1) < 0.01
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
