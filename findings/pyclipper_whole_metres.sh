#!/usr/bin/env bash
# pyclipper 1.4.0: a plot of 10.7 m x 4.9 m has 40 m2, and a working space of 0.5 m around it is 1 m wide.
#
# Expected: coordinates may be floats, since floats are taken without a message; the union of a plot with itself has
#     its area, 52.43 m2, and an offset by 0.5 m makes 11.7 m x 5.9 m = 69.03 m2.
# Seen: 40 m2 for the union and 72 m2 for the offset, whose corners lie at -1 and 11 m; an offset by 1.5 m makes 112
#     in place of 108.2 m2.  With `scale_to_clipper` and `scale_from_clipper` all three are right.
# Meaning: the library calculates in whole numbers.  Floats are cut off towards zero on their way in, and the corners
#     of the offset are rounded on their way out, without a message.  Pits, strips of land and volumes per metre in m
#     are wrong by up to a metre at each side, and walls of 0.6 m vanish.  Scale before and after, or draw in mm.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    pyclipper==1.4.0 numpy==2.4.6
cat > run.py <<'PY'
import numpy as np
import pyclipper

WIDTH, LENGTH = 10.7, 4.9  # m
PLOT = ((0.0, 0.0), (WIDTH, 0.0), (WIDTH, LENGTH), (0.0, LENGTH))


def area(path):
    """Area by the shoelace formula."""
    x, y = np.transpose(path)
    return abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2


def union(path):
    """The union of a plot with itself."""
    clipper = pyclipper.Pyclipper()
    clipper.AddPath(path, pyclipper.PT_SUBJECT, True)
    (result,) = clipper.Execute(pyclipper.CT_UNION, pyclipper.PFT_NONZERO, pyclipper.PFT_NONZERO)
    return result


def offset(path, distance):
    """The plot with a strip of the given width around it."""
    clipper = pyclipper.PyclipperOffset()
    clipper.AddPath(path, pyclipper.JT_MITER, pyclipper.ET_CLOSEDPOLYGON)
    (result,) = clipper.Execute(distance)
    return result


def scaled(operation, *distances):
    """The same operation on scaled coordinates."""
    distances = [pyclipper.scale_to_clipper(distance) for distance in distances]
    return pyclipper.scale_from_clipper(operation(pyclipper.scale_to_clipper(PLOT), *distances))


for name, distances, operation, seen in (
    ("union", (), union, 40.0),
    ("offset", (0.5,), offset, 72.0),
    ("offset", (1.5,), offset, 112.0),
):
    distance = sum(distances)
    right = (WIDTH + 2 * distance) * (LENGTH + 2 * distance)
    found, fixed = area(operation(PLOT, *distances)), area(scaled(operation, *distances))
    print(f"{name} by {distance} m: {found:.2f} m2, scaled {fixed:.2f} m2, right {right:.2f} m2")
    assert abs(found - seen) < 1e-9 and abs(fixed - right) < 1e-5 and abs(found - right) > 2
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
