#!/usr/bin/env bash
# cadquery 2.8.0: a pit has another volume if it is extruded from its floor than from its rim.
#
# Expected: `extrude` with a `taper` gives the frustum with plane slopes and sharp corners, whether the floor is
#     extruded upwards with a negative angle or the rim downwards with a positive one.
# Seen: square pits with slopes of 45 degrees.  Floor 4 m, depth 10 m: 2007.2 m3 from the floor, 2293.3 m3 from the
#     rim, exact 2293.3 m3.  Floor 10 m, depth 3 m: 508.3 and 516.0 m3.  Both have the rim of 24 m and 16 m as their
#     bounding box; the one from the floor has 10 faces in place of 6, and 490 m2 in place of 576 m2 at its rim.  A
#     ruled `loft` is right.  No message.
# Meaning: a profile that widens gets rounded corners, cones in place of the intersection of two slopes; one that
#     narrows gets mitred ones.  Excavated volumes of small deep shafts are 12 % too small, and the model of the
#     ground has steep fillets at the corners, where no engineer drew them.  Extrude from the rim, or loft.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    cadquery==2.8.0 numpy==2.4.6
cat > run.py <<'PY'
import math

import cadquery as cq


def prism(side, height, slope):
    """Solid over a square, with sides that lean by `slope` degrees inwards."""
    return cq.Workplane().rect(side, side).extrude(height, taper=slope).val()


for floor, depth in ((4.0, 10.0), (10.0, 3.0)):
    rim = floor + 2 * depth
    exact = depth / 3 * (floor**2 + floor * rim + rim**2)
    # four quarters of a cone in place of four pyramids with a square base
    rounded = exact - (4 - math.pi) * depth**3 / 3
    from_floor, from_rim = prism(floor, depth, -45), prism(rim, -depth, 45)
    loft = cq.Workplane().rect(floor, floor).workplane(offset=depth).rect(rim, rim).loft(ruled=True).val()
    top = max(from_floor.Faces(), key=lambda face: face.Center().z)
    print(f"floor {floor} m, depth {depth} m: exact {exact:.1f} m3, from the floor {from_floor.Volume():.1f} m3 "
          f"({len(from_floor.Faces())} faces), from the rim {from_rim.Volume():.1f} m3 ({len(from_rim.Faces())} "
          f"faces), loft {loft.Volume():.1f} m3; area at the rim {top.Area():.1f} m2, right {rim**2:.1f} m2")
    assert from_floor.isValid() and abs(from_floor.BoundingBox().xlen - rim) < 1e-6
    assert abs(from_rim.Volume() - exact) < 1e-6 * exact and abs(loft.Volume() - exact) < 1e-6 * exact
    assert abs(from_floor.Volume() - rounded) < 1e-6 * exact
    assert abs(top.Area() - (rim**2 - (4 - math.pi) * depth**2)) < 1e-6 * rim**2
    assert len(from_floor.Faces()) == 10 and len(from_rim.Faces()) == 6
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
