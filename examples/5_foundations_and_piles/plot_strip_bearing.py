r"""
A strip footing between proven bounds
=====================================

A rough strip footing, 2 m wide, on the surface of sand: half of it is computed. The limit load of
the finite elements stands beside lower and upper bounds of limit analysis, and beside
:math:`q = \tfrac{1}{2} \gamma B N_\gamma + c N_c` with :math:`N_\gamma = 14.75` of Martin's slip
lines (2005) and :math:`N_c = 30.14` of Prandtl for 30 degrees. Units are kN and m.
"""

import json

from skfem import Basis, ElementTriP2, ElementVector

import skfem_contact as sc
import skfem_contact.plot as plot

sc.set_units("kN", "m")

B, weight, c = 2.0, 20.0, 0.1
box = sc.section.rectangle
areas = {"sand": box((0.0, 6.0), (-2.5, 0.0)), "footing": box((0.0, B / 2.0), (0.0, 0.5))}
top, edge = {"top": [(0.0, 0.5), (B / 2.0, 0.5)]}, [((B / 2.0, 0.0), 0.02)]
section = sc.section.Section(areas, size=0.5, sizes={"footing": 0.08}, lines=top, near=edge)
basis = Basis(section.mesh(), ElementVector(ElementTriP2()), intorder=2)
sand = sc.MohrCoulomb(E=5e4, nu=0.3, c=c, phi=30.0, psi=30.0)
soils = {"sand": sand, "footing": sc.LinearElastic(E=3e7, nu=0.2)}
forms = section.solids(basis, soils, unit_weight={"sand": weight, "footing": 0.0})
model = sc.Model(forms, sc.box_supports(basis))

# %%
# The multipliers of a pressure of 1 kPa:
found = model.limit_load(model.traction("top", (0.0, -1.0)), step=20.0)
bounds = model.bounds(tractions={"top": (0.0, -1.0)}, live="top", gap=0.1)
print(bounds, found, sep="\n\n")
plot.mechanism(found, window=(0.0, 6.0, -2.5, 0.6))

# %%
# By hand. Elements make the ground too strong by the share that the result tells.
by_hand = weight * B / 2.0 * 14.75 + c * 30.14
less = found.multiplier / (1.0 + found.added)
print(f"limit pressure {less:.0f} kPa less the error of the mesh, by hand {by_hand:.0f} kPa")
error = abs(less / by_hand - 1.0)
assert bounds.lower < less < bounds.upper and error < 0.03
row = {"method": "P2", "n": basis.mesh.nelements, "unknowns": int(basis.N), "error": error}
row |= {"cpu_s": None, "iterations": found.iterations}
print(json.dumps({"case": "strip_bearing", "rows": [row]}))
