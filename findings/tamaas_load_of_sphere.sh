#!/usr/bin/env bash
# tamaas 2.9.0: by one of four solvers for contact with friction, a sphere under any load touches nothing.
#
# Expected: `Kato`, `Condat`, `PolonskyKeerTan` and `BeckTeboulle` solve the same problem and are called alike,
#     `solver(model, surface, tolerance, mu).solve(p0)`: `p0` is the mean traction for all of them.
# Seen: a sphere of radius 10 m on ground with E = 1 MPa, a cell of 2 m x 2 m, a mean pressure of 2 kPa.  Three solvers
#     find a largest pressure of 30.4 kPa, Hertz has 30.2 kPa.  `BeckTeboulle` returns no traction at all, with an
#     error of 0, for 2 kPa and for 1 MPa.  With p0 = (0, 0, -0.02) it finds a mean pressure of 10.69 kPa, and the three
#     others find a mean displacement of -0.02 m under 10.69 kPa.  With 0.001 in x the middle moves by -0.001 m.
# Meaning: p0 of `BeckTeboulle` is a distance in metres under the name of a pressure: upwards, and against x.  A
#     positive load lifts the body off, without a message; a negative one gives pressures that look right and are
#     proportional to E.  Use one of the others, or search the distance that belongs to the load.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check tamaas==2.9.0 numpy==2.4.6 scipy==1.17.1
cat > run.py <<'PY'
import numpy as np
import tamaas
from tamaas.utils import hertz_surface

tamaas.set_log_level(tamaas.LogLevel.error)
SIZE, POINTS, RADIUS, YOUNG, POISSON, FRICTION = 2.0, 32, 10.0, 1.0, 0.5, 0.3  # m, MPa
LOADS = (tamaas.Kato, tamaas.Condat, tamaas.PolonskyKeerTan)
surface = hertz_surface([SIZE, SIZE], [POINTS, POINTS], RADIUS)


def solve(solver, given):
    """Error that the solver returns, mean tractions, largest pressure in MPa and displacements in m."""
    model = tamaas.ModelFactory.createModel(
        tamaas.model_type.surface_2d, [SIZE, SIZE], [POINTS, POINTS]
    )
    model.E, model.nu = YOUNG, POISSON
    contact = solver(model, surface, 1e-9, FRICTION)
    contact.max_iter = 20000
    error = contact.solve(given)
    return error, model.traction.mean((0, 1)), model.traction[..., 2].max(), model.displacement


def hertz(mean):
    """Largest pressure of a sphere in MPa for a mean pressure on the cell."""
    force = mean * SIZE**2
    modulus = YOUNG / (1 - POISSON**2)
    radius = (3 * force * RADIUS / (4 * modulus)) ** (1 / 3)
    return 3 * force / (2 * np.pi * radius**2)


for mean in (0.002, 1.0):
    error, tractions, largest, _ = solve(tamaas.BeckTeboulle, [0, 0, mean])
    print(f"BeckTeboulle, {1e3 * mean:.0f} kPa: error {error}, largest pressure {1e3 * largest:.2f} kPa")
    assert error == 0 and not tractions.any() and largest == 0
for solver in LOADS:
    _, tractions, largest, _ = solve(solver, [0, 0, 0.002])
    print(f"{solver.__name__}, 2 kPa: largest pressure {1e3 * largest:.2f} kPa, Hertz {1e3 * hertz(0.002):.2f} kPa")
    assert abs(tractions[2] / 0.002 - 1) < 3e-3 and abs(largest / hertz(0.002) - 1) < 0.02

_, tractions, largest, moved = solve(tamaas.BeckTeboulle, [0, 0, -0.02])
print(f"BeckTeboulle, -0.02: mean pressure {1e3 * tractions[2]:.3f} kPa, largest {1e3 * largest:.2f} kPa, "
      f"mean displacement {moved[..., 2].mean():.5f} m")
assert abs(moved[..., 2].mean() + 0.02) < 1e-6
for solver in LOADS:
    _, _, same, moved = solve(solver, [0, 0, tractions[2]])
    print(f"{solver.__name__}, {1e3 * tractions[2]:.3f} kPa: largest {1e3 * same:.2f} kPa, "
          f"mean displacement {moved[..., 2].mean():.5f} m")
    assert abs(same / largest - 1) < 1e-3 and abs(moved[..., 2].mean() + 0.02) < 1e-4

_, tractions, _, moved = solve(tamaas.BeckTeboulle, [0.001, 0, -0.02])
middle = moved[POINTS // 2, POINTS // 2, 0]
print(f"BeckTeboulle, 0.001 in x: the middle moves by {middle:.5f} m, mean traction {1e3 * tractions[0]:.3f} kPa")
assert abs(middle + 0.001) < 1e-5 and tractions[0] < 0
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
