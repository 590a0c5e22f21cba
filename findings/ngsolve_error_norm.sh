#!/usr/bin/env bash
# ngsolve 6.2.2608: the measured error of high-order elements is 40 % below the true one.
#
# Expected: `Integrate` chooses its order from the function, as the integrators of forms do, so that the
#     energy or the error of a solution of order p is exact, or close to it.
# Seen: on the unit square the integral of the square of a grid function of order 8 that holds x**8 is
#     0.0569, right is 0.0588.  For a Poisson problem with a known solution the measured L2 error is
#     1.33 times the true one at order 4, and 0.84, 0.60 and 0.61 times it at orders 6, 8 and 10; the
#     error of the gradient is 0.61 times the true one at order 4.  With order=40 all are converged.
# Meaning: the default is order 5 for every integrand.  Rates of convergence, effectivity of error
#     estimators and strain energies from coarse meshes of high order are those of seven points per
#     triangle, with errors up to a third either way.  Give `order=2 * p + 8`.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    ngsolve==6.2.2608
cat > run.py <<'PY'
from netgen.geom2d import unit_square
from ngsolve import (
    BND, H1, BilinearForm, GridFunction, Integrate, LinearForm, Mesh, cos, dx, grad, sin, sqrt, x, y,
)

coarse = Mesh(unit_square.GenerateMesh(maxh=2))
power = GridFunction(H1(coarse, order=8))
power.Set(x**8, bonus_intorder=10)
value, fine = Integrate(power * power, coarse), Integrate(power * power, coarse, order=16)
print(f"integral of x**16: default {value:.5f}, order 16 {fine:.5f}, right {1 / 17:.5f}")
assert abs(value - 0.05691) < 1e-4 and abs(fine - 1 / 17) < 1e-8

mesh = Mesh(unit_square.GenerateMesh(maxh=0.5))
right = sin(4 * x) * cos(3 * y)


def ratio(order):
    """L2 error of the Poisson problem by the default order over the one by order 40."""
    space = H1(mesh, order=order, dirichlet=".*")
    trial, test = space.TnT()
    solution = GridFunction(space)
    solution.Set(right, BND)
    form = BilinearForm(grad(trial) * grad(test) * dx).Assemble()
    load = LinearForm(25 * right * test * dx(bonus_intorder=12)).Assemble()
    rest = load.vec - form.mat * solution.vec
    solution.vec.data += form.mat.Inverse(space.FreeDofs()) * rest
    error = (solution - right) ** 2
    default, true = (sqrt(Integrate(error, mesh, **more)) for more in ({}, {"order": 40}))
    close = sqrt(Integrate(error, mesh, order=2 * order + 8))
    print(f"order {order}: measured error {default:.3e}, true {true:.3e}, ratio {default / true:.2f}")
    assert abs(close / true - 1) < 1e-3
    return default / true


for order, seen in ((4, 1.33), (6, 0.84), (8, 0.60), (10, 0.61)):
    assert abs(ratio(order) - seen) < 0.05
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
