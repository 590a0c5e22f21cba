"""
A cantilever wall with its backfill
===================================

A retaining wall of 5 m on sand, which touches the ground by contact alone. What does the stem bear,
and how much of the strength is used? Units are kN and m.
"""

# sphinx_gallery_thumbnail_number = 3

import json
from time import process_time

from skfem import Basis, ElementTriP2, ElementVector

import skfem_contact as sc
import skfem_contact.plot as plot

sc.set_units("kN", "m")

begin = process_time()
section = sc.section.retaining_wall(
    5.0, 3.6, {"sand": -5.0}, 2.5, stem=0.5, slab=0.6, toe=0.8, depth=1.0, beyond=9.0
)
section.plot()

# %%
mesh = section.mesh(scale=1.3)
basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
sand, fill = (
    sc.MohrCoulomb(E=6e4, nu=0.3, c=2.0, phi=35.0),
    sc.MohrCoulomb(E=3e4, nu=0.3, c=1.0, phi=32.0),
)
soils = {"sand": sand, "backfill": fill, "wall": sc.LinearElastic(E=3e7, nu=0.2)}
forms = section.solids(basis, soils, unit_weight={"sand": 19.0, "backfill": 18.0, "wall": 25.0})
forms["skin"] = sc.ContactPair(basis, "ground|wall", "wall|ground", sc.Coulomb(mu=0.42))
model = sc.Model(forms, sc.box_supports(basis, part="ground"))
result = model.run([sc.Stage("weight", increments=2)])
stem = sc.Cuts.line((0.25, 5.0), (0.25, -0.4), depth=0.5, n=28)
print(result.table(sections={"wall": stem}))
moment = result[-1].section_forces("wall", stem)
plot.diagram(moment, "M", on=result[-1])

# %%
print(result[-1].contact("skin"))
plot.contour(result[-1], "mobilised", contact=True, deformed="auto")

# sphinx_gallery_start_ignore
weight = 25.0 * (0.6 * 3.6 + 0.5 * 5.4)  # of the wall, on the ground
error = abs(abs(result[-1].contact("skin").force[1]) / weight - 1.0)
assert error < 1e-4, error  # tolerance of the equilibrium
largest = abs(moment.M).max()
active, at_rest = (
    K * 18.0 * 5.4**3 / 6 for K in (0.307, 1 - 0.53)
)  # Rankine, Jaky, at the foot of the stem
assert 0.5 * active < largest < 1.2 * at_rest, (
    active,
    largest,
    at_rest,
)  # friction of the stem, cohesion; compaction
print(
    json.dumps(
        {
            "case": "cantilever_wall",
            "rows": [
                {
                    "method": "wall",
                    "n": mesh.nelements,
                    "error": error,
                    "unknowns": model.layout.size,
                    "cpu_s": round(process_time() - begin, 1),
                    "iterations": None,
                }
            ],
        }
    )
)
# sphinx_gallery_end_ignore
