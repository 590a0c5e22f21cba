#!/usr/bin/env bash
# openseespy 3.7.1.2: under ten times its weight the soil settles as under one tenth of it.
#
# Expected: the body forces of a plane element (`quad`, last two arguments) belong to a load pattern:
#     they grow with its time series, and do not act without one.
# Seen: a square with a body force of -20 kN/m3 has a vertical stress of -10 kPa at a load factor of
#     0.1, of 1 and of 10, and without any pattern.  `SSPquad` is the same.  With `eleLoad ...
#     -selfWeight 0 1` in the pattern the stress is -1, -10 and -100 kPa.  No message.
# Meaning: the weight is switched on as a whole in the first step, so that an elasto-plastic slope is
#     not loaded gradually, and its factor of safety by an increase of gravity is infinite: the
#     load factor rises and nothing happens.  Load the weight by `-selfWeight`, and compare the
#     reactions with the factor.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    openseespy==3.7.1.2
cat > run.py <<'PY'
import openseespy.opensees as ops

WEIGHT = -20.0
ELEMENTS = {
    "quad": ("quad", 1, 1, 2, 3, 4, 1.0, "PlaneStrain", 1, 0.0, 0.0, 0.0, WEIGHT),
    "SSPquad": ("SSPquad", 1, 1, 2, 3, 4, 1, "PlaneStrain", 1.0, 0.0, WEIGHT),
}


def stress(element, factor, pattern=True, own_weight=False):
    """Vertical stress and sum of the reactions of a square under its weight."""
    ops.wipe()
    ops.model("basic", "-ndm", 2, "-ndf", 2)
    for tag, corner in enumerate([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)], 1):
        ops.node(tag, *corner)
        ops.fix(tag, 1, int(tag < 3))
    ops.nDMaterial("ElasticIsotropic", 1, 1e4, 0.3)
    ops.element(*ELEMENTS[element])
    if pattern:
        ops.timeSeries("Linear", 1)
        ops.pattern("Plain", 1, 1)
    if own_weight:
        ops.eleLoad("-ele", 1, "-type", "-selfWeight", 0.0, 1.0, 0.0)
    ops.constraints("Plain")
    ops.numberer("RCM")
    ops.system("BandGeneral")
    ops.test("NormDispIncr", 1e-10, 20)
    ops.algorithm("Newton")
    ops.integrator("LoadControl", factor)
    ops.analysis("Static")
    assert ops.analyze(1) == 0
    ops.reactions()
    reactions = sum(ops.nodeReaction(tag, 2) for tag in (1, 2))
    return round(ops.eleResponse(1, "stress")[1], 9), round(reactions, 9)


FACTORS = (0.1, 1.0, 10.0)
for element in ELEMENTS:
    plain = [stress(element, factor) for factor in FACTORS]
    alone = stress(element, 1.0, pattern=False)
    scaled = [stress(element, factor, own_weight=True) for factor in FACTORS]
    print(f"{element}, factors {FACTORS}: {plain}; without a pattern {alone}; selfWeight {scaled}")
    assert plain == [(-10, 20)] * 3 and alone == (-10, 20)
    assert scaled == [(-1, 2), (-10, 20), (-100, 200)]
PY
OMP_NUM_THREADS=1 venv/bin/python run.py 2>&1
