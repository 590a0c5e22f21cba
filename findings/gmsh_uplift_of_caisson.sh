#!/usr/bin/env bash
# gmsh 4.15.2: the water lifts a caisson by 4905 kN if it was drawn as a box, and presses it down if it was extruded.
#
# Expected: the triangles on the surface of a body are turned outwards, however it was drawn, or the signs of
#     `getBoundary(oriented=True)` tell which surfaces are turned inwards.
# Seen: a caisson of 10 m x 10 m x 5 m, its top 2 m below the water.  The pressures on its triangles add up to an uplift
#     of 4905 kN (the weight of the water) for `addBox`.  For a base that is extruded upwards it is -8829 kN, in both
#     kernels: the base has its triangles inwards, and 2 x 6867 kN are missing.  Extruded downwards it is 4905 kN.
#     The signs of the oriented boundary repair it in the built-in kernel only: in the other one they turn the base, and
#     the sides as well (x n_x has the integral -500 m3), and spoil the box (z n_z: -900 m3).
# Meaning: a surface keeps the direction in which it was drawn when it becomes the base of a volume.  Buoyancy,
#     earth pressure and discharge through a named surface have a sign that depends on the way of drawing, and one
#     that is right on all other surfaces.  Check that the integral of x n_x is the volume in each direction,
#     and turn triangles by the fourth node of their tetrahedron.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    gmsh==4.15.2 numpy==2.4.6
cat > run.py <<'PY'
import gmsh
import numpy as np

SIDE, HEIGHT, BASE, WATER = 10.0, 5.0, -7.0, 9.81  # m, level of the base below the water, kN/m3
gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
gmsh.option.setNumber("Mesh.MeshSizeMax", 2.5)


def box():
    gmsh.model.occ.addBox(0, 0, BASE, SIDE, SIDE, HEIGHT)


def extruded(kernel, level, height):
    corners = [kernel.addPoint(x, y, level) for x, y in ((0, 0), (SIDE, 0), (SIDE, SIDE), (0, SIDE))]
    lines = [kernel.addLine(corners[i], corners[(i + 1) % 4]) for i in range(4)]
    surface = kernel.addPlaneSurface([kernel.addCurveLoop(lines)])
    kernel.extrude([(2, surface)], 0, 0, height)


def sums(draw, *arguments):
    """Uplift of the triangles, and integrals of x n_x and z n_z without and with the signs of the boundary."""
    gmsh.clear()
    draw(*arguments)
    gmsh.model.occ.synchronize()
    gmsh.model.geo.synchronize()
    gmsh.model.mesh.generate(3)
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    points = np.zeros((int(max(tags)) + 1, 3))
    points[tags] = coordinates.reshape(-1, 3)
    uplift, plain, signed = 0.0, np.zeros(3), np.zeros(3)
    for _, surface in gmsh.model.getBoundary(gmsh.model.getEntities(3), oriented=True):
        corners = points[gmsh.model.mesh.getElementsByType(2, abs(surface))[1].reshape(-1, 3)]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
        centres = corners.mean(axis=1)
        uplift += (WATER * centres[:, 2] * normals[:, 2]).sum()  # minus pressure times normal
        plain += (centres * normals).sum(axis=0)
        signed += np.sign(surface) * (centres * normals).sum(axis=0)
    return uplift, plain[[0, 2]], signed[[0, 2]]


volume = SIDE**2 * HEIGHT
base = WATER * -BASE * SIDE**2
for name, draw, turned in (
    ("box", (box,), False),
    ("extruded upwards, OpenCASCADE", (extruded, gmsh.model.occ, BASE, HEIGHT), True),
    ("extruded upwards, built-in kernel", (extruded, gmsh.model.geo, BASE, HEIGHT), True),
    ("extruded downwards, OpenCASCADE", (extruded, gmsh.model.occ, BASE + HEIGHT, -HEIGHT), False),
):
    uplift, plain, signed = sums(*draw)
    print(f"{name}: uplift {uplift:.1f} kN; x n_x and z n_z {plain.round(1)}, with signs {signed.round(1)} m3")
    assert abs(plain[0] - volume) < 1e-6
    assert abs(uplift - (WATER * volume - 2 * base * turned)) < 1e-6
    if turned:
        assert np.allclose(signed, [-volume if "OpenCASCADE" in name else volume, volume])
    else:
        assert np.allclose(signed, [volume, volume - 2 * base / WATER])
gmsh.finalize()
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
