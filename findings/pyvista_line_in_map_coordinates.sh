#!/usr/bin/env bash
# pyvista 0.49.1, VTK 9.7.2: a sampled line lies 5 cm away in map coordinates.
#
# Expected: `sample_over_line` on a mesh in double precision is right to a millimetre anywhere.
# Seen: with the origin at easting 500000, northing 5800000 the line is in single precision: its
#     points are at 0.50 m in place of 0.55 m, and the steps along it are multiples of 1/32 m.
#     The values are those of the moved points, all are marked valid, and the distances along the
#     line are 0.052, 0.117, ... in place of 0, 0.099, ...  `slice`, `contour` and
#     `sample` of points in double precision are right.
# Meaning: pore pressures and settlements along a line differ by the gradient times centimetres between
#     a mesh in local and one in map coordinates, and a line close to a wall may change its side.
#     Shift the mesh to a local origin first, or sample points that you make in double precision.
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

for origin in (np.zeros(3), np.array([500000.0, 5800000.0, 0.0])):
    mesh = pyvista.ImageData(dimensions=(101, 11, 11), spacing=(0.1, 0.1, 0.1))
    mesh = mesh.cast_to_unstructured_grid()
    mesh.points = mesh.points.astype(float) + origin
    mesh["y"] = mesh.points[:, 1] - origin[1]
    start, end = origin + [0.05, 0.55, 0.5], origin + [9.95, 0.55, 0.5]
    line = mesh.sample_over_line(start, end, resolution=100)
    points = pyvista.PolyData(np.linspace(start, end, 101)).sample(mesh)
    cut = mesh.slice(normal="y", origin=start)
    errors = [abs(found["y"] - 0.55).max() for found in (line, points, cut)]
    print(f"origin {origin}: line {line.points.dtype} error {errors[0]:.3f} m, points {errors[1]:.1e}, "
          f"slice {errors[2]:.1e}; distances {line['Distance'][:3]}")
    assert line["vtkValidPointMask"].all()
    assert errors[1] < 1e-6 and errors[2] < 1e-6
    assert line.points.dtype == np.float32
    if origin.any():
        assert errors[0] > 0.04 and line["Distance"][0] > 0.04
    else:
        assert errors[0] < 1e-6
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
