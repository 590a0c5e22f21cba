#!/usr/bin/env bash
# fenics-ufl 2026.2.0: the equivalent stress of soil in plane strain is zero where the true one is 40 kPa.
#
# Expected: `dev` of a tensor of a plane problem subtracts a third of the trace, as a plane section is
#     a cut through a body of three dimensions, or the name says what it subtracts.
# Seen: a third of the trace for 3 x 3, and half of it for 2 x 2.  Stresses of 100 and 100 kPa in the plane
#     and 60 kPa normal to it (nu = 0.3) have a Mises stress of 40 kPa; sqrt(3/2 dev(s) : dev(s)) is 0.
#     In K0 loading, 100 and 42.9 kPa, it is 49.5 in place of 57.1 kPa.  The stress
#     K tr(e) + 2 G dev(e) for strains of 0.1 % in both directions is 16.7 in place of 19.2 kPa.
# Meaning: von Mises and Drucker-Prager laws and pictures of equivalent stress, written in a form
#     language as in the textbook, change with the dimension of the mesh.  Extend the tensor to 3 x 3 first.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    fenics-ufl==2026.2.0 numpy==2.4.6
cat > run.py <<'PY'
import numpy as np
import ufl
from ufl.algorithms.apply_algebra_lowering import apply_algebra_lowering


def number(expression):
    """Value of an expression of constants."""
    return apply_algebra_lowering(expression)(())


def mises(matrix):
    """Equivalent stress by the formula of the textbook."""
    deviator = ufl.dev(ufl.as_matrix(matrix))
    return np.sqrt(1.5 * number(ufl.inner(deviator, deviator)))


POISSON, YOUNG = 0.3, 1e4
BULK, SHEAR = YOUNG / 3 / (1 - 2 * POISSON), YOUNG / 2 / (1 + POISSON)
for name, x, y, seen in (
    ("equal", 100.0, 100.0, 0.0),
    ("K0", 100 * POISSON / (1 - POISSON), 100.0, 49.49),
):
    z = POISSON * (x + y)
    plane, body = mises([[x, 0.0], [0.0, y]]), mises([[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]])
    right = np.sqrt(((x - y) ** 2 + (y - z) ** 2 + (z - x) ** 2) / 2)
    print(f"{name}: stresses {x:.1f}, {y:.1f}, {z:.1f}; Mises {plane:.2f} of 2 x 2, {body:.2f} of 3 x 3")
    assert abs(body - right) < 1e-9 and abs(plane - seen) < 0.01

strain = ufl.as_matrix([[1e-3, 0.0], [0.0, 1e-3]])
law = BULK * ufl.tr(strain) * ufl.Identity(2) + 2 * SHEAR * ufl.dev(strain)
seen, right = number(law[0, 0]), (BULK + SHEAR / 3) * 2e-3
print(f"strains of 1e-3 in both directions: stress {seen:.2f} kPa, right {right:.2f}")
assert abs(seen - BULK * 2e-3) < 1e-9
assert abs(right - 2e-3 * YOUNG / 2 / (1 + POISSON) / (1 - 2 * POISSON)) < 1e-9
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
