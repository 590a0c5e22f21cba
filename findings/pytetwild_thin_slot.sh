#!/usr/bin/env bash
# pytetwild 0.4.2: a slot of 10 cm in a block of 100 m is filled.
#
# Expected: a mesh of tetrahedra of a closed surface keeps its shape, with a slot or a cut, or a
#     message says what was closed.
# Seen: a block of 100 x 40 x 20 m with a slot of 20 m depth in its top, and edges of a tenth of
#     the diagonal.  A slot of 0.5 m stays open.  One of 0.1 m is gone: the two sides are one body, with no
#     free surface inside, and the volume is 80,000 m3 in place of 79,960 m3.  No message.  The surface
#     may move by `epsilon`, a thousandth of the diagonal: 11 cm here.
# Meaning: joints, tension cracks, gaps behind walls and thin linings in a large block of ground are closed
#     before the analysis, and the mesh has good quality.  Set `epsilon` to a part of the thinnest
#     detail, and look for it in the mesh.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    pytetwild==0.4.2 pyvista==0.49.1 vtk==9.7.2 numpy==2.4.6
cat > run.py <<'PY'
import warnings

import numpy as np
import pytetwild
import pyvista

warnings.simplefilter("ignore")


def block(width):
    """Surface of a block with a slot, from its outline in the plane."""
    left, right = 50 - width / 2, 50 + width / 2
    outline = [(0, 0), (left, 0), (right, 0), (100, 0), (100, 20), (100, 40), (right, 40), (right, 20),
               (left, 20), (left, 40), (0, 40), (0, 20)]
    plane = [(0, 1, 8, 11), (1, 2, 7, 8), (2, 3, 4, 7), (11, 8, 9, 10), (7, 4, 5, 6)]
    points = [(x, y, z) for z in (0, 20) for x, y in outline]
    faces = [face[::-1] for face in plane] + [[12 + i for i in face] for face in plane]
    faces += [(i, (i + 1) % 12, 12 + (i + 1) % 12, 12 + i) for i in range(12)]
    cells = np.hstack([[4, *face] for face in faces])
    return pyvista.PolyData(np.array(points, float), cells).triangulate()


def inside(mesh, width):
    """Part of a line across the slot at half its depth that is filled."""
    line = pyvista.Line((50 - 0.4 * width, 30, 10), (50 + 0.4 * width, 30, 10), resolution=50)
    return line.sample(mesh)["vtkValidPointMask"].mean()


for width, filled in ((0.5, 0), (0.1, 1)):
    surface = block(width)
    mesh = pytetwild.tetrahedralize_pv(surface, num_threads=1, edge_length_fac=0.1)
    part = inside(mesh, width)
    print(f"slot {width} m: {mesh.n_cells} tetrahedra, volume {mesh.volume:.0f} m3, "
          f"right {surface.volume:.0f} m3, {100 * part:.0f} % of the slot filled")
    assert abs(part - filled) < 0.05
    assert abs(mesh.volume - (80000 if filled else surface.volume)) < 20
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
