"""
A tunnel with relaxation and lining
===================================

A tunnel of three centres in two layers of ground. Half of the ground's pressure is released before
the lining, a shell of 20 cm of shotcrete, is placed; it bears the rest. Units are kN and m.
"""

# sphinx_gallery_thumbnail_number = 2

import json
from time import process_time

from skfem import Basis, ElementTriP2, ElementVector

import skfem_contact as sc
import skfem_contact.plot as plot

sc.set_units("kN", "m")

begin = process_time()
outline = sc.section.three_centres(4.5, 3.2, (55.0, 65.0), centre=(0.0, -16.0))
section = sc.section.tunnel(outline, {"gravel": -8.0, "marl": -35.0}, 7.0, width=70.0, fine=1.0)
section.plot()

# %%
mesh = section.mesh()
basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=4)
soils = {
    "gravel": sc.MohrCoulomb(E=6e4, nu=0.3, c=2.0, phi=35.0),
    "marl": sc.MohrCoulomb(E=1.5e5, nu=0.3, c=40.0, phi=26.0),
}
forms = section.solids(basis, soils, unit_weight={"gravel": 20.0, "marl": 22.0})
forms["lining"] = sc.Beam(basis, "lining", EI=1.5e7 * 0.2**3 / 12, EA=1.5e7 * 0.2)
model = sc.Model(forms, sc.box_supports(basis))
result = model.run(
    [
        sc.Stage("at rest", deactivate="lining"),
        sc.Stage("relaxed", deactivate="core", release=0.5, increments=3),
        sc.Stage("lined", activate="lining", increments=3),
    ],
    start=model.k0_state(K0=0.6),
)
print(result.table())
plot.stages([result["relaxed"], result["lined"]], "uy", window=(-20, 20, -28, 0))

# %%
forces = result["lined"].section_forces("lining")
plot.diagram(forces, "M", on=result["lined"])

# sphinx_gallery_start_ignore
assert (
    -1500.0 < forces.N.min() < -200.0
)  # the weight above the springline on half of the width, 336 kPa on 4.5 m
seconds, iterations = process_time() - begin, [sum(stage.iterations) for stage in result][1:]
print(
    json.dumps(
        {
            "case": "tunnel_with_lining",
            "rows": [
                {
                    "method": "tunnel",
                    "n": mesh.nelements,
                    "unknowns": model.layout.size,
                    "error": None,
                    "cpu_s": round(seconds, 1),
                    "iterations": sum(iterations),
                }
            ],
        }
    )
)
# sphinx_gallery_end_ignore
