#!/usr/bin/env bash
# medcoupling 9.15.0: the L2 norm of a field does not depend on the area on which it lives.
#
# Expected: `normL2` is the root of the integral of the square, and `normL1` the integral of the
#     absolute value, as the letters mean: 4.899 and 12 for a field of 2 on 3 m x 2 m.
# Seen: both are 2, the mean and the root mean square.  On 30 m x 20 m they are 2 again.  A field of 2 on
#     a tenth of the area and 0 elsewhere has the L2 norm 0.632.  `integral` of the same field is 12.
# Meaning: energies, residuals or errors of two programs differ by the root of the area or volume,
#     and an error of a local region "converges" when the mesh around it is made larger: a
#     far boundary at ten times the distance makes the same error under a footing ten times smaller
#     in the plane.  Multiply by the root of the measure before comparing.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    medcoupling==9.15.0 numpy==2.4.6
cat > run.py <<'PY'
import medcoupling
import numpy as np


def norms(width, height, share=1.0):
    """Norms and integral of a field of 2 on the first share of a rectangle of elements of 1 m."""
    grid = medcoupling.MEDCouplingCMesh()
    grid.setCoords(*(medcoupling.DataArrayDouble(np.arange(n + 1.0)) for n in (width, height)))
    mesh = grid.buildUnstructured()
    count = width * height
    values = np.where(np.arange(count) < share * count, 2.0, 0.0)
    field = medcoupling.MEDCouplingFieldDouble(medcoupling.ON_CELLS)
    field.setMesh(mesh)
    field.setArray(medcoupling.DataArrayDouble(values))
    field.setName("field")
    field.checkConsistencyLight()
    return field.normL1()[0], field.normL2()[0], field.integral(0, True), (2.0**2 * share * count) ** 0.5


for arguments, seen in {(3, 2): (2, 2, 12), (30, 20): (2, 2, 1200), (30, 20, 0.1): (0.2, 0.4**0.5, 120)}.items():
    l1, l2, integral, right = norms(*arguments)
    print(f"{arguments}: L1 {l1:.3f}, L2 {l2:.3f}, integral {integral:.0f}, root of the integral {right:.3f}")
    assert np.allclose((l1, l2, integral), seen)
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
