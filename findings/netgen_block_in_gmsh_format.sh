#!/usr/bin/env bash
# netgen-mesher 6.2.2608, gmsh 4.15.2, meshio 5.3.5: two blocks of 1 m3 have the volume -2 m3 in a .msh file.
#
# Expected: `Export(..., "Gmsh2 Format")` writes tetrahedra in the order of this format, so that their volumes
#     are positive, and the names of soils and faces, as `Export(..., "Abaqus Format")` does.
# Seen: all tetrahedra are inverted, of first and of second order: gmsh finds volumes of -2 m3 and a scaled
#     Jacobian of -1, meshio the same corners.  In the Abaqus file of the same mesh the volume is 2 m3.  The
#     soils "clay" and "sand" are the groups 100001 and 100002 without a name, the face "base" is 5.
# Meaning: a program that takes the Jacobian as it is has negative stiffness and weight, one that checks it
#     refuses the mesh, and one that takes its absolute value has inward normals on the
#     faces of these elements.  Swap two corners, and give the soils by their numbers.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    netgen-mesher==6.2.2608 gmsh==4.15.2 meshio==5.3.5 numpy==2.4.6
cat > export.py <<'PY'
import sys

from netgen.occ import Box, Glue, OCCGeometry, Z

order, file, kind = sys.argv[1:]
clay, sand = Box((0, 0, 0), (1, 1, 1)), Box((0, 0, 1), (1, 1, 2))
clay.mat("clay")
sand.mat("sand")
clay.faces.Min(Z).name = "base"
mesh = OCCGeometry(Glue([clay, sand])).GenerateMesh(maxh=0.7)
if order == "2":
    mesh.SecondOrder()
mesh.Export(file, kind)
PY
cat > run.py <<'PY'
import subprocess
import sys

import gmsh
import meshio
import numpy as np


def volume(mesh):
    """Signed volume of all tetrahedra by their corners, as meshio reads them."""
    total = 0.0
    for block in mesh.cells:
        if block.type.startswith("tetra"):
            a, b, c, d = (mesh.points[block.data[:, i]] for i in range(4))
            total += np.linalg.det(np.stack([b - a, c - a, d - a], axis=1)).sum() / 6
    return total


def export(order, file, kind):
    """Mesh of netgen in a file."""
    subprocess.run([sys.executable, "export.py", order, file, kind], check=True, capture_output=True)


gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
for order in "12":
    export(order, "soil.msh", "Gmsh2 Format")
    read = meshio.read("soil.msh")
    gmsh.open("soil.msh")
    tags = np.concatenate(gmsh.model.mesh.getElements(3)[1])
    volumes = gmsh.model.mesh.getElementQualities(tags, "volume")
    jacobians = gmsh.model.mesh.getElementQualities(tags, "minSICN")
    groups = gmsh.model.getPhysicalGroups()
    names = {gmsh.model.getPhysicalName(*group) for group in groups}
    soils = [tag for dimension, tag in groups if dimension == 3]
    print(f"order {order}: volume {volumes.sum():.3f} by gmsh, {volume(read):.3f} by meshio; "
          f"{(jacobians < 0).sum()} of {len(tags)} inverted; groups {soils}, names {names}")
    assert abs(volumes.sum() + 2) < 1e-6 and abs(volume(read) + 2) < 1e-6
    assert np.all(jacobians < 0) and names == {""} and soils == [100001, 100002]
    assert not read.field_data
export("1", "soil.inp", "Abaqus Format")
deck = meshio.read("soil.inp")
print(f"Abaqus: volume {volume(deck):.3f}, sets {sorted(deck.cell_sets)}")
assert abs(volume(deck) - 2) < 1e-6 and {"clay", "sand", "base"} <= set(deck.cell_sets)
gmsh.finalize()
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
