#!/usr/bin/env bash
# ifcopenshell 0.9.0.post1: a pile of 10 m stands at 5000.
#
# Expected: position and shape of an object of an IFC model come in one unit, that of the model
#     (mm).
# Seen: for a pile in a model in mm, `get_local_placement` returns 5000, 2000, -3000, and the
#     vertices of `create_shape` reach from 0 to 10, with the position 5, 2, -3 in the matrix of the
#     same shape.  The geometry is converted to metres, attributes and placements are not.  The
#     setting "convert-back-units" gives 10000.
# Meaning: vertices added to placements, to make a mesh of soil and piles, put piles of 10 m
#     kilometres apart, and a model in metres hides the error.  Take the matrix of the shape, or
#     multiply the placement by `calculate_unit_scale`.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    ifcopenshell==0.9.0.post1 numpy==2.4.6
cat > run.py <<'PY'
import ifcopenshell
import ifcopenshell.api.context
import ifcopenshell.api.geometry
import ifcopenshell.api.root
import ifcopenshell.api.unit
import ifcopenshell.geom
import numpy as np
from ifcopenshell.util.placement import get_local_placement
from ifcopenshell.util.unit import calculate_unit_scale

model = ifcopenshell.file(schema="IFC4")
ifcopenshell.api.root.create_entity(model, ifc_class="IfcProject", name="site")
millimetre = ifcopenshell.api.unit.add_si_unit(model, unit_type="LENGTHUNIT", prefix="MILLI")
ifcopenshell.api.unit.assign_unit(model, units=[millimetre])
context = ifcopenshell.api.context.add_context(model, context_type="Model")
body = ifcopenshell.api.context.add_context(
    model, context_type="Model", context_identifier="Body", target_view="MODEL_VIEW", parent=context
)


def axes(*origin):
    """An axis placement at a point, in the unit of the model."""
    return model.createIfcAxis2Placement3D(model.createIfcCartesianPoint(origin))


pile = ifcopenshell.api.root.create_entity(model, ifc_class="IfcPile", name="pile")
pile.ObjectPlacement = model.createIfcLocalPlacement(None, axes(5000.0, 2000.0, -3000.0))
circle = model.createIfcCircleProfileDef("AREA", None, None, 300.0)
up = model.createIfcDirection((0.0, 0.0, 1.0))
solid = model.createIfcExtrudedAreaSolid(circle, axes(0.0, 0.0, 0.0), up, 10000.0)
shape = model.createIfcShapeRepresentation(body, "Body", "SweptSolid", [solid])
ifcopenshell.api.geometry.assign_representation(model, product=pile, representation=shape)

print("metres per unit of the model", calculate_unit_scale(model))
position = get_local_placement(pile.ObjectPlacement)[:3, 3]
print("get_local_placement", position)
assert np.allclose(position, [5000, 2000, -3000])
for back, length in ((False, 10), (True, 10000)):
    settings = ifcopenshell.geom.settings()
    settings.set("convert-back-units", back)
    made = ifcopenshell.geom.create_shape(settings, pile)
    heights = np.array(made.geometry.verts).reshape(-1, 3)[:, 2]
    matrix = np.array(made.transformation.matrix).reshape(4, 4).T
    print(f"convert-back-units {back}: length {np.ptp(heights)}, position {matrix[:3, 3]}")
    assert abs(np.ptp(heights) - length) < 1e-6
    if not back:
        assert np.allclose(matrix[:3, 3], [5, 2, -3])
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
