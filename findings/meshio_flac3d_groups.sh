#!/usr/bin/env bash
# meshio 5.3.5: a fill of tetrahedra beside bricks has no volume after its grid was read from FLAC3D.
#
# Expected: the groups of a FLAC3D grid (.f3grid) come back with the cells, and the names, with which they were written.
# Seen: three bricks and four tetrahedra in the groups clay (2 m3), sand (1.333 m3) and fill (0.167 m3).  Read back,
#     the bricks are right; the sand has 1.25 m3 and one cell that does not exist, the fill 0 m3 and two such cells.
#     The names are "zone:clay:1" and so on.  No message.
# Meaning: sets count the cells of one type from 0, as in meshio's other formats, but here they count those of
#     all types.  In a larger mesh the numbers exist, and the group is somewhere else: a grid with
#     wedges or tetrahedra gets its soils, stages and supports in wrong places.  Subtract the number of the cells
#     before, and compare the volumes of the groups.
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
before = volumes(ground)
ground.write("ground.f3grid")
back = meshio.read("ground.f3grid")
assert [(b.type, len(b.data)) for b in back.cells] == [("hexahedron", 3), ("tetra", 4)]
after = volumes(back)
for name, sets in back.cell_sets.items():
    print(name, "sets read:", [np.asarray(s).tolist() for s in sets])
print(f"volume and missing cells, drawn: {before}\nread: {after}")
assert before == {"clay": (2.0, 0), "sand": (1.333, 0), "fill": (0.167, 0)}
assert after == {"zone:clay:1": (2.0, 0), "zone:sand:1": (1.25, 1), "zone:fill:1": (0.0, 2)}
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
