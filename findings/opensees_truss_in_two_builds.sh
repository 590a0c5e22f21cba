#!/usr/bin/env bash
# openseespy 3.7.1.2, opensees 0.1.32 (xara): the option that damps a truss has no effect in the other build.
#
# Expected: one script gives the same numbers with `openseespy.opensees` and with `opensees.openseespy`.
# Seen: a suddenly loaded mass on a bar with Rayleigh damping of 10 %.  By hand it overshoots by 0.729.  A spring
#     `zeroLength` with -doRayleigh 1: 0.729 in both builds.  A `Truss` with -doRayleigh 1: 0.729 in openseespy,
#     0.999 in opensees, as without the option.  No message.
# Meaning: braces, anchors and cables that were damped are undamped after a change of the import line, while springs and
#     beams beside them are not.  Peaks of anchor forces grow, periods are the same.  Compare a free vibration
#     of one truss when the build changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    --no-deps openseespy==3.7.1.2 openseespylinux==3.7.1.2 opensees==0.1.32 numpy==2.4.6
cat > run.py <<'PY'
import importlib
import subprocess
import sys

import numpy as np

OMEGA, DAMPING, STEPS = 2 * np.pi, 0.1, 100
CASES = {
    "spring": ("zeroLength", 1, 1, 2, "-mat", 1, "-dir", 1, "-doRayleigh", 1),
    "truss": ("Truss", 1, 1, 3, 1.0, 1, "-doRayleigh", 1),
    "truss without option": ("Truss", 1, 1, 3, 1.0, 1),
}


def overshoot(ops, *element):
    """Overshoot of a suddenly loaded mass on a bar, over its static displacement."""
    ops.wipe()
    ops.model("basic", "-ndm", 1, "-ndf", 1)
    for tag, x in ((1, 0.0), (2, 0.0), (3, 1.0)):
        ops.node(tag, x)
    moving = element[3]
    for tag in {1, 2, 3} - {moving}:
        ops.fix(tag, 1)
    ops.mass(moving, 1.0)
    ops.uniaxialMaterial("Elastic", 1, OMEGA**2)
    ops.element(*element)
    ops.rayleigh(0.0, 2 * DAMPING / OMEGA, 0.0, 0.0)
    ops.timeSeries("Constant", 1)
    ops.pattern("Plain", 1, 1)
    ops.load(moving, OMEGA**2)
    ops.constraints("Plain")
    ops.numberer("Plain")
    ops.system("FullGeneral")
    ops.algorithm("Linear")
    ops.integrator("Newmark", 0.5, 0.25)
    ops.analysis("Transient")
    found = []
    for _ in range(STEPS):
        assert ops.analyze(1, 1 / STEPS) == 0
        found.append(ops.nodeDisp(moving, 1))
    return max(found) - 1


if len(sys.argv) > 1:
    module = importlib.import_module(sys.argv[1])
    print(*(overshoot(module, *element) for element in CASES.values()))
    sys.exit()

right = np.exp(-np.pi * DAMPING / np.sqrt(1 - DAMPING**2))
print(f"by hand {right:.3f} with damping, 1 without")
seen = {}
for name in ("openseespy.opensees", "opensees.openseespy"):
    run = subprocess.run([sys.executable, __file__, name], capture_output=True, text=True, check=True)
    values = [float(word) for word in run.stdout.split()]
    seen[name] = dict(zip(CASES, values))
    print(f"{name}:", {key: round(value, 3) for key, value in seen[name].items()})
    for case, value in seen[name].items():
        damped = case == "spring" or (case == "truss" and name == "openseespy.opensees")
        assert abs(value - (right if damped else 1)) < 5e-3
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
