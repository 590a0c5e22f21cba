#!/usr/bin/env bash
# casadi 3.8.2 (Ipopt): the best liner has a permeability of -9e-9 m/s, below its bound of 1e-9 m/s.
#
# Expected: a solution that Ipopt calls optimal keeps the bounds of its variables, as an interior point
#     method comes from their inner side.
# Seen: the liner of a basin with the smallest loss of water, which is proportional to its permeability k.
#     With 1e-9 <= k <= 1e-5 the result is k = -9.0e-9 m/s, and the loss is -10.9 m3 a day: the
#     basin gains water.  The status is "Solve_Succeeded".  With `honor_original_bounds` "yes", or
#     with log10(k) as the variable, k is 1e-9 and the loss 1.2 m3.
# Meaning: all bounds are widened by 1e-8 times the larger of 1 and their size, and since Ipopt 3.14
#     the result is not moved back.  Permeabilities, thicknesses of joints in m, or strengths in TPa
#     are of this size, and a root or logarithm of the result is NaN.  Scale variables to about one.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    casadi==3.8.2 numpy==2.4.6
cat > run.py <<'PY'
import casadi as ca

AREA, GRADIENT, DAY = 7e3, 2.0, 86400.0


def loss(k):
    """Loss of water through the liner in m3 a day."""
    return k * GRADIENT * AREA * DAY


def design(variable, permeability, bounds, start, **options):
    """Permeability of the liner with the smallest cost of water, and the status."""
    settings = {"ipopt.print_level": 0, "ipopt.sb": "yes", "print_time": 0}
    settings |= {f"ipopt.{name}": value for name, value in options.items()}
    solver = ca.nlpsol("liner", "ipopt", {"x": variable, "f": loss(permeability)}, settings)
    result = solver(x0=start, lbx=bounds[0], ubx=bounds[1])
    return float(ca.Function("k", [variable], [permeability])(result["x"])), solver.stats()["return_status"]


k, exponent = ca.MX.sym("k"), ca.MX.sym("exponent")
cases = {
    "default": design(k, k, (1e-9, 1e-5), 1e-6),
    "original bounds": design(k, k, (1e-9, 1e-5), 1e-6, honor_original_bounds="yes"),
    "exponent": design(exponent, 10**exponent, (-9, -5), -6),
}
for name, (value, status) in cases.items():
    print(f"{name}: k = {value:.3e} m/s, loss {loss(value):.2f} m3 a day, {status}")
    assert status == "Solve_Succeeded"
assert abs(cases["default"][0] + 9e-9) < 1e-11
assert abs(cases["original bounds"][0] - 1e-9) < 1e-11
assert abs(cases["exponent"][0] - 1e-9) < 1e-11
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
