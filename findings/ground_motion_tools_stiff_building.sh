#!/usr/bin/env bash
# ground-motion-tools 0.3.1: the acceleration spectrum of a stiff building is 1 % of the peak ground acceleration.
#
# Expected: the acceleration spectrum at short periods tends to the peak ground acceleration, since a stiff building
#     moves with the ground, and agrees with the pseudo acceleration at small damping; so does the measure `SA_T1`.
# Seen: a decaying sine of 1 Hz with 2.93 m/s2: `spectrum_acc` is 0.026 m/s2 at 0.01 s and 0.28 m/s2 at 0.1 s; right, by
#     an exact recurrence, is 2.93 and 3.05 m/s2, as the pseudo acceleration that is returned too.  At 6 s it is 3.25
#     m/s2 in place of 0.54 m/s2.  `SA_T1` and the spectrum intensity `ASI` follow: 0.51 in place of 1.6 m/s.
# Meaning: the first of the five results is the largest acceleration relative to the ground.  Low walls, dams and rigid
#     foundations get almost no seismic force, and flexible frames too much; record selection by ASI takes the wrong
#     records.  Use the fourth result, the pseudo acceleration, and take its value at the period for `SA_T1`.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    ground-motion-tools==0.3.1 numpy==2.4.6 scipy==1.17.1
cat > run.py <<'PY'
import numpy as np
from ground_motion_tools.enums import GMIMEnum
from ground_motion_tools.im import GMIntensityMeasures
from ground_motion_tools.spectrum import SPECTRUM_PERIOD, get_spectrum
from scipy.signal import cont2discrete

STEP, DAMPING = 0.002, 0.05  # s
time = np.arange(0.0, 20.0, STEP)
ground = 3.0 * np.sin(2 * np.pi * time) * np.exp(-0.1 * time)


def total_acceleration(period):
    """Largest acceleration of the mass of an oscillator, exact for a ground motion that is linear in each step."""
    frequency = 2 * np.pi / period
    system = np.array([[0.0, 1.0], [-(frequency**2), -2 * DAMPING * frequency]])
    force = np.array([[0.0], [-1.0]])
    out = system[1:], np.zeros((1, 1))  # -omega^2 u - 2 D omega v
    advance, now, observe, direct, _ = cont2discrete((system, force, *out), STEP, method="foh")
    state, largest = np.zeros((2, 1)), 0.0
    for value in ground:
        largest = max(largest, abs((observe @ state + direct * value).item()))
        state = advance @ state + now * value
    return largest


acceleration, _, _, pseudo, _ = get_spectrum(ground, STEP, DAMPING)
peak = np.abs(ground).max()
for period, seen in ((0.01, 0.026), (0.1, 0.276), (1.0, 17.57), (6.0, 3.245)):
    place = SPECTRUM_PERIOD.index(period)
    right = total_acceleration(period)
    print(f"{period} s: {acceleration[place]:.3f} m/s2, right {right:.3f}, pseudo {pseudo[place]:.3f}, peak {peak:.3f}")
    assert abs(acceleration[place] - seen) < 0.01 * seen + 1e-3
    assert abs(pseudo[place] / right - 1) < 0.1
assert acceleration[0] < 0.01 * peak and abs(pseudo[0] / peak - 1) < 0.01

measures = GMIntensityMeasures(ground, STEP)
found = measures.get_im([GMIMEnum.SA_T1, GMIMEnum.ASI], period=0.1)
within = [i for i, period in enumerate(SPECTRUM_PERIOD) if 0.1 <= period <= 0.5]
right = np.trapezoid(pseudo[within], np.array(SPECTRUM_PERIOD)[within])
print(f"SA_T1 at 0.1 s: {found['SA_T1'][0]:.3f} m/s2; ASI {found['ASI'][0]:.3f} m/s, pseudo {right:.3f} m/s")
assert found["SA_T1"][0] < 0.1 * peak and found["ASI"][0] < 0.4 * right
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
