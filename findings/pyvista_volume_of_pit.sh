#!/usr/bin/env bash
# pyvista 0.49.1, VTK 9.7.2: the volume of a pit depends on the height of the ground above the sea.
#
# Expected: `volume` of a surface that is not closed is an error or NaN; or the same number at any
#     datum.
# Seen: a terrain of 100 m x 100 m with a pit of 5 m, whose volume is 1803 m3.  The result is 1803
#     with the ground at 0 m, 97457 at 10 m and 990797 at 100 m, which is neither the pit nor the
#     ground above the datum (98197 and 998197).  A box of 8 m3 without one side has 7.2 m3.  No
#     message.
# Meaning: masses of excavation and fill from a surveyed surface are right at a local datum with the
#     surroundings at zero, and wrong by any factor elsewhere.  Close the surface, and ask
#     `n_open_edges`, or integrate the heights over the triangles.
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


def terrain(datum):
    """Triangles of a flat ground at the height of the datum, with a pit of 5 m in the middle."""
    line = np.linspace(0, 100, 101)
    x, y = np.meshgrid(line, line, indexing="ij")
    pit = (abs(x - 50) < 10) & (abs(y - 50) < 10)
    grid = pyvista.StructuredGrid(x, y, np.where(pit, -5.0, 0.0) + datum)
    return grid.extract_surface(algorithm="dataset_surface").triangulate()


def below(surface, datum):
    """Volume between the surface and a level, from the triangles."""
    corners = surface.points[surface.regular_faces].astype(float)
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    plan = abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) / 2
    return (plan * (datum - corners[:, :, 2].mean(axis=1))).sum()


for datum in (0.0, 10.0, 100.0):
    surface = terrain(datum)
    right = below(surface, datum)
    print(f"ground at {datum} m: volume {surface.volume:.1f}, pit {right:.1f}, "
          f"ground above 0 {-below(surface, 0):.1f} m3")
    assert abs(right - 1803.33) < 0.1 and surface.n_open_edges == 400
    assert abs(surface.volume - right) < 1 if datum == 0 else surface.volume > 40 * right
box = pyvista.Box().triangulate()
opened = box.remove_cells([10, 11])
print(f"box {box.volume:.2f} m3, without one side {opened.volume:.2f} m3")
assert abs(box.volume - 8) < 1e-6 and abs(opened.volume - 7.2) < 0.01
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
