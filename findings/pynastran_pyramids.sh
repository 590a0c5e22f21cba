#!/usr/bin/env bash
# pyNastran 1.4.1: a block is 22 % heavier if its mesh is one of pyramids, and the mass of a pyramid sits too high.
#
# Expected: mass and centre of gravity of a body do not depend on the elements that fill it.
# Seen: a cube of 1 m3 and 2000 kg of one brick, two wedges or six tetrahedra is right.  Divided into three pyramids
#     with the apex in a corner it has 2449.5 kg.  One pyramid with a base of 1 m2 and a height of 1 m has its centre of
#     gravity in half its height (0.50 m), right is a quarter (0.25 m); upright its volume is right, with the apex
#     over a corner of the base 1.22 times the right one, as the length of the inclined axis is taken as the
#     height.  The same for 13 nodes, and in `mass_properties`.  No message.
# Meaning: pyramids are the elements between bricks and tetrahedra, around piles and tunnels.  Weight, masses for an
#     earthquake and moments of a gravity load are too large in such zones, while a mesh of bricks passes every
#     check.  Compare the sum of the volumes with that of the body.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    pyNastran==1.4.1 numpy==1.26.4 scipy==1.17.1
cat > run.py <<'PY'
import math

import numpy as np
from pyNastran.bdf.bdf import BDF
from pyNastran.bdf.mesh_utils.mass_properties import mass_properties

DENSITY = 2000.0
CUBE = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
# nodes of the elements that fill the cube, with the base of a pyramid first and corner 7 as the apex
FILLINGS = {
    "add_chexa": [(1, 2, 3, 4, 5, 6, 7, 8)],
    "add_cpenta": [(1, 2, 3, 5, 6, 7), (1, 3, 4, 5, 7, 8)],
    "add_ctetra": [(1, 2, 3, 7), (1, 3, 4, 7), (1, 4, 8, 7), (1, 8, 5, 7), (1, 5, 6, 7), (1, 6, 2, 7)],
    "add_cpyram": [(1, 2, 3, 4, 7), (1, 4, 8, 5, 7), (1, 5, 6, 2, 7)],
}


def body(points, add, elements):
    """Mass and centre of gravity of a body."""
    model = BDF(debug=None)
    model.add_mat1(1, 20e6, None, 0.3, rho=DENSITY)
    model.add_psolid(1, 1)
    for number, point in enumerate(points, 1):
        model.add_grid(number, point)
    for number, nodes in enumerate(elements, 1):
        getattr(model, add)(number, 1, list(nodes))
    model.cross_reference()
    return mass_properties(model)[:2]


for add, elements in FILLINGS.items():
    mass, centre = body(CUBE, add, elements)
    print(f"cube by {add}: {mass:.1f} kg, right {DENSITY:.1f} kg; centre {np.round(centre, 3)}")
    if add == "add_cpyram":
        # the inclined axis of each pyramid over its height
        assert math.isclose(mass, DENSITY * math.sqrt(1.5), rel_tol=1e-9)
    else:
        assert math.isclose(mass, DENSITY, rel_tol=1e-9) and np.allclose(centre, 0.5, atol=1e-9)

base = np.array(CUBE[:4], dtype=float)
for apex, ratio in (((0.5, 0.5, 1.0), 1.0), ((1.0, 1.0, 1.0), math.sqrt(1.5))):
    points = [*base, np.array(apex)]
    # the second order: four nodes on the base, four on the edges to the apex
    middles = [(base[i] + base[(i + 1) % 4]) / 2 for i in range(4)] + [(corner + points[4]) / 2 for corner in base]
    for nodes in (points, [*points, *middles]):
        mass, centre = body(nodes, "add_cpyram", [range(1, len(nodes) + 1)])
        print(f"pyramid of {len(nodes)} nodes, apex {apex}: {mass:.1f} kg, right {DENSITY / 3:.1f} kg; height of its "
              f"centre {centre[2]:.3f} m, right 0.250 m")
        assert math.isclose(mass, ratio * DENSITY / 3, rel_tol=1e-9) and math.isclose(centre[2], 0.5, rel_tol=1e-9)
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
