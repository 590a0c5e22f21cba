#!/usr/bin/env bash
# pymeshfix 0.18.1: the repair of a block with a pile beside it leaves the pile.
#
# Expected: `repair` closes holes and keeps closed bodies, or keeps the largest one: the block.
# Seen: a block of 500 m3 (12 triangles) and a pile of 7.8 m3 (124 triangles) in one surface.  After
#     `repair()` 124 triangles with 7.8 m3 are left, without a message, and after `clean_from_arrays`
#     with the message that not everything could be fixed.  The part with the most triangles is
#     kept, not the largest one.  With `remove_smallest_components=False` both are left.
# Meaning: a repair before meshing removes the coarse bodies: rock blocks, walls and slabs are the
#     first to go, as they are flat, and what is fine stays.  Count the volume before and after.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    pymeshfix==0.18.1 pyvista==0.49.1 vtk==9.7.2 numpy==2.4.6
cat > run.py <<'PY'
import numpy as np
import pymeshfix
import pyvista

block = pyvista.Cube(x_length=10, y_length=10, z_length=5).triangulate().clean()
pile = pyvista.Cylinder(
    center=(20, 0, 0), direction=(0, 0, 1), radius=0.5, height=10, resolution=32
).triangulate().clean()
points = np.vstack([block.points, pile.points])
faces = np.vstack([block.regular_faces, pile.regular_faces + block.n_points])


def volume(points, faces):
    """Volume in m3 of a closed surface."""
    corners = points[faces].astype(float)
    return abs(np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2]))) / 6


def repaired(**option):
    """Number of triangles and volume after the repair."""
    surface = pymeshfix.MeshFix(points, faces)
    surface.repair(**option)
    return len(surface.faces), volume(surface.points, surface.faces)


parts = len(block.regular_faces), len(pile.regular_faces)
print(f"block and pile: {parts} triangles, {volume(points, faces):.1f} m3")
default, both = repaired(), repaired(remove_smallest_components=False)
cleaned = pymeshfix.clean_from_arrays(points, faces)
print(f"repaired: {default}, all parts kept: {both}, clean_from_arrays {len(cleaned[1])} triangles")
assert default[0] == parts[1] and abs(default[1] - 7.8) < 0.05
assert len(cleaned[1]) == parts[1]
assert both[0] == sum(parts) and abs(both[1] - 507.8) < 0.05
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
