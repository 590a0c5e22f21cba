#!/usr/bin/env bash
# openseespy 3.7.1.2: at the last time of a load history the load is zero.
#
# Expected: a series of loads 0, 1, 2, 3 at t = 0, 1, 2, 3 (timeSeries Path with -dt) gives the load
#     3 at t = 3, and keeps it or drops to zero afterwards.
# Seen: the displacement at t = 1, 2, 3 is 1, 2 and 0.  At the time of the last value the load is
#     zero already.  With the same values given by -time it is 3 at t = 3, and zero from there on.
#     -useLast gives 3, 3 with -dt, and has no effect with -time: 3, 0.
# Meaning: the final state of a static push or of a staged fill is the unloaded one, which passes as
#     "analysis converged".  Repeat the last value in the list, whichever form is used.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    openseespy==3.7.1.2
cat > run.py <<'PY'
import openseespy.opensees as ops


def history(*series):
    """Displacements of a spring of stiffness 1 at t = 1, 2, 3, 4 under a load history."""
    ops.wipe()
    ops.model("basic", "-ndm", 1, "-ndf", 1)
    ops.node(1, 0.0)
    ops.node(2, 0.0)
    ops.fix(1, 1)
    ops.uniaxialMaterial("Elastic", 1, 1.0)
    ops.element("zeroLength", 1, 1, 2, "-mat", 1, "-dir", 1)
    ops.timeSeries("Path", 1, *series)
    ops.pattern("Plain", 1, 1)
    ops.load(2, 1.0)
    ops.system("BandGeneral")
    ops.numberer("Plain")
    ops.constraints("Plain")
    ops.algorithm("Linear")
    ops.integrator("LoadControl", 1.0)
    ops.analysis("Static")
    moved = []
    for _ in range(4):
        assert ops.analyze(1) == 0
        moved.append(round(ops.nodeDisp(2, 1), 9))
    return moved


VALUES = ("-values", 0.0, 1.0, 2.0, 3.0)
for series, seen in (
    (("-dt", 1.0, *VALUES), [1, 2, 0, 0]),
    (("-dt", 1.0, *VALUES, "-useLast"), [1, 2, 3, 3]),
    (("-time", 0.0, 1.0, 2.0, 3.0, *VALUES), [1, 2, 3, 0]),
    (("-time", 0.0, 1.0, 2.0, 3.0, *VALUES, "-useLast"), [1, 2, 3, 0]),
):
    moved = history(*series)
    print(*series, "gives", moved)
    assert moved == seen
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
