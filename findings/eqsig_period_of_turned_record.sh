#!/usr/bin/env bash
# eqsig 1.2.17: an instrument that was installed the other way round records another period of the ground.
#
# Expected: `im.max_fa_period` is "the period corresponding to the maximum value in the Fourier amplitude spectrum", so
#     that a record, the same record with the other sign, and the record run backwards have one period.
# Seen: eight random records with 0.5 to 8 Hz.  In all of them the three periods differ, in three by more than a half:
#     0.20 and 0.32 s, 0.36 and 1.02 s, 0.22 and 0.48 s.  In seven the record as it stands has another period than the
#     largest amplitude.  No message.
# Meaning: the spectrum is complex, and the largest of complex numbers is the one with the largest real part: the result
#     depends on the phase, hence on the sign and on the start of the record.  Predominant periods for a soil profile or
#     for selecting records are near the right ones, or at another peak.  Take the largest of abs(fa_spectrum).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    eqsig==1.2.17 numpy==2.3.1 scipy==1.16.3
cat > run.py <<'PY'
import eqsig
import numpy as np
from scipy.signal import butter, sosfiltfilt

STEP = 0.01
time = np.arange(0, 40.95, STEP)
passed = butter(2, [0.5, 8], "bandpass", fs=1 / STEP, output="sos")
differ = far = wrong = 0
for seed in range(8):
    noise = np.random.default_rng(seed).standard_normal(time.size)
    record = sosfiltfilt(passed, noise * np.exp(-(((time - 15) / 5) ** 2)))
    signals = [eqsig.AccSignal(values, STEP) for values in (record, -record, record[::-1])]
    periods = np.array([eqsig.im.max_fa_period(signal) for signal in signals])
    spectra = [np.abs(signal.fa_spectrum) for signal in signals]
    right = [1 / signal.fa_frequencies[spectrum.argmax()] for signal, spectrum in zip(signals, spectra)]
    print(f"record {seed}: {periods[0]:.3f} s, other sign {periods[1]:.3f} s, backwards {periods[2]:.3f} s; "
          f"largest amplitude {right[0]:.3f} s")
    assert np.allclose(right, right[0])
    differ += np.ptp(periods) > 1e-3 * right[0]
    far += periods.max() > 1.5 * periods.min()
    wrong += abs(periods[0] / right[0] - 1) > 1e-3
print(f"periods differ in {differ} records, by more than a half in {far}; {wrong} are not the largest amplitude's")
assert (differ, far, wrong) == (8, 3, 7)
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
