#!/usr/bin/env bash
# damflownet 0.1.3 (flownetpy): a dam that reaches half-way through the layer lets as much water pass as one on top of it.
#
# Expected: `embed_depth` of a dam is impervious and lengthens the way of the water, at least as
#     a cut-off wall of the same depth does.
# Seen: with a base of 10 m on a layer of 10 m (8 m of head, k = 1e-6 m/s) the discharge is
#     4.27e-6 m2/s with 0 m, 5 m and 9 m of embedment, and the heads are equal to the last
#     digit.  A cut-off of 5 m under the heel makes it 2.89e-6 m2/s.  The outline `dam_polygon`
#     has the embedment, the flow does not.
# Meaning: uplift and exit gradients of an embedded structure are those of one that stands on
#     the ground, half too much water or more in this case.  Model the embedment by cut-offs at heel
#     and toe.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    damflownet==0.1.3 numpy==2.4.6 matplotlib==3.11.2
cat > run.py <<'PY'
import numpy as np
from flownetpy import BoundaryConditions, CutoffConfig, Geometry, SolverConfig, run_seepage

BASE, LAYER, HEAD, PERMEABILITY = 10.0, 10.0, 8.0, 1e-6
SOLVER = SolverConfig(k=PERMEABILITY, tol=1e-6, max_iter=20000)


def seepage(embedded, cut_off=0.0):
    """Result under a dam on square cells of 1 m, for a depth of the base and one of a cut-off at the heel in m."""
    geometry = Geometry(
        dam_height=10, base_width=BASE, top_width=4, embed_depth=embedded, left_domain=20, right_domain=20,
        bottom_domain=LAYER, grid_x=1.0, grid_y=1.0,
    )
    walls = CutoffConfig(us_cutoff_width=0.5, us_cutoff_depth=cut_off)
    result = run_seepage(
        geometry, BoundaryConditions(us_head=HEAD, ds_head=0), walls, SOLVER, x_control=BASE / 2
    )
    assert result.converged
    return result


surface = seepage(0.0)
for depth in (5.0, 9.0):
    embedded = seepage(depth)
    print(f"embedded by {depth:.0f} m: {embedded.Q:.3e} m2/s, on the surface {surface.Q:.3e} m2/s")
    assert np.array_equal(embedded.h, surface.h) and embedded.Q == surface.Q
wall = seepage(0.0, 5.0)
print(f"cut-off of 5 m: {wall.Q:.3e} m2/s")
assert abs(wall.Q / surface.Q - 0.677) < 0.01
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
