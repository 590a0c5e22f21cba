#!/usr/bin/env bash
# ngsolve 6.2.2608: the head of the tailwater removes the head of the reservoir.
#
# Expected: two calls `head.Set(..., definedon=mesh.Boundaries(...))` for two boundaries give both
#     heads.
# Seen: the second call sets all other values to zero: with 10 m on the left and 4 m on the right,
#     the seepage is solved with 0 m on the left.  It flows from right to left, 4 in place of -6
#     (times the permeability), and no message appears.  One call with `mesh.BoundaryCF({...})` is
#     right.
# Meaning: of several heads, settlements or temperatures only the last is applied.  If its value is
#     zero, as at a drain or a fixed base, the whole solution is zero; otherwise it looks like a
#     result.  Set all values in one call, and print them from the boundaries before solving.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    ngsolve==6.2.2608 numpy==2.4.6
cat > run.py <<'PY'
from netgen.geom2d import unit_square
from ngsolve import H1, BilinearForm, GridFunction, Integrate, Mesh, dx, grad

mesh = Mesh(unit_square.GenerateMesh(maxh=0.3))


def seepage(single):
    """Heads on both sides and the mean gradient along x of flow through a block."""
    space = H1(mesh, order=2, dirichlet="left|right")
    u, v = space.TnT()
    head = GridFunction(space)
    if single:
        head.Set(mesh.BoundaryCF({"left": 10, "right": 4}), definedon=mesh.Boundaries("left|right"))
    else:
        head.Set(10, definedon=mesh.Boundaries("left"))
        head.Set(4, definedon=mesh.Boundaries("right"))
    matrix = BilinearForm(grad(u) * grad(v) * dx).Assemble().mat
    head.vec.data -= matrix.Inverse(space.FreeDofs()) * (matrix * head.vec)
    sides = [Integrate(head, mesh, definedon=mesh.Boundaries(name)) for name in ("left", "right")]
    return sides, Integrate(grad(head)[0], mesh)


for single, left, gradient in ((False, 0, 4), (True, 10, -6)):
    sides, slope = seepage(single)
    print(f"one call {single}: left {sides[0]:.3f} m, right {sides[1]:.3f} m, gradient {slope:.3f}")
    assert abs(sides[0] - left) < 1e-6 and abs(sides[1] - 4) < 1e-6
    assert abs(slope - gradient) < 1e-6
PY
OMP_NUM_THREADS=1 NGS_NUM_THREADS=1 venv/bin/python run.py
