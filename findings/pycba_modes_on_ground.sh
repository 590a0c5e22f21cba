#!/usr/bin/env bash
# PyCBA 1.0.2: a beam on the ground vibrates as if there were no ground, and a free one not at all.
#
# Expected: a Winkler foundation `kf`, which is right in the static analysis, adds kf / m to each squared frequency of a
#     uniform beam, or `modal` refuses it, as it refuses a shear stiffness `GAv`.
# Seen: 10 m, EI = 30 MN m2, 2 t/m, simply supported, kf = 50 MN/m2.  Under 10 kN/m the middle settles by 0.205 mm,
#     as by the series.  `modal` gives 12.09 rad/s with and without the ground, right is 158.6 rad/s.  Without supports
#     the ground alone carries the beam, which settles by 0.200 mm, and the first two frequencies are zero, right are
#     158.1 rad/s.  No message.
# Meaning: the modes are those of the beam and its point supports.  A slab or a sleeper on soil has its resonance
#     at a tenth of the true frequency, and a check against machines or trains looks at the wrong band.  Use springs on
#     many nodes, or add kf / m to the squares.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    PyCBA==1.0.2 numpy==2.4.6 scipy==1.17.1 matplotlib==3.11.2
cat > run.py <<'PY'
import numpy as np
import pycba

LENGTH, STIFFNESS, MASS, GROUND, LOAD = 10.0, 30e3, 2.0, 50e3, 10.0  # m, kN m2, t/m, kN/m2, kN/m
SUPPORTED, FREE = [-1, 0, -1, 0], [0, 0, 0, 0]


def beam(supports, **options):
    """Beam of one span under a uniform load."""
    result = pycba.BeamAnalysis(L=[LENGTH], EI=STIFFNESS, R=supports, **options)
    result.add_udl(1, LOAD)
    return result


def settlement(analysis):
    """Settlement of the middle in m."""
    assert analysis.analyze() == 0
    results = analysis.beam_results.results
    return -np.interp(LENGTH / 2, results.x[1:-1], results.D[1:-1])


waves = np.arange(1, 400, 2)
beam_part = STIFFNESS * (waves * np.pi / LENGTH) ** 4
series = np.sum(4 * LOAD / (np.pi * waves) / (beam_part + GROUND) * np.sin(waves * np.pi / 2))
found = settlement(beam(SUPPORTED, kf=GROUND))
print(f"supported, on the ground: settlement {1e3 * found:.4f} mm, right {1e3 * series:.4f} mm")
assert abs(found / series - 1) < 2e-3
found = settlement(beam(FREE, kf=GROUND))
print(f"free, on the ground: settlement {1e3 * found:.4f} mm, right {1e3 * LOAD / GROUND:.4f} mm")
assert abs(found * GROUND / LOAD - 1) < 1e-4

bending = STIFFNESS * (np.pi / LENGTH) ** 4
for ground in (None, GROUND):
    first = beam(SUPPORTED, kf=ground).modal(MASS).omega[0]
    right = np.sqrt((bending + (ground or 0)) / MASS)
    print(f"supported, kf {ground}: {first:.2f} rad/s, right {right:.2f} rad/s")
    assert abs(first / np.sqrt(bending / MASS) - 1) < 1e-3
free = beam(FREE, kf=GROUND).modal(MASS).omega[:2]
print(f"free, on the ground: {free.round(3)} rad/s, right {np.sqrt(GROUND / MASS):.2f} rad/s twice")
assert np.all(free < 0.1)

try:
    beam(SUPPORTED, GAv=1e5).modal(MASS)
    raise AssertionError("a shear stiffness is accepted")
except NotImplementedError as message:
    print(f"with a shear stiffness: {message}")
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
