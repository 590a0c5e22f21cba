#!/usr/bin/env bash
# meshio 5.3.5: a mesh that was written for FLAC3D has other groups afterwards, in memory as well.
#
# Expected: writing a mesh leaves the mesh as it is, and a second file is like the first one.
# Seen: three bricks and four tetrahedra in the groups clay (2 m3), sand (1.333 m3) and fill (0.167 m3).  After
#     `write("ground.f3grid")` the sets of the mesh have 2, 1.25 and 0 m3, and point at three cells that do not
#     exist; after a second one the sand has 1 m3.  The sand has the cells 3, 4 and 7 in the first file, and
#     3, 7 and 10 of 7 in the second.  No message.
# Meaning: sets of all types of cells but the first are shifted in place with each file.  A mesh that is written
#     once for FLAC3D and then used, or written in each stage, has its soils in other places. Write a copy
#     (`copy.deepcopy`), and compare the volumes of the groups.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    meshio==5.3.5 numpy==2.4.6
cat > run.py <<'PY'
import meshio
import numpy as np

# Three bricks of 1 m in a row, and four tetrahedra on the last one, one of them larger.
points = np.array([[x, y, z] for x in range(4) for y in range(2) for z in range(2)], float)
bricks = np.array([[4 * i + j for j in (0, 4, 6, 2, 1, 5, 7, 3)] for i in range(3)])
top = np.array([[2, 0, 1], [3, 0, 1], [3, 1, 1], [2, 1, 1], [2.5, 0.5, 1], [2.5, 0.5, 2], [2, 1, 4]])
points = np.vstack([points, top])
a = len(points) - len(top)
tetrahedra = a + np.array([[0, 1, 4, 5], [1, 2, 4, 5], [2, 3, 4, 5], [3, 0, 4, 6]])
edges = [points[corners[1:]] - points[corners[0]] for corners in tetrahedra]
sizes = [np.ones(3), np.abs(np.linalg.det(edges)) / 6]


def volumes(mesh):
    """Volume in m3 of each group by its sets, and the number of places that do not exist."""
    found = {}
    for name, sets in mesh.cell_sets.items():
        inside = [np.asarray(s, int)[np.asarray(s, int) < len(v)] for s, v in zip(sets, sizes)]
        missing = sum(len(s) for s in sets) - sum(len(s) for s in inside)
        total = sum(float(v[s].sum()) for v, s in zip(sizes, inside))
        found[name] = (round(total, 3), missing)
    return found


none = np.array([], int)
ground = meshio.Mesh(
    points,
    [("hexahedron", bricks), ("tetra", tetrahedra)],
    cell_sets={
        "clay": [np.array([0, 1]), none],
        "sand": [np.array([2]), np.array([0, 3])],
        "fill": [none, np.array([1, 2])],
    },
)
found, numbers = [volumes(ground)], []
for _ in range(2):
    ground.write("ground.f3grid")
    found.append(volumes(ground))
    lines = open("ground.f3grid").read().splitlines()
    start = next(i for i, line in enumerate(lines) if '"sand"' in line)
    numbers.append([int(word) for word in lines[start + 1].split()])
for name, volume in zip(("drawn", "after a file", "after two files"), found):
    print(f"{name}: volume and missing cells {volume}")
print(f"cells of the sand in the first file {numbers[0]}, in the second {numbers[1]}, of 7 cells")
assert found[0] == {"clay": (2.0, 0), "sand": (1.333, 0), "fill": (0.167, 0)}
assert found[1] == {"clay": (2.0, 0), "sand": (1.25, 1), "fill": (0.0, 2)}
assert found[2] == {"clay": (2.0, 0), "sand": (1.0, 2), "fill": (0.0, 2)}
assert numbers == [[3, 4, 7], [3, 7, 10]]
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
