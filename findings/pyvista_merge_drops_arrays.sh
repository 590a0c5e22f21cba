#!/usr/bin/env bash
# pyvista 0.49.1, VTK 9.7.2: the friction angle of the soil is gone when the wall is put beside it.
#
# Expected: `merge` keeps the arrays of both meshes and fills what one of them does not have (with NaN), or says
#     that it drops them.
# Seen: a soil with "friction_angle" and "young", a wall with "thickness" and "young".  The merged mesh has "young"
#     alone; the same with `pv.merge(..., merge_points=False)` and `MultiBlock.combine`.  The head in the joint is 5 m
#     if the wall is merged into the soil, and 1 m the other way round; both stay where points are kept apart.  No
#     message.
# Meaning: only arrays that all meshes have survive, and values of shared points are those of the mesh that comes first.
#     A model that is put together from parts loses the constants of its materials, and the next
#     program takes its defaults.  Add each array to each part first.
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

soil = pv.ImageData(dimensions=(3, 3, 3)).cast_to_unstructured_grid()
wall = soil.translate((2, 0, 0), inplace=False)
for mesh, name, value, head in ((soil, "friction_angle", 30.0, 5.0), (wall, "thickness", 0.8, 1.0)):
    mesh.cell_data[name] = np.full(mesh.n_cells, value)
    mesh.cell_data["young"] = np.full(mesh.n_cells, value)
    mesh["head"] = np.full(mesh.n_points, head)

seen = {}
for name, merged in (
    ("soil.merge(wall)", soil.merge(wall)),
    ("wall.merge(soil)", wall.merge(soil)),
    ("pv.merge, points apart", pv.merge([soil, wall], merge_points=False)),
    ("MultiBlock.combine", pv.MultiBlock([soil, wall]).combine()),
):
    shared = sorted(set(merged["head"][np.isclose(merged.points[:, 0], 2)].tolist()))
    seen[name] = (sorted(merged.cell_data.keys()), shared)
    print(f"{name}: arrays {seen[name][0]} of {merged.n_cells} cells, heads at the joint {shared} m")
assert all(arrays == ["young"] for arrays, _ in seen.values())
assert seen["soil.merge(wall)"][1] == [5.0] and seen["wall.merge(soil)"][1] == [1.0]
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
