#!/usr/bin/env bash
# meshio 5.3.5, KratosMultiphysics 10.4.4: a brick of 20 nodes gets the volume -0.24 on its way.
#
# Expected: meshio writes a straight unit cube of 20 nodes as .mdpa, and Kratos finds the volume 1.
# Seen: -0.244.  meshio writes the nodes in the order of VTK, Kratos has the nodes of the upright
#     edges before the ones of the upper face.  In Kratos' order the volume is 1.  Neither program
#     has a message; bricks of 8 nodes are right.
# Meaning: stiffness and weight of a body of the better elements are nonsense, while a picture of
#     the corners looks right.  Compare the volume of the elements after every change of programs.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    meshio==5.3.5 numpy==2.4.6 KratosMultiphysics==10.4.4
cat > run.py <<'PY'
import KratosMultiphysics as Kratos
import meshio
import numpy as np

corners = np.array([
    [0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1.0],
])
edges = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
points = np.r_[corners, [(corners[a] + corners[b]) / 2 for a, b in edges]]


def written(kind, count):
    """Numbers of the nodes of the element in the file that meshio writes."""
    cells = [(kind, np.arange(count)[None])]
    meshio.Mesh(points[:count], cells).write("brick.mdpa")
    with open("brick.mdpa") as file:
        text = file.read().split("Begin Elements")[1].split("\n")[1]
    return [int(word) for word in text.split()[2:]]


def volume(shape, order):
    """Volume that Kratos finds for an element with these nodes."""
    part = Kratos.Model().CreateModelPart("part")
    for number, x in enumerate(points, start=1):
        part.CreateNewNode(number, *x)
    return shape(*[part.GetNode(number) for number in order]).DomainSize()


straight = volume(Kratos.Hexahedra3D8, written("hexahedron", 8))
misread = volume(Kratos.Hexahedra3D20, written("hexahedron20", 20))
right = volume(Kratos.Hexahedra3D20, [*range(1, 13), 17, 18, 19, 20, 13, 14, 15, 16])
print(f"8 nodes {straight:.3f}, 20 nodes {misread:.3f}, in the order of Kratos {right:.3f}")
assert abs(straight - 1) < 1e-9 and abs(right - 1) < 1e-9
assert abs(misread + 0.2444) < 1e-3
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
