#!/usr/bin/env bash
# ngsolve 6.2.2608: the discharge through a boundary is zero.
#
# Expected: `Integrate(grad(head) * normal, mesh, BND)` is the flow through the boundary of the
#     mesh, or refused: for the head x**2 on the unit square it is 2.
# Seen: exactly 0 with a head of any order, without a message.  On a boundary `grad` is the gradient
#     along the boundary, which has no normal part.  `BoundaryFromVolumeCF(grad(head))` gives 2, and
#     so does the same head as a formula.
# Meaning: inflow of an excavation, seepage through a dam and heat of an energy pile vanish, in the
#     expression that stands in the textbook.  A sum of zero over all boundaries even passes a check
#     of balance.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    ngsolve==6.2.2608 numpy==2.4.6
cat > run.py <<'PY'
from netgen.geom2d import unit_square
from ngsolve import (
    BND, H1, BoundaryFromVolumeCF, CoefficientFunction, GridFunction, Integrate, Mesh, grad,
    specialcf, x,
)

mesh = Mesh(unit_square.GenerateMesh(maxh=0.3))
normal = specialcf.normal(2)
for order in (2, 3, 4):
    head = GridFunction(H1(mesh, order=order))
    head.Set(x * x)
    flow = Integrate(grad(head) * normal, mesh, BND)
    right = Integrate(BoundaryFromVolumeCF(grad(head)) * normal, mesh, BND)
    formula = Integrate(CoefficientFunction((2 * x, 0)) * normal, mesh, BND)
    print(f"order {order}: grad(head) {flow:.6f}, from the volume {right:.6f}, formula {formula:.6f}")
    assert abs(flow) < 1e-9 and abs(right - 2) < 1e-9 and abs(formula - 2) < 1e-9
PY
OMP_NUM_THREADS=1 NGS_NUM_THREADS=1 venv/bin/python run.py
