#!/usr/bin/env bash
# gmsh 4.15.2: the fine mesh along a tunnel is a string of beads.
#
# Expected: a size field by the distance from a curve (`Distance`, then `Threshold`) gives the small
#     size all along the curve, as the distance is zero there.
# Seen: along a straight line of 400 m with the size 1 m up to a distance of 2 m, growing to 5 m at 8 m,
#     the steps are from 1.0 to 5.0 m: 222 nodes in place of 401.  The distance is the one from 20
#     points on the curve, the default of `Sampling`, here 21 m apart.  With Sampling=400 all steps
#     are 1.0 m.
# Meaning: long tunnels, dams and sheet-pile walls are refined near the points only, and mostly have
#     the coarse size.  Stresses along them have waves of the period of the points.  Set
#     `Sampling` to the length of the curve over the small size.
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

LENGTH = 400.0


def steps(sampling):
    """Element lengths along the lower side of a strip, refined by the distance from this side."""
    gmsh.clear()
    occ, mesh = gmsh.model.occ, gmsh.model.mesh
    occ.addRectangle(0, 0, 0, LENGTH, 10)
    occ.synchronize()
    (line,) = [c for _, c in gmsh.model.getEntities(1) if abs(occ.getCenterOfMass(1, c)[1]) < 1e-9]
    distance, size = mesh.field.add("Distance"), mesh.field.add("Threshold")
    mesh.field.setNumbers(distance, "CurvesList", [line])
    if sampling:
        mesh.field.setNumber(distance, "Sampling", sampling)
    options = {"InField": distance, "SizeMin": 1, "SizeMax": 5, "DistMin": 2, "DistMax": 8}
    for name, value in options.items():
        mesh.field.setNumber(size, name, value)
    mesh.field.setAsBackgroundMesh(size)
    for name in ("FromPoints", "FromCurvature", "ExtendFromBoundary"):
        gmsh.option.setNumber(f"Mesh.MeshSize{name}", 0)
    mesh.generate(1)
    return np.diff(np.sort(mesh.getNodes(1, line, includeBoundary=True)[1][::3]))


gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
default, dense = steps(None), steps(LENGTH)
gmsh.finalize()
for name, lengths in (("default", default), ("Sampling=400", dense)):
    print(f"{name}: {len(lengths) + 1} nodes, steps from {lengths.min():.3f} to {lengths.max():.3f} m")
assert len(default) < 250 and default.min() < 1.05 and default.max() > 4.9
assert len(dense) == 400 and abs(dense - 1).max() < 1e-6
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
