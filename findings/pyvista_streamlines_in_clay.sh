#!/usr/bin/env bash
# pyvista 0.49.1, VTK 9.7.2: there are no flow paths in clay.
#
# Expected: the streamlines of a field depend on its direction alone: a uniform flow through a block
#     has the same line at 1e-6 m/s and at 5e-13 m/s.
# Seen: a line of 6.9 m in a block of 10 m at 1e-6, 1e-10 and 2e-12 m/s, and no line at all at 5e-13
#     m/s (permeability 5e-11 m/s, gradient 0.01), without a message.  The default `terminal_speed`
#     of 1e-12 is in the unit of the field.  In m/day the line is there.
# Meaning: clays, liners, cut-off walls and the calm parts behind them look like places without
#     flow, and paths that meet them end early, which changes travel times.  Give
#     `terminal_speed=0`, or divide the field by its largest value.
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


def length(velocity, **options):
    """Length of the streamline through the middle of a block of 10 m in a uniform flow."""
    block = pyvista.ImageData(dimensions=(11, 11, 11))
    block["flow"] = np.tile([velocity, 0, 0], (block.n_points, 1))
    start = pyvista.PolyData([[5.0, 5.0, 5.0]])
    lines = block.streamlines_from_source(start, vectors="flow", **options)
    return np.ptp(lines.points[:, 0]) if lines.n_lines else 0.0


for velocity in (1e-6, 1e-10, 2e-12):
    print(f"{velocity:g} m/s: {length(velocity):.2f} m")
    assert abs(length(velocity) - 6.93) < 0.1
clay = length(5e-13), length(5e-13, terminal_speed=0), length(5e-13 * 86400)
print(f"5e-13 m/s: {clay[0]:.2f} m; terminal_speed=0 {clay[1]:.2f} m; in m/day {clay[2]:.2f} m")
assert clay[0] == 0 and min(clay[1:]) > 6.8
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
