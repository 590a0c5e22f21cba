#!/usr/bin/env bash
# obspy 1.5.1: the peak of a resonance is a hollow between two peaks after smoothing, at another frequency.
#
# Expected: `obspy.signal.util.smooth`, a central moving average, with one value on each side takes the mean of three
#     values: a peak of 10 at 2.0 Hz becomes 6.32 at 2.0 Hz.
# Seen: an oscillator with 5 % damping, every 0.2 Hz.  The smoothed curve has 6.36 at 1.8 Hz, 4.49 at 2.0 Hz and 6.10
#     at 2.2 Hz.  With two and three values on each side the largest value is at 1.8 and 1.6 Hz.  A single blow of 1
#     in a record of zeros is zero after smoothing, and a half before and after.  No message.
# Meaning: the value itself has no weight in its own average.  Resonances of soil and of structures move by a step or
#     two, and two close modes appear where one is.  The same function smooths attributes like the central frequency
#     and the bandwidth.  Take `numpy.convolve` with equal weights.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    obspy==1.5.1 numpy==2.4.6 scipy==1.17.1 setuptools==80.9.0
cat > run.py <<'PY'
import numpy as np
from obspy.signal.util import smooth

RESONANCE, DAMPING, STEP = 2.0, 0.05, 0.2  # Hz, Hz

frequencies = STEP * np.arange(1, 51)
ratio = frequencies / RESONANCE
amplification = 1 / np.hypot(1 - ratio**2, 2 * DAMPING * ratio)
peak = amplification.argmax()
assert abs(frequencies[peak] - RESONANCE) < 1e-9

for values in (1, 2, 3):
    found = smooth(amplification, values)
    weights = np.ones(2 * values + 1)
    right = np.convolve(amplification, weights / weights.sum(), "same")
    weights[values] = 0
    hollow = np.convolve(amplification, weights / weights.sum(), "same")
    inner = slice(2 * values, -2 * values)
    print(f"{values} on each side: largest {found.max():.2f} at {frequencies[found.argmax()]:.1f} Hz, at {RESONANCE} "
          f"Hz {found[peak]:.2f}, one step later {found[peak + 1]:.2f}; mean of all values {right[peak]:.2f}")
    assert np.allclose(found[inner], hollow[inner])
    assert found[peak] < 0.9 * right[peak] and found.argmax() != peak
assert smooth(amplification, 1)[peak] < min(smooth(amplification, 1)[[peak - 1, peak + 1]])
blow = np.zeros(11)
blow[5] = 1
print(f"a blow: {smooth(blow, 1)[3:8]}")
assert np.allclose(smooth(blow, 1)[3:8], [0, 0.5, 0, 0.5, 0])
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
