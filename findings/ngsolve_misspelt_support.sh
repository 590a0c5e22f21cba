#!/usr/bin/env bash
# ngsolve 6.2.2608: a support whose name is misspelt is left out, and the block is "solved".
#
# Expected: `VectorH1(mesh, dirichlet="left|botom")` is refused, as the mesh has no boundary
#     "botom".
# Seen: no error and no warning.  A block of 1 m under its weight that should rest on its base and a
#     wall hangs on the wall alone: its corner sinks 5.6 mm in place of 0.86 mm.  A pressure on the
#     boundary "tpo" in place of "top" has the resultant 0.
# Meaning: names are regular expressions, and an expression may match nothing.  Where other supports
#     hold the body the settlement looks plausible.  Ask `mesh.Boundaries(name).Mask().NumSet()` for
#     every name before it is used.
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
    BilinearForm, GridFunction, Id, InnerProduct, LinearForm, Mesh, Sym, Trace, VectorH1, ds, dx,
)
from ngsolve import Grad as gradient

mesh = Mesh(unit_square.GenerateMesh(maxh=0.2))
MU, LAME = 1e7 / 2.6, 1e7 * 0.3 / (1.3 * 0.4)


def strain(u):
    """Small strain."""
    return Sym(gradient(u))


def sinking(supports):
    """Downward movement of the upper right corner under the weight, in m."""
    space = VectorH1(mesh, order=2, dirichlet=supports)
    u, v = space.TnT()
    stress = 2 * MU * strain(u) + LAME * Trace(strain(u)) * Id(2)
    stiffness = BilinearForm(InnerProduct(stress, strain(v)) * dx).Assemble()
    weight = LinearForm(-2e4 * v[1] * dx).Assemble()
    moved = GridFunction(space)
    moved.vec.data = stiffness.mat.Inverse(space.FreeDofs()) * weight.vec
    return -moved(mesh(1, 1))[1]


def load(name):
    """Resultant of a unit pressure on a boundary."""
    space = VectorH1(mesh, order=1)
    _, v = space.TnT()
    return sum(LinearForm(v[1] * ds(name)).Assemble().vec)


right, wrong = sinking("left|bottom"), sinking("left|botom")
print(f"base and wall {1000 * right:.3f} mm, misspelt {1000 * wrong:.3f} mm")
assert abs(1000 * right - 0.859) < 0.01 and abs(1000 * wrong - 5.65) < 0.1
found = [mesh.Boundaries(name).Mask().NumSet() for name in ("left", "botom")]
assert found == [1, 0]
print(f"load on the top {load('top'):.3f}, misspelt {load('tpo'):.3f}")
assert abs(load("top") - 1) < 1e-9 and load("tpo") == 0
PY
OMP_NUM_THREADS=1 NGS_NUM_THREADS=1 venv/bin/python run.py
