#!/usr/bin/env bash
# openseespy 3.7.1.2: rigid ends make a beam with shear deformation two to three times too stiff.
#
# Expected: `ElasticTimoshenkoBeam` with a huge shear area deflects as `elasticBeamColumn`, with `-jntOffset` as well as
#     without: the tip of a cantilever of 10 m with rigid ends of 2 and 1 m sinks by P (c^3/3 + c^2 r + c r^2) / EI,
#     with the elastic length c = 7 m and the arm r = 1 m.
# Seen: EI times the deflection is 333.3 for both without offsets.  With them it is 170.3 for elasticBeamColumn, as by
#     hand, and 56.0 in a plane model and 114.3 in a spatial one for ElasticTimoshenkoBeam.  114.3 is c^3/3 alone, the
#     elastic part without the arm.  No message.
# Meaning: walls, coupling beams, short piles in caps and box frames have deep members, rigid joints and shear together.
#     Their frames are too stiff, their periods too short and their forces wrong, and the element differs from itself
#     in the plane.  Use stiff elements for the joints, or forceBeamColumn with a section that has shear.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    openseespy==3.7.1.2 numpy==2.4.6
cat > run.py <<'PY'
import math

import openseespy.opensees as ops

LENGTH, LEFT, RIGHT = 10.0, 2.0, 1.0  # m
MODULUS, AREA, INERTIA, TORSION, HUGE = 3e7, 0.1, 1e-3, 1e-3, 1e12


def tip(kind, dimension, offsets):
    """EI times the deflection of the tip of a cantilever under a unit load."""
    ops.wipe()
    freedoms = 3 if dimension == 2 else 6
    ops.model("basic", "-ndm", dimension, "-ndf", freedoms)
    rest = [0.0] * (dimension - 1)
    ops.node(1, 0.0, *rest)
    ops.node(2, LENGTH, *rest)
    ops.fix(1, *[1] * freedoms)
    plane = [] if dimension == 2 else [0.0, 0.0, 1.0]
    ends = ["-jntOffset", LEFT, *rest, -RIGHT, *rest] if offsets else []
    ops.geomTransf("Linear", 1, *plane, *ends)
    if kind == "elasticBeamColumn":
        stiffness = [AREA, MODULUS, INERTIA] if dimension == 2 else [AREA, MODULUS, HUGE, TORSION, INERTIA, INERTIA]
    elif dimension == 2:
        stiffness = [MODULUS, HUGE, AREA, INERTIA, HUGE]
    else:
        stiffness = [MODULUS, HUGE, AREA, TORSION, INERTIA, INERTIA, HUGE, HUGE]
    ops.element(kind, 1, 1, 2, *stiffness, 1)
    ops.timeSeries("Linear", 1)
    ops.pattern("Plain", 1, 1)
    ops.load(2, 0.0, -1.0, *[0.0] * (freedoms - 2))
    ops.system("FullGeneral")
    ops.numberer("Plain")
    ops.constraints("Plain")
    ops.algorithm("Linear")
    ops.integrator("LoadControl", 1.0)
    ops.analysis("Static")
    assert ops.analyze(1) == 0
    return -ops.nodeDisp(2, 2) * MODULUS * INERTIA


elastic = LENGTH - LEFT - RIGHT
for offsets, right, seen in (
    (False, LENGTH**3 / 3, (LENGTH**3 / 3, LENGTH**3 / 3)),
    (True, elastic**3 / 3 + elastic**2 * RIGHT + elastic * RIGHT**2, (56.023, elastic**3 / 3)),
):
    for dimension, value in zip((2, 3), seen):
        slender = tip("elasticBeamColumn", dimension, offsets)
        deep = tip("ElasticTimoshenkoBeam", dimension, offsets)
        print(
            f"{dimension}D, offsets {offsets}: elasticBeamColumn {slender:.2f}, ElasticTimoshenkoBeam {deep:.2f}, "
            f"right {right:.2f}"
        )
        assert math.isclose(slender, right, rel_tol=1e-6) and math.isclose(deep, value, rel_tol=1e-4)
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
