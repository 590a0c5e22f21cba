#!/usr/bin/env bash
# welly 0.5.2: readings at a list of depths are doubled after the first depth that is between two samples.
#
# Expected: `Curve.read_at` of a list gives one value for each depth, interpolated where there is no sample.
# Seen: a curve that is twice the depth, with samples each 0.5 m.  At 1.0, 1.25, 2.0, 3.0 and 4.0 m it gives
#     eight values, 2, 2.5, 4, 4, 6, 6, 8, 8 in place of 2, 2.5, 4, 6 and 8.  Beside their depths the last two
#     stand as 4 and 6. One by one they are right, and so is a list of samples alone.  No message.
# Meaning: a flag for "not found" is not reset, so that each later sample comes a second time, by interpolation.
#      In a zip or a loop the strength of a shallow depth goes to a deeper one, which is unsafe below a crust.
#      Read the depths one by one, or compare the lengths.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    welly==0.5.2 numpy==1.26.4 scipy==1.11.4 pandas==1.5.3
cat > run.py <<'PY'
import numpy as np
from welly import Curve

depth = 0.5 * np.arange(20)  # m
curve = Curve(2 * depth, index=depth, mnemonic="CU", index_name="DEPT")
asked = [1.0, 1.25, 2.0, 3.0, 4.0]
right = [2 * z for z in asked]

together = [float(value) for value in curve.read_at(asked)]
single = [float(curve.read_at(z)) for z in asked]
paired = dict(zip(asked, together))
print(f"list: {together}\none by one: {single}\nbeside their depths: {paired}")
assert np.allclose(single, right)
assert np.allclose(together, [2.0, 2.5, 4.0, 4.0, 6.0, 6.0, 8.0, 8.0])
assert np.allclose(list(paired.values()), [2.0, 2.5, 4.0, 4.0, 6.0])
assert np.allclose(curve.read_at([1.0, 2.0, 3.0]), [2.0, 4.0, 6.0])
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
