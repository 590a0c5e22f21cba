#!/usr/bin/env bash
# meshio 5.3.5, gmsh 4.15.2: all solids are turned inside out on their way to and from Salome's MED format.
#
# Expected: a mesh of gmsh in MED (.med) is read by meshio as the same mesh in .msh, and the other way round.
# Seen: a cube of 1 m3.  From .msh the volume is +1, from .med it is -1, for tetrahedra and bricks, of first and of
#     second order.  What meshio writes as .med is read by gmsh with a negative Jacobian in every solid, while
#     gmsh reads its own .med file rightly.  No message.
# Meaning: MED numbers a solid the other way round, and meshio passes the numbers on as they are.  Weight
#     acts upwards, stiffness is negative, normals of the sides of solids point inwards; a program that takes
#     the absolute value hides it.  Reverse the base of each solid, or exchange meshes by .msh.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    gmsh==4.15.2 meshio==5.3.5 h5py==3.16.0 numpy==2.4.6
cat > run.py <<'PY'
import gmsh
import meshio
import numpy as np

# Tetrahedra of a cell by its corner nodes in the numbering of VTK and meshio.
PARTS = {
    "tetra": [(0, 1, 2, 3)],
    "hexahedron": [(0, 1, 3, 4), (1, 2, 3, 6), (4, 7, 6, 3), (4, 6, 5, 1), (1, 3, 4, 6)],
}


def volume(mesh):
    """Signed volume by the numbering of meshio."""
    total = 0.0
    for block in mesh.cells:
        for part in PARTS.get(block.type.rstrip("0123456789"), []):
            a, b, c, d = (mesh.points[block.data[:, i]] for i in part)
            total += np.einsum("ij,ij->", np.cross(b - a, c - a), d - a) / 6
    return round(float(total), 9)


def block(order, bricks):
    """Mesh of a cube of 1 m3."""
    gmsh.clear()
    face = gmsh.model.occ.addRectangle(0, 0, 0, 1, 1)
    gmsh.model.occ.extrude([(2, face)], 0, 0, 1, [2] if bricks else [], recombine=bricks)
    gmsh.model.occ.synchronize()
    if bricks:
        for _, line in gmsh.model.getEntities(1):
            gmsh.model.mesh.setTransfiniteCurve(line, 3)
        gmsh.model.mesh.setTransfiniteSurface(face)
        gmsh.model.mesh.setRecombine(2, face)
    gmsh.model.addPhysicalGroup(3, [1], name="soil")
    gmsh.model.mesh.generate(3)
    gmsh.model.mesh.setOrder(order)


def smallest():
    """Smallest Jacobian determinant of the solids in gmsh."""
    _, tags, _ = gmsh.model.mesh.getElements(3)
    return min(float(gmsh.model.mesh.getElementQualities(t, "minDetJac").min()) for t in tags)


gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
gmsh.option.setNumber("Mesh.SecondOrderIncomplete", 1)
for order in (1, 2):
    for bricks in (False, True):
        block(order, bricks)
        name = f"{'bricks' if bricks else 'tetrahedra'} of order {order}"
        found = {}
        for ending in ("msh", "med"):
            gmsh.write(f"soil.{ending}")
            found[ending] = volume(meshio.read(f"soil.{ending}"))
        gmsh.open("soil.med")
        own = smallest()
        mesh = meshio.read("soil.msh")
        solids = [(b.type, b.data) for b in mesh.cells if b.type.startswith(("tetra", "hexa"))]
        meshio.Mesh(mesh.points, solids).write("soil_of_meshio.med")
        gmsh.open("soil_of_meshio.med")
        back = smallest()
        print(f"{name}: volume read by meshio from .msh {found['msh']} m3, from .med {found['med']} m3; "
              f"smallest Jacobian in gmsh: own .med {own:.4f}, .med of meshio {back:.4f}")
        assert found == {"msh": 1.0, "med": -1.0} and own > 0 > back
gmsh.finalize()
PY
OMP_NUM_THREADS=1 venv/bin/python run.py 2>&1
