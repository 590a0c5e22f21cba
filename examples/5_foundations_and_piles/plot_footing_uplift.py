r"""
An eccentric footing that lifts off
===================================

A stiff, smooth footing of width B stands on elastic ground, and its load has an eccentricity e of
more than a quarter of the width: one edge lifts off. The pressure of a rigid punch on a half-plane
over the contact length :math:`L` has its resultant at a quarter of it from the end that does not
lift, :math:`p = \frac{2 V}{\pi L} \sqrt{(L - s) / s}`, so that

.. math:: L = 4 (B / 2 - e) .

Units are kN and m.
"""

import json

from skfem import Basis, ElementTriP2, ElementVector

import skfem_contact as sc
import skfem_contact.plot as plot

sc.set_units("kN", "m")

B, e, V = 2.0, 0.7, 400.0
near = [((B / 2.0, 0.0), 0.02), ((-0.2, 0.0), 0.05)]
section = sc.section.footing(B, 1.0, {"sand": -20.0}, 2.5, beyond=20.0, fine=0.08, near=near)
basis = Basis(section.mesh(), ElementVector(ElementTriP2()), intorder=4)
soils = {"sand": sc.LinearElastic(E=2e4, nu=0.3), "footing": sc.LinearElastic(E=1e9, nu=0.2)}
forms = section.solids(basis, soils, unit_weight={"sand": 0.0, "footing": 0.0})
forms["base"] = sc.ContactPair(basis, "footing|ground", "ground|footing", sc.Coulomb(0.0))
sides = sc.dofs_at(basis, (0.0, 1.0))[0, :1]
model = sc.Model(forms, [sc.box_supports(basis), sides])

# %%
# A pressure on the top with the resultant V at the distance e from the middle:
load = model.traction("footing:top", lambda x: (0.0 * x[0], -V / B * (1 + 12 * e * x[0] / B**2)))
stage = model.run([sc.Stage("load", load, increments=2)])["load"]
forces = stage.tractions("base")
plot.contour(stage, "syy", contact=True, window=(-3, 3, -3, 1.5))

# %%
# By hand:
pressed = forces.x[forces.pressure > 0.0]
length, by_hand = B / 2.0 - pressed.min(), 4.0 * (B / 2.0 - e)
lever = (forces.weight * forces.pressure) @ forces.x / (forces.weight @ forces.pressure)
print(f"contact length {length:.3f} m, by hand {by_hand:.3f} m; eccentricity {lever:.3f} m")
error = abs(length / by_hand - 1.0)
assert error < 0.02 and abs(lever / e - 1.0) < 0.01
row = {"method": "P2", "n": basis.mesh.nelements, "unknowns": int(basis.N), "error": error}
row |= {"cpu_s": None, "iterations": sum(stage.iterations)}
print(json.dumps({"case": "footing_uplift", "rows": [row]}))
