#!/usr/bin/env bash
# scipy 1.17.1: the bending moment of a pile is 37 % too large if its deflection is in m, and right if it is in mm.
#
# Expected: `solve_bvp` ("converged to the desired accuracy", `tol` of 1e-3) is right to some parts in a thousand for
#     a pile on springs, in any unit of the deflection, and refines the mesh that it is given until it is.
# Seen: a pile of 60 m (EI = 2e6 kN m2, 20 MPa of subgrade reaction, 300 kN on the free head), four equations of
#     first order and 3, 5 or 11 equidistant nodes to begin with.  In m: no node is added, the largest moment is 990,
#     593 and 444 kN m, right is 433 kN m; with 3 nodes the deflection of the head is 16 % too large.  In mm: 15 or
#     16 nodes and 433 kN m.  All end with success.
# Meaning: the residual is divided by 1 + |f|, as the documentation of `tol` says: it is an absolute one as long as
#     slopes and curvatures are far below 1, as they are in m.  Give the unknowns in a unit in which they are above
#     1, and compare two initial meshes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1
cat > run.py <<'PY'
import numpy as np
from scipy.integrate import solve_bvp

STIFFNESS, SPRINGS, FORCE, LENGTH = 2e6, 2e4, 300.0, 60.0  # kN m2, kN/m2, kN, m


def pile(unit, parts):
    """Head deflection in m, largest moment in kN m and number of nodes; the unknown is the deflection times `unit`."""
    depth = np.linspace(0, LENGTH, parts)
    solution = solve_bvp(
        lambda z, y: np.vstack([y[1], y[2], y[3], -SPRINGS / STIFFNESS * y[0]]),
        lambda top, tip: np.array([top[2], top[3] - FORCE / STIFFNESS * unit, tip[2], tip[3]]),
        depth,
        np.zeros((4, parts)),
    )
    assert solution.success and solution.rms_residuals.max() < 1e-3
    deflection, _, curvature, _ = solution.sol(np.linspace(0, LENGTH, 2001)) / unit
    return deflection[0], STIFFNESS * np.abs(curvature).max(), solution.x.size


# Hetenyi's long beam with a force on its end
rate = (SPRINGS / STIFFNESS / 4) ** 0.25
right = np.array([2 * FORCE * rate / SPRINGS, FORCE / rate * np.exp(-np.pi / 4) * np.sin(np.pi / 4)])
print(f"right: {1e3 * right[0]:.3f} mm, {right[1]:.1f} kN m; {rate * LENGTH:.1f} characteristic lengths")
for unit, name in ((1.0, "m"), (1e3, "mm")):
    for parts, moment in ((3, 990.5), (5, 592.6), (11, 444.1)):
        *found, nodes = pile(unit, parts)
        print(f"in {name}, {parts} nodes: {1e3 * found[0]:.3f} mm, {found[1]:.1f} kN m with {nodes} nodes")
        if name == "m":
            assert nodes == parts and abs(found[1] / moment - 1) < 1e-3
        else:
            assert nodes > 11 and np.allclose(found, right, rtol=1e-3)
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
