#!/usr/bin/env bash
# calfem-python 3.6.16: at the end of three steps of 0.1 the settlement is zero.
#
# Expected: `step1` with a step of 0.1 and a total time of 0.3 makes three steps, and the state at the
#     times 0.1, 0.2 and 0.3, which are asked for, is 0.1, 0.2 and 0.3 of the way (a rate of 1).
# Seen: two steps.  The states are 0.1, 0.2 and 0.  Without times there are three columns in place of
#     four.  The quotient 0.3 / 0.1 is just below 3 and is cut to 2, and a column that is not reached
#     keeps zero.  The same for 0.7 / 0.1 and 0.29 / 0.01; 0.4 / 0.1 is right.  No message.
# Meaning: the final settlement, the state that is wanted most, is zero, which looks like a full
#     rebound, for totals that are multiples of the step.  Give half a step more as the total time.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    calfem-python==3.6.16 numpy==2.4.6 scipy==1.16.3
cat > run.py <<'PY'
import calfem.core as cfc
import numpy as np

# da/dt = 1: the state is the time.
RATE, REST = np.eye(1), np.zeros((1, 1))


def states(step, total, times):
    """States at some times."""
    time, free, dofs = [step, total, 0.5], np.array([]), np.array([1])
    model, _ = cfc.step1(REST, RATE, np.ones((1, 1)), REST, free, time, np.array(times), dofs)
    return model["a"][0]


CASES = ((0.1, 0.3, False), (0.1, 0.4, True), (0.1, 0.7, False), (0.01, 0.29, False))
for step, total, right in CASES:
    last = states(step, total, [step, total])[-1]
    count = states(step, total, []).size - 1
    longer = states(step, total + step / 2, [step, total])[-1]
    print(f"steps of {step} to {total}: last state {last:.2f} after {count}, with half more {longer:.2f}")
    assert abs(last - (total if right else 0)) < 1e-12
    assert count == round(total / step) - (not right)
    assert abs(longer - total) < 1e-12
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
