#!/usr/bin/env bash
# netgen-mesher 6.2.2608, meshio 5.3.5: the supports of a section are not in the .msh file.
#
# Expected: `Export(..., "Gmsh2 Format")` writes the boundary of a plane mesh, as it does for a solid, with
#     the edges "base", "sides", "load" and "joint" as groups.
# Seen: a section of 2 m x 1 m of two soils has its triangles with the groups 1 and 2 in the file, of first
#     and second order, and no line at all.  The mesh has 14 edges with these names; the file of a solid has
#     the triangles of its faces.  The log says "Surface Mesh".
# Meaning: a reader that fixes what it finds in the group "base" finds nothing: the model has no support,
#     or a load of zero.  An interface for a wall or a joint is missing, too.  Count the lines of the
#     file, and find the edges of the base by their coordinates.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    netgen-mesher==6.2.2608 meshio==5.3.5 numpy==2.4.6
cat > run.py <<'PY'
import meshio
from netgen.occ import Box, Glue, MoveTo, OCCGeometry, Rectangle

section = Glue([Rectangle(1, 1).Face(), MoveTo(1, 0).Rectangle(1, 1).Face()])
for face, name in zip(section.faces, ("clay", "sand")):
    face.name = name
for edge in section.edges:
    middle = edge.center
    if middle.y < 1e-6:
        edge.name = "base"
    elif middle.y > 1 - 1e-6:
        edge.name = "load"
    else:
        edge.name = "joint" if abs(middle.x - 1) < 1e-6 else "sides"
mesh = OCCGeometry(section, dim=2).GenerateMesh(maxh=0.5)
for order in (1, 2):
    if order == 2:
        mesh.SecondOrder()
    edges = len(mesh.Elements1D())
    mesh.Export("section.msh", "Gmsh2 Format")
    read = meshio.read("section.msh")
    names = sorted({mesh.GetBCName(edge.index - 1) for edge in mesh.Elements1D()})
    blocks = {block.type: len(block.data) for block in read.cells}
    print(f"order {order}: mesh with {edges} edges named {names}; in the file {blocks}, {read.field_data}")
    assert edges > 10 and {"base", "load", "sides", "joint"} <= set(names)
    assert set(blocks) == {"triangle" if order == 1 else "triangle6"} and not read.field_data

solid = OCCGeometry(Box((0, 0, 0), (1, 1, 1))).GenerateMesh(maxh=0.7)
solid.Export("solid.msh", "Gmsh2 Format")
blocks = {block.type: len(block.data) for block in meshio.read("solid.msh").cells}
print(f"solid: {blocks}")
assert blocks["triangle"] == len(solid.Elements2D()) and blocks["tetra"] > 0
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
