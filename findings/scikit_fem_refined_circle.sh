#!/usr/bin/env bash
# scikit-fem 12.0.2: one uniform refinement of a curved mesh makes the circle 500 times worse.
#
# Expected: `MeshTri2.refined` divides the curved elements, so that the area comes closer to pi, by a
#     factor of about 16, or stays.
# Seen: the area of the unit disk is 3.14144 before and 3.06147 after, which is the area of straight
#     elements with the corners of the mesh before.  The straight mesh of as many elements as the
#     refined one has 3.12145.
# Meaning: a study of convergence of a tunnel or pile by `refined` converges to a polygon with the
#     perimeter and stiffness of the coarse mesh.  Refine the straight mesh first, move its new nodes
#     to the circle, and raise the order last.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    scikit-fem==12.0.2 numpy==2.4.6 scipy==1.17.1
cat > run.py <<'PY'
import numpy as np
from skfem import Basis, ElementTriP1, Functional, MeshTri, MeshTri2


def area(mesh):
    return Functional(lambda w: 1 + 0 * w.x[0]).assemble(Basis(mesh, ElementTriP1()))


curved = MeshTri2.init_circle(2)
refined = curved.refined()
straight = MeshTri.init_circle(3)
for mesh in (curved, refined, straight):
    print(type(mesh).__name__, mesh.nelements, f"area {area(mesh):.6f} error {np.pi - area(mesh):.1e}")
assert abs(area(curved) - np.pi) < 2e-4
assert refined.nelements == straight.nelements == 4 * curved.nelements
assert np.isclose(area(refined), area(MeshTri.init_circle(2)))
assert np.pi - area(refined) > 400 * abs(np.pi - area(curved))
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
