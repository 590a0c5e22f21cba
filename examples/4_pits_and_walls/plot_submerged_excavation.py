"""
A submerged excavation beside a published comparison
====================================================

A pit of 30 m width is dug 20 m deep below the water, between diaphragm walls of 30 m with a strut.
The developers of Kratos publish the moments that PLAXIS finds for the linear elastic model, with
interfaces of their own stiffness in clay and sand, beside their own (test
``submerged_construction_of_excavation`` of the application for geomechanics, pull request 14011).
Half of the pit is computed. Units are kN and m.
"""

# sphinx_gallery_thumbnail_number = 2

import json

import numpy as np
from skfem import Basis, ElementTriP2, ElementVector

import skfem_contact as sc
import skfem_contact.plot as plot

plot.set_units("kN", "m")
layers, floors = {"dry clay": -2.0, "clay": -20.0, "sand": -50.0}, [-2.0, -10.0, -20.0]
street = {"street": [(2.0, 0.0), (7.0, 0.0)]}
pit = sc.section.pit(15.0, floors, (-1.0, -30.0), layers, 3.0, beyond=50.0, fine=0.5, lines=street)
basis = Basis(pit.mesh(), ElementVector(ElementTriP2()), intorder=4)
clay, sand = sc.LinearElastic(E=12e3, nu=0.15), sc.LinearElastic(E=120e3, nu=0.2)
weights = {"dry clay": 16.0, "clay": 18.0, "sand": 20.0}
forms = pit.solids(basis, {"dry clay": clay, "clay": clay, "sand": sand}, unit_weight=weights)

# %%
# The wall, and the interfaces on both sides: each pair has the stiffnesses of its soil, across and
# along the wall. Interfaces beside lifts go with them.
E, thickness = 5.93e6, 1.265
EA, EI = E * thickness, E * thickness**3 / 12.0
wall = sc.Beam(basis, "wall|right", EI, EA, GA=5 / 12 * EA, unit_weight=10.0, bonded=False)
beside_clay = [
    "lift 1|wall",
    "lift 2|wall",
    "lift 3|wall",
    "dry clay|wall|right",
    "clay|wall|right",
]
beside_sand = ["sand|wall|left", "sand|wall|right"]
forms |= wall.contact(basis, sc.Tied(), beside_clay, penalty=(48e3, 20869.565))
forms |= wall.contact(basis, sc.Tied(), beside_sand, penalty=(480e3, 200e3))
forms |= {"wall": wall}
forms["strut"] = sc.Bar(None, wall.at((0.0, -1.0)), (-15.0, -1.0), EA=4e5, fixed_end=True)

# %%
# The water stays at 2 m below the surface, in the ground and in the pit.
model = sc.Model(forms, sc.box_supports(basis), water_unit_weight=10.0)
load, level = model.traction("street", (0.0, -5.0)), -2.0
stages = [
    sc.Stage("load", load, deactivate="strut", water=level),
    sc.Stage("dig 1", load, deactivate=["lift 1", "lift 1|wall"], water=level),
    sc.Stage("dig 2", load, activate="strut", deactivate=["lift 2", "lift 2|wall"], water=level),
    sc.Stage("dig 3", load, deactivate=["lift 3", "lift 3|wall"], water=level),
]
start = model.k0_state(K0={"dry clay": 0.5774, "clay": 0.5774, "sand": 0.4701}, water=level)
result = model.run(stages, start=start)
print(result.table("wall", "strut"))
plot.contour(result["dig 3"], "ux", water=True)

# %%
# Moments of PLAXIS in the last two stages at heights of the wall, with the sign of this package:
published = {
    "dig 2": {-2.0: -103, -4.0: -262, -6.3: -331, -8.0: -285, -20.0: 179, -20.45: 191, -22.1: 126},
    "dig 3": {
        -2.0: -156,
        -6.0: -622,
        -10.0: -828,
        -10.9: -837,
        -15.0: -586,
        -20.0: 885,
        -20.6: 1000,
    },
}
errors = []
for name, moments in published.items():
    forces = result[name].section_forces("wall")
    order = np.argsort(forces.y)
    found = np.interp(list(moments), forces.y[order], forces.M[order])
    errors.append(np.abs(found - list(moments.values())).max() / np.abs(forces.M).max())
    print(f"{name}: M is {errors[-1]:.1%} of the largest moment off at most")
wall_forces = {name: result[name].section_forces("wall") for name in published}
figure = plot.diagram(wall_forces, "M", upright=True)
for moments in published.values():
    depths = [-y for y in moments]  # from the top of the wall at y = 0
    figure.axes[0].plot(list(moments.values()), depths, "k.")
assert max(errors) < 0.01
row = {"method": "P2", "n": basis.mesh.nelements, "unknowns": model.layout.size}
row |= {"error": max(errors), "cpu_s": None, "iterations": sum(result["dig 3"].iterations)}
print(json.dumps({"case": "submerged_excavation", "rows": [row]}))
