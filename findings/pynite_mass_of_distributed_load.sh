#!/usr/bin/env bash
# PyNiteFEA 3.2.0: the mass of a distributed load grows with the number of members.
#
# Expected: `analyze_modal` turns a distributed load into its weight over gravity, as it does for loads of nodes.
# Seen: a cantilever of 4 m that carries 0.785 kN/m, by hand 17.49 Hz.  As self-weight of 4 to 64 members
#     17.49 Hz, as loads of nodes 17.00 to 17.48 Hz.  As a distributed load: 16.43 Hz with 4 members, 12.98 with 8,
#     9.14 with 16 and 4.44 with 64.  8 members with lengths in mm: 34.2 Hz.  No message.
# Meaning: the place of the load, in units of length, is used as a share of the member, so that the mass of a member
#     is its load divided by its length.  Periods of frames with floor loads depend on the mesh and on the unit;
#     members of 1 m are right by chance, and refinement makes it worse.  Use loads of nodes or self-weight.
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

YOUNG, INERTIA, AREA, LENGTH, WEIGHT, GRAVITY = 2e8, 1e-4, 1e-2, 4.0, 0.785, 9.81  # kN, m


def frequency(count, kind, unit=1.0):
    """First frequency in Hz of a cantilever of some members; lengths in m times the unit."""
    model = FEModel3D()
    model.add_material("steel", YOUNG / unit**2, 8e7 / unit**2, 0.3, WEIGHT / AREA / unit**3)
    model.add_section("beam", AREA * unit**2, INERTIA * unit**4, INERTIA * unit**4, unit**4)
    for i in range(count + 1):
        model.add_node(f"N{i}", LENGTH * unit * i / count, 0, 0)
        if i:
            model.add_member(f"M{i}", f"N{i - 1}", f"N{i}", "steel", "beam")
            model.def_support(
                f"N{i}", support_DX=True, support_DZ=True, support_RX=True, support_RY=True
            )
    model.def_support("N0", True, True, True, True, True, True)
    model.add_load_combo("mass", {"Case 1": 1.0})
    if kind == "self-weight":
        model.add_member_self_weight("FY", -1.0)
    for i in range(1, count + 1):
        share = WEIGHT * LENGTH / count / (1 if i < count else 2)
        if kind == "loads of nodes":
            model.add_node_load(f"N{i}", "FY", -share)
        elif kind == "distributed load":
            model.add_member_dist_load(f"M{i}", "FY", -WEIGHT / unit, -WEIGHT / unit)
    model.analyze_modal(
        num_modes=1, mass_combo_name="mass", mass_direction="Y", gravity=GRAVITY * unit
    )
    return float(model.frequencies[0])


right = 1.8751041**2 / 2 / np.pi * np.sqrt(YOUNG * INERTIA * GRAVITY / WEIGHT / LENGTH**4)
print(f"by hand {right:.3f} Hz")
for count, seen in ((4, 16.434), (8, 12.984), (16, 9.143), (64, 4.436)):
    kinds = ("self-weight", "loads of nodes", "distributed load")
    weight, nodes, load = [frequency(count, kind) for kind in kinds]
    print(f"{count} members: self-weight {weight:.3f}, loads of nodes {nodes:.3f}, "
          f"distributed load {load:.3f} Hz")
    assert abs(weight / right - 1) < 1e-3 and abs(nodes / right - 1) < 0.5 / count**2 + 1e-4
    assert abs(load / seen - 1) < 1e-3
millimetres = frequency(8, "distributed load", 1e3)
print(f"8 members, lengths in mm: distributed load {millimetres:.3f} Hz")
assert abs(millimetres / 34.205 - 1) < 1e-3
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
