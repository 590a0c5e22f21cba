#!/usr/bin/env bash
# fedoo 1.1.0: a block sinks into the ground on its right side, and carries a fifth less than it should.
#
# Expected: two equal blocks, one on top of the other, under a settlement of the top that is everywhere the same:
#     contact in all nodes, the same stress everywhere, left and right alike, by any of the searches for contact.
# Seen: blocks of 1 m x 1 m of 4 x 4 elements, E = 10 MPa, no Poisson's ratio, 10 mm, right are 50.0 kN and 5.00 mm in
#     the joint.  With `search_algorithm="search_nearest"` `Contact` gives 50.0 kN and 5.00 mm in all nodes.  With the
#     default "bucket" it gives 40.2 kN; the last two of five nodes of the upper block settle by 7.5 and 7.8 mm, and
#     lie 5 mm inside the lower one.  With 2 x 2 elements 42.3 kN, with 16 x 16 49.9 kN and 5.43 mm at the right end.
#     A block in the middle of ground of twice its width settles by 3.4 mm on the left and 6.2 mm on the right.
#     No message.
# Meaning: the nodes of both surfaces are sorted into square buckets, and the last bucket is left out: its nodes, at
#     the right end of a joint, stay free.  The load of a footing looks eccentric, and its settlement is too large.  Set
#     `search_algorithm="search_nearest"`, and check a symmetric case.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check fedoo==1.1.0 numpy==2.4.6 scipy==1.17.1
cat > run.py <<'PY'
import fedoo
import numpy as np

YOUNG, SETTLEMENT = 10e6, 0.01  # Pa, m


def press(search, below=4, above=4, width=1.0):
    """Force in kN and settlements in mm of the nodes of the upper block in the joint, from left to right."""
    fedoo.ModelingSpace("2D")
    ground = fedoo.mesh.rectangle_mesh(
        nx=below + 1, ny=below + 1, x_min=-width / 2, x_max=width / 2, y_min=0, y_max=1, elm_type="quad4"
    )
    block = fedoo.mesh.rectangle_mesh(
        nx=above + 1, ny=above + 1, x_min=-0.5, x_max=0.5, y_min=1, y_max=2, elm_type="quad4"
    )
    mesh = fedoo.Mesh.stack(ground, block)
    nodes, level = np.arange(mesh.n_nodes), mesh.nodes[:, 1]
    upper = nodes >= ground.n_nodes
    joint, top = nodes[upper & np.isclose(level, 1)], nodes[upper & np.isclose(level, 2)]
    joint = joint[np.argsort(mesh.nodes[joint, 0])]
    surface = fedoo.mesh.extract_surface(mesh.extract_elements(np.arange(ground.n_elements)))
    options = {} if search is None else {"search_algorithm": search}
    contact = fedoo.constraint.Contact(joint, surface, **options)
    contact.eps_n = 1e3 * YOUNG
    soil = fedoo.constitutivelaw.ElasticIsotrop(YOUNG, 0.0)
    solid = fedoo.Assembly.create(fedoo.weakform.StressEquilibrium(soil), mesh)
    problem = fedoo.problem.NonLinear(fedoo.Assembly.sum(solid, contact))
    problem.bc.add("Dirichlet", nodes, "DispX", 0)
    problem.bc.add("Dirichlet", nodes[np.isclose(level, 0)], "DispY", 0)
    problem.bc.add("Dirichlet", top, "DispY", -SETTLEMENT)
    problem.nlsolve(dt=0.1, tmax=1, update_dt=True, print_info=0)
    force = -problem.get_ext_forces("DispY")[top].sum() / 1e3
    return force, -1e3 * problem.get_disp("DispY")[joint]


right = YOUNG * SETTLEMENT / 2 / 1e3
for parts in (2, 4, 16):
    nearest, same = press("search_nearest", parts, parts)
    force, settlements = press(None, parts, parts)
    print(f"{parts} x {parts} elements: default {force:.2f} kN, nearest {nearest:.2f} kN, right {right:.2f} kN; "
          f"the joint settles by {settlements[0]:.2f} mm left and {settlements[-1]:.2f} mm right")
    assert abs(nearest / right - 1) < 1e-3 and np.allclose(same, 5, atol=0.01)
    assert abs(settlements[0] - 5) < 0.1 and settlements[-1] > 5.3
    assert parts == 16 or force < 0.9 * right

_, settlements = press(None, 8, 4, 2.0)
_, nearest = press("search_nearest", 8, 4, 2.0)
print(f"ground twice as wide: default {settlements.round(2)} mm, nearest {nearest.round(2)} mm")
assert np.allclose(nearest, nearest[::-1], atol=1e-3) and settlements[-1] / settlements[0] > 1.5
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
