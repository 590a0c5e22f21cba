#!/usr/bin/env bash
# openseespy 3.7.1.2: the pressure of a plane element pulls, and forgets the thickness.
#
# Expected: `pressure` of the element `quad` presses on its edges, as force per area: 10 kPa gives a
#     stress of -10 kPa, whatever the thickness.
# Seen: 10 gives the stress +20 at a thickness of 0.5 m, +10 at 1 m and +5 at 2 m.  The sign is that
#     of tension, and the edges get the value as force per length.  The body force of the same
#     element is multiplied by the thickness, and its stress does not depend on it.
# Meaning: a cell pressure or water pressure turns into suction, and a slice that is not 1 m thick
#     gets the wrong ratio of water pressure to weight.  Give minus the pressure times the
#     thickness, and compare the stress of one element.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    openseespy==3.7.1.2
cat > run.py <<'PY'
import openseespy.opensees as ops


def vertical_stress(thickness, pressure, weight):
    """Mean vertical stress of a unit square on rollers, without Poisson's effect."""
    ops.wipe()
    ops.model("basic", "-ndm", 2, "-ndf", 2)
    for tag, (x, y) in enumerate([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)], start=1):
        ops.node(tag, x, y)
    ops.fix(1, 1, 1)
    ops.fix(2, 0, 1)
    ops.nDMaterial("ElasticIsotropic", 1, 1000.0, 0.0)
    ops.element("quad", 1, 1, 2, 3, 4, thickness, "PlaneStrain", 1, pressure, 0.0, 0.0, -weight)
    ops.system("BandGeneral")
    ops.numberer("Plain")
    ops.constraints("Plain")
    ops.algorithm("Linear")
    ops.integrator("LoadControl", 1.0)
    ops.analysis("Static")
    assert ops.analyze(1) == 0
    return sum(ops.eleResponse(1, "stresses")[1::3]) / 4


for thickness in (0.5, 1.0, 2.0):
    pressed = vertical_stress(thickness, 10.0, 0.0)
    heavy = vertical_stress(thickness, 0.0, 10.0)
    print(f"thickness {thickness}: pressure 10 gives {pressed:+.3f}, body force 10 {heavy:+.3f}")
    assert abs(pressed - 10 / thickness) < 1e-9 and abs(heavy + 5) < 1e-9
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
