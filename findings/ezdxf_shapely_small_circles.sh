#!/usr/bin/env bash
# ezdxf 1.4.5, shapely 2.2.0: a pile of 0.6 m becomes a square, one of 0.4 m a triangle, and a bar of 0.1 m nothing.
#
# Expected: `ezdxf.addons.geo.proxy(circle)` gives a polygon for shapely with an area that is right to a per cent,
#     for circles of any size.
# Seen: in a drawing in metres a circle of radius 3 m has 13 sides and 96 % of its area.  Radius 0.6 m: 6 sides, 83 %;
#     0.3 m: 4 sides, 64 %; 0.2 m: 3 sides, 41 %; 0.05 m: a line without area.  No message.  The same circle as
#     a hatch or a polyline has 16 sides and 97 % in all sizes.
# Meaning: the distance of the chords from the arc is 0.1 of the drawing's unit, whatever the size: the sides are
#     n = pi / arccos(1 - 0.1 / r), rounded up, and the area is n / (2 pi) sin(2 pi / n) of the right one.  Areas of
#     piles, columns and boreholes, their overlap in a pile wall and volumes of concrete are too small by a third or
#     more, in a drawing in mm they are right.  Give `distance`, 1e-4 of the radius.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    ezdxf==1.4.5 shapely==2.2.0 numpy==2.4.6
cat > run.py <<'PY'
import math

import ezdxf
from ezdxf import units
from ezdxf.addons import geo
from shapely.geometry import shape


def drawn(entity, **arguments):
    """Kind of geometry, number of sides and area that shapely gets."""
    body = shape(geo.proxy(entity, **arguments).__geo_interface__)
    line = body.exterior if body.geom_type == "Polygon" else body
    return body.geom_type, len(line.coords) - 1, body.area


drawing = ezdxf.new()
drawing.units = units.M
space = drawing.modelspace()
for radius, sides in ((3.0, 13), (0.6, 6), (0.3, 4), (0.2, 3), (0.05, 1)):
    circle = space.add_circle((5, 5), radius)
    hatch = space.add_hatch()
    hatch.paths.add_edge_path().add_arc((5, 5), radius, 0, 360)
    right = math.pi * radius**2
    kind, found, area = drawn(circle)
    _, hatched, filled = drawn(hatch)
    _, _, fine = drawn(circle, distance=1e-4 * radius)
    print(f"radius {radius} m: {kind}, {found} sides, area {area / right:.3f}; as hatch {hatched} sides, "
          f"{filled / right:.3f}; with a distance {fine / right:.4f}")
    assert found == sides and hatched == 16 and filled > 0.97 * right and fine > 0.999 * right
    if kind == "Polygon":
        assert sides == math.ceil(math.pi / math.acos(1 - 0.1 / radius))
        assert abs(area / right - sides / (2 * math.pi) * math.sin(2 * math.pi / sides)) < 1e-5
    else:
        assert kind == "LineString" and area == 0
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
