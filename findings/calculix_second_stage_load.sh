#!/usr/bin/env bash
# CalculiX 2.20: the water pressure of the second stage takes the earth pressure away.
#
# Expected: a wall has 10 kPa of earth in the first step, and 5 kPa of water in the second, by
#     `*DLOAD` on the same faces.  As two cards within one step add up, two steps do: 15 kPa at the
#     end.
# Seen: both cards within one step give a reaction of 15 kN per m2.  In two steps it is 10 and then
#     5: the new value replaces the old one, for `*DLOAD` and `*CLOAD` alike.  Weight is different:
#     a second `GRAV` with another direction is added, 5 downwards and 1.5 sideways of a supported
#     block.
# Meaning: the default OP=MOD modifies a load of the same face and label.  Pressures of stages must
#     be given as totals; earthquake by a second GRAV must be given as the increment.  The sum of
#     the reactions of each step shows which it was.
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

MESH = """*NODE,NSET=ALL
1,0,0,0
2,1,0,0
3,1,1,0
4,0,1,0
5,0,0,1
6,1,0,1
7,1,1,1
8,0,1,1
*ELEMENT,TYPE=C3D8,ELSET=WALL
1,1,2,3,4,5,6,7,8
*NSET,NSET=BASE
1,2,3,4
*MATERIAL,NAME=CONCRETE
*ELASTIC
1.E7,0.
*DENSITY
1.
*SOLID SECTION,ELSET=WALL,MATERIAL=CONCRETE
*BOUNDARY
BASE,1,3
"""


def reactions(*steps):
    """Sum of the reactions of the base after each step: x and z."""
    text = MESH
    for cards in steps:
        text += f"*STEP\n*STATIC\n{cards}*NODE PRINT,NSET=BASE,TOTALS=ONLY\nRF\n*END STEP\n"
    with open("wall.inp", "w") as file:
        file.write(text)
    log = subprocess.run(["ccx", "wall"], check=True, capture_output=True, text=True).stdout
    assert "WARNING" not in log
    with open("wall.dat") as file:
        rows = [line.split() for line in file]
    sums = [row for row in rows if len(row) == 3 and row[0] != "total"]
    return [(round(float(row[0]), 6), round(float(row[2]), 6)) for row in sums]


for card in ("*DLOAD\nWALL,P2,{}\n", "*CLOAD\n7,3,-{}\n"):
    earth, water = card.format(10.0), card.format(5.0)
    together, staged = reactions(earth + water), reactions(earth, water)
    print(card.split()[0], "one step", together, "two steps", staged)
    assert [z for _, z in together] == [15] and [z for _, z in staged] == [10, 5]
down, aside = "*DLOAD\nWALL,GRAV,10.,0,0,-1.\n", "*DLOAD\nWALL,GRAV,3.,1.,0,0\n"
weight = reactions(down, aside)
print("GRAV two steps", weight)
assert weight == [(0, 5), (-1.5, 5)]
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
