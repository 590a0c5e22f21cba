#!/usr/bin/env bash
# obspy 1.5.1: a spectrum that is smoothed grows with the frequency and with the length of the record.
#
# Expected: `konno_ohmachi_smoothing` is a weighted mean over neighbours: a constant spectrum stays as
#     it is, and a longer record has the same smoothed spectrum.
# Seen: the constant 1 becomes 2.4, 12 and 48 at 1, 5 and 20 Hz for a record of 20 s, and 4.8, 24 and 97
#     for one of 40 s.  With `normalize=True`, which is not the default, it is 1.0.  The default divides
#     by the width of the window in the logarithm of the frequency, on frequencies that are
#     equally spaced, so that their number in the window counts.
# Meaning: ratios of two spectra of the same length are right, which hides it.  Amplitudes of Fourier
#     spectra, their decay (kappa), corner frequencies and sums over records of different length are
#     wrong: a fall with the second power of the frequency becomes one with the first.  Give `normalize=True`.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    obspy==1.5.1 numpy==2.4.6 scipy==1.17.1 setuptools==65.5.0
cat > run.py <<'PY'
import numpy as np
from obspy.signal.konnoohmachismoothing import konno_ohmachi_smoothing

RESULTS = {20: (2.41, 12.07, 48.28), 40: (4.83, 24.14, 96.56)}

for duration, seen in RESULTS.items():
    frequency = np.fft.rfftfreq(100 * duration, 0.01)
    constant = np.ones_like(frequency)
    at = [int(np.argmin(abs(frequency - value))) for value in (1.0, 5.0, 20.0)]
    default = konno_ohmachi_smoothing(constant, frequency, bandwidth=40)[at]
    mean = konno_ohmachi_smoothing(constant, frequency, bandwidth=40, normalize=True)[at]
    print(f"{duration} s: {np.round(default, 2)}, with normalize=True {np.round(mean, 6)}")
    assert np.allclose(default, seen, atol=0.01) and np.allclose(mean, 1)

# A Brune spectrum with a corner at 2 Hz falls with the second power of the frequency above it.
spectrum = 1 / (1 + (frequency / 2) ** 2)
low, high = (int(np.argmin(abs(frequency - value))) for value in (8.0, 25.0))
for option, seen in (({}, -0.95), ({"normalize": True}, -1.95)):
    smooth = konno_ohmachi_smoothing(spectrum, frequency, bandwidth=40, **option)
    slope = np.log(smooth[high] / smooth[low]) / np.log(frequency[high] / frequency[low])
    print(f"{option or 'default'}: slope above the corner {slope:.2f}")
    assert abs(slope - seen) < 0.03
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
