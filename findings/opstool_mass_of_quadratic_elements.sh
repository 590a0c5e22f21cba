#!/usr/bin/env bash
# opstool 1.0.26: quadratic elements have 40 or 50 % of their mass and weight.
#
# Expected: `ModelMass` adds "mass from tetrahedral or hexahedral elements" and from "a planar element"; with midside
#     nodes the total mass is still density times volume, whichever nodes it goes to.
# Seen: a cube of 2 m of 2 t/m3: 16 t as a brick of 8 nodes and 6.4 t as one of 20; a tetrahedron of 10 nodes has 0.4,
#     a quadrilateral of 8 or 9 nodes 0.5 or 0.44 and a triangle of 6 nodes 0.5 of its mass.
#     `total_mass` reports the smaller mass too, and `generate_ops_gravity_load` loads the ground with 62.8 kN in place
#     of 157.0 kN.  No message.
# Meaning: the mass is divided by the number of all nodes and given to the corners alone.  Initial stresses and
#     settlements by weight of ground made of quadratic elements are 2 to 2.5 times too small, periods 1.4 to 1.6
#     times.  Compare `total_mass` with a hand calculation, or multiply the density by nodes over corners.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    openseespy==3.7.1.2 numpy==2.4.6 scipy==1.17.1 xarray==2026.7.0 gmsh==4.15.2 pyvista==0.49.1 plotly==7.1.0 \
    rich==15.0.0 shapely==2.2.0 sectionproperties==3.10.2 tqdm==4.70.1
# Without its parts for pages and videos.
venv/bin/pip install --quiet --no-compile --disable-pip-version-check --no-deps opstool==1.0.26
cat > run.py <<'PY'
import numpy as np
import openseespy.opensees as ops
from opstool.pre import ModelMass

SIDE, DENSITY, GRAVITY = 2.0, 2.0, 9.81  # m, t/m3, m/s2
CORNERS = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)], float)
RING = [(i, (i + 1) % 4) for i in range(4)]
EDGES = RING + [(4 + i, 4 + j) for i, j in RING] + [(i, 4 + i) for i in range(4)]
TETRAHEDRON = CORNERS[[0, 1, 3, 4]]
TET_EDGES = [(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)]


def with_middles(points, edges):
    """Corner points followed by the middles of edges, in m."""
    return SIDE * np.vstack([points, [(points[i] + points[j]) / 2 for i, j in edges]])


def model(points, *element):
    """A model of one element; its tag is 1."""
    ops.wipe()
    ops.model("basic", "-ndm", 3, "-ndf", 3)
    ops.nDMaterial("ElasticIsotropic", 1, 5e4, 0.3)
    for number, point in enumerate(points, 1):
        ops.node(number, *map(float, point))
        ops.fix(number, int(number > 1), 1, 1)  # one freedom, since an analysis needs one
    name, *rest = element
    ops.element(name, 1, *range(1, len(points) + 1), *rest)


def weight():
    """Sum of the vertical reactions in kN, by a static analysis with nearly all freedoms fixed."""
    ops.constraints("Plain")
    ops.numberer("Plain")
    ops.system("FullGeneral")
    ops.algorithm("Linear")
    ops.integrator("LoadControl", 1.0)
    ops.analysis("Static")
    ops.analyze(1)
    ops.reactions()
    return sum(ops.nodeReaction(node, 3) for node in ops.getNodeTags())


for name, points, element, volume, share in (
    ("brick of 8", SIDE * CORNERS, ("stdBrick", 1), 1.0, 1.0),
    ("brick of 20", with_middles(CORNERS, EDGES), ("20NodeBrick", 1, 0.0, 0.0, 0.0), 1.0, 0.4),
    ("tetrahedron of 4", SIDE * TETRAHEDRON, ("FourNodeTetrahedron", 1), 1 / 6, 1.0),
    ("tetrahedron of 10", with_middles(TETRAHEDRON, TET_EDGES), ("TenNodeTetrahedron", 1), 1 / 6, 0.4),
):
    model(points, *element)
    mass = ModelMass()
    mass.add_mass_from_solid(1, DENSITY)
    right = DENSITY * volume * SIDE**3
    ops.timeSeries("Linear", 1)
    ops.pattern("Plain", 1, 1)
    mass.generate_ops_gravity_load("Z", -GRAVITY)
    print(f"{name} nodes: {mass.total_mass:.3f} t, right {right:.3f} t; weight {weight():.1f} kN")
    assert np.isclose(mass.total_mass / right, share)

square, sides = CORNERS[:4, :2], RING
triangle, corners = TETRAHEDRON[:3, :2], TET_EDGES[:3]
for name, points, volume, share in (
    ("quad", SIDE * square, 1.0, 1.0),
    ("quad8n", with_middles(square, sides), 1.0, 1 / 2),
    ("quad9n", np.vstack([with_middles(square, sides), [SIDE / 2, SIDE / 2]]), 1.0, 4 / 9),
    ("tri31", SIDE * triangle, 0.5, 1.0),
    ("tri6n", with_middles(triangle, corners), 0.5, 1 / 2),
):
    ops.wipe()
    ops.model("basic", "-ndm", 2, "-ndf", 2)
    ops.nDMaterial("ElasticIsotropic", 1, 5e4, 0.3)
    for number, point in enumerate(points, 1):
        ops.node(number, *map(float, point))
    ops.element(name, 1, *range(1, len(points) + 1), 1.0, "PlaneStrain", 1)
    mass = ModelMass()
    mass.add_mass_from_surf(1, DENSITY, 1.0)
    right = DENSITY * volume * SIDE**2
    print(f"{name}: {mass.total_mass:.3f} t per m, right {right:.3f}")
    assert np.isclose(mass.total_mass / right, share)
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
