#!/usr/bin/env bash
# pyExSi 0.43.3: a random excitation with an RMS of 1 kN has one of 0.21 to 0.26 kN.
#
# Expected: the docstring of `burst_random` says of the amplitude A: "For 'uniform' distribution, this is the
#     peak-to-peak amplitude, for 'normal' distribution this is the RMS."
# Seen: the largest value of the signal is A for each distribution.  A = 1 without pauses: a normal signal of
#     1,000, 10,000 and 100,000 points has an RMS of 0.25, 0.26 and 0.21, since the largest of more values
#     is a larger multiple of the standard deviation; a uniform one goes from -1 to 1.  The power of the normal signal
#     is 4 to 6 % of the one that was asked for.
# Meaning: a footing or a pile under a shaker gets a fifth of the force in the model; the longer the test, the
#     weaker it is, so that two records of one test differ in level.  Divide the signal by its standard
#     deviation and multiply it by the RMS.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    pyExSi==0.43.3 numpy==2.4.6 scipy==1.17.1
cat > run.py <<'PY'
import numpy as np
import pyExSi

assert "this is the RMS" in " ".join(pyExSi.burst_random.__doc__.split())
effective = []
for points in (1000, 10000, 100000):
    normal, uniform = (
        pyExSi.burst_random(points, A=1.0, ratio=1.0, distribution=name, rg=np.random.default_rng(0))
        for name in ("normal", "uniform")
    )
    effective.append(np.sqrt(np.mean(normal**2)))
    print(
        f"{points} points: normal with an RMS of {effective[-1]:.3f} and a largest value of "
        f"{np.abs(normal).max():.3f}; uniform from {uniform.min():.3f} to {uniform.max():.3f}"
    )
    assert abs(np.abs(normal).max() - 1) < 1e-12
    assert uniform.max() - uniform.min() > 1.99
assert np.allclose(effective, [0.250, 0.256, 0.211], atol=0.002)
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
