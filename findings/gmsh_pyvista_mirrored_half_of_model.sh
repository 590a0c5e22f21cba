#!/usr/bin/env bash
# gmsh 4.15.2, pyvista 0.49.1, VTK 9.7.2: the mirrored half of a model has the volume -1 m3.
#
# Expected: a mesh that is mirrored at its plane of symmetry (`mesh.affineTransform` in gmsh, `reflect` in pyvista) has
#     its elements renumbered, so that volumes stay positive and outer surfaces point outwards.
# Seen: half a block, 1 m3 of tetrahedra.  After the reflection it has -1 m3 in gmsh, -1 m3 in pyvista, and
#     both halves together have 0 m3.  The weight of the whole block, by its elements, is 0 kN.  The outer surface
#     in pyvista is the same: the enclosed volume is +1 by `volume`, but the normals point inwards in the
#     new half.  Mirrored before it was meshed (`occ.mirror`) the block is right.  No message.
# Meaning: only the coordinates change.  Programs that take the determinant with its sign get negative stiffness, weight
#     and water pressure from the second half, and a sum over both halves may cancel.  Mirror the drawing, not the
#     mesh, or swap two nodes of each element, and check the sum of the volumes of each half.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    gmsh==4.15.2 pyvista==0.49.1 vtk==9.7.2 numpy==2.4.6
cat > run.py <<'PY'
import gmsh
import numpy as np
import pyvista

gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
gmsh.option.setNumber("Mesh.MeshSizeMax", 0.5)


def half(mirror_drawing):
    gmsh.clear()
    body = gmsh.model.occ.addBox(0, 0, 0, 1, 1, 1)
    if mirror_drawing:
        gmsh.model.occ.mirror([(3, body)], 1, 0, 0, 0)
    gmsh.model.occ.synchronize()
    gmsh.model.mesh.generate(3)


def tetrahedra():
    """Coordinates of the nodes of gmsh's mesh, nodes of its tetrahedra, and sum of their volumes."""
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    points = np.zeros((int(max(tags)) + 1, 3))
    points[tags] = coordinates.reshape(-1, 3)
    numbers, nodes = gmsh.model.mesh.getElementsByType(4)
    return points, nodes.reshape(-1, 4).astype(int), gmsh.model.mesh.getElementQualities(numbers, "volume").sum()


def inward(surface, centre):
    """Share of the triangles of a convex surface whose nodes turn inwards."""
    corners = surface.points[surface.regular_faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return (np.einsum("ij,ij->i", normals, corners.mean(axis=1) - centre) < 0).mean()


half(False)
points, nodes, volume = tetrahedra()
gmsh.model.mesh.affineTransform([-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0])
mirrored = tetrahedra()[2]
half(True)
drawn = tetrahedra()[2]
gmsh.finalize()
print(f"gmsh: half {volume:.6f} m3, mirrored mesh {mirrored:.6f} m3, mirrored drawing {drawn:.6f} m3")
assert abs(volume - 1) < 1e-9 and abs(mirrored + 1) < 1e-9 and abs(drawn - 1) < 1e-9

grid = pyvista.UnstructuredGrid({pyvista.CellType.TETRA: nodes}, points)
other = grid.reflect((1, 0, 0))
volumes = [part.compute_cell_sizes()["Volume"].sum() for part in (grid, other)]
skins = [part.extract_surface(algorithm="dataset_surface") for part in (grid, other)]
shares = [inward(skin, centre) for skin, centre in zip(skins, ((0.5, 0.5, 0.5), (-0.5, 0.5, 0.5)))]
print(f"pyvista: half {volumes[0]:.6f} m3, reflected {volumes[1]:.6f} m3, both {sum(volumes):.6f} m3")
print(f"    share of inward triangles of the skin: {shares}; volumes within {[skin.volume for skin in skins]}")
assert np.allclose(volumes, [1, -1])
assert shares == [0, 1]
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
