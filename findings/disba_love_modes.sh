#!/usr/bin/env bash
# disba 0.7.0: three quarters of a dispersion curve are missing for Love waves in soft soil.
#
# Expected: the dispersion curves of soft layers (shear-wave velocities of 100 to 800 m/s, given in
#     km/s as documented) are complete, or a step of search that is too coarse is noticed.
# Seen: from 4 to 60 Hz the first higher Love mode has 7 points and starts with 123 m/s where it
#     has 27 points and starts with 103 m/s; its velocities are those of the third higher mode.  The
#     fundamental mode has 109.9 m/s at 60 Hz, right is 100.3 m/s (a layer on a rigid base).  No
#     message.  With dc=0.0005 the curves are complete.
# Meaning: the default step `dc` of 0.005 km/s is absolute, and steps over pairs of roots where modes
#     are close.  A profile of stiffness that is fitted to higher modes gets the wrong mode.  Set
#     `dc` to a thousandth of the smallest velocity, and look whether a smaller one changes the
#     number of points.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    disba==0.7.0 numpy==2.4.6
cat > run.py <<'PY'
import numpy as np
from disba import PhaseDispersion

# Thickness in km, velocities of P and S waves in km/s, density in g/cm3.
LAYERS = np.array([[0.005, 0.3, 0.1, 1.8], [0.010, 0.8, 0.3, 1.9], [0.0, 1.6, 0.8, 2.0]])
PERIODS = np.linspace(1 / 60, 1 / 4, 40)


def velocities(mode, **step):
    """Phase velocities of one Love mode in m/s."""
    return 1000 * PhaseDispersion(*LAYERS.T, **step)(PERIODS, mode=mode, wave="love").velocity


default = [velocities(mode) for mode in (0, 1)]
fine = [velocities(mode, dc=0.0005) for mode in (0, 1, 3)]
for mode in (0, 1):
    # At 60 Hz the waves stay in the upper layer of 5 m, as if it were on a rigid base.
    layer = 100 / np.sqrt(1 - ((mode + 0.5) * 100 / (2 * 5 * 60)) ** 2)
    print(f"mode {mode}: {len(default[mode])} points, at 60 Hz {default[mode][0]:.1f} m/s; dc=0.0005 "
          f"{len(fine[mode])}, {fine[mode][0]:.1f} m/s; layer {layer:.1f} m/s")
    assert abs(fine[mode][0] / layer - 1) < 2e-3
assert abs(default[0][0] - 109.9) < 0.2
assert len(default[1]) == len(fine[2]) == 7 and np.allclose(default[1], fine[2], atol=0.5)
assert len(fine[1]) == 27
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
