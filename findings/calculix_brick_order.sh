#!/usr/bin/env bash
# CalculiX 2.20: the result file numbers the nodes of a brick differently from the input file.
#
# Expected: an element C3D20 has its 20 nodes in the .frd file in the order of the .inp file.
# Seen: the last two groups of four are swapped: nodes 17 to 20, in the middle of the vertical edges,
#     come before nodes 13 to 16 of the upper face.
# Meaning: a reader of .frd files that takes the order of the input (which is VTK's, too) puts
#     midside nodes on other edges.  Corner values and pictures of the corners stay right; volumes,
#     gradients and values inside the elements are wrong: the straight unit cube gets the volume
#     -0.24.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
if [[ "$(ccx -v 2>&1 || true)" != *2.20* ]]; then
    echo 'needs CalculiX 2.20: apt-get install calculix-ccx'
    exit 1
fi
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6
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

import numpy as np

corners = np.array([
    [0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1.0],
])
edges = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
nodes = np.r_[corners, [(corners[a] + corners[b]) / 2 for a, b in edges]]
text = "*NODE,NSET=ALL\n"
for number, (x, y, z) in enumerate(nodes, start=1):
    text += f"{number},{x},{y},{z}\n"
text += "*ELEMENT,TYPE=C3D20,ELSET=SOIL\n1," + ",".join(map(str, range(1, 16))) + ",\n"
text += ",".join(map(str, range(16, 21)))
run("brick", text + """
*MATERIAL,NAME=SOIL
*ELASTIC
1e7,0.3
*SOLID SECTION,ELSET=SOIL,MATERIAL=SOIL
*BOUNDARY
1,1,3
2,2,3
3,3,3
4,3,3
4,1,1
*STEP
*STATIC
*DLOAD
SOIL,P2,1e3
*NODE FILE
U
*NODE PRINT,NSET=ALL
U
*END STEP
""")
with open("brick.frd") as file:
    order = [int(number) for line in file if line.startswith(" -2") for number in line.split()[1:]]
print("order in the result file:", order)
assert order == [*range(1, 13), *range(17, 21), *range(13, 17)]


def volume(nodes):
    """Volume of a 20-node brick with nodes in the order of the input, by 4**3 Gauss points."""
    reference = 2 * np.r_[corners, [(corners[a] + corners[b]) / 2 for a, b in edges]] - 1

    def shape(x):
        factors = 1 + reference * x
        corner = factors.prod(axis=1) * ((reference * x).sum(axis=1) - 2) / 8
        middle = np.where(reference == 0, 1 - x**2, factors).prod(axis=1) / 4
        return np.where((reference == 0).any(axis=1), middle, corner)

    points, weights = np.polynomial.legendre.leggauss(4)
    total, step = 0.0, 1e-5
    for i, j, k in np.ndindex(4, 4, 4):
        x = points[[i, j, k]]
        slopes = [(shape(x + d) - shape(x - d)) / (2 * step) for d in step * np.eye(3)]
        total += weights[[i, j, k]].prod() * np.linalg.det(np.array(slopes) @ nodes)
    return total


right, misread = volume(nodes), volume(nodes[np.array(order) - 1])
print(f"volume of the unit cube {right:.4f}; with the order misread {misread:.4f}")
assert abs(right - 1) < 1e-6 and abs(misread - 1) > 0.1
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
