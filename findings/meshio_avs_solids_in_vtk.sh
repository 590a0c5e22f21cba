#!/usr/bin/env bash
# meshio 5.3.5, VTK 9.7.2: bricks, wedges and tetrahedra are turned inside out in AVS UCD, pyramids are not.
#
# Expected: a mesh that meshio writes as AVS UCD (.inp) has the same volumes when it is read by VTK, as by meshio.
# Seen: a brick of 1 m3, a wedge of 1/2, a tetrahedron of 1/6 and a pyramid of 1/3 m3.  Read by meshio they are as they
#     were.  Read by `vtkAVSucdReader` they are -1, -1/2, -1/6 and +1/3 m3.  No message.
# Meaning: meshio renumbers the nodes for the file and again when it reads, VTK takes them as they are; a round trip in
#     one program shows nothing.  Bricks with pyramids at the transition to a fine mesh have volumes of
#     both signs, so that a weight of soil is neither right nor just negative.  Check volumes, and use .vtu.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    meshio==5.3.5 pyvista==0.49.1 vtk==9.7.2 numpy==2.4.6
cat > run.py <<'PY'
import meshio
import numpy as np
import pyvista
import vtk

CORNERS = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)], float)


def volume(grid):
    return grid.compute_cell_sizes()["Volume"][0]


for kind, nodes, right, sign in (
    ("hexahedron", [0, 1, 2, 3, 4, 5, 6, 7], 1, -1),
    ("wedge", [0, 1, 3, 4, 5, 7], 1 / 2, -1),
    ("tetra", [0, 1, 3, 4], 1 / 6, -1),
    ("pyramid", [0, 1, 2, 3, 4], 1 / 3, 1),
):
    mesh = meshio.Mesh(CORNERS, [(kind, [nodes])])
    mesh.write("soil.inp", file_format="avsucd")
    again = meshio.read("soil.inp", file_format="avsucd")
    reader = vtk.vtkAVSucdReader()
    reader.SetFileName("soil.inp")
    reader.Update()
    found = volume(pyvista.wrap(reader.GetOutput()))
    written, returned = volume(pyvista.from_meshio(mesh)), volume(pyvista.from_meshio(again))
    print(f"{kind}: {written:.4f} m3, read by meshio {returned:.4f} m3, read by VTK {found:.4f} m3")
    assert abs(written - right) < 1e-6 and abs(returned - right) < 1e-6
    assert abs(found - sign * right) < 1e-6
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
