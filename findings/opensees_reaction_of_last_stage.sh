#!/usr/bin/env bash
# openseespy 3.7.1.2: the reaction of the second stage is the one of the first.
#
# Expected: `nodeReaction` after a step of analysis is the reaction of this step, as `nodeDisp` is its
#     displacement; before anything is computed there is an error.
# Seen: a spring under 10, 20 and 30 kN.  Without a call of `reactions()` the reaction is 0.  After one
#     call in the first step it is -10, and it stays -10 in the second and third step, while the
#     displacements grow and the element has 20 and 30 kN.  No message.
# Meaning: `reactions()` computes them once, and the numbers stay until the next call.  Bearing
#     pressure, prop loads and base shear of later stages are those of an earlier one, on the unsafe side
#     where loads grow.  Call `reactions()` after each step, and compare with the loads.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    openseespy==3.7.1.2
cat > run.py <<'PY'
import openseespy.opensees as ops

ops.wipe()
ops.model("basic", "-ndm", 1, "-ndf", 1)
ops.node(1, 0.0)
ops.node(2, 0.0)
ops.fix(1, 1)
ops.uniaxialMaterial("Elastic", 1, 100.0)
ops.element("zeroLength", 1, 1, 2, "-mat", 1, "-dir", 1)
ops.timeSeries("Linear", 1)
ops.pattern("Plain", 1, 1)
ops.load(2, 10.0)
ops.constraints("Plain")
ops.numberer("Plain")
ops.system("BandGeneral")
ops.algorithm("Linear")
ops.integrator("LoadControl", 1.0)
ops.analysis("Static")

assert ops.analyze(1) == 0
never = ops.nodeReaction(1, 1)
ops.reactions()
found = [ops.nodeReaction(1, 1)]
for _ in range(2):
    assert ops.analyze(1) == 0
    found.append(ops.nodeReaction(1, 1))
    moved, spring = ops.nodeDisp(2, 1), ops.eleForce(1)[-1]
ops.reactions()
last = ops.nodeReaction(1, 1)
print(f"without a call {never}, in three stages {found}, after a call {last}")
print(f"third stage: displacement {moved}, force of the spring {spring}")
assert never == 0 and found == [-10, -10, -10]
assert abs(last + 30) < 1e-9 and abs(spring - 30) < 1e-9 and abs(moved - 0.3) < 1e-12
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
