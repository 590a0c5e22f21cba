#!/usr/bin/env bash
# newton 1.8.0 (warp 1.19.0): a rock of 500 kg is one of 1500 kg.
#
# Expected: `add_body(mass=500)` makes a body of 500 kg, and a shape that is added gives it a form; or the shape's mass
#     replaces the given one, or both together are refused.
# Seen: with a cube of 1 m the body has 1500 kg, with four cubes 4500 kg: each shape adds its volume times a
#     density of 1000 kg/m3, the default.  The moment of inertia is 166.7 kgm2, of a cube of 1000 kg, in place of 83.3
#     kgm2; a given one of 83.3 kgm2 becomes 250 kgm2.  With a density of 0 for the shape the body has 500 kg and no
#     moment of inertia.  Right are mass and inertia together with `lock_inertia=True`, and the density of
#     500 kg/m3 without a mass.  No message for the default.
# Meaning: rocks and barges that are built from weighed masses fall on structures with three times their
#     energy, press with three times their weight, and answer a force with a third of the acceleration; a finer
#     outline of several shapes makes them heavier.  Compare `body_mass` with what was given.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    newton==1.8.0 warp-lang==1.19.0 numpy==2.4.6
cat > run.py <<'PY'
import math

import newton
import numpy as np

MASS, SIDE = 500.0, 1.0
INERTIA = MASS * SIDE**2 / 6  # of a cube about its centre


def body(parts=1, density=None, **given):
    """Mass and moment of inertia about a vertical axis of a body of cubes side by side, of one edge length."""
    builder = newton.ModelBuilder()
    number = builder.add_body(**given)
    settings = newton.ModelBuilder.ShapeConfig()
    if density is not None:
        settings.density = density
    for part in range(parts):
        place = ((part - (parts - 1) / 2) * SIDE, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)
        builder.add_shape_box(number, xform=place, hx=SIDE / 2, hy=SIDE / 2, hz=SIDE / 2, cfg=settings)
    inertia = np.array(builder.body_inertia[number]).reshape(3, 3)
    return builder.body_mass[number], inertia[2, 2]


water = 1000.0 * SIDE**3
CASES = {
    "mass": (body(mass=MASS), (MASS + water, water * SIDE**2 / 6)),
    "mass, four cubes": (body(parts=4, mass=MASS), (MASS + 4 * water, 4 * water * (16 + 1) * SIDE**2 / 12)),
    "mass and inertia": (
        body(mass=MASS, inertia=INERTIA * np.eye(3)),
        (MASS + water, INERTIA + water * SIDE**2 / 6),
    ),
    "mass, shape of density 0": (body(mass=MASS, density=0.0), (MASS, 0.0)),
    "mass and inertia locked": (body(mass=MASS, inertia=INERTIA * np.eye(3), lock_inertia=True), (MASS, INERTIA)),
    "density": (body(density=MASS / SIDE**3), (MASS, INERTIA)),
}
for name, (found, seen) in CASES.items():
    print(f"{name}: {found[0]:.1f} kg, {found[1]:.2f} kgm2")
    assert all(math.isclose(value, other, rel_tol=1e-5, abs_tol=1e-6) for value, other in zip(found, seen))
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
