#!/usr/bin/env bash
# trimesh 5.2.0: a tunnel that has converged by 50 mm shows 15 mm or nothing after the scans are registered.
#
# Expected: `registration.icp` and `registration.procrustes` move and turn the second survey rigidly onto the first
#     one, and the distances that remain are the deformation.
# Seen: a tunnel with a radius of 5 m whose lining has moved inwards by 50 mm everywhere.  Twelve prisms a ring: one
#     ring shows 0 mm of convergence after `procrustes`, three rings 5 m apart 20 mm.  Two scans of 4000 points on
#     30 m, `icp`: 15 mm.  With scale=False all show 50 mm.  No message: the transformation has a determinant of
#     1.031, 1.018 and 1.021.
# Meaning: a scale and a mirror image are allowed by default, in `icp` through its further arguments; a ring is
#     blown up until it fits.  Convergence, the settlement of a dam and the closing of a joint are measured too
#     small, or not at all.  Give scale=False and reflection=False, and print the determinant.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    trimesh==5.2.0 numpy==2.4.6 scipy==1.17.1
cat > run.py <<'PY'
import numpy as np
from trimesh.registration import icp, procrustes

RADIUS, CONVERGENCE = 5.0, 0.05  # m
RIGID = {"scale": False, "reflection": False}


def tunnel(radius, angle, along):
    """Points of the lining."""
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle), along])


def prisms(radius, rings):
    """Twelve prisms in each ring, rings 5 m apart."""
    ring, angle = np.meshgrid(5.0 * np.arange(rings), np.radians(np.arange(0, 360, 30)))
    return tunnel(radius, angle.ravel(), ring.ravel())


def scan(radius, seed):
    """Points of a scan of 30 m."""
    random = np.random.default_rng(seed)
    return tunnel(radius, random.uniform(0, 2 * np.pi, 4000), random.uniform(0, 30, 4000))


def shown(register, before, after, **options):
    """Mean convergence in m after the registration, and the determinant of the transformation."""
    matrix, moved, _ = register(after, before, **options)
    return RADIUS - np.hypot(moved[:, 0], moved[:, 1]).mean(), np.linalg.det(matrix[:3, :3])


inside = RADIUS - CONVERGENCE
for rings in (1, 3):
    surveys = prisms(RADIUS, rings), prisms(inside, rings)
    found, determinant = shown(procrustes, *surveys)
    rigid, _ = shown(procrustes, *surveys, **RIGID)
    # the ratio of the distances from the centre, root mean square
    along = np.var(surveys[0][:, 2])
    scale = np.sqrt((RADIUS**2 + along) / (inside**2 + along))
    print(f"{rings} rings: convergence {1e3 * found:.1f} mm, rigid {1e3 * rigid:.1f} mm, right "
          f"{1e3 * CONVERGENCE:.1f} mm; determinant {determinant:.3f}")
    assert abs(found - (RADIUS - scale * inside)) < 1e-6 and abs(rigid - CONVERGENCE) < 1e-6
    assert abs(determinant - scale**3) < 1e-6

scans = scan(RADIUS, 1), scan(inside, 2)
found, determinant = shown(icp, *scans, max_iterations=50)
rigid, _ = shown(icp, *scans, max_iterations=50, **RIGID)
print(f"scans: convergence {1e3 * found:.1f} mm, rigid {1e3 * rigid:.1f} mm, right {1e3 * CONVERGENCE:.1f} mm; "
      f"determinant {determinant:.3f}")
assert found < 0.03 and abs(rigid - CONVERGENCE) < 0.001
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
