#!/usr/bin/env bash
# pyNastran 1.4.1: an angle of two equal legs bends about one axis more easily than about the other.
#
# Expected: `PBARL` and `PBEAML` of the type "L" return the second moments of two rectangles; with legs of equal width
#     and thickness I1 and I2 are equal, by symmetry.
# Seen: an angle of 150 x 150 x 15 mm: I1 965 and I2 656 cm4, right are 911 cm4 for both.  For 200 x 100 x 10 mm
#     I1 228 and I2 841 cm4, right are 218 and 1228 cm4.  The area and I12 are right.  No message.
# Meaning: I2 leaves out the upright leg's distance from the centroid, and I1 takes the leg too long by half a
#     thickness.  Walers, struts and anchor beams of angles have 72 % and 106 % of their moments of
#     inertia in checks of stress and buckling that are made from the model's cards, while the solver that reads the
#     same file has the right ones.  Take the sum of two rectangles, or a general `PBAR`.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    pyNastran==1.4.1 numpy==1.26.4 scipy==1.17.1
cat > run.py <<'PY'
import numpy as np
from pyNastran.bdf.bdf import BDF


def moments(rectangles):
    """Area, I1, I2 and I12 of rectangles, each with its centre, width and height."""
    x, y, width, height = np.transpose(rectangles)
    area = width * height
    x, y = x - np.average(x, weights=area), y - np.average(y, weights=area)
    about_x = np.sum(width * height**3 / 12 + area * y**2)
    about_y = np.sum(height * width**3 / 12 + area * x**2)
    return area.sum(), about_x, about_y, np.sum(area * x * y)


def cards(width, height, flat, upright):
    """The same values of both cards, in mm; `flat` and `upright` are the thicknesses of the two legs."""
    model = BDF(debug=None)
    model.add_mat1(1, 210e3, None, 0.3)
    bar = model.add_pbarl(1, 1, "L", [width, height, flat, upright])
    beam = model.add_pbeaml(2, 1, "L", [0.0], [[width, height, flat, upright]], [0.0])
    for card in (bar, beam):
        card.cross_reference(model)
    values = np.array([bar.Area(), bar.I11(), bar.I22(), bar.I12()])
    assert np.allclose(values[:3], [beam.Area(), beam.I11(), beam.I22()])
    return values


# width, height, thickness of the flat and of the upright leg: ratios of I1 and I2 to the right ones
SEEN = {
    (150.0, 150.0, 15.0, 15.0): (1.0594, 0.7195),
    (200.0, 100.0, 10.0, 10.0): (1.0492, 0.6853),
    (300.0, 500.0, 20.0, 10.0): (1.0227, 0.6919),
}
for (width, height, flat, upright), ratios in SEEN.items():
    # the origin is the outer corner
    legs = [
        (width / 2, flat / 2, width, flat),
        (upright / 2, (flat + height) / 2, upright, height - flat),
    ]
    right, found = np.array(moments(legs)), cards(width, height, flat, upright)
    print(f"{width} x {height} mm: I1 {found[1] / 1e4:.1f}, I2 {found[2] / 1e4:.1f} cm4, right "
          f"{right[1] / 1e4:.1f} and {right[2] / 1e4:.1f} cm4")
    assert np.allclose(found[[0, 3]], right[[0, 3]], rtol=1e-9)
    assert np.allclose(found[1:3] / right[1:3], ratios, atol=1e-4)
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
