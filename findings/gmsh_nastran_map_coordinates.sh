#!/usr/bin/env bash
# gmsh 4.15.2: a site of 100 m has no width in bulk data of Nastran (.bdf), if it lies in map coordinates.
#
# Expected: the nodes of a mesh that is written and read again stand in the same places to a centimetre, or
#     the larger fields of the format are used where 8 characters are too few.
# Seen: a block of 100 m x 100 m x 20 m at easting 500123 and northing 5412346.  In .unv, .vtk and .msh it stays.
#     In .bdf all nodes have the northing 5410000 ("5.41E+06"), up to 2446 m away, and eastings are right to 0.1 m: the
#     block is a flat sheet with the volume 0.  No message.  Free fields (Mesh.BdfFieldFormat 0) are the same, long
#     fields (2) are right to 5 mm.  At a local origin the default is right to 0.01 mm.
# Meaning: by default a number has 8 characters, and one with an exponent has three digits left.  Distances of less
#     than 10 km do not exist in the northing.  An easting only gets rough (steps of 0.1 m), which spoils thin layers
#     and contacts unseen.  Move the origin to the site, or set the option to 2, and compare volumes.
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

SITE, SIDE, DEPTH = np.array([500123.456, 5412345.678, -12.3456]), 100.0, 20.0
gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
gmsh.option.setNumber("Mesh.MeshSizeMax", 50)


def state():
    """Coordinates of the nodes in the order of their numbers, and volume of the tetrahedra."""
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    points = coordinates.reshape(-1, 3)[np.argsort(tags)]
    volumes = gmsh.model.mesh.getElementQualities(gmsh.model.mesh.getElementsByType(4)[0], "volume")
    return points, np.sum(volumes)


def errors(origin, suffix, fields=1):
    """Largest errors of the coordinates in m after writing and reading, and the volume."""
    gmsh.clear()
    gmsh.option.setNumber("Mesh.BdfFieldFormat", fields)
    gmsh.model.occ.addBox(*origin, SIDE, SIDE, DEPTH)
    gmsh.model.occ.synchronize()
    gmsh.model.mesh.generate(3)
    before, _ = state()
    gmsh.write(f"site.{suffix}")
    gmsh.clear()
    gmsh.open(f"site.{suffix}")
    after, volume = state()
    return np.abs(after - before).max(axis=0), volume


for suffix in ("unv", "vtk", "msh"):
    gap, volume = errors(SITE, suffix)
    print(f".{suffix}: errors {gap} m, volume {volume:.2f} m3")
    assert gap.max() < 1e-5 and abs(volume - SIDE**2 * DEPTH) < 1
assert gmsh.option.getNumber("Mesh.BdfFieldFormat") == 1
gap, volume = errors(SITE, "bdf")
print(f".bdf: errors {gap} m, volume {volume:.2f} m3")
assert 2300 < gap[1] < 2500 and 0.01 < gap[0] < 0.1 and abs(volume) < 1e-3
for fields in (0, 2):
    gap, volume = errors(SITE, "bdf", fields)
    print(f".bdf with fields of kind {fields}: errors {gap} m, volume {volume:.2f} m3")
    assert (2300 < gap[1] < 2500 and abs(volume) < 1e-3) if fields == 0 else gap.max() < 0.006
gap, volume = errors([0, 0, 0], "bdf")
print(f".bdf at a local origin: errors {gap} m, volume {volume:.2f} m3")
assert gap.max() < 0.01 and abs(volume / (SIDE**2 * DEPTH) - 1) < 1e-3
gmsh.finalize()
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
