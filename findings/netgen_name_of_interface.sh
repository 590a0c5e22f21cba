#!/usr/bin/env bash
# netgen-mesher 6.2.2608: the order of two layers decides which name their interface has.
#
# Expected: where a lower layer names its top "drain" and an upper layer its base "membrane", the common
#     face after `Glue` has both names, or a message says that one of them is dropped.
# Seen: it has the name of the layer that comes first in the list, and the other is gone from the
#     mesh.  A name that only one layer gives is kept in either order.  With the two as a sum the
#     common face has gone, and so have the names of both materials: the one region is "default".  No
#     message.
# Meaning: with ngsolve a condition on a name that does not exist is left out without an error, so
#     that drain, membrane or joint vanish when someone sorts the layers by depth.  Name faces after
#     `Glue`, and look up every name in `mesh.GetBoundaries()`.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    ngsolve==6.2.2608 numpy==2.4.6
cat > run.py <<'PY'
import ngsolve
from netgen.occ import Box, Glue, OCCGeometry, Pnt, Z


def layers(drain, membrane):
    """Two layers of 1 m with names of their common face."""
    lower, upper = Box(Pnt(0, 0, -2), Pnt(1, 1, -1)), Box(Pnt(0, 0, -1), Pnt(1, 1, 0))
    lower.mat("sand")
    upper.mat("clay")
    if drain:
        lower.faces.Max(Z).name = "drain"
    if membrane:
        upper.faces.Min(Z).name = "membrane"
    return lower, upper


def names(shape):
    """Materials and named boundaries of the mesh, with the area of each."""
    mesh = ngsolve.Mesh(OCCGeometry(shape).GenerateMesh(maxh=0.5))
    found = {
        name: round(ngsolve.Integrate(ngsolve.CF(1), mesh, definedon=mesh.Boundaries(name)), 6)
        for name in set(mesh.GetBoundaries()) - {"default"}
    }
    return sorted(mesh.GetMaterials()), found


seen = {}
for drain, membrane in ((True, True), (True, False), (False, True)):
    lower, upper = layers(drain, membrane)
    seen[drain, membrane] = names(Glue([lower, upper])), names(Glue([upper, lower]))
    print(f"named: drain {drain}, membrane {membrane}; lower first {seen[drain, membrane][0]}, "
          f"upper first {seen[drain, membrane][1]}")
lower, upper = layers(True, True)
print("sum", names(lower + upper))
both = ["clay", "sand"]
assert seen[True, True] == ((both, {"drain": 1.0}), (both, {"membrane": 1.0}))
assert seen[True, False] == ((both, {"drain": 1.0}),) * 2
assert seen[False, True] == ((both, {"membrane": 1.0}),) * 2
assert names(lower + upper) == (["default"], {})
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
