#!/usr/bin/env bash
# openseespy 3.7.1.2: a settlement that is prescribed in z holds the node in x as well.
#
# Expected: `constraints("Auto")` chooses a method for the constraints and has the result of
#     `constraints("Transformation")`.
# Seen: a square of soil between rollers (E = 10 MPa, nu = 0.3, plane strain), whose top is pressed by
#     10 mm with `sp(node, 2, -0.01)`, widens by 4.3 mm under a stress of -109.9 kPa with
#     Transformation, Lagrange and Penalty.  With Auto the top does not widen at all, the stresses are
#     -57.7 and -134.6 kPa, and the reactions have horizontal parts of 28.8 kN that no support
#     transfers.  No message.  With forces in place of settlements the two agree.
# Meaning: all dofs of a node are held that has a prescribed one in a load pattern: a smooth footing
#     becomes a rough one, 22 % stiffer here.  Use Transformation for prescribed settlements, and
#     look at the reactions in directions without support.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    openseespy==3.7.1.2
cat > run.py <<'PY'
import openseespy.opensees as ops


def square(handler, prescribed):
    """Displacement and reactions of the free corner, and the stress, of a pressed square."""
    ops.wipe()
    ops.model("basic", "-ndm", 2, "-ndf", 2)
    for tag, corner in enumerate([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)], 1):
        ops.node(tag, *corner)
    ops.fix(1, 1, 1)
    ops.fix(2, 0, 1)
    ops.nDMaterial("ElasticIsotropic", 1, 1e4, 0.3)
    ops.element("quad", 1, 1, 2, 3, 4, 1.0, "PlaneStrain", 1)
    ops.timeSeries("Linear", 1)
    ops.pattern("Plain", 1, 1)
    for tag in (3, 4):
        if prescribed:
            ops.sp(tag, 2, -0.01)
        else:
            ops.load(tag, 0.0, -50.0)
    ops.constraints(*handler)
    ops.numberer("RCM")
    ops.system("UmfPack")
    ops.test("NormDispIncr", 1e-8, 10)
    ops.algorithm("Newton")
    ops.integrator("LoadControl", 1.0)
    ops.analysis("Static")
    assert ops.analyze(1) == 0
    ops.reactions()
    return ops.nodeDisp(3, 1) * 1e3, ops.nodeReaction(3, 1), ops.eleResponse(1, "stress")[:2]


HANDLERS = [("Transformation",), ("Lagrange",), ("Penalty", 1e10, 1e10), ("Auto",)]
for handler in HANDLERS:
    widening, reaction, stress = square(handler, True)
    print(f"{handler[0]}: widens by {widening:.3f} mm, reaction {reaction:.2f} kN, stress {stress}")
    right = handler[0] != "Auto"
    assert abs(widening - (4.2857 if right else 0)) < 1e-3
    assert abs(stress[1] - (-109.89 if right else -134.615)) < 0.01
    assert abs(abs(reaction) - (0 if right else 28.846)) < 0.01
loads = [square(handler, False) for handler in (("Transformation",), ("Auto",))]
print("under forces", loads)
assert loads[0] == loads[1]
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
