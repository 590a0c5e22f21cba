#!/usr/bin/env bash
# obspy 1.5.1: a crosshole wave of 240 m/s runs at 250 m/s in SEG-Y, and at 238 m/s in Seismic Unix.
#
# Expected: a record with 48,000 readings a second is written and read with the same time step, or is refused; the two
#     formats store the step as a whole number of microseconds, so that at least the same one is stored.
# Seen: receivers 3 m apart, an arrival 12.5 ms later: 240.0 m/s.  Read from SEG-Y it is 250.0 m/s, since the step of
#     20.83 us has become 20 us, and from Seismic Unix 238.1 m/s with 21 us.  With 44,100 a second 247.4 and 236.6
#     m/s.  With 2 million a second, for bender elements, SEG-Y has a step of 1 s.  MiniSEED returns all of them.  No
#     message.
# Meaning: one format cuts the step off, the other one rounds it.  Small-strain shear moduli of the same test are 8.5
#     % too high or 1.6 % too low, after nothing but a change of format; sound cards have 48,000 and 44,100.  Choose a
#     rate that divides 10^6, or exchange such records as MiniSEED.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    obspy==1.5.1 numpy==2.4.6 scipy==1.17.1 setuptools==80.9.0
cat > run.py <<'PY'
import io

import numpy as np
from obspy import Stream, Trace, read

DISTANCE, SPEED = 3.0, 240.0  # m, m/s
OPTIONS = {"SEGY": {"data_encoding": 5}, "SU": {}, "MSEED": {}}  # 5: IEEE floats


def step(rate, form):
    """Time step in s of a record after it is written and read."""
    record = Trace(np.zeros(2000, dtype=np.float32))
    record.stats.sampling_rate = rate
    file = io.BytesIO()
    Stream([record]).write(file, format=form, **OPTIONS[form])
    file.seek(0)
    return read(file, format=form)[0].stats.delta


for rate, seen in ((48000.0, {"SEGY": 250.0, "SU": 238.095}), (44100.0, {"SEGY": 247.371, "SU": 236.616})):
    # readings between the two arrivals
    readings = DISTANCE / SPEED * rate
    for form in OPTIONS:
        delta = step(rate, form)
        speed = DISTANCE / (readings * delta)
        print(f"{rate:.0f} readings a second, {form}: step {1e6 * delta:.3f} us, speed {speed:.1f} m/s, "
              f"shear modulus {100 * (speed / SPEED) ** 2 - 100:+.1f} %")
        assert abs(speed - seen.get(form, SPEED)) < 0.01
print(f"2 million readings a second, SEGY: step {step(2e6, 'SEGY')} s")
assert step(2e6, "SEGY") == 1 and abs(step(2e6, "MSEED") - 5e-7) < 1e-12
PY
OMP_NUM_THREADS=1 venv/bin/python run.py 2> warnings.txt || { cat warnings.txt; exit 1; }
