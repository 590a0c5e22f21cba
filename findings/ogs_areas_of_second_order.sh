#!/usr/bin/env bash
# ogs 6.5.9: a load of 10 kN on a surface of second order becomes 20 kN.
#
# Expected: `ComputeNodeAreasFromSurfaceMesh` divides the area of a surface among its nodes, so that the areas
#     add up to it, with a consistent or an equal share for the midside nodes; `createNeumannBc` does the
#     same with a flux or a pressure, or both refuse elements of second order.
# Seen: for a triangle of three nodes and 0.5 m2 and a quadrilateral of four nodes and 1 m2 the sums are 0.5
#     and 1 m2.  For those of six and eight nodes every node has the share of a corner, 1/6 and 1/4 m2, and the
#     sums are 1 and 2 m2.  10 kPa on 1 m2 are 20 kN on the nodes.  No message.
# Meaning: the program's meshes for coupled problems of soil and water are of second order, by
#     `createQuadraticMesh`.  Loads, recharge and inflow per node are doubled, and right in a first check
#     with linear elements.  Compare the sum with the area.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    ogs==6.5.9 meshio==5.3.5 numpy==2.4.6
cat > run.py <<'PY'
import subprocess

import meshio
import numpy as np

PRESSURE = 10.0
TRIANGLE = [(0, 0), (1, 0), (0, 1), (0.5, 0), (0.5, 0.5), (0, 0.5)]
SQUARE = [(0, 0), (1, 0), (1, 1), (0, 1), (0.5, 0), (1, 0.5), (0.5, 1), (0, 0.5)]
SURFACES = {
    "triangle": (TRIANGLE[:3], 0.5, 0.5),
    "triangle6": (TRIANGLE, 0.5, 1.0),
    "quad": (SQUARE[:4], 1.0, 1.0),
    "quad8": (SQUARE, 1.0, 2.0),
}


def run(tool, *arguments):
    """Run a tool of OpenGeoSys, which must not complain."""
    done = subprocess.run(
        [f"venv/bin/{tool}", *arguments], check=True, capture_output=True, text=True
    )
    assert "error" not in done.stdout + done.stderr


for kind, (places, area, seen) in SURFACES.items():
    number = len(places)
    points = np.column_stack([places, np.zeros(number)])
    mesh = meshio.Mesh(
        points, [(kind, [list(range(number))])],
        point_data={"bulk_node_ids": np.arange(number, dtype=np.uint64)},
        cell_data={"pressure": [np.array([PRESSURE])]},
    )
    mesh.write(f"{kind}.vtu")
    run("ComputeNodeAreasFromSurfaceMesh", "-i", f"{kind}.vtu", "-p", kind)
    areas = np.loadtxt(f"{kind}.txt")[:, 1]
    run("createNeumannBc", "-i", f"{kind}.vtu", "-o", "load.vtu", "-p", "pressure",
        "--property-out-name", "load")
    loads = meshio.read("load.vtu").point_data["load"]
    print(f"{kind}: area {area} m2, sum over the nodes {areas.sum():.3f} m2; "
          f"load {PRESSURE * area:.1f} kN, sum over the nodes {loads.sum():.1f} kN")
    print("    areas of the nodes", areas.round(4))
    assert abs(areas.sum() - seen) < 1e-9 and abs(loads.sum() - PRESSURE * seen) < 1e-9
    assert np.allclose(areas, areas[0])
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
