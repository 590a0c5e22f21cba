#!/usr/bin/env bash
# CalculiX 2.20: the shear stresses of one job have one order in the .dat file and another one in the .frd file.
#
# Expected: both files list the six stresses in the order of the input (xx, yy, zz, xy, xz, yz).
# Seen: a cube with a single shear stress of 5 kPa.  xy is the fourth in both.  xz is the fifth in the .dat file and
#     the sixth in the .frd file, yz the other way round.  The titles in the files say so.
# Meaning: a script that reads both files, or puts stresses of a .frd file into *INITIAL CONDITIONS, TYPE=STRESS for
#     the next stage, swaps two shear stresses.  Equivalent and principal stresses under a vertical load on a
#     symmetric block hardly change and hide it; the shear on a pile or a wall acts on the wrong side.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
if [[ "$(ccx -v 2>&1 || true)" != *2.20* ]]; then
    echo 'needs CalculiX 2.20: apt-get install calculix-ccx'
    exit 1
fi
cat > run.py <<'PY'
import re
import subprocess

CORNERS = [(x, y, z) for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
SHEAR = {"xy": (0, 1), "xz": (0, 2), "yz": (1, 2)}  # direction of the displacement, place it grows with


def components(plane):
    """Names of the component that is 5 kPa, by the place in the list and by its title, in both files."""
    along, across = SHEAR[plane]
    lines = ["*NODE,NSET=ALL"]
    lines += [f"{i},{x},{y},{z}" for i, (x, y, z) in enumerate(CORNERS, 1)]
    lines += ["*ELEMENT,TYPE=C3D8,ELSET=SOIL", "1,1,2,3,4,5,6,7,8", "*MATERIAL,NAME=SOIL", "*ELASTIC"]
    lines += ["1000,0", "*SOLID SECTION,ELSET=SOIL,MATERIAL=SOIL", "*STEP", "*STATIC", "*BOUNDARY"]
    for i, corner in enumerate(CORNERS, 1):
        moved = [0.01 * corner[across] if j == along else 0 for j in range(3)]
        lines += [f"{i},{j + 1},{j + 1},{moved[j]}" for j in range(3)]
    lines += ["*EL PRINT,ELSET=SOIL", "S", "*EL FILE", "S", "*END STEP"]
    with open("block.inp", "w") as file:
        file.write("\n".join(lines) + "\n")
    subprocess.run(["ccx", "block"], check=True, capture_output=True)

    with open("block.dat") as file:
        table = file.read()
    titles = re.search(r"\(elem, integ.pnt.,(.*?)\)", table).group(1).split(",")
    row = next(line.split() for line in table.splitlines() if line.split()[:2] == ["1", "1"])
    values = [float(word) for word in row[2:]]
    place = max(range(6), key=lambda i: abs(values[i]))
    assert abs(values[place] - 5) < 1e-3

    with open("block.frd") as file:
        result = file.read()
    result = result[result.index("STRESS") :]
    names = re.findall(r"-5  (S[XYZ]{2})", result)
    row = next(line for line in result.splitlines() if line.startswith(" -1"))
    values = [float(row[13 + 12 * i : 25 + 12 * i]) for i in range(6)]
    second = max(range(6), key=lambda i: abs(values[i]))
    assert abs(values[second] - 5) < 1e-2
    return (place + 1, titles[place]), (second + 1, names[second])


seen = {plane: components(plane) for plane in SHEAR}
for plane, (table, result) in seen.items():
    print(f"shear stress {plane}: component {table} of the .dat file, {result} of the .frd file")
assert seen == {
    "xy": ((4, "sxy"), (4, "SXY")),
    "xz": ((5, "sxz"), (6, "SZX")),
    "yz": ((6, "syz"), (5, "SYZ")),
}
PY
OMP_NUM_THREADS=1 python3 run.py
