#!/usr/bin/env bash
# PyNiteFEA 3.2.0: in a modal analysis the load on a slab has no mass.
#
# Expected: `analyze_modal` turns the loads of its combination in the given direction into mass, as documented: "any
#     loads applied in this direction", the pressures on quadrilaterals as well, or says that it does not.
# Seen: a slab of 4 m x 4 m with 5 kPa and a machine of 4 kN in the middle.  As loads of nodes: 35.2 Hz.  With the
#     5 kPa as `add_quad_surface_pressure`: 80.6 Hz, the same as without the 5 kPa.  No message.  Only without the
#     machine it stops: "Model is massless".  (The slab alone as loads of nodes: 38.6 Hz, by hand 39.7 Hz.)
# Meaning: as soon as a single member or node has mass, floors, rafts and walls count as massless, their own
#     weight included.  Frequencies of a building are too high by a factor, and its earthquake forces are those of
#     the columns.  Put the weight of plates on the nodes, and compare the total mass.
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

SIDE, COUNT, DEPTH, YOUNG, POISSON, LOAD, GRAVITY = 4.0, 6, 0.2, 3e7, 0.2, 5.0, 9.81  # kN, m


def frequency(kind, machine):
    """First frequency in Hz of a simply supported slab with a machine in the middle."""
    model = FEModel3D()
    model.add_material("concrete", YOUNG, YOUNG / 2 / (1 + POISSON), POISSON, 25.0)
    size = SIDE / COUNT
    model.add_rectangle_mesh("slab", size, SIDE, SIDE, DEPTH, "concrete", element_type="Quad")
    model.meshes["slab"].generate()
    model.add_load_combo("mass", {"dead": 1.0})
    for node in model.nodes.values():
        on_edge = [min(x, SIDE - x) < 1e-6 for x in (node.X, node.Y)]
        model.def_support(node.name, True, True, any(on_edge), support_RZ=True)
        if kind == "loads of nodes":
            model.add_node_load(node.name, "FZ", -LOAD * size**2 / 2 ** sum(on_edge), "dead")
        if machine and np.hypot(node.X - SIDE / 2, node.Y - SIDE / 2) < 1e-6:
            model.add_node_load(node.name, "FZ", -machine, "dead")
    if kind == "pressure":
        for quad in model.quads.values():
            model.add_quad_surface_pressure(quad.name, -LOAD, "dead")
    model.analyze_modal(
        num_modes=1, mass_combo_name="mass", mass_direction="Z", gravity=GRAVITY
    )
    return float(model.frequencies[0])


rigidity = YOUNG * DEPTH**3 / 12 / (1 - POISSON**2)
right = np.pi / SIDE**2 * np.sqrt(rigidity * GRAVITY / LOAD)
print(f"slab alone: by hand {right:.2f} Hz, loads of nodes {frequency('loads of nodes', 0):.2f} Hz")
assert abs(frequency("loads of nodes", 0) / right - 1) < 0.04
seen = {kind: frequency(kind, 4.0) for kind in ("loads of nodes", "pressure", "no load")}
print("slab with a machine of 4 kN:", {key: round(value, 2) for key, value in seen.items()})
assert abs(seen["loads of nodes"] / 35.18 - 1) < 1e-3
assert abs(seen["pressure"] / 80.57 - 1) < 1e-3
assert abs(seen["pressure"] / seen["no load"] - 1) < 1e-9
try:
    frequency("pressure", 0)
except Exception as error:
    print(f"slab alone, pressure: {error}")
else:
    raise AssertionError("the pressure has a mass")
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
