#!/usr/bin/env bash
# spotpy 1.6.7, hydroeval 0.1.0, HydroErr 2.0.0: a model 10 % too high has a bias of +10 %, -10 % and -1.25 m.
#
# Expected: `bias` and `pbias` of one library have one sign, and the three libraries have the same one; their
#     functions take the observed and the simulated heads in one order.
# Seen: observed heads with a mean of 12.5 m, simulated ones 10 % higher.  spotpy: `pbias` +10 %, `bias` -1.25 m.
#     hydroeval: `pbias` -10 %.  HydroErr: `me` +1.25 m.  spotpy takes the observed heads first, the others the
#     simulated ones.  The efficiency of Nash and Sutcliffe is 0.296 in all three; with the arguments of the next
#     library it is 0.418.  No message.
# Meaning: heads that are too high by one line are too low by the next line of the same table, and a correction with
#     the wrong sign doubles the error.  Exchanged arguments raise the efficiency of models with too much variation.
#     Write down the sign, and try a model that is 10 % too high first.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    spotpy==1.6.7 hydroeval==0.1.0 HydroErr==2.0.0 numpy==2.4.6
cat > run.py <<'PY'
import hydroeval
import HydroErr
import numpy as np
from spotpy import objectivefunctions as spotpy

observed = np.array([10.0, 11, 12, 13, 14, 15, 14, 13, 12, 11])  # m
simulated = 1.1 * observed


def by_hydroeval(function, *heads):
    """One measure of hydroeval."""
    (value,) = hydroeval.evaluator(function, *heads)
    return value


def efficiency(heads, reference):
    """Efficiency of Nash and Sutcliffe by its definition."""
    return 1 - ((heads - reference) ** 2).sum() / ((reference - reference.mean()) ** 2).sum()


excess = (simulated - observed).mean()
percent = 100 * excess / observed.mean()
print(f"by hand: the mean is {excess:.2f} m or {percent:.0f} % too high")
# value, sign
for name, value, right, sign in (
    ("spotpy pbias", spotpy.pbias(observed, simulated), percent, 1),
    ("spotpy bias", spotpy.bias(observed, simulated), excess, -1),
    ("hydroeval pbias", by_hydroeval(hydroeval.pbias, simulated, observed), percent, -1),
    ("HydroErr me", HydroErr.me(simulated, observed), excess, 1),
):
    print(f"{name}: {value:+.2f}")
    assert abs(value - sign * right) < 1e-9
for name, value, exchanged in (
    ("spotpy", spotpy.nashsutcliffe(observed, simulated), spotpy.nashsutcliffe(simulated, observed)),
    (
        "hydroeval",
        by_hydroeval(hydroeval.nse, simulated, observed),
        by_hydroeval(hydroeval.nse, observed, simulated),
    ),
    ("HydroErr", HydroErr.nse(simulated, observed), HydroErr.nse(observed, simulated)),
):
    print(f"{name}: efficiency {value:.3f}, with exchanged arguments {exchanged:.3f}")
    assert abs(value - efficiency(simulated, observed)) < 1e-9
    assert abs(exchanged - efficiency(observed, simulated)) < 1e-9 and exchanged - value > 0.1
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
