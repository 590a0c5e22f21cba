#!/usr/bin/env bash
# anastruct 1.7.0: a pile that stands in compression has a reaction that pulls it down.
#
# Expected: `reaction_forces` opposes the loads in both directions, or has the sign of the loads in
#     both: the sum of loads and reactions is zero, or twice the loads.
# Seen: a column that is fixed at its foot, with 3 kN to the right and 10 kN downwards at its head
#     (Fx = 3, Fy = -10; the head moves right and down), has the reaction Fx = -3 and Fy = -10.  The
#     horizontal sum is 0 and the vertical one -20.  `get_node_results_system` has Fx = 3 and Fy =
#     -10 at the same node, and its displacements have the other sign than those of
#     `get_node_displacements`.
# Meaning: a bearing pile is taken for an anchor and an uplift for a bearing force, while the
#     horizontal forces look right, so that a test with lateral loads confirms the convention.
#     Eccentricity of the resultant under a footing comes out on the other side.  Compare the sums
#     with the loads in each direction.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    anastruct==1.7.0 numpy==2.4.6
cat > run.py <<'PY'
import logging

from anastruct import SystemElements

logging.disable(logging.WARNING)
system = SystemElements(EI=1e4, EA=1e6)
system.add_element([[0, 0], [0, 5]])
system.add_support_fixed(1)
system.point_load(2, Fx=3, Fy=-10)
system.solve()
head = system.get_node_displacements(2)
foot, again = system.reaction_forces[1], system.get_node_results_system(2)
table = system.get_node_results_system(1)
print(f"load Fx = 3, Fy = -10; the head moves by {head['ux']:.4f}, {head['uy']:.6f}")
print(f"reaction_forces: Fx = {foot.Fx:.2f}, Fy = {foot.Fy:.2f}; "
      f"sums {3 + foot.Fx:.2f}, {-10 + foot.Fy:.2f}")
print(f"get_node_results_system: Fx = {table['Fx']:.2f}, Fy = {table['Fy']:.2f}; the head moves by "
      f"{again['ux']:.4f}, {again['uy']:.6f}")
assert head["ux"] > 0 > head["uy"]
assert abs(foot.Fx + 3) < 1e-6 and abs(foot.Fy + 10) < 1e-6
assert abs(table["Fx"] - 3) < 1e-6 and abs(table["Fy"] + 10) < 1e-6
assert again["ux"] == -head["ux"] and again["uy"] == -head["uy"]
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
