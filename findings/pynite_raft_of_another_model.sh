#!/usr/bin/env bash
# PyNiteFEA 3.2.0: the settlement of a raft depends on the raft that was calculated before it.
#
# Expected: two models have nothing in common; a raft has the same mesh and settlement whenever it is calculated.
# Seen: a raft of 5 m x 3 m with a column of 600 kN: 24 quadrilaterals, settlement 14.00 mm, uplift 7.56 mm.
#     The same call after a raft of 6 m x 4 m in another model: 35 quadrilaterals, 14.48 mm and 8.24 mm.  With
#     `x_control=[]` and `y_control=[]` it is as alone.
# Meaning: the lists of the lines of the mesh are default arguments of `add_mat_foundation`, and each raft
#     leaves the places of its columns and edges in them.  The second case of a study of
#     sizes has the mesh of the first one as well, results depend on the order of the cases, and a check of a
#     single case in a new session gives another figure.  Pass empty lists.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    PyNiteFEA==3.2.0 numpy==2.4.6 scipy==1.17.1
cat > run.py <<'PY'
from Pynite import FEModel3D


def raft(length, width, column, *lists):
    """Number of quadrilaterals, largest settlement and largest uplift in mm under one column."""
    model = FEModel3D()
    model.add_material("concrete", 3e7, 1.25e7, 0.2, 25.0)
    model.add_mat_foundation(
        "raft", 1.0, length, width, 0.6, "concrete", 1e4, [0, 0, 0], *lists
    )
    mat = model.mats["raft"]
    mat.add_mat_pt_load(list(column), "FY", -600.0)
    mat.generate()
    for node in mat.nodes.values():
        model.def_support(node.name, support_DX=True, support_DZ=True, support_RY=True)
    model.analyze()
    moved = [1e3 * node.DY["Combo 1"] for node in mat.nodes.values()]
    return len(model.quads), -float(min(moved)), float(max(moved))


SMALL, LARGE = (5.0, 3.0, (1.3, 1.1)), (6.0, 4.0, (2.6, 1.7))
alone = raft(*SMALL)
raft(*LARGE)
second = raft(*SMALL)
again = raft(*SMALL, [], [])
print("quadrilaterals, settlement and uplift in mm")
print(f"alone {alone}\nafter another raft {second}\nthe same with empty lists {again}")
assert alone[0] == again[0] == 24 and second[0] == 35
assert max(abs(a - b) for a, b in zip(alone, again)) < 1e-6
assert 1.02 < second[1] / alone[1] < 1.05 and 1.07 < second[2] / alone[2] < 1.11
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
