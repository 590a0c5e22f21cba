#!/usr/bin/env bash
# lasio 0.32: a log of permeabilities in m/s is written as a log of zeros.
#
# Expected: a curve that is written to a LAS file and read again is the same to about six digits.
# Seen: permeabilities of 1.23e-9, 4.5e-10 and 1e-6 m/s are written as 0.00000 and read as 0.  8.4e-5 m/s
#     becomes 8e-5.  Values are written with five decimals ("%.5f"), whatever their size.
#     With `fmt="%.6e"` or a format for the column they stay.
# Meaning: permeability in m/s, compressibility in 1/kPa, strain and slowness in s/m lose their
#     digits or are gone, and zero is no value that a reader would take for missing.  Give `fmt`, or
#     use units in which the values are not small.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    lasio==0.32 numpy==2.4.6
cat > run.py <<'PY'
import io

import lasio
import numpy as np

PERMEABILITY = np.array([1.23e-9, 4.5e-10, 1e-6, 8.4e-5])


def again(**option):
    """The permeabilities after writing and reading."""
    log = lasio.LASFile()
    log.append_curve("DEPT", np.array([1.0, 1.5, 2.0, 2.5]), unit="m")
    log.append_curve("K", PERMEABILITY, unit="m/s")
    text = io.StringIO()
    log.write(text, version=2.0, **option)
    return lasio.read(text.getvalue())["K"]


default, scientific = again(), again(fmt="%.6e")
print(f"written {PERMEABILITY}, read {default}, with fmt='%.6e' {scientific}")
assert default.tolist() == [0.0, 0.0, 0.0, 8e-5]
assert np.allclose(scientific, PERMEABILITY, rtol=1e-6, atol=0)
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
