#!/usr/bin/env bash
# ngsolve 6.2.2608: a block that turns to the left turns to the right in another space of the same displacements.
#
# Expected: `grad` of a displacement has one convention, du_i / dx_j in row i, for `VectorH1` and for `H1` with
#     `dim=2`, which hold the same functions.
# Seen: a block turned by 30 degrees: the deformation gradient `Id(2) + grad(u)` turns by +30 degrees with `VectorH1`
#     and by -30 degrees with `H1(dim=2)`.  Simple shear of 0.5: the Green strains xx and yy are 0 and 0.125 with the
#     first, right, and 0.125 and 0 with the other.  The energy of rock with level beds (50 and 5 MPa, G = 2 MPa) is
#     0.289 and 0.641 MJ/m3.  The linear strain and the energies of isotropic laws are the same in both.
#     `Grad`, with a capital letter, is right in both.  No message.
# Meaning: linear and isotropic checks pass, and then a law for bedded rock, reinforced soil or a follower load
#     sees the material turned against the rotation, only because of another space.  Use `Grad`, and check one
#     rotation.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    ngsolve==6.2.2608 numpy==2.4.6
cat > run.py <<'PY'
import math

import numpy as np
from netgen.geom2d import unit_square
from ngsolve import CF, H1, GridFunction, Grad, Id, Mesh, VectorH1, grad, x, y

MESH = Mesh(unit_square.GenerateMesh(maxh=0.5))
SPACES = {"VectorH1": VectorH1(MESH, order=1), "H1(dim=2)": H1(MESH, order=1, dim=2)}
POINT = MESH(0.3, 0.4)
ALONG, ACROSS, SHEAR_MODULUS = 50.0, 5.0, 2.0  # MPa
ANGLE, SHEAR = math.pi / 6, 0.5


def gradient(space, displacement, operator):
    """Deformation gradient of a displacement at a point of the block."""
    moved = GridFunction(space)
    moved.Set(CF(displacement))
    return np.reshape((Id(2) + operator(moved))(POINT), (2, 2))


def green(tensor):
    """Green strain of a deformation gradient."""
    return (tensor.T @ tensor - np.eye(2)) / 2


def energy(strain):
    """Energy of rock with level beds in MJ/m3."""
    return (ALONG * strain[0, 0] ** 2 + ACROSS * strain[1, 1] ** 2) / 2 + 2 * SHEAR_MODULUS * strain[0, 1] ** 2


turned = (math.cos(ANGLE) - 1) * x - math.sin(ANGLE) * y, math.sin(ANGLE) * x + (math.cos(ANGLE) - 1) * y
right = np.array([[1.0, SHEAR], [0.0, 1.0]])
for name, space in SPACES.items():
    for operator in (grad, Grad):
        rotation = gradient(space, turned, operator)
        angle = math.degrees(math.atan2(rotation[1, 0], rotation[0, 0]))
        sheared = gradient(space, (SHEAR * y, 0 * x), operator)
        strain = green(sheared)
        print(f"{name}, {operator.__name__}: rotation {angle:+.1f} degrees, right +30.0; Green strains xx, yy "
              f"{strain[0, 0]:.3f}, {strain[1, 1]:.3f}, right 0.000, {SHEAR**2 / 2:.3f}; energy {energy(strain):.3f} "
              f"MJ/m3, right {energy(green(right)):.3f}")
        transposed = name != "VectorH1" and operator is grad
        assert math.isclose(angle, -30 if transposed else 30, rel_tol=1e-9)
        assert np.allclose(sheared, right.T if transposed else right, atol=1e-12)
        assert np.allclose(sheared + sheared.T, right + right.T, atol=1e-12)
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
