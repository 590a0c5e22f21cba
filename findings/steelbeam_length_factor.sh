#!/usr/bin/env bash
# steelbeam 0.2.2: a beam of 3 m with a length factor of 2 resists 0.57 of the moment of a beam of 6 m.
#
# Expected: `beta` of `bending_moment_buckling_y` is the factor of the buckling length, since the method multiplies the
#     length with it, so that 2.0 on 3 m and 1.0 on 6 m are the same beam.
# Seen: IPE 300, S 355, curve b of EN 1993-1-1.  6 m: 67.2 kNm, as by hand.  3 m with 2.0: 38.5 kNm.  12 m with 0.5:
#     100.1 kNm.  24 m with 0.25: 122.9 kNm.  All of them have a buckling length of 6 m.
# Meaning: the same number is also the beta of the formulas of the reduction factor in clause 6.3.2.3, where 0.75 or 1.0
#     belong.  A factor below one for clamped ends or for bracing is unsafe, one above it loses capacity.  Leave `beta`
#     at 1.0 and give the buckling length as the length of the beam.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    steelbeam==0.2.2 numpy==2.4.6 scipy==1.17.1 handcalcs==1.11.0 pint==0.25.3 ipython==9.8.0
cat > run.py <<'PY'
import math

import steelbeam

YOUNG, YIELD, PARTIAL, IMPERFECTION = 210e3, 355.0, 1.05, 0.34  # MPa, MPa, -, curve b
WEAK, TORSION, WARPING, PLASTIC = 6.04e6, 1.99e5, 1.259e11, 6.28e5  # mm4, mm4, mm6, mm3 of IPE 300


def by_library(length, beta):
    """Resistance to lateral-torsional buckling in kNm, and the properties of the profile."""
    beam = steelbeam.SteelBeam(length=length, elastic_modulus=YOUNG, f_yk=YIELD, profile="IPE300")
    beam.analysis("EC")
    moment = beam.bending_moment_buckling_y(beta=beta, buckling_curve_lt="b")
    constants = (
        beam.section_inertia_z, beam.section_inertia_torsional, beam.section_warping_constant, beam.section_w_pl_y
    )
    return moment.to("kN*m").magnitude, [constant.magnitude for constant in constants]


def by_hand(length):
    """The same by the general case of clause 6.3.2.2 for uniform bending."""
    length, shear = 1e3 * length, YOUNG / 2.6
    critical = math.pi / length * math.sqrt(
        YOUNG * WEAK * (shear * TORSION + math.pi**2 * YOUNG * WARPING / length**2)
    )
    slender = math.sqrt(PLASTIC * YIELD / critical)
    phi = (1 + IMPERFECTION * (slender - 0.2) + slender**2) / 2
    return 1e-6 * PLASTIC * YIELD / PARTIAL / (phi + math.sqrt(phi**2 - slender**2))


for length, beta, seen in ((6.0, 1.0, 67.2), (3.0, 2.0, 38.5), (12.0, 0.5, 100.1), (24.0, 0.25, 122.9)):
    moment, constants = by_library(length, beta)
    right = by_hand(beta * length)
    print(f"{length} m, factor {beta}: {moment:.1f} kNm, right {right:.1f} kNm, ratio {moment / right:.2f}")
    assert abs(moment - seen) < 0.1 and all(
        abs(found / given - 1) < 1e-3 for found, given in zip(constants, (WEAK, TORSION, WARPING, PLASTIC))
    )
    assert abs(right - 67.2) < 0.1
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
