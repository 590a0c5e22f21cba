#!/usr/bin/env bash
# gmsh 4.15.2, ngsolve 6.2.2608: a plane section of second order is read as a surface in space, of no area.
#
# Expected: `ReadGmsh` gives the same plane mesh with the materials "clay" and "sand" and the boundary "base"
#     for elements of first and of second order.
# Seen: a section of 2 m x 2 m of first order has the dimension 2, 4 m2, both materials and 2 m of base.  The
#     same model of second order has the dimension 3, no element, the material "default", clay and sand as
#     boundaries, and no base: `Integrate(1, mesh)` is 0, and `dirichlet="base"` fixes nothing.  A
#     solid of second order keeps all three.  The only message is the same for both orders.
# Meaning: the reader takes every file with element types above 3 for a solid, and the triangle of six nodes
#     has the type 9.  Weights, stiffnesses and loads over the domain are zero, the support is missing,
#     and forms on the boundary work and look right.  Assert `mesh.dim`, the area and the length of the
#     supports after reading.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    gmsh==4.15.2 ngsolve==6.2.2608 numpy==2.4.6
cat > write.py <<'PY'
import gmsh

gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
gmsh.option.setNumber("Mesh.MshFileVersion", 2.2)
gmsh.option.setNumber("Mesh.MeshSizeMax", 0.7)
occ = gmsh.model.occ
for dimension in (2, 3):
    gmsh.clear()
    if dimension == 2:
        parts = [occ.addRectangle(0, level, 0, 2, 1) for level in (0, 1)]
    else:
        parts = [occ.addBox(0, 0, level, 2, 1, 1) for level in (0, 1)]
    occ.fragment([(dimension, parts[0])], [(dimension, parts[1])])
    occ.synchronize()
    for (_, part), (number, name) in zip(gmsh.model.getEntities(dimension), ((20, "clay"), (10, "sand"))):
        gmsh.model.addPhysicalGroup(dimension, [part], number, name=name)
    sides = [tag for _, tag in gmsh.model.getEntities(dimension - 1)]
    base = [tag for tag in sides if occ.getCenterOfMass(dimension - 1, tag)[dimension - 1] < 1e-6]
    gmsh.model.addPhysicalGroup(dimension - 1, base, 5, name="base")
    gmsh.model.mesh.generate(dimension)
    for order in (1, 2):
        gmsh.model.mesh.setOrder(order)
        gmsh.write(f"model{dimension}{order}.msh")
gmsh.finalize()
PY
cat > run.py <<'PY'
import subprocess
import sys

from netgen.read_gmsh import ReadGmsh
from ngsolve import BND, H1, Integrate, Mesh

subprocess.run([sys.executable, "write.py"], check=True)
for dimension in (2, 3):
    for order in (1, 2):
        mesh = Mesh(ReadGmsh(f"model{dimension}{order}.msh"))
        size = Integrate(1, mesh)
        base = Integrate(1, mesh, BND, definedon=mesh.Boundaries("base"))
        fixed = H1(mesh, order=1).GetDofs(mesh.Boundaries("base")).NumSet()
        materials, boundaries = sorted(set(mesh.GetMaterials())), sorted(set(mesh.GetBoundaries()))
        print(f"dimension {dimension}, order {order}: read with dimension {mesh.dim} and {mesh.ne} elements; "
              f"size {size:.3f}, base {base:.3f}, {materials}, {boundaries}, {fixed} nodes of the base")
        if (dimension, order) == (2, 2):
            assert mesh.dim == 3 and mesh.ne == 0 and size == 0 and base == 0 and fixed == 0
            assert materials == ["default"] and boundaries == ["clay", "sand"]
        else:
            assert mesh.dim == dimension and abs(size - 4) < 1e-6 and abs(base - 2) < 1e-6
            assert materials == ["clay", "sand"] and boundaries == ["base"] and fixed > 0
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
