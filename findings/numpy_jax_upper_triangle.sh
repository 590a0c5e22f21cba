#!/usr/bin/env bash
# numpy 2.4.6, scipy 1.17.1, jax 0.10.2: soil under shear has no shear stress, half of it, or all.
#
# Expected: `eigvalsh` is for symmetric matrices; a stress of which only the upper triangle was filled from six
#     components gives the right principal stresses, or an error, and the same in all libraries.
# Seen: 100, 50 and 20 kPa and a shear stress of 60 kPa in the upper triangle.  By hand 10, 20 and 140 kPa.  numpy and
#     scipy return 20, 50 and 100 kPa, jax 20, 36.0 and 114.1 kPa.  The same for `eigh`.  With the lower triangle
#     numpy and scipy are right, and jax is as before.  No message.
# Meaning: two libraries read the lower triangle alone, and one takes the mean of the matrix and its transpose, so
#     that it has half the shear stress.  The greatest shear stress is 40 or 47 in place of 65 kPa, and soil that
#     fails is safe.  Fill both triangles; a test with shear stress tells the cases apart, a triaxial one does not.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 jax==0.10.2 jaxlib==0.10.2
cat > run.py <<'PY'
import jax
import numpy as np
import scipy.linalg

jax.config.update("jax_enable_x64", True)

NORMAL, SHEAR = (100.0, 50.0, 20.0), 60.0  # kPa


def principal(shear):
    """Principal stresses in kPa by the circle of Mohr in the plane of the shear stress."""
    middle, radius = (NORMAL[0] + NORMAL[1]) / 2, np.hypot((NORMAL[0] - NORMAL[1]) / 2, shear)
    return np.sort([middle - radius, middle + radius, NORMAL[2]])


upper = np.diag(NORMAL)
upper[0, 1] = SHEAR
SOLVERS = {
    "numpy": np.linalg.eigvalsh,
    "scipy": scipy.linalg.eigvalsh,
    "jax": lambda stress: np.asarray(jax.numpy.linalg.eigvalsh(jax.numpy.array(stress))),
}
for name, solve in SOLVERS.items():
    found = {"upper": solve(upper), "lower": solve(upper.T), "both": solve(upper + np.triu(upper, 1).T)}
    print(f"{name}: " + ", ".join(f"{which} {stress.round(2)}" for which, stress in found.items()) +
          f" kPa, right {principal(SHEAR).round(2)} kPa")
    half = name == "jax"
    assert np.allclose(found["both"], principal(SHEAR))
    assert np.allclose(found["upper"], principal(SHEAR / 2 if half else 0.0))
    assert np.allclose(found["lower"], principal(SHEAR / 2 if half else SHEAR))
assert np.allclose(np.linalg.eigh(upper)[0], principal(0.0))
assert np.allclose(jax.numpy.linalg.eigh(upper)[0], principal(SHEAR / 2))
PY
OMP_NUM_THREADS=1 JAX_PLATFORMS=cpu venv/bin/python run.py
