#!/usr/bin/env bash
# pyvista 0.49.1, VTK 9.7.2: two bodies in contact, put together for a picture, become one.
#
# Expected: `merge` and `+` of two meshes keep both sets of nodes and both displacements on the surface
#     that they share.
# Seen: coincident nodes are joined by default and the first mesh wins: 45 nodes of 54, and the body
#     that slides by 1 m over the other is sheared in its lowest row instead.  Its warped
#     volume is right, so that only the displacements show it.  `merge_points=False` keeps 54.
# Meaning: slip, gaps and jumps of pressure vanish from pictures and from values sampled at the
#     surface, and the deformed row of elements looks like a shear band.
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

lower = pyvista.ImageData(dimensions=(3, 3, 3)).cast_to_unstructured_grid()
upper = lower.copy()
upper.points[:, 2] += 2
lower["u"] = np.zeros((lower.n_points, 3))
upper["u"] = np.tile([1.0, 0.0, 0.0], (upper.n_points, 1))


def slip(mesh):
    """Difference of the displacements u_x on the surface z = 2."""
    u = mesh["u"][np.isclose(mesh.points[:, 2], 2), 0]
    return u.max() - u.min()


for name, mesh in (
    ("merge", pyvista.merge([lower, upper])),
    ("+", lower + upper),
    ("merge_points=False", pyvista.merge([lower, upper], merge_points=False)),
):
    row = mesh.extract_cells(np.isclose(mesh.cell_centers().points[:, 2], 2.5))
    shear = row.compute_derivative("u")["gradient"][:, 2].max()
    volume = mesh.warp_by_vector("u").volume
    print(f"{name}: {mesh.n_points} nodes, slip {slip(mesh):.1f} m, du_x/dz of the lowest row of the "
          f"upper body {shear:.1f}, volume {volume:.1f}")
    assert np.isclose(volume, 16)
    if name == "merge_points=False":
        assert mesh.n_points == 54 and slip(mesh) == 1 and abs(shear) < 1e-6
    else:
        assert mesh.n_points == 45 and slip(mesh) == 0 and np.isclose(shear, 1)
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
