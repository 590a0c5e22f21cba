#!/usr/bin/env bash
# meshio 5.3.5: the wall of an Abaqus assembly stands in the soil, and the soil has the wall's shape.
#
# Expected: two parts, each with nodes 1 to 4 as usual, are placed by the translations of their
#     *INSTANCE cards, or the file is refused.
# Seen: soil of 1 m x 1 m and a wall of 0.2 m x 2 m beside it are read as four points and two
#     quadrilaterals with the same four corners, those of the wall part before it is moved.  Both
#     element sets are there.  The soil has an area of 0.4 m2 in place of 1 m2, and the wall starts at
#     x = 0 in place of 1 m.  No message.
# Meaning: later nodes replace earlier ones of the same number, and instances are not read.  Any model
#     with more than one part loses all but the last, while elements, sets and names suggest a
#     complete one.  Write the file with "parts and assemblies" turned off, and compare the area of
#     each set.
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

PART = """*PART, NAME={name}
*NODE
1, 0., 0., 0.
2, {width}, 0., 0.
3, {width}, {height}, 0.
4, 0., {height}, 0.
*ELEMENT, TYPE=CPS4, ELSET={name}
1, 1, 2, 3, 4
*END PART
"""
ASSEMBLY = """*ASSEMBLY, NAME=SITE
*INSTANCE, NAME=SOIL-1, PART=SOIL
*END INSTANCE
*INSTANCE, NAME=WALL-1, PART=WALL
1., 0., 0.
*END INSTANCE
*END ASSEMBLY
"""

with open("site.inp", "w") as file:
    file.write("*HEADING\n" + PART.format(name="SOIL", width=1.0, height=1.0)
               + PART.format(name="WALL", width=0.2, height=2.0) + ASSEMBLY)
mesh = meshio.read("site.inp")
for name, blocks in mesh.cell_sets.items():
    cells = np.vstack([block.data[chosen.astype(int)]
                       for block, chosen in zip(mesh.cells, blocks, strict=True)])
    size = np.ptp(mesh.points[cells[0]], axis=0)
    print(f"{name}: {len(cells)} element, width {size[0]}, height {size[1]}, "
          f"from x = {mesh.points[cells[0], 0].min()}")
    assert len(cells) == 1 and np.allclose(size, [0.2, 2, 0])
    assert mesh.points[cells[0], 0].min() == 0
assert len(mesh.points) == 4 and set(mesh.cell_sets) == {"SOIL", "WALL"}
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
