r"""
A shield tunnel and its settlement trough
=========================================

The grout behind the shield of a tunnel bears the ground's pressure but for 150 kPa; the clay keeps
its volume. The trough of the surface is compared with Sagaseta's (1987) for a ground loss
:math:`V` at the depth :math:`h`, and the closure of the bore with Lamé's for the pressure :math:`p`
that is missing,

.. math:: s(x) = \frac{V}{\pi} \frac{h}{x^2 + h^2}, \quad V = 2 \pi R u, \quad
   u = \frac{p R}{2 G} .

Units are kN and m.
"""

# sphinx_gallery_thumbnail_number = 2

import json

import numpy as np
from skfem import Basis, ElementTriP2, ElementVector

import skfem_contact as sc
import skfem_contact.plot as plot

sc.set_units("kN", "m")

h, R, p, weight = 16.0, 3.0, 150.0, 20.0
outline = sc.section.circle((0.0, -h), R)
section = sc.section.tunnel(outline, {"clay": -100.0}, 8.0, width=240.0, fine=0.8)
section.plot()

# %%
# The pressure of the grout grows with depth like the one of the ground:
basis = Basis(section.mesh(), ElementVector(ElementTriP2()), intorder=4)
clay = sc.Tresca(E=4e4, nu=0.499, c=200.0)
model = sc.Model(section.solids(basis, clay, unit_weight=weight), sc.box_supports(basis))
grout = model.traction("lining", lambda x: (-weight * x[1] - p) / R * np.stack((x[0], x[1] + h)))
drive = sc.Stage("drive", grout, deactivate="core")
stage = model.run([drive], start=model.k0_state(K0=1.0))["drive"]
trough = stage.along([(-50.0, 0.0), (50.0, 0.0)], "uy", n=101)
trough.plot()
plot.contour(stage, "uy", window=(-40, 40, -40, 2))

# %%
# By hand:
closure = p * R * (1.0 + clay.nu) / clay.E
settlement = 2.0 * R * closure * h / (trough["x"] ** 2 + h**2)
moved = stage.at([(R, -h), (0.0, R - h), (-R, -h), (0.0, -R - h)], "ux", "uy")
closed = 0.25 * (moved["ux"][2] - moved["ux"][0] + moved["uy"][3] - moved["uy"][1])
deepest = -trough["uy"].min()
print(f"closure {1e3 * closed:.1f} mm, by hand {1e3 * closure:.1f} mm; settlement ", end="")
print(f"{1e3 * deepest:.2f} mm, by hand {1e3 * settlement.max():.2f} mm")
error = np.abs(trough["uy"] + settlement).max() / settlement.max()
assert error < 0.03 and abs(closed / closure - 1.0) < 0.015
row = {"method": "P2", "n": basis.mesh.nelements, "unknowns": int(basis.N), "error": error}
row |= {"cpu_s": None, "iterations": sum(stage.iterations)}
print(json.dumps({"case": "tunnel_trough", "rows": [row]}))
