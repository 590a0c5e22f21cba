#!/usr/bin/env bash
# CalculiX 2.20: rock under 100 kPa has a vertical stress of 75 kPa in one result file and 100 kPa in the other.
#
# Expected: stresses and reactions are in the axes of the model in both result files; an elastic rock whose beds have no
#     influence has the same results with and without `*ORIENTATION` and `*TRANSFORM`.
# Seen: a block of 1 m3, isotropic, under 100 kPa.  Without both cards szz is -100 kPa in the .dat and the .frd file.
#     With beds at 30 degrees (`*ORIENTATION`) the .dat file has szz -75, sxx -25 and sxz -43.3 kPa, the .frd file -100
#     kPa.  With the base in axes at 30 degrees (`*TRANSFORM`) the four reactions of the .dat file are 12.5 kN sideways
#     and 21.65 kN upwards, together 86.6 kN; the line "total force" below them says 100 kN, and so does the .frd
#     file.  A name at the end of the line is the only sign; `GLOBAL=YES` gives the axes of the model in the .dat file.
# Meaning: the overburden of bedded rock read from the .dat file is a quarter too small, with a shear stress that is
#     not there, only because the rock got beds, and sums of reactions at inclined supports miss the load.
#     Ask for GLOBAL=YES, or read the .frd file.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
if [[ "$(ccx -v 2>&1 || true)" != *2.20* ]]; then
    echo 'needs CalculiX 2.20: apt-get install calculix-ccx'
    exit 1
fi
cat > run.py <<'PY'
import math
import subprocess

LOAD = 100.0  # kN on 1 m2
CORNERS = ((0, 0), (1, 0), (1, 1), (0, 1))
COSINE, SINE = math.cos(math.pi / 6), 0.5
AXES = f"{COSINE},0,{SINE},0,1,0"
NODES = "".join(f"{4 * z + i},{x},{y},{z}\n" for z in (0, 1) for i, (x, y) in enumerate(CORNERS, 1))


def block(beds=False, turned=False, output=""):
    """Stresses sxx, szz, sxz, sums of the reactions in x and z and total of the .dat file, szz of the .frd file."""
    orientation = f"*ORIENTATION,NAME=BEDS\n{AXES}\n" if beds else ""
    transform = f"*TRANSFORM,NSET=BASE,TYPE=R\n{AXES}\n" if turned else ""
    text = (
        f"*NODE,NSET=ALL\n{NODES}*ELEMENT,TYPE=C3D8,ELSET=ROCK\n1,1,2,3,4,5,6,7,8\n"
        f"*NSET,NSET=BASE\n1,2,3,4\n*NSET,NSET=TOP\n5,6,7,8\n{orientation}"
        f"*MATERIAL,NAME=ROCK\n*ELASTIC\n1e4,0.\n"
        f"*SOLID SECTION,ELSET=ROCK,MATERIAL=ROCK{',ORIENTATION=BEDS' if beds else ''}\n"
        f"{transform}*BOUNDARY\nBASE,1,3\n*STEP\n*STATIC\n*CLOAD\nTOP,3,{-LOAD / 4}\n"
        f"*NODE PRINT,NSET=BASE,TOTALS=YES{output}\nRF\n*EL PRINT,ELSET=ROCK{output}\nS\n*EL FILE\nS\n*END STEP\n"
    )
    with open("rock.inp", "w") as file:
        file.write(text)
    subprocess.run(["ccx", "rock"], check=True, capture_output=True)
    with open("rock.dat") as file:
        rows = [line.split() for line in file]
    reactions = [row for row in rows if len(row) in (4, 5) and row[0] in "1234"]
    (total,) = [row for row in rows if len(row) == 3 and all("E" in word for word in row)]
    (stress, *_) = [row for row in rows if len(row) >= 8 and row[:2] == ["1", "1"]]
    with open("rock.frd") as file:
        lines = file.read().split("-4  STRESS")[1].splitlines()
    # a record of a node has its number in ten places, and twelve for each value
    node = next(line for line in lines if line.startswith(" -1"))
    sums = [sum(float(row[column]) for row in reactions) for column in (1, 3)]
    return [float(stress[column]) for column in (2, 4, 6)], sums, float(total[2]), float(node[37:49])


def same(found, right):
    """Are the values right within 0.01 kN or kPa?"""
    return all(math.isclose(value, other, abs_tol=0.01) for value, other in zip(found, right, strict=True))


upright, inclined = [0.0, -LOAD, 0.0], [-LOAD * SINE**2, -LOAD * COSINE**2, -LOAD * SINE * COSINE]
CASES = {
    (False, False, ""): (upright, [0.0, LOAD]),
    (True, False, ""): (inclined, [0.0, LOAD]),
    (False, True, ""): (upright, [LOAD * SINE, LOAD * COSINE]),
    (True, True, ",GLOBAL=YES"): (upright, [0.0, LOAD]),
}
for case, (stress, reaction) in CASES.items():
    found, sums, total, written = block(*case)
    print(f"beds {case[0]}, axes of the base {case[1]} {case[2]}: .dat sxx, szz, sxz {found} kPa, sum of the reactions "
          f"{sums} kN, total {total} kN; .frd szz {written} kPa")
    assert same(found, stress) and same(sums, reaction)
    assert same([total, written], [LOAD, -LOAD])
PY
python3 run.py
