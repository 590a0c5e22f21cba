#!/usr/bin/env bash
# CalculiX 2.20: under axial symmetry loads are those of the circle, reactions those of two degrees.
#
# Expected: for a column of radius 1 m the reactions of the base add up to the load on the top.
# Seen: a ring load of 1000 N given by *CLOAD has the reaction 5.556 N, and a pressure of 1000 Pa on
#     the top (3142 N) 17.45 N.  Both are 1/180 of the load: the element is expanded to a wedge of
#     two degrees, and concentrated loads are divided by 180, but `RF` is not multiplied by it.
#     The stress is right.
# Meaning: the bearing force of a pile or circular footing that is pushed down by prescribed
#     displacements comes out 180 times too small, with no remark in the output.  Multiply `RF` by 180,
#     and compare once with the stress times the area.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
if [[ "$(ccx -v 2>&1 || true)" != *2.20* ]]; then
    echo 'needs CalculiX 2.20: apt-get install calculix-ccx'
    exit 1
fi
python3 -m venv venv
cat > run.py <<'PY'
import subprocess


def run(name, text):
    """Run CalculiX.  Return its log and the text of the printed results."""
    with open(name + ".inp", "w") as file:
        file.write(text)
    log = subprocess.run(["ccx", name], capture_output=True, text=True, check=True).stdout
    assert "Job finished" in log
    with open(name + ".dat") as file:
        return log, file.read()


def rows(text, columns):
    """Rows of numbers that have as many columns."""
    found = []
    for line in text.splitlines():
        words = line.split()
        if len(words) == columns and all(w[-1].isdigit() for w in words):
            found.append([float(w) for w in words])
    return found

import math

COLUMN = """*NODE,NSET=ALL
1,0,0
2,1,0
3,1,1
4,0,1
*ELEMENT,TYPE=CAX4,ELSET=SOIL
1,1,2,3,4
*NSET,NSET=BASE
1,2
*MATERIAL,NAME=SOIL
*ELASTIC
1e7,0.
*SOLID SECTION,ELSET=SOIL,MATERIAL=SOIL
*BOUNDARY
BASE,2,2
ALL,1,1
*STEP
*STATIC
"""
PRINT = """*NODE PRINT,NSET=BASE,TOTALS=ONLY
RF
*EL PRINT,ELSET=SOIL
S
*END STEP
"""
_, ring = run("ring", COLUMN + "*CLOAD\n3,2,-1000.\n" + PRINT)
_, pressure = run("pressure", COLUMN + "*DLOAD\nSOIL,P3,1000.\n" + PRINT)
for name, results, load in (("ring", ring, 1000), ("pressure", pressure, 1000 * math.pi)):
    reaction = rows(results, 3)[0][1]
    print(f"{name}: load {load:.1f} N, reaction {reaction:.4f} N, ratio {load / reaction:.2f}")
    assert abs(load / reaction - 180) < 0.1
stress = rows(pressure, 8)[0][3]
print(f"stress under the pressure {stress:.1f} Pa")
assert abs(stress + 1000) < 1e-3
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
