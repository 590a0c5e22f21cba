#!/usr/bin/env bash
# compas 2.15.1: the centre of a slice of a dam lies 1 m above its centre of gravity.
#
# Expected: `Mesh.centroid` of a closed mesh, whose `volume` is right, is the centre of gravity of the body, as it
#     is for a box.
# Seen: a gravity dam of 10 m, 8 m wide at its base and 1 m at its crest.  A slice of 1 m: 2.39 m from the heel and
#     4.71 m above the base, right are 2.70 m and 3.70 m.  A slice of 10 m: 2.68 m and 4.13 m; a dam of 100 m: 2.79 m
#     and 3.91 m; with the faces cut into triangles the slice of 10 m has 2.78 m and 3.84 m.
# Meaning: the method is the mean of the corners of each face, weighted with the area of the face, thus a point of the
#     skin that depends on the mesh, not of the body.  The lever of the weight is wrong, here for overturning about the
#     toe, and for the inertia of blocks in an earthquake.  `compas.geometry.centroid_polyhedron` is right.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    compas==2.15.1 numpy==2.4.6 scipy==1.17.1
cat > run.py <<'PY'
from compas.datastructures import Mesh
from compas.geometry import Box, centroid_polyhedron

DAM = ((0.0, 0.0), (8.0, 0.0), (1.0, 10.0), (0.0, 10.0))  # m, from the heel
AREA = (8.0 + 1.0) / 2 * 10.0
# A rectangle of 1 m and a triangle of 7 m.
RIGHT_X = (10.0 * 0.5 + 35.0 * (1.0 + 7.0 / 3)) / AREA
RIGHT_Z = (10.0 * 5.0 + 35.0 * 10.0 / 3) / AREA


def slice_of_dam(length, count):
    """Vertices and faces of a slice of the dam, with several faces along it."""
    corners = len(DAM)
    vertices = [[x, length * j / count, z] for j in range(count + 1) for x, z in DAM]
    faces = [list(range(corners)), [count * corners + i for i in reversed(range(corners))]]
    for j in range(count):
        for i in range(corners):
            k = (i + 1) % corners
            faces.append([j * corners + i, (j + 1) * corners + i, (j + 1) * corners + k, j * corners + k])
    return vertices, faces


box = Mesh.from_shape(Box.from_corner_corner_height([0, 0, 0], [8, 1, 0], 10))
assert all(abs(found - right) < 1e-9 for found, right in zip(box.centroid(), (4.0, 0.5, 5.0)))
print(f"right: {RIGHT_X:.2f} m from the heel, {RIGHT_Z:.2f} m above the base")
for length, count, triangles, seen in (
    (1.0, 1, False, (2.392, 4.711)),
    (10.0, 10, False, (2.678, 4.129)),
    (10.0, 10, True, (2.780, 3.839)),
    (100.0, 10, False, (2.786, 3.910)),
):
    vertices, faces = slice_of_dam(length, count)
    mesh = Mesh.from_vertices_and_faces(vertices, faces)
    if triangles:
        mesh.quads_to_triangles()
    x, _, z = mesh.centroid()
    true_x, _, true_z = centroid_polyhedron((vertices, faces))
    print(f"{length} m, triangles {triangles}: {x:.2f}, {z:.2f} m; centroid_polyhedron {true_x:.2f}, {true_z:.2f} m")
    assert abs(mesh.volume() / (AREA * length) - 1) < 1e-9
    assert abs(true_x - RIGHT_X) < 1e-9 and abs(true_z - RIGHT_Z) < 1e-9
    assert abs(x - seen[0]) < 2e-3 and abs(z - seen[1]) < 2e-3
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
