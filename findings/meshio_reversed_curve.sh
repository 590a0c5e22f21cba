#!/usr/bin/env bash
# gmsh 4.15.2, meshio 5.3.5: half of the base of a model loses its support in MSH 4.1.
#
# Expected: a physical group of two curves, one of them given with a minus sign for its direction,
#     has the segments of both after the file is read.
# Seen: in MSH 2.2 the group has ten segments of ten, in MSH 4.1, the default of Gmsh, five: the
#     file has the tag -5 at the reversed curve, and meshio gives these segments the physical tag
#     -5.  With plus signs both formats have ten.  There is no message.
# Meaning: loops of walls and linings are naturally written with signs.  Half of a support, a load
#     or a drain is missing, and the rest has its name.  Compare the length of each group with the
#     drawing.
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


def base_length(sign, version):
    """Length of the group 5, the base of a block of 2 m x 1 m in two curves, after reading."""
    gmsh.clear()
    build = gmsh.model.geo
    places = [(0, 0), (1, 0), (2, 0), (2, 1), (0, 1)]
    points = [build.addPoint(x, y, 0, 0.2) for x, y in places]
    curves = [build.addLine(points[i], points[(i + 1) % 5]) for i in range(5)]
    soil = build.addPlaneSurface([build.addCurveLoop(curves)])
    build.synchronize()
    gmsh.model.addPhysicalGroup(1, [curves[0], sign * curves[1]], 5, "base")
    gmsh.model.addPhysicalGroup(2, [soil], 6, "soil")
    gmsh.model.mesh.generate(2)
    gmsh.option.setNumber("Mesh.MshFileVersion", version)
    gmsh.write("block.msh")
    mesh = meshio.read("block.msh")
    length, tags = 0.0, set()
    for block, physical in zip(mesh.cells, mesh.cell_data["gmsh:physical"]):
        if block.type == "line":
            ends = mesh.points[block.data[physical == 5]]
            length += np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).sum()
            tags |= {int(tag) for tag in physical}
    return length, sorted(tags)


gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
for sign in (1, -1):
    for version in (2.2, 4.1):
        length, tags = base_length(sign, version)
        print(f"sign {sign:+d}, MSH {version}: length {length:.3f} of 2 m, tags of segments {tags}")
        assert abs(length - (1 if (sign, version) == (-1, 4.1) else 2)) < 1e-9
gmsh.finalize()
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
