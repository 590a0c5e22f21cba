#!/usr/bin/env bash
# meshio 5.3.5, pyNastran 1.3.4: the lining of a tunnel from Nastran becomes a flat strip.
#
# Expected: nodes that are given in a cylindrical system (field CP of GRID, CORD2C) are moved to
#     Cartesian coordinates, or refused.
# Seen: meshio reads radius, angle and height as x, y and z: a quarter of a ring of radii 2 and 3 m
#     spans 1 m by 90 "m", and its area is 90 m2 in place of 3.9 m2.  There is no message. pyNastran
#     gives the right points by `get_position()`, and r, angle and z by `xyz`.
# Meaning: linings, shafts and piles are usually written in such systems.  A local Cartesian system
#     (CORD2R) is ignored as well: a node at 1, 0, 0 in a system shifted by 10 m along y is read as
#     1, 0, 0.  Search the file for CORD cards before it is converted.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    meshio==5.3.5 pyNastran==1.3.4 numpy==2.4.6
cat > run.py <<'PY'
import meshio
import numpy as np
from pyNastran.bdf.bdf import BDF

STEPS = 9
with open("lining.bdf", "w") as file:
    file.write("CEND\nBEGIN BULK\n")
    file.write("CORD2C,1,,0.,0.,0.,0.,0.,1.,\n,1.,0.,0.\n")
    for i in range(STEPS + 1):
        for j, radius in enumerate((2.0, 3.0)):
            file.write(f"GRID,{2 * i + j + 1},1,{radius},{90.0 * i / STEPS},0.\n")
    for i in range(STEPS):
        first = 2 * i + 1
        file.write(f"CQUAD4,{i + 1},1,{first},{first + 1},{first + 3},{first + 2}\n")
    file.write("PSHELL,1,1,.3\nMAT1,1,3.+10,,.2\nENDDATA\n")


def area(points, quads):
    """Area of plane quadrilaterals, from their diagonals."""
    a = points[quads[:, 2]] - points[quads[:, 0]]
    b = points[quads[:, 3]] - points[quads[:, 1]]
    return abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum() / 2


mesh = meshio.read("lining.bdf")
model = BDF(debug=None)
model.read_bdf("lining.bdf")
right = np.array([node.get_position() for _, node in sorted(model.nodes.items())])
quads = mesh.cells_dict["quad"]
print(f"meshio: extent {np.ptp(mesh.points, axis=0)}, area {area(mesh.points, quads):.2f} m2")
print(f"pyNastran: extent {np.ptp(right, axis=0).round(3)}, area {area(right, quads):.2f} m2")
assert np.allclose(np.ptp(mesh.points, axis=0), [1, 90, 0])
assert abs(area(mesh.points, quads) - 90) < 1e-9
assert abs(area(right, quads) - np.pi * 5 / 4) < 0.03
assert np.allclose(model.nodes[19].xyz, [2, 90, 0])

with open("shifted.bdf", "w") as file:
    file.write("CEND\nBEGIN BULK\nCORD2R,1,,0.,10.,0.,0.,10.,1.,\n,1.,10.,0.\n")
    for tag, (x, y) in enumerate([(0, 0), (1, 0), (1, 1), (0, 1)], start=1):
        file.write(f"GRID,{tag},1,{x}.,{y}.,0.\n")
    file.write("CQUAD4,1,1,1,2,3,4\nPSHELL,1,1,.3\nMAT1,1,3.+10,,.2\nENDDATA\n")
mesh = meshio.read("shifted.bdf")
model = BDF(debug=None)
model.read_bdf("shifted.bdf")
print("CORD2R: meshio", mesh.points[1], "pyNastran", model.nodes[2].get_position())
assert np.allclose(mesh.points[1], [1, 0, 0])
assert np.allclose(model.nodes[2].get_position(), [1, 10, 0])
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
