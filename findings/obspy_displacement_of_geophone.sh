#!/usr/bin/env bash
# obspy 1.5.1: a geophone that moved by 1 mm says 0.5 mm, or 0.06 mm.
#
# Expected: `remove_response(output="DISP")` and `remove_response(output="VEL")` followed by `integrate`
#     find the same displacement, as the instrument is the same.
# Seen: a geophone of 4.5 Hz (28.8 V per m/s, 70 % of damping, 200 values a second) and bursts of 1 mm.
#     At 2 Hz both find 1.00 mm.  At 1 Hz "DISP" finds 0.49 mm, at 0.5 Hz 0.06 mm and at 0.2 Hz 0.004 mm,
#     where velocities that are integrated give 1.00, 0.99 and 0.92 mm (the record is tapered).  The
#     default water level of 60 dB is counted from the largest gain to the wanted unit.  A displacement
#     has it at 100 Hz, so that the limit is met at 1.3 Hz, and that of a velocity at 0.14 Hz.  With
#     water_level=None "DISP" is right.  No message.
# Meaning: vibrations of buildings, piles and slopes below the corner of the instrument are too small by a
#     factor, and a higher sampling rate makes it worse.  Ask for the velocity and integrate, or give
#     `pre_filt` and no water level.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    obspy==1.5.1 numpy==2.3.1 scipy==1.16.3
cat > run.py <<'PY'
import numpy as np
import obspy
from obspy.core.inventory.response import Response

RATE, SIZE, CORNER, DAMPING, GAIN = 200.0, 12000, 2 * np.pi * 4.5, 0.7, 28.8
time = np.arange(SIZE) / RATE
root = CORNER * np.sqrt(DAMPING**2 - 1 + 0j)
geophone = Response.from_paz(
    zeros=[0, 0],
    poles=[-DAMPING * CORNER + root, -DAMPING * CORNER - root],
    stage_gain=GAIN,
    stage_gain_frequency=30.0,
    input_units="M/S",
    output_units="V",
)


def reading(velocity):
    """Voltage of the geophone, exact for a record that repeats itself."""
    s = 2j * np.pi * np.fft.rfftfreq(SIZE, 1 / RATE)
    response = GAIN * s**2 / (s**2 + 2 * DAMPING * CORNER * s + CORNER**2)
    return np.fft.irfft(np.fft.rfft(velocity) * response, SIZE)


seen = {}
for frequency in (2.0, 1.0, 0.5, 0.2):
    moved = np.exp(-(((time - 30) / 6) ** 2)) * np.cos(2 * np.pi * frequency * (time - 30))
    trace = obspy.Trace(reading(np.gradient(1e-3 * moved, 1 / RATE)), {"sampling_rate": RATE})
    trace.stats.response = geophone
    direct = trace.copy().remove_response(output="DISP").data
    without = trace.copy().remove_response(output="DISP", water_level=None).data
    integral = trace.copy().remove_response(output="VEL").integrate().data
    seen[frequency] = [1e3 * np.ptp(x[2000:-2000]) / 2 for x in (direct, integral, without)]
    print(
        f"{frequency} Hz, 1 mm: DISP {seen[frequency][0]:.4f} mm, VEL and integrate {seen[frequency][1]:.4f}",
        end="",
    )
    print(f" mm, DISP without water level {seen[frequency][2]:.4f} mm")
found = np.array(list(seen.values()))
assert np.allclose(found[:, 0], [1.0, 0.494, 0.0627, 0.0042], rtol=0.04)
assert np.allclose(found[:, 1:], 1.0, atol=0.1)
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
