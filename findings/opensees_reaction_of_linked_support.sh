#!/usr/bin/env bash
# openseespy 3.7.1.2: the foundation of a column that stands on a rigid link carries nothing.
#
# Expected: the reaction of a fixed node includes what reaches it through `equalDOF` or a rigid link.
# Seen: a column of 3 m, with 10 kN to the right and 20 kN downwards at its head, stands on a node that
#     is tied to a fixed one.  `nodeReaction` of the fixed node is 0, 0, 0, with the handlers
#     Transformation, Penalty and Lagrange, for both kinds of tie.  The free end of the tie has
#     -10, 20 and 30 kNm instead.  With a rigid link of 1 m the moment at the fixed node should be 50
#     kNm, with 20 kNm from the eccentricity, and no node has it.  Displacements are right.
# Meaning: sums over supported nodes, base shear and bearing forces lose every member that is tied
#     on: piles under a rigid cap, decks on offset bearings, walls on a rigid slab.  If all are tied
#     the foundation has no load at all.  Take the reactions of the tied nodes, and move them
#     to the support by statics.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    openseespy==3.7.1.2
cat > run.py <<'PY'
import openseespy.opensees as ops

HEIGHT, SIDE, DOWN, OFFSET = 3.0, 10.0, 20.0, 1.0


def reactions(tie, *handler):
    """Reactions of the fixed node 1 and of the foot 2 of the column."""
    offset = OFFSET if tie == "rigidLink" else 0.0
    ops.wipe()
    ops.model("basic", "-ndm", 2, "-ndf", 3)
    ops.node(1, 0.0, 0.0)
    ops.node(2, offset, 0.0)
    ops.node(3, offset, HEIGHT)
    if tie == "none":
        ops.fix(2, 1, 1, 1)
    ops.fix(1, 1, 1, 1)
    if tie == "equalDOF":
        ops.equalDOF(1, 2, 1, 2, 3)
    elif tie == "rigidLink":
        ops.rigidLink("beam", 1, 2)
    ops.geomTransf("Linear", 1)
    ops.element("elasticBeamColumn", 1, 2, 3, 1.0, 1e6, 1.0, 1)
    ops.timeSeries("Linear", 1)
    ops.pattern("Plain", 1, 1)
    ops.load(3, SIDE, -DOWN, 0.0)
    ops.system("FullGeneral")
    ops.numberer("Plain")
    ops.constraints(*handler)
    ops.test("NormUnbalance", 1e-6, 20)
    ops.integrator("LoadControl", 1.0)
    ops.algorithm("Newton")
    ops.analysis("Static")
    assert ops.analyze(1) == 0
    ops.reactions()
    return ops.nodeReaction(1), ops.nodeReaction(2), ops.nodeDisp(3, 1)


_, fixed, moved = reactions("none", "Transformation")
for tie in ("equalDOF", "rigidLink"):
    # The moment of both loads about the fixed node.
    right = SIDE * HEIGHT + DOWN * (OFFSET if tie == "rigidLink" else 0.0)
    for handler in (("Transformation",), ("Penalty", 1e12, 1e12), ("Lagrange",)):
        support, foot, head = reactions(tie, *handler)
        print(f"{tie}, {handler[0]}: fixed node {[round(x, 3) for x in support]}, tied node "
              f"{[round(x, 3) for x in foot]}; right at the fixed node {[-SIDE, DOWN, right]}")
        assert max(map(abs, support)) < 1e-6 and abs(head - moved) < 1e-8
        assert all(abs(a - b) < 1e-6 for a, b in zip(foot, (-SIDE, DOWN, SIDE * HEIGHT)))
        assert all(abs(a - b) < 1e-6 for a, b in zip(foot, fixed))
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
