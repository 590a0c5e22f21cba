#!/usr/bin/env bash
# meshio 5.3.5: a mesh of bricks and tetrahedra is written to CGNS without its bricks.
#
# Expected: all cells and the results of the points are in the file, or an error says which types the format
#     cannot have.
# Seen: two bricks with two tetrahedra on each, and a head at the points.  Written as .vtu and read back: two
#     bricks, four tetrahedra, the head.  As .cgns: four tetrahedra, all 14 points, no head; the same with the
#     tetrahedra first. No message.
# Meaning: the ground below is missing, its points hang in the air, and the mesh that arrives is valid. A flow
#     program that reads it takes the hole for a boundary.  Compare the number of cells and the volume, or
#     take another format.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    h5py==3.16.0 meshio==5.3.5 numpy==2.4.6
cat > run.py <<'PY'
import meshio
import numpy as np

points = np.array([[x, y, z] for x in range(3) for y in range(2) for z in range(2)], float)
points = np.vstack([points, [[0.5, 0.5, 2.0], [1.5, 0.5, 2.0]]])
bricks = np.array([[4 * i + j for j in (0, 4, 6, 2, 1, 5, 7, 3)] for i in range(2)])
tops = [1, 5, 7, 3], [5, 9, 11, 7]
tetrahedra = np.array(
    [[p, *pair, 12 + i] for i, (p, q, r, s) in enumerate(tops) for pair in ((q, r), (r, s))]
)


def count(mesh):
    """Number of cells of each type, and names of the results."""
    return {block.type: len(block.data) for block in mesh.cells}, sorted(mesh.point_data)


for cells in (
    [("hexahedron", bricks), ("tetra", tetrahedra)],
    [("tetra", tetrahedra), ("hexahedron", bricks)],
):
    ground = meshio.Mesh(points, cells, point_data={"head": np.arange(len(points)) * 1.0})
    seen = {}
    for ending in ("vtu", "cgns"):
        ground.write(f"ground.{ending}")
        seen[ending] = count(meshio.read(f"ground.{ending}"))
    print(f"written {count(ground)}, read {seen}")
    assert seen["vtu"] == count(ground) == ({"hexahedron": 2, "tetra": 4}, ["head"])
    assert seen["cgns"] == ({"tetra": 4}, [])
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
