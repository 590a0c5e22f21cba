#!/usr/bin/env bash
# openseespy 3.7.1.2: the quadratic tetrahedron is six times too soft.
#
# Expected: a cube under a stiff lid, restrained at its sides, settles by the load over area and
#     oedometric modulus, exactly, with tetrahedra of four and of ten nodes.
# Seen: under 10 kN a cube of 1 m (12,000 kPa) settles 0.833 mm with FourNodeTetrahedron and 5.000 mm
#     with TenNodeTetrahedron, 6.0 times the right value, for a cube of 2 m too.  The reaction is 10 kN.
#     Under its own weight (body forces of the element) it settles right, but its reaction is 1.67 kN
#     in place of 10 kN.  So stiffness and weight of the element both have a sixth of their size.
#     No message.
# Meaning: a model of ten-node tetrahedra passes a check by its own weight and is wrong by a factor of six
#     under each load on nodes and in each joint with other elements: piles, walls and interfaces stand
#     in soil of a sixth of its modulus.  Check reactions, or use hexahedra.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    openseespy==3.7.1.2 numpy==2.4.6
cat > run.py <<'PY'
import itertools
import sys

import numpy as np
import openseespy.opensees as ops

EDGES = [(0, 1), (1, 2), (2, 0), (0, 3), (2, 3), (1, 3)]  # nodes 5 to 10, the order of the manual
YOUNG, POISSON, FORCE, WEIGHT, DENSITY = 1e4, 0.25, 10.0, 10.0, 2.0
MODULUS = YOUNG * (1 - POISSON) / ((1 + POISSON) * (1 - 2 * POISSON))


def cube(size, kind, load):
    """Settlement in m and sum of the reactions in kN of a cube of six tetrahedra."""
    ops.wipe()
    ops.model("basic", "-ndm", 3, "-ndf", 3)
    nodes = {}

    def node(point):
        key = tuple(float(x) for x in np.round(point, 9))
        if key not in nodes:
            nodes[key] = len(nodes) + 1
            ops.node(nodes[key], *key)
        return nodes[key]

    ops.nDMaterial("ElasticIsotropic", 1, YOUNG, POISSON, DENSITY)
    body = (0.0, 0.0, -WEIGHT) if load == "weight" else (0.0, 0.0, 0.0)
    for number, axes in enumerate(itertools.permutations(range(3)), 1):
        corners = [np.zeros(3)]
        for axis in axes:
            corners.append(corners[-1] + size * np.eye(3)[axis])
        if np.linalg.det(np.array(corners[1:]) - corners[0]) < 0:
            corners[1], corners[2] = corners[2], corners[1]
        middles = [(corners[i] + corners[j]) / 2 for i, j in EDGES]
        points = corners + middles if kind == "TenNodeTetrahedron" else corners
        ops.element(kind, number, *(node(x) for x in points), 1, *body)
    for point, tag in nodes.items():
        ops.fix(tag, 1, 1, int(point[2] == 0))
    lid = [tag for point, tag in nodes.items() if point[2] == size]
    ops.timeSeries("Linear", 1)
    ops.pattern("Plain", 1, 1)
    if load == "lid":
        for tag in lid[1:]:
            ops.equalDOF(lid[0], tag, 3)
        ops.load(lid[0], 0, 0, -FORCE)
    ops.constraints("Transformation")
    ops.numberer("Plain")
    ops.system("FullGeneral")
    ops.algorithm("Linear")
    ops.integrator("LoadControl", 1.0)
    ops.analysis("Static", "-noWarnings")
    assert ops.analyze(1) == 0
    ops.reactions()
    reaction = sum(ops.nodeReaction(tag)[2] for point, tag in nodes.items() if point[2] == 0)
    return -np.mean([ops.nodeDisp(tag)[2] for tag in lid]), reaction


KIND = sys.argv[1]
for size in (1.0, 2.0):
    settlement, reaction = cube(size, KIND, "lid")
    right = FORCE / (size * MODULUS)
    print(f"{KIND}, {size} m, lid: {1000 * settlement:.3f} mm, right {1000 * right:.3f} mm; "
          f"reaction {reaction:.2f} kN")
    assert abs(settlement / right - (6 if KIND.startswith("Ten") else 1)) < 1e-9
    assert abs(reaction - FORCE) < 1e-9
    settlement, reaction = cube(size, KIND, "weight")
    right, weight = WEIGHT * size**2 / (2 * MODULUS), WEIGHT * size**3
    print(f"{KIND}, {size} m, weight: {1000 * settlement:.4f} mm, right {1000 * right:.4f} mm; "
          f"reaction {reaction:.2f} kN, right {weight:.2f} kN")
    assert abs(settlement / right - 1) < 0.02
    assert abs(reaction / weight - (1 / 6 if KIND.startswith("Ten") else 1)) < 1e-9
PY
for kind in FourNodeTetrahedron TenNodeTetrahedron; do
    OMP_NUM_THREADS=1 venv/bin/python run.py "$kind"
done
