#!/usr/bin/env bash
# pyvista 0.49.1, VTK 9.7.2: quadratic elements are exact at points and linear in sums.
#
# Expected: a field x**2 + x at the nodes of a second-order element of unit size has the value 0.75 at
#     its centre and the integral 5/6, since VTK evaluates the shape functions of the element.
# Seen: sampling at the centre (0.75) and the gradient at the nodes are exact, but
#     `point_data_to_cell_data` gives 0.9375 for 8 nodes in the plane and 0.95 for 20 nodes, and
#     `integrate_data` gives 0.875 for both, the integral of a field that is linear between nodes.
# Meaning: stresses that are moved from nodes to elements are means of the nodes, 25 % off where the
#     field bends, and the resultant of a pressure or the mean of a displacement has the error of
#     linear elements.  Sample the field at the centres of the cells, and integrate in the program
#     that knows the shape functions.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    pyvista==0.49.1 vtk==9.7.2 numpy==2.4.6
cat > run.py <<'PY'
import numpy as np
import pyvista

square = [[0, 0], [1, 0], [1, 1], [0, 1], [0.5, 0], [1, 0.5], [0.5, 1], [0, 0.5]]
plane = np.c_[np.array(square), np.zeros(8)]
corners = np.array(square[:4])
bottom, top = np.c_[corners, np.zeros(4)], np.c_[corners, np.ones(4)]
edges = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
brick = np.r_[bottom, top]
brick = np.r_[brick, [(brick[a] + brick[b]) / 2 for a, b in edges]]

for kind, nodes, mean in (
    (pyvista.CellType.QUADRATIC_QUAD, plane, 0.9375),
    (pyvista.CellType.QUADRATIC_HEXAHEDRON, brick, 0.95),
):
    mesh = pyvista.UnstructuredGrid(np.array([len(nodes), *range(len(nodes))]), [kind], nodes)
    x = nodes[:, 0]
    mesh["f"] = x**2 + x
    sampled = mesh.cell_centers().sample(mesh)["f"][0]
    gradient = mesh.compute_derivative("f")["gradient"][:, 0]
    moved = mesh.point_data_to_cell_data()["f"][0]
    integral = mesh.integrate_data()["f"][0]
    print(f"{kind.name}: sampled {sampled:.4f}, moved to the cell {moved:.4f} of 0.75; "
          f"integral {integral:.4f} of 0.8333")
    assert np.isclose(sampled, 0.75) and np.allclose(gradient, 2 * x + 1)
    assert np.isclose(moved, mean)
    assert np.isclose(integral, 0.875)
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
