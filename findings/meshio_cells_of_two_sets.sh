#!/usr/bin/env bash
# meshio 5.3.5: clay that is dug in stage 1 is not clay any more in a .vtu file.
#
# Expected: a cell may be in two sets, "clay" and "dug_in_stage_1", and is in both after a file, or an error says that
#     the format cannot have it.
# Seen: three cells, the first two of clay, the last two dug.  After a file for Abaqus (.inp) both sets are as before.
#     After .vtu and .vtk, and `cell_data_to_sets`, the clay has the first cell alone.  With the sets in the
#     other order the clay is whole, and the excavation has one cell.  The message at writing says that sets are
#     converted, not that they lose cells.
# Meaning: the sets become one array with one number per cell, and the last set wins.  Soil and stage, material and
#     part, support and load overlap in every staged analysis: after a round trip soil has no material, or an
#     excavation leaves soil in the pit.  Write an array of 0 and 1 for each set.
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

points = np.array([[x, y, 0.0] for y in range(2) for x in range(4)])
cells = [("quad", np.array([[i, i + 1, i + 5, i + 4] for i in range(3)]))]
SETS = {"clay": [0, 1], "dug_in_stage_1": [1, 2]}


def kept(ending, order):
    """Sets of a mesh after a file; those of .vtu and .vtk come back as an array of cells."""
    sets = {name: [np.array(SETS[name])] for name in order}
    meshio.Mesh(points, cells, cell_sets=sets).write(f"soil.{ending}")
    mesh = meshio.read(f"soil.{ending}")
    for name in list(mesh.cell_data):
        mesh.cell_data_to_sets(name)
    return {name: np.asarray(found[0]).tolist() for name, found in mesh.cell_sets.items()}


for order in (("clay", "dug_in_stage_1"), ("dug_in_stage_1", "clay")):
    for ending in ("inp", "vtu", "vtk"):
        found = kept(ending, order)
        print(f"{ending}, {' before '.join(order)}: {found}")
        whole = {name: SETS[name] for name in order}
        last = order[1]
        first_only = [i for i in SETS[order[0]] if i not in SETS[last]]
        assert found == (whole if ending == "inp" else {order[0]: first_only, last: SETS[last]})
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
