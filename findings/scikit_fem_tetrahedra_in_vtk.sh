#!/usr/bin/env bash
# scikit-fem 12.0.2, meshio 5.3.5, pyvista 0.49.1, VTK 9.7.2: the unit cube has the volume 0.25.
#
# Expected: a mesh of tetrahedra of the unit cube, saved as .vtu and read by pyvista, has volume 1.
# Seen: 0.25 after one refinement, of first and second order: elements of both orientations are in the
#     mesh (scikit-fem takes the absolute value of the determinant), and VTK adds signed volumes.
#     The integral of a field has the same error, without a message.  Hexahedra give 1.
# Meaning: volumes of excavation, weights and means over a body are wrong in the viewer where the
#     analysis was right.  Swap two nodes of the inverted elements before the export.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    scikit-fem==12.0.2 numpy==2.4.6 scipy==1.17.1 meshio==5.3.5 pyvista==0.49.1 vtk==9.7.2
cat > run.py <<'PY'
import numpy as np
import pyvista
from skfem import MeshHex, MeshTet, MeshTet2

straight = MeshTet().refined(1)
for mesh, right in (
    (straight, False), (MeshTet2.from_mesh(straight), False), (MeshHex().refined(1), True),
):
    mesh.save("cube.vtu")
    grid = pyvista.read("cube.vtu")
    volumes = grid.compute_cell_sizes()["Volume"]
    grid["weight"] = np.full(grid.n_points, 20.0)
    integral = grid.integrate_data()["weight"][0]
    print(type(mesh).__name__, f"volume {grid.volume:.3f} of absolute values {abs(volumes).sum():.3f} "
          f"integral of 20: {integral:.3f} negative {(volumes < 0).sum()} of {grid.n_cells}")
    assert np.isclose(abs(volumes).sum(), 1)
    assert np.isclose(grid.volume, 1 if right else 0.25)
    assert np.isclose(integral, 20) == right
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
