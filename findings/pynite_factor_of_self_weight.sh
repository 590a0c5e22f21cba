#!/usr/bin/env bash
# PyNiteFEA 3.2.0: twice the self-weight has the same mass.
#
# Expected: the factor of `add_member_self_weight` counts in the mass of `analyze_modal` as it does in the
#     load.
# Seen: a cantilever of steel, 4 m long.  Factor 1: deflection 1.256 mm, 17.49 Hz.  Factor 2: 2.512 mm, and
#     17.49 Hz, where 12.36 Hz is right; factor 0.5: 0.628 mm and 17.49 Hz, where 24.73 Hz is right.  Factor 2
#     on the load case in the combination: 2.512 mm and 12.36 Hz, right.  No message.
# Meaning: a factor for connections, coating or fill in hollow members goes into the forces, and not into
#     periods and earthquake loads.  Raise the density of the material, and compare the frequency of one
#     member by hand.
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


def cantilever(factor, of_case, count=8):
    """Deflection in mm under the self-weight, and first frequency in Hz."""
    model = FEModel3D()
    model.add_material("steel", YOUNG, 8e7, 0.3, WEIGHT / AREA)
    model.add_section("beam", AREA, INERTIA, INERTIA, 1e-4)
    for i in range(count + 1):
        model.add_node(f"N{i}", LENGTH * i / count, 0, 0)
        if i:
            model.add_member(f"M{i}", f"N{i - 1}", f"N{i}", "steel", "beam")
            model.def_support(
                f"N{i}", support_DX=True, support_DZ=True, support_RX=True, support_RY=True
            )
    model.def_support("N0", True, True, True, True, True, True)
    model.add_load_combo("mass", {"dead": of_case})
    model.add_member_self_weight("FY", -factor, "dead")
    model.analyze()
    deflection = -1e3 * model.nodes[f"N{count}"].DY["mass"]
    model.analyze_modal(
        num_modes=1, mass_combo_name="mass", mass_direction="Y", gravity=GRAVITY
    )
    return float(deflection), float(model.frequencies[0])


static = 1e3 * WEIGHT * LENGTH**4 / 8 / YOUNG / INERTIA
first = 1.8751041**2 / 2 / np.pi * np.sqrt(YOUNG * INERTIA * GRAVITY / WEIGHT / LENGTH**4)
for factor, of_case in ((1.0, 1.0), (1.0, 2.0), (2.0, 1.0), (0.5, 1.0)):
    deflection, frequency = cantilever(factor, of_case)
    total = factor * of_case
    right = first / total**0.5
    print(f"factor of the self-weight {factor}, of its case {of_case}: deflection {deflection:.3f} mm "
          f"(right {total * static:.3f}), frequency {frequency:.2f} Hz (right {right:.2f})")
    assert abs(deflection / (total * static) - 1) < 1e-6
    assert abs(frequency / (first / of_case**0.5) - 1) < 1e-3
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
