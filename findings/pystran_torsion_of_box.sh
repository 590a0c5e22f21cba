#!/usr/bin/env bash
# pystran 0.3.1: a square tube of 200 mm x 10 mm has 79 % of its torsion constant.
#
# Expected: `section.rect_tube` gives the constant of Bredt, 4 A^2 over the sum of length over thickness, with the area
#     and the lengths at the middle of the walls.
# Seen: 200 mm x 200 mm x 10 mm: 5525 cm4; by Bredt 6859, by a membrane of Prandtl 7026 cm4.  300 mm x 100 mm x 8 mm:
#     2371; 3007 and 3068 cm4.  400 mm x 200 mm with flanges of 20 mm and webs of 8 mm: 20844; 18645 and 19177 cm4.
# Meaning: the area is that of the hole, and each wall is divided by the thickness of the other pair.  Box girders and
#     hollow walers are too soft in torsion, or too stiff where the flanges are thick, and frequencies of torsion and
#     the share of skew supports follow.  Calculate J by hand and pass it to `beam_3d_section`.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    pystran==0.3.1 numpy==2.4.6 scipy==1.17.1 matplotlib==3.10.8
cat > run.py <<'PY'
import numpy as np
import scipy.sparse.linalg
from pystran import section


def by_bredt(height, width, flange, web):
    """Torsion constant of a thin box by the lines in the middle of the walls."""
    high, wide = height - flange, width - web
    return 4 * (high * wide) ** 2 / (2 * wide / flange + 2 * high / web)


def by_membrane(height, width, flange, web, step):
    """Torsion constant by the membrane of Prandtl: twice its volume, with a stiff plate over the hole."""
    rows, columns = round(height / step) + 1, round(width / step) + 1
    row, column = np.meshgrid(np.arange(rows), np.arange(columns), indexing="ij")
    edge = (row == 0) | (row == rows - 1) | (column == 0) | (column == columns - 1)
    from_flange, from_web = np.minimum(row, rows - 1 - row) * step, np.minimum(column, columns - 1 - column) * step
    plate = (from_flange >= flange - 1e-9) & (from_web >= web - 1e-9)
    number = np.full((rows, columns), -1)
    wall = ~edge & ~plate
    number[wall] = np.arange(wall.sum())
    number[plate] = wall.sum()
    count = wall.sum() + 1
    stiffness = scipy.sparse.csr_array((count, count))
    for one, other in ((number[1:], number[:-1]), (number[:, 1:], number[:, :-1])):
        one, other = one.ravel(), other.ravel()
        for i, j in ((one, other), (other, one)):
            free, both = i >= 0, (i >= 0) & (j >= 0)
            stiffness += scipy.sparse.coo_array((np.ones(free.sum()), (i[free], i[free])), (count, count)).tocsr()
            stiffness -= scipy.sparse.coo_array((np.ones(both.sum()), (i[both], j[both])), (count, count)).tocsr()
    load = 2 * step**2 * np.bincount(number[number >= 0], minlength=count)
    return float(load @ scipy.sparse.linalg.spsolve(stiffness.tocsc(), load))


for name, box, ratio in (
    ("square", (200.0, 200.0, 10.0, 10.0), 0.806),
    ("oblong", (300.0, 100.0, 8.0, 8.0), 0.789),
    ("thick flanges", (400.0, 200.0, 20.0, 8.0), 1.118),
):
    *_, torsion = section.rect_tube(*box)
    bredt, membrane = by_bredt(*box), by_membrane(*box, 1.0)
    print(f"{name}: {torsion / 1e4:.0f} cm4, Bredt {bredt / 1e4:.0f}, membrane {membrane / 1e4:.0f} cm4")
    assert abs(bredt / membrane - 1) < 0.04 and abs(torsion / bredt - ratio) < 2e-3

# The tube of the same module is right, so that a thin round tube is no warning.
*_, tube = section.circular_tube(95.0, 105.0)
exact = 3.141592653589793 / 2 * (105.0**4 - 95.0**4)
assert abs(tube / exact - 1) < 1e-9
PY
OMP_NUM_THREADS=1 MPLBACKEND=Agg venv/bin/python run.py
