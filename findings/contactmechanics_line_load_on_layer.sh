#!/usr/bin/env bash
# ContactMechanics 1.8.3: in the plane, a layer of 1 m on rock is as soft as ground without end.
#
# Expected: `PeriodicFFTElasticHalfSpace(..., thickness=h)` is "an elastic layer of thickness h on top of a rigid flat"
#     for one and for two grid directions: strips of pressure settle alike in both, and a uniform pressure settles
#     by p h / E_oed.
# Seen: E = 10 MPa, nu = 0.3, h = 1 m, a period of 64 m.  A pressure of cos(2 pi x / 64) kPa on a grid of 64 x 64
#     settles by 0.0743 mm, and a uniform one of 1 kPa by 0.0743 mm, both right.  On a grid of 64 points in a line they
#     settle by 1.854 mm, 25 times as much, for h = 1 m, 100 m and no thickness alike.  No message.
# Meaning: in one direction the thickness is stored and not used.  Strip footings, rollers and walls on a thin layer get
#     the pressures and the settlement of the half-space; a sweep of the thickness shows no effect, and looks like a
#     result.  Use two directions.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    ContactMechanics==1.8.3 SurfaceTopography==1.27.1 muGrid==1.6.1 NuMPI==0.18.1 numpy==2.4.6 scipy==1.17.1
cat > run.py <<'PY'
import numpy as np
from ContactMechanics import PeriodicFFTElasticHalfSpace

POINTS, PERIOD, YOUNG, POISSON = 64, 64.0, 1e4, 0.3  # m, kPa
oedometer = YOUNG * (1 - POISSON) / ((1 + POISSON) * (1 - 2 * POISSON))
halfspace = np.pi * YOUNG / (1 - POISSON**2) / PERIOD
wave = np.cos(2 * np.pi * np.arange(POINTS) / POINTS)


def settlements(directions, thickness):
    """Settlement in m under the crest of a wave of 1 kPa and under a uniform pressure of 1 kPa."""
    shape = (POINTS,) * directions
    ground = PeriodicFFTElasticHalfSpace(shape, YOUNG, (PERIOD,) * directions, thickness=thickness, poisson=POISSON)
    pressures = (wave.reshape((-1,) + (1,) * (directions - 1)), 1.0)
    return [
        -ground.evaluate_disp(np.ones(shape) * pressure * ground.area_per_pt).ravel()[0] for pressure in pressures
    ]


for thickness in (1.0, 100.0, None):
    plane, strips = settlements(1, thickness), settlements(2, thickness)
    print(
        f"thickness {thickness}: wave {1e3 * plane[0]:.4f} mm in the plane, {1e3 * strips[0]:.4f} mm on a surface; "
        f"uniform {1e3 * plane[1]:.4f} and {1e3 * strips[1]:.4f} mm"
    )
    assert np.allclose(plane, 1 / halfspace, rtol=1e-9)
    if thickness is not None:
        print(f"right: {1e3 * thickness / oedometer:.4f} mm for the uniform pressure")
        assert abs(strips[1] * oedometer / thickness - 1) < 1e-9
    if thickness == 1.0:
        assert 0.99 < strips[0] * oedometer / thickness < 1.01
        assert abs(plane[0] / strips[0] - 24.94) < 0.02
    if thickness is None:
        assert np.allclose(strips[0], plane[0], rtol=1e-9)
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
