#!/usr/bin/env bash
# PyNiteFEA 3.2.0: a P-Delta analysis finds two thirds of the moment of a slender column.
#
# Expected: `analyze_PDelta` gives the moment of a simply supported column under half its buckling
#     load and a lateral load; its geometric stiffness includes the bending of the member.
# Seen: 26.3 kNm with one member, where theory has 40.6 kNm and a first-order analysis 20.0 kNm.
#     With two members it is 40.4, with four 40.58 kNm.  What the axial force does along a member,
#     between its nodes, is found in part only.
# Meaning: props, piles and braces that are modelled by one member each, the usual way in this
#     program, are on the unsafe side by a third, though the analysis is called second-order.  Add a
#     node at mid-height of each slender member.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    PyNiteFEA==3.2.0 numpy==2.4.6 scipy==1.17.1
cat > run.py <<'PY'
import numpy as np
from Pynite import FEModel3D

LENGTH, E, I, LATERAL = 4.0, 200e6, 2e-4, 10.0
AXIAL = 0.5 * np.pi**2 * E * I / LENGTH**2


def largest_moment(members, second_order):
    """Largest moment of a simply supported column of some members, in kNm."""
    model = FEModel3D()
    model.add_material("steel", E, 80e6, 0.3, 77)
    model.add_section("column", 0.01, 1e-4, I, 1e-5)
    for i in range(members + 1):
        model.add_node(f"N{i}", LENGTH * i / members, 0, 0)
    for i in range(members):
        model.add_member(f"M{i}", f"N{i}", f"N{i + 1}", "steel", "column")
        model.add_member_dist_load(f"M{i}", "FY", -LATERAL, -LATERAL)
    model.def_support("N0", True, True, True, True, False, False)
    model.def_support(f"N{members}", False, True, True, False, False, False)
    model.add_node_load(f"N{members}", "FX", -AXIAL)
    if second_order:
        model.analyze_PDelta()
    else:
        model.analyze()
    return max(
        max(abs(member.max_moment("Mz")), abs(member.min_moment("Mz")))
        for member in model.members.values()
    )


k = np.sqrt(AXIAL / (E * I))
right = LATERAL / k**2 * (1 / np.cos(k * LENGTH / 2) - 1)
first = largest_moment(1, False)
found = {members: largest_moment(members, True) for members in (1, 2, 4)}
print(f"theory {right:.2f} kNm, first order {first:.2f} kNm")
for members, moment in found.items():
    print(f"P-Delta with {members} members: {moment:.2f} kNm")
assert abs(first - 20) < 0.01 and abs(right - 40.60) < 0.01
assert abs(found[1] - 26.28) < 0.1
assert abs(found[2] / right - 1) < 0.01 and abs(found[4] / right - 1) < 0.001
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
