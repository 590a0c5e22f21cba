#!/usr/bin/env bash
# openseespy 3.7.1.2: the pore pressure of `quadUP` is a velocity, and a prescribed one disappears.
#
# Expected: the third dof of a node is the pore pressure, as the first two are displacements:
#     `nodeDisp(node, 3)` is its value, and `sp(node, 3, 20.0)` holds it at 20 kPa.
# Seen: a column of clay of 1 m under 100 kPa, hardly drained.  At its base `nodeDisp` is 50 kPa after 1 s,
#     149 after 2 s and 1938 after 20 s; `nodeVel` is 99 kPa throughout, which is right.  With 20 kPa
#     prescribed at the top of a permeable column, the pressure there is 40 and -38 kPa in two steps
#     and 0 after a minute (Lagrange); with the Transformation method it is 0 from the start.  A
#     linear series of 20 kPa a second ends at 20 kPa (Lagrange), or at 0 (Transformation).  No message.
# Meaning: the dof is the integral of the pressure over time.  After a first step of 1 s the value has
#     the size of a pressure.  Water levels that are prescribed as values vanish, and zero is the only
#     one that is kept: a river beside a dyke is a drain.  Read velocities, and prescribe p t.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    openseespy==3.7.1.2
cat > run.py <<'PY'
import openseespy.opensees as ops

LAYERS, LOAD, WATER = 10, 100.0, 20.0


def column(load, water, permeability, steps, handler="Transformation"):
    """Displacement and pressure at the base, and pressure at the top, after each step of 1 s."""
    ops.wipe()
    ops.model("basic", "-ndm", 2, "-ndf", 3)
    top = [2 * LAYERS + 1, 2 * LAYERS + 2]
    for j in range(LAYERS + 1):
        for i in range(2):
            ops.node(2 * j + i + 1, float(i), j / LAYERS)
            ops.fix(2 * j + i + 1, 1, int(j == 0), int(j == LAYERS and water is None))
    ops.nDMaterial("ElasticIsotropic", 1, 1e4, 0.3)
    for j in range(LAYERS):
        first = 2 * j + 1
        corners = (first, first + 1, first + 3, first + 2)
        ops.element("quadUP", j + 1, *corners, 1.0, 1, 2.2e6, 1.0, permeability, permeability)
    ops.timeSeries(*(("Linear", 1) if water == "integral" else ("Constant", 1)))
    ops.pattern("Plain", 1, 1)
    for tag in top:
        if load:
            ops.load(tag, 0.0, -load / 2, 0.0)
        if water is not None:
            ops.sp(tag, 3, WATER)
    ops.constraints(handler)
    ops.numberer("RCM")
    ops.system("UmfPack")
    ops.test("NormDispIncr", 1e-8, 20)
    ops.algorithm("Newton")
    ops.integrator("Newmark", 0.6, 0.3025)
    ops.analysis("Transient")
    history = []
    for _ in range(steps):
        assert ops.analyze(1, 1.0) == 0
        history.append([ops.nodeDisp(1, 3), ops.nodeVel(1, 3), ops.nodeVel(top[0], 3)])
    return history


loaded = column(LOAD, None, 1e-7, 20)
for step, seen in {1: 50.16, 2: 148.89, 20: 1938.19}.items():
    displacement, pressure, _ = loaded[step - 1]
    print(f"step {step}: at the base, displacement {displacement:.2f}, velocity {pressure:.2f} kPa")
    assert abs(displacement - seen) < 0.5 and abs(pressure - 99.4) < 1
tops = {}
for handler in ("Lagrange", "Transformation"):
    for kind in ("value", "integral"):
        soaked = column(0.0, kind, 1e-2, 60, handler)
        tops[handler, kind] = [soaked[step - 1][2] for step in (1, 2, 60)]
        print(f"{handler}, prescribed {kind}: pressures at the top after 1, 2 and 60 s {tops[handler, kind]}")
first, second, last = tops["Lagrange", "value"]
assert abs(first - 39.7) < 0.1 and abs(second + 38.5) < 0.1 and abs(last) < 0.1
assert abs(tops["Lagrange", "integral"][2] - 20) < 0.1
assert all(pressure == 0 for kind in ("value", "integral") for pressure in tops["Transformation", kind])
PY
OMP_NUM_THREADS=1 venv/bin/python run.py 2>&1
