#!/usr/bin/env bash
# openseespy 3.7.1.2: a soil that thaws keeps the stiffness of the frozen one, in some elements.
#
# Expected: `setParameter("-val", modulus, "-ele", 1, "E")` halves the stiffness of the element, whatever
#     its type and elastic material, or refuses a parameter that the element does not have.
# Seen: a column of 1 m settles by 1 mm.  With half of Young's modulus it is 2 mm for `quad`, `SSPquad`
#     and `tri31`, and still 1 mm for `bbarQuad`, with no message.  With the material `J2Plasticity` "E" has
#     no effect in any of them; "G" and "K" have.  With `ElasticIsotropic` it is the other way round.
# Meaning: softening by stages, thawing, wetting, reduction of stiffness and sensitivities use this
#     command.  `bbarQuad` is the element for undrained clay.  A study in which the settlement does not
#     depend on the stiffness runs without a warning.  Compare two results for each parameter.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check openseespy==3.7.1.2
cat > run.py <<'PY'
import openseespy.opensees as ops

YOUNG = 1e4  # kPa, Poisson's ratio 0
MATERIALS = {
    "ElasticIsotropic": (YOUNG, 0.0),
    "J2Plasticity": (YOUNG / 3, YOUNG / 2, 1e9, 1e9, 0.0, 0.0),
}
PLANE = (1.0, "PlaneStrain", 1)
ELEMENTS = {
    "quad": [("quad", 1, 1, 2, 3, 4, *PLANE)],
    "SSPquad": [("SSPquad", 1, 1, 2, 3, 4, 1, "PlaneStrain", 1.0)],
    "tri31": [("tri31", 1, 1, 2, 3, *PLANE), ("tri31", 2, 1, 3, 4, *PLANE)],
    "bbarQuad": [("bbarQuad", 1, 1, 2, 3, 4, 1.0, 1)],
}


def settlements(elements, material, changes):
    """Settlement in mm under 10 kPa before and after the change of parameters."""
    ops.wipe()
    ops.model("basic", "-ndm", 2, "-ndf", 2)
    for tag, place in enumerate([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)], start=1):
        ops.node(tag, *place)
        ops.fix(tag, 1, int(tag < 3))
    ops.nDMaterial(material, 1, *MATERIALS[material])
    for element in elements:
        ops.element(*element)
    ops.timeSeries("Constant", 1)
    ops.pattern("Plain", 1, 1)
    for tag in (3, 4):
        ops.load(tag, 0.0, -5.0)
    ops.constraints("Transformation")
    ops.numberer("RCM")
    ops.system("FullGeneral")
    ops.test("NormDispIncr", 1e-10, 20)
    ops.algorithm("Newton")
    ops.integrator("LoadControl", 1.0)
    ops.analysis("Static")
    assert ops.analyze(1) == 0
    before = -1e3 * ops.nodeDisp(3, 2)
    for name, value in changes.items():
        ops.setParameter("-val", value, "-ele", *[element[1] for element in elements], name)
    assert ops.analyze(1) == 0
    return before, -1e3 * ops.nodeDisp(3, 2)


CHANGES = ({"E": YOUNG / 2}, {"G": YOUNG / 4, "K": YOUNG / 6})
for material in MATERIALS:
    for name, elements in ELEMENTS.items():
        for changes in CHANGES:
            before, after = settlements(elements, material, changes)
            print(f"{name}, {material}, half of {' and '.join(changes)}: {before:.3f} to {after:.3f} mm")
            works = name != "bbarQuad" and ("E" in changes) == (material == "ElasticIsotropic")
            assert abs(before - 1) < 1e-6 and abs(after - (2 if works else 1)) < 1e-3
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
