#!/usr/bin/env bash
# mmgpy 0.17.1: a rod of 5 cm radius loses five sixths of its section in metres, none in cm.
#
# Expected: `remesh` keeps the border of two materials to a share of the element size or of the model, so
#     that a model in metres and the same one in centimetres have the same mesh.
# Seen: a rod in soil of 0.5 m x 0.5 m, meshed with 64 sides, has 78.4 cm2.  After `remesh` without options it
#     has 12 cm2 in metres, with hmax=0.1 it has 26 cm2.  In centimetres it keeps 78.4 cm2.  The meshes have
#     73, 81 and 1016 triangles.  With hausd=1e-4 the rod in metres has 78.4 cm2.  No message.
# Meaning: the default of the distance by which a curved border may move, 0.01, is a length in the unit of
#     the mesh.  Axial stiffness and perimeter of piles, anchors, drains and pipes are wrong by tens of
#     per cent, by a mesh that looks fine.  Set hausd from the smallest radius, and compare the areas.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    mmgpy==0.17.1 gmsh==4.15.2 numpy==2.4.6
cat > run.py <<'PY'
import gmsh
import mmgpy
import numpy as np

gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
RADIUS, WIDTH = 0.05, 0.5  # m
SOIL, ROD = 1, 2


def start(unit):
    """Mesh of rod and soil, with coordinates in a unit in m."""
    gmsh.clear()
    occ, middle = gmsh.model.occ, WIDTH / 2 / unit
    rod = occ.addDisk(middle, middle, 0, RADIUS / unit, RADIUS / unit)
    soil = occ.addRectangle(0, 0, 0, WIDTH / unit, WIDTH / unit)
    _, parts = occ.fragment([(2, rod)], [(2, soil)])
    occ.synchronize()
    gmsh.option.setNumber("Mesh.MeshSizeMax", 0.02 / unit)
    gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", 64)
    gmsh.model.mesh.generate(2)
    nodes, places, _ = gmsh.model.mesh.getNodes()
    number = np.zeros(int(nodes.max()) + 1, dtype=np.int32)
    number[nodes.astype(int)] = np.arange(len(nodes))
    triangles, materials = [], []
    for _, surface in gmsh.model.getEntities(2):
        found = gmsh.model.mesh.getElements(2, surface)[2][0].astype(int).reshape(-1, 3)
        triangles.append(number[found])
        materials += [ROD if (2, surface) in parts[0] else SOIL] * len(found)
    mesh, triangles = mmgpy.MmgMesh2D(), np.vstack(triangles)
    mesh.set_mesh_size(vertices=len(nodes), triangles=len(triangles))
    mesh.set_vertices(np.ascontiguousarray(places.reshape(-1, 3)[:, :2]))
    mesh.set_triangles(triangles, np.array(materials, dtype=np.int64))
    return mesh


def section(mesh, unit):
    """Area of the rod in cm2, and number of triangles."""
    triangles, materials = mesh.get_triangles_with_refs()
    a, b, c = (mesh.get_vertices()[triangles[:, i]] * unit for i in range(3))
    (x, y), (u, v) = (b - a).T, (c - a).T
    return 1e4 * ((x * v - y * u) / 2)[materials == ROD].sum(), len(triangles)


CASES = {"default": {}, "hmax 0.1 m": {"hmax": 0.1}, "hausd 0.1 mm": {"hausd": 1e-4}}
for name, unit in (("m", 1.0), ("cm", 0.01)):
    before, _ = section(start(unit), unit)
    assert abs(before - 78.4) < 0.2
    for case, lengths in CASES.items():
        mesh = start(unit)
        mesh.remesh(verbose=-1, **{key: value / unit for key, value in lengths.items()})
        area, number = section(mesh, unit)
        print(f"{name}, {case}: {before:.1f} cm2 before, {area:.1f} cm2 after, {number} triangles")
        if unit == 1.0 and "hausd" not in lengths:
            assert area < 55 and number < 200
        else:
            assert abs(area - 78.5) < 1 and number > 400
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
