#!/usr/bin/env bash
# CalculiX 2.20: a pile of radius 50 mm from an Abaqus input becomes one of diameter 50 mm.
#
# Expected: `*BEAM SECTION, SECTION=CIRC` with the value 0.05 is a circle of this radius, as in
#     Abaqus.
# Seen: the head of a cantilever pile moves 111 mm in place of 6.8 mm, as a circle of diameter 0.05
#     would: the value is the diameter.  With 0.1 the result is right to 3 %.  `SECTION=PIPE` in the
#     same program takes the outer radius (and the thickness): 0.05, 0.01 is right to 1 %.
# Meaning: bending stiffness falls by a factor of 16 and the area by 4, in an input that both
#     programs read without a message.  Piles, anchors and props that are written for Abaqus need
#     their CIRC values doubled, and their PIPE values left alone.
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
import math
import subprocess

ELEMENTS, LENGTH, E, FORCE = 8, 1.0, 1e7, 1.0
N = 2 * ELEMENTS + 1


def head(section, values):
    """Displacement of the head of a cantilever under a force, and warnings in the log."""
    nodes = "".join(f"{i + 1},{LENGTH * i / (N - 1)},0,0\n" for i in range(N))
    bars = "".join(f"{e + 1},{2 * e + 1},{2 * e + 2},{2 * e + 3}\n" for e in range(ELEMENTS))
    text = (
        f"*NODE,NSET=ALL\n{nodes}*ELEMENT,TYPE=B32R,ELSET=PILE\n{bars}"
        f"*MATERIAL,NAME=STEEL\n*ELASTIC\n{E},0.\n"
        f"*BEAM SECTION,ELSET=PILE,MATERIAL=STEEL,SECTION={section}\n{values}\n0,0,1\n"
        f"*BOUNDARY\n1,1,6\n*NSET,NSET=HEAD\n{N}\n"
        f"*STEP\n*STATIC\n*CLOAD\nHEAD,2,{FORCE}\n*NODE PRINT,NSET=HEAD\nU\n*END STEP\n"
    )
    with open("pile.inp", "w") as file:
        file.write(text)
    log = subprocess.run(["ccx", "pile"], check=True, capture_output=True, text=True).stdout
    with open("pile.dat") as file:
        rows = [line.split() for line in file]
    moved = [float(row[2]) for row in rows if row[:1] == [str(N)]]
    return moved[-1], log.count("WARNING")


circle, pipe = math.pi * 0.05**4 / 4, math.pi * (0.05**4 - 0.04**4) / 4
for section, values, inertia, low, high in (
    ("CIRC", "0.05", circle, 15, 17),
    ("CIRC", "0.1,0.1", circle, 0.95, 1.05),
    ("PIPE", "0.05,0.01", pipe, 0.95, 1.05),
):
    moved, warnings = head(section, values)
    beam = FORCE * LENGTH**3 / (3 * E * inertia)
    print(f"{section} {values}: {1000 * moved:.2f} mm, beam of radius 0.05 m {1000 * beam:.2f} mm, "
          f"ratio {moved / beam:.3f}, warnings {warnings}")
    assert low < moved / beam < high and warnings == 0
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
