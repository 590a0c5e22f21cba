#!/usr/bin/env bash
# CalculiX 2.20: a beam of elements B31R becomes softer with every refinement, without a limit.
#
# Expected: the deflection of a clamped beam with a force at its end converges to that of beam
#     theory; reduced integration makes an element of two nodes softer, and better.
# Seen: 6.1 times the right deflection with 4 elements, 20 times with 8, 47 times with 16 and 70
#     times with 32, without a message.  B31 with the same nodes has 0.989, 1.001, 1.004 and 1.005,
#     and B32R 1.005.
# Meaning: the element is expanded to one brick with a single integration point, and bending is a
#     pattern of this brick that costs almost no energy.  Walls, piles and props of B31R hardly
#     resist bending, and refinement makes it worse.  Use B31 or B32R.
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

LENGTH, SIDE, E, FORCE = 1.0, 0.1, 1e7, 1.0


def deflection(kind, elements, direction):
    """Deflection of the end of a clamped square beam, and warnings in the log."""
    order = 2 if kind.startswith("B32") else 1
    n = order * elements + 1
    nodes = "".join(f"{i + 1},{LENGTH * i / (n - 1)},0,0\n" for i in range(n))
    bars = ""
    for e in range(elements):
        bars += f"{e + 1}," + ",".join(str(order * e + 1 + k) for k in range(order + 1)) + "\n"
    text = (
        f"*NODE,NSET=ALL\n{nodes}*ELEMENT,TYPE={kind},ELSET=BEAM\n{bars}"
        f"*MATERIAL,NAME=STEEL\n*ELASTIC\n{E},0.\n"
        f"*BEAM SECTION,ELSET=BEAM,MATERIAL=STEEL,SECTION=RECT\n{SIDE},{SIDE}\n0,0,1\n"
        f"*BOUNDARY\n1,1,6\n*NSET,NSET=TIP\n{n}\n"
        f"*STEP\n*STATIC\n*CLOAD\nTIP,{direction},{FORCE}\n*NODE PRINT,NSET=TIP\nU\n*END STEP\n"
    )
    with open("beam.inp", "w") as file:
        file.write(text)
    log = subprocess.run(["ccx", "beam"], check=True, capture_output=True, text=True).stdout
    with open("beam.dat") as file:
        rows = [line.split() for line in file]
    moved = [float(row[direction]) for row in rows if row[:1] == [str(n)]]
    return moved[-1], log.count("WARNING")


right = FORCE * LENGTH**3 / (3 * E * SIDE**4 / 12)
for kind in ("B31", "B32R", "B31R"):
    for direction in (2, 3):
        ratios = []
        for elements in (4, 8, 16, 32):
            moved, warnings = deflection(kind, elements, direction)
            ratios.append(moved / right)
            assert warnings == 0
        print(f"{kind}, direction {direction}: " + ", ".join(f"{ratio:.3f}" for ratio in ratios))
        if kind == "B31R":
            assert all(b > 1.3 * a for a, b in zip(ratios, ratios[1:])) and ratios[0] > 5
        else:
            assert all(0.98 < ratio < 1.02 for ratio in ratios)
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
