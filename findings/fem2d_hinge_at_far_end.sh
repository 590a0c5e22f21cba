#!/usr/bin/env bash
# fem2d 0.5.1: a beam with a hinge at its second end carries 31 % of its point load, or more than its uniform load.
#
# Expected: a beam that is fixed at its first end and released at its second end, on a support, is the propped
#     cantilever of the tables: 5/8 w L and 3/8 w L under a uniform load; the reactions sum up to the load, whichever
#     end has the hinge.
# Seen: 10 kN/m on 4, 6 and 8 m: the reactions sum up to 33.3, 60 and 93.3 kN, right are 40, 60 and 80 kN.  A load of 10
#     kN at L/4 has reactions of 3.1 kN, and a moment at the fixed end of 2.5 kNm on 4 m in place of 6.56 kNm.  With the
#     nodes swapped and `hinge_i` in place of `hinge_j` all is right.  A `TriangularLoad` does not see hinges: the
#     released end is held with w L^2/12.
# Meaning: in the load vector of `hinge_j` the force of the first node is made from the moment (f2 for f1), or from the
#     force of the other node.  By chance it is right at 6 m.  Loads vanish between a slab and its walls, without a
#     message.  Number the nodes so that the hinge is at the first end, and compare the sum of reactions with the load.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    fem2d==0.5.1 numpy==2.4.6 scipy==1.17.1 pandas==3.0.0
cat > run.py <<'PY'
from fem2d import BeamWithHingesElement, ElasticMaterial, Node, Section, Structure
from fem2d.loads import DistributedLoad, ElementPointLoad, TriangularLoad

LINE, POINT = 10.0, 10.0  # kN/m, kN


def reactions(length, load, hinge_first):
    """Force and moment at the fixed end, force and moment at the support below the hinge, in kN and kNm."""
    structure = Structure()
    fixed, hinged = Node("fixed", 0.0, 0.0), Node("hinged", length, 0.0)
    for node in (fixed, hinged):
        node.set_support(1, 1, 1)
        structure.add_node(node)
    # The element starts at the fixed end, or at the hinge; then its axes are turned and so is the load.
    start, end = (hinged, fixed) if hinge_first else (fixed, hinged)
    beam = BeamWithHingesElement(
        1, start, end, ElasticMaterial(30e6), Section(0.16, 2e-3), hinge_i=hinge_first, hinge_j=not hinge_first
    )
    structure.add_element(beam)
    down = LINE if hinge_first else -LINE
    if load == "uniform":
        DistributedLoad(beam, wy=down)
    elif load == "triangular":
        TriangularLoad(beam, wy1=down, wy2=down)
    else:
        ElementPointLoad(beam, py=down / LINE * POINT, x=0.75 * length if hinge_first else 0.25 * length)
    structure.solve()
    _, first, moment, _, second, held = structure.reactions
    return first, moment, second, held


for length, seen in ((4.0, 33.333), (6.0, 60.0), (8.0, 93.333)):
    first, moment, second, _ = reactions(length, "uniform", hinge_first=False)
    right = reactions(length, "uniform", hinge_first=True)
    print(f"{length} m: {first:.2f} + {second:.2f} = {first + second:.2f} kN, hinge at first end "
          f"{right[0]:.2f} + {right[2]:.2f} kN, table {5 * LINE * length / 8:.2f} + {3 * LINE * length / 8:.2f} kN")
    assert abs(first + second - seen) < 1e-2
    assert abs(right[0] - 5 * LINE * length / 8) < 1e-6 and abs(right[1] - LINE * length**2 / 8) < 1e-6

    first, moment, second, _ = reactions(length, "point", hinge_first=False)
    right = reactions(length, "point", hinge_first=True)
    table = POINT * 0.25 * 0.75 * 1.75 / 2 * length  # P a b (L + b) / (2 L^2)
    print(f"    point load: {first + second:.3f} kN, moment {moment:.3f} kNm; hinge at first end "
          f"{right[0] + right[2]:.3f} kN, {right[1]:.3f} kNm, table {table:.3f} kNm")
    assert abs(first + second - 3.125) < 1e-3 and abs(right[0] + right[2] - POINT) < 1e-6
    assert abs(right[1] - 10 * 0.25 * 0.75 * 1.75 / 2 * length) < 1e-6

held = abs(reactions(6.0, "triangular", hinge_first=False)[3])
print(f"triangular load with equal ends: moment {held:.2f} kNm at the hinge")
assert abs(held - LINE * 6.0**2 / 12) < 1e-6
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
