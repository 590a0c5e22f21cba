r"""
Sliding and overturning of a gravity wall
=========================================

A concrete wall of 4 m stands on sand; Rankine's earth pressure acts on its back. The ratios of
sliding and overturning from the forces of the contact below the base are compared with a hand
calculation. For design values and bearing see :doc:`a gravity wall by Eurocode 7
</gallery/4_pits_and_walls/plot_design_wall>`. Units are kN and m.
"""

import json

import numpy as np
from skfem import Basis, ElementQuad2, ElementVector, MeshQuad

import skfem_contact as sc
import skfem_contact.plot as plot

sc.set_units("kN", "m")

height, width, mu = 4.0, 2.0, 0.5
x = np.concatenate((np.linspace(-6.0, -0.5, 6), np.linspace(0.0, width, 9), [2.5, 3.5, 5.5, 8.0]))
ground = MeshQuad.init_tensor(x, np.array([-5.0, -3.0, -1.6, -0.7, 0.0])).with_defaults()
wall = MeshQuad.init_tensor(x[6:15], np.linspace(0.0, height, 9)).with_defaults()
basis = Basis(sc.join_bodies({"ground": ground, "wall": wall}), ElementVector(ElementQuad2()))
soils = {"ground": sc.LinearElastic(E=4e4, nu=0.3), "wall": sc.LinearElastic(E=3e7, nu=0.2)}
solid = sc.SolidForm(basis, soils, unit_weight={"ground": 18.0, "wall": 24.0})
exact = sc.AugmentedLagrangian()
pair = sc.ContactPair(basis, "wall:bottom", "ground:top", sc.Coulomb(mu), enforcement=exact)
model = sc.Model({"solid": solid, "base": pair}, sc.box_supports(basis, part="ground"))

# %%
# The weight, then the pressure:
Ka = np.tan(np.radians(45.0 - 33.0 / 2.0)) ** 2
earth = model.traction("wall:right", lambda x: (-Ka * 18.0 * (height - x[1]), 0.0 * x[1]))
result = model.run([sc.Stage("weight"), sc.Stage("earth", earth, increments=2)])
check = sc.design.check(result["earth"], "wall", base=[(0.0, 0.0), (width, 0.0)])
print(check)
plot.contour(result["earth"], "syy", loads=earth, contact=True, window=(-3, 5, -2, 5))

# %%
# By hand:
W, H = 24.0 * width * height, Ka * 18.0 * height**2 / 2.0
by_hand = np.array([mu * W / H, W * width / 2.0 / (H * height / 3.0)])
print(f"by hand: sliding {by_hand[0]:.3f}, overturning {by_hand[1]:.3f}")
error = np.abs(np.array([check.sliding, check.overturning]) / by_hand - 1.0).max()
assert error < 2e-3
row = {"method": "contact forces", "n": basis.mesh.nelements, "unknowns": int(basis.N)}
row |= {"error": error, "cpu_s": None, "iterations": sum(result["earth"].iterations)}
print(json.dumps({"case": "gravity_wall", "rows": [row]}))
