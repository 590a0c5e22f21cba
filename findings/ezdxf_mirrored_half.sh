#!/usr/bin/env bash
# ezdxf 1.4.5: the mirrored half of a section has its lines on the right and its outline on the left.
#
# Expected: the parts of a block that is inserted with the scale -1 in x at x = 10 come back from
#     `virtual_entities` or `explode` with coordinates of the drawing, all in the same system.
# Seen: a line from (0, 0) to (2, 1) has the ends (10, 0) and (8, 1), which is right.  A polyline with
#     the same two points has (-10, 0) and (-8, 1), and the centre of an arc at (0, 0) has x = -10.
#     Their `extrusion` is (0, 0, -1), and their coordinates are in a system of their own.
#     `points_in_wcs` and `start_point` of the arc are right.
# Meaning: tunnels, dams and basements are drawn by halves and mirrored.  A mesh from such a drawing
#     has props and lines in their place, while outlines of soil and vaults lie twice their distance
#     away, on the other side of the origin, and at x = 0 the error is invisible.  Take points in
#     world coordinates, or ask for the extrusion.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    ezdxf==1.4.5
cat > run.py <<'PY'
import ezdxf

drawing = ezdxf.new()
half = drawing.blocks.new("half")
half.add_line((0, 0), (2, 1))
half.add_lwpolyline([(0, 0), (2, 1)])
half.add_arc((0, 0), radius=2, start_angle=0, end_angle=90)
insert = drawing.modelspace().add_blockref("half", (10, 0), dxfattribs={"xscale": -1})
for parts in (list(insert.virtual_entities()), list(insert.explode())):
    line, outline, arc = parts
    points = [tuple(map(float, point)) for point in outline.get_points("xy")]
    world = [(point.x, point.y) for point in outline.vertices_in_wcs()]
    print("line:", line.dxf.start.vec2, line.dxf.end.vec2)
    print("polyline:", points, "in world coordinates:", world, "extrusion", outline.dxf.extrusion)
    print("arc: centre", arc.dxf.center, "start", arc.start_point)
    assert line.dxf.start.isclose((10, 0)) and line.dxf.end.isclose((8, 1))
    assert points == [(-10, 0), (-8, 1)] and world == [(10, 0), (8, 1)]
    assert arc.dxf.center.isclose((-10, 0)) and arc.start_point.isclose((8, 0))
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
