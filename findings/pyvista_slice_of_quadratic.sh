#!/usr/bin/env bash
# pyvista 0.49.1, VTK 9.7.2: a slice through a quadratic element has twice the head of a line in the same place.
#
# Expected: `slice`, `clip` and `contour` of a quadratic element use its quadratic field, as `sample_over_line` does.
# Seen: a brick of 20 and a tetrahedron of 10 nodes, 1 m long, with the head x^2, which they have exactly.  At
#     x = 0.25 m the head is 0.0625 m, and on a line within 1e-3.  On a slice and on the cut of a clip it is 0.125 m.
#     The contour of 0.0625 m lies at x = 0.125 m.  No message.
# Meaning: these filters cut each element into linear pieces between its nodes.  A water table, a plastic zone or a
#     contour of settlement is off by up to an eighth of a coarse element, and peaks between nodes are cut, where
#     a line in the same report shows the right ones.  Sample points on the plane, or refine first.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    pyvista==0.49.1 vtk==9.7.2 numpy==2.4.6
cat > run.py <<'PY'
import numpy as np
import pyvista as pv

CORNERS = {
    pv.CellType.QUADRATIC_HEXAHEDRON: [
        (0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)
    ],
    pv.CellType.QUADRATIC_TETRA: [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)],
}
EDGES = {
    8: [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)],
    4: [(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)],
}
PLACE = 0.25  # m
for kind, corners in CORNERS.items():
    corners = np.array(corners, float)
    middles = [(corners[a] + corners[b]) / 2 for a, b in EDGES[len(corners)]]
    points = np.vstack([corners, middles])
    cell = pv.UnstructuredGrid(np.r_[len(points), np.arange(len(points))], [kind], points)
    cell["head"] = points[:, 0] ** 2  # the shape functions have this field exactly
    line = cell.sample_over_line((0, 0.1, 0.1), (0.8, 0.1, 0.1), resolution=8)
    error = float(np.abs(line["head"] - line.points[:, 0] ** 2).max())
    cut = cell.slice(normal="x", origin=(PLACE, 0.1, 0.1))
    clipped = cell.clip(normal="x", origin=(PLACE, 0.1, 0.1))
    face = np.isclose(clipped.points[:, 0], PLACE)
    contour = cell.contour([PLACE**2], scalars="head")
    print(f"{kind.name}: head at x = {PLACE} m is {PLACE**2:.4f} m; line within {error:.0e}; slice "
          f"{cut['head'].min():.4f} to {cut['head'].max():.4f}; clip {clipped['head'][face].max():.4f}; "
          f"contour of this head at x = {contour.points[:, 0].mean():.4f} m")
    assert error < 1e-3
    assert np.allclose(cut["head"], PLACE / 2) and np.allclose(clipped["head"][face], PLACE / 2)
    assert np.allclose(contour.points[:, 0], PLACE / 2)
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
