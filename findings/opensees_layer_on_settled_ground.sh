#!/usr/bin/env bash
# openseespy 3.7.1.2: a layer of fill lifts the ground that it is placed on.
#
# Expected: an element that is added between nodes that have moved is free of stress, as its material
#     starts with its own strain; all elements agree.
# Seen: on springs that have settled 10 mm, an analysis without a new load keeps 10.00 mm after
#     `Truss`, `elasticBeamColumn`, `dispBeamColumn` or `forceBeamColumn` is added.  With
#     `CorotTruss` and `twoNodeLink` it is 5.00 mm, with `quad`, `SSPquad` and `bbarQuad` 6.67, `tri31`
#     7.06, `stdBrick`, `bbarBrick` and `SSPbrick` 8.00 and `FourNodeTetrahedron` 8.57 mm.
# Meaning: bars and beams remember the displacement at which they are added, solids and the other two
#     take all of it as strain.  Fill, backfill and linings of solids are stressed by all that
#     happened before, pull the ground back without a message, and anchors depend on the kind of
#     truss.  Analyse once without a load after each stage, and see that nothing moves.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    openseespy==3.7.1.2
cat > run.py <<'PY'
import openseespy.opensees as ops

PLANE = [(0, 0), (1, 0), (1, 1), (0, 1)]
SPACE = [(x, y, z) for z in (0, 1) for x, y in PLANE]
BEAMS = ("elasticBeamColumn", "dispBeamColumn", "forceBeamColumn")
SOLIDS = ("stdBrick", "bbarBrick", "SSPbrick", "FourNodeTetrahedron")


def add(kind):
    """Add one element of unit size between the settled nodes and fixed ones."""
    if kind in ("Truss", "CorotTruss"):
        ops.element(kind, 1, 1, 4, 1.0, 1)
    elif kind == "twoNodeLink":
        ops.element(kind, 1, 1, 4, "-mat", 1, "-dir", 1)
    elif kind in BEAMS:
        ops.geomTransf("Linear", 1)
        ops.section("Elastic", 1, 1000.0, 1.0, 1.0)
        ops.beamIntegration("Lobatto", 1, 1, 3)
        more = (1.0, 1000.0, 1.0, 1) if kind == "elasticBeamColumn" else (1, 1)
        ops.element(kind, 1, 1, 4, *more)
    else:
        ops.nDMaterial("ElasticIsotropic", 1, 1000.0, 0.0)
        nodes = {"tri31": (1, 3, 4), "FourNodeTetrahedron": (1, 2, 4, 5)}
        nodes = nodes.get(kind, range(1, 9) if kind in SOLIDS else range(1, 5))
        more = {"quad": (1.0, "PlaneStrain", 1), "SSPquad": (1, "PlaneStrain", 1.0),
                "bbarQuad": (1.0, 1), "tri31": (1.0, "PlaneStrain", 1)}
        ops.element(kind, 1, *nodes, *more.get(kind, (1,)))


def settlement(kind):
    """Settlement of the top nodes before and after an element is added, in mm."""
    ops.wipe()
    points, beam = SPACE if kind in SOLIDS else PLANE, kind in BEAMS
    dimension = len(points[0])
    ops.model("basic", "-ndm", dimension, "-ndf", 3 if beam else dimension)
    ops.uniaxialMaterial("Elastic", 1, 1000.0)
    ops.timeSeries("Constant", 1)
    ops.pattern("Plain", 1, 1)
    rotation = [1] if beam else []
    for node, point in enumerate(points, start=1):
        ops.node(node, *map(float, point))
        if point[-1] == 0:
            ops.fix(node, *[1] * dimension, *rotation)
            continue
        # A top node moves down only, on a spring of its own.
        ops.fix(node, *[1] * (dimension - 1), 0, *rotation)
        ops.node(100 + node, *map(float, point))
        ops.fix(100 + node, *[1] * dimension, *rotation)
        ops.element("zeroLength", 100 + node, 100 + node, node, "-mat", 1, "-dir", dimension)
        ops.load(node, *[0.0] * (dimension - 1), -10.0, *[0.0] * len(rotation))
    ops.system("FullGeneral")
    ops.numberer("Plain")
    ops.constraints("Transformation")
    ops.test("NormDispIncr", 1e-10, 20)
    ops.algorithm("Newton")
    ops.integrator("LoadControl", 1.0)
    ops.analysis("Static")
    assert ops.analyze(1) == 0
    before = ops.nodeDisp(len(points), dimension)
    ops.loadConst("-time", 0.0)
    add(kind)
    assert ops.analyze(1) == 0
    added = 5 if kind in SOLIDS else 4
    return -1000 * before, -1000 * ops.nodeDisp(added, dimension)


RESULTS = {"Truss": 10, **dict.fromkeys(BEAMS, 10), "CorotTruss": 5, "twoNodeLink": 5,
           **dict.fromkeys(("quad", "SSPquad", "bbarQuad"), 20 / 3), "tri31": 7.06,
           **dict.fromkeys(SOLIDS[:3], 8), "FourNodeTetrahedron": 8.57}
for kind, result in RESULTS.items():
    before, after = settlement(kind)
    print(f"{kind}: {before:.2f} mm before, {after:.2f} mm after")
    assert abs(before - 10) < 1e-6 and abs(after - result) < 0.01
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
