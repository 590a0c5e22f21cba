"""
A pit from a drawing
====================

The drawing ``pit.dxf`` has the upper edges of three soils, the wall, three lifts with their stages
at the end of their layers' names, a strip load and the water table, in millimetres. From it follow
the stages, what the wall bears, and the factor of safety, which Davis' flow rule finds on the safe
side. Units are kN and m.
"""

# sphinx_gallery_thumbnail_number = 3

import json
from time import process_time

from skfem import Basis, ElementTriP2, ElementVector

import skfem_contact as sc
import skfem_contact.plot as plot

sc.set_units("kN", "m")

begin = process_time()
rules = {
    "fill": "top",
    "sand": "top",
    "clay": "top",
    "dig *": "lift",
    "wall": "line",
    "load": "load",
    "water": "water",
}
drawing = sc.section.from_dxf("pit.dxf", rules, size=5.0, bottom=-20.0, sizes={"WALL": 1.2})
print(drawing.section, *drawing.remarks, sep="\n")
drawing.section.plot()

# %%
pit, mesh = drawing.section, drawing.section.mesh()
basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
soils = {
    "FILL": sc.MohrCoulomb(E=2e4, nu=0.3, c=3.0, phi=28.0),
    "SAND": sc.MohrCoulomb(E=5e4, nu=0.3, c=2.0, phi=34.0),
    "CLAY": sc.MohrCoulomb(E=3e4, nu=0.3, c=15.0, phi=25.0),
}
wall = sc.Beam(basis, "WALL", EI=6e4, EA=4e6)
forms = pit.solids(basis, soils, unit_weight={"FILL": 18.0, "SAND": 19.0, "CLAY": 20.0}) | {
    "wall": wall
}
forms["prop"] = sc.Bar(basis, (0, -1), (-6, -1), EA=2e5, fixed_end=True)
model = sc.Model(forms, sc.box_supports(basis), water_unit_weight=9.81)
load = model.traction("LOAD", (0.0, -10.0))
stages = [sc.Stage("load", load, deactivate="prop")] + [
    sc.Stage(f"dig {k}", load, deactivate=lifts, activate=["prop"] * (k == 2))
    for k, lifts in drawing.stages.items()
]
result = model.run(stages, start=model.k0_state(K0=0.5, water=drawing.water["WATER"]))
envelope, found = (
    result.envelope("wall"),
    model.strength_reduction(start=result, certify=False, flow="davis_b"),
)
result.report("pit.html", title="A pit from a drawing")
print(result.table(), envelope, f"factor of safety {found.factor:.2f}", sep="\n\n")
plot.diagram({"smallest": envelope.smallest, "largest": envelope.largest}, "M", upright=True)

# %%
plot.mechanism(found)

# sphinx_gallery_start_ignore
assert found.stop.kind == "plateau"
assert 1.5 < found.factor < 3.0
seconds, iterations = process_time() - begin, [sum(stage.iterations) for stage in result][1:]
print(
    json.dumps(
        {
            "case": "from_drawing",
            "rows": [
                {
                    "method": "pit",
                    "n": mesh.nelements,
                    "unknowns": model.layout.size,
                    "error": None,
                    "cpu_s": round(seconds, 1),
                    "iterations": sum(iterations),
                    "factor": found.factor,
                }
            ],
        }
    )
)
# sphinx_gallery_end_ignore
