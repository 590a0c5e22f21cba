#!/usr/bin/env bash
# gmsh 4.15.2: the lining of a tunnel keeps its inverted elements, though optimisation is on.
#
# Expected: with Mesh.HighOrderOptimize 1 the second-order elements of a thin lining are repaired,
#     whether the order is given by Mesh.ElementOrder or by `setOrder` after the mesh.
# Seen: a lining of 0.3 m around a tunnel of radius 5 m, elements of 3 m: 8 triangles have a negative
#     Jacobian, as their midside nodes move to the arcs.  With ElementOrder 2 before `generate` and the
#     option 1 there is none.  With `setOrder(2)` after `generate` it is 8 for the options 0, 1 and 2; a
#     line of the log, which is off in most scripts, tells the number.  `optimize("HighOrder")`
#     after `setOrder` leaves none.
# Meaning: `setOrder` is the usual call where one script makes meshes of both orders.  The stiffness
#     of these elements is wrong or infinite, and just where hoop force and moment are read.  Look at
#     the smallest of `getElementQualities(..., "minDetJac")` after every change of the order.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    gmsh==4.15.2 numpy==2.4.6
cat > run.py <<'PY'
import gmsh
import numpy as np

RADIUS, LINING, SIZE = 5.0, 0.3, 3.0
gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)


def inverted(optimise, before=False, afterwards=False):
    """Number of second-order triangles with a negative Jacobian, and warnings of the log."""
    gmsh.clear()
    gmsh.logger.start()
    shapes = [gmsh.model.occ.addDisk(0, 0, 0, r, r) for r in (RADIUS + LINING, RADIUS)]
    soil = gmsh.model.occ.addRectangle(-15, -15, 0, 30, 30)
    gmsh.model.occ.fragment([(2, soil)], [(2, shape) for shape in shapes])
    gmsh.model.occ.synchronize()
    for name, value in {
        "MeshSizeMin": SIZE, "MeshSizeMax": SIZE, "HighOrderOptimize": optimise,
        "ElementOrder": 2 if before else 1,
    }.items():
        gmsh.option.setNumber(f"Mesh.{name}", value)
    gmsh.model.mesh.generate(2)
    if not before:
        gmsh.model.mesh.setOrder(2)
    if afterwards:
        gmsh.model.mesh.optimize("HighOrder")
    warnings = [line for line in gmsh.logger.get() if line.startswith("Warning")]
    gmsh.logger.stop()
    types, elements, _ = gmsh.model.mesh.getElements(2)
    assert list(types) == [9]
    jacobians = np.array(gmsh.model.mesh.getElementQualities(elements[0], "minDetJac"))
    return int((jacobians < 0).sum()), len(jacobians), warnings


for optimise in (0, 1, 2):
    after, number, warnings = inverted(optimise)
    first, _, _ = inverted(optimise, before=True)
    print(f"HighOrderOptimize {optimise}: of {number} triangles {after} are inverted with setOrder, "
          f"{first} with ElementOrder")
    print("   ", *warnings)
    assert after > 0 and (first > 0) == (optimise == 0)
repaired, _, _ = inverted(0, afterwards=True)
print(f'optimize("HighOrder") after setOrder: {repaired}')
assert repaired == 0
gmsh.finalize()
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
