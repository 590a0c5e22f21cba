#!/usr/bin/env bash
# pyNastran 1.4.1: a rectangular bar has no stiffness in torsion, and a box nearly twice its own.
#
# Expected: `J` of a `PBARL` is the torsional constant for the solid bar, the tube, the rectangle and the closed box, as
#     the solver takes it; types without a formula are refused, as "T" is.
# Seen: "ROD" and "TUBE" are right.  "BAR" of 0.2 m x 0.5 m has J = 0, right are 0.998e-3 m4; so do all rectangles.
#     "BOX" of 0.3 m x 0.5 m, 20 mm and 10 mm thick, has 1.137e-3 m4, right are 0.620e-3 m4 (Bredt); a square box 1.33
#     times the right value.  For a box the number is I1 + I2, the polar moment.  No message.
# Meaning: a capping beam, a waler or a rib of a tunnel lining that is checked with J from the card has no
#     resistance to torsion, or 33 % to 83 % too much, on the unsafe side for angles of twist.  Solver and check
#     disagree.  Use Bredt's formula for boxes, and the series for rectangles.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    pyNastran==1.4.1 numpy==1.26.4 scipy==1.17.1
cat > run.py <<'PY'
import math

from pyNastran.bdf.bdf import BDF


def constant(kind, *sizes):
    """J, I1 and I2 of a section."""
    model = BDF(debug=None)
    model.add_mat1(1, 210e9, None, 0.3)
    card = model.add_pbarl(1, 1, kind, list(sizes))
    card.cross_reference(model)
    return card.J(), card.I1(), card.I2()


def rectangle(side, longer):
    """Torsional constant of a rectangle by Saint-Venant's series."""
    terms = (math.tanh(n * math.pi * longer / (2 * side)) / n**5 for n in range(1, 200, 2))
    return longer * side**3 / 3 * (1 - 192 * side / (math.pi**5 * longer) * sum(terms))


def box(width, height, flange, web):
    """Torsional constant of a thin closed box by Bredt's second formula."""
    inner_width, inner_height = width - web, height - flange
    return 4 * (inner_width * inner_height) ** 2 / (2 * inner_width / flange + 2 * inner_height / web)


radius, inner = 0.3, 0.2
assert math.isclose(constant("ROD", radius)[0], math.pi * radius**4 / 2, rel_tol=1e-9)
assert math.isclose(constant("TUBE", radius, inner)[0], math.pi * (radius**4 - inner**4) / 2, rel_tol=1e-9)
# the series, for the square of the textbooks
assert math.isclose(rectangle(1.0, 1.0), 0.1406, rel_tol=1e-3)
for sizes in ((0.2, 0.5), (0.3, 0.3)):
    found = constant("BAR", *sizes)[0]
    print(f"bar {sizes}: J {found:.3e} m4, right {rectangle(*sizes):.3e} m4")
    assert found == 0
for sizes, ratio in (((0.3, 0.5, 0.02, 0.01), 1.834), ((0.3, 0.3, 0.01, 0.01), 1.335)):
    found, about_one, about_two = constant("BOX", *sizes)
    print(f"box {sizes}: J {found:.3e} m4, right {box(*sizes):.3e} m4, I1 + I2 {about_one + about_two:.3e} m4")
    assert math.isclose(found, about_one + about_two, rel_tol=1e-9)
    assert math.isclose(found / box(*sizes), ratio, rel_tol=1e-3)
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
