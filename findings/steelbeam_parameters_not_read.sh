#!/usr/bin/env bash
# steelbeam 0.2.2: an IPE 300 of 5.5 m resists 4.5 kNm by the American code, where 101 are right.
#
# Expected: `flexure_y(section_type="F2", ltb_params=...)` of `analysis("AISC")` uses the given constant of warping,
#     distance of the flanges and factor of the moment diagram for lateral-torsional buckling, or those of the
#     profile.
# Seen: S 355, profile from the library, uniform moment. 5.5 m: 4.49 kNm, right is 101; 6 m: 4.11, right 90; 8 m:
#     3.09, right 63 kNm. The same without `ltb_params` and with a factor of the moment diagram of 2, which doubles
#     the moment. The profile itself has the right constant of warping.
# Meaning: the argument is not read; the method makes parameters of its own, with flanges 1 mm apart, a warping
#     constant of 1 mm6 and a factor of one. Beams beyond the limit of 5.33 m are taken for 20 times too weak. Take
#     `analysis("EC")`, or the formulas below.
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
from steelbeam.analysis_AISC import LTBParams
from steelbeam.units import ureg

YOUNG, YIELD = 210e3, 355.0  # MPa
WEAK, TORSION, WARPING, ELASTIC = 6.04e6, 1.99e5, 1.259e11, 5.57e5  # mm4, mm4, mm6, mm3
FLANGES = 289.3  # mm, distance of the flanges


def by_hand(length):
    """Nominal moment of chapter F2 in kNm for a long beam and a uniform moment."""
    radius = math.sqrt(math.sqrt(WEAK * WARPING) / ELASTIC)
    twist, stress = TORSION / (ELASTIC * FLANGES), 0.7 * YIELD
    second = 1.95 * radius * YOUNG / stress * math.sqrt(twist + math.sqrt(twist**2 + 6.76 * (stress / YOUNG) ** 2))
    ratio = (1e3 * length / radius) ** 2
    assert 1e3 * length > second
    return math.pi**2 * YOUNG / ratio * math.sqrt(1 + 0.078 * twist * ratio) * ELASTIC / 1e6


def by_library(length, **parameters):
    """The same by the library, and its constant of warping in mm6."""
    beam = steelbeam.SteelBeam(length=length, elastic_modulus=YOUNG, f_yk=YIELD, profile="IPE300")
    beam.analysis("AISC")
    moment = beam.flexure_y(section_type="F2", **parameters).to("kN*m").magnitude
    return moment, beam.section_warping_constant.magnitude


for length, seen in ((5.5, 4.489), (6.0, 4.115), (8.0, 3.086)):
    given = LTBParams(c=1.0, h_0=FLANGES * ureg.mm, c_b=1.0, c_w=WARPING * ureg.mm**6)
    doubled = LTBParams(c=1.0, h_0=FLANGES * ureg.mm, c_b=2.0, c_w=WARPING * ureg.mm**6)
    (without, warping), (found, _), (twice, _) = (
        by_library(length, **parameters) for parameters in ({}, {"ltb_params": given}, {"ltb_params": doubled})
    )
    right = by_hand(length)
    print(f"{length} m: {found:.2f} kNm with parameters, {without:.2f} kNm without, right {right:.1f} kNm")
    assert found == without == twice and abs(found - seen) < 0.01 and right > 15 * found
    assert abs(warping / WARPING - 1) < 1e-3
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
