#!/usr/bin/env bash
# felupe 11.3.0: under the same load a rigid plate settles by 2 mm, 13 mm or 11 m, by the unit of the force.
#
# Expected: a `MultiPointConstraint` holds its points to the centre as a rigid plate does, or its penalty follows the
#     stiffness of the body; a model has the same settlement in N, kN and MN.
# Seen: a column of soil of 1 m3, E = 50 MPa, no Poisson's ratio, under 100 kN on the centre of a plate: 2.0 mm is
#     right.  With 2 x 2 x 2 elements the plate settles by 11.1 m in N, 13.4 mm in kN and 2.01 mm in MN, and the soil
#     below it by 2.3, 2.3 and 2.0 mm.  In kN the plate settles by 27.0, 13.4 and 6.2 mm with 1, 2 and 4 elements a
#     side.  With `multiplier` 1e9 in kN it is right to 1e-5.  No message.
# Meaning: the default penalty is the number 1e3 for each point, whatever the units are.  Plates, pile caps and rigid
#     platens of a test are a layer of weak springs, whose stiffness grows with the number of nodes: a
#     convergence study blames the mesh.  Choose the multiplier by the stiffness of the body, and compare the centre
#     with the points.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    felupe==11.3.0 numpy==2.4.6 scipy==1.17.1
cat > run.py <<'PY'
import math

import felupe
import numpy as np

YOUNG, FORCE = 50e6, 100e3  # Pa, N


def settlements(count, unit, **penalty):
    """Settlements in mm of plate and soil, with `count` elements a side and forces in `unit` newtons."""
    mesh = felupe.Cube(n=count + 1)
    top = np.flatnonzero(mesh.points[:, 2] == 1)
    # the centre of the plate is a point without elements
    mesh.update(np.vstack((mesh.points, [0.5, 0.5, 1.0])), mesh.cells)
    centre = mesh.npoints - 1
    mesh.points_without_cells = np.array([], dtype=int)

    field = felupe.FieldContainer([felupe.Field(felupe.RegionHexahedron(mesh), dim=3)])
    soil = felupe.SolidBody(felupe.LinearElastic(E=YOUNG / unit, nu=0.0), field)
    plate = felupe.MultiPointConstraint(field, points=top, centerpoint=centre, **penalty)
    load = felupe.PointLoad(field, [centre], [0.0, 0.0, -FORCE / unit])
    supports = {
        "base": felupe.Boundary(field[0], fz=0, skip=(1, 1, 0)),
        "plate": felupe.Boundary(field[0], mask=np.arange(mesh.npoints) == centre, skip=(0, 0, 1)),
    }
    step = felupe.Step(items=[soil, plate, load], boundaries=supports)
    felupe.Job(steps=[step]).evaluate(verbose=0)
    moved = -1e3 * field[0].values[:, 2]
    return moved[centre], moved[top].mean()


right = 1e3 * FORCE / YOUNG
SEEN = {(2, 1.0): 11113.41, (2, 1e3): 13.372, (2, 1e6): 2.0140, (1, 1e3): 27.0, (4, 1e3): 6.155}
for (count, unit), seen in SEEN.items():
    plate, soil = settlements(count, unit)
    print(f"{count} elements a side, forces in {unit:g} N: plate {plate:.3f}, soil {soil:.3f}, right {right:.3f} mm")
    assert math.isclose(plate, seen, rel_tol=1e-3)
plate, soil = settlements(2, 1e3, multiplier=1e9)
print(f"multiplier 1e9: plate {plate:.5f} mm, soil {soil:.5f} mm")
assert math.isclose(plate, right, rel_tol=1e-4)
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
