#!/usr/bin/env bash
# PyNiteFEA 3.2.0: the load of a column disappears if the raft does not start at the origin.
#
# Expected: `add_mat_pt_load([X, Z], ...)` makes a node at the place of the load, as documented, in global
#     coordinates or in those of the raft, wherever the raft lies.
# Seen: a column of 600 kN at (2.6, 1.7) on a raft of 6 m x 4 m that starts at (0, 0): the soil carries
#     600 kN and settles by up to 4.2 mm.  The same raft and column moved by (10, 20): reaction 0, all
#     settlements 0.  With (2.6, 1.7), counted from the corner of the raft, it is 0, too.  Only where the place
#     is a node of the mesh by chance, at (13, 22), the load acts.  No message.
# Meaning: the point of the mesh is set in coordinates of the raft, and the load is put on it in global
#     ones.  In a site grid, and for the second raft of a model, loads of columns are missing from
#     settlements and soil pressures.  Compare the sum of the reactions with the loads, or start at the origin.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    PyNiteFEA==3.2.0 numpy==2.4.6 scipy==1.17.1
cat > run.py <<'PY'
from Pynite import FEModel3D

LENGTH, WIDTH, SUBGRADE, LOAD = 6.0, 4.0, 1e4, 600.0  # m, m, kN/m3, kN


def raft(corner, column):
    """Sum of the reactions in kN and mean settlement in mm under one column."""
    model = FEModel3D()
    model.add_material("concrete", 3e7, 1.25e7, 0.2, 25.0)
    model.add_mat_foundation(
        "raft", 1.0, LENGTH, WIDTH, 0.6, "concrete", SUBGRADE, [corner[0], 0, corner[1]], [], []
    )
    mat = model.mats["raft"]
    mat.add_mat_pt_load(list(column), "FY", -LOAD)
    mat.generate()
    for node in mat.nodes.values():
        model.def_support(node.name, support_DX=True, support_DZ=True, support_RY=True)
    model.analyze()
    nodes = mat.nodes.values()
    reaction = sum(node.RxnFY["Combo 1"] for node in nodes)
    return reaction, -1e3 * min(node.DY["Combo 1"] for node in nodes)


for name, corner, column, carried in (
    ("at the origin", (0, 0), (2.6, 1.7), LOAD),
    ("moved, global coordinates", (10, 20), (12.6, 21.7), 0),
    ("moved, coordinates of the raft", (10, 20), (2.6, 1.7), 0),
    ("moved, at a node", (10, 20), (13, 22), LOAD),
):
    reaction, settlement = raft(corner, column)
    print(f"{name}: reaction {reaction:.1f} kN of {LOAD:.0f}, largest settlement {settlement:.2f} mm")
    assert abs(reaction - carried) < 1e-3
    assert settlement > 2.5 if carried else settlement == 0
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
