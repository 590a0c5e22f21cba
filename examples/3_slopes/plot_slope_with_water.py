"""
Factor of safety of a slope with two layers and two water levels
================================================================

Tutorial four: how safe is it? A slope of 10 m in two layers. The sand has a phreatic line; the clay
below is confined and has its own, higher piezometric line. The strength of both soils is divided by
a factor until the slope fails; the last factor with an equilibrium is the factor of safety. Units
are kN and m.

Soils below the water table weigh what they weigh when they are saturated. ``water`` takes a level,
a line, or one for each region; the stresses are effective ones.
"""

import json

import numpy as np
from skfem import Basis, ElementTriP2, ElementVector, MeshTri

import skfem_contact as sc
import skfem_contact.plot as plot

plot.set_units("kN", "m")
flat = MeshTri.init_tensor(np.linspace(0, 1, 29), np.linspace(0, 1, 15))
crest = 5 + 10 * (1 - np.clip((40 * flat.p[0] - 10) / 20, 0, 1))
upper = flat.p[1, flat.t].mean(axis=0) > 0.5
layers = {"clay": np.flatnonzero(~upper), "sand": np.flatnonzero(upper)}
mesh = MeshTri(np.stack((40 * flat.p[0], crest * flat.p[1])), flat.t).with_subdomains(layers)
basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
clay = sc.MohrCoulomb(E=2e4, nu=0.3, c=12.0, phi=22.0, psi=22.0)
sand = sc.MohrCoulomb(E=4e4, nu=0.3, c=3.0, phi=34.0, psi=34.0)
slope = sc.SolidForm(basis, {"clay": clay, "sand": sand}, unit_weight={"clay": 20.0, "sand": 19.0})
model = sc.Model({"slope": slope}, sc.box_supports(basis), water_unit_weight=9.81)

# %%
# Certified bounds under the same water enclose the factor.
phreatic, piezometric = [(0, 10), (12, 9), (30, 5)], [(0, 12), (12, 11), (30, 5)]
levels = {"sand": phreatic, "clay": piezometric}
wet = model.strength_reduction(water=levels, certify=False)
bounds = model.bounds(water=levels, gap=0.05)
print(wet, bounds, sep="\n\n")

# %%
# The mechanism: where the soil shears, and where it goes. It enters the clay and leaves at the toe.
plot.mechanism(wet, water=True)

# %%
# The curve levels off at the factor: a collapse, and no failure of the computation.
plot.load_curve(wet)

# sphinx_gallery_start_ignore
assert bounds.lower < wet.factor / (1.0 + wet.added) < bounds.upper
assert bounds.upper / bounds.lower < 1.05
row = {"method": "P2", "n": 14, "unknowns": int(basis.N), "error": None}
row |= {"cpu_s": None, "iterations": wet.iterations, "factor": round(wet.factor, 3)}
print(json.dumps({"case": "slope_with_water", "rows": [row]}))
# sphinx_gallery_end_ignore
