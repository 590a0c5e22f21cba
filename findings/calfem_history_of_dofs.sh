#!/usr/bin/env bash
# calfem-python 3.6.16: the history of a settlement is zero at all times, unless other output is asked for.
#
# Expected: `step1` and `step2` return in `dofhist` the history of the dofs that are given in `dofs`, as
#     documented, whether or not `times` asks for the state of the whole model.
# Seen: with times=[] the whole model is returned at all steps and is right (0.632 after one time
#     constant), and the history of dof 1 is its initial value and then zero.  With times=[1] the
#     same history is right.  `step2` behaves alike.  No message.
# Meaning: the history of a settlement, of a pore pressure or of a floor says that nothing moves, in the
#     call that asks for most.  A peak that is taken from it is the initial value.  Take the row of
#     the dof from `modelhist`, or give any time in `times`.
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

ONE, DOF = np.eye(1), np.array([1])
LOAD, START, FREE = np.ones((1, 1)), np.zeros((1, 1)), np.array([])


def first_order(times):
    """Model and history of da/dt + a = 1 with a(0) = 0."""
    return cfc.step1(ONE, ONE, LOAD, START, FREE, [0.01, 2.0, 0.5], times, DOF)


def second_order(times):
    """Model and history of d2a/dt2 + a = 1 from rest."""
    time = [0.01, 4.0, 0.25, 0.5]
    return cfc.step2(ONE, 0 * ONE, ONE, LOAD, START, START, FREE, time, times, DOF)


for solve, step, right in (
    (first_order, 100, 1 - np.exp(-1)),
    (second_order, 314, 1 - np.cos(3.14)),
):
    model, empty = solve(np.array([]))
    _, filled = solve(np.array([1.0]))
    whole, lost, kept = model["a"][0, step], empty["a"][0], filled["a"][0, step]
    print(f"{solve.__name__}: exact {right:.4f}, model {whole:.4f}, history with a time {kept:.4f}")
    print(f"    history without times: largest value {np.abs(lost).max()}, {lost.size} values")
    assert abs(whole - right) < 1e-4 and abs(kept - whole) < 1e-12
    assert lost.size > step and not lost.any()
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
