"""
The factor of safety of an embankment in time
=============================================

An embankment of 3 m is built on 4 m of soft clay within two days, and the clay consolidates. The
factor of safety is least at the end of construction and grows as the water drains. Certified bounds
with the pore pressures of each moment enclose it. Units are kN, m and days.
"""

import json

from skfem import Basis, ElementTriP2, ElementVector

import skfem_contact as sc
import skfem_contact.plot as plot

sc.set_units("kN", "m")

section = sc.section.embankment(3.0, 6.0, 2.0, {"clay": -4.0}, 1.0, beyond=9.0)
basis = Basis(section.mesh(), ElementVector(ElementTriP2()), intorder=4)
clay = sc.MohrCoulomb(E=2e3, nu=0.3, c=6.0, phi=24.0, psi=24.0)
fill = sc.MohrCoulomb(E=8e3, nu=0.3, c=5.0, phi=33.0, psi=33.0)
forms = section.solids(basis, {"clay": clay, "fill": fill}, unit_weight={"clay": 7.0, "fill": 19.0})
forms["water"] = water = sc.PoreWater(basis.with_elements("clay"), 1e-4, unit_weight=9.81)
supports = sc.box_supports(basis)
start = sc.Model({"remaining": forms["remaining"]}, supports).k0_state(K0=0.6)
model = sc.Model(forms, [supports, water.dofs("clay:surface"), water.dofs("clay|fill")])
stages = [sc.Stage("fill", activate=["lift 1", "water"], duration=2.0, increments=4)]
stages += [sc.Stage(f"{days} days", duration=days, increments=3) for days in (60, 2000)]
result = model.run(stages, start=start)
plot.contour(result["fill"], "pore", window=(0, 17, -4, 3.2))

# %%
# Slow failure under the pressures of each moment:
solids = sc.Model({name: forms[name] for name in ("remaining", "lift 1")}, supports)
factors, off = [], []
for stage in list(result)[1:]:
    found = model.strength_reduction(start=stage, certify=False)
    bounds = solids.bounds(water=stage.states["water"].pressure, gap=0.05)
    print(f"{stage.name}: {found.factor:.3f}, between {bounds.lower:.3f} and {bounds.upper:.3f}")
    assert bounds.lower < found.factor < bounds.upper * (1.0 + found.added)
    factors.append(found.factor)
    off.append(abs(2.0 * found.factor / (bounds.lower + bounds.upper) - 1.0))
assert factors == sorted(factors)
row = {"method": "P2", "n": basis.mesh.nelements, "unknowns": model.layout.size, "error": max(off)}
row |= {"cpu_s": None, "iterations": found.iterations}
print(json.dumps({"case": "embankment_factor", "rows": [row]}))
