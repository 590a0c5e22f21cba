#!/usr/bin/env bash
# openseespy 3.7.1.2: a footing that slides has no friction in the results.
#
# Expected: a block with 100 kN on a contact `zeroLengthContact2D` with a friction of 0.5, and a spring of 1 kN/m beside
#     it, under a push of 60 kN: friction 50 kN, spring 10 kN.  `eleForce` and `nodeReaction` say so.
# Seen: with 30 kN the reaction of the ground is -30 kN, right.  With 60 kN the block moves 10.00 m, so the
#     friction was 50 kN in the analysis; but the tangential force of the element and the reaction are 0.0, the normal
#     ones are 100 kN.  Reactions of 10 kN are left of a load of 60 kN.  With 51 and 200 kN the friction is 0.0, too.
# Meaning: results are computed once more in the converged state, where the last slip counts as none.  The
#     base shear of a sliding wall or an isolated building vanishes in the moment in which it is largest, and
#     a factor of safety from reactions is infinite.  Derive friction from equilibrium, and sum reactions.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    openseespy==3.7.1.2
cat > run.py <<'PY'
import openseespy.opensees as ops

WEIGHT, FRICTION, SPRING, PENALTY = 100.0, 0.5, 1.0, 1e6


def pushed(push):
    """Displacement, forces of the contact on the block, and reactions of ground and spring."""
    ops.wipe()
    ops.model("basic", "-ndm", 2, "-ndf", 2)
    for node in (1, 2, 3):
        ops.node(node, 0.0, 0.0)
    ops.fix(1, 1, 1)
    ops.fix(3, 1, 1)
    ops.element("zeroLengthContact2D", 1, 2, 1, PENALTY, PENALTY, FRICTION, "-normal", 0.0, 1.0)
    ops.uniaxialMaterial("Elastic", 1, SPRING)
    ops.element("zeroLength", 2, 3, 2, "-mat", 1, "-dir", 1)
    ops.constraints("Plain")
    ops.numberer("Plain")
    ops.system("BandGeneral")
    ops.test("NormDispIncr", 1e-10, 100)
    ops.algorithm("Newton")
    ops.integrator("LoadControl", 0.1)
    ops.analysis("Static")
    for stage, (along, down) in enumerate(((0.0, -WEIGHT), (push, 0.0)), 1):
        ops.timeSeries("Linear", stage)
        ops.pattern("Plain", stage, stage)
        ops.load(2, along, down)
        assert ops.analyze(10) == 0
        ops.loadConst("-time", 0.0)
    ops.reactions()
    return ops.nodeDisp(2, 1), ops.eleForce(1)[:2], ops.nodeReaction(1), ops.nodeReaction(3, 1)


for push in (30.0, 51.0, 60.0, 200.0):
    moved, contact, ground, spring = pushed(push)
    friction = push - SPRING * moved
    print(f"push {push} kN: moved {moved:.4f} m, friction by equilibrium {friction:.3f} kN; element "
          f"{contact[0]:.3f}, {contact[1]:.3f}; reactions {ground[0]:.3f}, {ground[1]:.3f} and {spring:.3f} kN")
    assert abs(friction - min(push, FRICTION * WEIGHT)) < 1e-3
    assert abs(ground[1] - WEIGHT) < 1e-3 and abs(spring + SPRING * moved) < 1e-6
    if push < FRICTION * WEIGHT:
        assert abs(ground[0] + push) < 1e-3
    else:
        assert ground[0] == 0 and contact[0] == 0
PY
OMP_NUM_THREADS=1 venv/bin/python run.py 2>&1
