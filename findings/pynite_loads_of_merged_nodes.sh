#!/usr/bin/env bash
# PyNiteFEA 3.2.0: the load on a joint is gone after `merge_duplicate_nodes`, if the joint was drawn twice.
#
# Expected: two nodes at one place become one node, which has the loads, the supports and the prescribed
#     displacements of both.  (Supports and springs are kept.)
# Seen: a beam of two members that were drawn with a joint each.  10 kN on the first of the two nodes: 0.1667 mm,
#     as by hand, and reactions of 10 kN.  On the second one: 0 mm, reactions of 0 kN.  A settlement of
#     10 mm of the second node is kept as a support that does not move: 0 mm.  No message.
# Meaning: which of the two nodes stays depends on the order in which members are drawn or imported.  Loads of
#     columns and settlements of supports vanish, and the check of equilibrium cannot find it, since load and
#     reaction vanish together.  Merge first, then load, or compare the sum of the reactions.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    PyNiteFEA==3.2.0 numpy==2.4.6 scipy==1.17.1
cat > run.py <<'PY'
from Pynite import FEModel3D


def beam(support, **action):
    """Deflection in mm at the joint of two members that were drawn with a node each."""
    model = FEModel3D()
    model.add_material("steel", 2e8, 8e7, 0.3, 0)
    model.add_section("beam", 1e-2, 1e-4, 1e-4, 2e-4)
    for name, x in (("A", 0), ("B", 2), ("B2", 2), ("C", 4)):
        model.add_node(name, x, 0, 0)
    model.add_member("left", "A", "B", "steel", "beam")
    model.add_member("right", "B2", "C", "steel", "beam")
    for name in support:
        model.def_support(name, True, True, True, True, True, True)
    if "load" in action:
        model.add_node_load(action["load"], "FY", -10.0)
    if "moved" in action:
        model.def_support(action["moved"], support_DY=True)
        model.def_node_disp(action["moved"], "DY", -0.010)
    model.merge_duplicate_nodes()
    model.analyze(check_statics=False)
    assert len(model.nodes) == 3
    reaction = sum(node.RxnFY["Combo 1"] for node in model.nodes.values())
    return 1e3 * model.nodes["B"].DY["Combo 1"], reaction


right = -10 * 4**3 / (192 * 2e8 * 1e-4) * 1e3
for name, action, seen, sum_of_reactions in (
    ("load of 10 kN on the first node", {"load": "B"}, right, 10),
    ("load of 10 kN on the second node", {"load": "B2"}, 0, 0),
    ("settlement of 10 mm of the first node", {"moved": "B"}, -10, 0),
    ("settlement of 10 mm of the second node", {"moved": "B2"}, 0, 0),
):
    deflection, reaction = beam("AC", **action)
    print(f"{name}: deflection {deflection:.4f} mm, sum of the reactions {reaction:.3f} kN")
    assert abs(deflection - seen) < 1e-9 and abs(reaction - sum_of_reactions) < 1e-6
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
