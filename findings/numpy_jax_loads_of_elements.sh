#!/usr/bin/env bash
# numpy 2.4.6, jax 0.10.2: a line load of 100 kN is 55 kN after assembly by numpy, and 100 kN by jax.
#
# Expected: `loads[nodes] += shares` adds the shares of all elements to their nodes, as the same line does in a loop
#     over elements, so that the loads have the sum 100 kN.
# Seen: 10 m of beam under 10 kN/m in 10 elements.  The sum is 55 kN: each inner node has the share of one element, 5
#     kN in place of 10.  With 100 elements it is 50.5 kN.  A simply supported beam has 62.5 in place of 125 kNm in
#     the middle.  A loop, `numpy.add.at`, `numpy.bincount` and jax' `loads.at[nodes].add(shares)` give 100 kN.  No
#     message.
# Meaning: an index that occurs twice is served once.  Code that was a loop, or that was written for jax, loses half
#     of every distributed load when it is written for whole arrays; self-weight, and stiffness that is added to an
#     array in this way, as well.  Half a load looks like a load.  Compare the sum of the loads with the one by hand.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 jax==0.10.2 jaxlib==0.10.2
cat > run.py <<'PY'
import jax
import numpy as np

LENGTH, LOAD = 10.0, 10.0  # m, kN/m


def assembled(number):
    """Nodal loads in kN of a number of equal elements, in four ways."""
    nodes = np.column_stack([np.arange(number), np.arange(1, number + 1)])
    shares = np.full(nodes.shape, LOAD * LENGTH / number / 2)
    loop, whole, unbuffered = np.zeros((3, number + 1))
    for element, share in zip(nodes, shares):
        loop[element] += share
    whole[nodes] += shares
    np.add.at(unbuffered, nodes, shares)
    return {
        "loop": loop,
        "whole arrays": whole,
        "numpy.add.at": unbuffered,
        "numpy.bincount": np.bincount(nodes.ravel(), shares.ravel()),
        "jax": np.asarray(jax.numpy.zeros(number + 1).at[nodes].add(shares)),
    }


def moment(loads):
    """Moment in kNm in the middle of a simply supported beam under nodal loads."""
    places = np.linspace(0, LENGTH, loads.size)
    support = loads @ (LENGTH - places) / LENGTH
    return support * LENGTH / 2 - loads @ np.maximum(LENGTH / 2 - places, 0)


for number in (10, 100):
    for name, loads in assembled(number).items():
        print(f"{number} elements, {name}: sum {loads.sum():.2f} kN, moment {moment(loads):.2f} kNm; right "
              f"{LOAD * LENGTH} kN and {LOAD * LENGTH**2 / 8} kNm")
        if name == "whole arrays":
            assert abs(loads.sum() - LOAD * LENGTH * (number + 1) / (2 * number)) < 1e-9
            assert abs(moment(loads) - LOAD * LENGTH**2 / 16) < 1e-9
        else:
            assert abs(loads.sum() - LOAD * LENGTH) < 1e-3 and abs(moment(loads) - LOAD * LENGTH**2 / 8) < 1e-2
PY
OMP_NUM_THREADS=1 JAX_PLATFORMS=cpu venv/bin/python run.py
