#!/usr/bin/env bash
# openseespy 3.7.1.2: the moments along a loaded beam are all the same, and none is right.
#
# Expected: the section forces of `dispBeamColumn` under a uniform load are those of beam theory, at
#     least at the integration points, as its deflections and end forces are exact.
# Seen: a beam of 10 m on two supports with 10 kN/m, one element, five points.  The moments of the
#     sections are 83.3 kNm at all points, from the supports to the middle; right are 0 and 125 kNm.
#     The rotation of the ends is exact.  With two elements the supports have 20.8 kNm and the middle
#     145.8 kNm, with four 5.2 and 130.2 kNm.  `forceBeamColumn` is exact with one element.
# Meaning: the load acts on the nodes of this element only, and its curvature is linear.  Diagrams of
#     moments of walls and decks have moments at hinged ends and too large ones at mid-span, and
#     sections with strength yield there.  Nodes look right.  Use `forceBeamColumn`, or so many
#     elements that load times length squared over 12 is small.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    openseespy==3.7.1.2
cat > run.py <<'PY'
import openseespy.opensees as ops

LENGTH, BENDING, LOAD, POINTS = 10.0, 1e4, 10.0, 5


def beam(kind, parts):
    """Rotation of the end, and moments of all sections, of a beam on two supports."""
    ops.wipe()
    ops.model("basic", "-ndm", 2, "-ndf", 3)
    for node in range(parts + 1):
        ops.node(node + 1, LENGTH * node / parts, 0.0)
    ops.fix(1, 1, 1, 0)
    ops.fix(parts + 1, 0, 1, 0)
    ops.geomTransf("Linear", 1)
    ops.section("Elastic", 1, BENDING, 1.0, 1.0)
    ops.beamIntegration("Lobatto", 1, 1, POINTS)
    ops.timeSeries("Linear", 1)
    ops.pattern("Plain", 1, 1)
    for part in range(1, parts + 1):
        ops.element(kind, part, part, part + 1, 1, 1)
        ops.eleLoad("-ele", part, "-type", "-beamUniform", -LOAD)
    ops.system("FullGeneral")
    ops.numberer("Plain")
    ops.constraints("Plain")
    ops.test("NormUnbalance", 1e-8, 20)
    ops.integrator("LoadControl", 1.0)
    ops.algorithm("Newton")
    ops.analysis("Static")
    assert ops.analyze(1) == 0
    moments = [
        ops.eleResponse(part, "section", str(point), "force")[1]
        for part in range(1, parts + 1) for point in range(1, POINTS + 1)
    ]
    return ops.nodeDisp(parts + 1, 3), moments


middle = LOAD * LENGTH**2 / 8
for kind in ("dispBeamColumn", "forceBeamColumn"):
    for parts in (1, 2, 4):
        rotation, moments = beam(kind, parts)
        centre = max(moments)
        print(f"{kind}, {parts} elements: at the support {abs(moments[0]):.1f} kNm (right 0), largest "
              f"{centre:.1f} kNm (right {middle:.1f}), rotation {rotation:.5f}")
        assert abs(rotation - LOAD * LENGTH**3 / (24 * BENDING)) < 1e-6
        # The moment of the clamped part of the length of one element is missing.
        missing = LOAD * (LENGTH / parts) ** 2 / 12 if kind == "dispBeamColumn" else 0.0
        assert abs(moments[0] - missing) < 1e-6
        assert abs(centre - (middle + missing if parts > 1 or not missing else missing)) < 1e-6
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
