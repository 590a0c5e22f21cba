#!/usr/bin/env bash
# concretedesignpy 0.5.0: a beam of 300 mm x 500 mm carries a torsion of 1000 kNm.
#
# Expected: `torsion_design` takes mm, MPa and kNm, as its docstring says, and checks the
#     threshold, the stirrups and the crushing of the struts of the American code 318-19.
# Seen: the threshold below which torsion may be neglected is 4632 kNm, right is 4.63 kNm.  30 kNm ask for stirrups of
#     0.0007 mm2/mm in one leg, right is 0.70; a leg of 10 mm at 150 mm has 0.52.  1000 kNm pass with "MAY NEGLECT"; the
#     stress of the struts is 0.008 MPa, right is 110 MPa.  The formulas are the ones for cm and kN, and some of them
#     are for mm, so that no set of units suits all.
# Meaning: ring beams, pile caps and edge beams of pits pass any torsion.  The limit of the spacing of 305 is in mm, and
#     the cover is measured to the main bars.  Calculate the threshold, the stirrups and the struts by hand.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    --no-deps concretedesignpy==0.5.0 numpy==2.4.6
cat > run.py <<'PY'
import math

from concretedesignpy.calculators.beam_torsion import torsion_design

WIDTH, HEIGHT, COVER, BAR, STIRRUP, SPACING = 300.0, 500.0, 40.0, 20.0, 10.0, 150.0  # mm
CONCRETE, STEEL, FACTOR = 28.0, 420.0, 0.75  # MPa, MPa, -
AREA, PERIMETER = WIDTH * HEIGHT, 2 * (WIDTH + HEIGHT)
LEGS = 2 * math.pi * STIRRUP**2 / 4  # mm2

# Threshold of the American code 318-19 in kNm, below which torsion may be neglected.
threshold = FACTOR * 0.083 * math.sqrt(CONCRETE) * AREA**2 / PERIMETER / 1e6
for torsion in (10.0, 30.0, 100.0, 1000.0):
    result = torsion_design(
        width=WIDTH, height=HEIGHT, cover=COVER, db=BAR, tf=0.0, beff=WIDTH, phi_torsion=FACTOR, fc=CONCRETE,
        fy=STEEL, tu=torsion, vc=100.0, ds=STIRRUP, smax_shear=200.0, s_actual=SPACING, av=LEGS, s=SPACING,
    )
    core, around = result["geometry"]["aoh"], result["geometry"]["ph"]
    right = torsion * 1e6 / (2 * FACTOR * 0.85 * core * STEEL)
    stress = torsion * 1e6 * around / (1.7 * core**2)
    crushing = next(check for check in result["checks"] if check["check"] == "crushing_limit")
    print(
        f"{torsion:.0f} kNm: {result['status']}, {result['checks'][0]['status']}; threshold "
        f"{result['torsion_threshold']:.0f} kNm, right {threshold:.2f}; one leg {result['at_per_s']:.6f} mm2/mm, right "
        f"{right:.3f}; stress {crushing['combined_stress']:.4f} MPa, right {stress:.2f} of torsion alone"
    )
    assert result["status"] == "PASS" and result["checks"][0]["status"] == "MAY NEGLECT" and torsion > threshold
    assert math.isclose(result["torsion_threshold"], 1e3 * threshold, rel_tol=1e-4)
    assert math.isclose(result["at_per_s"], right / 1e3, rel_tol=5e-3)
    assert crushing["combined_stress"] < stress / 50
print(f"a leg of {STIRRUP:.0f} mm at {SPACING:.0f} mm: {LEGS / 2 / SPACING:.3f} mm2/mm")
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
