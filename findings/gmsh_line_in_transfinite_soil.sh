#!/usr/bin/env bash
# gmsh 4.15.2: an embedded wall is meshed beside the soil, not in it.
#
# Expected: a line that is embedded in a transfinite surface has nodes of the surface's elements, or
#     the two demands are refused.
# Seen: the line has its nine nodes and eight segments, and none of the nodes belongs to a triangle of
#     the soil.  No error and no warning in the log.  Without the transfinite mesh all nine belong to
#     triangles.
# Meaning: a wall, anchor or drain in a structured mesh hangs in the air: a beam on these nodes is a
#     body without supports, and a load or head on them acts on nothing.  Divide the surface along
#     the line, and ask whether the nodes of each group are nodes of the soil.
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


def wall(transfinite):
    """Nodes of a wall that is embedded in a square of soil, those of them in triangles, remarks."""
    gmsh.clear()
    geo, mesh = gmsh.model.geo, gmsh.model.mesh
    corners = [geo.addPoint(x, y, 0) for x, y in ((0, 0), (4, 0), (4, 4), (0, 4))]
    sides = [geo.addLine(corners[i], corners[(i + 1) % 4]) for i in range(4)]
    soil = geo.addPlaneSurface([geo.addCurveLoop(sides)])
    line = geo.addLine(geo.addPoint(1.3, 2.1, 0), geo.addPoint(2.7, 2.1, 0))
    geo.synchronize()
    mesh.embed(1, [line], 2, soil)
    for curve in [*sides, line]:
        mesh.setTransfiniteCurve(curve, 9)
    if transfinite:
        mesh.setTransfiniteSurface(soil)
    gmsh.logger.start()
    mesh.generate(2)
    remarks = [text for text in gmsh.logger.get() if text.startswith(("Warning", "Error"))]
    gmsh.logger.stop()
    nodes = mesh.getNodes(1, line, includeBoundary=True)[0]
    triangles = np.hstack(mesh.getElements(2, soil)[2])
    return len(nodes), int(np.isin(nodes, triangles).sum()), remarks


gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
free, structured = wall(False), wall(True)
gmsh.finalize()
print("nodes of the wall, of them in the soil, remarks:", free, "transfinite:", structured)
assert free == (9, 9, []) and structured == (9, 0, [])
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
