#!/usr/bin/env bash
# triangle 20250106: the unit square, meshed with six-node triangles, has the area -1.
#
# Expected: the six nodes of a triangle from `triangulate(..., "o2")` have the order of VTK, Abaqus
#     and Gmsh: the fourth lies between the first and the second.
# Seen: the fourth lies opposite the first node, between the second and the third.  With the usual
#     shape functions the area of the unit square is -1.0000 in place of 1, and every element is
#     inverted.  The corners alone are right and counter-clockwise.
# Meaning: a program that takes the absolute value of the Jacobian, or draws corners only, accepts
#     this mesh: the area is right, and stiffness and loads are those of elements whose sides cross.
#     Reorder the columns to 0, 1, 2, 5, 3, 4 before the mesh is used.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    triangle==20250106 numpy==2.4.6
cat > run.py <<'PY'
import numpy as np
import triangle

square = dict(
    vertices=[[0, 0], [1, 0], [1, 1], [0, 1]], segments=[[0, 1], [1, 2], [2, 3], [3, 0]]
)
mesh = triangle.triangulate(square, "pqa0.05o2")
points, elements = mesh["vertices"], mesh["triangles"]
# Three points that are exact for polynomials of degree two.
POINTS = np.array([[1 / 6, 1 / 6], [2 / 3, 1 / 6], [1 / 6, 2 / 3]])


def area(elements):
    """Area by the Jacobian of six-node triangles in the usual order."""
    total = 0.0
    for r, s in POINTS:
        t = 1 - r - s
        by_r = np.array([1 - 4 * t, 4 * r - 1, 0, 4 * (t - r), 4 * s, -4 * s])
        by_s = np.array([1 - 4 * t, 0, 4 * s - 1, -4 * r, 4 * r, 4 * (t - s)])
        a, b = by_r @ points[elements], by_s @ points[elements]
        total += (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum() / 6
    return total


usual = elements[:, [0, 1, 2, 5, 3, 4]]
for name, nodes in (("as returned", elements), ("reordered", usual)):
    middle = (points[nodes[:, 0]] + points[nodes[:, 1]]) / 2
    print(f"{name}: fourth node {abs(points[nodes[:, 3]] - middle).max():.3f} m from the middle of "
          f"the first side, area {area(nodes):.4f} m2")
corners = points[elements[:, :3]]
a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
assert (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0] > 0).all()
assert abs(area(elements) + 1) < 1e-9 and abs(area(usual) - 1) < 1e-9
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
