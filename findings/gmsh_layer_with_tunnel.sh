#!/usr/bin/env bash
# gmsh 4.15.2: a tunnel is cut into a named layer, and the layer is missing from the mesh.
#
# Expected: after `fragment`, the parts of a layer belong to the physical group of the layer, or
#     the group keeps its surface, or a message says that a group has lost all of its surfaces.
# Seen: three layers of 30 m x 3 m (groups fill, clay, sand), then a tunnel of radius 1 m is cut
#     into the clay by `fragment`.  The groups of fill and sand are as before; the group of the clay
#     is gone.  The mesh has all 270 m2, but the file has 180 m2: neither clay nor tunnel.  meshio
#     still lists a set "clay", which is empty.  The log has no warning.
# Meaning: layers that the cut does not touch keep their number and so their group, the cut ones get
#     new numbers.  As a file holds the elements of groups alone once there is one, the ground has a
#     gap from side to side, and the fill above it is loose, or hangs between its lateral supports.  Give
#     groups after the last cut, and compare the area in the file with the drawing.
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
occ = gmsh.model.occ
layers = [occ.addRectangle(0, -3 * (i + 1), 0, 30, 3) for i in range(3)]
occ.fragment([(2, layers[0])], [(2, layer) for layer in layers[1:]])
occ.synchronize()
for layer, name in zip(layers, ("fill", "clay", "sand")):
    centre = occ.getCenterOfMass(2, layer)
    print(name, "at", np.round(centre, 3))
    gmsh.model.addPhysicalGroup(2, [layer], name=name)
tunnel = occ.addDisk(15, -4.5, 0, 1, 1)
occ.fragment([(2, layer) for layer in layers], [(2, tunnel)])
occ.synchronize()
groups = sorted(gmsh.model.getPhysicalName(*group) for group in gmsh.model.getPhysicalGroups(2))
drawn = sum(occ.getMass(*surface) for surface in gmsh.model.getEntities(2))
gmsh.model.mesh.generate(2)
meshed = len(gmsh.model.mesh.getElementsByType(2)[0])
gmsh.write("ground.msh")
messages = [line for line in gmsh.logger.get() if line.startswith(("Warning", "Error"))]
gmsh.finalize()

mesh = meshio.read("ground.msh")
triangles = mesh.get_cells_type("triangle")
a, b, c = (mesh.points[triangles[:, i], :2] for i in range(3))
u, v = b - a, c - a
area = float(np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]).sum() / 2)
sets = {name: sum(len(part) for part in parts if part is not None) for name, parts in mesh.cell_sets.items()}
print("groups", groups, "sets of meshio", {name: sets[name] for name in ("fill", "clay", "sand")})
print(f"area drawn {drawn:.2f} m2, in the file {area:.2f} m2, {len(triangles)} triangles of {meshed}")
print("messages", messages)
assert groups == ["fill", "sand"] and not messages
assert abs(drawn - 270) < 1e-6 and abs(area - 180) < 1e-6
assert sets["clay"] == 0 and sets["fill"] + sets["sand"] == len(triangles) < meshed
PY
OMP_NUM_THREADS=1 venv/bin/python run.py 2>&1
