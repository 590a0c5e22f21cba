#!/usr/bin/env bash
# gmsh 4.15.2: a clay that belongs to two physical groups is in the file twice.
#
# Expected: a surface may belong to a group "clay" (material) and a group "old_ground" (stage); a file
#     has each of its elements once, or a message says that its format has one group per element.
# Seen: a square of 1 m2 with 162 triangles.  In format 4.1 the file has 162 triangles, in format 2.2
#     it has 324, each one twice, and meshio finds an area of 2 m2.  gmsh itself reads 324 elements
#     into the one surface.  The nodes are the same.  No message.
# Meaning: 2.2 is the format of most programs that read gmsh's files.  The clay has twice its stiffness
#     and twice its weight, so that its stresses and settlements under its own weight look right, and
#     settlements under a load are half.  Compare the area of the mesh with the drawing, or give one
#     group per surface.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    gmsh==4.15.2 meshio==5.3.5 numpy==2.4.6
cat > run.py <<'PY'
import gmsh
import meshio
import numpy as np

gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
gmsh.logger.start()
square = gmsh.model.occ.addRectangle(0, 0, 0, 1, 1)
gmsh.model.occ.synchronize()
for name in ("clay", "old_ground"):
    gmsh.model.addPhysicalGroup(2, [square], name=name)
gmsh.model.mesh.generate(2)
meshed = len(gmsh.model.mesh.getElementsByType(2)[0])
for version in (4.1, 2.2):
    gmsh.option.setNumber("Mesh.MshFileVersion", version)
    gmsh.write(f"ground_{version}.msh")
messages = [line for line in gmsh.logger.get() if line.startswith(("Warning", "Error"))]

seen = {}
for version in (4.1, 2.2):
    mesh = meshio.read(f"ground_{version}.msh")
    triangles = mesh.get_cells_type("triangle")
    a, b, c = (mesh.points[triangles[:, i], :2] for i in range(3))
    u, v = b - a, c - a
    area = float(np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]).sum() / 2)
    different = len(np.unique(np.sort(triangles, axis=1), axis=0))
    gmsh.clear()
    gmsh.open(f"ground_{version}.msh")
    again = len(gmsh.model.mesh.getElementsByType(2)[0])
    print(f"format {version}: {len(triangles)} triangles, {different} different, area {area:.3f} m2; "
          f"gmsh reads {again} of {meshed}")
    seen[version] = (len(triangles) / meshed, different / meshed, round(area, 9), again / meshed)
gmsh.finalize()
print("messages", messages)
assert seen == {4.1: (1, 1, 1.0, 1), 2.2: (2, 1, 2.0, 2)} and not messages
PY
OMP_NUM_THREADS=1 venv/bin/python run.py 2>&1
