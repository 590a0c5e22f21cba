"""
Factor of safety of a slope with two layers and a water table
=============================================================

Tutorial four: how safe is it? A slope of 10 m in two layers stands half in water. The strength of
both soils is divided by a factor until the slope fails; the last factor with an equilibrium is the
factor of safety. Units are kN and m.

Soils below the water table weigh what they weigh when they are saturated; the water in their pores
is a load (:func:`~skfem_contact.water_load`), and the stresses are effective ones.
"""

import numpy as np
from skfem import Basis, ElementTriP2, ElementVector, MeshTri

import skfem_contact as sc
import skfem_contact.plot as plot

plot.set_units("kN", "m")
flat = MeshTri.init_tensor(np.linspace(0, 1, 29), np.linspace(0, 1, 15))
crest = 5 + 10 * (1 - np.clip((40 * flat.p[0] - 10) / 20, 0, 1))
upper = flat.p[1, flat.t].mean(axis=0) > 0.5
mesh = MeshTri(np.stack((40 * flat.p[0], crest * flat.p[1])), flat.t).with_subdomains(
    {"clay": np.flatnonzero(~upper), "sand": np.flatnonzero(upper)}
)
basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)

clay = sc.MohrCoulomb(E=2e4, nu=0.3, c=12.0, phi=22.0, psi=22.0)
sand = sc.MohrCoulomb(E=4e4, nu=0.3, c=3.0, phi=34.0, psi=34.0)
slope = sc.SolidForm(basis, {"clay": clay, "sand": sand}, unit_weight={"clay": 20.0, "sand": 19.0})
water = sc.hydrostatic([(0, 10), (12, 9), (30, 5)], unit_weight=9.81)

model = sc.Model({"slope": slope}, sc.box_supports(basis))
wet, dry = model.strength_reduction(sc.water_load(basis, water)), model.strength_reduction()
print(f"with water {wet.factor:.2f}, without {dry.factor:.2f}")

# %%
# The mechanism: where the soil shears, and where it goes. It enters the clay and leaves at the toe.
plot.mechanism(wet, water=water)

# %%
# The curve levels off at the factor: a collapse, and no failure of the computation.
plot.load_curve(wet)

# sphinx_gallery_start_ignore
import json

assert wet.factor < dry.factor
assert 1.2 < wet.factor < 1.9, wet.factor
assert wet.stop.shows_limit and dry.stop.shows_limit
rows = [
    {
        "method": name,
        "n": 14,
        "unknowns": int(basis.N),
        "error": None,
        "cpu_s": None,
        "iterations": found.iterations,
        "factor": round(found.factor, 3),
    }
    for name, found in (("with water", wet), ("without", dry))
]
print(json.dumps({"case": "slope_with_water", "rows": rows}))
# sphinx_gallery_end_ignore
