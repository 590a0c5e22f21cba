#!/usr/bin/env bash
# steelbeam 0.2.2: the partial factor for buckling changes no resistance to buckling.
#
# Expected: `gamma_m1` of `analysis("EC", {...})` divides the resistances to buckling, as EN 1993-1-1 6.1 has it, and
#     `gamma_m0` those of cross-sections.
# Seen: IPE 300, 4 m, S 355.  With 1.0 and 1.1, the values of some national annexes, a column resists 611.7 kN, right is
#     556.1 kN; a beam 108.6 kNm, right is 98.7 kNm.  Both are the same for `gamma_m1` of 1.0, 1.1 and 2.0, and both
#     fall by a tenth for `gamma_m0` of 1.1.
# Meaning: `normal_force_buckling` and the two methods `bending_moment_buckling` read the entry "gamma_m0" into the name
#     gamma_m1.  The defaults are both 1.05 and hide it.  Where a national annex has two values, columns and struts
#     have a tenth too much.  Make a second beam with `gamma_m0` set to the factor for buckling.
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

YOUNG, YIELD, LENGTH, IMPERFECTION = 210e3, 355.0, 4000.0, 0.34  # MPa, MPa, mm, curve b


def resistances(section, buckling):
    """Resistances of a column in kN and of a beam in kNm, and area and weak inertia of the profile."""
    beam = steelbeam.SteelBeam(length=LENGTH / 1e3, elastic_modulus=YOUNG, f_yk=YIELD, profile="IPE300")
    beam.analysis("EC", {"gamma_m0": section, "gamma_m1": buckling})
    return (
        beam.normal_force_buckling("b").to("kN").magnitude,
        beam.bending_moment_buckling_y(buckling_curve_lt="b").to("kN*m").magnitude,
        beam.section_area.magnitude, beam.section_inertia_z.magnitude,
    )


base = resistances(1.0, 1.0)
_, _, area, inertia = base
slender = math.sqrt(area * YIELD / (math.pi**2 * YOUNG * inertia / LENGTH**2))
phi = (1 + IMPERFECTION * (slender - 0.2) + slender**2) / 2
column = area * YIELD / (phi + math.sqrt(phi**2 - slender**2)) / 1e3
print(f"column by hand with a factor of 1: {column:.1f} kN")
assert abs(base[0] / column - 1) < 1e-3
for section, buckling in ((1.0, 1.0), (1.0, 1.1), (1.0, 2.0), (1.1, 1.0)):
    force, moment, *_ = resistances(section, buckling)
    print(f"gamma_m0 {section}, gamma_m1 {buckling}: {force:.1f} kN (right {column / buckling:.1f}), "
          f"{moment:.1f} kNm (right {base[1] / buckling:.1f})")
    assert abs(force * section / base[0] - 1) < 1e-9 and abs(moment * section / base[1] - 1) < 1e-9
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
