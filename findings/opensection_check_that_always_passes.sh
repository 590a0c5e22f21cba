#!/usr/bin/env bash
# opensection 1.0.0: a beam with six times the moment that it carries passes the check of strength.
#
# Expected: `EC2Verification.check_ULS` says that a section fails if the moment is above its capacity.
# Seen: 300 mm x 500 mm, C30, three bars of 20 mm and two of 16 mm: 170 kNm by hand, with 0.35 % in the concrete.
#     250, 400 and 1000 kNm are OK for concrete and steel, and the largest ratio of strength is 1.00 or less.  With
#     500 kN the capacity is 246 kNm, and 400 and 1000 kNm are OK.
# Meaning: the check compares stresses with design strengths which the laws of the materials never exceed, and it does
#     not look at strains.  It cannot fail, and does not ask whether a solution was found.  Walls, piles and caps that
#     are sized with it have no proof.  Look at `converged` of the result, and at the strain of the edge.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    opensection==1.0.0 numpy==2.4.6 scipy==1.17.1 matplotlib==3.10.7
cat > run.py <<'PY'
import math

import opensection as ops
from scipy.optimize import brentq

WIDTH, HEIGHT, COVER = 0.3, 0.5, 0.05  # m
BOTTOM, TOP = 3 * math.pi * 0.020**2 / 4, 2 * math.pi * 0.016**2 / 4  # m2
concrete, steel = ops.ConcreteEC2(fck=30), ops.SteelEC2(fyk=500)


def solve(axial, moment):
    """Result of the library for an axial force in kN and a moment in kNm, and its check of strength."""
    bars = ops.RebarGroup()
    bars.add_rebar(y=0.0, z=COVER - HEIGHT / 2, diameter=0.020, n=3)
    bars.add_rebar(y=0.0, z=HEIGHT / 2 - COVER, diameter=0.016, n=2)
    solver = ops.SectionSolver(ops.RectangularSection(width=WIDTH, height=HEIGHT), concrete, steel, bars)
    result = solver.solve(N=axial, My=moment)
    return result, ops.EC2Verification.check_ULS(result, concrete.fcd, steel.fyd)


def forces(depth):
    """Axial force and moment at failure, in kN and kNm, for 0.35 % at the edge, parabola and rectangle."""

    def bar(distance):
        strain = 0.0035 * (depth - distance) / depth
        return max(-steel.fyd, min(steel.fyd, steel.Es * strain)) * 1e3

    block, lever = 17 / 21 * concrete.fcd * WIDTH * depth * 1e3, HEIGHT / 2 - 99 / 238 * depth
    low, high = bar(HEIGHT - COVER) * BOTTOM, bar(COVER) * TOP
    return block + low + high, block * lever + (high - low) * (HEIGHT / 2 - COVER)


for axial, moments in ((0.0, (100.0, 160.0, 250.0, 400.0, 1000.0)), (500.0, (200.0, 400.0, 1000.0))):
    capacity = forces(brentq(lambda depth: forces(depth)[0] - axial, 0.01, 0.45))[1]
    for moment in moments:
        result, checks = solve(axial, moment)
        ratio = max(check["ratio"] for check in checks.values())
        passed = all(check["ok"] for check in checks.values())
        print(
            f"{axial:.0f} kN, {moment:.0f} kNm: {'OK' if passed else 'FAIL'}, largest ratio {ratio:.2f}, converged "
            f"{result.converged}; capacity by hand {capacity:.0f} kNm, ratio {moment / capacity:.2f}"
        )
        assert passed and ratio <= 1 and result.converged == (moment < capacity)
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
