#!/usr/bin/env bash
# gmsh 4.15.2: a layer that is extruded upwards has triangles turned clockwise, or not, depending on the kernel.
#
# Expected: surfaces in the plane z = 0 have counterclockwise triangles, in both kernels alike, however they were drawn.
# Seen: a line of 1 m extruded by 1 m.  Upwards the area is +1 with `geo` and -1 with `occ`, downwards -1 with
#     `geo` and +1 with `occ`.  A loop of lines that runs clockwise gives -1 in both.
#     No message.
# Meaning: a section whose layers are extruded up and down from one line has negative Jacobians in half of its
#     elements, and the same script in the other kernel has them in the other half: plane programs stop, subtract
#     stiffness and weight, or turn the pressure on a side round.  Compare the signed areas of the layers.
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

gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
gmsh.option.setNumber("Mesh.MeshSizeMax", 0.3)


def areas(kernel, way):
    """Signed areas of the surfaces of a drawing, by the order of the nodes of its triangles."""
    gmsh.clear()
    drawing = getattr(gmsh.model, kernel)
    if way == "clockwise loop":
        corners = [drawing.addPoint(x, y, 0) for x, y in ((0, 0), (0, 1), (1, 1), (1, 0))]
        sides = [drawing.addLine(corners[i - 1], corners[i]) for i in range(4)]
        drawing.addPlaneSurface([drawing.addCurveLoop(sides)])
    else:
        ends = [drawing.addPoint(x, 0, 0) for x in (0, 1)]
        base = drawing.addLine(*ends)
        drawing.extrude([(1, base)], 0, 1 if way == "upwards" else -1, 0)
    drawing.synchronize()
    gmsh.model.mesh.generate(2)
    numbers, points, _ = gmsh.model.mesh.getNodes()
    place = np.zeros((int(max(numbers)) + 1, 2))
    place[numbers.astype(int)] = points.reshape(-1, 3)[:, :2]
    triangles = place[gmsh.model.mesh.getElementsByType(2)[1].astype(int).reshape(-1, 3)]
    a, b = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    return float((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum() / 2)


seen = {}
for way in ("upwards", "downwards", "clockwise loop"):
    for kernel in ("geo", "occ"):
        seen[way, kernel] = round(areas(kernel, way), 9)
        print(f"{way}, {kernel}: area {seen[way, kernel]:+.3f} m2")
gmsh.finalize()
assert seen["upwards", "geo"] == seen["downwards", "occ"] == 1
assert seen["downwards", "geo"] == seen["upwards", "occ"] == -1
assert seen["clockwise loop", "geo"] == seen["clockwise loop", "occ"] == -1
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
