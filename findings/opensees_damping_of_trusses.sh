#!/usr/bin/env bash
# openseespy 3.7.1.2: Rayleigh damping of 10 % has no effect on springs and trusses.
#
# Expected: `rayleigh` with a coefficient for the stiffness damps every element, so that the
#     overshoot of a suddenly loaded mass on a bar is 0.729 at 10 % of critical damping.
# Seen: 0.999 and no decay in ten periods, if the bar is a `Truss` or a spring `zeroLength`: both
#     are left out of the damping by default.  With -doRayleigh 1 both give 0.729.  A beam element
#     in the same position gives 0.729 as it is.
# Meaning: the soil springs, anchors and braces of a frame are undamped where the frame is damped,
#     and an array of p-y springs or a truss bridge has no damping at all.  The periods are right.
#     Give -doRayleigh 1, and look at a free vibration.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    openseespy==3.7.1.2
cat > run.py <<'PY'
import math

import openseespy.opensees as ops

W, DAMPING = 2 * math.pi, 0.1


def response(kind, *options):
    """Overshoot and last value of a mass on a bar of 1 Hz under a constant load, in ten periods."""
    ops.wipe()
    ops.model("basic", "-ndm", 2, "-ndf", 3)
    ops.node(1, 0.0, 0.0)
    ops.node(2, 0.0 if kind == "zeroLength" else 1.0, 0.0)
    ops.fix(1, 1, 1, 1)
    ops.fix(2, 0, 1, 1)
    ops.uniaxialMaterial("Elastic", 1, W * W)
    ops.geomTransf("Linear", 1)
    if kind == "zeroLength":
        ops.element(kind, 1, 1, 2, "-mat", 1, "-dir", 1, *options)
    elif kind == "Truss":
        ops.element(kind, 1, 1, 2, 1.0, 1, *options)
    else:
        ops.element(kind, 1, 1, 2, 1.0, W * W, 1.0, 1)
    ops.mass(2, 1.0, 0.0, 0.0)
    ops.timeSeries("Constant", 1)
    ops.pattern("Plain", 1, 1)
    ops.load(2, 1.0, 0.0, 0.0)
    ops.rayleigh(0.0, 0.0, 2 * DAMPING / W, 0.0)
    ops.system("BandGeneral")
    ops.numberer("Plain")
    ops.constraints("Plain")
    ops.algorithm("Linear")
    ops.integrator("Newmark", 0.5, 0.25)
    ops.analysis("Transient")
    moved = []
    for _ in range(1000):
        assert ops.analyze(1, 0.01) == 0
        moved.append(ops.nodeDisp(2, 1) * W * W)
    return max(moved) - 1, max(moved[-100:]) - 1


right = math.exp(-math.pi * DAMPING / math.sqrt(1 - DAMPING**2))
print(f"right overshoot {right:.3f}")
for kind, options, damped in (
    ("zeroLength", (), False), ("zeroLength", ("-doRayleigh", 1), True),
    ("Truss", (), False), ("Truss", ("-doRayleigh", 1), True), ("elasticBeamColumn", (), True),
):
    first, last = response(kind, *options)
    print(kind, *options, f"overshoot {first:.3f}, in the tenth period {last:.3f}")
    assert abs(first - (right if damped else 1)) < 2e-3
    assert (last < 0.01) if damped else (last > 0.99)
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
