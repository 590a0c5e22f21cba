#!/usr/bin/env bash
# fem2d 0.5.1: a moment within a member turns the support the wrong way, and by twice as much.
#
# Expected: `ElementPointLoad` with `mz` within a member is the same load as `PointLoad` with that moment at a node
#     which divides the member: the rotations and reactions agree, since the beam element is exact for loads at nodes.
# Seen: 100 kNm at the middle of 8 m on two pinned supports (EI 60 MNm2): the ends turn by +1.111e-3, right is -0.556e-3
#     (M L / 24 EI).  At a quarter of a beam with fixed ends the moments are -75 and -25 kNm and the forces zero; right
#     are -18.75 and 31.25 kNm and 14.06 kN.
# Meaning: the moment is shared between the two nodes like a force by the lever rule, and the couple of forces is left
#     out.  A bracket, an eccentric anchor head or the thrust of a strut on a wall loads the wall with a wrong moment,
#     even in its sign.  Put a node where the moment acts.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    fem2d==0.5.1 numpy==2.4.6 scipy==1.17.1 pandas==3.0.0
cat > run.py <<'PY'
from fem2d import BeamElement, ElasticMaterial, Node, Section, Structure
from fem2d.loads import ElementPointLoad, PointLoad

LENGTH, MODULUS, INERTIA, MOMENT = 8.0, 30e6, 2e-3, 100.0  # m, kPa, m4, kNm


def solve(place, fixed, node_at_moment):
    """Rotations of the two ends, and force and moment of their reactions."""
    structure = Structure()
    places = [0.0, place, LENGTH] if node_at_moment else [0.0, LENGTH]
    nodes = [Node(i, x, 0.0) for i, x in enumerate(places)]
    for node in nodes:
        if node.x in (0.0, LENGTH):
            node.set_support(1, 1, fixed)
        structure.add_node(node)
    for i, (start, end) in enumerate(zip(nodes[:-1], nodes[1:])):
        beam = BeamElement(i, start, end, ElasticMaterial(MODULUS), Section(0.16, INERTIA))
        structure.add_element(beam)
    if node_at_moment:
        structure.add_load(PointLoad(nodes[1], mz=MOMENT))
    else:
        ElementPointLoad(beam, mz=MOMENT, x=place)
    structure.solve()
    ends = [nodes[0].dofs, nodes[-1].dofs]
    rotations = [structure.disp[dofs[2]] for dofs in ends]
    return rotations, [structure.reactions[dofs[1]] for dofs in ends], [structure.reactions[dofs[2]] for dofs in ends]


wrong, _, _ = solve(LENGTH / 2, 0, node_at_moment=False)
right, _, _ = solve(LENGTH / 2, 0, node_at_moment=True)
table = -MOMENT * LENGTH / (24 * MODULUS * INERTIA)
print(f"pinned ends: rotation {wrong[0]:.3e}, with a node {right[0]:.3e}, table {table:.3e}")
assert abs(right[0] - table) < 1e-9 and abs(wrong[0] + 2 * table) < 1e-9

_, forces, moments = solve(LENGTH / 4, 1, node_at_moment=False)
_, right_forces, right_moments = solve(LENGTH / 4, 1, node_at_moment=True)
print(f"fixed ends: forces {forces[0]:.3f} and {forces[1]:.3f} kN, moments {moments[0]:.3f} and {moments[1]:.3f} kNm")
print(f"with a node: forces {right_forces[0]:.3f} and {right_forces[1]:.3f} kN, "
      f"moments {right_moments[0]:.3f} and {right_moments[1]:.3f} kNm")
assert abs(moments[0] + 75) < 1e-6 and abs(moments[1] + 25) < 1e-6 and abs(forces[0]) < 1e-6
# Table of fixed ends: M b (2 a - b) / L^2 and 6 M a b / L^3.
a, b = LENGTH / 4, 3 * LENGTH / 4
assert abs(right_moments[0] - MOMENT * b * (2 * a - b) / LENGTH**2) < 1e-6
assert abs(right_forces[0] - 6 * MOMENT * a * b / LENGTH**3) < 1e-6
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
