#!/usr/bin/env bash
# xsect 1.1.2: the section modulus of a section with an eccentric hole is 25 % too large.
#
# Expected: `multi_section_summary` of an outline and a hole gives the elastic section moduli I / c with the distance
#     c from the centroid that it returns to the farthest fibre.
# Seen: 10 x 20 with a hole of 8 x 9 near the top: centroid at 7.469 and inertia 3902.5 as by hand, `elast_sect_mod_x`
#     390.3, that is with c of 10, the half of the height; right is 311.4 with c of 12.53.  With the hole in the
#     middle both agree.
# Meaning: the moduli call the function for the farthest fibre with an empty list of holes, that is with the centroid
#     of the outline.  Bending stresses of box sections with thick bottom flanges, channels, hollow piers and trough
#     bridges are up to a quarter too small.  Divide the returned inertia by the distances from the returned centroid.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    xsect==1.1.2 numpy==2.4.6 matplotlib==3.11.2 pandas==3.0.6
cat > run.py <<'PY'
import matplotlib

matplotlib.use("Agg")
import numpy as np
from xsect import multi_section_summary

WIDTH, HEIGHT = 10.0, 20.0
outline = np.array([(0.0, 0.0), (WIDTH, 0.0), (WIDTH, HEIGHT), (0.0, HEIGHT)])


def by_hand(bottom, top, wide):
    """Centroid, inertia and smaller section modulus of the rectangle with a hole of this width from bottom to top."""
    deep, middle = top - bottom, (top + bottom) / 2
    area = WIDTH * HEIGHT - wide * deep
    centroid = (WIDTH * HEIGHT**2 / 2 - wide * deep * middle) / area
    inertia = WIDTH * HEIGHT**3 / 12 + WIDTH * HEIGHT * (HEIGHT / 2 - centroid) ** 2
    inertia -= wide * deep**3 / 12 + wide * deep * (middle - centroid) ** 2
    return centroid, inertia, inertia / max(centroid, HEIGHT - centroid)


for bottom, top, ratio in ((5.5, 14.5, 1.0), (8.0, 17.0, 1.1406), (10.0, 19.0, 1.2533)):
    hole = np.array([(1.0, bottom), (9.0, bottom), (9.0, top), (1.0, top)])
    found = multi_section_summary([outline], [hole])
    centroid, inertia, modulus = by_hand(bottom, top, 8.0)
    print(f"hole from {bottom} to {top}: centroid {found['y']:.3f}, inertia {found['inertia_x']:.1f}, modulus "
          f"{found['elast_sect_mod_x']:.1f}, right {centroid:.3f}, {inertia:.1f}, {modulus:.1f}")
    assert np.allclose([found["y"], found["inertia_x"]], [centroid, inertia])
    assert np.isclose(found["elast_sect_mod_x"], inertia / (HEIGHT / 2))
    assert abs(found["elast_sect_mod_x"] / modulus - ratio) < 1e-3
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
